// SPDX-License-Identifier: Apache-2.0
// Sizes from the boundary (S1): the minimum over all boundary points of a cone that grows with the distance.
//
// With c the growth and k = (c - 1) / c, a boundary point of size d allows max(d, d / c + k s) at distance s. The
// points stand in a tree of boxes four wide (flat arrays, eight points a leaf); each box keeps the smallest d in it, so
// that its points allow no less than max(dmin, dmin / c + k dist(box)). Besides its sides along the axes each box keeps
// a slab across the direction in which its points spread least: they lie on a surface, and without the slab a place far
// from it (the middle of a sphere) would see hundreds of boxes as near as the nearest point, where with it it sees a
// few. Branch and bound: a box is entered only where what it allows is below the best value so far, i.e. dmin < best
// and dist(box) < (best - dmin / c) / k, which needs no square root. The best value starts from the leaf that won for
// the query before, near in space when queries come along a curve.
//
// A boundary point i which another, j, undercuts everywhere (d_j + (c - 1) |p_i - p_j| < d_i) can win nowhere and is
// left out. Who undercuts whom is asked of the same tree with another cone: max(d, d + (c - 1) s).
//
// The result does not depend on that start or on the order of the search: every value is computed by the one function
// `allowed`, each rounding in it and in the box test is monotone, and the reach is widened by kSlack, which covers the
// few roundings that are not. So what is skipped could not have lowered the minimum, bit for bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "Eigen/Eigenvalues"
#include "delfront/errors.hpp"
#include "delfront/size_field.hpp"
#include "fmt/format.h"

namespace delfront {

void SizeField::metrics(std::span<const Point> at, std::span<Metric> metric) const {
  DELFRONT_CHECK(at.size() == metric.size());
  std::vector<double> size(at.size());
  sizes(at, size);
  for (std::size_t i = 0; i < at.size(); ++i) metric[i] = isotropic_metric(size[i]);
}

void SizeField::lower_sizes(std::span<const Point> at, std::span<double> size) const {
  std::vector<double> own(at.size());
  sizes(at, own);
  for (std::size_t i = 0; i < at.size(); ++i) size[i] = std::min(size[i], own[i]);
}

namespace {

constexpr int kLeafPoints = 8;
constexpr int kWidth = 4;
constexpr std::uint32_t kLeafBit = 0x80000000u;
constexpr std::uint32_t kNoLeaf = 0xffffffffu;
constexpr double kSlack = 1 + 1e-14;
constexpr std::size_t kMaxStack = 128;  // depth of 2^31 points in a balanced tree of four children, three left a level

using LeafLanes = Eigen::Array<double, kLeafPoints, 1>;
using NodeLanes = Eigen::Array<double, kWidth, 1>;
using NodeFloats = Eigen::Array<float, kWidth, 1>;

struct Leaf {
  LeafLanes at[3], d;  // a short last leaf repeats its last point
};

/// Boxes in single precision, rounded outwards, relative to the centre of all points. The slab is the places p with
/// slab_low <= normal . p <= slab_high; |normal| < 1, so that it is never farther away than it seems.
struct Node {
  NodeFloats low[3], high[3];
  NodeFloats normal[3], slab_low, slab_high;
  NodeLanes dmin;               // infinity: no child
  std::uint32_t child[kWidth];  // a node, or a leaf with kLeafBit set
};

/// A query box (for a point low = high), relative to the centre, and the best value found so far.
struct Query {
  double low[3], high[3];
  double middle[3], half[3];
  double best;
  std::uint32_t winner = kNoLeaf;
};

/// Size d allows max(d, base d + slope s) at distance s.
struct Cone {
  double base, slope;
  double allowed(double d, double distance2) const { return std::max(d, base * d + slope * std::sqrt(distance2)); }

