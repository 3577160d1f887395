// SPDX-License-Identifier: Apache-2.0
#include "cad/order_loop.hpp"

#include <algorithm>
#include <cmath>

namespace delfront::cad {
namespace {

constexpr double kSamePlace = 1e-4;  ///< of the extent: a loop that is back where it began

class Orderer {
 public:
  Orderer(const std::vector<LoopSide>& sides, Point2 extent) : sides_(sides), extent_(extent), is_used_(sides.size()) {}

  std::vector<std::vector<std::size_t>> run() {
    std::vector<std::vector<std::size_t>> loops;
    for (std::size_t first = 0; first < sides_.size(); ++first) {
      if (is_used_[first]) continue;
      loops.push_back({first});
      is_used_[first] = true;
      std::vector<std::size_t>& loop = loops.back();
      while (!is_back(loop)) {
        const std::size_t next = find_next(loop.back());
        if (next == sides_.size()) break;
        is_used_[next] = true;
        loop.push_back(next);
      }
    }
    return loops;
  }

 private:
  double apart(Point2 a, Point2 b) const {
    return std::max(std::abs(a.x - b.x) / extent_.x, std::abs(a.y - b.y) / extent_.y);
  }

  bool is_back(const std::vector<std::size_t>& loop) const {
    const LoopSide &first = sides_[loop.front()], &last = sides_[loop.back()];
    return last.corners[1] == first.corners[0] && apart(last.end, first.begin) <= kSamePlace;
  }

  /// The side itself follows where it lies nearest; sides in the order given win among equals.
  std::size_t find_next(std::size_t from) const {
    std::size_t best = sides_.size();
    double least = 0;
    const std::size_t n = sides_.size();
    for (std::size_t k = 1; k < n; ++k) {
      const std::size_t i = (from + k) % n;
      if (is_used_[i] || sides_[i].corners[0] != sides_[from].corners[1]) continue;
      const double away = apart(sides_[i].begin, sides_[from].end);
      if (best < n && !(away < 0.9 * least - kSamePlace)) continue;
      best = i;
      least = away;
    }
    return best;
  }

  const std::vector<LoopSide>& sides_;
  Point2 extent_;
  std::vector<bool> is_used_;
};

}  // namespace

std::vector<std::vector<std::size_t>> order_loop(const std::vector<LoopSide>& sides, Point2 extent) {
  if (!(extent.x > 0)) extent.x = 1;
  if (!(extent.y > 0)) extent.y = 1;
  return Orderer(sides, extent).run();
}

}  // namespace delfront::cad
