// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "delfront/ids.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief Cell types, vertices in VTK's order (prisms: first triangle's normal towards the second).
enum class CellType : std::uint8_t {
  vertex,
  line,
  triangle,
  quad,
  tetrahedron,
  pyramid,
  prism,
  hexahedron,
  polygon,     ///< any number of vertices, by offsets
  polyhedron,  ///< face stream as in VTK: number of faces, then per face its count and vertices; by offsets
};
inline constexpr int kNumCellTypes = 10;

/// @return vertices of a cell of this type; 0 for polygon and polyhedron
int num_vertices(CellType type);
/// @return 0 vertex, 1 line, 2 triangle/quad/polygon, 3 the rest
int dimension(CellType type);
/// @return "triangle", "tetrahedron", …
const char* name_of(CellType type);

/// @brief All cells of one type in one place: `vertices` is (num_cells, num_vertices(type)) row-major.
struct CellBlock {
  CellType type = CellType::tetrahedron;
  std::vector<VertexId> vertices;
  std::vector<std::uint64_t> offsets;  ///< polygon and polyhedron only: num_cells + 1 entries into `vertices`
  std::vector<GroupId> group;  ///< one a cell: the region of a volume cell, the patch of a face, …; may be invalid

  std::size_t size() const;
  std::span<const VertexId> operator[](std::size_t cell) const;
};

/// @brief A named set of cells of one dimension: a patch, a region, a curve.
struct Group {
  std::string name;
  int dimension = 3;  ///< 3: region of volume cells, 2: patch of faces, 1: curve, 0: points
  std::string kind;   ///< boundary kind: "wall", "patch", "farfield", "symmetry", …; empty: patch / region
  bool two_sided =
      false;  ///< faces with cells on both sides (baffles, interfaces): stored once here, writers double them
};

/// @brief Values on vertices or on the cells of one block.
struct Field {
  enum class On : std::uint8_t { vertices, cells };
  std::string name;
  On on = On::vertices;
  CellType block = CellType::tetrahedron;  ///< which block, for cell fields
  int components = 1;
  std::vector<double> values;  ///< (num, components) row-major
};

/// @brief Which entity of the model a vertex lies on, and where on it.
struct VertexEntity {
  std::int8_t dimension = 3;                       ///< 0 corner, 1 curve, 2 patch, 3 region
  std::uint32_t id = Id<struct EntityTag>::kNone;  ///< of that dimension
  double u = 0, v = 0;                             ///< parameters, where the entity has them
};

/// @brief A grid in 2-D or 3-D: points, cells by type, named groups of every dimension, fields.
///
/// Boundary faces are stored once each, as cells of dimension 2 that point out of the region with the lower id.
/// Counts are size_t throughout; one block holds up to 2^32 - 1 vertices.
struct Mesh {
  int dimension = 3;  ///< of the space: in 2-D all z = 0
  Array<VertexId, Point> points;
  std::vector<VertexEntity> vertex_entity;  ///< empty, or one a point
  std::vector<CellBlock> blocks;            ///< at most one a cell type
  Array<GroupId, Group> groups;
  std::vector<Field> fields;

  const CellBlock* find_block(CellType type) const;
  /// @brief The block of this type, made empty where there is none.
  CellBlock& block(CellType type);
  std::size_t num_cells(CellType type) const;
  /// @return cells of all blocks of that dimension
  std::size_t num_cells_of_dimension(int dimension) const;
  /// @return highest dimension of any cell, -1 without cells
  int top_dimension() const;
  GroupId find_group(int dimension, const std::string& name) const;
  /// @brief The group of that dimension and name, added where there is none.
  GroupId add_group(int dimension, const std::string& name, const std::string& kind = "");
  Box bounding_box() const;
};

}  // namespace delfront
