// SPDX-License-Identifier: Apache-2.0
// Frontal Delaunay refinement in rounds (Rebay 1993). Terms: a triangle is accepted when its circle is about as large
// as its vertices' sizes ask; the front is the edges between accepted triangles (or the boundary) and those that are
// not. A triangle at the front proposes the point that would make a good triangle over that edge, but never beyond its
// own circumcentre. Proposals go in in the order of the last round's, which follows the front; the kernel refuses those
// too close to another point or to the boundary.
#include "planar/refine.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/hilbert.hpp"

namespace delfront {

namespace {

constexpr double kAcceptedRadius = 0.75;    ///< of the wanted size; the regular triangle has 0.577
constexpr double kMinDistance = 0.72;       ///< of the wanted size, between points
constexpr double kLongestOverEdge = 1.6;    ///< sides over a short edge, of its length: 36 degrees between them
constexpr double kShortestOverEdge = 0.68;  ///< sides over a long edge, of its length: 95 degrees between them
constexpr double kFloor = 0.75;             ///< of a given segment: no smaller size at its ends
constexpr double kFloorDecay = 0.75;        ///< of that a layer further in
constexpr std::size_t kPointsPerCancelCheck = 4096;

/// What is known of a triangle, in its flags; all of it goes when its slot is used again.
enum State : std::uint32_t {
  queued = 1u << 5,  ///< made since the last round
  accepted = 1u << 6,
  large = 1u << 7,      ///< not accepted
  listed = 1u << 8,     ///< in candidates_ while that is put together
  refused_0 = 1u << 9,  ///< three bits: the point over edge e was refused; that would happen again
  refused_circumcentre = 1u << 12,
};

struct Proposal {
  Point2 at;
  TriIndex tri;
  double floor;       ///< no smaller size there; see set_floors()
  EdgeRef behind;     ///< the edge it stands over, from behind; kNoTri for none
  std::uint32_t way;  ///< which of the triangle's proposals it is, as a State bit
  std::uint32_t region;
};

class Refinement {
 public:
  Refinement(PlanarGrid& grid, const SizeField& size, PointPlacement placement, Context& context)
      : grid_(grid),
        c_(grid.complex),
        size_(size),
        placement_(placement),
        context_(context),
        kernel_(c_),
        curve_(c_.point) {}

  RefineReport run() {
    set_floors();
    kernel_.flags_of_new = queued;
    kernel_.last_tri = 0;
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (c_.is_dead(t)) continue;
      c_.tri[t].flags = (c_.tri[t].flags & kEdgeBits) | queued;
      fresh_.push_back(t);
    }
    const bool has_front = placement_ == PointPlacement::frontal;
    for (bool is_frontal = has_front;;) {
      collect_candidates();
      propose(is_frontal);
      ask_sizes();
      const std::size_t inserted = insert();
      ++report_.rounds;
      if (inserted > 0) {
        is_frontal = has_front;  // the front goes on from there
        continue;
      }
      if (!is_frontal) break;
      is_frontal = false;  // what the front could not reach: circumcentres
      for (TriIndex t = 0; t < c_.tri.size(); ++t) {
        if (!is_inside(t)) continue;
        c_.tri[t].flags = (c_.tri[t].flags & ~(accepted | large)) | queued;
        fresh_.push_back(t);
      }
    }
    for (Triangle& t : c_.tri) t.flags &= kEdgeBits | kDead;
    return report_;
  }

  /// Where sizes are much less than a given segment, points crowd round a long edge and angles get bad whatever is
  /// done. So sizes start from nearly the segments' lengths there and come down to the field's layer by layer.
  void set_floors() {
    floor_.assign(c_.point.size(), 0);
    for (const PlanarPiece& piece : grid_.pieces) {
      const double lowest = kFloor * std::sqrt(squared_length(c_.point[piece.b] - c_.point[piece.a]));
      for (const VertexIndex v : {piece.a, piece.b})
        if (c_.h[v] < lowest) floor_[v] = floor_[v] > 0 ? std::min(floor_[v], lowest) : lowest;
    }
    for (VertexIndex v = 0; v < floor_.size(); ++v) c_.h[v] = std::max(c_.h[v], floor_[v]);
  }

