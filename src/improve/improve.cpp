// SPDX-License-Identifier: Apache-2.0
// The schedule: one scan finds the bad tets; then passes over them, cheap operations first: swaps, smoothing of their
// vertices, contraction and insertion for what stays. Only tets that an operation touched are looked at again. Lists
// are kept in slot order and every decision depends on the complex alone, so the result does too.
#include "improve/improve.hpp"

#include <algorithm>

#include "improve/operations.hpp"

namespace delfront {

namespace {

/// Swaps and smoothing aim this much higher than the goal, since they cost little; points are removed and added for
/// the goal alone.
constexpr double kStretch = 1.7;
constexpr double kMaxWorkAngle = 32;  // degrees; a regular tet has 70, but few vertices can have only those
constexpr double kCrowded = 0.4;      // of the wanted size: nearer neighbours than this are too many
constexpr double kEnough = 1.5;       // times the quality worked for: good enough to look no further
// Tets between two cancellation points, so that these are a few milliseconds apart.
constexpr std::size_t kSwapsBetweenChecks = 1024, kSmoothsBetweenChecks = 128, kInsertionsBetweenChecks = 16;
constexpr std::size_t kScansBetweenChecks = 1 << 16;

class Improver {
 public:
  Improver(TetComplex& complex, const ImproveOptions& options, Context& context)
      : c_(complex), context_(context), operations_(complex), options_(options) {}

  ImproveReport run();

 private:
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
  bool insert(TetIndex t);
  template <class Operation>
  void sweep(std::size_t first_pass, std::size_t between_checks, Operation operation);
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
  std::vector<TetIndex> bad_, next_;
  std::vector<std::uint32_t> vertex_pass_;   ///< the last pass that changed a tet of this vertex
  std::vector<std::uint32_t> vertex_sweep_;  ///< the last sweep that visited this vertex
  std::uint32_t sweep_ = 0;
};

/// Tets below a quality, into bad_.
void Improver::scan(double bound) {
  bad_.clear();
  const std::size_t slots = c_.num_slots();
  FaceBlock block;
  Lanes apex[3];
  TetIndex waiting[kLanes];
  std::size_t lane = 0;
  const auto flush = [&] {
    const Lanes q = measure_block(block, apex);
    for (std::size_t i = 0; i < lane; ++i)
      if (q[i] < bound) bad_.push_back(waiting[i]);
    lane = 0;
  };
  for (TetIndex t = 0; t < slots; ++t) {
    if (t % kScansBetweenChecks == 0) context_.progress("improve", t, slots, "cells");
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
  if (!is_below(t, goal_)) return false;
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
  if (!is_below(t, goal_)) return false;
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

bool Improver::insert(TetIndex t) {
  if (!is_below(t, goal_)) return false;
  if (!is_changed(operations_.insert(t, goal_, enough_))) return false;
  ++report_.points_added;
  return true;
}

/// Apply an operation to every tet of bad_ that is still bad; afterwards bad_ holds what is left and what came new.
template <class Operation>
void Improver::sweep(std::size_t first_pass, std::size_t between_checks, Operation operation) {
  if (report_.passes < first_pass) return;
  ++sweep_;
  next_.clear();
  for (std::size_t i = 0; i < bad_.size(); ++i) {
    if (i % between_checks == 0) context_.progress("improve", i, bad_.size(), "cells");
    const TetIndex t = bad_[i];
    if (!is_bad(t)) continue;
    if (report_.passes == first_pass || !is_stale(t)) operation(t);
    next_.push_back(t);
  }
  std::sort(next_.begin(), next_.end());
  next_.erase(std::unique(next_.begin(), next_.end()), next_.end());
  next_.erase(std::remove_if(next_.begin(), next_.end(), [this](TetIndex t) { return !is_bad(t); }), next_.end());
  bad_.swap(next_);
}

/// The smallest dihedral angle of all, degrees. Leaves bad_ filled with the tets below work_ if there are any.
double Improver::measure_least_dihedral() {
  scan(work_);
  const bool has_bad = !bad_.empty();
  if (!has_bad) scan(1);
  double least = std::numbers::pi;
  for (const TetIndex t : bad_) {
    const std::uint32_t* n = &c_.node[4 * t];
    least = std::min(least, measure_dihedrals(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(n[3])).least);
  }
  if (!has_bad) bad_.clear();
  return least * 180 / std::numbers::pi;
}

void Improver::count_left() {
  for (const TetIndex t : bad_) {
    if (!is_below(t, goal_)) continue;
    ++report_.below_goal;
    const std::uint32_t* n = &c_.node[4 * t];
    if (c_.on_boundary[n[0]] && c_.on_boundary[n[1]] && c_.on_boundary[n[2]] && c_.on_boundary[n[3]])
      ++report_.below_goal_forced;
  }
}

void Improver::run_pass() {
  ++report_.passes;
  sweep(1, kSwapsBetweenChecks, [this](TetIndex t) { thin_out(t); });
  sweep(1, kSwapsBetweenChecks, [this](TetIndex t) { swap(t); });
  sweep(1, kSmoothsBetweenChecks, [this](TetIndex t) { smooth(t); });
  sweep(2, kSmoothsBetweenChecks, [this](TetIndex t) { contract(t); });
  sweep(2, kInsertionsBetweenChecks, [this](TetIndex t) { insert(t); });
}

ImproveReport Improver::run() {
  goal_ = quality_of_angle(options_.min_dihedral);
  work_ = quality_of_angle(std::max(options_.min_dihedral, std::min(kStretch * options_.min_dihedral, kMaxWorkAngle)));
  enough_ = kEnough * work_;
  vertex_pass_.assign(c_.num_vertices(), 0);
  report_.min_dihedral_before_deg = measure_least_dihedral();
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
  return Improver(complex, options, context).run();
}

}  // namespace delfront
