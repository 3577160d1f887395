// SPDX-License-Identifier: Apache-2.0
#include "delfront/mesh.hpp"

namespace delfront {

namespace {
struct TypeFacts {
  int vertices;
  int dimension;
  const char* name;
};
constexpr TypeFacts kTypes[kNumCellTypes] = {
    {1, 0, "vertex"},  {2, 1, "line"},  {3, 2, "triangle"},   {4, 2, "quad"},    {4, 3, "tetrahedron"},
    {5, 3, "pyramid"}, {6, 3, "prism"}, {8, 3, "hexahedron"}, {0, 2, "polygon"}, {0, 3, "polyhedron"},
};
const TypeFacts& facts(CellType type) { return kTypes[static_cast<int>(type)]; }
}  // namespace

int num_vertices(CellType type) { return facts(type).vertices; }
int dimension(CellType type) { return facts(type).dimension; }
const char* name_of(CellType type) { return facts(type).name; }

std::size_t CellBlock::size() const {
  const int n = num_vertices(type);
  if (n > 0) return vertices.size() / static_cast<std::size_t>(n);
  return offsets.empty() ? 0 : offsets.size() - 1;
}

std::span<const VertexId> CellBlock::operator[](std::size_t cell) const {
  const auto n = static_cast<std::size_t>(num_vertices(type));
  if (n > 0) return {vertices.data() + cell * n, n};
  return {vertices.data() + offsets[cell], static_cast<std::size_t>(offsets[cell + 1] - offsets[cell])};
}

const CellBlock* Mesh::find_block(CellType type) const {
  for (const CellBlock& block : blocks)
    if (block.type == type) return &block;
  return nullptr;
}

CellBlock& Mesh::block(CellType type) {
  for (CellBlock& block : blocks)
    if (block.type == type) return block;
  blocks.push_back({type, {}, {}, {}});
  return blocks.back();
}

std::size_t Mesh::num_cells(CellType type) const {
  const CellBlock* found = find_block(type);
  return found ? found->size() : 0;
}

std::size_t Mesh::num_cells_of_dimension(int wanted) const {
  std::size_t sum = 0;
  for (const CellBlock& block : blocks)
    if (delfront::dimension(block.type) == wanted) sum += block.size();
  return sum;
}

int Mesh::top_dimension() const {
  int top = -1;
  for (const CellBlock& block : blocks)
    if (block.size() > 0) top = std::max(top, delfront::dimension(block.type));
  return top;
}

GroupId Mesh::find_group(int wanted, const std::string& name) const {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const GroupId id(i);
    if (groups[id].dimension == wanted && groups[id].name == name) return id;
  }
  return {};
}

GroupId Mesh::add_group(int wanted, const std::string& name, const std::string& kind) {
  if (const GroupId found = find_group(wanted, name); found.is_valid()) return found;
  groups.push_back({name, wanted, kind, false});
  return GroupId(groups.size() - 1);
}

Box Mesh::bounding_box() const {
  Box box;
  for (const Point& p : points) box.add(p);
  return box;
}

}  // namespace delfront