  const PlanarCounts& counts() const { return kernel_.counts; }

 private:
  bool is_inside(TriIndex t) const { return c_.tri[t].region != kOutside && !c_.is_dead(t); }

  double mean_size(const Triangle& s) const { return (c_.h[s.node[0]] + c_.h[s.node[1]] + c_.h[s.node[2]]) / 3; }

  /// R^2 = a^2 b^2 c^2 / (16 area^2), without dividing.
  bool is_accepted(const Triangle& s) const {
    const Point2 a = c_.point[s.node[0]], b = c_.point[s.node[1]], d = c_.point[s.node[2]];
    const double radius = kAcceptedRadius * mean_size(s), area2 = cross(b - a, d - a);
    return squared_length(b - a) * squared_length(d - b) * squared_length(a - d) <= 4 * radius * radius * area2 * area2;
  }

  /// Who may propose now and could not before: fresh triangles, and those that the front has come to.
  void collect_candidates() {
    std::size_t num_fresh = 0;
    for (const TriIndex t : fresh_) {
      Triangle& s = c_.tri[t];
      if (!(s.flags & queued)) continue;
      s.flags &= ~queued;
      if (!is_inside(t)) continue;
      s.flags |= is_accepted(s) ? accepted : large;
      fresh_[num_fresh++] = t;
    }
    fresh_.resize(num_fresh);
    candidates_.clear();
    const auto add = [&](TriIndex t) {
      Triangle& s = c_.tri[t];
      if ((s.flags & (large | listed)) != large) return;
      s.flags |= listed;
      candidates_.push_back(t);
    };
    for (const TriIndex t : fresh_) {
      add(t);
      if (c_.tri[t].flags & accepted)
        for (const EdgeRef ref : c_.tri[t].neigh) add(ref >> 2);
    }
    for (const TriIndex t : candidates_) c_.tri[t].flags &= ~listed;
    fresh_.clear();
  }

  void propose(bool is_frontal) {
    proposals_.clear();
    for (const TriIndex t : candidates_) {
      const Triangle& s = c_.tri[t];
      const Point2 centre = c_.to_circumcentre(s);
      if (!std::isfinite(squared_length(centre))) continue;
      if (is_frontal)
        propose_over_edge(t, s, c_.point[s.node[0]] + centre);
      else if (!(s.flags & refused_circumcentre))
        proposals_.push_back({c_.point[s.node[0]] + centre, t,
                              kFloorDecay / 3 * (floor_[s.node[0]] + floor_[s.node[1]] + floor_[s.node[2]]), kNoTri,
                              refused_circumcentre, s.region});
    }
    if (placement_ == PointPlacement::circumcentres) sort_along_curve();
    report_.candidates += proposals_.size();
  }

  /// Without a front the order of the last round soon follows nothing.
  void sort_along_curve() {
    keys_.clear();
    for (const Proposal& p : proposals_) keys_.push_back({curve_.key(p.at), static_cast<std::uint32_t>(keys_.size())});
    radix_sort(keys_);
    sorted_.clear();
    for (const auto& [key, i] : keys_) sorted_.push_back(proposals_[i]);
    proposals_.swap(sorted_);
  }

  /// Over the shortest edge of the front.
  void propose_over_edge(TriIndex t, const Triangle& s, Point2 centre) {
    double shortest = 1e300;
    Proposal proposal{{}, t, 0, kNoTri, 0, s.region};
    for (unsigned e = 0; e < 3; ++e) {
      if (s.flags & (refused_0 << e)) continue;
      const bool is_constrained = s.flags >> e & 1;
      if (!is_constrained && !(c_.tri[s.neigh[e] >> 2].flags & accepted)) continue;
      const VertexIndex v = s.node[next_of(e)], w = s.node[previous_of(e)];
      const Point2 a = c_.point[v], along = c_.point[w] - a;
      const double squared = squared_length(along);
      if (squared >= shortest) continue;
      const double edge = std::sqrt(squared), h = 0.5 * (c_.h[v] + c_.h[w]);
      const Point2 normal = {-along.y / edge, along.x / edge};
      const Point2 middle = a + 0.5 * along;
      const double up = dot(centre - middle, normal);
      if (up <= 0) continue;
      const double side = std::max(std::min(h, kLongestOverEdge * edge), kShortestOverEdge * edge);
      const double wanted = std::sqrt(side * side - 0.25 * squared);
      proposal.at = up <= wanted ? centre : middle + wanted * normal;
      proposal.way = refused_0 << e;
      proposal.behind = s.neigh[e];
      proposal.floor = kFloorDecay * 0.5 * (floor_[v] + floor_[w]);
      shortest = squared;
    }
    if (proposal.way) proposals_.push_back(proposal);
  }

