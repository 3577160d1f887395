// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief A cube of an octree (in the plane a square), by its place in units of its own side.
struct OctreeLeaf {
  std::array<std::uint32_t, 3> at{};
  int level = 0;
  std::array<std::uint32_t, 8> corner{};  ///< numbers of corners, x fastest; in the plane the first four
  double low = 0;                         ///< a lower bound of the size in it
};

struct SizeOctreeOptions {
  double sizes_per_leaf = 2;  ///< a leaf is at most this many of its least size wide …
  double flat = 1.05;         ///< … but where sizes in it are within this ratio
  /// Where sizes rise by more than this with distance, leaves are at most `sizes_per_steep_leaf` wide. Infinite:
  /// nowhere.
  double slope = 1e300;
  double sizes_per_steep_leaf = 0.5;
  /// The field is known to rise by no more than this with distance: bounds by the sizes at corners then help where the
  /// field's own are poor.
  double rises_at_most = std::numeric_limits<double>::infinity();
  std::size_t max_leaves = 4'000'000;  ///< no level is begun that could pass this
};

/// @brief Cubes as large as a size field allows: what is summed up, drawn or sampled is as fine as the grid would be.
/// Those on the upper sides of the domain end there, so that the field is never asked beyond it.
///
/// Lower bounds decide what is cut, so nothing that a field says is missed between samples.
/// @par Cost  leaves are a few hundredths of the cells that the field asks for
class SizeOctree {
 public:
  /// @param domain  not empty; flat along z in the plane
  SizeOctree(const SizeField& size, const Box& domain, const SizeOctreeOptions& options, Context& context);

  int dimension() const { return dimension_; }
  int num_corners() const { return 1 << dimension_; }
  const std::vector<OctreeLeaf>& leaves() const { return leaves_; }
  const std::vector<Point>& corners() const { return corners_; }
  const std::vector<double>& corner_sizes() const { return corner_sizes_; }
  bool is_cut_short() const { return is_cut_short_; }  ///< max_leaves was in the way

  double side(const OctreeLeaf& leaf) const;
  Box box(const OctreeLeaf& leaf) const;
  /// @brief Whether sizes at two corners differ by more than `slope` times their distance, or may do in between.
  bool is_steep(const OctreeLeaf& leaf) const;

 private:
  static constexpr int kMaxLevel = 20;

  void set_bounds(std::vector<OctreeLeaf>& cells, const SizeField& size, Context& context) const;
  void raise_bounds(std::vector<OctreeLeaf>& cells) const;
  void add_corners(std::vector<OctreeLeaf>& cells, const SizeField& size, Context& context);
  bool is_flat(const OctreeLeaf& leaf, const SizeField& size) const;
  bool is_fine(const OctreeLeaf& leaf, const SizeField& size) const;
  std::vector<OctreeLeaf> halves(const OctreeLeaf& leaf) const;
  std::uint64_t corner_key(const OctreeLeaf& leaf, int corner) const;

  Box domain_;
  double side_ = 0;
  double largest_;  ///< of the field
  int dimension_ = 3;
  SizeOctreeOptions options_;
  std::vector<OctreeLeaf> leaves_;
  std::vector<Point> corners_;
  std::vector<double> corner_sizes_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> corner_of_key_;  ///< sorted
  bool is_cut_short_ = false;
};

}  // namespace delfront
