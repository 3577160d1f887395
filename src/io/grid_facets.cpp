// SPDX-License-Identifier: Apache-2.0
#include "io/grid_facets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/grid_parts.hpp"

namespace delfront {

Facets build_facets(const Mesh& mesh, Context& context) {
  Facets facets;
  std::unordered_map<FacetKey, std::uint32_t, FacetKeyHash> known;
  std::uint32_t cell_number = 0;
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == mesh.dimension && cell < block.size(); ++cell, ++cell_number) {
      if (cell % 65536 == 0) context.check_limits();
      for_each_facet(block, cell, [&](std::span<const VertexId> corners) {
        const auto [it, is_new] = known.try_emplace(facet_key(corners), static_cast<std::uint32_t>(facets.all.size()));
        if (is_new) {
          Facet& facet = facets.all.emplace_back();
          std::copy(corners.begin(), corners.end(), facet.corners.begin());
          facet.num_corners = static_cast<int>(corners.size());
          facet.first = cell_number;
          return;
        }
        Facet& facet = facets.all[it->second];
        if (facet.second != Facet::kNone)
          throw InputError(
              fmt::format("a face of cell {} belongs to three cells; the grid is not conforming", facet.first));
        facet.second = cell_number;
      });
    }
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == mesh.dimension - 1 && cell < block.size(); ++cell) {
      const auto found = known.find(facet_key(block[cell]));
      if (found == known.end())
        ++facets.num_loose;
      else
        facets.all[found->second].group = group_of(block, cell);
    }
  return facets;
}

}  // namespace delfront
