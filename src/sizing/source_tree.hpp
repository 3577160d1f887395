// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "delfront/context.hpp"
#include "sizing/size_law.hpp"
#include "sizing/source_shapes.hpp"

namespace delfront {

/// @brief What a source asks for: factor * law(distance to shape).
struct SourceTerm {
  PlacedShape shape;
  LimitedLaw law;
  double factor = 1;

  double operator()(Point p) const { return factor * law(shape.distance(p)); }
  /// @return a lower bound over a box
  double lower_bound(const Box& box) const;
};

/// @brief The least of many terms, exact, by branch and bound in a tree of boxes eight wide.
class SourceTree {
 public:
  SourceTree() = default;
  SourceTree(std::vector<SourceTerm> terms, Context& context);

  static constexpr std::uint32_t kNone = 0xffffffffu;
  bool empty() const { return terms_.empty(); }

  /// @brief The least term at p, or `best` where none is below it.
  /// @param[in,out] hint  a term (by its place in the tree) that may be the least, or kNone; which one it was
  double least(Point p, double best, std::uint32_t& hint) const;
  double least_by_scan(Point p) const;
  /// @brief A lower bound over a box, not above the least term at its centre.
  double lower_bound(const Box& box) const;
  /// @brief Numbers (as given) of the terms below `size` somewhere in the box as far as lower bounds tell (at p:
  /// exactly those), ascending.
  std::vector<std::uint32_t> below(const Box& box, double size) const;
  double largest() const;
  double smallest() const;  ///< the least delta0

 private:
  static constexpr int kWidth = 8;
  static constexpr int kBins = 32;
  using Lanes = float __attribute__((vector_size(4 * kWidth)));

  /// Boxes relative to the centre in units of the extent, widened by more than single precision rounds.
  struct Node {
    Lanes low[3], high[3];
    std::uint32_t child[kWidth];  // a node, or a term with kTermBit set
  };
  struct Reach {
    Lanes squared[kBins];  // within which a child may be below the size of the bin; negative: never
  };
  struct Query {
    float low[3], high[3];
    double best;
    int bin;
  };
  struct Builder;

  Query start(const Box& box, double best) const;
  int bin_of(double size) const;
  template <class Visit>
  void search(Query& query, const Visit& visit) const;
  std::vector<double> sample_sizes() const;

  std::vector<SourceTerm> terms_;      // in the order of the leaves
  std::vector<std::uint32_t> number_;  // as given
  std::vector<Node> nodes_;
  std::vector<Reach> reaches_;
  Point centre_;
  double extent_ = 1;
  alignas(64) double edge_[kBins] = {};  // sizes, ascending; the last is infinite
};

}  // namespace delfront
