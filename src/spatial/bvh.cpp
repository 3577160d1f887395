// SPDX-License-Identifier: Apache-2.0
// Built top down: each node splits its items by their boxes' centres along the longest axis of the centres' box, at the
// one of 15 planes with the least surface-area cost (Wald 2007, "On fast construction of SAH-based bounding volume
// hierarchies"); by the median where no plane separates or where the tree grows deep, which bounds the depth.
#include "spatial/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace delfront {
namespace {

constexpr int kBins = 16;
constexpr int kMedianDepth = 40;  // below it halves only: 2^32 items add at most 32 levels

double half_area(const Box& box) {
  if (box.is_empty()) return 0;
  const Point side = box.high - box.low;
  return side.x * side.y + side.y * side.z + side.z * side.x;
}

int longest_axis(const Box& box) {
  const Point side = box.high - box.low;
  return side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
}

}  // namespace

double squared_distance(Point p, const Box& box) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = std::max({box.low[k] - p[k], 0.0, p[k] - box.high[k]});
    sum += gap * gap;
  }
  return sum;
}

Point nearest_point_on_triangle(Point p, Point a, Point b, Point c) {
  auto on_segment = [](Point q, Point from, Point to) {
    const Point along = to - from;
    const double squared = squared_length(along);
    const double t = squared > 0 ? std::clamp(dot(q - from, along) / squared, 0.0, 1.0) : 0.0;
    return from + t * along;
  };
  const Point ab = b - a, ac = c - a, ap = p - a;
  const Point normal = cross(ab, ac);
  const double squared = squared_length(normal);
  if (squared > 0) {
    const double v = dot(cross(ap, ac), normal) / squared, w = dot(cross(ab, ap), normal) / squared;
    if (v >= 0 && w >= 0 && v + w <= 1) return a + v * ab + w * ac;
  }
  Point best = on_segment(p, a, b);
  for (const Point& q : {on_segment(p, b, c), on_segment(p, c, a)})
    if (squared_length(q - p) < squared_length(best - p)) best = q;
  return best;
}

std::optional<double> ray_triangle(Point origin, Point direction, Point a, Point b, Point c) {
  const Point ab = b - a, ac = c - a;
  const Point h = cross(direction, ac);
  const double det = dot(ab, h);
  if (det == 0) return std::nullopt;
  const Point s = origin - a;
  const double u = dot(s, h) / det;
  if (!(u >= 0 && u <= 1)) return std::nullopt;
  const Point q = cross(s, ab);
  const double v = dot(direction, q) / det;
  if (!(v >= 0 && u + v <= 1)) return std::nullopt;
  const double t = dot(ac, q) / det;
  if (!(t >= 0)) return std::nullopt;
  return t;
}

Bvh::Bvh(std::span<const Box> boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].is_empty()) continue;
    items_.push_back(static_cast<std::uint32_t>(i));
    boxes_.push_back(boxes[i]);
    box_.add(boxes[i]);
  }
  if (items_.empty()) return;
  nodes_.reserve(items_.size());
  nodes_.resize(1);
  build(0, 0, static_cast<std::uint32_t>(items_.size()), 0);
}

void Bvh::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end, int depth) {
  Box box, centres;
  for (std::uint32_t i = begin; i < end; ++i) {
    box.add(boxes_[i]);
    centres.add(boxes_[i].centre());
  }
  nodes_[node].box = box;
  if (end - begin <= kLeafSize) {
    nodes_[node].begin = begin;
    nodes_[node].count = end - begin;
    return;
  }
  const std::uint32_t middle = split(begin, end, centres, depth);
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].begin = left;
  nodes_.resize(nodes_.size() + 2);
  build(left, begin, middle, depth + 1);
  build(left + 1, middle, end, depth + 1);
}

