// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/flat_array.hpp"
#include "delfront/mesh.hpp"
#include "refine/child_table.hpp"

namespace delfront {

/// @brief Keys in rows, each row in ascending order, numbered through: finds the number of a key in its row.
template <class Key>
class RowTable {
 public:
  std::size_t size() const { return keys_.size(); }
  std::size_t num_rows() const { return offsets_.empty() ? 0 : offsets_.size() - 1; }
  std::uint32_t first_of_row(std::size_t row) const { return offsets_[row]; }
  std::span<const Key> row(std::size_t i) const { return {keys_.data() + offsets_[i], keys_.data() + offsets_[i + 1]}; }

  /// @return number of the key, or VertexId::kNone
  std::uint32_t find(std::size_t row, const Key& key) const {
    const Key* const begin = keys_.data() + offsets_[row];
    const Key* const end = keys_.data() + offsets_[row + 1];
    const Key* found = begin;
    if (end - begin <= kShort)
      while (found != end && *found < key) ++found;
    else
      found = std::lower_bound(begin, end, key);
    return found != end && *found == key ? static_cast<std::uint32_t>(found - keys_.data()) : VertexId::kNone;
  }

  /// @brief One row more. @pre all keys together are fewer than 2^32 - 1
  void start(std::size_t num_rows, std::size_t num_keys) {
    offsets_.resize(num_rows + 1);
    keys_.resize(num_keys);
    offsets_[0] = 0;
  }
  std::uint32_t* offsets() { return offsets_.data(); }
  Key* keys() { return keys_.data(); }

 private:
  static constexpr std::ptrdiff_t kShort = 24;  ///< keys that are looked through one by one
  FlatArray<std::uint32_t> offsets_;
  FlatArray<Key> keys_;
};

/// @brief The new points of a grid whose edges are halved: after the old ones the middles of edges, then of quads
/// between (or beside) cells in space, then of cells: quads of the highest dimension, hexahedra.
///
/// Edges stand in rows by their lower end, quads by their lowest corner: no hash table, and a cell finds its new points
/// near those of its neighbours.
/// @par Cost  O(n); 4 bytes an edge, 12 a quad, and those of FacetSweep while it is built
class MidPoints {
 public:
  /// @param mesh  indices in range; stays
  /// @throws LimitError  more points than ids
  MidPoints(const Mesh& mesh, int threads);

  std::size_t num_old() const { return num_old_; }
  std::size_t num_points() const { return first_centre_ + num_centres_; }  ///< old and new

  /// @return kNone where it is no edge of a cell
  std::uint32_t of_edge(std::uint32_t u, std::uint32_t v) const {
    const auto [low, high] = std::minmax(u, v);
    const std::uint32_t edge = edges_.find(low, high);
    return edge == VertexId::kNone ? edge : static_cast<std::uint32_t>(num_old_ + edge);
  }
  /// @brief The middle of the quad with these corners, in their order around it.
  std::uint32_t of_quad(const std::array<std::uint32_t, 4>& corners) const;

  /// @brief The numbers of a cell's local nodes. @return false where one is missing: a stored face that no cell has
  bool find_nodes(const ChildTable& table, const VertexId* vertices, std::size_t cell, std::uint32_t* nodes) const;

  /// @brief Calls visit(new point, its corners) for all new points, from several threads.
  template <class Visit>
  void for_each(int threads, const Visit& visit) const;

 private:
  using QuadKey = std::array<std::uint32_t, 3>;  ///< the corners after the lowest: see HalfFacet

  void number_edges(int threads);
  void number_quads(int threads);

  const Mesh& mesh_;
  std::size_t num_old_ = 0, first_quad_ = 0, first_centre_ = 0, num_centres_ = 0;
  const CellBlock* centred_ = nullptr;  ///< the block whose cells have centres
  bool has_quad_faces_ = false;         ///< quads are faces of cells in space
  RowTable<std::uint32_t> edges_;
  RowTable<QuadKey> quads_;
};

}  // namespace delfront

#include "refine/mid_points_inline.hpp"
