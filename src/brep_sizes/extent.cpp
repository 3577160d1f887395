// SPDX-License-Identifier: Apache-2.0
// The smallest ball round samples of the geometry: from a ball round few of them, the farthest one outside is taken in
// and the smallest ball round those few is found anew, until none is outside. The radius rises each time.
#include <algorithm>
#include <cmath>
#include <utility>

#include "Eigen/Dense"
#include "delfront/brep_sizes.hpp"

namespace delfront {
namespace {

constexpr int kAlongEdge = 24;
constexpr int kAcrossFace = 16;
constexpr double kInside = 1e-12;  ///< of the radius: places so little outside count as inside
constexpr int kMostSteps = 1000;
// A far field that is part of the geometry: at most so many faces, each so many times as large as the rest together,
// which has so many faces at least. Less than that share of the whole is no body, but a splinter.
constexpr std::size_t kMostOfFarField = 8, kLeastOfBody = 3;
constexpr double kFarFieldRatio = 8, kLeastBodyShare = 1e-4;

struct Ball {
  Point centre;
  double radius = -1;
  bool holds(Point p) const { return distance(p, centre) <= radius * (1 + kInside); }
};

/// The smallest ball with these on its border; radius < 0 where they have none.
Ball ball_through(const std::vector<Point>& on) {
  const auto n = static_cast<Eigen::Index>(on.size()) - 1;
  if (n < 0) return {};
  if (n == 0) return {on[0], 0};
  Eigen::MatrixXd gram(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Point a = on[std::size_t(i) + 1] - on[0];
    right[i] = 0.5 * dot(a, a);
    for (Eigen::Index j = 0; j < n; ++j) gram(i, j) = dot(a, on[std::size_t(j) + 1] - on[0]);
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(gram);
  if (!lu.isInvertible()) return {};
  const Eigen::VectorXd share = lu.solve(right);
  Ball ball{on[0], 0};
  for (Eigen::Index i = 0; i < n; ++i) ball.centre = ball.centre + share[i] * (on[std::size_t(i) + 1] - on[0]);
  ball.radius = distance(ball.centre, on[0]);
  return ball;
}

/// Of at most five places, by all subsets of two to four.
Ball smallest_ball(const std::vector<Point>& places, std::vector<Point>& support) {
  Ball best;
  for (unsigned set = 1; set < 1u << places.size(); ++set) {
    std::vector<Point> on;
    for (std::size_t i = 0; i < places.size(); ++i)
      if (set >> i & 1u) on.push_back(places[i]);
    if (on.size() > 4) continue;
    const Ball ball = ball_through(on);
    if (ball.radius < 0 || (best.radius >= 0 && ball.radius >= best.radius)) continue;
    if (!std::all_of(places.begin(), places.end(), [&](Point p) { return ball.holds(p); })) continue;
    best = ball;
    support = on;
  }
  return best;
}

Ball enclosing_ball(const std::vector<Point>& places) {
  if (places.empty()) return {};
  std::vector<Point> support = {places[0]};
  Ball ball{places[0], 0};
  for (int step = 0; step < kMostSteps; ++step) {
    std::size_t farthest = 0;
    for (std::size_t i = 1; i < places.size(); ++i)
      if (squared_length(places[i] - ball.centre) > squared_length(places[farthest] - ball.centre)) farthest = i;
    if (ball.holds(places[farthest])) break;
    std::vector<Point> few = support;
    few.push_back(places[farthest]);
    const Ball next = smallest_ball(few, support);
    if (!(next.radius > ball.radius)) break;
    ball = next;
  }
  return ball;
}

/// Loops of a face as polygons in its parameter plane.
using Polygons = std::vector<std::vector<Point2>>;

bool is_inside(const Polygons& loops, Point2 p) {
  bool inside = false;
  for (const auto& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Point2 a = loop[i], b = loop[(i + 1) % loop.size()];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
  return inside;
}

void add_samples(const Brep& brep, const BrepFace& face, std::vector<Point>& samples) {
  Polygons loops;
  Box box;
  for (const auto& loop : face.loops) {
    loops.emplace_back();
    for (const BrepUse& use : loop) {
      const auto& range = brep.edges[use.edge].range;
      for (int i = 0; i < kAlongEdge; ++i) {
        const double f = double(use.is_reversed ? kAlongEdge - i : i) / kAlongEdge;
        const Point2 uv = use.curve->at((1 - f) * range[0] + f * range[1]);
        loops.back().push_back(uv);
        box.add(Point{uv.x, uv.y, 0});
        samples.push_back(face.surface->at(uv));
      }
    }
  }
  for (int i = 0; i < kAcrossFace; ++i)
    for (int j = 0; j < kAcrossFace; ++j) {
      const double f = (i + 0.5) / kAcrossFace, g = (j + 0.5) / kAcrossFace;
      const Point2 uv = {(1 - f) * box.low.x + f * box.high.x, (1 - g) * box.low.y + g * box.high.y};
      if (is_inside(loops, uv)) samples.push_back(face.surface->at(uv));
    }
}

/// Round all faces but those of a far field: the few largest, each far larger than the rest together.
Ball ball_of_body(const std::vector<std::vector<Point>>& samples, const Ball& whole) {
  std::vector<std::pair<double, std::size_t>> faces;  // largest first
  for (std::size_t f = 0; f < samples.size(); ++f) faces.emplace_back(-enclosing_ball(samples[f]).radius, f);
  std::sort(faces.begin(), faces.end());
  for (std::size_t k = 1; k <= kMostOfFarField && k + kLeastOfBody <= faces.size(); ++k) {
    if (faces[k - 1].first > kFarFieldRatio * faces[k].first) continue;  // both negative: not so much larger
    std::vector<Point> rest;
    for (std::size_t i = k; i < faces.size(); ++i) {
      const std::vector<Point>& at = samples[faces[i].second];
      rest.insert(rest.end(), at.begin(), at.end());
    }
    const Ball body = enclosing_ball(rest);
    const bool is_far = -faces[k - 1].first >= kFarFieldRatio * body.radius;
    if (is_far && body.radius >= kLeastBodyShare * whole.radius) return body;
  }
  return whole;
}

}  // namespace

BrepExtent measure_extent(const Brep& brep) {
  std::vector<std::vector<Point>> samples(brep.faces.size());
  std::vector<Point> all;
  for (std::size_t f = 0; f < samples.size(); ++f) {
    add_samples(brep, brep.faces[FaceId(f)], samples[f]);
    std::erase_if(samples[f], [](Point p) { return !is_finite(p); });
    all.insert(all.end(), samples[f].begin(), samples[f].end());
  }
  const Ball whole = enclosing_ball(all), body = ball_of_body(samples, whole);
  return {2 * std::max(0.0, whole.radius), 2 * std::max(0.0, body.radius), body.centre};
}

}  // namespace delfront