  /// Squared distance within which size d < best can give less than `best`; of no meaning where d >= best.
  template <class Lanes>
  Lanes reach2(double best, const Lanes& d) const {
    const Lanes reach = (best - base * d) * (kSlack / slope);
    return reach * reach;
  }
};

/// How far [low, high] is from [query_low, query_high], 0 where they meet.
template <class Lanes>
Lanes gap(const Lanes& low, const Lanes& high, const Lanes& query_low, const Lanes& query_high) {
  return (low - query_high).max(query_low - high).max(0.0);
}

NodeLanes distance2(const Node& node, const Query& query) {
  NodeLanes sum = NodeLanes::Zero(), at = NodeLanes::Zero(), half = NodeLanes::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const NodeLanes side = gap<NodeLanes>(node.low[axis].cast<double>(), node.high[axis].cast<double>(),
                                          NodeLanes::Constant(query.low[axis]), NodeLanes::Constant(query.high[axis]));
    sum += side * side;
    const NodeLanes normal = node.normal[axis].cast<double>();
    at += normal * query.middle[axis];
    half += normal.abs() * query.half[axis];
  }
  const NodeLanes slab =
      gap<NodeLanes>(node.slab_low.cast<double>(), node.slab_high.cast<double>(), at - half, at + half);
  return sum.max(slab * slab);
}

float rounded_down(double value) {
  const float f = static_cast<float>(value);
  return static_cast<double>(f) <= value ? f : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float rounded_up(double value) { return -rounded_down(-value); }

class BoundarySizeField final : public SizeField {
 public:
  BoundarySizeField(const BoundarySizes& boundary, Context& context);

  void sizes(std::span<const Point> at, std::span<double> size) const override {
    std::fill(size.begin(), size.end(), hmax_);
    lower_sizes(at, size);
  }
  void lower_sizes(std::span<const Point> at, std::span<double> size) const override;
  double lower_bound(const Box& box) const override;
  double largest() const override { return hmax_; }

 private:
  double clamped(double value) const { return std::clamp(value, hmin_, hmax_); }
  void search_leaf(std::uint32_t leaf, Query& query) const;
  void search(Query& query) const;
  void build_tree(std::span<std::uint32_t> ids, const BoundarySizes& boundary);
  std::size_t drop_undercut(std::vector<std::uint32_t>& ids, const BoundarySizes& boundary, Context& context) const;
  std::uint32_t build(std::span<std::uint32_t> ids, const BoundarySizes& boundary);
  std::uint32_t build_leaf(std::span<const std::uint32_t> ids, const BoundarySizes& boundary);
  void set_child(Node& node, int k, std::span<const std::uint32_t> ids, const BoundarySizes& boundary) const;
  void set_slab(Node& node, int k, std::span<const std::uint32_t> ids, const std::vector<Point>& points) const;
  Query start(Point low, Point high, double best) const;

  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  Point centre_;
  double extent_ = 1;  ///< no coordinate relative to the centre is larger
  Cone cone_;
  double hmin_, hmax_;
};

void check_input(const BoundarySizes& boundary) {
  const std::size_t n = boundary.points.size();
  if (!(boundary.growth > 1) || !std::isfinite(boundary.growth))
    throw UsageError(fmt::format("growth is {}; it must be a number greater than 1, e.g. 1.2", boundary.growth));
  if (!(boundary.hmin >= 0) || !(boundary.hmax > 0) || boundary.hmin > boundary.hmax)
    throw UsageError(
        fmt::format("hmin = {} and hmax = {}: need 0 <= hmin <= hmax and hmax > 0", boundary.hmin, boundary.hmax));
  if (n == 0) throw InputError("sizes from the boundary: there is no boundary point to take a size from");
  if (boundary.size.size() != n)
    throw InputError(fmt::format("sizes from the boundary: {} points but {} sizes", n, boundary.size.size()));
  for (std::size_t i = 0; i < n; ++i) {
    const Point p = boundary.points[i];
    if (is_finite(p) && boundary.size[i] > 0 && std::isfinite(boundary.size[i])) continue;
    throw InputError(
        fmt::format("sizes from the boundary: point {} at ({}, {}, {}) has size {}; sizes must be positive "
                    "and all numbers finite",
                    i, p.x, p.y, p.z, boundary.size[i]),
        {{p, {static_cast<std::uint32_t>(i)}}});
  }
}

BoundarySizeField::BoundarySizeField(const BoundarySizes& boundary, Context& context)
    : hmin_(boundary.hmin), hmax_(boundary.hmax) {
  Box box;
  for (const Point& p : boundary.points) box.add(p);
  centre_ = box.centre();
  if (box.longest_side() > 0) extent_ = box.longest_side();
  std::vector<std::uint32_t> ids(boundary.points.size());
  std::iota(ids.begin(), ids.end(), 0u);
  context.check_limits();
  build_tree(ids, boundary);
  context.check_limits();
  const double c = boundary.growth;
  cone_ = {1, c - 1};
  if (drop_undercut(ids, boundary, context) > 0) build_tree(ids, boundary);
  cone_ = {1 / c, (c - 1) / c};
}

void BoundarySizeField::build_tree(std::span<std::uint32_t> ids, const BoundarySizes& boundary) {
  nodes_.clear();
  leaves_.clear();
  leaves_.reserve(ids.size() / kLeafPoints + 1);
  nodes_.reserve(ids.size() / (kLeafPoints * (kWidth - 1)) + 1);
  build(ids, boundary);
}

/// @return how many points were taken out of `ids`, which stand in the order of the leaves
std::size_t BoundarySizeField::drop_undercut(std::vector<std::uint32_t>& ids, const BoundarySizes& boundary,
                                             Context& context) const {
  std::size_t asked = 0;
  return std::erase_if(ids, [&](std::uint32_t id) {
    if (++asked % 4096 == 0) context.check_limits();
    Query query = start(boundary.points[id], boundary.points[id], boundary.size[id]);
    search(query);
    return query.best < boundary.size[id];
  });
}

/// Order `ids` so that a middle multiple of the leaf size parts them along the longest side of their box.
std::size_t part(std::span<std::uint32_t> ids, const std::vector<Point>& points) {
  if (ids.size() <= kLeafPoints) return ids.size();
  Box box;
  for (const std::uint32_t id : ids) box.add(points[id]);
  const Point side = box.high - box.low;
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const std::size_t leaves = (ids.size() + kLeafPoints - 1) / kLeafPoints;
  const std::size_t middle = leaves / 2 * kLeafPoints;
  std::nth_element(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(middle), ids.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double xa = points[a][axis], xb = points[b][axis];
                     return xa != xb ? xa < xb : a < b;
                   });
  return middle;
}

std::uint32_t BoundarySizeField::build(std::span<std::uint32_t> ids, const BoundarySizes& boundary) {
  if (ids.size() <= kLeafPoints) return build_leaf(ids, boundary) | kLeafBit;
  const std::size_t middle = part(ids, boundary.points);
  const std::span<std::uint32_t> left = ids.first(middle), right = ids.subspan(middle);
  const std::size_t in_left = part(left, boundary.points), in_right = part(right, boundary.points);
  const std::array<std::span<std::uint32_t>, kWidth> parts = {left.first(in_left), left.subspan(in_left),
                                                              right.first(in_right), right.subspan(in_right)};
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  for (int k = 0; k < kWidth; ++k) {
    set_child(nodes_[self], k, parts[k], boundary);
    const std::uint32_t child = parts[k].empty() ? kNoLeaf : build(parts[k], boundary);
    nodes_[self].child[k] = child;
  }
  return static_cast<std::uint32_t>(self);
}

std::uint32_t BoundarySizeField::build_leaf(std::span<const std::uint32_t> ids, const BoundarySizes& boundary) {
  Leaf leaf;
  for (int i = 0; i < kLeafPoints; ++i) {
    const std::uint32_t id = ids[std::min(static_cast<std::size_t>(i), ids.size() - 1)];
    const Point p = boundary.points[id] - centre_;
    for (int axis = 0; axis < 3; ++axis) leaf.at[axis][i] = p[axis];
    leaf.d[i] = boundary.size[id];
  }
  leaves_.push_back(leaf);
  return static_cast<std::uint32_t>(leaves_.size() - 1);
}

void BoundarySizeField::set_child(Node& node, int k, std::span<const std::uint32_t> ids,
                                  const BoundarySizes& boundary) const {
  Box box;
  double dmin = std::numeric_limits<double>::infinity();
  for (const std::uint32_t id : ids) {
    box.add(boundary.points[id] - centre_);
    dmin = std::min(dmin, boundary.size[id]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    node.low[axis][k] = ids.empty() ? 0.0f : rounded_down(box.low[axis]);
    node.high[axis][k] = ids.empty() ? 0.0f : rounded_up(box.high[axis]);
  }
  node.dmin[k] = dmin;
  set_slab(node, k, ids, boundary.points);
}

/// The slab across the direction of least spread, the eigenvector of the smallest eigenvalue of the covariance.
void BoundarySizeField::set_slab(Node& node, int k, std::span<const std::uint32_t> ids,
                                 const std::vector<Point>& points) const {
  Point mean;
  for (const std::uint32_t id : ids) mean = mean + (points[id] - centre_);
  mean = mean / static_cast<double>(std::max<std::size_t>(ids.size(), 1));
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t id : ids) {
    const Point p = (1 / extent_) * (points[id] - centre_ - mean);
    const Eigen::Vector3d v(p.x, p.y, p.z);
    covariance += v * v.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d normal = (1 - 1e-6) * solver.eigenvectors().col(0);
  double low = ids.empty() ? 0 : std::numeric_limits<double>::infinity(), high = -low;
  for (int axis = 0; axis < 3; ++axis) node.normal[axis][k] = static_cast<float>(normal[axis]);
  for (const std::uint32_t id : ids) {
    const Point p = points[id] - centre_;
    const double at = node.normal[0][k] * p.x + node.normal[1][k] * p.y + node.normal[2][k] * p.z;
    low = std::min(low, at);
    high = std::max(high, at);
  }
  // Rounding of this and of the query's product; for places farther than a few extents |normal| < 1 covers it.
  const double margin = 32 * std::numeric_limits<double>::epsilon() * extent_;
  node.slab_low[k] = rounded_down(low - margin);
  node.slab_high[k] = rounded_up(high + margin);
}

void BoundarySizeField::search_leaf(std::uint32_t index, Query& query) const {
  const Leaf& leaf = leaves_[index];
  LeafLanes distance2 = LeafLanes::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const LeafLanes side = gap<LeafLanes>(leaf.at[axis], leaf.at[axis], LeafLanes::Constant(query.low[axis]),
                                          LeafLanes::Constant(query.high[axis]));
    distance2 += side * side;
  }
  const LeafLanes inside = distance2 - cone_.reach2<LeafLanes>(query.best, leaf.d);
  if (!(inside.minCoeff() < 0)) return;
  for (int i = 0; i < kLeafPoints; ++i) {
    if (!(inside[i] < 0 && leaf.d[i] < query.best)) continue;
    const double allowed = cone_.allowed(leaf.d[i], distance2[i]);
    if (allowed >= query.best) continue;
    query.best = allowed;
    query.winner = index;
  }
}

void BoundarySizeField::search(Query& query) const {
  if (nodes_.empty()) return search_leaf(0, query);
  struct Entry {
    double distance2, dmin;
    std::uint32_t child;
  };
  Entry stack[kMaxStack];
  std::size_t top = 0;
  const std::uint32_t searched = query.winner;
  stack[top++] = {0, 0, 0};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (!(entry.dmin < query.best && entry.distance2 < cone_.reach2(query.best, entry.dmin))) continue;
    if (entry.child & kLeafBit) {
      const std::uint32_t leaf = entry.child & ~kLeafBit;
      if (leaf != searched) search_leaf(leaf, query);
      continue;
    }
    const Node& node = nodes_[entry.child];
    const NodeLanes away2 = distance2(node, query);
    const NodeLanes reach = cone_.reach2<NodeLanes>(query.best, node.dmin);
    const std::size_t bottom = top;
    for (int k = 0; k < kWidth; ++k) {
      if (!(node.dmin[k] < query.best && away2[k] < reach[k])) continue;
      std::size_t place = top++;  // the nearest on top
      for (; place > bottom && stack[place - 1].distance2 < away2[k]; --place) stack[place] = stack[place - 1];
      stack[place] = {away2[k], node.dmin[k], node.child[k]};
    }
  }
}

