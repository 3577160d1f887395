// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "delfront/context.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief Make (a, b) an edge by switching what lies in its way: faces (2-3) and edges, any of which the segment cuts.
///
/// A switch is kept where the segment cuts less afterwards, and undone otherwise. Required edges and constrained faces
/// stay; every new tet is positive. Between vertices of one flat part of the surface an edge in the way is exchanged
/// for the other diagonal even where a point has to be added above or below it.
/// @return false where that did not succeed; the complex is valid all the same
/// @par Source  George, Borouchaki & Saltel (2003); Si (2015), section 4
class EdgeFlips {
 public:
  static constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

  EdgeFlips(TetComplex& complex, const EdgeSet& required) : c_(complex), required_(required) {}

  /// @param flat  one a vertex: whether it lies in the flat part of the surface that (a, b) runs through
  /// @param most_fills  times that a place for a point is looked for, which takes longer than all else
  bool recover(VertexIndex a, VertexIndex b, const std::vector<bool>& flat, std::size_t most_fills = kAnyNumber);

  /// @brief Switch faces that are not locally Delaunay (2-3, 3-2, 4-4 where flat), until none is left that can be.
  ///
  /// Recovery leaves flat tets with huge spheres behind; insertion by cavity never gets rid of those.
  /// @return switches made
  /// @par Source  Lawson (1977); in space: Joe (1989)
  std::size_t restore_delaunay(Context& context);

 private:
  /// A face that the segment cuts, or an edge that it cuts exactly (`is_edge`: between node[0] and node[1]).
  struct Obstacle {
    FaceRef ref;
    VertexIndex node[3];
    bool is_edge;
  };
  enum class Way { adjacent, blocked, open };

  Way find_obstacles(VertexIndex a, VertexIndex b);
  void add_cut_faces(TetIndex t, VertexIndex a, VertexIndex b, bool& through_vertex);
  bool make_locally_delaunay(FaceRef ref);
  bool improve(VertexIndex a, VertexIndex b);
  bool switch_diagonal(VertexIndex a, VertexIndex b, const std::vector<bool>& flat);
  bool fill_half_from_point(VertexIndex p, VertexIndex q, std::size_t i, std::size_t j);
  bool keep_if_better(VertexIndex a, VertexIndex b, std::size_t before);
  bool switch_face(const Obstacle& at);
  bool switch_edge(TetIndex t, VertexIndex p, VertexIndex q, VertexIndex from, VertexIndex to);
  bool collect_ring(TetIndex t, VertexIndex p, VertexIndex q);
  bool triangulate(VertexIndex p, VertexIndex q, std::size_t i, std::size_t j);
  void replace(const std::vector<TetIndex>& old_tets);

  TetComplex& c_;
  const EdgeSet& required_;
  std::vector<Obstacle> obstacles_, tried_;
  bool may_add_points_ = false;
  std::size_t fills_left_ = kAnyNumber;
  int sideways_ = 0;  ///< switches left that may leave as much in the way as before
  std::vector<TetIndex> ring_, scratch_, visited_, new_tets_;
  std::vector<VertexIndex> polygon_;
  std::vector<std::array<VertexIndex, 4>> made_, undo_;
  std::vector<signed char> known_;  ///< by (i, j): whether that part of the ring can be triangulated; 0 not tried
  std::vector<std::uint8_t> apex_;  ///< by (i, j): how
};

}  // namespace delfront
