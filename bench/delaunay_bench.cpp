// SPDX-License-Identifier: Apache-2.0
// Delaunay tetrahedrization of a point set by the kernel: one JSON line a run.
//
//   delaunay_bench --points uniform|sphere|lattice|graded --n 1000000 --threads 2 --repeat 1
//   delaunay_bench --file POINTS.f64 --threads 2        coordinates x y z as doubles, nothing else
//
// "seconds": sorting and inserting all points; making or reading them and counting afterwards are left out. Counts are
// a point: beside 48 in-sphere tests, 5.6 walk steps and 28 tets made for random points. "complex_bytes_per_tet": of
// the complex afterwards; "peak_bytes_per_tet": peak memory of the process, the points included. Sets: in the unit
// cube; on the unit sphere (rounded: every in-sphere test is nearly a tie); a lattice of integers (all are ties);
// graded: radius 1e-5^u with u uniform, directions uniform, so the spacing grows with the radius from 1 to 1e5.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delfront/context.hpp"
#include "tetra/tet_complex.hpp"

namespace {

using delfront::Point;

struct Job {
  std::string points = "uniform", file;
  std::size_t n = 1000000;
  int threads = 1, repeat = 1;
};

std::vector<Point> make_points(const std::string& kind, std::size_t n) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto side = static_cast<std::size_t>(std::lround(std::cbrt(static_cast<double>(n))));
  if (kind == "lattice") n = side * side * side;
  std::vector<Point> points;
  points.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    Point p = {unit(random), unit(random), unit(random)};
    if (kind == "sphere" || kind == "graded") {
      const double radius = kind == "graded" ? std::pow(1e-5, p.z) : 1;
      const double z = 2 * p.x - 1, angle = 2 * std::numbers::pi * p.y, r = std::sqrt(1 - z * z);
      p = {radius * r * std::cos(angle), radius * r * std::sin(angle), radius * z};
    } else if (kind == "lattice") {
      p = {double(i % side), double(i / side % side), double(i / side / side)};
    }
    points.push_back(p);
  }
  return points;
}

std::vector<Point> read_points(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw delfront::IoError(path + ": cannot be opened");
  std::vector<Point> points(static_cast<std::size_t>(file.tellg()) / (3 * sizeof(double)));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(points.data()), static_cast<std::streamsize>(points.size() * 3 * sizeof(double)));
  return points;
}

struct Size {
  std::size_t tets = 0, bytes = 0;
  double volume = 0;
};

Size measure(const delfront::TetComplex& c) {
  Size size;
  for (std::size_t i = 0; i < c.num_slots(); ++i) {
    const auto t = static_cast<delfront::TetIndex>(i);
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const Point a = c.point(c.node[4 * t]);
    const auto side = [&](unsigned k) { return c.point(c.node[4 * t + k]) - a; };
    size.volume += dot(cross(side(1), side(2)), side(3)) / 6;
    ++size.tets;
  }
  size.bytes = c.vertex.capacity() * sizeof(c.vertex[0]) + c.node.capacity() * sizeof(c.node[0]) +
               c.neigh.capacity() * sizeof(c.neigh[0]) + c.flag.capacity() * sizeof(c.flag[0]) +
               c.region.capacity() * sizeof(c.region[0]) + c.vertex_tet.capacity() * sizeof(c.vertex_tet[0]) +
               c.on_boundary.capacity();
  return size;
}

/// The one place that knows the kernel's interface. @return seconds of the phase
double triangulate(const std::vector<Point>& points, int threads, delfront::TetComplex& complex,
                   delfront::KernelCounts& counts) {
  for (const Point& p : points) complex.add_vertex(p, 0);
  delfront::Context context;
  context.threads = threads;
  const auto start = std::chrono::steady_clock::now();
  build_delaunay(complex, context, &counts);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void run(const Job& job) {
  std::vector<Point> points = job.file.empty() ? make_points(job.points, job.n) : read_points(job.file);
  const std::size_t n = points.size();
  delfront::TetComplex complex;
  delfront::KernelCounts counts;
  const double seconds = triangulate(points, job.threads, complex, counts);
  const Size size = measure(complex);
  const auto tets = static_cast<double>(size.tets);
  const auto a_point = [&](std::uint64_t count) { return static_cast<double>(count) / static_cast<double>(n); };
  fmt::print(
      "{{\"set\": \"{}\", \"points\": {}, \"threads\": {}, \"seconds\": {:.6f}, \"tets\": {}, \"volume\": {:.17g}, "
      "\"walk_steps\": {:.3f}, \"insphere_tests\": {:.3f}, \"tets_created\": {:.3f}, \"tets_deleted\": {:.3f}, "
      "\"complex_bytes_per_tet\": {:.1f}, \"peak_bytes_per_tet\": {:.1f}}}\n",
      job.file.empty() ? job.points : job.file, n, job.threads, seconds, size.tets, size.volume,
      a_point(counts.walk_steps), a_point(counts.insphere_tests), a_point(counts.tets_created),
      a_point(counts.tets_deleted), static_cast<double>(size.bytes) / tets,
      static_cast<double>(delfront::peak_resident_memory()) / tets);
}

}  // namespace

int main(int argc, char** argv) {
  Job job;
  CLI::App app("Delaunay tetrahedrization of a point set: one JSON line a run", "delaunay_bench");
  app.add_option("--points", job.points)->check(CLI::IsMember({"uniform", "sphere", "lattice", "graded"}));
  app.add_option("--file", job.file, "coordinates x y z as doubles, instead of --points and --n");
  app.add_option("--n", job.n)->check(CLI::Range(std::size_t{5}, std::size_t{4000000000}));
  app.add_option("--threads", job.threads)->check(CLI::Range(1, 1024));
  app.add_option("--repeat", job.repeat)->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  try {
    for (int i = 0; i < job.repeat; ++i) run(job);
  } catch (const delfront::Error& error) {
    fmt::print(stderr, "delaunay_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
