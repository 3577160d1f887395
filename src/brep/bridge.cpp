// SPDX-License-Identifier: Apache-2.0
#include "brep/bridge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <unordered_map>

#include "geometry/angles.hpp"

namespace delfront {
namespace {

constexpr double kSmall = 0.117;         ///< squared sine of 20 degrees: angles under it are worked on
constexpr double kLeastGain = 1e-3;      ///< of a squared sine
constexpr double kMostLoss = 0.8;        ///< of one, where points merge, ...
constexpr double kTiny = 0.25;           ///< ... and of `below`: sides so short go, even where that ...
constexpr double kMostTinyLoss = 0.5;    ///< ... leaves so much for the next to lift
constexpr double kAgree = 0.3;           ///< cosine between a triangle and its surface at its corners
constexpr double kWedge = 60 * kDegree;  ///< least angle between neighbours, ...
constexpr double kCusp = 5 * kDegree;    ///< borders that meet at more are a corner, which stays
constexpr double kWedgeShare = 0.5;      ///< ... or that share of the least there is already
constexpr int kMostPasses = 30;
constexpr std::uint32_t kNone = 0xffffffffu;

using Corners = std::array<std::uint32_t, 3>;
using Side = std::array<std::uint32_t, 2>;

Side side_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// A triangle as it would be: in place of number `t`, or of none.
struct Change {
  std::uint32_t t = kNone;  ///< the triangle whose face it is on
  bool is_new = false;      ///< t stays as well
  Corners corners{};
  std::array<Point2, 3> uv{};
};

/// What an operation does, before it is done.
struct Plan {
  std::vector<std::uint32_t> gone;
  std::vector<Change> changed;
};

class Bridger {
 public:
  Bridger(const Brep& brep, double below, BrepGrid& grid, const Context& context)
      : brep_(brep), below_(below), grid_(grid), model_(grid.model), context_(context) {}

  std::vector<BrepBridge> run() {
    if (!gather()) return {};
    for (int pass = 0; pass < kMostPasses && work(); ++pass) context_.check_limits();
    if (!bridges_.empty()) finish();
    return std::move(bridges_);
  }

 private:
  Point at(std::uint32_t p) const { return model_.points[VertexId(std::size_t(p))]; }
  int dimension(std::uint32_t p) const { return grid_.entity[p].dimension; }
  Corners corners(std::uint32_t t) const {
    const auto& c = model_.triangles[TriangleId(std::size_t(t))];
    return {c[0].value, c[1].value, c[2].value};
  }
  double sine(const Corners& c) const { return smallest_squared_sine(at(c[0]), at(c[1]), at(c[2])); }
  Point area(const Corners& c) const { return cross(at(c[1]) - at(c[0]), at(c[2]) - at(c[0])); }
  double height(const Corners& c) const {
    const double longest =
        std::max({distance(at(c[0]), at(c[1])), distance(at(c[1]), at(c[2])), distance(at(c[2]), at(c[0]))});
    return longest > 0 ? length(area(c)) / longest : 0;
  }

  /// Whether a triangle is narrow by what the geometry is: two of its corners at least are on borders.
  bool is_narrow(std::uint32_t t) const {
    const Corners c = corners(t);
    if (dimension(c[0]) + dimension(c[1]) + dimension(c[2]) > 4) return false;
    return sine(c) < kSmall && height(c) < below_;
  }

  /// The narrow triangles, and stars of all points as far as work may go. @return whether there are any
  bool gather() {
    const auto n = static_cast<std::uint32_t>(model_.triangles.size());
    is_gone_.assign(n, false);
    std::vector<bool> is_near(model_.points.size(), false);
    bool is_any = false;
    for (std::uint32_t t = 0; t < n; ++t) {
      if (!is_narrow(t)) continue;
      is_any = true;
      for (const std::uint32_t p : corners(t)) is_near[p] = true;
    }
    if (!is_any) return false;
    for (int ring = 0; ring < 3; ++ring) {
      std::vector<bool> next = is_near;
      for (std::uint32_t t = 0; t < n; ++t) {
        const Corners c = corners(t);
        if (!is_near[c[0]] && !is_near[c[1]] && !is_near[c[2]]) continue;
        for (const std::uint32_t p : c) next[p] = true;
      }
      is_near = std::move(next);
    }
    for (std::uint32_t t = 0; t < n; ++t)
      for (const std::uint32_t p : corners(t))
        if (is_near[p]) star_[p].push_back(t);
    for (const BrepEdge& edge : brep_.edges)
      if (edge.is_degenerate()) poles_.insert(edge.corners[0].value);
    gather_curves();
    return true;
  }

