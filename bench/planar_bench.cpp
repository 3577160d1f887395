// SPDX-License-Identifier: Apache-2.0
// planar_bench [points]: Delaunay of uniform points in the plane, then refinement of the unit square and of sections.
// One JSON line a case and stage: case, stage, seconds, triangles, min_angle_deg, and counts a point.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <random>

#include "planar/kernel.hpp"

namespace {

using namespace delfront;

double seconds_of(auto&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void delaunay_case(std::size_t n) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  TriComplex complex;
  for (std::size_t i = 0; i < n; ++i) complex.point.push_back({uniform(random), uniform(random)});
  PlanarKernel kernel(complex);
  Context context;
  const double seconds = seconds_of([&] { build_delaunay(complex, kernel, context); });
  const auto per_point = [&](std::uint64_t count) { return double(count) / double(n); };
  fmt::print(
      "{{\"case\": \"uniform_{}\", \"stage\": \"delaunay\", \"seconds\": {:.4f}, \"triangles\": {}, \"min_angle_deg\": "
      "null, \"walk_steps_a_point\": {:.2f}, \"incircle_tests_a_point\": {:.2f}, \"triangles_made_a_point\": {:.2f}}}\n",
      n, seconds, complex.num_live(), per_point(kernel.counts.walk_steps), per_point(kernel.counts.incircle_tests),
      per_point(kernel.counts.triangles_created));
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t n = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000;
  delaunay_case(n);
  return 0;
}
