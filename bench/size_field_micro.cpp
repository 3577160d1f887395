// SPDX-License-Identifier: Apache-2.0
// The size field from the boundary (S1): building it, and evaluations a second at places uniform in the volume, in
// Hilbert order, in batches. Target: 1.5 million evaluations a second from 100,000 boundary points.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "base/hilbert.hpp"
#include "delfront/size_field.hpp"

namespace {

using delfront::Point;

enum Sizes : int { uniform, noisy, graded };

/// Random points on the unit sphere, each as large as the spacing there: the same everywhere, the same with noise on
/// the size, or growing 17-fold from one pole to the other.
delfront::BoundarySizes make_boundary(std::size_t n, int kind) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const auto factor = [kind](Point p) { return kind == graded ? 1 + 8 * (1 + p.x) : 1.0; };
  const double area = kind == graded ? 2 * std::numbers::pi / 8 * (1 - 1.0 / 17) : 4 * std::numbers::pi;
  const double spacing = std::sqrt(area / static_cast<double>(n));  // where the factor is 1
  delfront::BoundarySizes boundary;
  while (boundary.points.size() < n) {
    Point p = {normal(random), normal(random), normal(random)};
    p = p / length(p);
    if (unit(random) * factor(p) * factor(p) > 1) continue;
    boundary.points.push_back(p);
    boundary.size.push_back(spacing * factor(p) * (kind == noisy ? 0.7 + 0.6 * unit(random) : 1));
  }
  return boundary;
}

std::vector<Point> make_queries(std::size_t n) {
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Point> inside;
  while (inside.size() < n) {
    const Point p = {unit(random), unit(random), unit(random)};
    if (length(p) < 1) inside.push_back(p);
  }
  std::vector<Point> ordered;
  for (const std::uint32_t i : delfront::hilbert_order(inside)) ordered.push_back(inside[i]);
  return ordered;
}

void set_name(benchmark::State& state) {
  constexpr const char* kNames[] = {"uniform", "noisy", "graded"};
  state.SetLabel(kNames[state.range(1)]);
}

void build_size_field(benchmark::State& state) {
  const auto boundary = make_boundary(static_cast<std::size_t>(state.range(0)), static_cast<int>(state.range(1)));
  delfront::Context context;
  for (auto _ : state) benchmark::DoNotOptimize(build_boundary_size_field(boundary, context));
  state.SetItemsProcessed(state.iterations() * state.range(0));
  set_name(state);
}

void evaluate_size_field(benchmark::State& state) {
  const auto boundary = make_boundary(static_cast<std::size_t>(state.range(0)), static_cast<int>(state.range(1)));
  delfront::Context context;
  const auto field = build_boundary_size_field(boundary, context);
  const std::vector<Point> at = make_queries(200000);
  std::vector<double> size(at.size());
  for (auto _ : state) {
    field->sizes(at, size);
    benchmark::DoNotOptimize(size.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(at.size()));
  set_name(state);
}

BENCHMARK(build_size_field)->ArgsProduct({{10000, 100000}, {uniform, noisy, graded}})->Unit(benchmark::kMillisecond);
BENCHMARK(evaluate_size_field)->ArgsProduct({{10000, 100000}, {uniform, noisy, graded}})->Unit(benchmark::kMillisecond);

}  // namespace
