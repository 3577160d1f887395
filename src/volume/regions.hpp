// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
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

/// @brief Remove the tets that are not kept: ghosts stand on the border of the rest, colours are numbered anew in
/// order.
void strip_outside(TetComplex& complex, const std::vector<bool>& keep);

}  // namespace delfront