  void gather_curves() {
    for (std::size_t c = 0; c < model_.curves.size(); ++c) {
      const auto& chain = model_.curves[CurveId(c)].vertices;
      for (std::size_t i = 0; i + 1 < chain.size(); ++i)
        if (star_.contains(chain[i].value) && star_.contains(chain[i + 1].value))
          curves_[side_of(chain[i].value, chain[i + 1].value)].insert(c);
    }
  }

  /// @return whether anything was done
  bool work() {
    std::vector<std::pair<double, std::uint32_t>> narrow;
    for (const auto& [p, star] : star_)
      for (const std::uint32_t t : star)
        if (corners(t)[0] == p && is_narrow(t)) narrow.emplace_back(sine(corners(t)), t);
    std::sort(narrow.begin(), narrow.end());
    bool is_any = false;
    for (const auto& [angle, t] : narrow)
      if (!is_gone_[t] && is_narrow(t) && bridge(t)) is_any = true;
    return is_any;
  }

  /// A side becomes a point, the shortest first; or the triangle goes onto its longest side.
  bool bridge(std::uint32_t t) {
    const Corners c = corners(t);
    std::array<std::size_t, 3> by_length = {0, 1, 2};
    const auto side = [&](std::size_t k) { return distance(at(c[k]), at(c[(k + 1) % 3])); };
    std::stable_sort(by_length.begin(), by_length.end(),
                     [&](std::size_t i, std::size_t k) { return side(i) < side(k); });
    if (std::any_of(c.begin(), c.end(), [&](std::uint32_t r) { return is_sharp_corner(t, r); })) return false;
    for (const std::size_t k : by_length)
      if (close(c[k], c[(k + 1) % 3], k == by_length[0])) return true;
    return fold(t, by_length[2]);
  }

  /// What lies on less goes: the point of a face, then that of an edge.
  bool close(std::uint32_t a, std::uint32_t b, bool is_shortest) {
    if (dimension(a) != dimension(b))
      return dimension(a) < dimension(b) ? merge(b, a, is_shortest) : merge(a, b, is_shortest);
    return merge(std::max(a, b), std::min(a, b), is_shortest) || merge(std::min(a, b), std::max(a, b), is_shortest);
  }

  std::vector<std::uint32_t> around(std::uint32_t p) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t t : star_.at(p))
      for (const std::uint32_t q : corners(t))
        if (q != p) found.push_back(q);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Point q becomes p. Strips vanish piece by piece, at their short sides: those may cost a little.
  bool merge(std::uint32_t q, std::uint32_t p, bool is_shortest) {
    if (!(distance(at(p), at(q)) < below_) || is_kept(q) || !star_.contains(p) || !star_.contains(q)) return false;
    Plan plan;
    std::vector<std::uint32_t> across;
    for (const std::uint32_t t : star_.at(q)) {
      const Corners c = corners(t);
      if (std::find(c.begin(), c.end(), p) == c.end()) {
        plan.changed.push_back(replaced(t, q, p));
        continue;
      }
      plan.gone.push_back(t);
      for (const std::uint32_t r : c)
        if (r != p && r != q) across.push_back(r);
    }
    std::sort(across.begin(), across.end());
    if (plan.gone.empty() || std::adjacent_find(across.begin(), across.end()) != across.end()) return false;
    const double tiny = distance(at(p), at(q)) < kTiny * below_ ? kMostTinyLoss : kMostLoss;
    const double share = is_shortest ? tiny : 1;
    std::vector<std::uint32_t> common;
    const std::vector<std::uint32_t> round_p = around(p), round_q = around(q);
    std::set_intersection(round_p.begin(), round_p.end(), round_q.begin(), round_q.end(), std::back_inserter(common));
    for (const std::uint32_t r : across)
      if (num_triangles(r, p) + num_triangles(r, q) == 2) return false;  // nothing would be left there
    if (common.size() == across.size() + 1 && drop_enclosed(across, p, q)) return merge(q, p, is_shortest);
    if (common != across || !is_better(plan, star_.at(q), share, is_shortest ? 0 : kLeastGain)) return false;
    across.insert(across.end(), {p, q});
    if (folds(plan, p, across)) return false;
    bridges_.push_back({at(p), distance(at(p), at(q))});
    do_it(plan);
    move_curves(q, p);
    return true;
  }

