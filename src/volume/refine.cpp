// SPDX-License-Identifier: Apache-2.0
// Frontal Delaunay refinement in rounds (Rebay 1993; Marot, Pellerin & Remacle 2019). Terms: a tet is accepted when its
// circumsphere is about as large as its vertices' sizes ask; the front is the faces between accepted tets (or the
// boundary) and tets that are not. A tet at the front proposes the point that would make a good tet over that face, but
// never beyond its own circumcentre. Proposals go in along a Hilbert curve, in territories along it that threads share
// out; the kernel refuses those too close to another point. What lies near a border of the territories is proposed
// again in the next round, when another curve draws the borders elsewhere.
#include "volume/refine.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/hilbert.hpp"
#include "base/parallel.hpp"
#include "delaunay/territories.hpp"
#include "volume/core.hpp"

namespace delfront {

namespace {

constexpr double kRegularRadius = 0.61237243569579452;  ///< circumradius of a regular tet of side 1: sqrt(6) / 4
constexpr double kAcceptedRadius = 1.30 * kRegularRadius;
constexpr double kMinDistance = 0.70;      ///< of the wanted size, between points
constexpr std::uint64_t kMaxSteps = 1000;  ///< to a proposal's tet, 5 on average: beyond, a walk among slivers wanders
constexpr std::size_t kPointsPerCancelCheck = 256;
constexpr std::size_t kTriesPerPoint = 1000, kCheapTries = 1 << 14;  ///< more for a point are too many, if not cheap
constexpr std::size_t kRecent = 16;                                  ///< points inserted last that are looked at first
constexpr double kFar = 1e150;
constexpr std::size_t kGrain = 1 << 12;
constexpr std::size_t kSlotsPerProposal = 4;  ///< a third of the proposals become points, of 5.7 tets each
constexpr std::size_t kVerticesPerTerritory = 1 << 16, kMaxTerritories = 256;
constexpr std::size_t kWorthTerritories = 1 << 12;  ///< proposals
constexpr unsigned kPasses = 3;
constexpr std::size_t kWorthRadixSort = 4096;

struct Proposal {
  Point at;
  TetIndex tet;
  VertexIndex near;  ///< a vertex of the tet
  std::uint32_t region;
  std::uint16_t way;  ///< which of the tet's proposals it is, as a State bit
};

struct Sphere {
  Point centre;
  double squared_radius;  ///< not finite for a flat tet
};

Sphere circumsphere(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point u = b - a, v = c - a, w = d - a, vw = cross(v, w);
  const Point offset =
      (squared_length(u) * vw + squared_length(v) * cross(w, u) + squared_length(w) * cross(u, v)) / (2 * dot(u, vw));
  return {a + offset, squared_length(offset)};
}

/// The points that one territory inserted last: what most proposals of tets that are gone run into.
class Recent {
 public:
  Recent() { places_.fill({kFar, kFar, kFar}); }
  void add(const Point& p) { places_[count_++ % kRecent] = p; }
  bool is_near(const Point& p, double distance) const {
    return std::any_of(places_.begin(), places_.end(),
                       [&](const Point& q) { return squared_length(p - q) < distance * distance; });
  }

 private:
  std::array<Point, kRecent> places_;
  std::size_t count_ = 0;
};

class Refinement {
 public:
  Refinement(TetComplex& complex, const SizeField& size, bool is_frontal, Context& context)
      : c_(complex),
        size_(size),
        is_frontal_(is_frontal),
        context_(context),
        curve_{curve_over(complex, 0), curve_over(complex, 1)} {}

