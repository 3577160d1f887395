// SPDX-License-Identifier: Apache-2.0
#include "sizing/source_tree_builder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace delfront {
namespace {

constexpr float kMargin = 0x1p-19f;   // of boxes, in units of the extent
constexpr double kWiden = 1 + 4e-6;   // of reaches
constexpr float kLeastReach = 1e-6f;  // its square must not vanish
constexpr double kRoom = 1.2;         // places are expected within so many extents of the centre
constexpr int kMedianDepth = 24;      // of nodes; below it clusters are halved only

float rounded_up(double value) {
  const float f = static_cast<float>(value);
  return static_cast<double>(f) >= value ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

/// The upper half of the least such number that is not below `value`.
std::uint16_t upper_half(double value) {
  const auto bits = std::bit_cast<std::uint32_t>(rounded_up(value));
  return static_cast<std::uint16_t>((bits >> 16) + ((bits & 0xffff) != 0 ? 1 : 0));
}

}  // namespace

/// Box and reaches of a set of items.
struct SourceTreeBuilder::Bounds {
  float low[3], high[3], reach[kSamples];
  std::uint32_t count = 0;

  Bounds() {
    std::fill(low, low + 3, std::numeric_limits<float>::infinity());
    std::fill(high, high + 3, -std::numeric_limits<float>::infinity());
    std::fill(reach, reach + kSamples, -1.0f);
  }
  template <class Other>
  void add(const Other& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
    for (std::size_t s = 0; s < kSamples; ++s) reach[s] = std::max(reach[s], other.reach[s]);
  }
  /// How likely it is entered, times the number of items.
  double cost() const {
    double sum = 0;
    for (std::size_t s = 0; s < kSamples; ++s) {
      if (reach[s] < 0 || count == 0) continue;
      double volume = 1;
      for (int k = 0; k < 3; ++k) {
        const double from = std::max(-kRoom, double(low[k]) - double(reach[s]));
        const double to = std::min(kRoom, double(high[k]) + double(reach[s]));
        volume *= std::max(0.0, to - from);
      }
      sum += volume;
    }
    return sum * count;
  }
};

SourceTreeBuilder::SourceTreeBuilder(const std::vector<SourceTerm>& terms, Point centre, double extent)
    : terms_(terms), centre_(centre), extent_(extent), smallest_(std::numeric_limits<double>::infinity()) {
  for (const SourceTerm& term : terms) smallest_ = std::min(smallest_, term.factor * term.law.delta0());
}

void SourceTreeBuilder::choose_first_sizes() {
  for (std::size_t k = 0; k < kBins; ++k) edge_[k] = smallest_ * std::pow(1.15, static_cast<double>(k));
  edge_.back() = std::numeric_limits<double>::infinity();
}

void SourceTreeBuilder::choose_sizes(std::vector<double> sample) {
  std::erase_if(sample, [](double size) { return !std::isfinite(size); });
  std::sort(sample.begin(), sample.end());
  if (sample.empty()) return choose_first_sizes();
  // Above the largest four more, for places farther out, then infinity.
  constexpr std::size_t kQuantiles = kBins - 5;
  for (std::size_t k = 0; k < kQuantiles; ++k) edge_[k] = sample[(k + 1) * (sample.size() - 1) / kQuantiles];
  for (std::size_t k = kQuantiles; k < kBins; ++k)
    edge_[k] = edge_[kQuantiles - 1] * std::pow(2, static_cast<double>(k - kQuantiles + 1));
  edge_.back() = std::numeric_limits<double>::infinity();
}

void SourceTreeBuilder::set_tables() {
  const std::size_t n = terms_.size();
  reach_.resize(n * kBins);
  items_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const SourceTerm& term = terms_[i];
    Item& item = items_[i];
    item.term = static_cast<std::uint32_t>(i);
    std::size_t first = kBins;
    for (std::size_t b = kBins; b-- > 0;) {
      const double reach = term.law.reach(edge_[b] / term.factor);
      reach_[i * kBins + b] = reach < 0 ? -1.0f : std::max(kLeastReach, rounded_up(reach / extent_ * kWiden));
      if (reach >= 0) first = b;
    }
    for (std::size_t s = 0; s < kSamples; ++s) item.reach[s] = reach_[i * kBins + s * (kBins - 5) / kSamples + 1];
    const Box& box = term.shape.box();
    for (int k = 0; k < 3; ++k) {
      // Sides of moved and round shapes, and distances to them, round with the size of the coordinates.
      const double rounding =
          16 * std::numeric_limits<double>::epsilon() * std::max(std::abs(box.low[k]), std::abs(box.high[k])) / extent_;
      const float margin = kMargin + static_cast<float>(rounding);
      item.low[k] = static_cast<float>((box.low[k] - centre_[k]) / extent_) - margin;
      item.high[k] = static_cast<float>((box.high[k] - centre_[k]) / extent_) + margin;
      item.key[k] = 0.5f * (item.low[k] + item.high[k]);
    }
    item.key[3] = static_cast<float>(first);
  }
}

