// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/metric.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief Wanted size (and shape) of the cells in space; gridding asks for nothing else.
///
/// Thread-safe, deterministic. Points are best given in space-filling-curve order. A field has an answer everywhere,
/// also outside of what it was made for; an infinite size is a field without an opinion.
class SizeField {
 public:
  virtual ~SizeField() = default;

  /// @brief Wanted side length at each point, model units, > 0; of a metric the least over all directions.
  /// @throws InputError  the field has no valid value there (place and value are named)
  virtual void sizes(std::span<const Point> at, std::span<double> size) const = 0;

  /// @brief Lower the given sizes to those of the field where these are less. A field that can tell early that it has
  /// nothing lower to say overrides this: of many fields few have a say at a place.
  virtual void lower_sizes(std::span<const Point> at, std::span<double> size) const;

  /// @brief Wanted metric at each point. The default is isotropic: size^-2 times the identity.
  virtual void metrics(std::span<const Point> at, std::span<Metric> metric) const;

  /// @brief Whether metrics() says no more than sizes().
  virtual bool is_isotropic() const { return true; }

  /// @brief A lower bound, never violated, of the size over a box; tight where that is cheap, > 0.
  virtual double lower_bound(const Box& box) const = 0;

  /// @brief A value that no size exceeds, infinite where there is none.
  virtual double largest() const { return std::numeric_limits<double>::infinity(); }

  double size(Point at) const {
    double result = 0;
    sizes({&at, 1}, {&result, 1});
    return result;
  }
};

/// @brief field.sizes() for many places, on all threads, in parts between which the run can be stopped.
/// @throws Cancelled, LimitError
void evaluate_sizes(const SizeField& field, std::span<const Point> at, std::span<double> size, const Context& context);

/// @brief Sizes from the boundary (S1), growing into the volume.
///
/// At distance s from a boundary point of size delta1 the size is at most max(delta1, (s (c - 1) + delta1) / c) with
/// c = growth; the field is the minimum over all boundary points, clamped to [hmin, hmax].
struct BoundarySizes {
  std::vector<Point> points;
  std::vector<double> size;  ///< one a point, > 0
  double growth = 1.2;       ///< > 1
  double hmin = 0;
  double hmax = 1e300;
};

/// @par Cost    O(n log n) to build, O(log n) a point
/// @par Source  Löhner (2008), eq. 3.16, 3.17
std::unique_ptr<SizeField> build_boundary_size_field(const BoundarySizes& boundary, Context& context);

/// @brief The minimum of several fields, or the intersection of their metrics, clamped to [hmin, hmax].
/// @param parts  null ones are left out
/// @throws UsageError  hmin > hmax, nothing to combine
std::unique_ptr<SizeField> combine_size_fields(std::vector<std::shared_ptr<const SizeField>> parts, double hmin,
                                               double hmax);

/// @brief Sizes of a field, and lengths of its metrics, times a factor; its bounds too.
/// @throws UsageError  factor not finite and positive
std::shared_ptr<const SizeField> scale_sizes(std::shared_ptr<const SizeField> field, double factor);

/// @brief A field with sizes that rise by at most (growth - 1) / growth with distance: the given one where it keeps to
/// that, else lowered.
///
/// Rises over less than half of the size are seen to as if they took that much; nothing is seen to outside `domain`.
/// @par Cost    a sampling of the field by an octree, then that of one more search of the boundary kind a point
/// @par Source  Löhner (2008), eq. 3.16 to 3.18
std::shared_ptr<const SizeField> limit_growth(std::shared_ptr<const SizeField> field, const Box& domain, double growth,
                                              Context& context);

}  // namespace delfront
