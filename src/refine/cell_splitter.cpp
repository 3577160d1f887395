// SPDX-License-Identifier: Apache-2.0
#include "refine/cell_splitter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 13;    ///< parents a task
constexpr std::size_t kBetween = std::size_t{1} << 20;  ///< parents between two looks at limits
constexpr std::size_t kTetChildren = 8, kPyramidTets = 4;

void put(const ChildTable::Cell& cell, std::size_t n, const std::uint32_t* nodes, VertexId*& out) {
  for (std::size_t i = 0; i < n; ++i) (out++)->value = nodes[cell[i]];
}

[[noreturn]] void fail_loose(const Mesh& mesh, CellType type, std::span<const VertexId> vertices) {
  Place place;
  for (const VertexId v : vertices) {
    place.at = place.at + mesh.points[v] / static_cast<double>(vertices.size());
    place.ids.push_back(v.value);
  }
  throw InputError(fmt::format("a stored {} at ({:.9g}, {:.9g}, {:.9g}) is no side or edge of any cell, so the grid "
                               "cannot be refined; 'delfront check' lists all such places",
                               name_of(type), place.at.x, place.at.y, place.at.z),
                   {place});
}

}  // namespace

CellSplitter::CellSplitter(const Mesh& coarse, const MidPoints& mids, Mesh& fine)
    : coarse_(coarse), mids_(mids), fine_(fine) {
  add_blocks();
  for (const Part& part : parts_) carry_groups(part);
}

/// All blocks first: they move while more are added.
void CellSplitter::add_blocks() {
  for (const CellBlock& block : coarse_.blocks) fine_.block(block.type);
  if (coarse_.num_cells(CellType::pyramid) > 0) fine_.block(CellType::tetrahedron);
  const auto place_of = [&](CellType type) {
    return static_cast<std::size_t>(&fine_.block(type) - fine_.blocks.data());
  };
  for (const CellBlock& block : coarse_.blocks) {
    Part part{&block, place_of(block.type)};
    CellBlock& fine = fine_.blocks[part.fine_block];
    if (block.type == CellType::vertex) {
      fine = block;
      continue;
    }
    const ChildTable& table = child_table(block.type);
    std::size_t num_children = block.size() * table.num_children();
    if (block.type == CellType::tetrahedron) num_children += kPyramidTets * coarse_.num_cells(CellType::pyramid);
    if (block.type == CellType::pyramid) {
      part.tet_block = place_of(CellType::tetrahedron);
      part.first_tet = kTetChildren * coarse_.num_cells(CellType::tetrahedron);
      CellBlock& tets = fine_.blocks[part.tet_block];
      tets.vertices.resize(4 * (part.first_tet + kPyramidTets * block.size()));
    }
    fine.vertices.resize(num_children * static_cast<std::size_t>(table.num_corners));
    parts_.push_back(part);
  }
}

void CellSplitter::carry_groups(const Part& part) {
  const std::vector<GroupId>& parents = part.parents->group;
  if (parents.empty()) return;
  CellBlock& fine = fine_.blocks[part.fine_block];
  const std::size_t n = child_table(part.parents->type).num_children();
  fine.group.resize(fine.size());
  for (std::size_t i = 0; i < parents.size(); ++i) std::fill_n(fine.group.data() + i * n, n, parents[i]);
  if (part.parents->type != CellType::pyramid) return;
  CellBlock& tets = fine_.blocks[part.tet_block];
  tets.group.resize(tets.size());
  for (std::size_t i = 0; i < parents.size(); ++i)
    std::fill_n(tets.group.data() + part.first_tet + i * kPyramidTets, kPyramidTets, parents[i]);
}

const CellSplitter::Part& CellSplitter::part_of(CellType type) const {
  const auto found =
      std::find_if(parts_.begin(), parts_.end(), [type](const Part& p) { return p.parents->type == type; });
  DELFRONT_CHECK(found != parts_.end());
  return *found;
}

void CellSplitter::split_all(Context& context, std::uint64_t cells_before, std::uint64_t cells_in_all) {
  const int top = coarse_.top_dimension();
  std::uint64_t done = cells_before;
  for (const Part& part : parts_) {
    const std::size_t size = part.parents->size();
    for (std::size_t from = 0; from < size; from += kBetween) {
      context.progress("refine", done, cells_in_all, "cells");
      const std::size_t count = std::min(kBetween, size - from);
      parallel_ranges(context.threads, count, kGrain, [&](std::size_t first, std::size_t last) {
        if (part.parents->type == CellType::tetrahedron)
          split_tets(part, from + first, from + last);
        else
          split(part, from + first, from + last);
      });
      const ChildTable& table = child_table(part.parents->type);
      if (dimension(part.parents->type) == top) done += count * (table.num_children() + table.tets.size());
    }
  }
}

