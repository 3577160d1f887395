// SPDX-License-Identifier: Apache-2.0
// Surfaces with known areas and volumes, and uniform sizes.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "delfront/surface_check.hpp"
#include "delfront/surface_grid.hpp"
#include "delfront/uniform_size.hpp"
#include "spatial/bvh.hpp"
#include "support/support.hpp"

namespace delfront::fixtures {

inline constexpr double kPi = 3.14159265358979323846;

/// @brief Size h at x = 0, rising by slope with |x|.
class RisingSize : public SizeField {
 public:
  RisingSize(double h, double slope) : h_(h), slope_(slope) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = h_ + slope_ * std::abs(at[i].x);
  }
  double lower_bound(const Box&) const override { return h_; }

 private:
  double h_, slope_;
};

inline Model model_of(const Mesh& mesh, const std::string& name = "body") {
  Context context;
  return build_model({{mesh, name}}, context);
}

/// @brief A box of 12 triangles, outward, one patch.
inline Model box_model(Point low, Point high) {
  Model m = model_of(cube_surface());
  for (Point& p : m.points)
    for (int k = 0; k < 3; ++k) p[k] = p[k] > 0.5 ? high[k] : low[k];
  return m;
}

inline Model grid_model(int n, int m, bool closes_m, Point (*place)(double, double)) {
  Model model;
  model.patches.push_back({"body", ""});
  const int rows = closes_m ? m : m + 1;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < rows; ++j) model.points.push_back(place(2 * kPi * i / n, double(j) / m));
  const auto id = [&](int i, int j) { return VertexId(std::size_t((i % n) * rows + (closes_m ? j % m : j))); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      model.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      model.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  model.patch_of_triangle.assign(model.triangles.size(), PatchId(std::size_t(0)));
  for (std::size_t t = 0; t < model.triangles.size(); ++t) model.input_face.push_back(std::uint32_t(t));
  return model;
}

/// @brief Radii 2 and 0.6.
inline Model torus_model(int n = 96, int m = 40) {
  return grid_model(n, m, true, [](double a, double t) {
    const double b = 2 * kPi * t;
    return Point{(2 + 0.6 * std::cos(b)) * std::cos(a), (2 + 0.6 * std::cos(b)) * std::sin(a), 0.6 * std::sin(b)};
  });
}

/// @brief Radius 1, height 3, with both ends: strips as long as the cylinder, as CAD exports them.
inline Model cylinder_model(int n = 48) {
  Model m = grid_model(n, 1, false, [](double a, double t) { return Point{std::cos(a), std::sin(a), 3 * t}; });
  m.patches.push_back({"ends", ""});
  const VertexId bottom = m.points.next_id();
  m.points.push_back({0, 0, 0});
  const VertexId top = m.points.next_id();
  m.points.push_back({0, 0, 3});
  for (int i = 0; i < n; ++i) {
    const std::size_t a = std::size_t(2 * i), b = std::size_t(2 * ((i + 1) % n));
    m.triangles.push_back({bottom, VertexId(b), VertexId(a)});
    m.triangles.push_back({top, VertexId(a + 1), VertexId(b + 1)});
  }
  m.patch_of_triangle.resize(m.triangles.size(), PatchId(std::size_t(1)));
  for (std::size_t t = m.input_face.size(); t < m.triangles.size(); ++t) m.input_face.push_back(std::uint32_t(t));
  return m;
}

/// @brief Turned about an axis in no special direction.
inline Model turned(Model m, double angle) {
  const Point axis = Point{1, 2, 3} / std::sqrt(14.0);
  for (Point& p : m.points)
    p = std::cos(angle) * p + std::sin(angle) * cross(axis, p) + (1 - std::cos(angle)) * dot(axis, p) * axis;
  return m;
}

struct Regridded {
  Model model;
  SurfaceGridReport report;
  SurfaceReport look;
};

inline Regridded regrid(const Model& model, const SizeField& size, const std::string& method = "front",
                        int threads = 1) {
  Context context;
  context.threads = threads;
  SurfaceOptions options;
  options.method = method;
  Regridded result;
  result.model = regrid_surface(model, size, options, result.report, context);
  result.look = check_surface(result.model, context);
  return result;
}

/// @brief No errors but those of the given surface, closed and oriented as it is, nothing kept or remeshed.
inline void expect_sound(const Regridded& made, const Model& given) {
  Context context;
  const SurfaceReport before = check_surface(given, context);
  EXPECT_EQ(made.look.is_closed, before.is_closed);
  EXPECT_EQ(made.look.is_manifold, before.is_manifold);
  EXPECT_EQ(made.look.is_oriented, before.is_oriented);
  EXPECT_EQ(made.look.can_bound_volume, before.can_bound_volume);
  EXPECT_EQ(made.look.components.size(), before.components.size());
  if (before.can_bound_volume) {
    for (const Finding& f : made.look.findings) EXPECT_NE(f.severity, Severity::error) << f.message;
  }
  for (const SurfaceFallback& f : made.report.fallbacks)
    ADD_FAILURE() << f.patch << " at " << f.at.x << " " << f.at.y << " " << f.at.z << ": " << f.why;
}

/// @brief How far any vertex lies from the given triangles, by all pairs.
inline double largest_distance_of_points(const Model& made, const Model& given) {
  double largest = 0;
  for (const auto& t : made.triangles)
    for (const VertexId v : t) {
      double least = 1e300;
      const Point p = made.points[v];
      for (const auto& [a, b, c] : given.triangles) {
        const Point q = nearest_point_on_triangle(p, given.points[a], given.points[b], given.points[c]);
        least = std::min(least, distance(p, q));
      }
      largest = std::max(largest, least);
    }
  return largest;
}

}  // namespace delfront::fixtures
