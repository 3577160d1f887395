// SPDX-License-Identifier: Apache-2.0
// A child at corner k is its parent, halved towards k: its vertices are the middles of k and every corner j. Where that
// does not fill the parent, the rest is listed. Orientation is kept throughout.
#include "refine/child_table.hpp"

#include "delfront/errors.hpp"
#include "mesh/cell_shape.hpp"

namespace delfront {

namespace {

class TableBuilder {
 public:
  explicit TableBuilder(CellType type) : shape_(shape_of(type)) {
    table_.type = type;
    table_.num_corners = num_vertices(type);
    add_nodes();
    for (int k = 0; k < table_.num_corners; ++k) add_corner_child(k);
  }

  ChildTable build() {
    switch (table_.type) {
      case CellType::triangle:
        add(table_.children, {middle(1, 2), middle(2, 0), middle(0, 1)});
        break;
      case CellType::tetrahedron:
        add_inner_tets();
        break;
      case CellType::pyramid:
        add_inside_of_pyramid();
        break;
      case CellType::prism:
        add(table_.children, {middle(1, 2), middle(2, 0), middle(0, 1), middle(1, 5), middle(2, 3), middle(0, 4)});
        add(table_.children, {middle(1, 5), middle(2, 3), middle(0, 4), middle(4, 5), middle(5, 3), middle(3, 4)});
        break;
      default:
        break;
    }
    return table_;
  }

 private:
  void add_nodes() {
    for (int i = 0; i < table_.num_corners; ++i) add_node({i});
    if (table_.type == CellType::line) add_node({0, 1});
    for (int e = 0; e < shape_.num_edges; ++e) add_node({shape_.edges[e][0], shape_.edges[e][1]});
    table_.num_edges = table_.num_nodes - table_.num_corners;
    for (int f = 0; f < shape_.num_facets; ++f)
      if (shape_.facets[f].num_vertices == 4) {
        const auto& v = shape_.facets[f].vertices;
        add_node({v[0], v[1], v[2], v[3]});
        ++table_.num_quads;
      }
    table_.has_centre = table_.type == CellType::quad || table_.type == CellType::hexahedron;
    if (table_.type == CellType::quad) add_node({0, 1, 2, 3});
    if (table_.type == CellType::hexahedron) add_node({0, 1, 2, 3, 4, 5, 6, 7});
  }

  void add_node(std::initializer_list<int> corners) {
    ChildTable::Node& node = table_.nodes[table_.num_nodes++];
    for (const int corner : corners) node.corners[node.num_corners++] = static_cast<std::uint8_t>(corner);
  }

  /// The corner itself, or the node of fewest corners that has both: the middle of an edge, a quad, the cell.
  std::uint8_t middle(int j, int k) const {
    for (int i = 0; i < table_.num_nodes; ++i) {
      bool has_j = false, has_k = false;
      for (int c = 0; c < table_.nodes[i].num_corners; ++c) {
        has_j = has_j || table_.nodes[i].corners[c] == j;
        has_k = has_k || table_.nodes[i].corners[c] == k;
      }
      if (has_j && has_k) return static_cast<std::uint8_t>(i);  // nodes stand in the order of their corners' number
    }
    DELFRONT_CHECK(false && "two corners have a middle");
    return 0;
  }

  static void add(std::vector<ChildTable::Cell>& cells, std::initializer_list<std::uint8_t> nodes) {
    ChildTable::Cell cell{};
    std::size_t i = 0;
    for (const std::uint8_t node : nodes) cell[i++] = node;
    cells.push_back(cell);
  }

  void add_corner_child(int k) {
    ChildTable::Cell cell{};
    for (int j = 0; j < table_.num_corners; ++j) cell[static_cast<std::size_t>(j)] = middle(k, j);
    table_.children.push_back(cell);
  }

  /// The octahedron between the corner tets has three diagonals, from the middle of 0 k to that of the opposite edge.
  void add_inner_tets() {
    constexpr int kTurns[3][3] = {{1, 2, 3}, {2, 3, 1}, {3, 1, 2}};  // even permutations: positive stays positive
    for (std::size_t d = 0; d < 3; ++d) {
      const auto [a, b, c] = kTurns[d];
      const std::uint8_t low = middle(0, a), high = middle(b, c);
      const std::uint8_t ring[4] = {middle(0, b), middle(0, c), middle(a, c), middle(a, b)};
      table_.diagonals[d] = {low, high};
      for (std::size_t i = 0; i < 4; ++i) table_.around_diagonal[d][i] = {low, high, ring[i], ring[(i + 1) % 4]};
    }
  }

  void add_inside_of_pyramid() {
    const std::uint8_t base = middle(0, 2);
    add(table_.children, {middle(0, 4), middle(3, 4), middle(2, 4), middle(1, 4), base});
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4;
      add(table_.tets, {middle(i, j), middle(i, 4), middle(j, 4), base});
    }
  }

  const CellShape& shape_;
  ChildTable table_;
};

}  // namespace

const ChildTable& child_table(CellType type) {
  static const std::vector<ChildTable> tables = [] {
    std::vector<ChildTable> all(kNumCellTypes);
    for (const CellType t : {CellType::line, CellType::triangle, CellType::quad, CellType::tetrahedron,
                             CellType::pyramid, CellType::prism, CellType::hexahedron})
      all[static_cast<std::size_t>(t)] = TableBuilder(t).build();
    return all;
  }();
  return tables[static_cast<std::size_t>(type)];
}

}  // namespace delfront
