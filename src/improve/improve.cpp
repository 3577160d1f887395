// SPDX-License-Identifier: Apache-2.0
// The schedule: one scan finds the bad tets; then passes over them, cheap operations first: vertices that crowd others
// are removed, then swaps, smoothing of the tets' vertices, from the second pass on contraction and insertion for what
// stays. Only where an operation changed something are tets looked at again. Lists are kept in slot order and every
// decision depends on the complex alone, so the result does too.
#include "improve/improve.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "improve/operations.hpp"
#include "improve/sharpness.hpp"

namespace delfront {

namespace {

/// Swaps and smoothing aim this much higher than the goal, since they cost little; points are removed and added for
/// the goal alone.
constexpr double kStretch = 1.7;
constexpr double kMaxWorkAngle = 32;       // degrees; a regular tet has 70, but few vertices can have only those
constexpr double kCrowded = 0.4;           // of the wanted size: nearer neighbours than this are too many
constexpr double kEnough = 1.5;            // times the quality worked for: good enough to look no further
constexpr double kLeastScan = 1e-3;        // quality from which the search for the smallest angle starts
constexpr double kScarce = 0.01;           // of all cells: where fewer are bad, each is worth more trouble
constexpr double kFlatToRounding = 1e-13;  // squared sine of 2e-5 degrees
constexpr std::size_t kFreeUrgentTries = 300, kFreeFlatTries = 2000, kUrgentTriesForOne = 5;
constexpr double kExplained = 0.25;  // of the boundary's quality: no more can be expected
constexpr std::size_t kScanGrain = 1 << 15;

/// A cell is urgent below an angle, degrees, if its quality is below that of the boundary there by a factor.
struct Urgency {
  double flat, unexplained;
};
constexpr Urgency kUsual{1, 0.01}, kWhereBadAreScarce{6, 0.1};

/// One kind of operation, over the list of bad tets, in each pass from `first_pass` on.
///
/// A surface of needles leaves tets that nothing can mend. Where more than `free_tries` and `tries_for_one` times
/// the successes have been made, the sweep goes on with those alone that the boundary does not explain, from then on in
/// all passes; where that is too much again, it ends, and the next pass resumes there.
struct Sweep {
  std::size_t first_pass;
  std::size_t free_tries;
  std::size_t between_checks;  ///< tets between two cancellation points, so that these are some milliseconds apart
  std::size_t tries_for_one;   ///< fewer successes than one in so many tries are not worth the time
  double bound = 0;            ///< only tets whose quality is below this
  TetIndex resume = 0;
  bool was_cut = false;
  bool skips_explained = false;
};
constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max() / 2;

class Improver {
 public:
  Improver(TetComplex& complex, const ImproveOptions& options, Context& context)
      : c_(complex), context_(context), operations_(complex), options_(options) {}

  ImproveReport run();

 private:
  std::vector<TetIndex> find_below(double bound, TetIndex first, TetIndex last) const;
  void scan(double bound);
  bool is_below(TetIndex t, double bound) const {
    return !c_.is_dead(t) && !c_.is_ghost(t) && c_.region[t] != TetComplex::kOutside && operations_.quality(t) < bound;
  }
  bool is_bad(TetIndex t) const { return is_below(t, work_); }
  bool is_changed(bool changed);
  bool swap(TetIndex t);
  bool smooth(TetIndex t);
  bool contract(TetIndex t);
  bool thin_out(TetIndex t);
  bool is_first_visit(VertexIndex v);
  std::array<VertexIndex, 4> nodes(TetIndex t) const {
    return {c_.node[4 * t], c_.node[4 * t + 1], c_.node[4 * t + 2], c_.node[4 * t + 3]};
  }
  bool is_explained(TetIndex t, double share) const;
  bool is_urgent(TetIndex t) const;
  bool insert(TetIndex t);
  template <class Operation>
  void run_sweep(Sweep& sweep, Operation operation);
  bool is_stale(TetIndex t) const;
  void run_pass();
  std::size_t num_changes() const {
    return report_.face_swaps + report_.edge_swaps + report_.points_moved + report_.points_removed +
           report_.points_added;
  }
  double measure_least_dihedral();
  void count_left();