  RefineReport run() {
    state_.assign(c_.num_slots(), queued);
    for (TetIndex t = 0; t < c_.num_slots(); ++t) fresh_.push_back(t);
    for (auto& key : key_) key.resize(c_.num_vertices());
    for (VertexIndex v = 0; v < c_.num_vertices(); ++v) set_keys(v);
    run_front();
    // What the front could not reach (all, without one): circumcentres; where those lie behind the boundary: centroids.
    fill_gaps(Placement::circumcentre);
    fill_gaps(Placement::centroid);
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

  /// What comes of one territory, and what it may use.
  struct Work {
    std::vector<VertexIndex> vertices;  ///< free numbers
    std::vector<TetIndex> fresh;
    std::vector<TetIndex> left;  ///< tets whose proposals have to wait
    Recent recent;
    std::size_t inserted = 0, tried = 0;
  };

  static constexpr std::size_t kCurves = 2;
  std::size_t curve_of_round() const { return report_.rounds % kCurves; }

  void run_front() {
    while (is_frontal_ && (run_round(Placement::over_face) > 0 || num_left_ > 0)) {
    }
  }

  /// Gives all large tets a try, until next to none of them gets a point; the front goes on from those that do.
  void fill_gaps(Placement placement) {
    for (bool is_worthwhile = true; is_worthwhile;) {
      for (TetIndex t = 0; t < c_.num_slots(); ++t) enqueue(t);
      const std::size_t before = report_.candidates;
      std::size_t inserted = 0;
      do inserted += run_round(placement);
      while (num_left_ > 0);
      const std::size_t tried = report_.candidates - before;
      is_worthwhile = inserted > (tried > kCheapTries ? tried / kTriesPerPoint : 0);
      run_front();
    }
  }

  std::size_t run_round(Placement placement) {
    context_.progress("refine", c_.num_live(), 0, "cells");
    context_.check_cells(c_.num_live());
    classify_fresh();
    propose(placement);
    sort_proposals();
    const std::size_t inserted = insert();
    ++report_.rounds;
    return inserted;
  }

  /// By vertex, what its place along each curve says of territories.
  void set_keys(VertexIndex v) {
    for (std::size_t i = 0; i < kCurves; ++i) key_[i][v] = territory_key(curve_[i].key(c_.point(v)));
  }

  bool is_live(TetIndex t) const { return !c_.is_dead(t) && !c_.is_ghost(t); }

  double mean_size(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return (c_.vertex[n[0]].h + c_.vertex[n[1]].h + c_.vertex[n[2]].h + c_.vertex[n[3]].h) / 4;
  }

  Point centroid(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return 0.25 * (c_.point(n[0]) + c_.point(n[1]) + c_.point(n[2]) + c_.point(n[3]));
  }

  Sphere sphere(TetIndex t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return circumsphere(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(n[3]));
  }

  bool is_accepted(TetIndex t) const {
    const double radius = kAcceptedRadius * mean_size(t);
    return sphere(t).squared_radius <= radius * radius;
  }

  void enqueue(TetIndex t) {
    if (state_[t] & queued) return;
    state_[t] |= queued;
    fresh_.push_back(t);
  }

  /// Who may propose now and could not before: fresh tets, and tets that the front has come to.
  void classify_fresh() {
    parallel_ranges(context_.threads, fresh_.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const TetIndex t = fresh_[i];
        state_[t] &= static_cast<std::uint16_t>(~queued);
        if (is_live(t) && !(state_[t] & (accepted | large))) state_[t] |= is_accepted(t) ? accepted : large;
      }
    });
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
    fresh_.release();
  }