std::uint32_t Bvh::split(std::uint32_t begin, std::uint32_t end, const Box& centres, int depth) {
  const int axis = longest_axis(centres);
  const double low = centres.low[axis], extent = centres.high[axis] - low;
  auto swap_items = [&](std::uint32_t i, std::uint32_t j) {
    std::swap(items_[i], items_[j]);
    std::swap(boxes_[i], boxes_[j]);
  };
  const double scale = kBins / extent;
  if (depth < kMedianDepth && extent > 0 && std::isfinite(scale)) {
    auto bin_of = [&](const Box& b) { return std::min(kBins - 1, static_cast<int>((b.centre()[axis] - low) * scale)); };
    std::array<Box, kBins> bin_box;
    std::array<std::uint32_t, kBins> bin_count{};
    for (std::uint32_t i = begin; i < end; ++i) {
      const auto bin = std::size_t(bin_of(boxes_[i]));
      bin_box[bin].add(boxes_[i]);
      ++bin_count[bin];
    }
    std::array<double, kBins> right_cost{};
    Box sweep;
    std::uint32_t count = 0;
    for (std::size_t k = kBins - 1; k > 0; --k) {
      sweep.add(bin_box[k]);
      count += bin_count[k];
      right_cost[k] = half_area(sweep) * count;
    }
    sweep = {};
    count = 0;
    int best = 0;
    double best_cost = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < kBins; ++k) {
      sweep.add(bin_box[k - 1]);
      count += bin_count[k - 1];
      const double cost = half_area(sweep) * count + right_cost[k];
      if (cost < best_cost && count > 0 && count < end - begin) {
        best_cost = cost;
        best = static_cast<int>(k);
      }
    }
    std::uint32_t i = begin, j = end;
    while (best > 0 && i < j) {
      if (bin_of(boxes_[i]) < best)
        ++i;
      else
        swap_items(i, --j);
    }
    if (i > begin && i < end) return i;
  }
  std::vector<std::uint32_t> order(end - begin);
  std::iota(order.begin(), order.end(), begin);
  const auto middle = order.size() / 2;
  std::nth_element(order.begin(), order.begin() + std::ptrdiff_t(middle), order.end(),
                   [&](std::uint32_t i, std::uint32_t j) {
                     const double a = boxes_[i].centre()[axis], b = boxes_[j].centre()[axis];
                     return a != b ? a < b : items_[i] < items_[j];
                   });
  std::vector<std::pair<std::uint32_t, Box>> sorted;
  for (std::uint32_t i : order) sorted.push_back({items_[i], boxes_[i]});
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    items_[begin + k] = sorted[k].first;
    boxes_[begin + k] = sorted[k].second;
  }
  return begin + static_cast<std::uint32_t>(middle);
}

Bvh::Ray Bvh::make_ray(Point origin, Point direction, double t_max) const {
  const Point inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    largest = std::max({largest, std::abs(origin[k]), std::abs(box_.low[k]), std::abs(box_.high[k])});
  return {origin, inverse, t_max, 4 * std::numeric_limits<double>::epsilon() * largest};
}

bool Bvh::Ray::meets(const Box& box) const {
  double enter = 0, leave = t_max;
  for (int k = 0; k < 3; ++k) {
    const double low = box.low[k] - widen - origin[k], high = box.high[k] + widen - origin[k];
    if (std::isinf(inverse[k])) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double t0 = low * inverse[k], t1 = high * inverse[k];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter <= leave * (1 + 4 * std::numeric_limits<double>::epsilon());
}

TriangleTree::TriangleTree(std::vector<std::array<Point, 3>> corners) : corners_(std::move(corners)) {
  std::vector<Box> boxes(corners_.size());
  for (std::size_t i = 0; i < corners_.size(); ++i)
    for (const Point& p : corners_[i]) boxes[i].add(p);
  bvh_ = Bvh(boxes);
}

TriangleTree::Hit TriangleTree::nearest(Point p) const {
  return nearest_if(p, [](std::uint32_t) { return true; });
}

}  // namespace delfront
