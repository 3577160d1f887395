// SPDX-License-Identifier: Apache-2.0
// Times CGAL's Delaunay_triangulation_3, sequential or parallel, for bench/compare_peers.py.
//
//   cgal_delaunay POINTS.f64 THREADS        THREADS 0: the sequential class; else the TBB one with so many threads
//
// POINTS.f64: coordinates x y z as doubles, nothing else. Prints one line of JSON; "seconds" is the insertion of all
// points, reading and counting left out. CGAL's triangulations are under the GPL: this file is a program of its own,
// built by the benchmark on request, never part of the build, never installed, never linked with delfront.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_data_structure_3.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_3<Kernel>;
using CellBase = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
template <class Tag>
using Delaunay =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase, Tag>>;
using Clock = std::chrono::steady_clock;

std::vector<Kernel::Point_3> read_points(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<Kernel::Point_3> points;
  double p[3];
  while (file.read(reinterpret_cast<char*>(p), sizeof p)) points.emplace_back(p[0], p[1], p[2]);
  return points;
}

template <class Triangulation>
void report(const Triangulation& triangulation, std::size_t points, Clock::time_point start) {
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  double volume = 0;
  for (auto cell : triangulation.finite_cell_handles()) volume += triangulation.tetrahedron(cell).volume();
  std::printf("{\"seconds\": %.6f, \"points\": %zu, \"tets\": %zu, \"volume\": %.17g, \"version\": \"%s\"}\n", seconds,
              points, triangulation.number_of_finite_cells(), volume, CGAL_VERSION_STR);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: cgal_delaunay POINTS.f64 THREADS\n"), 2;
  const std::vector<Kernel::Point_3> points = read_points(argv[1]);
  const int threads = std::atoi(argv[2]);
  if (threads == 0) {
    const auto start = Clock::now();
    const Delaunay<CGAL::Sequential_tag> triangulation(points.begin(), points.end());
    report(triangulation, points.size(), start);
    return 0;
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  CGAL::Bbox_3 box;
  for (const auto& p : points) box += p.bbox();
  const auto start = Clock::now();
  Delaunay<CGAL::Parallel_tag>::Lock_data_structure locks(box, 50);
  const Delaunay<CGAL::Parallel_tag> triangulation(points.begin(), points.end(), &locks);
  report(triangulation, points.size(), start);
  return 0;
}
