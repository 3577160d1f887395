// SPDX-License-Identifier: Apache-2.0
// Which pieces have to be cut by each other. Two faces are clear of each other where their boxes are apart, or have no
// more in common than a corner or edge of both; flat faces with straight edges also where what each has on the line of
// both planes is covered by such, or, in one plane, no side of one comes near the other elsewhere. What is not shown to
// be clear counts as a contact: the general fuse finds out.
#include <BOPTools_BoxTree.hxx>
#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "translation.hpp"

namespace delfront::cad {
namespace {

constexpr double kFlatAngle = 1e-3;  ///< sine between planes: below, the line of both is badly defined
constexpr double kReach = 10;        ///< slacks: how near to what is shared a contact is of that

struct Segment {
  Point a, b;
  int corner[2] = {-1, -1};
  int edge = -1;
};

struct Outline {
  Box box;  ///< with the tolerance
  double tolerance = 0;
  bool is_plane = false;            ///< flat
  bool is_polygon = false;          ///< with straight edges alone
  Point origin, normal;             ///< of the plane
  std::vector<Segment> segments;    ///< of straight edges
  std::vector<int> corners, edges;  ///< ascending
};

struct Interval {
  double low, high;
};

double distance_to(const Segment& s, Point p) {
  const Point along = s.b - s.a;
  const double length2 = dot(along, along);
  const double t = length2 > 0 ? std::clamp(dot(p - s.a, along) / length2, 0.0, 1.0) : 0.0;
  return distance(p, s.a + t * along);
}

/// In one plane: ends, or a crossing.
double distance_between(const Segment& s, const Segment& t, Point normal) {
  double least = std::min({distance_to(s, t.a), distance_to(s, t.b), distance_to(t, s.a), distance_to(t, s.b)});
  const auto side = [&](const Segment& of, Point p) { return dot(cross(of.b - of.a, p - of.a), normal); };
  if (side(s, t.a) * side(s, t.b) < 0 && side(t, s.a) * side(t, s.b) < 0) least = 0;
  return least;
}

class Pair {
 public:
  Pair(const Outline& f, const Outline& g, const Translation& data)
      : f_(f), g_(g), data_(data), slack_(2 * (f.tolerance + g.tolerance)) {}

  bool is_clear() {
    for (int k = 0; k < 3; ++k) {
      common_.low[k] = std::max(f_.box.low[k], g_.box.low[k]);
      common_.high[k] = std::min(f_.box.high[k], g_.box.high[k]);
      if (common_.low[k] > common_.high[k]) return true;
    }
    find_shared();
    if (is_within_shared()) return true;
    if (!f_.is_plane || !g_.is_plane) return false;
    const double sine = length(cross(f_.normal, g_.normal));
    if (is_apart(f_, g_) || is_apart(g_, f_)) return true;
    if (sine >= kFlatAngle) return is_line_covered(cross(f_.normal, g_.normal));
    return f_.is_polygon && g_.is_polygon && is_in_plane_of(f_, g_) && are_clear_in_plane();
  }

 private:
  void find_shared() {
    std::vector<int> edges;
    std::set_intersection(f_.corners.begin(), f_.corners.end(), g_.corners.begin(), g_.corners.end(),
                          std::back_inserter(corners_));
    std::set_intersection(f_.edges.begin(), f_.edges.end(), g_.edges.begin(), g_.edges.end(),
                          std::back_inserter(edges));
    for (const Segment& s : f_.segments)
      if (std::binary_search(edges.begin(), edges.end(), s.edge)) segments_.push_back(s);
  }

  Point corner(int c) const { return data_.vertices[std::size_t(c)].at; }

  bool is_within(const Box& outer) const {
    for (int k = 0; k < 3; ++k)
      if (common_.low[k] < outer.low[k] - slack_ || common_.high[k] > outer.high[k] + slack_) return false;
    return true;
  }

  /// All that both boxes have lies at a shared corner, or along a shared edge parallel to an axis.
  bool is_within_shared() const {
    for (const int c : corners_) {
      Box box;
      box.add(corner(c));
      if (is_within(box)) return true;
    }
    for (const Segment& s : segments_) {
      Box box;
      box.add(s.a);
      box.add(s.b);
      int thick = 0;
      for (int k = 0; k < 3; ++k) thick += box.high[k] - box.low[k] > slack_;
      if (thick <= 1 && is_within(box)) return true;
    }
    return false;
  }