  void propose(Placement placement) {
    const std::size_t chunks = (candidates_.size() + kGrain - 1) / kGrain;
    std::vector<std::vector<Proposal>> parts(chunks);
    parallel_ranges(context_.threads, candidates_.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) propose_for(candidates_[i], placement, parts[first / kGrain]);
    });
    proposals_.clear();
    for (const std::vector<Proposal>& part : parts) proposals_.insert(proposals_.end(), part.begin(), part.end());
    report_.candidates += proposals_.size();
  }

  void propose_for(TetIndex t, Placement placement, std::vector<Proposal>& out) const {
    const Sphere s = sphere(t);
    if (!std::isfinite(s.squared_radius)) return;
    const VertexIndex near = c_.node[4 * t];
    if (placement == Placement::over_face)
      propose_over_face(t, s, out);
    else if (placement == Placement::circumcentre && !(state_[t] & refused_circumcentre))
      out.push_back({s.centre, t, near, c_.region[t], refused_circumcentre});
    else if (placement == Placement::centroid && !(state_[t] & refused_centroid))
      out.push_back({centroid(t), t, near, c_.region[t], refused_centroid});
  }

  /// Over the front face whose point would lie nearest to it.
  void propose_over_face(TetIndex t, const Sphere& s, std::vector<Proposal>& out) const {
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
    if (found) out.push_back(proposal);
  }

  /// Along the curve of this round; sizes for all of them.
  void sort_proposals() {
    const std::size_t n = proposals_.size();
    const HilbertCurve& curve = curve_[curve_of_round()];
    order_.resize(n);
    parallel_ranges(context_.threads, n, kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        order_[i] = {curve.key(proposals_[i].at), static_cast<std::uint32_t>(i)};
    });
    if (n < kWorthRadixSort)
      std::sort(order_.begin(), order_.end());
    else
      radix_sort(order_, context_.threads);
    places_.resize(n);
    sizes_.resize(n);
    parallel_ranges(context_.threads, n, kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) places_[i] = proposals_[order_[i].second].at;
      context_.check_limits();
      size_.sizes({&places_[first], last - first}, {&sizes_[first], last - first});
    });
  }

  std::size_t num_territories() const {
    // Where most had to wait, all go in at once: so every round gets on.
    if (order_.size() < kWorthTerritories || 2 * num_left_ > order_.size()) return 1;
    return std::clamp<std::size_t>(std::bit_floor(c_.num_vertices() / kVerticesPerTerritory), 1, kMaxTerritories);
  }

  std::size_t insert() {
    Territories territories(
        c_, num_territories(), order_.size(), [&](std::size_t k) { return territory_key(order_[k].first); },
        kSlotsPerProposal);
    std::vector<Work> works(territories.size());
    for (std::size_t i = 0; i < works.size(); ++i)
      works[i].vertices = c_.take_vertices(territories[i].end - territories[i].begin);
    state_.resize(c_.num_slots(), 0);
    for (auto& key : key_) key.resize(c_.num_vertices());
    is_ours_.resize(order_.size());
    const std::uint32_t* const key = key_[curve_of_round()].data();
    // First, since later a tet that is not ours may be in the hands of another thread.
    territories.run(key, context_.threads, [&](Territories::Part& part, std::size_t) {
      for (std::size_t k = part.begin; k < part.end; ++k)
        is_ours_[k] = part.kernel.is_ours(proposals_[order_[k].second].tet);
    });
    territories.run(key, context_.threads, [&](Territories::Part& part, std::size_t i) { insert_in(part, works[i]); });
    territories.finish(report_.kernel);
    return collect(works);
  }

  std::size_t collect(const std::vector<Work>& works) {
    std::size_t inserted = 0;
    num_left_ = 0;
    for (const Work& work : works) {
      inserted += work.inserted;
      num_left_ += work.left.size();
      c_.give_vertices(work.vertices);
      for (const TetIndex t : work.fresh) fresh_.push_back(t);
    }
    for (const Work& work : works)
      for (const TetIndex t : work.left)
        if (is_live(t)) enqueue(t);
    report_.points_inserted += inserted;
    return inserted;
  }

  /// A few first, then all, so that the front does not grow from one end, among the long tets there.
  void insert_in(Territories::Part& part, Work& work) {
    for (unsigned pass = 0; pass < kPasses; ++pass)
      for (std::size_t k = part.begin; k < part.end; ++k)
        if (pass_of(k) == pass) {
          if (work.tried++ % kPointsPerCancelCheck == 0) context_.check_limits();
          insert_proposal(part.kernel, work, k);
        }
  }

  static unsigned pass_of(std::size_t k) {
    const auto scrambled = static_cast<unsigned>(k * 0x9e3779b97f4a7c15ull >> 58);
    return scrambled == 0 ? 0 : scrambled % 8 == 0 ? 1 : 2;
  }

  void insert_proposal(DelaunayKernel& kernel, Work& work, std::size_t k) {
    const Proposal& p = proposals_[order_[k].second];
    if (!is_ours_[k]) {
      work.left.push_back(p.tet);
      return;
    }
    const bool is_there = is_unchanged(p.tet);
    if (!is_there && work.recent.is_near(p.at, kMinDistance * sizes_[k])) return;
    const auto result = insert_one(kernel, work, p, sizes_[k], is_there);
    if (result == DelaunayKernel::Insert::done)
      ++work.inserted;
    else if (is_there && result == DelaunayKernel::Insert::not_ours)
      work.left.push_back(p.tet);
    else if (is_there)
      state_[p.tet] |= p.way;
  }

  DelaunayKernel::Insert insert_one(DelaunayKernel& kernel, Work& work, const Proposal& p, double h, bool is_there) {
    const VertexIndex v = work.vertices.back();
    c_.set_vertex(v, p.at, h);
    TetIndex holder = kernel.locate(v, is_there ? p.tet : c_.vertex_tet[p.near], kMaxSteps);
    if (holder != kNoIndex && c_.is_ghost(holder) && !is_there)  // the walk may have left a hollow: from elsewhere
      holder = kernel.locate(v, p.tet, kMaxSteps);
    if (holder == kNoIndex) return kernel.is_confined() ? DelaunayKernel::Insert::not_ours : kRefused;
    if (c_.is_ghost(holder) || c_.region[holder] != p.region) return kRefused;
    const auto result = kernel.insert_into(holder, v, {.min_distance = kMinDistance * h, .constrained = true});
    if (result != DelaunayKernel::Insert::done) return result;
    work.vertices.pop_back();
    set_keys(v);
    work.recent.add(p.at);
    if (!kernel.is_confined()) state_.resize(c_.num_slots(), 0);  // it may have grown
    for (const TetIndex t : kernel.made()) {
      if (!(state_[t] & queued)) work.fresh.push_back(t);
      state_[t] = queued;
    }
    return result;
  }

  /// Whether the slot still has the tet that stood there when the round began.
  bool is_unchanged(TetIndex t) const { return is_live(t) && !(state_[t] & queued); }

  static constexpr auto kRefused = DelaunayKernel::Insert::not_visible;

  TetComplex& c_;
  const SizeField& size_;
  const bool is_frontal_;
  Context& context_;
  std::array<HilbertCurve, kCurves> curve_;
  std::array<FlatArray<std::uint32_t>, kCurves> key_;  ///< by vertex: the upper half of its place along each curve
  RefineReport report_;
  FlatArray<std::uint16_t> state_;  ///< by tet, bits of State
  FlatArray<TetIndex> fresh_;       ///< made since the last round
  FlatArray<TetIndex> candidates_;  ///< who may propose
  std::vector<Proposal> proposals_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;  ///< place along the curve, proposal
  FlatArray<std::uint8_t> is_ours_;  ///< by order: whether the proposing tet lies in the territory
  FlatArray<Point> places_;
  FlatArray<double> sizes_;
  std::size_t num_left_ = 0;  ///< proposals of the last round that have to wait
};

}  // namespace

RefineReport refine_complex(TetComplex& complex, const SizeField& size, const VolumeOptions& options,
                            Context& context) {
  const StageTimer timer(context, "refine");
  KernelCounts counts;
  const bool is_frontal = options.method != "delaunay";
  const std::size_t in_core = options.core && is_frontal ? fill_core(complex, size, counts, context) : 0;
  RefineReport report = Refinement(complex, size, is_frontal, context).run();
  report.points_in_core = in_core;
  report.points_inserted += in_core;
  add_counts(report.kernel, counts);
  return report;
}

}  // namespace delfront
