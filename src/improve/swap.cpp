// SPDX-License-Identifier: Apache-2.0
// Exchange of edges and faces, and the contraction of an edge.
#include <algorithm>

#include "improve/operations.hpp"

namespace delfront {

namespace {
constexpr double kLongest = 1.8;  // edges made by a contraction, of the wanted size
}

LocalOperations::Swap LocalOperations::swap(TetIndex t, double enough) {
  if (!flips_.plan_best(t, kGain * quality(t), enough, plan_)) return Swap::none;
  const bool is_face = plan_.made.size() > plan_.old_tets.size();
  if (!flips_.commit(plan_, touched)) return Swap::none;
  return is_face ? Swap::face : Swap::edge;
}

bool LocalOperations::contract(VertexIndex v) {
  if (!collect_star(v)) return false;
  candidates_.clear();
  for (const auto& n : star_faces_) candidates_.insert(candidates_.end(), n.begin(), n.end());
  std::sort(candidates_.begin(), candidates_.end());
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  double best = kGain * faces_.worst(c_.point(v));
  VertexIndex target = kNoIndex;
  for (const VertexIndex u : candidates_) {
    const bool is_short = std::all_of(candidates_.begin(), candidates_.end(), [&](VertexIndex w) {
      const double wanted = kLongest * 0.5 * (c_.vertex[u].h + c_.vertex[w].h);
      const double now = squared_length(c_.point(u) - c_.point(w));
      return now <= wanted * wanted || now <= squared_length(c_.point(v) - c_.point(w));
    });
    if (!is_short) continue;
    faces_.measure(c_.point(u), quality_);
    double worst = 1;
    for (std::size_t i = 0; i < star_faces_.size(); ++i) {
      const auto& n = star_faces_[i];
      if (n[0] != u && n[1] != u && n[2] != u) worst = std::min(worst, quality_[i]);
    }
    if (worst <= best) continue;
    best = worst;
    target = u;
  }
  if (target == kNoIndex) return false;
  plan_.old_tets.assign(star_.begin(), star_.end());
  plan_.made.clear();
  for (const auto& n : star_faces_)
    if (n[0] != target && n[1] != target && n[2] != target) plan_.made.push_back({n[0], n[1], n[2], target});
  return flips_.commit(plan_, touched);
}

}  // namespace delfront