  static double height(const Outline& plane, Point p) { return dot(p - plane.origin, plane.normal); }

  /// A polygon on one side of a plane.
  bool is_apart(const Outline& plane, const Outline& polygon) const {
    if (!polygon.is_polygon) return false;
    bool is_above = true, is_below = true;
    for (const Segment& s : polygon.segments) {
      is_above = is_above && height(plane, s.a) > slack_;
      is_below = is_below && height(plane, s.a) < -slack_;
    }
    return is_above || is_below;
  }

  /// What a polygon has on another plane, along a line in it: where it lies there with its border, and where it goes
  /// through, seen from either side.
  std::vector<Interval> cut(const Outline& plane, const Outline& polygon, Point along) const {
    std::vector<Interval> result;
    std::vector<double> crossings[2];
    const auto at = [&](Point p) { return dot(p - plane.origin, along); };
    for (const Segment& s : polygon.segments) {
      double h[2] = {height(plane, s.a), height(plane, s.b)};
      for (double& x : h)
        if (std::abs(x) <= slack_) x = 0;
      if (h[0] == 0) result.push_back({at(s.a), at(s.a)});
      if (h[0] == 0 && h[1] == 0) result.push_back({std::min(at(s.a), at(s.b)), std::max(at(s.a), at(s.b))});
      for (const int zero_is_above : {0, 1}) {
        const bool above[2] = {zero_is_above ? h[0] >= 0 : h[0] > 0, zero_is_above ? h[1] >= 0 : h[1] > 0};
        if (above[0] == above[1]) continue;
        const double t = h[0] == h[1] ? 0 : h[0] / (h[0] - h[1]);
        crossings[zero_is_above].push_back(at(s.a + t * (s.b - s.a)));
      }
    }
    for (std::vector<double>& points : crossings) {
      std::sort(points.begin(), points.end());
      for (std::size_t i = 0; i + 1 < points.size(); i += 2) result.push_back({points[i], points[i + 1]});
    }
    return result;
  }

  /// Of one of them at least the part on the other's plane is known; both, where both are polygons.
  bool is_line_covered(Point along) const {
    along = (1 / length(along)) * along;
    if (!f_.is_polygon && !g_.is_polygon) return false;
    const Outline& polygon = g_.is_polygon ? g_ : f_;
    const Outline& plane = g_.is_polygon ? f_ : g_;
    std::vector<Interval> met = cut(plane, polygon, along);
    if (plane.is_polygon) {
      std::vector<Interval> both;
      const double shift = dot(polygon.origin - plane.origin, along);  // of the other's zero
      for (const Interval& b : cut(polygon, plane, along))
        for (const Interval& a : met) {
          const Interval common{std::max(a.low, b.low + shift), std::min(a.high, b.high + shift)};
          if (common.low <= common.high + kReach * slack_) both.push_back(common);
        }
      met = std::move(both);
    }
    const std::vector<Interval> covered = shared_along(plane, polygon, along);
    return std::all_of(met.begin(), met.end(), [&](const Interval& i) { return is_covered(i, covered); });
  }

  /// Shared corners and edges on the line of both planes, ascending.
  std::vector<Interval> shared_along(const Outline& plane, const Outline& other, Point along) const {
    std::vector<Interval> result;
    const auto is_on = [&](Point p) {
      return std::abs(height(plane, p)) <= kReach * slack_ && std::abs(height(other, p)) <= kReach * slack_;
    };
    const auto at = [&](Point p) { return dot(p - plane.origin, along); };
    for (const int c : corners_)
      if (is_on(corner(c))) result.push_back({at(corner(c)), at(corner(c))});
    for (const Segment& s : segments_)
      if (is_on(s.a) && is_on(s.b)) result.push_back({std::min(at(s.a), at(s.b)), std::max(at(s.a), at(s.b))});
    std::sort(result.begin(), result.end(), [](const Interval& a, const Interval& b) { return a.low < b.low; });
    return result;
  }

  bool is_covered(const Interval& wanted, const std::vector<Interval>& covered) const {
    const double reach = kReach * slack_;
    double from = wanted.low;
    for (const Interval& i : covered) {
      if (i.low > from + reach) break;
      if (i.high + reach >= from) from = std::max(from, i.high);
      if (from + reach >= wanted.high) return true;
    }
    return false;
  }