void CellSplitter::find_nodes(const ChildTable& table, const CellBlock& parents, std::size_t cell,
                              std::uint32_t* nodes) const {
  const auto n = static_cast<std::size_t>(table.num_corners);
  if (!mids_.find_nodes(table, parents.vertices.data() + cell * n, cell, nodes))
    fail_loose(coarse_, parents.type, parents[cell]);
}

void CellSplitter::split(const Part& part, std::size_t first, std::size_t last) {
  const ChildTable& table = child_table(part.parents->type);
  const auto n = static_cast<std::size_t>(table.num_corners);
  VertexId* out = fine_.blocks[part.fine_block].vertices.data() + first * table.children.size() * n;
  VertexId* tets = nullptr;
  if (!table.tets.empty())
    tets = fine_.blocks[part.tet_block].vertices.data() + 4 * (part.first_tet + first * kPyramidTets);
  for (std::size_t cell = first; cell < last; ++cell) {
    std::uint32_t nodes[ChildTable::kMaxNodes];
    find_nodes(table, *part.parents, cell, nodes);
    for (const ChildTable::Cell& child : table.children) put(child, n, nodes, out);
    for (const ChildTable::Cell& child : table.tets) put(child, 4, nodes, tets);
  }
}

/// The type of nearly all cells: the diagonal by where the points stand.
void CellSplitter::split_tets(const Part& part, std::size_t first, std::size_t last) {
  const ChildTable& table = child_table(CellType::tetrahedron);
  VertexId* out = fine_.blocks[part.fine_block].vertices.data() + 4 * kTetChildren * first;
  for (std::size_t cell = first; cell < last; ++cell) {
    std::uint32_t nodes[ChildTable::kMaxNodes];
    find_nodes(table, *part.parents, cell, nodes);
    for (const ChildTable::Cell& child : table.children) put(child, 4, nodes, out);
    for (const ChildTable::Cell& child : table.around_diagonal[shortest_diagonal(table, nodes)])
      put(child, 4, nodes, out);
  }
}

unsigned CellSplitter::shortest_diagonal(const ChildTable& table, const std::uint32_t* nodes) const {
  double shortest = 0;
  unsigned best = 0;
  for (unsigned d = 0; d < kNumDiagonals; ++d) {
    const auto [low, high] = table.diagonals[d];
    const double squared = squared_length(fine_.points[VertexId(nodes[high])] - fine_.points[VertexId(nodes[low])]);
    if (d > 0 && !(squared < shortest)) continue;
    shortest = squared;
    best = d;
  }
  return best;
}

std::array<unsigned, CellSplitter::kNumDiagonals> CellSplitter::diagonals_by_length(std::size_t tet) const {
  const ChildTable& table = child_table(CellType::tetrahedron);
  std::uint32_t nodes[ChildTable::kMaxNodes];
  find_nodes(table, *part_of(CellType::tetrahedron).parents, tet, nodes);
  std::array<std::pair<double, unsigned>, kNumDiagonals> lengths;
  for (unsigned d = 0; d < kNumDiagonals; ++d) {
    const auto [low, high] = table.diagonals[d];
    lengths[d] = {squared_length(fine_.points[VertexId(nodes[high])] - fine_.points[VertexId(nodes[low])]), d};
  }
  std::sort(lengths.begin(), lengths.end());
  return {lengths[0].second, lengths[1].second, lengths[2].second};
}

void CellSplitter::split_tet(std::size_t tet, unsigned diagonal) {
  const ChildTable& table = child_table(CellType::tetrahedron);
  const Part& part = part_of(CellType::tetrahedron);
  std::uint32_t nodes[ChildTable::kMaxNodes];
  find_nodes(table, *part.parents, tet, nodes);
  VertexId* out = fine_.blocks[part.fine_block].vertices.data() + 4 * (kTetChildren * tet + table.children.size());
  for (const ChildTable::Cell& child : table.around_diagonal[diagonal]) put(child, 4, nodes, out);
}

std::size_t CellSplitter::list_children(const CellBlock& parents, std::size_t cell,
                                        std::array<Child, kMaxChildren>& list) const {
  const ChildTable& table = child_table(parents.type);
  const Part& part = part_of(parents.type);
  const auto n = static_cast<std::size_t>(table.num_corners);
  const VertexId* at = fine_.blocks[part.fine_block].vertices.data() + cell * table.num_children() * n;
  std::size_t count = 0;
  for (; count < table.num_children(); ++count, at += n) list[count] = {parents.type, at};
  if (table.tets.empty()) return count;
  at = fine_.blocks[part.tet_block].vertices.data() + 4 * (part.first_tet + cell * kPyramidTets);
  for (std::size_t i = 0; i < kPyramidTets; ++i, at += 4) list[count++] = {CellType::tetrahedron, at};
  return count;
}

}  // namespace delfront
