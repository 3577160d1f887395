// SPDX-License-Identifier: Apache-2.0
#include "volume/link.hpp"

namespace delfront {

bool find_link(const TetComplex& complex, VertexIndex v, std::vector<TetIndex>& star, std::vector<LinkFace>& link) {
  complex.star(v, star);
  link.clear();
  for (const TetIndex t : star) {
    if (complex.is_ghost(t)) return false;
    const auto at = static_cast<unsigned>(complex.local_index(t, v));
    if ((complex.flag[t] & 15u) & ~(1u << at)) return false;
    link.push_back(complex.face_nodes(4 * t + at));
  }
  return true;
}

}  // namespace delfront
