// SPDX-License-Identifier: Apache-2.0
// Smoothing of one vertex: maximise the worst quality of its star, which is not a smooth function.
#include <algorithm>

#include "improve/operations.hpp"

namespace delfront {

namespace {

constexpr int kMaxSteps = 16;
constexpr int kMaxHalvings = 6;
constexpr int kMaxHalvingsWhereFlat = 24;  // there may be little room, but any of it helps
constexpr double kFlat = 1e-9;             // squared sine of 0.002 degrees
constexpr double kFirstStep = 0.15;        // of the mean distance to the corners
constexpr double kFirstActive = 0.5;       // tets up to (1 + this) of the worst count as active ...
constexpr double kLastActive = 0.03;       // ... narrowed down to this before giving up
constexpr double kLeastGain = 1 + 1e-3;    // a step that gains less ends the search
constexpr std::size_t kMaxActive = 12;

/// The shortest vector of the convex hull of the gradients: a direction in which all of them rise, if there is one.
Point find_ascent(const std::vector<Point>& gradients) {
  Point d = gradients[0];
  for (int step = 0; step < 24; ++step) {
    const Point* lowest = &gradients[0];
    for (const Point& g : gradients)
      if (dot(g, d) < dot(*lowest, d)) lowest = &g;
    const Point to = *lowest - d;
    const double along = -dot(to, d), whole = squared_length(to);
    if (along <= 1e-3 * squared_length(d) || whole == 0) break;
    d = d + std::min(1.0, along / whole) * to;
  }
  return d;
}

Point measure_centroid(const FaceBatch& faces, const Point& p, double& mean_distance) {
  Point sum;
  mean_distance = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      sum = sum + faces.corner(i, c);
      mean_distance += distance(faces.corner(i, c), p);
    }
  }
  const double n = 3.0 * static_cast<double>(faces.size());
  mean_distance /= n;
  return sum / n;
}

void collect_gradients(const FaceBatch& faces, const Point& p, double worst, double active, SmoothScratch& scratch) {
  scratch.gradients.clear();
  const double limit = worst + active * std::abs(worst);
  for (std::size_t i = 0; i < faces.size() && scratch.gradients.size() < kMaxActive; ++i) {
    if (scratch.quality[i] > limit) continue;
    scratch.gradients.push_back(
        measure_quality_gradient(faces.corner(i, 0), faces.corner(i, 1), faces.corner(i, 2), p));
    if (scratch.quality[i] <= worst) std::swap(scratch.gradients.front(), scratch.gradients.back());
  }
}

}  // namespace

double optimise_point(const FaceBatch& faces, Point& p, double enough, SmoothScratch& scratch) {
  double worst = faces.worst(p), mean_distance = 0;
  const Point centroid = measure_centroid(faces, p, mean_distance);
  if (const double there = faces.worst(centroid, worst); there > worst) {
    worst = there;
    p = centroid;
  }
  double step = kFirstStep * mean_distance, active = kFirstActive;
  for (int i = 0; i < kMaxSteps && worst < enough; ++i) {
    faces.measure(p, scratch.quality);
    collect_gradients(faces, p, worst, active, scratch);
    const Point ascent = find_ascent(scratch.gradients);
    const double norm = length(ascent);
    double best = worst;
    Point best_at = p;
    double tried = step;
    const int halvings = worst < kFlat ? kMaxHalvingsWhereFlat : kMaxHalvings;
    for (int half = 0; norm > 0 && half < halvings; ++half, tried *= 0.5) {
      const Point at = p + (tried / norm) * ascent;
      const double there = faces.worst(at, best);
      if (there > best) {
        best = there;
        best_at = at;
      } else if (best > worst) {
        break;
      }
    }
    const bool gained = worst > 0 ? best > kLeastGain * worst : best > worst;
    if (best > worst) {
      step = 1.5 * distance(best_at, p);
      worst = best;
      p = best_at;
    }
    if (gained) continue;
    if (active <= kLastActive) break;
    active *= 0.25;
  }
  return worst;
}

bool LocalOperations::collect_star(VertexIndex v) {
  if (c_.on_boundary[v] || c_.vertex_tet[v] == kNoIndex) return false;
  c_.star(v, star_);
  faces_.clear();
  star_faces_.clear();
  for (const TetIndex t : star_) {
    if (c_.is_ghost(t) || c_.region[t] != c_.region[star_[0]]) return false;
    const auto at = static_cast<unsigned>(c_.local_index(t, v));
    const unsigned constrained = c_.flag[t] & 15u;
    if (constrained & ~(1u << at)) return false;
    const auto n = c_.face_nodes(4 * t + at);
    star_faces_.push_back(n);
    faces_.add(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]));
  }
  return true;
}

bool LocalOperations::smooth(VertexIndex v, double enough) {
  if (!collect_star(v)) return false;
  const Point old = c_.point(v);
  const double before = faces_.worst(old);
  Point p = old;
  const double after = optimise_point(faces_, p, enough, scratch_);
  if (!(after > kGain * before)) return false;
  for (const auto& n : star_faces_)
    if (orient3d(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), p) <= 0) return false;
  c_.vertex[v] = {p.x, p.y, p.z, c_.vertex[v].h};
  touched.assign(star_.begin(), star_.end());
  return true;
}

}  // namespace delfront
