// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "delfront/metric.hpp"
#include "delfront/point.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Size as a function of the distance r from a source; rho = max(0, (r - r0) / r1).
/// @par Source  Löhner (2008), eq. 3.10 to 3.13
struct SizeLaw {
  enum class Kind : std::uint8_t {
    step,         ///< delta0 for r <= r0, no bound beyond it
    power,        ///< delta0 (1 + rho^gamma)
    exponential,  ///< delta0 e^(gamma rho)
    polynomial,   ///< delta0 (1 + sum a_i rho^i), i from 1
  };
  Kind kind = Kind::power;
  double delta0 = 1;               ///< > 0
  double r0 = 0;                   ///< >= 0, within it the size is delta0
  double r1 = 1;                   ///< > 0, scaling length
  double gamma = 1;                ///< > 0
  std::vector<double> polynomial;  ///< a_1, a_2, …; the law must not decrease

  /// @return the size at distance r >= 0; infinite where the law says nothing (step) or overflows
  double size_at(double r) const;
};

/// @throws UsageError  what is wrong with the law: r1 = 0, r0 < 0, delta0 <= 0, a law that decreases (and where), …
/// Whether a polynomial decreases is decided by the roots of its derivative, to rounding: a dip below 1e-12 of the
/// value is let pass.
void check_law(const SizeLaw& law);

/// @brief Point, line or triangle; a degenerate one is a legal smaller one, with exact distances (eq. 3.1 to 3.9).
struct Simplex {
  std::array<Point, 3> corner;
  int num_corners = 1;
};
struct AlignedBox {
  Box box;
};
struct SolidSphere {
  Point centre;
  double radius = 0;
};
/// @brief Cylinder or frustum of a cone with flat ends; radius 0 at one end: a cone.
struct Frustum {
  Point from, to;
  double radius_from = 0, radius_to = 0;
};

class FacetSurface;
/// @brief Triangles as one source; a solid is 0 inside too.
struct FacetShape {
  std::shared_ptr<const FacetSurface> surface;
};
/// @param is_solid  the surface is closed, and all that it encloses (an odd number of times) is at distance 0
/// @throws InputError  no triangle, a coordinate not finite; a solid with an edge of an odd number of triangles (place)
/// @par Cost  O(n log n); then about O(log n) a distance, and the triangles on a line for inside, decided exactly
std::shared_ptr<const FacetSurface> build_facet_surface(std::vector<std::array<Point, 3>> triangles, bool is_solid);

/// @brief What a source is: distance 0 on it and, for solids, inside it.
using SourceShape = std::variant<Simplex, AlignedBox, SolidSphere, Frustum, FacetShape>;

/// @throws UsageError  a shape that is none: a coordinate not finite, a negative radius, a cylinder without an axis, …
void check_shape(const SourceShape& shape);

/// @return exact distance to rounding, for coordinates within 1e-140 … 1e140
double distance_to(const SourceShape& shape, Point at);

/// @brief Where a body is at a time: turned about an axis through `centre` by rate * time, then moved by velocity *
/// time.
struct Motion {
  Point velocity;           ///< model units a time unit
  Point centre, axis;       ///< axis of any length; zero: no turning
  double degrees_rate = 0;  ///< degrees a time unit, right-handed about the axis

  Point at(double time, Point point) const;          ///< where a point of the body is
  Point turned(double time, Point direction) const;  ///< where a direction of the body points to
};

struct SizeSource {
  SourceShape shape;
  SizeLaw law;
  std::optional<Stretching> stretching;  ///< constant in space; the law is that of delta
  std::optional<Motion> motion;
  std::string group;  ///< name for messages and for switching on and off
};

/// @brief Those sources whose group matches a pattern with * (any text) and ? (any one character), in order.
std::vector<SizeSource> select_sources(std::span<const SizeSource> sources, const std::string& pattern);

enum class SourceSearch : std::uint8_t {
  automatic,  ///< the quicker one as measured in docs/sizes/sources.md
  scan,       ///< every source for every point
  tree,       ///< branch and bound in a tree of boxes
  lists,      ///< an octree with the sources that matter in each cell; the tree where they are many
};

struct SourceFieldOptions {
  /// Sizes rise with the distance from any place by at most (growth - 1) / growth: laws that rise faster are cut to
  /// that (neighbours then keep the growth). Infinity: laws as they are.
  double growth = std::numeric_limits<double>::infinity();
  double time = 0;                                ///< for sources that move
  SourceSearch search = SourceSearch::automatic;  ///< changes the time, never a bit of a result
  Box domain = {};  ///< of `lists`: where most places will lie; empty: the box of the sources, half as wide again
};

/// @brief The minimum over any number of sources (S3, S4, S5; eq. 3.14), exact, at a cost that grows like the logarithm
/// of their number. Metrics: the intersection of those of the sources with stretchings, and of the minimum of the rest.
/// With stretchings `sizes` is the least size of that metric, and the growth is that of each source's delta.
/// @throws UsageError  no source, or a bad one (its number and group are named)
/// @par Cost  O(n log n) to build, about O(log n) a point, best in space-filling-curve order; with stretchings also
/// O(those that are smaller, in their least direction, than what the others allow in any)
std::unique_ptr<SizeField> build_source_size_field(std::vector<SizeSource> sources, const SourceFieldOptions& options,
                                                   Context& context);

/// @brief Sizes of a field smoothed on a background grid: a diffusion problem for log(size), with the field as data
/// (3.2.3), then lowered so that no edge grows faster than `growth` and no node exceeds the field (3.14).
/// @param growth  > 1; along an edge sizes differ by at most (growth - 1) / growth of its length
/// @return one size a vertex of the grid; infinite where the field is on the whole connected piece
/// @throws UsageError  growth <= 1 or not finite  @throws InputError  a cell without a fixed shape, a bad coordinate
/// @par Cost  O(n log n)
std::vector<double> smooth_sizes(const Mesh& grid, const SizeField& sources, double growth, Context& context);

}  // namespace delfront
