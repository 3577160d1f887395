// SPDX-License-Identifier: Apache-2.0
// Frontal Delaunay refinement in rounds (Rebay 1993; Marot, Pellerin & Remacle 2019). Terms: a tet is accepted when its
// circumsphere is about as large as its vertices' sizes ask; the front is the faces between accepted tets (or the
// boundary) and tets that are not. A tet at the front proposes the point that would make a good tet over that face, but
// never beyond its own circumcentre. Proposals go in along the Hilbert curve; the kernel refuses those too close to
// another.
#include "volume/refine.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/hilbert.hpp"

namespace delfront {

namespace {

constexpr double kRegularRadius = 0.61237243569579452;  ///< circumradius of a regular tet of side 1: sqrt(6) / 4
constexpr double kAcceptedRadius = 1.30 * kRegularRadius;
constexpr double kMinDistance = 0.70;  ///< of the wanted size, between points
constexpr std::size_t kPointsPerCancelCheck = 4096;
constexpr std::uint64_t kMaxSteps = 1000;  ///< to a proposal's tet, 5 on average: beyond, a walk among slivers wanders
constexpr std::size_t kRecent = 16;        ///< points inserted last that are looked at first
constexpr double kFar = 1e150;
constexpr std::size_t kWorthRadixSort = 4096;

struct Proposal {
  Point at;
  TetIndex tet;
  VertexIndex near;  ///< a vertex near it
  std::uint32_t region;
  std::uint16_t way;  ///< which of the tet's proposals it is, as a State bit
};

class Refinement {
 public:
  Refinement(TetComplex& complex, const SizeField& size, Context& context)
      : c_(complex), size_(size), context_(context), kernel_(complex) {}

  RefineReport run() {
    kernel_.keep_spheres();
    recent_.fill({kFar, kFar, kFar});
    state_.assign(c_.num_slots(), queued);
    for (TetIndex t = 0; t < c_.num_slots(); ++t) fresh_.push_back(t);
    for (Placement placement = Placement::over_face;;) {
      classify_fresh();
      propose(placement);
      ask_sizes();
      const std::size_t inserted = insert();
      ++report_.rounds;
      if (inserted > 0) {
        placement = Placement::over_face;  // the front goes on from there
        continue;
      }
      if (placement == Placement::centroid) break;
      // What the front could not reach: circumcentres; where those lie behind the boundary: centroids.
      placement = placement == Placement::over_face ? Placement::circumcentre : Placement::centroid;
      for (TetIndex t = 0; t < c_.num_slots(); ++t) enqueue(t);
    }
    return report_;
  }

 private:
  /// What is known of a tet; all of it goes when its slot is used again.
  enum State : std::uint16_t {
    refused_0 = 1,  ///< bits 0-3: the point over face f was refused; that would happen again
    refused_circumcentre = 1 << 4,
    refused_centroid = 1 << 5,
    accepted = 1 << 6,
    large = 1 << 7,  ///< not accepted
    queued = 1 << 8  ///< in fresh_, or in candidates_ while that is put together
  };

  enum class Placement : std::uint8_t { over_face, circumcentre, centroid };

  bool is_live(TetIndex t) const { return !c_.is_dead(t) && !c_.is_ghost(t); }

  double mean_size(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return (c_.vertex[n[0]].h + c_.vertex[n[1]].h + c_.vertex[n[2]].h + c_.vertex[n[3]].h) / 4;
  }

  Point centroid(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return 0.25 * (c_.point(n[0]) + c_.point(n[1]) + c_.point(n[2]) + c_.point(n[3]));
  }

  bool is_accepted(TetIndex t) const {
    const double radius = kAcceptedRadius * mean_size(t);
    return std::abs(kernel_.sphere(t).squared_radius) <= radius * radius;
  }

  void enqueue(TetIndex t) {
    if (state_[t] & queued) return;
    state_[t] |= queued;
    fresh_.push_back(t);
  }

  /// Who may propose now and could not before: fresh tets, and tets that the front has come to.
  void classify_fresh() {
    for (const TetIndex t : fresh_) {
      state_[t] &= static_cast<std::uint16_t>(~queued);
      if (is_live(t) && !(state_[t] & (accepted | large))) state_[t] |= is_accepted(t) ? accepted : large;
    }
    candidates_.clear();
    auto add = [&](TetIndex t) {
      if ((state_[t] & (large | queued)) != large) return;
      state_[t] |= queued;
      candidates_.push_back(t);
    };
    for (const TetIndex t : fresh_) {
      if (!is_live(t)) continue;
      add(t);
      if (state_[t] & accepted)
        for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) add(c_.neigh[ref] >> 2);
    }
    for (const TetIndex t : candidates_) state_[t] &= static_cast<std::uint16_t>(~queued);
    fresh_.clear();
  }

