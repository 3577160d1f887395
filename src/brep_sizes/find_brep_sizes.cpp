// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include "brep_sizes/size_parts.hpp"
#include "delfront/errors.hpp"
#include "delfront/size_field.hpp"
#include "sizing/geometry_facets.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

constexpr double kLookShare = 0.05;   ///< of the body's extent: sides of the first grid
constexpr double kLookGrowth = 0.2;   ///< of them, a length away from the body
constexpr double kLeastShare = 1e-3;  ///< of the body's extent: bends that need shorter ones are not followed

/// Sizes of the first grid: fine on the body, coarser outside of its ball.
class LookSize final : public SizeField {
 public:
  explicit LookSize(const BrepExtent& extent) : extent_(extent) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = size_at(distance(at[i], extent_.body_centre));
  }
  double lower_bound(const Box& box) const override {
    return size_at(std::sqrt(squared_distance(extent_.body_centre, box)));
  }
  double largest() const override { return kLookShare * extent_.whole; }

 private:
  double size_at(double from_centre) const {
    return std::min(largest(),
                    kLookShare * extent_.body + kLookGrowth * std::max(0.0, from_centre - 0.5 * extent_.body));
  }
  BrepExtent extent_;
};

}  // namespace

BrepLook look_at_brep(const Brep& brep, Context& context) {
  check_brep(brep);
  BrepLook look;
  look.extent = measure_extent(brep);
  if (!(look.extent.whole > 0)) throw InputError("the geometry has no extent: all of it is one place");
  BrepOptions how;
  how.checks_crossings = false;
  how.least_size = kLeastShare * look.extent.body;
  how.keeps_parameters = true;
  Context quiet = context.for_a_piece();
  look.grid = grid_brep(brep, LookSize(look.extent), how, look.report, quiet);
  return look;
}

GeometrySources find_brep_sizes(const Brep& brep, const BrepLook& look, const BrepSizes& wish, Context& context) {
  check_bounds("sizes of the geometry", wish.hmin, wish.hmax);
  if (!(wish.hmin > 0)) throw UsageError("sizes of the geometry: hmin must be above 0");
  const std::vector<FacePiece> pieces = pieces_of(brep, look.grid, look.report);
  GeometrySources found = find_curvature(brep, pieces, wish, context);
  if (wish.line_cells > 0) found.append(find_lines(brep, look.extent.whole, wish, context));
  if (wish.gap_cells > 0) found.append(find_gaps(brep, look.grid, pieces, look.extent.whole, wish, context));
  return found;
}

}  // namespace delfront
