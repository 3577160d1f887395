// SPDX-License-Identifier: Apache-2.0
// One step of the front: a face, its ideal point, the points that could be taken instead, and the first of them whose
// tet crosses nothing.
#include "volume/front_step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "tetra/quality.hpp"

namespace delfront {

namespace {

constexpr std::uint64_t kTimed = 16;
constexpr double kShortest = 0.6, kLongest = 1.7;  ///< wanted edge, of the mean edge of the face
constexpr double kLowest = 0.5;                    ///< height of the ideal point, of the wanted edge
constexpr double kPreferOld = 1.0;  ///< weighs a new point, beside 1 for old ones far from the ideal place
constexpr double kReuse = 0.7;      ///< an old point nearer than that to the ideal one, in wanted edges, is it
constexpr double kNearBonus = 4;
constexpr double kNeedle = 0.04;   ///< area over the squared mean edge; of the regular triangle 0.43
constexpr double kLongEdge = 1.0;  ///< wanted edges; beyond, a candidate is worth less
constexpr double kHeights[] = {1.0, 0.75, 0.5};

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

FrontCounts& FrontCounts::operator+=(const FrontCounts& o) {
  steps += o.steps, tets += o.tets, points += o.points, deferred += o.deferred, failed += o.failed;
  candidates += o.candidates, visited += o.visited;
  step_seconds += o.step_seconds, test_seconds += o.test_seconds;
  near.faces += o.near.faces, near.points += o.near.points, near.tests += o.near.tests;
  near.plane_tests += o.near.plane_tests, near.exact_tests += o.near.exact_tests;
  return *this;
}

void FrontWorker::add_to_tree(std::uint32_t f) { tree.insert(f, front_.box(f)); }

FrontWorker::Result FrontWorker::advance(std::uint32_t f) {
  if (!front_.face(f).is_alive) return Result::gone;
  is_timed_ = counts.steps++ % kTimed == 0;
  const double start = is_timed_ ? seconds_now() : 0;
  measure(f);
  const Result result = choose(f);
  counts.deferred += result == Result::deferred;
  counts.failed += result == Result::failed;
  if (is_timed_) counts.step_seconds += seconds_now() - start;
  counts.near = near_.counts;
  return result;
}

/// F7: the best of the points that could be taken whose tet crosses nothing.
FrontWorker::Result FrontWorker::choose(std::uint32_t f) {
  is_local_ = set_.is_local || is_needle();
  if (!(is_local_ ? gather_ring(f) : gather(f))) return Result::deferred;
  candidates_.clear();
  add_candidates();
  add_new_points();
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  for (const Candidate& candidate : candidates_) {
    ++counts.candidates;
    const Result tried = candidate.point == kNoIndex ? try_new_point(f, candidate) : try_point(f, candidate);
    if (tried != Result::failed) return tried;
  }
  return Result::failed;
}

/// Round such a face a ball of the size of its edges would hold far too many others.
bool FrontWorker::is_needle() const { return area_ < kNeedle * edge_ * edge_; }

/// The ideal point (F7.1): over the centroid, with edges as long as wanted.
void FrontWorker::measure(std::uint32_t f) {
  near_.start(f);
  const auto n = front_.nodes(f);
  double h = 0, perimeter = 0, spread = 0;
  for (unsigned i = 0; i < 3; ++i) place_[i] = c_.point(n[i]), h += c_.vertex[n[i]].h / 3;
  for (unsigned i = 0; i < 3; ++i) corner_[i] = near_.frame().to_frame(place_[i]);
  centroid_ = near_.origin();
  normal_ = near_.normal();
  for (unsigned i = 0; i < 3; ++i) {
    perimeter += distance(corner_[i], corner_[i == 2 ? 0 : i + 1]);
    spread += squared_length(corner_[i] - centroid_) / 3;
  }
  edge_ = perimeter / 3;
  area_ = 0.5 * length(cross(corner_[1] - corner_[0], corner_[2] - corner_[0]));
  wanted_ = std::clamp(h, kShortest * edge_, kLongest * edge_);
  const double height = std::sqrt(std::max(wanted_ * wanted_ - spread, kLowest * kLowest * wanted_ * wanted_));
  ideal_ = centroid_ + height * normal_;
}

double FrontWorker::reach_of_step(std::uint32_t f) const {
  const auto n = front_.nodes(f);
  const FrontFrame frame = front_.frame(f);
  double longest = 0;
  for (unsigned i = 0; i < 3; ++i)
    longest = std::max(longest, length(frame.along(c_.point(n[i]) - c_.point(n[i == 2 ? 0 : i + 1]))));
  const Point reach = frame.reach();
  return (set_.radius + 1) * kLongest * longest * std::max({reach.x, reach.y, reach.z});
}

Box FrontWorker::box_with(const Point& low, const Point& high) const {
  Box box{low, high};
  for (const Point& p : place_) box.add(p);
  return box;
}

/// Faces of the front that may meet a tet over face f. @return false where they reach out of the slab
bool FrontWorker::gather(std::uint32_t f) {
  const Point around = set_.radius * wanted_ * near_.frame().reach(), ideal = near_.frame().from_frame(ideal_);
  const Box box = box_with(ideal - around, ideal + around);
  if (!slab_.holds(box)) return false;
  tree.for_each_overlap(box, [&](std::uint32_t g) {
    ++counts.visited;
    if (g != f && front_.face(g).is_alive) near_.add_face(g);
  });
  gather_obstacles(box);
  near_.counts.faces += near_.num_faces();
  near_.counts.points += near_.num_points();
  return true;
}

/// Those that another worker may change are not looked at.
void FrontWorker::gather_obstacles(const Box& box) {
  const FrontObstacles& obstacles = front_.obstacles();
  obstacles.for_each_overlap(box, [&](std::uint32_t i) {
    if (!slab_.meets(obstacles.box(i)) || !obstacles[i].is_pending()) return;
    if (!near_.has_obstacle(obstacles[i])) near_.add_obstacle(obstacles[i]);
  });
}

/// The faces at the corners of the face, and obstacles within reach. @return false where it reaches out of the slab:
/// others may change the lists of its corners there
bool FrontWorker::gather_ring(std::uint32_t f) {
  if (!slab_.holds(front_.box(f))) return false;
  taken_in_.assign(1, f);
  for (const VertexIndex v : front_.nodes(f))
    for (std::uint32_t e = front_.first_at(v); e != kNoIndex; e = front_.next_at(e))
      if (std::find(taken_in_.begin(), taken_in_.end(), e >> 2) == taken_in_.end()) {
        taken_in_.push_back(e >> 2);
        near_.add_face(e >> 2);
      }
  if (front_.obstacles().empty()) return true;
  const Point around = set_.radius * wanted_ * near_.frame().reach();
  const Box box = box_with(centroid_ - around, centroid_ + around);
  if (!slab_.holds(box)) return false;
  gather_obstacles(box);
  return true;
}

/// The faces that may meet the tet of a point. @return false where it reaches out of the slab
bool FrontWorker::gather_round(const Point& apex) {
  const Box box = box_with(apex, apex);
  if (!slab_.holds(box)) return false;
  tree.for_each_overlap(box, [&](std::uint32_t g) {
    ++counts.visited;
    if (!front_.face(g).is_alive || std::find(taken_in_.begin(), taken_in_.end(), g) != taken_in_.end()) return;
    taken_in_.push_back(g);
    near_.add_face(g);
  });
  gather_obstacles(box);
  return true;
}

double FrontWorker::quality(const Point& apex) const {
  return measure_quality(corner_[0], corner_[1], corner_[2], apex);
}

/// Points of the front within reach, in front of the face (F7.2, F14, F15).
void FrontWorker::add_candidates() {
  const Point ideal = ideal_ - centroid_;
  const double radius2 = set_.radius * set_.radius * wanted_ * wanted_;
  for (std::size_t p = 3; p < near_.num_points(); ++p) {
    const Point at = near_.at(p);
    const double d2 = squared_length(at - ideal);
    if (near_.height(p) <= 0 || (!is_local_ && d2 > radius2)) continue;
    const Point absolute = near_.frame().to_frame(c_.point(near_.id(p)));
    double score = quality(absolute);
    if (score < set_.quality) continue;
    const double wedge = near_.measure_wedges(p);
    if (wedge < set_.wedge) continue;
    score = std::min(score, wedge);
    double longest = 0;
    for (const Point& corner : corner_) longest = std::max(longest, squared_length(absolute - corner));
    longest = std::sqrt(longest) / std::max(wanted_, edge_);
    if (longest > kLongEdge) score *= kLongEdge / longest * kLongEdge / longest;
    if (d2 < kReuse * kReuse * wanted_ * wanted_) score *= kNearBonus;
    candidates_.push_back({score, static_cast<std::uint32_t>(p), {}});
  }
}

void FrontWorker::add_new_points() {
  if (is_local_ && !set_.is_local) return;  // other faces will do that better
  const Point up = ideal_ - centroid_;
  double share = kPreferOld;
  for (const double height : kHeights) {
    const Point in_frame = centroid_ + height * up, place = near_.frame().from_frame(in_frame);
    const std::size_t at = near_.add_place(place);
    const double q = quality(in_frame), wedge = near_.measure_wedges(at);
    near_.drop_place();
    if (q >= set_.quality && wedge >= set_.wedge) candidates_.push_back({share * std::min(q, wedge), kNoIndex, place});
    share *= 0.5;
  }
}

Neighbourhood::Verdict FrontWorker::test(std::size_t apex) {
  const double start = is_timed_ ? seconds_now() : 0;
  const auto verdict = near_.test(apex, set_.clearance * wanted_, set_.wedge > 0 ? std::sqrt(1 - set_.wedge) : 1);
  if (is_timed_) counts.test_seconds += seconds_now() - start;
  return verdict;
}

FrontWorker::Result FrontWorker::try_point(std::uint32_t f, const Candidate& candidate) {
  const VertexIndex d = near_.id(candidate.point);
  if (orient3d(place_[0], place_[1], place_[2], c_.point(d)) <= 0) return Result::failed;
  if (is_local_ && !gather_round(c_.point(d))) return Result::deferred;
  if (test(candidate.point) != Neighbourhood::Verdict::free) return Result::failed;
  add_tet(f, d);
  return Result::done;
}

void FrontWorker::add_tet(std::uint32_t f, VertexIndex d) {
  const std::size_t before = made.size();
  front_.add_tet(f, d, stock, made);
  for (std::size_t i = before; i < made.size(); ++i) add_to_tree(made[i]);
  ++counts.tets;
}

bool FrontWorker::is_roomy(std::size_t place, double size) const {
  return near_.distance_to_points(place) >= set_.to_points * size &&
         near_.distance_to_faces(place) >= set_.to_faces * size &&
         near_.distance_to_edges(place) >= set_.to_faces * size;
}

FrontWorker::Result FrontWorker::try_new_point(std::uint32_t f, const Candidate& candidate) {
  if (orient3d(place_[0], place_[1], place_[2], candidate.place) <= 0) return Result::failed;
  if (is_local_ && !gather_round(candidate.place)) return Result::deferred;
  const std::size_t place = near_.add_place(candidate.place);
  const bool fits = is_roomy(place, wanted_) && test(place) == Neighbourhood::Verdict::free;
  near_.drop_place();
  if (!fits) return Result::failed;
  const VertexIndex d = stock.vertices.back();
  stock.vertices.pop_back();
  c_.set_vertex(d, candidate.place, 0);
  front_.sizes().ask(d);
  add_tet(f, d);
  ++counts.points;
  return Result::done;
}

}  // namespace delfront
