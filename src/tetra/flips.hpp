// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "tetra/quality.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief A connected set of tets and what is to stand in their place: planned first, committed if it is worth it.
struct Retriangulation {
  std::vector<TetIndex> old_tets;
  std::vector<std::array<VertexIndex, 4>> made;  ///< positive
  double worst = 0;                              ///< quality of the worst of `made`
};

/// @brief Exchanges of faces and edges without points: 2-3, 3-2, 4-4 and their larger kin.
///
/// Constrained faces, the edges on them, kept edges, ghosts and tets of other regions are never part of a plan. A plan
/// changes nothing; commit() does, after an exact test of every new tet. All new tets positive, with the hole's
/// boundary kept and the sense of the ring fixed by the old tets, is enough for them to fill the hole without overlap.
class Flips {
 public:
  explicit Flips(TetComplex& complex) : c_(complex) {}

  static constexpr std::size_t kMaxRing = 10;

  /// @brief Remove edge (a, b) of t: the best triangulation of its ring, coned to a and to b.
  /// @param bound  the worst new quality must exceed this (>= 0); give the edge's worst quality now to improve it
  /// @return whether there is one; `plan` is written only then
  /// @par Cost    O(n^3) for a ring of n <= kMaxRing
  /// @par Source  Klincsek (1980); Shewchuk, "Two discrete optimization algorithms ..." (2002)
  bool plan_edge_removal(TetIndex t, VertexIndex a, VertexIndex b, double bound, Retriangulation& plan);

  /// @brief Remove face `ref` (2-3), and with it those neighbours sandwiched between the same two apices without which
  /// the result would not exceed `bound` (multi-face removal).
  bool plan_face_removal(FaceRef ref, double bound, Retriangulation& plan);

  /// @brief The best plan that removes an edge or a face of t; a first one above `enough` is taken at once.
  bool plan_best(TetIndex t, double bound, double enough, Retriangulation& plan);

  /// @brief Make it so, if every new tet is positive by the exact predicate; otherwise nothing changes.
  /// @param[out] new_tets  in the order of plan.made
  bool commit(const Retriangulation& plan, std::vector<TetIndex>& new_tets);

 private:
  bool collect_ring(TetIndex t, VertexIndex a, VertexIndex b);
  void measure_ring_triangles(VertexIndex a, VertexIndex b);
  double fill_table(double bound);
  void add_polygon(std::size_t i, std::size_t j, VertexIndex a, VertexIndex b, Retriangulation& plan) const;
  std::array<std::uint8_t, 6> order_edges(TetIndex t) const;
  double replace_face_edge(FaceRef below, FaceRef above, VertexIndex p, VertexIndex q, double bound, int depth);

  TetComplex& c_;
  std::vector<TetIndex> ring_;
  std::vector<VertexIndex> ring_vertex_;
  FaceBatch faces_;
  std::vector<double> quality_, quality_below_;
  double best_[kMaxRing][kMaxRing] = {};  ///< worst quality of the best triangulation of ring vertices i ... j
  std::uint8_t split_[kMaxRing][kMaxRing] = {};
  Retriangulation trial_;
};

}  // namespace delfront
