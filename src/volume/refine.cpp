// SPDX-License-Identifier: Apache-2.0
// Frontal Delaunay refinement in rounds (Rebay 1993; Marot, Pellerin & Remacle 2019). Terms: a tet is accepted when its
// circumsphere is about as large as its vertices' sizes ask; the front is the faces between accepted tets (or the
// boundary) and tets that are not. A tet at the front proposes the point that would make a good tet over that face, but
// never beyond its own circumcentre. Proposals go in along the Hilbert curve; the kernel refuses those too close to
// another.
#include "volume/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hilbert.hpp"

namespace delfront {

namespace {

constexpr double kRegularRadius = 0.61237243569579452;  ///< circumradius of a regular tet of side 1: sqrt(6) / 4
constexpr double kAcceptedRadius = 1.30 * kRegularRadius;
constexpr double kMinDistance = 0.70;  ///< of the wanted size, between points
constexpr double kEnough = 1e-3;       ///< share of proposals that still succeed, below which a round was the last
constexpr std::size_t kPointsPerCancelCheck = 4096;

struct Sphere {
  Point centre;
  double radius = 0;
};

Sphere circumsphere(Point a, Point b, Point c, Point d) {
  const Point u = b - a, v = c - a, w = d - a;
  const double det = 2 * dot(cross(u, v), w);
  if (!(std::abs(det) > 0)) return {a, std::numeric_limits<double>::infinity()};
  const Point offset =
      (squared_length(u) * cross(v, w) + squared_length(v) * cross(w, u) + squared_length(w) * cross(u, v)) / det;
  return {a + offset, length(offset)};
}

struct Proposal {
  Point at;
  TetIndex tet;
  double size;  ///< wanted there: first interpolated, then asked of the field
};

class Refinement {
 public:
  Refinement(TetComplex& complex, const SizeField& size, Context& context)
      : c_(complex), size_(size), context_(context), kernel_(complex) {}

  RefineReport run() {
    for (TetIndex t = 0; t < c_.num_slots(); ++t) pending_.push_back(t);
    for (bool frontal = true;;) {
      propose(frontal);
      ask_sizes();
      const std::size_t inserted = insert();
      ++report_.rounds;
      if (static_cast<double>(inserted) > kEnough * static_cast<double>(proposals_.size())) continue;
      if (!frontal) break;
      frontal = false;  // what the front could not reach: circumcentres, until those end too
    }
    return report_;
  }

 private:
  bool is_live(TetIndex t) const { return !c_.is_dead(t) && !c_.is_ghost(t); }

  double mean_size(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return (c_.vertex[n[0]].h + c_.vertex[n[1]].h + c_.vertex[n[2]].h + c_.vertex[n[3]].h) / 4;
  }

  Sphere sphere(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return circumsphere(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(n[3]));
  }

  bool is_accepted(TetIndex t) const { return sphere(t).radius <= kAcceptedRadius * mean_size(t); }

  /// One proposal at most from each pending tet; accepted tets leave the list, the others stay on it.
  void propose(bool frontal) {
    std::sort(pending_.begin(), pending_.end());
    pending_.erase(std::unique(pending_.begin(), pending_.end()), pending_.end());
    proposals_.clear();
    std::size_t kept = 0;
    accepted_.resize(c_.num_slots(), unknown);
    for (const TetIndex t : pending_) accepted_[t] = is_live(t) ? (is_accepted(t) ? yes : no) : unknown;
    for (const TetIndex t : pending_) {
      if (accepted_[t] != no) continue;
      pending_[kept++] = t;
      const Sphere s = sphere(t);
      if (!std::isfinite(s.radius)) continue;
      if (!frontal)
        proposals_.push_back({s.centre, t, mean_size(t)});
      else
        propose_over_face(t, s);
    }
    pending_.resize(kept);
    report_.candidates += proposals_.size();
  }

  /// Over the front face whose point would lie nearest to it.
  void propose_over_face(TetIndex t, const Sphere& s) {
    bool found = false;
    double best = 0;
    Proposal proposal{{}, t, 0};
    for (unsigned f = 0; f < 4; ++f) {
      const FaceRef ref = 4 * t + f;
      const TetIndex other = c_.neigh[ref] >> 2;
      if (!c_.is_constrained(ref) && accepted_[other] != yes) continue;
      const auto n = c_.face_nodes(ref);
      const Point a = c_.point(n[0]), b = c_.point(n[1]), c = c_.point(n[2]);
      Point normal = cross(b - a, c - a);
      const double l = length(normal);
      if (!(l > 0)) continue;
      normal = normal / l;
      const double up = dot(s.centre - a, normal);  // the face's circumcentre lies below the tet's
      const Point foot = s.centre - up * normal;
      const double h = (c_.vertex[n[0]].h + c_.vertex[n[1]].h + c_.vertex[n[2]].h) / 3;
      const double r2 = squared_length(a - foot);
      const double wanted = std::sqrt(std::max(h * h - r2, 0.25 * h * h));
      if (up <= 0 || (found && wanted >= best)) continue;
      proposal.at = foot + std::min(wanted, up) * normal;
      proposal.size = h;
      best = wanted;
      found = true;
    }
    if (found) proposals_.push_back(proposal);
  }

  /// Along the curve, all at once.
  void ask_sizes() {
    Box box;
    for (const Proposal& p : proposals_) box.add(p.at);
    const HilbertCurve curve(box);
    order_.clear();
    for (std::size_t i = 0; i < proposals_.size(); ++i)
      order_.push_back({curve.key(proposals_[i].at), static_cast<std::uint32_t>(i)});
    radix_sort(order_);
    places_.clear();
    for (const auto& [key, i] : order_) places_.push_back(proposals_[i].at);
    sizes_.resize(places_.size());
    size_.sizes(places_, sizes_);
  }

  std::size_t insert() {
    std::size_t inserted = 0;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (k % kPointsPerCancelCheck == 0) {
        context_.progress("refine", c_.num_live(), 0, "cells");
        context_.check_cells(c_.num_live());
      }
      const Proposal& p = proposals_[order_[k].second];
      if (is_live(p.tet) && insert_one(p, sizes_[k])) ++inserted;
    }
    report_.points_inserted += inserted;
    return inserted;
  }

  bool insert_one(const Proposal& p, double h) {
    const std::uint32_t colour = c_.region[p.tet];
    const VertexIndex v = c_.add_vertex(p.at, h);
    const TetIndex holder = kernel_.locate(v, p.tet);
    bool done = false;
    if (!c_.is_ghost(holder) && c_.region[holder] == colour)
      done = kernel_.insert(v, holder, {.min_distance = kMinDistance * h, .constrained = true}) ==
             DelaunayKernel::Insert::done;
    if (!done) {
      c_.remove_last_vertex();
      return false;
    }
    for (const TetIndex t : kernel_.made()) pending_.push_back(t);
    return true;
  }

  enum Accepted : std::uint8_t { unknown, no, yes };

  TetComplex& c_;
  const SizeField& size_;
  Context& context_;
  DelaunayKernel kernel_;
  RefineReport report_;
  std::vector<TetIndex> pending_;
  std::vector<Accepted> accepted_;  ///< by tet, as of the last time it was pending
  std::vector<Proposal> proposals_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
  std::vector<Point> places_;
  std::vector<double> sizes_;
};

}  // namespace

RefineReport refine_complex(TetComplex& complex, const SizeField& size, Context& context) {
  const StageTimer timer(context, "refine");
  return Refinement(complex, size, context).run();
}

}  // namespace delfront
