// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

namespace delfront {

/// @brief A place or a vector in space, model units. In the plane z = 0.
struct Point {
  double x = 0, y = 0, z = 0;

  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  friend bool operator==(const Point&, const Point&) = default;
};

inline Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(double s, Point a) { return {s * a.x, s * a.y, s * a.z}; }
inline Point operator*(Point a, double s) { return s * a; }
inline Point operator/(Point a, double s) { return {a.x / s, a.y / s, a.z / s}; }
inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point cross(Point a, Point b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double squared_length(Point a) { return dot(a, a); }
inline double length(Point a) { return std::sqrt(squared_length(a)); }
inline double distance(Point a, Point b) { return length(a - b); }
inline bool is_finite(Point a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// @brief An axis-aligned box; empty until something is added.
struct Box {
  Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Point high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};

  void add(Point p) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  void add(const Box& other) {
    add(other.low);
    add(other.high);
  }
  bool is_empty() const { return !(low.x <= high.x); }
  bool overlaps(const Box& other) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > other.high[k] || high[k] < other.low[k]) return false;
    return true;
  }
  Point centre() const { return 0.5 * (low + high); }
  /// @return 0 for an empty box
  double volume() const { return is_empty() ? 0 : (high.x - low.x) * (high.y - low.y) * (high.z - low.z); }
  double diagonal() const { return is_empty() ? 0 : length(high - low); }
  double longest_side() const { return is_empty() ? 0 : std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

}  // namespace delfront
