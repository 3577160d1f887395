// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sizing/source_tree.hpp"

namespace delfront {

/// @brief Makes the nodes of a SourceTree, see there.
class SourceTreeBuilder {
 public:
  static constexpr std::size_t kWidth = SourceTree::kWidth, kBins = SourceTree::kBins;
  static constexpr std::uint32_t kTermBit = 0x80000000u;
  struct Node {
    float low[3][kWidth], high[3][kWidth];
    float reach[kBins][kWidth];  // as SourceTree keeps them
    float fall[kBins][kWidth];
    std::uint32_t child[kWidth];
    std::uint32_t turned = SourceTree::kNone;
  };
  struct TurnedBoxes {
    float axis[3][3][kWidth], at[3][kWidth], half[3][kWidth];
  };

  SourceTreeBuilder(const std::vector<SourceTerm>& terms, Point centre, double extent);
  /// @brief Sizes in a geometric row from the least delta0.
  void choose_first_sizes();
  /// @brief Quantiles of the sizes of the field at places of a sample.
  void choose_sizes(std::vector<double> sample);
  /// @return terms in the order of the leaves; a child with kTermBit is a place in it
  std::vector<std::uint32_t> build(bool has_turned_boxes, Context& context);

  const std::array<double, kBins>& edges() const { return edge_; }
  /// @return of bin number b; 0 where it has none
  double width(std::size_t b) const;
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<TurnedBoxes>& turned_boxes() const { return turned_; }

 private:
  static constexpr std::size_t kSamples = 8;  // of the sizes, for the expected work
  static constexpr std::size_t kPlanes = 16;
  struct Item {
    float low[3], high[3];
    float key[4];  // centre, and the first bin that it reaches in
    float reach[kSamples];
    std::uint32_t term;
  };
  struct Cluster {
    std::uint32_t begin = 0, end = 0;
    double cost = 0;
    std::uint32_t size() const { return end - begin; }
  };
  struct Bounds;
  /// Within which distance a set of terms may be below a size, for each bin: see SourceTree::Reach.
  struct Lines {
    float low[3], high[3];
    float reach[kBins], fall[kBins];
    Lines();
    void add(const Lines& other);
  };

  void set_items();
  Lines lines_of(const Item& item) const;
  static void set_child(Node& node, std::size_t lane, const Lines& lines);
  double set_turned_box(TurnedBoxes& boxes, std::size_t lane, const Cluster& cluster) const;
  std::uint32_t add_turned_boxes(const std::vector<Cluster>& parts);
  std::uint32_t build_node(Cluster all, int depth, Lines& lines, Context& context);
  Cluster make_cluster(std::uint32_t begin, std::uint32_t end) const;
  std::uint32_t split(const Cluster& cluster, int depth);

  const std::vector<SourceTerm>& terms_;
  Point centre_;
  double extent_, smallest_;
  std::array<double, kBins> edge_{};
  std::vector<Item> items_;
  std::vector<Node> nodes_;
  bool has_turned_boxes_ = false;
  std::vector<TurnedBoxes> turned_;
};

}  // namespace delfront
