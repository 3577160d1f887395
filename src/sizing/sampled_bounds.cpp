// SPDX-License-Identifier: Apache-2.0
// A tree that halves boxes along their longest side, level by level so that the field is asked for many places at once.
// A leaf has the field at 3 x 3 x 3 places; those in the middle tell how far it is from linear between its corners.
#include "sizing/sampled_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr double kFirstShare = 1.0 / 16;  ///< of the longest side: all boxes are cut down to that
constexpr double kLinear = 0.03;          ///< of the least size: misses of the linear model that are let pass
constexpr std::size_t kManyPlaces = 64;   ///< in one box: it is cut, there may be detail
constexpr std::size_t kMostBoxes = 100'000;
constexpr std::size_t kSamples = 27;
constexpr std::size_t kPart = 1 << 15;  ///< places asked for at once
constexpr double kHuge = 1e150;         ///< stands for infinite sizes

double parameter(double low, double high, double x) {
  return high > low ? std::clamp((x - low) / (high - low), 0.0, 1.0) : 0;
}

struct Node {
  std::uint32_t child = 0;  ///< the first of two; 0: a leaf
  double least = kHuge;     ///< of all samples in it
  double miss = 0;          ///< how far below the linear model samples are
  bool is_linear = true;    ///< as far as they tell
  std::array<double, 8> corner{};

  double linear(Point t) const {
    const auto along_x = [&](std::size_t k) { return corner[k] + t.x * (corner[k + 1] - corner[k]); };
    const double low = along_x(0) + t.y * (along_x(2) - along_x(0));
    const double high = along_x(4) + t.y * (along_x(6) - along_x(4));
    return low + t.z * (high - low);
  }
};

int longest_axis(const Box& box) {
  const Point side = box.high - box.low;
  return side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
}

std::array<Box, 2> halves_of(const Box& box) {
  const int axis = longest_axis(box);
  std::array<Box, 2> halves = {box, box};
  const double middle = 0.5 * (box.low[axis] + box.high[axis]);
  halves[0].high[axis] = halves[1].low[axis] = middle;
  return halves;
}

Point sample_place(const Box& box, std::size_t k) {
  const Point t{0.5 * double(k % 3), 0.5 * double(k / 3 % 3), 0.5 * double(k / 9)};
  const Point side = box.high - box.low;
  return box.low + Point{t.x * side.x, t.y * side.y, t.z * side.z};
}

class SampledBounds final : public SizeField {
 public:
  SampledBounds(std::shared_ptr<const SizeField> field, const Box& domain, std::span<const Point> places,
                Context& context)
      : field_(std::move(field)), domain_(domain) {
    build(places, context);
  }

  void sizes(std::span<const Point> at, std::span<double> size) const override { field_->sizes(at, size); }
  void lower_sizes(std::span<const Point> at, std::span<double> size) const override { field_->lower_sizes(at, size); }
  double largest() const override { return field_->largest(); }

  double lower_bound(const Box& box) const override {
    Box inner = box;
    for (int k = 0; k < 3; ++k) {
      inner.low[k] = std::clamp(box.low[k], domain_.low[k], domain_.high[k]);
      inner.high[k] = std::clamp(box.high[k], domain_.low[k], domain_.high[k]);
    }
    double bound = kHuge;
    lower(0, domain_, inner, bound);
    return std::max(bound, field_->lower_bound(box));
  }

 private:
  /// A box of the level that is being made, and the places in it.
  struct Cell {
    std::uint32_t node = 0;
    Box box;
    std::vector<Point> places;
  };

  void build(std::span<const Point> places, Context& context) {
    std::vector<Cell> cells = {{0, domain_, {}}};
    for (const Point& p : places)
      if (domain_.overlaps({p, p})) cells[0].places.push_back(p);
    nodes_.emplace_back();
    bool is_cut_short = false;
    while (!cells.empty()) {
      context.progress("sizes", nodes_.size(), 0, "boxes");
      sample(cells, context);
      std::vector<Cell> finer;
      for (Cell& cell : cells) {
        if (!is_to_be_cut(cell)) continue;
        is_cut_short |= nodes_.size() + 2 > kMostBoxes;
        if (!is_cut_short) cut(std::move(cell), finer);
      }
      cells = std::move(finer);
    }
    for (std::size_t i = nodes_.size(); i-- > 0;)
      if (const std::uint32_t c = nodes_[i].child; c != 0)
        nodes_[i].least = std::min(nodes_[c].least, nodes_[c + 1].least);
  }