Query BoundarySizeField::start(Point low, Point high, double best) const {
  low = low - centre_;
  high = high - centre_;
  const Point middle = 0.5 * (low + high), half = high - middle;
  return {{low.x, low.y, low.z},
          {high.x, high.y, high.z},
          {middle.x, middle.y, middle.z},
          {half.x, half.y, half.z},
          best,
          kNoLeaf};
}

void BoundarySizeField::lower_sizes(std::span<const Point> at, std::span<double> size) const {
  DELFRONT_CHECK(at.size() == size.size());
  std::uint32_t winner = kNoLeaf;
  for (std::size_t i = 0; i < at.size(); ++i) {
    Query query = start(at[i], at[i], std::min(size[i], hmax_));
    if (winner != kNoLeaf) {
      search_leaf(winner, query);
      query.winner = winner;
    }
    if (query.best > hmin_) search(query);  // at hmin nothing can be lower
    winner = query.winner;
    size[i] = std::min(size[i], clamped(query.best));
  }
}

double BoundarySizeField::lower_bound(const Box& box) const {
  if (box.is_empty()) return hmin_ > 0 ? hmin_ : std::numeric_limits<double>::min();
  Query query = start(box.low, box.high, hmax_);
  search(query);
  return clamped(query.best / kSlack);  // `sizes` rounds too
}

}  // namespace

std::unique_ptr<SizeField> build_boundary_size_field(const BoundarySizes& boundary, Context& context) {
  check_input(boundary);
  return std::make_unique<BoundarySizeField>(boundary, context);
}

}  // namespace delfront
