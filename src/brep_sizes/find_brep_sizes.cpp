// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "brep_sizes/size_parts.hpp"
#include "delfront/errors.hpp"
#include "delfront/uniform_size.hpp"
#include "sizing/geometry_facets.hpp"

namespace delfront {
namespace {

constexpr double kLookShare = 0.05;   ///< of the extent: sides of the first grid
constexpr double kLeastShare = 1e-3;  ///< of the extent: bends that need shorter ones are not followed

}  // namespace

BrepLook look_at_brep(const Brep& brep, Context& context) {
  check_brep(brep);
  BrepLook look;
  look.extent = measure_extent(brep);
  if (!(look.extent > 0)) throw InputError("the geometry has no extent: all of it is one place");
  BrepOptions how;
  how.checks_crossings = false;
  how.least_size = kLeastShare * look.extent;
  how.keeps_parameters = true;
  Context quiet;  // a look only
  quiet.threads = context.threads;
  quiet.cancel = context.cancel;
  look.grid = grid_brep(brep, UniformSize(kLookShare * look.extent), how, look.report, quiet);
  return look;
}

GeometrySources find_brep_sizes(const Brep& brep, const BrepLook& look, const BrepSizes& wish, Context& context) {
  check_bounds("sizes of the geometry", wish.hmin, wish.hmax);
  if (!(wish.hmin > 0)) throw UsageError("sizes of the geometry: hmin must be above 0");
  const std::vector<FacePiece> pieces = pieces_of(brep, look.grid, look.report);
  GeometrySources found = find_curvature(brep, pieces, wish, context);
  if (wish.line_cells > 0) found.append(find_lines(brep, look.extent, wish, context));
  if (wish.gap_cells > 0) found.append(find_gaps(brep, look.grid, pieces, look.extent, wish, context));
  return found;
}

}  // namespace delfront