  void sample(const std::vector<Cell>& cells, Context& context) {
    std::vector<Point> at(kSamples * cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (std::size_t k = 0; k < kSamples; ++k) at[kSamples * i + k] = sample_place(cells[i].box, k);
    std::vector<double> size(at.size());
    for (std::size_t first = 0; first < at.size(); first += kPart) {
      context.check_limits();
      const std::size_t n = std::min(kPart, at.size() - first);
      field_->sizes({at.data() + first, n}, {size.data() + first, n});
    }
    for (std::size_t i = 0; i < cells.size(); ++i) set(nodes_[cells[i].node], size.data() + kSamples * i);
  }

  static void set(Node& node, const double* size) {
    std::array<double, kSamples> h{};
    for (std::size_t k = 0; k < kSamples; ++k) h[k] = std::min(size[k], kHuge);
    node.least = *std::min_element(h.begin(), h.end());
    for (std::size_t c = 0; c < 8; ++c) node.corner[c] = h[2 * (c & 1) + 6 * (c >> 1 & 1) + 18 * (c >> 2)];
    for (std::size_t k = 0; k < kSamples; ++k) {
      const Point t{0.5 * double(k % 3), 0.5 * double(k / 3 % 3), 0.5 * double(k / 9)};
      const double above = h[k] - node.linear(t);
      node.miss = std::max(node.miss, -above);
      node.is_linear = node.is_linear && std::abs(above) <= kLinear * node.least;
    }
  }

  bool is_to_be_cut(const Cell& cell) const {
    const Node& node = nodes_[cell.node];
    const int axis = longest_axis(cell.box);
    const double side = cell.box.high[axis] - cell.box.low[axis];
    if (side > kFirstShare * domain_.longest_side()) return true;
    if (side <= 0.5 * node.least) return false;
    return !node.is_linear || cell.places.size() > kManyPlaces;
  }

  void cut(Cell cell, std::vector<Cell>& finer) {
    const std::array<Box, 2> halves = halves_of(cell.box);
    const int axis = longest_axis(cell.box);
    nodes_[cell.node].child = static_cast<std::uint32_t>(nodes_.size());
    for (std::size_t h = 0; h < 2; ++h) {
      Cell half{static_cast<std::uint32_t>(nodes_.size()), halves[h], {}};
      for (const Point& p : cell.places)
        if ((p[axis] < halves[1].low[axis]) == (h == 0)) half.places.push_back(p);
      nodes_.emplace_back();
      finer.push_back(std::move(half));
    }
  }

  void lower(std::uint32_t index, const Box& box, const Box& asked, double& bound) const {
    const Node& node = nodes_[index];
    if (!box.overlaps(asked) || 0.5 * node.least >= bound) return;
    if (node.child != 0) {
      const std::array<Box, 2> halves = halves_of(box);
      lower(node.child, halves[0], asked, bound);
      return lower(node.child + 1, halves[1], asked, bound);
    }
    double least = kHuge;  // a function that is linear in each coordinate is least at a corner
    for (int c = 0; c < 8; ++c) {
      Point t;
      for (int k = 0; k < 3; ++k) t[k] = parameter(box.low[k], box.high[k], (c >> k & 1 ? asked.high : asked.low)[k]);
      least = std::min(least, node.linear(t));
    }
    bound = std::min(bound, node.is_linear ? std::max(least - node.miss, 0.5 * node.least) : node.least);
  }

  std::shared_ptr<const SizeField> field_;
  Box domain_;
  std::vector<Node> nodes_;
};

}  // namespace

std::shared_ptr<const SizeField> sample_bounds(std::shared_ptr<const SizeField> field, const Box& domain,
                                               std::span<const Point> places, Context& context) {
  DELFRONT_CHECK(field && !domain.is_empty());
  return std::make_shared<SampledBounds>(std::move(field), domain, places, context);
}

}  // namespace delfront
