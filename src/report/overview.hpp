// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief A picture of a whole grid: its boundary with the sides of its facets, or in the plane its cells.
struct Overview {
  struct Name {
    std::string name, colour;  ///< "#rrggbb"
  };
  std::string png;           ///< empty: there is nothing to draw
  std::vector<Name> names;   ///< of the boundaries that can be seen
  bool is_cut_open = false;  ///< what lies round the body is left out where it hides the body
};

/// @brief Seen from the front, the right and above, z up; in the plane from z.
///
/// What is looked at is the body: boundaries of kind wall where others have the kinds of far ones; without kinds those
/// that do not touch the box of all. The rest is drawn where it lies behind.
/// @par Cost  O(boundary + dots), some tenths of a second for a million facets
Overview draw_overview(const Mesh& mesh, int width = 800, int height = 500);

}  // namespace delfront
