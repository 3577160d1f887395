// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "delaunay/ball.hpp"
#include "delaunay/delaunay.hpp"
#include "delfront/context.hpp"

namespace delfront {

/// @brief Inserts weighted points one at a time (Bowyer-Watson with the power test); TetVertex::h is the weight.
///
/// Of vertices at one place only one may be inserted. Nothing depends on the order of insertion but the numbering of
/// tets. @par Source  Edelsbrunner & Shah (1996); perturbation of lifts alone: Devillers & Teillaud (2011)
class RegularKernel {
 public:
  explicit RegularKernel(TetComplex& complex) : c_(complex), walker_(complex) {}

  /// @brief Make the first tet and its ghosts from four vertices that are not coplanar.
  void start(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d);
  /// @brief Insert vertex v, whose place and weight stand in the complex. Vertices that it hides have no tet
  /// afterwards.
  /// @return false where v is hidden itself: nothing changed
  bool insert(VertexIndex v);

  KernelCounts counts() const;

 private:
  bool in_conflict(TetIndex t, VertexIndex v);
  void grow_cavity(TetIndex start, VertexIndex v);
  void fill_cavity(VertexIndex v);

  TetComplex& c_;
  DelaunayKernel walker_;  ///< for its start() and locate(), which know nothing of spheres
  Ball ball_;
  std::vector<TetIndex> cavity_, made_;
  std::vector<FaceRef> border_;  ///< faces of the cavity, from inside
  KernelCounts counts_;
};

}  // namespace delfront
