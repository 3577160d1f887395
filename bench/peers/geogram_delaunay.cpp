// SPDX-License-Identifier: Apache-2.0
// Times geogram's sequential (BDEL) and parallel (PDEL) Delaunay triangulations, for bench/compare_peers.py.
//
//   geogram_delaunay POINTS.f64 BDEL|PDEL THREADS
//
// POINTS.f64: coordinates x y z as doubles, nothing else. Prints one line of JSON; "seconds" is set_vertices(), which
// sorts and inserts all points. geogram's PyPI package offers Voronoi cells only, so the benchmark compiles this with
// the sources that the package's source archive carries (BSD-3-Clause). Built on request, never installed.
#include <geogram/basic/command_line.h>
#include <geogram/basic/command_line_args.h>
#include <geogram/basic/common.h>
#include <geogram/basic/geometry.h>
#include <geogram/basic/logger.h>
#include <geogram/basic/process.h>
#include <geogram/delaunay/delaunay.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

// The list of papers is left out of the build.
namespace GEO::Biblio {
void cite(const char*, const char*, int, const char*, const char*) {}
}  // namespace GEO::Biblio

namespace {

std::vector<double> read_coordinates(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::vector<double> coordinates(static_cast<std::size_t>(file.tellg()) / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(coordinates.data()), static_cast<std::streamsize>(coordinates.size() * 8));
  return coordinates;
}

double volume_of(const GEO::Delaunay& delaunay) {
  double volume = 0;
  for (GEO::index_t t = 0; t < delaunay.nb_cells(); ++t) {
    const auto point = [&](GEO::index_t i) {
      return GEO::vec3(delaunay.vertex_ptr(GEO::index_t(delaunay.cell_vertex(t, i))));
    };
    volume += std::fabs(GEO::Geom::tetra_signed_volume(point(0), point(1), point(2), point(3)));
  }
  return volume;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: geogram_delaunay POINTS.f64 BDEL|PDEL THREADS\n"), 2;
  GEO::initialize(GEO::GEOGRAM_INSTALL_NONE);
  GEO::Logger::instance()->set_quiet(true);
  GEO::CmdLine::import_arg_group("standard");
  GEO::CmdLine::import_arg_group("algo");
  GEO::Process::set_max_threads(static_cast<GEO::index_t>(std::atoi(argv[3])));
  const std::vector<double> coordinates = read_coordinates(argv[1]);
  const GEO::Delaunay_var delaunay = GEO::Delaunay::create(3, argv[2]);
  const auto start = std::chrono::steady_clock::now();
  delaunay->set_vertices(static_cast<GEO::index_t>(coordinates.size() / 3), coordinates.data());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("{\"seconds\": %.6f, \"points\": %zu, \"tets\": %zu, \"volume\": %.17g}\n", seconds,
              coordinates.size() / 3, static_cast<std::size_t>(delaunay->nb_cells()), volume_of(*delaunay));
  return 0;
}
