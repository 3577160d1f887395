// SPDX-License-Identifier: Apache-2.0
// Time of one predicate: on random points (the filter decides), and on points of a lattice and of a sphere, where the
// exact layers have to.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "predicates/predicates.hpp"

namespace {

using delfront::Point;

enum Kind : int { random_points, lattice, sphere };
constexpr std::size_t kNumPoints = 4096;  // a power of two; stays in the cache

std::vector<Point> make_points(int kind) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Point> points(kNumPoints);
  for (Point& p : points) {
    p = {unit(random), unit(random), unit(random)};
    if (kind == lattice) p = {std::round(4 * p.x) / 4, std::round(4 * p.y) / 4, std::round(4 * p.z) / 4};
    if (kind == sphere) p = p / length(p);
  }
  return points;
}

void set_name(benchmark::State& state) {
  constexpr const char* kNames[] = {"random", "lattice", "sphere"};
  state.SetLabel(kNames[state.range(0)]);
  state.SetItemsProcessed(state.iterations());
}

void orient3d(benchmark::State& state) {
  const std::vector<Point> p = make_points(static_cast<int>(state.range(0)));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        delfront::orient3d(p[i], p[(i + 1) % kNumPoints], p[(i + 2) % kNumPoints], p[(i + 3) % kNumPoints]));
    i = (i + 1) % kNumPoints;
  }
  set_name(state);
}
BENCHMARK(orient3d)->DenseRange(0, 2);

template <int (*predicate)(Point, Point, Point, Point, Point)>
void in_sphere(benchmark::State& state) {
  const std::vector<Point> p = make_points(static_cast<int>(state.range(0)));
  // Positive tetrahedra, as the kernel gives them.
  struct Tet {
    Point a, b, c, d, e;
  };
  std::vector<Tet> tets;
  for (std::size_t i = 0; i < kNumPoints; ++i) {
    Tet t{p[i], p[(i + 1) % kNumPoints], p[(i + 2) % kNumPoints], p[(i + 3) % kNumPoints], p[(i + 4) % kNumPoints]};
    const int sign = delfront::orient3d(t.a, t.b, t.c, t.d);
    if (sign < 0) std::swap(t.a, t.b);
    if (sign != 0) tets.push_back(t);
  }
  std::size_t i = 0;
  for (auto _ : state) {
    const Tet& t = tets[i];
    benchmark::DoNotOptimize(predicate(t.a, t.b, t.c, t.d, t.e));
    i = i + 1 < tets.size() ? i + 1 : 0;
  }
  set_name(state);
}
int insphere(Point a, Point b, Point c, Point d, Point e) { return delfront::insphere(a, b, c, d, e); }
int insphere_perturbed(Point a, Point b, Point c, Point d, Point e) {
  return delfront::insphere_perturbed(a, b, c, d, e);
}
BENCHMARK(in_sphere<insphere>)->Name("insphere")->DenseRange(0, 2);
BENCHMARK(in_sphere<insphere_perturbed>)->Name("insphere_perturbed")->DenseRange(0, 2);

}  // namespace
