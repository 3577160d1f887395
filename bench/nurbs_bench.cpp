// SPDX-License-Identifier: Apache-2.0
// Nanoseconds a place of spline surfaces: all derivatives to second order, tangents alone, the nearest place from a
// start near it.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <random>

#include "delfront/nurbs.hpp"

namespace {

using namespace delfront;

NurbsSurfaceData wavy(int degree, bool is_rational) {
  NurbsSurfaceData data;
  data.degree = {degree, degree};
  data.count = {20, 20};
  data.knots = {even_knots(20, degree), even_knots(20, degree)};
  for (std::size_t i = 0; i < 20; ++i)
    for (std::size_t j = 0; j < 20; ++j) {
      data.points.push_back({double(i), double(j), std::sin(double(i)) * std::cos(double(j))});
      if (is_rational) data.weights.push_back(1 + 0.3 * std::sin(double(i + j)));
    }
  return data;
}

template <class Ask>
double nanoseconds(const std::vector<Point2>& at, const Ask& ask) {
  double best = 1e300, sum = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (const Point2 uv : at) sum += ask(uv);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count() / double(at.size()));
  }
  return sum == 0.5 ? 0 : best;  // so that nothing is left out
}

}  // namespace

int main() {
  std::mt19937 dice(1);
  std::uniform_real_distribution<double> parameter(0, 1);
  std::vector<Point2> at(200000);
  for (Point2& uv : at) uv = {parameter(dice), parameter(dice)};
  fmt::print("surface               derivatives   tangents   closest  (ns a place)\n");
  for (const int degree : {1, 2, 3, 5})
    for (const bool is_rational : {false, true}) {
      const SurfacePointer surface = make_nurbs_surface(wavy(degree, is_rational));
      fmt::print("degree {}, {:<12} {:11.0f} {:10.0f} {:9.0f}\n", degree, is_rational ? "rational" : "polynomial",
                 nanoseconds(at, [&](Point2 uv) { return surface->derivatives(uv).vv.x; }),
                 nanoseconds(at, [&](Point2 uv) { return surface->tangents(uv).v.x; }),
                 nanoseconds({at.begin(), at.begin() + 20000}, [&](Point2 uv) {
                   const SurfaceTangents s = surface->tangents(uv);
                   return surface->closest(s.at + 0.05 * surface->normal(uv), {uv.x + 0.01, uv.y - 0.01}).x;
                 }));
    }
  return 0;
}
