// SPDX-License-Identifier: Apache-2.0
#include "io/poly_points.hpp"

namespace delfront {

std::int64_t read_poly_points(Cursor& cursor, std::size_t num_points, int dimension, Mesh& mesh) {
  std::int64_t first = 1;
  for (std::size_t i = 0; i < num_points; ++i) {
    const std::int64_t index = cursor.integer("index of a point");
    if (i == 0) first = index;
    // subtracted without sign: a first number near the end of the range must not overflow
    if (static_cast<std::uint64_t>(index) - static_cast<std::uint64_t>(first) != i)
      cursor.fail("points are not numbered one after the other");
    Point p;
    for (int k = 0; k < dimension; ++k) p[k] = cursor.number("coordinate of a point");
    cursor.skip_line();
    mesh.points.push_back(p);
  }
  if (first != 0 && first != 1) cursor.fail("points are numbered from neither 0 nor 1");
  return first;
}

}  // namespace delfront
