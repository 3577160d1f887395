// SPDX-License-Identifier: Apache-2.0
#include "spatial/box_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hilbert.hpp"

namespace delfront {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float rounded_down(double x) {
  const auto f = static_cast<float>(x);
  return double(f) <= x ? f : std::nextafter(f, -kInfinity);
}
float rounded_up(double x) {
  const auto f = static_cast<float>(x);
  return double(f) >= x ? f : std::nextafter(f, kInfinity);
}

}  // namespace

void BoxPairs::widest(const Node& node, Lane& box) {
  for (int k = 0; k < 3; ++k) {
    box.low[k] = node.low[k][0];
    box.high[k] = node.high[k][0];
    for (std::uint32_t lane = 1; lane < kWidth; ++lane) {
      box.low[k] = std::min(box.low[k], node.low[k][lane]);
      box.high[k] = std::max(box.high[k], node.high[k][lane]);
    }
  }
}

BoxPairs::BoxPairs(std::span<const Box> boxes, int threads) : boxes_(boxes) {
  std::vector<Point> centres;
  std::vector<std::uint32_t> given;
  Box all;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].is_empty()) continue;
    given.push_back(static_cast<std::uint32_t>(i));
    centres.push_back(boxes[i].centre());
    all.add(boxes[i]);
  }
  if (given.empty()) return;
  for (const std::uint32_t i : hilbert_order(centres, threads)) items_.push_back(given[i]);
  Node none;
  for (int k = 0; k < 3; ++k) {
    none.low[k] = Lanes{} + kInfinity;
    none.high[k] = Lanes{} - kInfinity;
  }
  const auto num_nodes = [](std::size_t n) { return (n + kWidth - 1) / kWidth; };
  const Point middle = all.centre();  // numbers are relative to it: rounding is that of the model's extent
  levels_.emplace_back(num_nodes(items_.size()), none);
  for (std::size_t s = 0; s < items_.size(); ++s) {
    const Box& box = boxes[items_[s]];
    Node& node = levels_[0][s / kWidth];
    for (int k = 0; k < 3; ++k) {
      // a difference rounds to nearest: one float further covers that too
      node.low[k][s % kWidth] = std::nextafter(rounded_down(box.low[k] - middle[k]), -kInfinity);
      node.high[k][s % kWidth] = std::nextafter(rounded_up(box.high[k] - middle[k]), kInfinity);
    }
  }
  while (levels_.back().size() > 1) {
    const std::vector<Node>& below = levels_.back();
    std::vector<Node> level(num_nodes(below.size()), none);
    for (std::size_t n = 0; n < below.size(); ++n) {
      Lane box;
      widest(below[n], box);
      for (int k = 0; k < 3; ++k) {
        level[n / kWidth].low[k][n % kWidth] = box.low[k];
        level[n / kWidth].high[k][n % kWidth] = box.high[k];
      }
    }
    levels_.push_back(std::move(level));
  }
}

}  // namespace delfront
