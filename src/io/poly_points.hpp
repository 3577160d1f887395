// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "delfront/mesh.hpp"
#include "io/cursor.hpp"

namespace delfront {

/// @brief The points of a .poly, one a line: its number, `dimension` coordinates (the others are 0), anything.
/// @return the number of the first, 0 or 1
/// @throws InputError  not numbered one after the other, or from neither 0 nor 1
std::int64_t read_poly_points(Cursor& cursor, std::size_t num_points, int dimension, Mesh& mesh);

}  // namespace delfront
