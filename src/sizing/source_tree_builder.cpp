// SPDX-License-Identifier: Apache-2.0
#include "sizing/source_tree_builder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "Eigen/Eigenvalues"

namespace delfront {
namespace {

constexpr float kMargin = 0x1p-19f;                   // of boxes, in units of the extent
constexpr double kWiden = 1 + 4e-6;                   // of reaches
constexpr float kLeastReach = 1e-6f;                  // its square must not vanish
constexpr double kShort = 1 - 2e-6;                   // axes, for the rounding of products with them
constexpr float kTurnedMargin = 8e-6f;                // of turned boxes
constexpr double kRoom = 1.2;                         // places are expected within so many extents of the centre
constexpr double kLargestRoom = 4;                    // extents: places of the sample are no farther from a source
constexpr double kLeastRange = 76, kMostRange = 1e6;  // of the first sizes
constexpr double kFarther = 8;                        // between sizes outside of all sources
constexpr int kMedianDepth = 24;                      // of nodes; below it clusters are halved only

float rounded_up(double value) {
  const float f = static_cast<float>(value);
  return static_cast<double>(f) >= value ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
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
  double largest = std::numeric_limits<double>::infinity();  // of the field where the sources are
  for (const SourceTerm& term : terms_) largest = std::min(largest, term.factor * term.law(kLargestRoom * extent_));
  largest = std::clamp(largest, kLeastRange * smallest_, kMostRange * smallest_);
  const double step = std::pow(largest / smallest_, 1.0 / (kBins - 2));
  for (std::size_t k = 0; k < kBins; ++k) edge_[k] = smallest_ * std::pow(step, static_cast<double>(k));
  edge_.back() = std::numeric_limits<double>::infinity();
}

void SourceTreeBuilder::choose_sizes(std::vector<double> sample) {
  std::erase_if(sample, [](double size) { return !std::isfinite(size); });
  std::sort(sample.begin(), sample.end());
  if (sample.empty()) return choose_first_sizes();
  // Above the largest four more, for places farther out, then infinity: there all terms are looked at.
  constexpr std::size_t kQuantiles = kBins - 5;
  for (std::size_t k = 0; k < kQuantiles; ++k) edge_[k] = sample[(k + 1) * (sample.size() - 1) / kQuantiles];
  for (std::size_t k = kQuantiles; k < kBins; ++k) edge_[k] = kFarther * edge_[k - 1];
  edge_.back() = std::numeric_limits<double>::infinity();
}

double SourceTreeBuilder::width(std::size_t b) const {
  const double low = b > 0 ? edge_[b - 1] : smallest_;
  return std::isfinite(edge_[b]) && edge_[b] > low ? edge_[b] - low : 0;
}

void SourceTreeBuilder::set_items() {
  const std::size_t n = terms_.size();
  items_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const SourceTerm& term = terms_[i];
    Item& item = items_[i];
    item.term = static_cast<std::uint32_t>(i);
    for (std::size_t s = 0; s < kSamples; ++s) {
      const double reach = term.law.reach(edge_[s * (kBins - 5) / kSamples + 1] / term.factor);
      item.reach[s] = reach < 0 ? -1.0f : std::max(kLeastReach, rounded_up(reach / extent_ * kWiden));
    }
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
    const double least = term.factor * term.law.delta0();
    item.key[3] = static_cast<float>(std::upper_bound(edge_.begin(), edge_.end(), least) - edge_.begin());
  }
}

SourceTreeBuilder::Lines::Lines() {
  std::fill(low, low + 3, std::numeric_limits<float>::infinity());
  std::fill(high, high + 3, -std::numeric_limits<float>::infinity());
  std::fill(reach, reach + kBins, -1.0f);
  std::fill(fall, fall + kBins, 0.0f);
}

/// The line above both, at the upper end of the bin as low as can be.
void SourceTreeBuilder::Lines::add(const Lines& other) {
  for (int k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], other.low[k]);
    high[k] = std::max(high[k], other.high[k]);
  }
  for (std::size_t b = 0; b < kBins; ++b) {
    if (other.reach[b] < 0) continue;
    const float most = std::max(reach[b], other.reach[b]);
    const float theirs = std::isfinite(most) ? other.fall[b] + (most - other.reach[b]) : 0;
    fall[b] = reach[b] < 0 ? theirs : std::min(theirs, std::isfinite(most) ? fall[b] + (most - reach[b]) : 0);
    reach[b] = most;
  }
}

