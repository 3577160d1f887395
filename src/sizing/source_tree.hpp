// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/context.hpp"
#include "sizing/size_law.hpp"
#include "sizing/source_shapes.hpp"

namespace delfront {

/// @brief What a source asks for: factor * law(distance to shape).
struct alignas(64) SourceTerm {
  PlacedShape shape;
  LimitedLaw law;
  double factor = 1;

  double operator()(Point p) const { return factor * law(shape.distance(p)); }
  /// @return a lower bound over a box
  double lower_bound(const Box& box) const;
};

class SourceTreeBuilder;

/// @brief The least of many terms, exact, by branch and bound in a tree of boxes eight wide.
class SourceTree {
 public:
  SourceTree() = default;
  SourceTree(std::vector<SourceTerm> terms, Context& context);

  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr int kWidth = 8, kBins = 32;
  bool empty() const { return terms_.empty(); }
  std::size_t size() const { return terms_.size(); }
  const SourceTerm& term(std::uint32_t place) const { return terms_[place]; }  ///< in the order of the tree
  Box box() const;

  /// What a search found, from which the next one near by may start; changes its time only.
  struct Hint {
    std::uint32_t term = kNone;
    int bin = 0;
  };
  /// @brief The least term at p.
  double least(Point p, Hint& hint) const { return least(p, hint, nullptr, kNoBound); }
  /// @brief The least terms at many places, quickest where neighbours in the list are near in space.
  void least(std::span<const Point> at, std::span<double> size) const;
  /// @brief Lower the given sizes to the least where that is less.
  void lower(std::span<const Point> at, std::span<double> size) const;
  double least_by_scan(Point p) const;
  /// @brief A lower bound over a box, not above the least term at its centre.
  double lower_bound(const Box& box) const;
  /// @brief Numbers (as given) of the terms below `size` somewhere in the box as far as lower bounds tell (at p:
  /// exactly those), ascending.
  std::vector<std::uint32_t> below(const Box& box, double size) const;
  /// A term that may be the least in a box, and what it asks for there at least, rounded down.
  struct Candidate {
    float floor;
    std::uint32_t term;  // see term()
  };
  /// @brief All terms that may be the least somewhere in a box, in ascending order of `floor`.
  /// @param visited  raised by the number of terms looked at
  /// @return false where they are more than `most`, or to find them would take too long; `found` then holds some
  bool candidates(const Box& box, std::size_t most, Hint& hint, std::vector<Candidate>& found,
                  std::size_t& visited) const;
  double largest() const;
  double smallest() const;  ///< the least delta0

 private:
  using Lanes = float __attribute__((vector_size(4 * kWidth)));

  /// Boxes relative to the centre in units of the extent, widened by more than single precision rounds.
  struct alignas(64) Node {
    Lanes low[3], high[3];
    std::uint32_t child[kWidth];  // a node, or a term with kTermBit set
    std::uint32_t turned;         // kNone: none
  };
  /// Boxes with axes of their own, of a node whose children lie flat or along lines: the boxes of Node around them
  /// are much wider, and places far from a curved surface would see hundreds of them as near as the nearest.
  struct alignas(64) TurnedBoxes {
    Lanes axis[3][3], at[3], half[3];  // where |axis . p - at| <= half; axes a little shorter than 1
  };
  /// Distances within which a child may be below a size v: reach - fall * (share of the bin that v lies below its upper
  /// end), never where that is negative.
  struct alignas(64) Reach {
    float reach[kWidth];
    float fall[kWidth];
    Lanes squared(float below) const;
    float squared(std::uint32_t lane, float below) const;
  };
  struct Query {
    float low[3], high[3];
    float middle[3], half[3];
    double best;
    int bin;
    float below;  ///< how far `best` lies below the upper end of its bin, as a share of the bin
  };
  /// A child that may matter in a box; where it stands, for its reach.
  struct Entry {
    float squared;
    std::uint32_t child, parent, lane;
  };
  /// Children that together hold all that matters in a box, below one size.
  struct Frontier {
    static constexpr std::size_t kLanes = 32, kGroups = kLanes / kWidth;
    std::size_t size = 0;
    std::uint64_t filled = 0;  ///< bins whose reaches are there
    Lanes low[kGroups][3], high[kGroups][3], reach[kBins][kGroups], fall[kBins][kGroups];
    Entry entry[kLanes];
  };

  Query start(Point low, Point high, double best, int bin) const;
  void set_best(Query& query, double size) const;
  template <class Visit>
  void search(Query& query, Frontier* frontier, const Visit& visit) const;
  static Lanes squared_distance(const Lanes low[3], const Lanes high[3], const Query& query);
  static Lanes squared_distance(const TurnedBoxes& boxes, const Query& query);
  unsigned near_children(std::uint32_t id, const Reach& reach, const Query& query, Lanes& away) const;
  const Reach* row(int bin) const { return &reaches_[static_cast<std::size_t>(bin) * nodes_.size()]; }
  void prefetch(std::uint32_t child) const;
  void find_frontier(const Query& query, Frontier& frontier) const;
  void fill_reaches(int bin, Frontier& frontier) const;
  static constexpr double kNoBound = std::numeric_limits<double>::infinity();
  /// The least size, or `bound` where none is less.
  double least(Point p, Hint& hint, Frontier* frontier, double bound) const;
  void build(const std::vector<double>* sample, Context& context);
  void take_nodes(const SourceTreeBuilder& builder);
  std::vector<double> sample_sizes() const;

  std::vector<SourceTerm> terms_;      // in the order of the leaves
  std::vector<std::uint32_t> number_;  // as given
  std::vector<Node> nodes_;
  std::vector<TurnedBoxes> turned_;
  std::vector<Reach> reaches_;  // (kBins, nodes): a search stays with few bins
  Point centre_;
  double extent_ = 1, per_extent_ = 1;
  alignas(64) double edge_[kBins] = {};  // sizes, ascending; the last is infinite
  double per_width_[kBins] = {};         // inverse widths of the bins; 0: of no use
};

}  // namespace delfront
