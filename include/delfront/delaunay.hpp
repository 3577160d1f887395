// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace delfront {

/// @brief What the Delaunay kernel did. The floor for random points in space, a point: 5.6 walk steps, 48 in-sphere
/// tests (four for each of 21 tets deleted, less those of faces between them), 28 tets created.
struct KernelCounts {
  std::uint64_t points = 0;
  std::uint64_t walk_steps = 0;
  std::uint64_t insphere_tests = 0;  ///< lanes of the filtered test: four a tet of the cavity
  std::uint64_t exact_tests = 0;     ///< of these, tests that the filter left to exact arithmetic
  std::uint64_t tets_deleted = 0;
  std::uint64_t tets_created = 0;
};

}  // namespace delfront
