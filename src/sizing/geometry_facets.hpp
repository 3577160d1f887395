// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "delfront/geometry_sizes.hpp"
#include "geometry/surface.hpp"

namespace delfront {

/// @brief A symmetric 2 x 2 tensor in a tangent plane.
struct PlaneTensor {
  double xx = 0, xy = 0, yy = 0;
  /// @brief The eigenvalue of largest magnitude, without its sign.
  double largest() const;
};

/// @brief Triangles with normals, edges that turn or do not, and curvature, as the ways of sizing look at them.
class Facets {
 public:
  explicit Facets(const Model& model);

  const Model& model;
  SurfaceEdges edges;
  std::vector<bool> is_used;    ///< by triangle: has an area
  std::vector<Point> normal;    ///< by triangle, unit; zero where there is no area
  std::vector<double> area;     ///< by triangle
  std::vector<double> turn;     ///< by edge: angle between the normals of its two triangles, radians
  std::vector<bool> is_crease;  ///< by edge: turns by more than the feature angle, or no two triangles that agree
  std::vector<bool> is_line;    ///< by edge: a crease, or between patches

  std::size_t num_triangles() const { return normal.size(); }
  Point corner(std::size_t t, std::size_t k) const { return model.points[model.triangles[TriangleId(t)][k]]; }
  std::array<Point, 3> corners(std::size_t t) const { return {corner(t, 0), corner(t, 1), corner(t, 2)}; }
  Point start(std::uint32_t half_edge) const { return corner(half_edge / 3, half_edge % 3); }
  Point end(std::uint32_t half_edge) const { return corner(half_edge / 3, (half_edge + 1) % 3); }
  std::array<Point, 2> ends(std::size_t edge) const {
    return {model.points[edges.ends(edge)[0]], model.points[edges.ends(edge)[1]]};
  }
  double diagonal() const { return diagonal_; }

 private:
  double diagonal_ = 0;
};

/// @brief Curvature of each triangle.
struct Curvature {
  std::vector<double> largest;      ///< by triangle: 1 / r, largest of all directions; 0: flat
  std::vector<PlaneTensor> tensor;  ///< by triangle, in plane_frame() of it
};

/// @brief Two unit vectors that with `normal` make a right-handed frame.
std::array<Point, 2> plane_frame(Point normal);

Curvature compute_curvature(const Facets& facets);

/// @brief A walk over triangles square to a line, to the next line that faces it.
struct PatchCrossing {
  double distance = std::numeric_limits<double>::infinity();  ///< along the surface
  Point at;
  bool found() const { return distance < std::numeric_limits<double>::infinity(); }
};
/// @param t  in (0, 1): where on the half-edge
PatchCrossing cross_patch(const Facets& facets, std::uint32_t half_edge, double t, double largest, double cos_facing);

/// @brief Adds a source, bounded by hmin, and keeps the report.
void add_source(GeometrySources& to, const Simplex& shape, double h, double hmin, const std::string& group);

inline Simplex simplex(Point a) { return {{a, a, a}, 1}; }
inline Simplex simplex(Point a, Point b) { return {{a, b, b}, 2}; }
inline Simplex simplex(const std::array<Point, 3>& corner) { return {corner, 3}; }

/// @throws UsageError  a bound that is negative or no number, hmin > hmax; `word` is the key to name
void check_bounds(const std::string& word, double hmin, double hmax);
/// @return hmin, or where it is 0 the usual share of the diagonal
double usual_hmin(const Facets& facets, double hmin);
inline constexpr double kUsualShare = 1e-3;  ///< hmin, of the diagonal of the box

}  // namespace delfront
