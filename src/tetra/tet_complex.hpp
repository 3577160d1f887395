// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/flat_array.hpp"
#include "base/hilbert.hpp"
#include "delfront/point.hpp"
#include "predicates/predicates.hpp"
#include "tetra/edge_set.hpp"

namespace delfront {

/// @brief 4 * tet + face; face f is opposite node f.
using FaceRef = std::uint32_t;
/// @brief Index of a tet slot and of a vertex; raw integers inside the engine, for the flat arrays' sake.
using TetIndex = std::uint32_t;
using VertexIndex = std::uint32_t;

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;
/// @brief The vertex at infinity; always node 3 of a ghost tet, so every real tet has four neighbours.
inline constexpr VertexIndex kGhost = 0xffffffffu;

/// @brief Nodes of face f, ordered so that (face nodes, node f) is a positive tet: the face's normal, by the right-hand
/// rule, points towards node f (into the tet).
inline constexpr std::uint8_t kFaceNodes[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
/// @brief The six edges of a tet, as node pairs; edge e and edge 5 - e are opposite.
inline constexpr std::uint8_t kEdgeNodes[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/// @brief For local nodes (i, j) of a tet: the other two (k, l) such that (i, j, k, l) is an even permutation.
inline constexpr std::uint8_t kOtherNodes[4][4][2] = {{{0, 0}, {2, 3}, {3, 1}, {1, 2}},
                                                      {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
                                                      {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
                                                      {{2, 1}, {0, 2}, {1, 0}, {0, 0}}};

/// @brief A vertex: coordinates and wanted size in one aligned load.
struct alignas(32) TetVertex {
  double x, y, z;
  double h = 0;
  Point point() const { return {x, y, z}; }
};

/// @brief Dead slots that one thread makes tets of: some that were used before, and a range that never was.
class SlotStock {
 public:
  SlotStock() = default;
  SlotStock(std::vector<TetIndex> used, TetIndex first, TetIndex end)
      : used_(std::move(used)), next_(first), end_(end) {}

  std::size_t size() const { return used_.size() + (end_ - next_); }
  /// @pre size() > 0
  TetIndex take() {
    if (used_.empty()) return next_++;
    const TetIndex t = used_.back();
    used_.pop_back();
    return t;
  }
  void give(TetIndex t) { used_.push_back(t); }

 private:
  std::vector<TetIndex> used_;
  TetIndex next_ = 0, end_ = 0;
};

/// @brief A tetrahedral complex on flat arrays: what the Delaunay engine builds and improvement edits.
///
/// Invariants: for live tets, neigh[ref] == the ref of the other side and neigh[neigh[ref]] == ref; orient3d of the
/// four nodes is > 0 (ghosts aside, whose node 3 is kGhost and whose face 3 lies on the hull, seen from outside);
/// constrained flags agree on both sides. A dead slot has node[4t] == kNoIndex and kNoIndex in node[4t+1].
class TetComplex {
 public:
  enum Flag : std::uint16_t {
    constrained_0 = 1,  ///< bits 0-3: face f is part of the given boundary
    marked = 1 << 4,    ///< scratch, clear outside of an operation
    dead = 1 << 5,
    visited = 1 << 6,  ///< scratch
    fresh = 1 << 7,    ///< made since the last round (refinement, improvement)
    in_scan = 1 << 8,  ///< scratch of star, find_edge, find_face and replace alone
  };

  FlatArray<TetVertex> vertex;
  FlatArray<std::uint32_t> node;          ///< 4 a tet
  FlatArray<FaceRef> neigh;               ///< 4 a tet
  mutable FlatArray<std::uint16_t> flag;  ///< 1 a tet; mutable: const searches mark with in_scan and clear it
  FlatArray<std::uint32_t> region;        ///< 1 a tet: the colour of its region; kOutside for what is not gridded
  FlatArray<TetIndex> vertex_tet;         ///< one live tet of each vertex, or kNoIndex
  FlatArray<std::uint8_t> on_boundary;    ///< 1 a vertex: 1 where it is a vertex of the given boundary and may not move
  /// Steiner points on boundary segments, held exactly until boundary recovery ends; empty afterwards.
  std::unordered_map<VertexIndex, ExactPoint> segment_points;
  /// Edges inside of regions that must stay: those of embedded curves. Both ends have on_boundary. Edges of constrained
  /// faces need not be here, since the faces hold them. What takes edges away asks keeps_edge(); what only fills the
  /// star of one free vertex again need not, since all edges that could be kept lie on the border of the star.
  EdgeSet kept_edges;

  static constexpr std::uint32_t kOutside = 0xffffffffu;
  static constexpr std::size_t kMaxSlots = std::size_t{1} << 30;  ///< what a FaceRef of 32 bits can tell apart

  std::size_t num_slots() const { return flag.size(); }
  std::size_t num_live() const { return flag.size() - free_.size(); }
  std::size_t num_vertices() const { return vertex.size(); }
  bool is_dead(TetIndex t) const { return flag[t] & dead; }
  bool is_ghost(TetIndex t) const { return node[4 * t + 3] == kGhost; }
  bool keeps_edge(VertexIndex a, VertexIndex b) const {
    return !kept_edges.empty() && a != kGhost && b != kGhost && on_boundary[a] && on_boundary[b] &&
           kept_edges.has(a, b);
  }
  /// @brief A kept edge of these tets that is no edge of the faces that `has_edge(a, b)` knows; else kNoIndex twice.
  template <class HasEdge>
  std::array<VertexIndex, 2> find_lost_edge(std::span<const TetIndex> tets, HasEdge&& has_edge) const {
    if (!kept_edges.empty())
      for (const TetIndex t : tets)
        for (const auto& e : kEdgeNodes) {
          const VertexIndex a = node[4 * t + e[0]], b = node[4 * t + e[1]];
          if (keeps_edge(a, b) && !has_edge(a, b)) return {a, b};
        }
    return {kNoIndex, kNoIndex};
  }
  template <class HasEdge>
  bool loses_kept_edge(std::span<const TetIndex> tets, HasEdge&& has_edge) const {
    return find_lost_edge(tets, has_edge)[0] != kNoIndex;
  }
  bool is_constrained(FaceRef ref) const { return (flag[ref >> 2] >> (ref & 3)) & 1; }
  void set_constrained(FaceRef ref, bool on) {
    const std::uint16_t bit = static_cast<std::uint16_t>(1u << (ref & 3));
    flag[ref >> 2] = static_cast<std::uint16_t>(on ? flag[ref >> 2] | bit : flag[ref >> 2] & ~bit);
  }
  /// @brief Set on both sides.
  void set_constrained_both(FaceRef ref, bool on) {
    set_constrained(ref, on);
    set_constrained(neigh[ref], on);
  }
  Point point(VertexIndex v) const { return vertex[v].point(); }
  PointView places() const {
    return {vertex.empty() ? nullptr : &vertex[0].x, sizeof(TetVertex) / sizeof(double), vertex.size()};
  }

  /// @brief A slot for a new tet: reuses dead ones, last freed first. Its arrays are not cleared but for the flags.
  TetIndex new_tet();
  void kill_tet(TetIndex t);
  /// @brief Take `count` dead slots out of the complex, for a thread to make tets of: give_slots() takes back the rest.
  SlotStock take_slots(std::size_t count);
  void give_slots(SlotStock& stock);
  /// @brief Mark a slot dead without taking it back.
  void bury_tet(TetIndex t) {
    flag[t] = dead;
    set_nodes(t, kNoIndex, kNoIndex, kNoIndex, kNoIndex);
    for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) neigh[ref] = kNoIndex;
  }
  VertexIndex add_vertex(Point p, double h);
  /// @brief The same for vertices: take_vertices() gives numbers that no tet has, for set_vertex(); what is not used
  /// has to be given back, and is taken again first.
  std::vector<VertexIndex> take_vertices(std::size_t count);
  void give_vertices(std::span<const VertexIndex> numbers);
  void set_vertex(VertexIndex v, Point p, double h) { vertex[v] = {p.x, p.y, p.z, h}; }
  /// @pre no tet has it
  void remove_last_vertex() {
    vertex.pop_back();
    vertex_tet.pop_back();
    on_boundary.pop_back();
  }
  void bond(FaceRef a, FaceRef b) {
    neigh[a] = b;
    neigh[b] = a;
  }
  void set_nodes(TetIndex t, VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d) {
    node[4 * t] = a;
    node[4 * t + 1] = b;
    node[4 * t + 2] = c;
    node[4 * t + 3] = d;
  }
  /// @return 0..3; the caller knows that v is a node of t
  int local_index(TetIndex t, VertexIndex v) const {
    for (int i = 0; i < 3; ++i)
      if (node[4 * t + static_cast<unsigned>(i)] == v) return i;
    return 3;
  }
  bool has_vertex(TetIndex t, VertexIndex v) const {
    const std::uint32_t* n = &node[4 * t];
    return n[0] == v || n[1] == v || n[2] == v || n[3] == v;
  }
  /// @brief Nodes of face `ref`, normal into its tet.
  std::array<VertexIndex, 3> face_nodes(FaceRef ref) const {
    const std::uint32_t* n = &node[ref & ~3u];
    const std::uint8_t* f = kFaceNodes[ref & 3];
    return {n[f[0]], n[f[1]], n[f[2]]};
  }

  /// @brief Exact orientation of four vertices, implicit points included.
  int orient(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d) const;
  ExactPoint exact(VertexIndex v) const;

  /// @brief All live tets around v (ghosts included), by breadth-first search from vertex_tet[v].
  void star(VertexIndex v, std::vector<TetIndex>& out) const;
  /// @brief The ring of tets around edge (a, b) of tet t, in rotation order, t first. Tet i is (a, b, p_i, p_i+1) in
  /// positive order, so that its face (a, b, p_i+1) is common with tet i + 1. Ghosts close every ring. Crosses
  /// constrained faces.
  void edge_ring(TetIndex t, VertexIndex a, VertexIndex b, std::vector<TetIndex>& out) const;
  /// @return a tet with both vertices, or kNoIndex
  TetIndex find_edge(VertexIndex a, VertexIndex b, std::vector<TetIndex>& scratch) const;
  /// @return a ref of the face with these three vertices, or kNoIndex
  FaceRef find_face(VertexIndex a, VertexIndex b, VertexIndex c, std::vector<TetIndex>& scratch) const;

  /// @brief Replace a connected set of tets by others that fill the same hole.
  ///
  /// `made` holds vertex quadruples (positive); every face of the hole's boundary must be a face of exactly one of
  /// them, every other face of exactly two. Bonds, constrained flags of the hole's boundary, regions (of the first old
  /// tet), vertex_tet are kept; constrained faces inside the hole are lost: callers do not remove those. New tets get
  /// `fresh`.
  /// @return the new tets, in the order of `made`
  void replace(const std::vector<TetIndex>& old_tets, const std::vector<std::array<VertexIndex, 4>>& made,
               std::vector<TetIndex>& new_tets);

  /// @brief Everything the invariants say, with exact orientations; for tests and debug builds.
  /// @return an empty string, or the first thing that is wrong
  std::string find_defect() const;

 private:
  /// A face that waits for its other side, in replace().
  struct OpenFace {
    std::array<VertexIndex, 3> key;  ///< sorted
    FaceRef ref;                     ///< kNoIndex once matched
    bool constrained;
  };
  void match_face(FaceRef ref, bool constrained);
  void collect_hole(const std::vector<TetIndex>& old_tets);

  std::vector<TetIndex> free_;
  std::vector<VertexIndex> free_vertices_;
  std::vector<OpenFace> open_faces_;       ///< scratch of replace()
  std::vector<std::uint32_t> face_table_;  ///< scratch of replace(): hash table of indices into open_faces_
  std::size_t num_open_ = 0;
};

}  // namespace delfront