  void propose(Placement placement) {
    proposals_.clear();
    for (const TetIndex t : candidates_) {
      const Circumsphere& s = kernel_.sphere(t);
      if (!std::isfinite(s.squared_radius)) continue;
      if (placement == Placement::over_face)
        propose_over_face(t, s);
      else if (placement == Placement::circumcentre)
        propose_at(s.centre, t, refused_circumcentre);
      else
        propose_at(centroid(t), t, refused_centroid);
    }
    report_.candidates += proposals_.size();
  }

  void propose_at(Point at, TetIndex t, std::uint16_t way) {
    if (!(state_[t] & way)) proposals_.push_back({at, t, c_.node[4 * t], c_.region[t], way});
  }

  /// Over the front face whose point would lie nearest to it.
  void propose_over_face(TetIndex t, const Circumsphere& s) {
    bool found = false;
    double best = 0;
    Proposal proposal{{}, t, kNoIndex, c_.region[t], 0};
    for (unsigned f = 0; f < 4; ++f) {
      const FaceRef ref = 4 * t + f;
      if (state_[t] & (refused_0 << f)) continue;
      if (!c_.is_constrained(ref) && !(state_[c_.neigh[ref] >> 2] & accepted)) continue;
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
      proposal.way = static_cast<std::uint16_t>(refused_0 << f);
      proposal.near = n[0];
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
    if (order_.size() < kWorthRadixSort)
      std::sort(order_.begin(), order_.end());
    else
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
      if (!is_unchanged(p.tet) && is_near_recent(p.at, kMinDistance * sizes_[k])) continue;
      if (insert_one(p, sizes_[k]))
        ++inserted;
      else if (is_unchanged(p.tet))
        state_[p.tet] |= p.way;
    }
    return inserted;
  }

  /// Whether one of the points inserted last is in the way: what most proposals of tets that are gone run into.
  bool is_near_recent(const Point& p, double distance) const {
    for (const Point& q : recent_)
      if (squared_length(p - q) < distance * distance) return true;
    return false;
  }

  /// Whether the slot still has the tet that stood there when the round began.
  bool is_unchanged(TetIndex t) const { return is_live(t) && !(state_[t] & queued); }

  bool insert_one(const Proposal& p, double h) {
    const VertexIndex v = c_.add_vertex(p.at, h);
    const bool is_there = is_unchanged(p.tet);
    TetIndex holder = kernel_.locate(v, is_there ? p.tet : c_.vertex_tet[p.near], kMaxSteps);
    if (holder != kNoIndex && c_.is_ghost(holder) && !is_there)  // the walk may have left a hollow: from elsewhere
      holder = kernel_.locate(v, p.tet, kMaxSteps);
    bool done = false;
    if (holder != kNoIndex && !c_.is_ghost(holder) && c_.region[holder] == p.region)
      done = kernel_.insert_into(holder, v, {.min_distance = kMinDistance * h, .constrained = true}) ==
             DelaunayKernel::Insert::done;
    if (!done) {
      c_.remove_last_vertex();
      return false;
    }
    recent_[report_.points_inserted++ % kRecent] = p.at;
    state_.resize(c_.num_slots(), 0);
    for (const TetIndex t : kernel_.made()) {
      if (!(state_[t] & queued)) fresh_.push_back(t);
      state_[t] = queued;
    }
    return true;
  }

  TetComplex& c_;
  const SizeField& size_;
  Context& context_;
  DelaunayKernel kernel_;
  RefineReport report_;
  std::vector<std::uint16_t> state_;  ///< by tet, bits of State
  std::vector<TetIndex> fresh_;       ///< made since the last round
  std::vector<TetIndex> candidates_;
  std::vector<Proposal> proposals_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
  std::vector<Point> places_;
  std::vector<double> sizes_;
  std::array<Point, kRecent> recent_;
};

}  // namespace

RefineReport refine_complex(TetComplex& complex, const SizeField& size, Context& context) {
  const StageTimer timer(context, "refine");
  return Refinement(complex, size, context).run();
}

}  // namespace delfront
