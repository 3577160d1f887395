// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "refine/child_table.hpp"
#include "refine/mid_points.hpp"

namespace delfront {

/// @brief Writes the children of a grid's cells into the blocks of the finer grid, in the order of their parents; the
/// tetrahedra of pyramids behind those of tetrahedra.
class CellSplitter {
 public:
  /// @param coarse, mids  stay
  /// @param fine          its points stand; stays, and gets blocks and their groups here
  CellSplitter(const Mesh& coarse, const MidPoints& mids, Mesh& fine);

  /// @throws InputError  a stored face or line that no cell has
  void split_all(Context& context, std::uint64_t cells_before, std::uint64_t cells_in_all);

  static constexpr unsigned kNumDiagonals = 3;
  /// @brief The inner diagonals of a tetrahedron, the shortest first; of equal ones that with the lower number.
  std::array<unsigned, kNumDiagonals> diagonals_by_length(std::size_t tet) const;
  /// @brief Write the inner children again, round another diagonal.
  void split_tet(std::size_t tet, unsigned diagonal);

  /// @brief One child: its type and vertices.
  struct Child {
    CellType type;
    const VertexId* vertices;
  };
  static constexpr std::size_t kMaxChildren = 10;
  /// @return how many there are
  std::size_t list_children(const CellBlock& parents, std::size_t cell, std::array<Child, kMaxChildren>& list) const;

 private:
  struct Part {
    const CellBlock* parents;
    std::size_t fine_block, tet_block = 0;  ///< in Mesh::blocks
    std::size_t first_tet = 0;              ///< of a pyramid's
  };
  const Part& part_of(CellType type) const;
  void add_blocks();
  void carry_groups(const Part& part);
  void split(const Part& part, std::size_t first, std::size_t last);
  void split_tets(const Part& part, std::size_t first, std::size_t last);
  void find_nodes(const ChildTable& table, const CellBlock& parents, std::size_t cell, std::uint32_t* nodes) const;
  unsigned shortest_diagonal(const ChildTable& table, const std::uint32_t* nodes) const;

  const Mesh& coarse_;
  const MidPoints& mids_;
  Mesh& fine_;
  std::vector<Part> parts_;
};

}  // namespace delfront