  void ask_sizes() {
    places_.resize(proposals_.size());
    sizes_.resize(proposals_.size());
    for (std::size_t i = 0; i < proposals_.size(); ++i) places_[i] = {proposals_[i].at.x, proposals_[i].at.y, 0};
    evaluate_sizes(size_, places_, sizes_, context_);
    for (std::size_t i = 0; i < proposals_.size(); ++i)
      sizes_[i] = std::max(std::min(sizes_[i], grid_.region_h[proposals_[i].region]), proposals_[i].floor);
  }

  /// From the middle of a gap each: a point that goes in far from others of its round cuts a wide fan of the long
  /// triangles ahead of the front, and in the front's order every point would.
  std::size_t insert() {
    const std::size_t n = proposals_.size();
    std::size_t inserted = 0, seen = 0;
    const auto visit = [&](std::size_t i) {
      if (seen++ % kPointsPerCancelCheck == 0) {
        context_.progress("refine", c_.num_live(), 0, "cells");
        context_.check_cells(c_.num_live());
      }
      const Proposal& p = proposals_[i];
      if (insert_one(p, sizes_[i])) {
        floor_.push_back(p.floor);
        ++inserted;
      } else if (is_unchanged(p.tri))
        c_.tri[p.tri].flags |= p.way;
    };
    if (n > 0) visit(0);
    for (std::size_t stride = std::bit_ceil(n); stride > 1; stride /= 2)
      for (std::size_t i = stride / 2; i < n; i += stride) visit(i);
    return inserted;
  }

  bool is_unchanged(TriIndex t) const { return !(c_.tri[t].flags & queued); }

  /// Where to begin: at the triangle now over the front edge, from the one behind it, which rarely goes.
  TriIndex start_of(const Proposal& p) const {
    if (is_unchanged(p.tri) || p.behind == kNoTri || !is_unchanged(p.behind >> 2)) return p.tri;
    return c_.across(p.behind) >> 2;
  }

  bool insert_one(const Proposal& p, double h) {
    const TriIndex holder = kernel_.locate(p.at, start_of(p));
    if (c_.tri[holder].region != p.region) return false;
    const auto v = static_cast<VertexIndex>(c_.point.size());
    c_.point.push_back(p.at);
    if (kernel_.insert_into(holder, v, {.min_distance = kMinDistance * h, .keeps_off_segments = true}) !=
        PlanarKernel::Insert::done) {
      c_.point.pop_back();
      return false;
    }
    c_.h.push_back(h);
    ++report_.points_inserted;
    fresh_.insert(fresh_.end(), kernel_.made().begin(), kernel_.made().end());
    return true;
  }

  PlanarGrid& grid_;
  TriComplex& c_;
  const SizeField& size_;
  PointPlacement placement_;
  Context& context_;
  PlanarKernel kernel_;
  RefineReport report_;
  std::vector<TriIndex> fresh_;  ///< made since the last round; some more than once
  std::vector<TriIndex> candidates_;
  std::vector<Proposal> proposals_, sorted_;
  HilbertCurve2 curve_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys_;
  std::vector<Point> places_;
  std::vector<double> sizes_;
  std::vector<double> floor_;  ///< by vertex: no smaller size there, 0 for none
};

}  // namespace

RefineReport refine_complex(PlanarGrid& grid, const SizeField& size, Context& context, PointPlacement placement,
                            PlanarCounts* counts) {
  const StageTimer timer(context, "refine");
  Refinement refinement(grid, size, placement, context);
  const RefineReport report = refinement.run();
  if (counts) *counts = refinement.counts();
  return report;
}

}  // namespace delfront
