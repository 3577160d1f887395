// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/flat_array.hpp"
#include "tetra/tet_complex.hpp"
#include "volume/front_obstacles.hpp"
#include "volume/front_sizes.hpp"

namespace delfront {

/// @brief A face of the front. The side that its normal points to (where orient3d(node, p) > 0) is not gridded yet.
struct FrontFace {
  VertexIndex node[3];
  std::uint32_t next[3];  ///< the next face at node i, as 4 * face + corner
  FaceRef behind;         ///< the same face of the tet (or ghost) behind it
  std::uint32_t region;
  float size;  ///< of the element it would make (F6)
  std::uint16_t tries;
  bool is_boundary;  ///< of the given boundary
  bool is_alive;
  std::uint64_t stamp;  ///< scratch of who looks for what hangs together
};

/// @brief What one worker takes new tets, faces and vertices from.
struct FrontStock {
  SlotStock tets, faces;
  std::vector<std::uint32_t> freed;  ///< faces: not used again before they are given back, since searches hold them
  std::vector<VertexIndex> vertices;
};

/// @brief The front of a complex: its faces, and the faces at each vertex (F5, F8-F10, F13).
///
/// Faces of the front and tets are bonded as they come, so that the complex is whole when the front is empty. Points
/// that no face has any more are not met by any search: the front costs what it has, not what was gridded (F16).
class FrontStore {
 public:
  /// @brief The front is the constrained faces of the complex, all regions are emptied.
  ///
  /// Ghosts stay, for the hull; a face with regions on both sides gets a ghost behind each side of it (a wall), which
  /// join() takes away.
  /// @param field  asked for sizes at embedded points and new vertices, and for directions; may be null in tests of
  /// other things
  explicit FrontStore(TetComplex& complex, const SizeField* field = nullptr);

  TetComplex& complex() { return c_; }
  const TetComplex& complex() const { return c_; }
  /// @brief Embedded edges and points, counted as tets come and go.
  const FrontObstacles& obstacles() const { return obstacles_; }
  FrontSizes& sizes() { return sizes_; }
  const FrontSizes& sizes() const { return sizes_; }
  FrontFrame frame(std::uint32_t f) const { return sizes_.frame(nodes(f)); }
  const FrontFace& face(std::uint32_t f) const { return faces_[f]; }
  FrontFace& face(std::uint32_t f) { return faces_[f]; }
  std::size_t num_slots() const { return faces_.size(); }

  /// @brief First face at a vertex, as 4 * face + corner; kNoIndex: the vertex is not on the front. It may be at an
  /// obstacle all the same.
  std::uint32_t first_at(VertexIndex v) const { return first_[v]; }
  std::uint32_t next_at(std::uint32_t entry) const { return faces_[entry >> 2].next[entry & 3]; }
  Box box(std::uint32_t f) const {
    Box box;
    for (const VertexIndex v : faces_[f].node) box.add(c_.point(v));
    return box;
  }
  /// @brief The live face with these nodes in this orientation (any rotation), or kNoIndex.
  std::uint32_t find(const std::array<VertexIndex, 3>& nodes) const;
  std::array<VertexIndex, 3> nodes(std::uint32_t f) const {
    return {faces_[f].node[0], faces_[f].node[1], faces_[f].node[2]};
  }

  FrontStock take(std::size_t tets);
  void give(FrontStock& stock);

  /// @brief The tet of face f and vertex d: f and the faces of the front that it meets go, its others come (F8-F10).
  /// @param[out] made  the new faces are appended
  /// @pre the tet is positive and crosses nothing
  TetIndex add_tet(std::uint32_t f, VertexIndex d, FrontStock& stock, std::vector<std::uint32_t>& made);
  /// @brief A tet that meets nothing of the front, all of whose faces come.
  void add_island(const std::array<VertexIndex, 4>& nodes, std::uint32_t region, std::vector<std::uint32_t>& made);
  /// @brief Take a tet away again: its faces that have tets or ghosts behind them come, those of the front that it
  /// stood behind go.
  void remove_tet(TetIndex t, std::vector<std::uint32_t>& made);

  /// @brief Make room for what is held by vertex.
  void add_vertex();
  /// @brief Take over the tets of another complex that fills cavities of the front: vertex i there is number[i] here.
  /// @return how many
  std::size_t add_tets(const TetComplex& from, const std::vector<VertexIndex>& number);

  /// @brief Make one complex of it. @pre no face is left
  void join();

 private:
  std::uint32_t add_face(const std::array<VertexIndex, 3>& nodes, FaceRef behind, std::uint32_t region,
                         bool is_boundary, std::uint32_t slot);
  void remove_face(std::uint32_t f);
  std::uint32_t new_slot();

  TetComplex& c_;
  FrontObstacles obstacles_;
  FrontSizes sizes_;
  FlatArray<FrontFace> faces_;
  FlatArray<std::uint32_t> first_;  ///< by vertex
  std::vector<std::uint32_t> free_;
  std::vector<std::array<TetIndex, 2>> walls_;  ///< behind the two sides of inner faces
};

}  // namespace delfront
