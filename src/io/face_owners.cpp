// SPDX-License-Identifier: Apache-2.0
#include "io/face_owners.hpp"

#include <algorithm>

namespace delfront {

FaceOwners::FaceOwners(const Mesh& mesh, bool look_outwards) : look_outwards_(look_outwards) {
  const int top = mesh.top_dimension();
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == top - 1 && top == mesh.dimension && cell < block.size(); ++cell)
      stored_.emplace(facet_key(block[cell]), std::pair(&block, cell));
}

void FaceOwners::offer(std::int64_t element, std::span<const VertexId> cell,
                       std::span<const std::array<int, 4>> faces) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::array<VertexId, 4> all;
    std::size_t n = 0;
    for (const int k : faces[f])
      if (k >= 0) all[n++] = cell[static_cast<std::size_t>(k)];
    const std::span<const VertexId> corners(all.data(), n);
    const FacetKey key = facet_key(corners);
    const auto found = stored_.find(key);
    if (found == stored_.end()) continue;
    const std::span<const VertexId> face = (*found->second.first)[found->second.second];
    const auto at = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), face[0]) - corners.begin());
    const bool runs_along = corners[(at + 1) % n] == face[1] && (face.size() > 2 || at == 0);
    const bool is_same_turn = runs_along == (face.size() == 2 || look_outwards_);
    Owner& best = owner_of_[key];
    if (best.element == 0 || (is_same_turn && !best.is_same_turn))
      best = {element, static_cast<int>(f) + 1, is_same_turn};
  }
}

const FaceOwners::Owner* FaceOwners::find(std::span<const VertexId> corners) const {
  const auto found = owner_of_.find(facet_key(corners));
  return found == owner_of_.end() ? nullptr : &found->second;
}

}  // namespace delfront
