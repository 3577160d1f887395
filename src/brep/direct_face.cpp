// SPDX-License-Identifier: Apache-2.0
#include "brep/face_grid.hpp"
namespace delfront {
void grid_directly(const Brep&, const BrepFace&, const Array<EdgeId, EdgePoints>&, const WantedSize&,
                   const BrepOptions&, FaceGrid& grid, Context&) {
  grid.fail("not there", grid.points[0].at);
}
}  // namespace delfront
