// SPDX-License-Identifier: Apache-2.0
// Delaunay tetrahedrization of growing point sets: points and tets a second, what the kernel did for a point, memory.
//
//   delaunay_bench [points ...]        default 10000 100000 1000000
//
// bytes/tet: of the complex alone; peak: of the process so far. Sets: uniform in a cube, on a sphere (all in-sphere
// tests are ties up to rounding), on a lattice (all are ties).
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delfront/context.hpp"
#include "tetra/tet_complex.hpp"

namespace {

using delfront::Point;

std::vector<Point> make_points(const std::string& kind, std::size_t n) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point> points;
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(n))));
  for (std::size_t i = 0; i < n; ++i) {
    Point p = {unit(random), unit(random), unit(random)};
    if (kind == "sphere") {
      const double z = 2 * p.x - 1, angle = 2 * std::numbers::pi * p.y, r = std::sqrt(1 - z * z);
      p = {r * std::cos(angle), r * std::sin(angle), z};
    } else if (kind == "lattice") {
      const auto h = 1 / static_cast<double>(side);
      p = {h * static_cast<double>(i % side), h * static_cast<double>(i / side % side),
           h * static_cast<double>(i / side / side)};
    }
    points.push_back(p);
  }
  return points;
}

std::size_t count_real_tets(const delfront::TetComplex& complex) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < complex.num_slots(); ++t) {
    const auto tet = static_cast<delfront::TetIndex>(t);
    count += !complex.is_dead(tet) && !complex.is_ghost(tet);
  }
  return count;
}

std::size_t bytes_of(const delfront::TetComplex& c) {
  return c.vertex.capacity() * sizeof(c.vertex[0]) + c.node.capacity() * sizeof(c.node[0]) +
         c.neigh.capacity() * sizeof(c.neigh[0]) + c.flag.capacity() * sizeof(c.flag[0]) +
         c.region.capacity() * sizeof(c.region[0]) + c.vertex_tet.capacity() * sizeof(c.vertex_tet[0]) +
         c.on_boundary.capacity();
}

void run(const std::string& kind, std::size_t n) {
  delfront::TetComplex complex;
  for (const Point& p : make_points(kind, n)) complex.add_vertex(p, 0);
  delfront::DelaunayKernel kernel(complex);
  delfront::Context context;
  const auto start = std::chrono::steady_clock::now();
  build_delaunay(complex, kernel, context);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto tets = static_cast<double>(count_real_tets(complex));
  const auto points = static_cast<double>(n);
  const delfront::KernelCounts& counts = kernel.counts;
  const auto per_point = [&](std::uint64_t count) { return static_cast<double>(count) / points; };
  fmt::print("{:<8} {:>9} {:>10.0f} {:>8.2f} {:>10.0f} {:>10.0f} {:>7.1f} {:>8.1f} {:>8.1f} {:>9.1f} {:>10.1f}\n", kind,
             n, tets, seconds, points / seconds / 1e3, tets / seconds / 1e3, per_point(counts.walk_steps),
             per_point(counts.insphere_tests), per_point(counts.tets_created),
             static_cast<double>(bytes_of(complex)) / tets,
             static_cast<double>(delfront::peak_resident_memory()) / 1048576);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::size_t> sizes;
  for (int i = 1; i < argc; ++i) sizes.push_back(std::strtoull(argv[i], nullptr, 10));
  if (sizes.empty()) sizes = {10000, 100000, 1000000};
  fmt::print("{:<8} {:>9} {:>10} {:>8} {:>10} {:>10} {:>7} {:>8} {:>8} {:>9} {:>10}\n", "points", "n", "tets", "s",
             "kpoints/s", "ktets/s", "walk/p", "sphere/p", "made/p", "bytes/tet", "peak MiB");
  for (const std::size_t n : sizes)
    for (const char* kind : {"cube", "sphere", "lattice"}) {
      if (n < 5) continue;
      run(kind, n);
    }
  return 0;
}