std::vector<std::uint32_t> SourceTreeBuilder::build(Context& context) {
  set_tables();
  nodes_.clear();
  nodes_.reserve(terms_.size() / 4 + 1);
  build_node(make_cluster(0, static_cast<std::uint32_t>(items_.size())), 0, context);
  std::vector<std::uint32_t> order;
  order.reserve(items_.size());
  for (const Item& item : items_) order.push_back(item.term);
  return order;
}

SourceTreeBuilder::Cluster SourceTreeBuilder::make_cluster(std::uint32_t begin, std::uint32_t end) const {
  Bounds bounds;
  for (std::uint32_t i = begin; i < end; ++i) bounds.add(items_[i]);
  bounds.count = end - begin;
  return {begin, end, bounds.cost()};
}

void SourceTreeBuilder::set_child(Node& node, std::size_t lane, const Cluster& cluster) const {
  Bounds bounds;
  float reach[kBins];
  std::fill(reach, reach + kBins, -1.0f);
  for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
    bounds.add(items_[i]);
    const float* const from = &reach_[items_[i].term * kBins];
    for (std::size_t b = 0; b < kBins; ++b) reach[b] = std::max(reach[b], from[b]);
  }
  for (int k = 0; k < 3; ++k) node.low[k][lane] = bounds.low[k], node.high[k][lane] = bounds.high[k];
  for (std::size_t b = 0; b < kBins; ++b)
    node.reach[b][lane] =
        reach[b] < 0 ? std::uint16_t(0) : upper_half(std::min(3e38, double(reach[b]) * double(reach[b])));
}

std::uint32_t SourceTreeBuilder::build_node(Cluster all, int depth, Context& context) {
  if (nodes_.size() % 256 == 0) context.check_limits();
  std::vector<Cluster> parts = {all};
  while (parts.size() < kWidth) {
    std::size_t worst = parts.size();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].size() < 2) continue;
      if (worst == parts.size() || parts[i].cost > parts[worst].cost ||
          (parts[i].cost == parts[worst].cost && parts[i].size() > parts[worst].size()))
        worst = i;
    }
    if (worst == parts.size()) break;
    const Cluster cluster = parts[worst];
    const std::uint32_t middle = split(cluster, depth);
    parts[worst] = make_cluster(cluster.begin, middle);
    parts.push_back(make_cluster(middle, cluster.end));
  }
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  Node node{};
  for (std::size_t lane = 0; lane < parts.size(); ++lane) {
    set_child(node, lane, parts[lane]);
    node.child[lane] =
        parts[lane].size() == 1 ? parts[lane].begin | kTermBit : build_node(parts[lane], depth + 1, context);
  }
  nodes_[self] = node;
  return static_cast<std::uint32_t>(self);
}

/// @return where the second part begins; both have items
std::uint32_t SourceTreeBuilder::split(const Cluster& cluster, int depth) {
  const auto first = items_.begin() + cluster.begin, last = items_.begin() + cluster.end;
  float low[4], high[4];
  for (int axis = 0; axis < 4; ++axis) {
    low[axis] = high[axis] = first->key[axis];
    for (auto item = first; item != last; ++item) {
      low[axis] = std::min(low[axis], item->key[axis]);
      high[axis] = std::max(high[axis], item->key[axis]);
    }
  }
  int best_axis = -1;
  std::size_t best_plane = 0;
  double best_cost = std::numeric_limits<double>::infinity();
  auto bin_of = [&](const Item& item, int axis) {
    const float at = (item.key[axis] - low[axis]) / (high[axis] - low[axis]) * float(kPlanes);
    return std::min(kPlanes - 1, static_cast<std::size_t>(std::max(0.0f, at)));
  };
  for (int axis = 0; axis < 4 && depth < kMedianDepth; ++axis) {
    if (!(high[axis] > low[axis])) continue;
    std::array<Bounds, kPlanes> bins;
    for (auto item = first; item != last; ++item) {
      Bounds& bin = bins[bin_of(*item, axis)];
      bin.add(*item);
      ++bin.count;
    }
    std::array<double, kPlanes> right{};
    Bounds sweep;
    for (std::size_t k = kPlanes - 1; k > 0; --k) {
      sweep.add(bins[k]);
      sweep.count += bins[k].count;
      right[k] = sweep.cost();
    }
    sweep = {};
    for (std::size_t k = 1; k < kPlanes; ++k) {
      sweep.add(bins[k - 1]);
      sweep.count += bins[k - 1].count;
      const double cost = sweep.cost() + right[k];
      if (sweep.count == 0 || sweep.count == cluster.size() || !(cost < best_cost)) continue;
      best_cost = cost;
      best_axis = axis;
      best_plane = k;
    }
  }
  if (best_axis >= 0 && best_cost > 0) {
    const auto middle =
        std::partition(first, last, [&](const Item& item) { return bin_of(item, best_axis) < best_plane; });
    return static_cast<std::uint32_t>(middle - items_.begin());
  }
  int axis = 0;  // the longest
  for (int k = 1; k < 3; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  const auto middle = first + (last - first) / 2;
  std::nth_element(first, middle, last, [axis](const Item& a, const Item& b) {
    return a.key[axis] != b.key[axis] ? a.key[axis] < b.key[axis] : a.term < b.term;
  });
  return static_cast<std::uint32_t>(middle - items_.begin());
}

}  // namespace delfront
