// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "tetra/flips.hpp"
#include "tetra/quality.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief Work arrays of optimise_point.
struct SmoothScratch {
  std::vector<double> quality;
  std::vector<Point> gradients;
};

/// @brief Move `p` so that the worst tet (face, p) of a batch gets better: ascent along the shortest vector in the
/// convex hull of the active gradients, with a line search that accepts only a better worst.
/// @param[in,out] p  the apex; also where the search starts
/// @param enough     stop as soon as the worst exceeds this
/// @return the worst quality at p
/// @par Source  Freitag & Ollivier-Gooch (1997); the direction by Gilbert's algorithm (1966)
double optimise_point(const FaceBatch& faces, Point& p, double enough, SmoothScratch& scratch);

/// @brief The operations of local improvement, one at a time on one tet or vertex.
///
/// Each returns whether it changed the complex, and then leaves the tets it made or reshaped in `touched`. A change is
/// made only where the worst quality of what is replaced rises by kGain, which bounds the number of changes; new tets
/// are positive by the exact predicate. Nothing here crosses a constrained face, takes a kept edge away or moves a
/// boundary vertex.
class LocalOperations {
 public:
  explicit LocalOperations(TetComplex& complex) : c_(complex), flips_(complex) {}

  static constexpr double kGain = 1.04;  ///< of the squared sine: 2 % of the sine

  std::vector<TetIndex> touched;

  double quality(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return measure_quality(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(n[3]));
  }

  enum class Swap : std::uint8_t { none, face, edge };
  /// @brief Remove the edge or face of t that leaves the best worst tet.
  Swap swap(TetIndex t, double enough);

  /// @brief Move a free vertex to raise the worst quality around it.
  bool smooth(VertexIndex v, double enough);

  /// @brief Pull a free vertex into the neighbour that leaves the best worst tet; edges stay below kLongest h.
  bool contract(VertexIndex v);

  /// @brief Put a point near t into a cavity grown and a place chosen for the best worst tet, which must reach
  /// `goal` or be clearly better than t; edges stay above kShortest h. Free vertices inside of the cavity are dropped
  /// with it. `is_urgent`: any room will do, and all edges are tried.
  bool insert(TetIndex t, double goal, double enough, bool is_urgent = false);

  std::size_t num_dropped = 0;  ///< vertices lost in cavities of insert()

 private:
  struct HoleFace {
    FaceRef ref;  ///< of the cavity's tet
    double quality;
  };
  bool collect_star(VertexIndex v);
  bool can_grow_across(FaceRef to) const;
  void add_to_cavity(TetIndex t, const Point& p);
  void grow_cavity(const Point& p, double enough);
  void rebuild_hole(std::size_t num_tets, const Point& p);
  Point measure_inwards() const;
  bool insert_at_edge(TetIndex t, const std::uint8_t* e, double bound, double enough);
  bool try_point(Point p, double bound, double enough);
  bool is_far_from_hole(const Point& p, double bound, double of_least) const;
  bool keeps_boundary_vertices();
  bool keeps_edges() const;
  void clear_cavity();
  void commit_insertion(const Point& p);

  TetComplex& c_;
  Flips flips_;
  Retriangulation plan_;
  std::vector<TetIndex> star_;
  std::vector<std::array<VertexIndex, 3>> star_faces_;
  FaceBatch faces_;
  SmoothScratch scratch_;
  std::vector<double> quality_;
  std::vector<VertexIndex> candidates_;
  std::vector<TetIndex> cavity_;
  std::vector<HoleFace> hole_;
  bool is_urgent_ = false;  ///< of the insertion that is being tried
};

}  // namespace delfront
