// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "base/parallel.hpp"
#include "refine/mid_points.hpp"

namespace delfront {

inline bool MidPoints::find_nodes(const ChildTable& table, const VertexId* vertices, std::size_t cell,
                                  std::uint32_t* nodes) const {
  const auto corner = [&](int node, std::size_t i) { return vertices[table.nodes[node].corners[i]].value; };
  int node = 0;
  for (; node < table.num_corners; ++node) nodes[node] = vertices[node].value;
  std::uint32_t missing = 0;
  for (const int end = node + table.num_edges; node < end; ++node) {
    nodes[node] = of_edge(corner(node, 0), corner(node, 1));
    missing |= nodes[node] == VertexId::kNone;
  }
  const bool is_face = table.type == CellType::quad && has_quad_faces_;
  for (const int end = node + table.num_quads + is_face; node < end; ++node) {
    nodes[node] = of_quad({corner(node, 0), corner(node, 1), corner(node, 2), corner(node, 3)});
    missing |= nodes[node] == VertexId::kNone;
  }
  if (node < table.num_nodes) nodes[node] = static_cast<std::uint32_t>(first_centre_ + cell);
  return missing == 0;
}

template <class Visit>
void MidPoints::for_each(int threads, const Visit& visit) const {
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  using Corners = std::span<const std::uint32_t>;
  parallel_ranges(threads, edges_.num_rows(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      std::size_t point = num_old_ + edges_.first_of_row(row);
      for (const std::uint32_t high : edges_.row(row)) {
        const std::uint32_t ends[2] = {static_cast<std::uint32_t>(row), high};
        visit(point++, Corners(ends));
      }
    }
  });
  parallel_ranges(threads, quads_.num_rows(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      std::size_t point = first_quad_ + quads_.first_of_row(row);
      for (const QuadKey& key : quads_.row(row)) {
        const std::uint32_t corners[4] = {static_cast<std::uint32_t>(row), key[0], key[1], key[2]};
        visit(point++, Corners(corners));
      }
    }
  });
  parallel_ranges(threads, num_centres_, kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t cell = first; cell < last; ++cell) {
      std::uint32_t corners[8];
      std::size_t n = 0;
      for (const VertexId v : (*centred_)[cell]) corners[n++] = v.value;
      visit(first_centre_ + cell, Corners(corners, n));
    }
  });
}

}  // namespace delfront