  bool is_in_plane_of(const Outline& plane, const Outline& polygon) const {
    return std::all_of(polygon.segments.begin(), polygon.segments.end(),
                       [&](const Segment& s) { return std::abs(height(plane, s.a)) <= slack_; });
  }

  /// No side of one comes near a side of the other but where they share it or a corner, and none runs inside the other.
  bool are_clear_in_plane() const {
    for (const Segment& s : f_.segments)
      for (const Segment& t : g_.segments)
        if (s.edge != t.edge && !are_clear(s, t)) return false;
    return !runs_inside(f_, g_) && !runs_inside(g_, f_);
  }

  bool are_clear(const Segment& s, const Segment& t) const {
    if (distance_between(s, t, f_.normal) > slack_) return true;
    for (const int i : {0, 1})
      for (const int k : {0, 1}) {
        if (s.corner[i] != t.corner[k]) continue;
        const Point far_of_s = i == 0 ? s.b : s.a, far_of_t = k == 0 ? t.b : t.a;
        return distance_to(t, far_of_s) > kReach * slack_ && distance_to(s, far_of_t) > kReach * slack_;
      }
    return false;
  }

  /// A place beside each side, within the polygon: does it lie in the other?
  bool runs_inside(const Outline& polygon, const Outline& other) const {
    return std::any_of(polygon.segments.begin(), polygon.segments.end(), [&](const Segment& s) {
      const Point along = s.b - s.a, beside = (1 / std::max(length(along), 1e-300)) * cross(polygon.normal, along);
      const double away = std::max(kReach * slack_, 1e-6 * length(along));
      Point p = 0.5 * (s.a + s.b) + away * beside;
      if (!holds(polygon, p)) p = p - 2 * away * beside;
      return holds(other, p);
    });
  }

  /// By the sides that a ray in the plane crosses.
  static bool holds(const Outline& polygon, Point p) {
    const Segment& first = polygon.segments[0];
    const Point u = (1 / std::max(length(first.b - first.a), 1e-300)) * (first.b - first.a);
    const Point v = cross(polygon.normal, u);
    bool is_inside = false;
    for (const Segment& s : polygon.segments) {
      const Point a = s.a - p, b = s.b - p;
      const double ya = dot(a, v), yb = dot(b, v);
      if ((ya > 0) == (yb > 0)) continue;
      const double x = dot(a, u) + ya / (ya - yb) * (dot(b, u) - dot(a, u));
      if (x > 0) is_inside = !is_inside;
    }
    return is_inside;
  }

  const Outline &f_, &g_;
  const Translation& data_;
  double slack_;
  Box common_;
  std::vector<int> corners_;       ///< shared
  std::vector<Segment> segments_;  ///< of shared straight edges
};

class Finder {
 public:
  explicit Finder(const Translation& data) : data_(data), group_(data.is_closed.size()) {
    std::iota(group_.begin(), group_.end(), 0);
  }

  std::vector<std::vector<int>> run() {
    for (std::size_t f = 0; f < data_.faces.size(); ++f) outlines_.push_back(outline_of(f));
    BOPTools_BoxTree tree;
    tree.SetSize(int(outlines_.size()));
    for (std::size_t f = 0; f < outlines_.size(); ++f) {
      const Box& box = outlines_[f].box;
      if (box.is_empty()) continue;
      tree.Add(int(f), BVH_Box<double, 3>(BVH_Vec3d(box.low.x, box.low.y, box.low.z),
                                          BVH_Vec3d(box.high.x, box.high.y, box.high.z)));
    }
    tree.Build();
    Selector selector(*this);
    selector.SetBVHSets(&tree, &tree);
    selector.SetSame(true);
    selector.Select();
    return groups();
  }

 private:
  /// Looks at each pair of faces when it is found; keeps none.
  class Selector : public BOPTools_BoxPairSelector {
   public:
    explicit Selector(Finder& finder) : finder_(finder) {}
    Standard_Boolean Accept(const Standard_Integer a, const Standard_Integer b) override {
      if (RejectElement(a, b)) return false;
      finder_.look_at(std::size_t(myBVHSet1->Element(a)), std::size_t(myBVHSet2->Element(b)));
      return true;
    }