  /// A point within a triangle of p, q and a third one, which keeps those from being one. @return whether it is gone
  bool drop_enclosed(const std::vector<std::uint32_t>& across, std::uint32_t p, std::uint32_t q) {
    for (const std::uint32_t x : across) {
      if (dimension(x) < 2 || star_.at(x).size() != 3) continue;
      Plan plan;
      std::uint32_t third = kNone;
      for (const std::uint32_t r : around(x))
        if (r != p && r != q) third = r;
      for (const std::uint32_t t : star_.at(x)) {
        const Corners c = corners(t);
        if (std::find(c.begin(), c.end(), third) != c.end())
          plan.gone.push_back(t);
        else
          plan.changed.push_back(replaced(t, x, third));
      }
      if (plan.changed.size() != 1) continue;
      do_it(plan);
      return true;
    }
    return false;
  }

  /// Whether the triangle's other two corners lie on edges that meet in its corner r, and not in a cusp.
  bool is_sharp_corner(std::uint32_t t, std::uint32_t r) const {
    if (dimension(r) != 0) return false;
    std::vector<Point> ways;
    for (const std::uint32_t a : corners(t))
      if (a != r && ends_in(a, r)) ways.push_back(at(a) - at(r));
    return ways.size() == 2 && angle_between(ways[0], ways[1]) > kCusp;
  }

  bool ends_in(std::uint32_t a, std::uint32_t r) const {
    if (dimension(a) != 1) return false;
    const auto& ends = brep_.edges[EdgeId(std::size_t(grid_.entity[a].id))].corners;
    return ends[0].value == grid_.entity[r].id || ends[1].value == grid_.entity[r].id;
  }

  /// Names of corners stay.
  bool is_kept(std::uint32_t q) const {
    const VertexEntity& e = grid_.entity[q];
    return e.dimension == 0 && !brep_.corners[CornerId(std::size_t(e.id))].name.empty();
  }

  /// Triangle t goes; those across its side `longest` are divided at its third corner.
  bool fold(std::uint32_t t, std::size_t longest) {
    const Corners c = corners(t);
    const std::uint32_t a = c[longest], b = c[(longest + 1) % 3], p = c[(longest + 2) % 3];
    if (dimension(a) > 1 || dimension(b) > 1 || dimension(p) > 1 || !star_.contains(a) || !star_.contains(b))
      return false;
    Plan plan{{t}, {}};
    std::vector<std::uint32_t> before = {t};
    for (const std::uint32_t other : star_.at(a)) {
      const Corners d = corners(other);
      if (other == t || std::find(d.begin(), d.end(), b) == d.end()) continue;
      if (std::find(d.begin(), d.end(), p) != d.end()) return false;
      for (const std::uint32_t r : d)
        if (r != a && r != b && has_side(p, r)) return false;
      Change second = replaced(other, a, p);
      second.is_new = true;
      plan.changed.push_back(second);
      plan.changed.push_back(replaced(other, b, p));
      before.push_back(other);
    }
    if (plan.changed.empty() || !is_better(plan, before, 1, kLeastGain) || folds(plan, p, {a, b, p})) return false;
    bridges_.push_back({at(p), height(c)});
    do_it(plan);
    bend_curves(a, b, p);
    return true;
  }

  std::ptrdiff_t num_triangles(std::uint32_t r, std::uint32_t p) const {
    const std::vector<std::uint32_t>& star = star_.at(p);
    return std::count_if(star.begin(), star.end(), [&](std::uint32_t t) {
      const Corners c = corners(t);
      return std::find(c.begin(), c.end(), r) != c.end();
    });
  }

  bool has_side(std::uint32_t p, std::uint32_t r) const {
    const auto found = star_.find(p);
    if (found == star_.end()) return true;  // nobody knows: then better not
    for (const std::uint32_t t : found->second) {
      const Corners c = corners(t);
      if (std::find(c.begin(), c.end(), r) != c.end()) return true;
    }
    return false;
  }

  /// Triangle t with p for q, which may lie off its surface.
  Change replaced(std::uint32_t t, std::uint32_t q, std::uint32_t p) const {
    Change change{t, false, corners(t), grid_.corner_uv[t]};
    const std::uint32_t face = model_.input_face[TriangleId(std::size_t(t))];
    for (std::size_t k = 0; k < 3; ++k) {
      if (change.corners[k] != q) continue;
      change.corners[k] = p;
      const SmoothSurface& surface = *brep_.faces[FaceId(std::size_t(face))].surface;
      change.uv[k] = surface.closest(at(p), change.uv[k]);
    }
    return change;
  }

