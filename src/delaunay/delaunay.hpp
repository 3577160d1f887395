// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/context.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief What the kernel did, for comparison with the floor (5.6 walk steps, 48 in-sphere tests, 28 tets a point).
struct KernelCounts {
  std::uint64_t points = 0, walk_steps = 0, insphere_tests = 0, tets_deleted = 0, tets_created = 0;
};

/// @brief Inserts points one at a time into a TetComplex (Bowyer-Watson), exactly in every degenerate case.
///
/// Constrained faces stop the cavity, which is then reduced until it is star-shaped: with constraints the complex stays
/// valid, Delaunay where the constraints let it. Nothing is allocated per point once the work arrays have grown.
/// @par Source  Bowyer (1981), Watson (1981); perturbation: Devillers & Teillaud (2011)
class DelaunayKernel {
 public:
  explicit DelaunayKernel(TetComplex& complex) : c_(complex) {}

  enum class Insert : std::uint8_t { done, duplicate, outside, too_close, failed };

  /// @brief Make the first tet and its ghosts from four vertices that are not coplanar.
  void start(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d);

  /// @brief The tet that holds p (a ghost where p lies outside of the hull).
  TetIndex locate(const ExactPoint& p, TetIndex hint);

  /// @brief Insert vertex v, whose place stands in the complex already. `hint`: a live tet near it, or kNoIndex.
  /// @param min_distance  > 0: refuse (too_close) where a vertex of the cavity is nearer than this
  Insert insert(VertexIndex v, TetIndex hint, double min_distance = 0);

  KernelCounts counts;
  TetIndex last_tet = kNoIndex;  ///< a live tet made by the last insertion

 private:
  TetComplex& c_;
};

/// @brief Delaunay tetrahedrization of the complex's vertices [first, last), BRIO + Hilbert order.
/// @return for duplicates (equal coordinates): pairs (vertex, the one it equals) are left out and returned
/// @throws InputError  fewer than four points, or all in one plane
std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TetComplex& complex, Context& context);

}  // namespace delfront
