// SPDX-License-Identifier: Apache-2.0
// A group's entity is that of a vertex inside it: of dimension 3 for a region's, 2 for a patch's, 1 for a curve's.
#include <algorithm>
#include <atomic>

#include "base/parallel.hpp"
#include "refine/boundary_points.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 13;  ///< cells a task

/// Entities by group; the last is that of cells without a group.
std::vector<VertexEntity> entities_of_groups(const Mesh& mesh, int dimension) {
  const VertexEntity unknown{static_cast<std::int8_t>(dimension), Id<struct EntityTag>::kNone, 0, 0};
  std::vector<VertexEntity> result(mesh.groups.size() + 1, unknown);
  for (const CellBlock& block : mesh.blocks) {
    if (delfront::dimension(block.type) != dimension) continue;
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      const GroupId group = block.group.empty() ? GroupId() : block.group[cell];
      VertexEntity& entity = result[group.is_valid() ? group.index() : mesh.groups.size()];
      if (entity.id != unknown.id) continue;
      for (const VertexId v : block[cell])
        if (const VertexEntity& e = mesh.vertex_entity[v.index()]; e.dimension == dimension) entity.id = e.id;
    }
  }
  return result;
}

/// Cells of a lower dimension say what their new points lie on after those of a higher one did. Cells of one dimension
/// that share a point agree, or lie on both sides of something lower: with the lowest id it is the same for any order.
class EntityCarrier {
 public:
  EntityCarrier(const Mesh& coarse, const MidPoints& mids, Mesh& fine) : coarse_(coarse), mids_(mids), fine_(fine) {}

  void carry(int dimension, int threads) {
    const std::vector<VertexEntity> of_group = entities_of_groups(coarse_, dimension);
    for (const CellBlock& block : coarse_.blocks) {
      if (delfront::dimension(block.type) != dimension) continue;
      for (const bool sets_dimension : {true, false})  // first of all cells: then ids can be compared
        parallel_ranges(threads, block.size(), kGrain, [&](std::size_t first, std::size_t last) {
          for (std::size_t cell = first; cell < last; ++cell) {
            const GroupId group = block.group.empty() ? GroupId() : block.group[cell];
            carry_cell(block, cell, of_group[group.is_valid() ? group.index() : of_group.size() - 1], sets_dimension);
          }
        });
    }
  }

 private:
  void carry_cell(const CellBlock& block, std::size_t cell, const VertexEntity& entity, bool sets_dimension) {
    const ChildTable& table = child_table(block.type);
    std::uint32_t nodes[ChildTable::kMaxNodes];
    mids_.find_nodes(table, block[cell].data(), cell, nodes);
    for (int i = table.num_corners; i < table.num_nodes; ++i) {
      VertexEntity& e = fine_.vertex_entity[nodes[i]];
      if (sets_dimension) {
        std::atomic_ref(e.dimension).store(entity.dimension, std::memory_order_relaxed);
        std::atomic_ref(e.id).store(Id<struct EntityTag>::kNone, std::memory_order_relaxed);
      } else {
        std::atomic_ref<std::uint32_t> id(e.id);
        std::uint32_t seen = id.load(std::memory_order_relaxed);
        while (entity.id < seen && !id.compare_exchange_weak(seen, entity.id, std::memory_order_relaxed)) {
        }
      }
    }
  }

  const Mesh& coarse_;
  const MidPoints& mids_;
  Mesh& fine_;
};

/// New points between faces of two patches lie on a curve that has no number.
void mark_patch_borders(const Mesh& coarse, const MidPoints& mids, Mesh& fine) {
  const std::vector<VertexEntity> of_group = entities_of_groups(coarse, 2);
  for (const CellType type : {CellType::triangle, CellType::quad}) {
    const CellBlock* block = coarse.find_block(type);
    for (std::size_t cell = 0; block && cell < block->size(); ++cell) {
      const ChildTable& table = child_table(type);
      std::uint32_t nodes[ChildTable::kMaxNodes];
      mids.find_nodes(table, (*block)[cell].data(), cell, nodes);
      const GroupId group = block->group.empty() ? GroupId() : block->group[cell];
      const std::uint32_t id = of_group[group.is_valid() ? group.index() : of_group.size() - 1].id;
      for (int i = table.num_corners; i < table.num_corners + table.num_edges; ++i) {
        VertexEntity& e = fine.vertex_entity[nodes[i]];
        if (e.dimension == 2 && e.id != id) e = {1, Id<struct EntityTag>::kNone, 0, 0};
      }
    }
  }
}

}  // namespace

void carry_entities(const Mesh& coarse, const MidPoints& mids, Mesh& fine, int threads) {
  if (coarse.vertex_entity.empty()) return;
  fine.vertex_entity = coarse.vertex_entity;
  fine.vertex_entity.resize(mids.num_points());
  EntityCarrier carrier(coarse, mids, fine);
  for (int dimension = coarse.top_dimension(); dimension > 0; --dimension) {
    carrier.carry(dimension, threads);
    if (dimension == 2 && coarse.dimension == 3) mark_patch_borders(coarse, mids, fine);
  }
}

}  // namespace delfront