  /// The least cosine between a triangle and its surface at its corners; 1 where nothing says otherwise.
  double agreement(std::uint32_t t, const Corners& c, const std::array<Point2, 3>& uv) const {
    const BrepFace& face = brep_.faces[FaceId(std::size_t(model_.input_face[TriangleId(std::size_t(t))]))];
    const Point normal = area(c);
    double least = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      if (dimension(c[k]) == 0 && poles_.contains(grid_.entity[c[k]].id)) continue;
      const double cosine = dot(normal, face.surface->normal(uv[k])) / length(normal);
      if (std::isfinite(cosine)) least = std::min(least, face.is_reversed ? -cosine : cosine);
    }
    return least;
  }

  /// @param share, gain  what the smallest angle's squared sine has to be: that share of what it is, and so much more
  bool is_better(const Plan& plan, const std::vector<std::uint32_t>& before, double share, double gain) const {
    double worst_before = 1, worst_after = 1;
    for (const std::uint32_t t : before) worst_before = std::min(worst_before, sine(corners(t)));
    for (const Change& change : plan.changed) {
      worst_after = std::min(worst_after, sine(change.corners));
      if (worst_after < std::min(share * worst_before + gain, kSmall)) return false;
    }
    for (const Change& change : plan.changed) {
      const double was = agreement(change.t, corners(change.t), grid_.corner_uv[change.t]);
      if (agreement(change.t, change.corners, change.uv) < std::min(kAgree, was)) return false;
    }
    return true;
  }

  /// Whether sheets that face away from each other would meet in a point of the plan, more closely than at `points`
  /// now.
  bool folds(const Plan& plan, std::uint32_t p, const std::vector<std::uint32_t>& points) const {
    double now = kWedge;
    for (const std::uint32_t q : points) {
      if (!star_.contains(q)) return true;
      std::vector<Corners> round;
      for (const std::uint32_t t : star_.at(q)) round.push_back(corners(t));
      now = std::min(now, least_wedge(round));
    }
    std::vector<Corners> then;
    for (const Change& change : plan.changed) then.push_back(change.corners);
    for (const std::uint32_t t : star_.at(p))
      if (std::find(plan.gone.begin(), plan.gone.end(), t) == plan.gone.end()) then.push_back(corners(t));
    return least_wedge(then) < (now < kWedge ? kWedgeShare * now : kWedge);
  }

  /// The least angle between any two of the triangles as sheets; pi where all face the same way.
  double least_wedge(const std::vector<Corners>& triangles) const {
    std::vector<Point> normals;
    for (const Corners& c : triangles) normals.push_back(area(c));
    double most = 0;
    for (std::size_t i = 0; i < normals.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) most = std::max(most, angle_between(normals[i], normals[k]));
    return std::numbers::pi - most;
  }

  void do_it(const Plan& plan) {
    for (const std::uint32_t t : plan.gone) {
      leave(t);
      is_gone_[t] = true;
    }
    for (const Change& change : plan.changed) {
      std::uint32_t t = change.t;
      if (change.is_new) {
        t = static_cast<std::uint32_t>(model_.triangles.size());
        const TriangleId from(std::size_t(change.t));
        model_.triangles.emplace_back();
        model_.patch_of_triangle.push_back(model_.patch_of_triangle[from]);
        model_.input_face.push_back(model_.input_face[from]);
        grid_.corner_uv.emplace_back();
        is_gone_.push_back(false);
      } else {
        leave(t);
      }
      for (std::size_t k = 0; k < 3; ++k) {
        model_.triangles[TriangleId(std::size_t(t))][k] = VertexId(std::size_t(change.corners[k]));
        star_[change.corners[k]].push_back(t);
      }
      grid_.corner_uv[t] = change.uv;
    }
  }

  void leave(std::uint32_t t) {
    for (const std::uint32_t p : corners(t)) std::erase(star_.at(p), t);
  }

  /// Point q of curves becomes p.
  void move_curves(std::uint32_t q, std::uint32_t p) {
    for (Curve& curve : model_.curves)
      for (VertexId& v : curve.vertices)
        if (v.value == q) v = VertexId(std::size_t(p));
    for (VertexId& v : model_.corners)
      if (v.value == q) v = VertexId(std::size_t(p));
    note_sides();
  }

