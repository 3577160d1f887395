// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

/// @brief One value a cell of the highest dimension, in the order of CellRange; NaN where a cell has none.
struct CellValues {
  std::string name;  ///< "min_dihedral", …, as in QualityReport; "volume" ("area" in the plane) and "size"
  std::string unit;  ///< "deg" or ""
  bool is_quality = true, worst_is_low = true;
  double range_low = 0, range_high = 0;  ///< of a legend; equal: that of the values
  std::vector<float> values;
};

/// @brief The measures of measure_quality for each cell, not only for the worst.
///
/// Of measures of facets (max_nonortho, skewness, volume_ratio) a cell has that of its worst facet. size is the mean
/// length of its edges. Polygons of more than four corners and polyhedra have no values.
/// @return only measures of which some cell has a value
/// @throws InputError  a cell names a point that is not there
/// @par Cost  O(n); 44 bytes a cell besides the result; the same for any number of threads
std::vector<CellValues> measure_each_cell(const Mesh& mesh, Context& context);

}  // namespace delfront