/// With F the inverse of the law, F(v) <= F(e) - (e - v) / (steepest slope up to F(e)) for v <= e.
SourceTreeBuilder::Lines SourceTreeBuilder::lines_of(const Item& item) const {
  const SourceTerm& term = terms_[item.term];
  Lines lines;
  std::copy(item.low, item.low + 3, lines.low);
  std::copy(item.high, item.high + 3, lines.high);
  for (std::size_t b = kBins; b-- > 0;) {
    const double reach = term.law.reach(edge_[b] / term.factor);
    if (reach < 0) break;  // and for smaller sizes
    lines.reach[b] = rounded_up(reach / extent_ * kWiden + kLeastReach);
    if (!std::isfinite(reach) || !(width(b) > 0)) continue;
    const double steepest = term.factor * term.law.steepest(reach);
    if (steepest < std::numeric_limits<double>::infinity())
      lines.fall[b] = static_cast<float>(std::min(1e30, width(b) / (extent_ * steepest)));
  }
  return lines;
}

std::vector<std::uint32_t> SourceTreeBuilder::build(bool has_turned_boxes, Context& context) {
  has_turned_boxes_ = has_turned_boxes;
  set_items();
  nodes_.clear();
  nodes_.reserve(terms_.size() / 4 + 1);
  Lines lines;
  build_node(make_cluster(0, static_cast<std::uint32_t>(items_.size())), 0, lines, context);
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

void SourceTreeBuilder::set_child(Node& node, std::size_t lane, const Lines& lines) {
  constexpr float kNarrow = 1 - 4e-6f;  // sums of falls round
  for (int k = 0; k < 3; ++k) node.low[k][lane] = lines.low[k], node.high[k][lane] = lines.high[k];
  for (std::size_t b = 0; b < kBins; ++b) {
    node.reach[b][lane] = lines.reach[b];
    node.fall[b][lane] = kNarrow * lines.fall[b];
  }
}

/// Along the principal axes of the corners. @return its volume, infinite where a shape has no corners
double SourceTreeBuilder::set_turned_box(TurnedBoxes& boxes, std::size_t lane, const Cluster& cluster) const {
  const auto for_each_corner = [&](const auto& visit) {
    Point corner[3];
    for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
      const int n = terms_[items_[i].term].shape.corners(corner);
      for (int k = 0; k < n; ++k) visit((1 / extent_) * (corner[k] - centre_));
      if (n == 0) return false;
    }
    return true;
  };
  Point sum;
  double count = 0;
  const auto add = [&](Point p) {
    sum = sum + p;
    ++count;
  };
  if (!for_each_corner(add)) return std::numeric_limits<double>::infinity();
  const Point mean = sum / count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for_each_corner([&](Point p) {
    const Eigen::Vector3d v(p.x - mean.x, p.y - mean.y, p.z - mean.z);
    covariance += v * v.transpose();
  });
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  const double far = std::abs(centre_.x) + std::abs(centre_.y) + std::abs(centre_.z);
  const auto rounding = static_cast<float>(64 * std::numeric_limits<double>::epsilon() * far / extent_);
  double volume = 1;
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) boxes.axis[k][j][lane] = static_cast<float>(kShort * axes(j, k));
    const auto along = [&](Point p) {
      return double(boxes.axis[k][0][lane]) * p.x + double(boxes.axis[k][1][lane]) * p.y +
             double(boxes.axis[k][2][lane]) * p.z;
    };
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for_each_corner([&](Point p) {
      low = std::min(low, along(p));
      high = std::max(high, along(p));
    });
    boxes.at[k][lane] = static_cast<float>(0.5 * (low + high));
    boxes.half[k][lane] = static_cast<float>(0.5 * (high - low)) + kTurnedMargin + rounding;
    volume *= 2 * double(boxes.half[k][lane]);
  }
  return volume;
}

/// @return their number; kNone where they would not be much smaller than the boxes along x, y and z
std::uint32_t SourceTreeBuilder::add_turned_boxes(const std::vector<Cluster>& parts) {
  constexpr double kMuchSmaller = 0.25;
  if (!has_turned_boxes_) return SourceTree::kNone;
  TurnedBoxes boxes{};
  double turned = 0, straight = 0;
  for (std::size_t lane = 0; lane < parts.size(); ++lane) {
    Bounds bounds;
    for (std::uint32_t i = parts[lane].begin; i < parts[lane].end; ++i) bounds.add(items_[i]);
    double volume = 1;
    for (int k = 0; k < 3; ++k) volume *= double(bounds.high[k]) - double(bounds.low[k]);
    straight += volume;
    turned += set_turned_box(boxes, lane, parts[lane]);
  }
  if (!(turned < kMuchSmaller * straight)) return SourceTree::kNone;
  turned_.push_back(boxes);
  return static_cast<std::uint32_t>(turned_.size() - 1);
}

std::uint32_t SourceTreeBuilder::build_node(Cluster all, int depth, Lines& lines, Context& context) {
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
  node.turned = add_turned_boxes(parts);
  for (std::size_t lane = 0; lane < parts.size(); ++lane) {
    Lines of_child;
    if (parts[lane].size() == 1) {
      of_child = lines_of(items_[parts[lane].begin]);
      node.child[lane] = parts[lane].begin | kTermBit;
    } else {
      node.child[lane] = build_node(parts[lane], depth + 1, of_child, context);
    }
    set_child(node, lane, of_child);
    lines.add(of_child);
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