  /// Curves along a b go through p.
  void bend_curves(std::uint32_t a, std::uint32_t b, std::uint32_t p) {
    const auto found = curves_.find(side_of(a, b));
    if (found == curves_.end()) return;
    for (const std::size_t c : found->second) {
      auto& chain = model_.curves[CurveId(c)].vertices;
      for (std::size_t i = 0; i + 1 < chain.size(); ++i)
        if (side_of(chain[i].value, chain[i + 1].value) == found->first) {
          chain.insert(chain.begin() + std::ptrdiff_t(i) + 1, VertexId(std::size_t(p)));
          break;
        }
    }
    note_sides();
  }

  void note_sides() {
    curves_.clear();
    gather_curves();
  }

  void finish() {
    drop_triangles();
    tidy_curves();
    drop_points();
  }

  void drop_triangles() {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < is_gone_.size(); ++t) {
      if (is_gone_[t]) continue;
      const TriangleId from(t), to(kept);
      model_.triangles[to] = model_.triangles[from];
      model_.patch_of_triangle[to] = model_.patch_of_triangle[from];
      model_.input_face[to] = model_.input_face[from];
      grid_.corner_uv[kept++] = grid_.corner_uv[t];
    }
    model_.triangles.resize(kept);
    model_.patch_of_triangle.resize(kept);
    model_.input_face.resize(kept);
    grid_.corner_uv.resize(kept);
  }

  /// Points twice in a row, ways there and back go; a side that several curves run along stays that of the first.
  void tidy_curves() {
    std::set<Side> taken;
    Array<CurveId, Curve> tidy;
    for (const Curve& curve : model_.curves) {
      std::vector<VertexId> run;
      const auto end_run = [&] {
        if (run.size() > 1) tidy.push_back({curve.name, run});
        run.clear();
      };
      for (const VertexId v : without_spikes(curve.vertices)) {
        if (!run.empty() && !taken.insert(side_of(run.back().value, v.value)).second) end_run();
        run.push_back(v);
      }
      end_run();
    }
    model_.curves = std::move(tidy);
    tidy_corners();
  }

  static std::vector<VertexId> without_spikes(const std::vector<VertexId>& vertices) {
    std::vector<VertexId> chain;
    for (const VertexId v : vertices) {
      if (!chain.empty() && chain.back() == v) continue;
      if (chain.size() > 1 && chain[chain.size() - 2] == v)
        chain.pop_back();
      else
        chain.push_back(v);
    }
    return chain;
  }

  void tidy_corners() {
    std::set<VertexId> seen;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < model_.corners.size(); ++i) {
      if (!seen.insert(model_.corners[i]).second) continue;
      model_.corners[kept] = model_.corners[i];
      model_.corner_names[kept++] = model_.corner_names[i];
    }
    model_.corners.resize(kept);
    model_.corner_names.resize(kept);
  }

  /// Those that became others.
  void drop_points() {
    std::vector<VertexId> number(model_.points.size());
    std::size_t kept = 0;
    for (std::uint32_t p = 0; p < number.size(); ++p) {
      const auto star = star_.find(p);
      if (star != star_.end() && star->second.empty() && !is_kept(p)) continue;
      number[p] = VertexId(kept);
      model_.points[VertexId(kept)] = model_.points[VertexId(std::size_t(p))];
      grid_.entity[kept++] = grid_.entity[p];
    }
    model_.points.resize(kept);
    grid_.entity.resize(kept);
    for (auto& t : model_.triangles)
      for (VertexId& v : t) v = number[v.index()];
    for (Curve& curve : model_.curves)
      for (VertexId& v : curve.vertices) v = number[v.index()];
    for (VertexId& v : model_.corners) v = number[v.index()];
  }

  const Brep& brep_;
  double below_;
  BrepGrid& grid_;
  Model& model_;
  const Context& context_;
  std::vector<bool> is_gone_;                                           ///< by triangle
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> star_;  ///< triangles of points near narrow ones
  std::set<std::uint32_t> poles_;                                       ///< corners of the Brep
  std::map<Side, std::set<std::size_t>> curves_;                        ///< by side: those that run along it
  std::vector<BrepBridge> bridges_;
};

}  // namespace

std::vector<BrepBridge> bridge_narrow_parts(const Brep& brep, double below, BrepGrid& grid, const Context& context) {
  return Bridger(brep, below, grid, context).run();
}

}  // namespace delfront