  TetComplex& c_;
  Context& context_;
  LocalOperations operations_;
  ImproveOptions options_;
  ImproveReport report_;
  double goal_ = 0;    ///< quality below which points are removed and added
  double work_ = 0;    ///< quality below which a tet is worked on
  double enough_ = 0;  ///< quality at which an operation looks no further
  Sweep thin_out_{.first_pass = 1, .free_tries = kUnlimited, .between_checks = 1024, .tries_for_one = 50};
  Sweep swap_{.first_pass = 1, .free_tries = kUnlimited, .between_checks = 1024, .tries_for_one = 50};
  Sweep smooth_{.first_pass = 1, .free_tries = 10000, .between_checks = 64, .tries_for_one = 50};
  Sweep contract_{.first_pass = 2, .free_tries = 10000, .between_checks = 512, .tries_for_one = 50};
  Sweep insert_{.first_pass = 2, .free_tries = 1000, .between_checks = 16, .tries_for_one = 12};
  std::vector<TetIndex> bad_, next_;         ///< in slot order
  std::vector<float> sharpness_;             ///< by vertex, those added by improvement left out
  std::vector<std::uint32_t> vertex_pass_;   ///< the last pass that changed a tet of this vertex
  std::vector<std::uint32_t> vertex_sweep_;  ///< the last sweep that visited this vertex
  std::uint32_t sweep_ = 0;
  std::size_t urgent_tries_ = 0, urgent_done_ = 0;
};

/// Tets [first, last) below a quality, four at a time.
std::vector<TetIndex> Improver::find_below(double bound, TetIndex first, TetIndex last) const {
  std::vector<TetIndex> found;
  FaceBlock block{};
  Lanes apex[3]{};
  TetIndex waiting[kLanes];
  std::size_t lane = 0;
  const auto flush = [&] {
    const Lanes q = measure_block(block, apex);
    for (std::size_t i = 0; i < lane; ++i)
      if (q[i] < bound) found.push_back(waiting[i]);
    lane = 0;
  };
  for (TetIndex t = first; t < last; ++t) {
    if (c_.is_dead(t) || c_.is_ghost(t) || c_.region[t] == TetComplex::kOutside) continue;
    const std::uint32_t* n = &c_.node[4 * t];
    for (unsigned i = 0; i < 4; ++i) {
      const TetVertex& v = c_.vertex[n[i]];
      auto& to = i < 3 ? block.corner[i] : apex;
      if (lane == 0) to[0] = to[1] = to[2] = Lanes{};
      to[0][lane] = v.x;
      to[1][lane] = v.y;
      to[2][lane] = v.z;
    }
    waiting[lane++] = t;
    if (lane == kLanes) flush();
  }
  flush();
  return found;
}

/// Tets below a quality, into bad_.
void Improver::scan(double bound) {
  const std::size_t slots = c_.num_slots();
  context_.progress("improve", 0, slots, "cells");
  std::vector<std::vector<TetIndex>> parts((slots + kScanGrain - 1) / kScanGrain);
  parallel_ranges(context_.threads, slots, kScanGrain, [&](std::size_t first, std::size_t last) {
    parts[first / kScanGrain] = find_below(bound, static_cast<TetIndex>(first), static_cast<TetIndex>(last));
  });
  bad_.clear();
  for (const std::vector<TetIndex>& part : parts) bad_.insert(bad_.end(), part.begin(), part.end());
}

bool Improver::is_changed(bool changed) {
  if (!changed) return false;
  vertex_pass_.resize(c_.num_vertices(), 0);
  for (const TetIndex t : operations_.touched) {
    for (unsigned i = 0; i < 4; ++i) vertex_pass_[c_.node[4 * t + i]] = static_cast<std::uint32_t>(report_.passes);
    if (is_bad(t)) next_.push_back(t);
  }
  return true;
}

/// Nothing near t has changed in this pass or the one before: what failed then would fail again.
bool Improver::is_stale(TetIndex t) const {
  for (unsigned i = 0; i < 4; ++i)
    if (vertex_pass_[c_.node[4 * t + i]] + 1 >= report_.passes) return false;
  return true;
}

bool Improver::swap(TetIndex t) {
  const auto kind = operations_.swap(t, enough_);
  report_.face_swaps += kind == LocalOperations::Swap::face ? 1 : 0;
  report_.edge_swaps += kind == LocalOperations::Swap::edge ? 1 : 0;
  return is_changed(kind != LocalOperations::Swap::none);
}

/// Each vertex once a sweep: it has many tets, and where most of them are bad it would be moved for each of them.
bool Improver::is_first_visit(VertexIndex v) {
  if (c_.on_boundary[v]) return false;
  vertex_sweep_.resize(c_.num_vertices(), 0);
  if (vertex_sweep_[v] == sweep_) return false;
  vertex_sweep_[v] = sweep_;
  return true;
}

bool Improver::smooth(TetIndex t) {
  bool changed = false;
  for (const VertexIndex v : nodes(t)) {
    if (!is_first_visit(v) || !is_changed(operations_.smooth(v, enough_))) continue;
    changed = true;
    ++report_.points_moved;
    if (!is_bad(t)) break;
  }
  return changed;
}

bool Improver::contract(TetIndex t) {
  for (const VertexIndex v : nodes(t)) {
    if (!is_first_visit(v) || !is_changed(operations_.contract(v))) continue;
    ++report_.points_removed;
    return true;
  }
  return false;
}

/// Vertices far nearer to a neighbour than the size asks (left over from boundary recovery): they cannot make good
/// tets.
bool Improver::thin_out(TetIndex t) {
  for (const VertexIndex v : nodes(t)) {
    if (c_.on_boundary[v]) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (const VertexIndex u : nodes(t))
      if (u != v) nearest = std::min(nearest, distance(c_.point(u), c_.point(v)));
    if (nearest > kCrowded * c_.vertex[v].h || !is_first_visit(v) || !is_changed(operations_.contract(v))) continue;
    ++report_.points_removed;
    return true;
  }
  return false;
}

/// Whether t is about as good as the boundary's own angles at its vertices: at least `share` of their quality.
bool Improver::is_explained(TetIndex t, double share) const {
  double sharpest = 1;
  for (const VertexIndex v : nodes(t))
    if (v < sharpness_.size()) sharpest = std::min(sharpest, static_cast<double>(sharpness_[v]));
  return operations_.quality(t) >= share * sharpest;
}

/// A cell of almost no volume that no sharp place of the boundary explains. Narrow gaps make many of those that nothing
/// can mend, which is noticed by the successes.
bool Improver::is_urgent(TetIndex t) const {
  const bool is_flat = is_below(t, kFlatToRounding);
  const std::size_t free_tries = is_flat ? kFreeFlatTries : kFreeUrgentTries;
  if (urgent_tries_ > free_tries + kUrgentTriesForOne * urgent_done_) return false;
  const bool are_scarce = static_cast<double>(bad_.size()) < kScarce * static_cast<double>(c_.num_live());
  const Urgency& urgency = are_scarce ? kWhereBadAreScarce : kUsual;
  return is_below(t, quality_of_angle(urgency.flat)) && !is_explained(t, urgency.unexplained);
}

bool Improver::insert(TetIndex t) {
  const bool urgent = is_urgent(t);
  const bool done = is_changed(operations_.insert(t, goal_, enough_, urgent));
  urgent_tries_ += urgent ? 1 : 0;
  urgent_done_ += urgent && done ? 1 : 0;
  report_.points_added += done ? 1 : 0;
  return done;
}

/// Apply an operation to every tet of bad_ that is still bad; afterwards bad_ holds what is left and what came new.
template <class Operation>
void Improver::run_sweep(Sweep& sweep, Operation operation) {
  if (report_.passes < sweep.first_pass) return;
  const bool takes_stale = report_.passes == sweep.first_pass || sweep.was_cut;
  const auto first = static_cast<std::size_t>(std::lower_bound(bad_.begin(), bad_.end(), sweep.resume) - bad_.begin());
  sweep.resume = 0;
  sweep.was_cut = false;
  ++sweep_;
  next_.clear();
  std::size_t tried = 0, done = 0;
  for (std::size_t i = 0; i < bad_.size(); ++i) {
    if (i % sweep.between_checks == 0) context_.progress("improve", i, bad_.size(), "cells");
    const TetIndex t = bad_[(first + i) % bad_.size()];
    if (!is_bad(t)) continue;
    next_.push_back(t);
    if (sweep.was_cut || !is_below(t, sweep.bound) || (!takes_stale && is_stale(t))) continue;
    if (sweep.skips_explained && is_explained(t, kExplained)) continue;
    ++tried;
    if (operation(t)) ++done;
    if (tried <= sweep.free_tries + sweep.tries_for_one * done) continue;
    if (sweep.skips_explained) {
      sweep.was_cut = true;
      sweep.resume = t;
    }
    sweep.skips_explained = true;
    tried = done = 0;
  }
  std::sort(next_.begin(), next_.end());
  next_.erase(std::unique(next_.begin(), next_.end()), next_.end());
  next_.erase(std::remove_if(next_.begin(), next_.end(), [this](TetIndex t) { return !is_bad(t); }), next_.end());
  bad_.swap(next_);
}

/// The smallest dihedral angle of all, degrees. Leaves bad_ filled with the tets below work_.
double Improver::measure_least_dihedral() {
  double least = std::numbers::pi;
  for (double bound = std::max(work_, kLeastScan); bound < 1; bound *= 1.5) {
    scan(bound);
    for (const TetIndex t : bad_) {
      const auto [p, q, r, v] = nodes(t);
      least = std::min(least, measure_dihedrals(c_.point(p), c_.point(q), c_.point(r), c_.point(v)).least);
    }
    // What was not listed has a sine above the root of the bound; so this is the smallest.
    if (least < std::numbers::pi / 2 && std::sin(least) * std::sin(least) <= bound) break;
  }
  bad_.erase(std::remove_if(bad_.begin(), bad_.end(), [this](TetIndex t) { return !is_bad(t); }), bad_.end());
  return least * 180 / std::numbers::pi;
}

void Improver::count_left() {
  for (const TetIndex t : bad_) {
    if (!is_below(t, goal_)) continue;
    ++report_.below_goal;
    const auto n = nodes(t);
    if (c_.on_boundary[n[0]] && c_.on_boundary[n[1]] && c_.on_boundary[n[2]] && c_.on_boundary[n[3]])
      ++report_.below_goal_forced;
  }
}

void Improver::run_pass() {
  ++report_.passes;
  run_sweep(thin_out_, [this](TetIndex t) { return thin_out(t); });
  run_sweep(swap_, [this](TetIndex t) { return swap(t); });
  run_sweep(smooth_, [this](TetIndex t) { return smooth(t); });
  run_sweep(contract_, [this](TetIndex t) { return contract(t); });
  run_sweep(insert_, [this](TetIndex t) { return insert(t); });
}

ImproveReport Improver::run() {
  goal_ = quality_of_angle(options_.min_dihedral);
  work_ = quality_of_angle(std::max(options_.min_dihedral, std::min(kStretch * options_.min_dihedral, kMaxWorkAngle)));
  enough_ = kEnough * work_;
  thin_out_.bound = contract_.bound = insert_.bound = goal_;
  swap_.bound = smooth_.bound = work_;
  vertex_pass_.assign(c_.num_vertices(), 0);
  report_.min_dihedral_before_deg = measure_least_dihedral();
  sharpness_ = measure_sharpness(c_);
  const int max_passes = options_.enabled ? options_.max_passes : 0;
  for (int pass = 0; pass < max_passes && !bad_.empty(); ++pass) {
    const std::size_t before = num_changes();
    run_pass();
    if (pass > 0 && num_changes() == before) break;
  }
  report_.points_removed += operations_.num_dropped;
  report_.min_dihedral_after_deg = measure_least_dihedral();
  count_left();
  return report_;
}

}  // namespace

ImproveReport improve_complex(TetComplex& complex, const SizeField&, const ImproveOptions& options, Context& context) {
  const StageTimer timer(context, "improve");
  return Improver(complex, options, context).run();
}

}  // namespace delfront
