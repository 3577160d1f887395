// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief A face of the complex and the model's triangle that it is (a part of), oriented like that triangle.
struct Subface {
  std::array<VertexIndex, 3> node;
  TriangleId triangle;
};

/// @brief A bounded component of space, before it is known whether it is wanted.
struct RegionFacts {
  double volume = 0;
  bool is_hole = false;       ///< its shell's orientation opposes its parent's
  bool is_undecided = false;  ///< flips made that undecidable: taken as a region
  bool touches_far_field = false;
  RegionId declared;  ///< which of the model's regions most of its faces say that it is; invalid: none says so
};

/// @brief Colour the tets by bounded component (0, 1, …; kOutside for what is not enclosed), by flood fill.
///
/// Triangles count the winding: through one against its normal adds one. A component with winding 0 is a hole.
std::vector<RegionFacts> colour_regions(TetComplex& complex, const std::vector<Subface>& subfaces, const Model& model,
                                        const std::vector<bool>& is_far_field, Context& context);

/// @brief Which components are to be gridded (domain.keep, seeds; with a far field only what touches it).
/// @throws InputError  nothing is kept; a seed lies outside of everything
std::vector<bool> choose_regions(const TetComplex& complex, const std::vector<RegionFacts>& facts,
                                 const DomainOptions& domain);

/// @brief The order of what is kept: the model's regions in its order, then the others in that of their colours.
/// @return new colours; kOutside for what is not kept
std::vector<std::uint32_t> order_regions(const std::vector<RegionFacts>& facts, const std::vector<bool>& keep);

/// @brief Names in that order: as the model has them, parts of one numbered; the first without a name is "fluid",
/// others are "region_" and their number.
std::vector<std::string> name_regions(const std::vector<RegionFacts>& facts, const std::vector<std::uint32_t>& order,
                                      const Model& model);

/// @brief Remove the tets whose new colour is kOutside: ghosts stand on the border of the rest.
void strip_outside(TetComplex& complex, const std::vector<std::uint32_t>& new_colour);

}  // namespace delfront
