// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "delfront/geometry_sizes.hpp"
#include "delfront/model.hpp"

namespace delfront::fixtures {

inline constexpr double kTurn = 2 * 3.14159265358979323846;

/// @brief Least and greatest size of sources.
struct Range {
  double low = 1e300, high = 0;
  std::size_t count = 0;
};

/// @param num_corners  of those that count; 0: all
inline Range range_of(const GeometrySources& found, int num_corners = 3) {
  Range range;
  for (const SizeSource& source : found.sources) {
    if (num_corners > 0 && std::get<Simplex>(source.shape).num_corners != num_corners) continue;
    range.low = std::min(range.low, source.law.delta0);
    range.high = std::max(range.high, source.law.delta0);
    ++range.count;
  }
  return range;
}

/// @brief Triangles collected by patch; equal points are welded by build_model.
class SurfaceBuilder {
 public:
  void patch(const std::string& name) { group_ = mesh_.add_group(2, name); }
  void triangle(Point a, Point b, Point c) {
    CellBlock& block = mesh_.block(CellType::triangle);
    for (const Point& p : {a, b, c}) {
      block.vertices.push_back(mesh_.points.next_id());
      mesh_.points.push_back(p);
    }
    block.group.push_back(group_);
  }
  /// @param other  cut along the other diagonal
  void quad(Point a, Point b, Point c, Point d, bool other = false) {
    if (other) {
      triangle(a, b, d);
      triangle(b, c, d);
    } else {
      triangle(a, b, c);
      triangle(a, c, d);
    }
  }
  /// n x m quads of a surface f(i / n, j / m); where sides meet, f must give equal bits.
  void grid(int n, int m, const std::function<Point(int, int)>& f, int pattern = 0) {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) {
        const Point a = f(i, j), b = f(i + 1, j), c = f(i + 1, j + 1), d = f(i, j + 1);
        if (a == b)
          triangle(a, c, d);
        else if (c == d)
          triangle(a, b, c);
        else
          quad(a, b, c, d, pattern == 1 || (pattern == 2 && (i + j) % 2 == 1));
      }
  }
  /// Six sides, outward; `is_hole`: inward.
  void box(Point low, Point high, const std::string& name, bool is_hole = false) {
    patch(name);
    const auto p = [&](int i) { return Point{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; };
    for (const auto& [a, b, c, d] :
         {std::array{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}})
      is_hole ? quad(p(d), p(c), p(b), p(a)) : quad(p(a), p(b), p(c), p(d));
  }
  Model model() const {
    Context context;
    return build_model({{mesh_, "surface"}}, context);
  }

 private:
  Mesh mesh_;
  GroupId group_;
};

/// @brief The place i of n round a circle, the last one equal to the first, bit for bit.
inline Point on_circle(int i, int n, double r) {
  const double angle = kTurn * (i % n) / n;
  return {r * std::cos(angle), r * std::sin(angle), 0};
}

/// @brief Side of a cylinder along z, and its flat ends.
inline void add_cylinder(SurfaceBuilder& to, double r, double height, int around, int along, int pattern,
                         bool is_hole = false) {
  const auto at = [&](int i, int j) {
    return on_circle(is_hole ? around - i : i, around, r) + Point{0, 0, height * j / along};
  };
  to.patch("side");
  to.grid(around, along, at, pattern);
}

inline void add_disc(SurfaceBuilder& to, double r, double z, int around, bool is_up) {
  to.patch(is_up ? "top" : "bottom");
  for (int i = 0; i < around; ++i) {
    const Point a = on_circle(i, around, r) + Point{0, 0, z}, b = on_circle(i + 1, around, r) + Point{0, 0, z};
    is_up ? to.triangle({0, 0, z}, a, b) : to.triangle({0, 0, z}, b, a);
  }
}

inline void add_sphere(SurfaceBuilder& to, double r, int around, int along, int pattern, bool is_hole = false) {
  const auto at = [&](int i, int j) {
    if (j == 0) return Point{0, 0, -r};
    if (j == along) return Point{0, 0, r};
    const double polar = 0.5 * kTurn * j / along;
    return on_circle(is_hole ? around - i : i, around, r * std::sin(polar)) + Point{0, 0, -r * std::cos(polar)};
  };
  to.patch(is_hole ? "hole" : "sphere");
  to.grid(around, along, at, pattern);
}

inline void add_torus(SurfaceBuilder& to, double major, double minor, int around, int along, int pattern) {
  const auto at = [&](int i, int j) {
    const Point section = on_circle(j, along, minor);
    const double radius = major + section.x;
    return on_circle(i, around, radius) + Point{0, 0, section.y};
  };
  to.patch("torus");
  to.grid(around, along, at, pattern);
}

}  // namespace delfront::fixtures
