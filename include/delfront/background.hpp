// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief A grid whose nodes hold the wanted sizes (S6), and which of its node fields say what.
///
/// Tetrahedra; other volume cells are split into tetrahedra. In the plane (all z = 0, no volume cells) triangles, other
/// faces are split; the sizes then hold for every z.
/// Names: of the size alone; of a metric; of a size and stretchings. With a size and a metric a node has the
/// intersection of the two. With no name at all the only node field is taken, by its number of components.
struct BackgroundGrid {
  Mesh mesh;
  std::string name = "background grid";  ///< of the file, for messages
  std::string size;                      ///< 1 component: wanted side length, model units
  /// 6 components xx yy zz xy yz xz (VTK), or 9; in the plane also 3: xx xy yy, or 4
  std::string metric;
  std::string s1, s2;      ///< stretchings, 1 component each; s2 may be empty: 1
  std::string direction1;  ///< 3 components, any length; needed with s1
  std::string direction2;  ///< with s2; at right angles to the first within 1e-3
  bool has_stretchings() const { return !s1.empty() || !s2.empty(); }
};

struct BackgroundOptions {
  double factor = 1;                                                ///< all sizes times this
  double hmin = 0, hmax = std::numeric_limits<double>::infinity();  ///< limits, after `factor`
  /// Isotropic: the result is the largest field with slope (growth - 1) / growth everywhere, also across holes, that is
  /// nowhere above the field without it. Metrics: the same rise along the edges of the grid for each axis.
  double growth = std::numeric_limits<double>::infinity();
};

/// @brief Sizes from a background grid: in a cell linear (metrics: log-Euclidean mean), outside the value of the
/// nearest point of the boundary.
///
/// The same value bit for bit whatever was asked before. With a growth, in a hole or a pocket of a grid that is not
/// convex: the largest field with that slope below the values of the grid, which rises from the rim, but not above the
/// largest node.
class BackgroundField : public SizeField {
 public:
  /// @return the share of the points that lie outside of the grid, 0 … 1; 0 without points
  virtual double share_outside(std::span<const Point> points) const = 0;
  /// @brief The box of all cells; in the plane without end in z.
  virtual Box box() const = 0;
  /// @throws InputError  the grid's box and `domain` have no place in common (both are named)
  virtual void require_overlap(const Box& domain) const = 0;
};

/// @throws InputError  no cells that fill space, a size that is not finite and positive, a metric that is not positive
///                     definite (node and place are named), wrong number of components
/// @throws UsageError  no such field (those that are there are named), options out of range
/// @par Cost    O(n log n) to build; about 1 µs a point in space-filling-curve order; thread-safe
/// @par Source  Löhner (2008), 3.2.3; growth: an exact form of the H-correction of Borouchaki, Hecht, Frey (1998)
std::unique_ptr<BackgroundField> build_background_size_field(const BackgroundGrid& grid,
                                                             const BackgroundOptions& options, Context& context);

}  // namespace delfront