   private:
    Finder& finder_;
  };

  Outline outline_of(std::size_t f) const {
    const Face& face = data_.faces[f];
    Outline o;
    o.tolerance = face.tolerance;
    o.is_plane = face.surface.kind == SurfaceData::Kind::plane;
    o.is_polygon = o.is_plane;
    o.origin = face.surface.frame.origin;
    o.normal = face.surface.frame.z;
    for (const auto& loop : face.loops)
      for (const Use& use : loop) add_edge(use.edge, o);
    for (std::vector<int>* ids : {&o.corners, &o.edges}) {
      std::sort(ids->begin(), ids->end());
      ids->erase(std::unique(ids->begin(), ids->end()), ids->end());
    }
    for (const Segment& s : o.segments) o.box.add(s.a), o.box.add(s.b);
    if (!o.is_polygon) add_box_of(f, o.box);
    for (int k = 0; k < 3 && !o.box.is_empty(); ++k) o.box.low[k] -= o.tolerance, o.box.high[k] += o.tolerance;
    return o;
  }

  void add_edge(int e, Outline& o) const {
    const Edge& edge = data_.edges[std::size_t(e)];
    for (const int c : edge.corners) {
      if (c < 0) continue;
      o.corners.push_back(c);
      o.tolerance = std::max(o.tolerance, data_.vertices[std::size_t(c)].tolerance);
    }
    o.tolerance = std::max(o.tolerance, edge.tolerance);
    o.edges.push_back(e);
    const bool is_straight = edge.curve.kind == CurveData::Kind::line && edge.corners[0] >= 0 && edge.corners[1] >= 0;
    o.is_polygon = o.is_polygon && is_straight;
    if (!is_straight) return;
    const auto at = [&](int c) { return data_.vertices[std::size_t(c)].at; };
    o.segments.push_back({at(edge.corners[0]), at(edge.corners[1]), {edge.corners[0], edge.corners[1]}, e});
  }

  void add_box_of(std::size_t f, Box& into) const {
    Bnd_Box box;
    BRepBndLib::Add(data_.shapes[f], box, false);
    if (box.IsVoid()) return;
    Point low, high;
    box.Get(low.x, low.y, low.z, high.x, high.y, high.z);
    into.add(low);
    into.add(high);
  }

  int find(int p) {
    while (group_[std::size_t(p)] != p) p = group_[std::size_t(p)] = group_[std::size_t(group_[std::size_t(p)])];
    return p;
  }

  void look_at(std::size_t f, std::size_t g) {
    const std::vector<int>&a = data_.owners[f].pieces, &b = data_.owners[g].pieces;
    if (a.empty() || b.empty()) return;
    const auto is_closed = [&](int p) { return bool(data_.is_closed[std::size_t(p)]); };
    for (const int p : a)
      if (std::find(b.begin(), b.end(), p) != b.end()) return;  // of one piece
    if (std::none_of(a.begin(), a.end(), is_closed) && std::none_of(b.begin(), b.end(), is_closed)) return;
    std::vector<int> all = a;
    all.insert(all.end(), b.begin(), b.end());
    const int first = find(all[0]);
    if (std::all_of(all.begin(), all.end(), [&](int p) { return find(p) == first; })) return;  // known already
    if (Pair(outlines_[f], outlines_[g], data_).is_clear()) return;
    for (const int p : all) {
      const int x = find(all[0]), y = find(p);
      group_[std::size_t(std::max(x, y))] = std::min(x, y);
    }
  }

  std::vector<std::vector<int>> groups() {
    std::map<int, std::vector<int>> members;
    for (std::size_t p = 0; p < group_.size(); ++p) members[find(int(p))].push_back(int(p));
    std::vector<std::vector<int>> result;
    for (auto& [first, pieces] : members)
      if (pieces.size() > 1) result.push_back(std::move(pieces));
    return result;
  }

  const Translation& data_;
  std::vector<Outline> outlines_;
  std::vector<int> group_;  ///< by piece: a piece of the same group, or itself
};

}  // namespace

std::vector<std::vector<int>> find_contacts(const Translation& data) {
  if (data.is_closed.size() < 2) return {};
  return Finder(data).run();
}

}  // namespace delfront::cad
