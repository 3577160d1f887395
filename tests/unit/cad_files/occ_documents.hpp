// SPDX-License-Identifier: Apache-2.0
// Files with a unit, or with products, names and colours, by OpenCASCADE itself.
#pragma once
#include <TopoDS_Shape.hxx>
#include <string>

namespace delfront::occ {

/// @brief The unit of shapes in memory and of STEP files that are written: MM, M, INCH, … as OpenCASCADE calls them. To
/// be said before a file is opened.
void set_unit(const std::string& unit);

/// @brief One shape; the file says that its coordinates are in this unit.
void write_step_in(const std::string& unit, const TopoDS_Shape& shape, const std::string& path);

/// @brief An assembly of two products, boxes that touch at x = 1; millimetres.
///
/// "left part": 1 x 1 x 1, its face at x = 0 is called "inlet", those at y = 0 and 1 have the colour FF8000.
/// "right#2": 2 x 1 x 1, its face at x = 3 is called "outlet".
void write_assembly(const std::string& path);

}  // namespace delfront::occ
