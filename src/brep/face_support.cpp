// SPDX-License-Identifier: Apache-2.0
#include "brep/face_support.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "planar/constrain.hpp"
#include "planar/kernel.hpp"

namespace delfront {
namespace {

constexpr int kPiecesPerSide = 4;                            ///< of the border's sides
constexpr double kTurnPerCell = 4 * std::numbers::pi / 180;  ///< of normals, along a cell of the lattice
constexpr int kLeastCells = 24, kMostCells = 300;
constexpr int kSamples = 32;
constexpr double kOffset = 0.4371;  ///< of a cell: no line of the lattice is one of the border's
constexpr double kFlat = 1e-4;      ///< of the squared longest side: areas that are none
constexpr int kMostFlips = 20;
constexpr double kRoom = 0.3;  ///< of a cell: between points of the lattice and of the border

class SupportMaker {
 public:
  SupportMaker(const Brep& brep, const BrepFace& face, const Array<EdgeId, EdgePoints>& edges)
      : brep_(brep), face_(face), edges_(edges) {}

  FaceSupport run(Context& context) {
    add_borders();
    find_cells();
    domain_.curves.push_back({});
    for (const Point2 uv : uv_) domain_.points.push_back(to_plane(uv));
    add_lattice();
    triangulate(context);
    return std::move(support_);
  }

 private:
  void add_borders() {
    for (const auto& loop : face_.loops) {
      const std::size_t first = uv_.size();
      for (const BrepUse& use : loop) add_use(use);
      for (std::size_t i = first; i < uv_.size(); ++i) {
        const std::size_t next = i + 1 < uv_.size() ? i + 1 : first;
        domain_.segments.push_back({VertexId(i), VertexId(next)});
        domain_.curve_of_segment.push_back(CurveId(std::size_t(0)));
      }
    }
  }

  void add_use(const BrepUse& use) {
    const EdgePoints& points = edges_[use.edge];
    const BrepEdge& edge = brep_.edges[use.edge];
    const std::size_t pieces = edge.is_degenerate() ? kMostCells / 4 : kPiecesPerSide;
    const std::size_t all = pieces * (points.t.size() - 1);
    for (std::size_t i = 0; i < all; ++i) {
      const std::size_t k = use.is_reversed ? all - i : i, side = std::min(k / pieces, points.t.size() - 2);
      const double f = double(k - side * pieces) / double(pieces);
      const double t = (1 - f) * points.t[side] + f * points.t[side + 1];
      const bool is_given = k % pieces == 0;
      if (edge.is_degenerate())
        add_point(use.curve->at(t), points.at[0], {points.vertex[0], 0});
      else if (is_given)
        add_point(use.curve->at(t), points.at[k / pieces], {points.vertex[k / pieces], 0});
      else
        add_point(use.curve->at(t), edge.curve->at(t), {use.edge.value, k});
    }
  }

  /// @param key  what it is in space: a vertex of the edges and 0, or an edge and a number within it
  void add_point(Point2 uv, Point at, std::pair<std::uint32_t, std::size_t> key) {
    const auto [it, is_new] = known_.try_emplace(key, support_.model.points.next_id());
    if (is_new) support_.model.points.push_back(at);
    uv_.push_back(uv);
    vertex_.push_back(it->second);
  }

  /// As many cells each way as the normals turn.
  void find_cells() {
    low_ = high_ = uv_[0];
    for (const Point2 p : uv_) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
    }
    for (int way = 0; way < 2; ++way) {
      double most = 0;
      for (int i = 0; i < kSamples; ++i) {
        double turn = 0;
        Point last;
        for (int j = 0; j < kSamples; ++j) {
          const double f = (i + 0.5) / kSamples, g = (j + 0.5) / kSamples, x = way ? f : g, y = way ? g : f;
          const Point n = face_.surface->normal({low_.x + x * (high_.x - low_.x), low_.y + y * (high_.y - low_.y)});
          if (j > 0) turn += std::acos(std::clamp(dot(n, last), -1.0, 1.0));
          last = n;
        }
        most = std::max(most, turn);
      }
      cells_[way] = std::clamp(int(std::ceil(most / kTurnPerCell)), kLeastCells, kMostCells);
    }
  }

  Point2 to_plane(Point2 uv) const {
    return {(uv.x - low_.x) / (high_.x - low_.x) * cells_[0], (uv.y - low_.y) / (high_.y - low_.y) * cells_[1]};
  }
  Point2 to_uv(Point2 p) const {
    return {low_.x + p.x / cells_[0] * (high_.x - low_.x), low_.y + p.y / cells_[1] * (high_.y - low_.y)};
  }

  void add_lattice() {
    std::unordered_multimap<std::int64_t, Point2> border;
    const auto key = [&](int i, int j) { return std::int64_t(i) * (4 * kMostCells) + j; };
    for (const Point2 p : domain_.points) border.emplace(key(int(std::floor(p.x)), int(std::floor(p.y))), p);
    const auto has_room = [&](Point2 p, int i, int j) {
      for (int x = i - 1; x <= i + 1; ++x)
        for (int y = j - 1; y <= j + 1; ++y) {
          const auto [first, last] = border.equal_range(key(x, y));
          for (auto it = first; it != last; ++it)
            if (std::abs(it->second.x - p.x) < kRoom && std::abs(it->second.y - p.y) < kRoom) return false;
        }
      return true;
    };
    for (int i = 0; i < cells_[0]; ++i)
      for (int j = 0; j < cells_[1]; ++j) {
        const Point2 p = {i + kOffset, j + kOffset};
        if (!has_room(p, i, j)) continue;
        domain_.points.push_back(p);
        uv_.push_back(to_uv(p));
        vertex_.push_back(VertexId{});  // a point in space where a triangle uses it
      }
  }

  VertexId vertex_of(VertexIndex v) {
    if (!vertex_[v].is_valid()) {
      vertex_[v] = support_.model.points.next_id();
      support_.model.points.push_back(face_.surface->at(uv_[v]));
    }
    return vertex_[v];
  }

  /// Triangles from a pole to two places on one line to it have an area in the plane and none in space: the side from
  /// the pole to the farther place is flipped.
  void flip_flat(TriComplex& c) {
    for (int pass = 0, count = 1; pass < kMostFlips && count > 0; ++pass) {
      count = 0;
      for (TriIndex t = 0; t < c.tri.size(); ++t) {
        if (c.is_dead(t) || c.is_ghost(t) || c.tri[t].region == kOutside) continue;
        const VertexIndex* n = c.tri[t].node;
        const Point p[3] = {place_of(n[0]), place_of(n[1]), place_of(n[2])};
        unsigned longest = 0;  // opposite the corner of the same number
        double squared[3];
        for (unsigned e = 0; e < 3; ++e) squared[e] = squared_length(p[next_of(e)] - p[previous_of(e)]);
        for (unsigned e = 1; e < 3; ++e)
          if (squared[e] > squared[longest]) longest = e;
        if (std::min({squared[0], squared[1], squared[2]}) == 0) continue;
        if (length(cross(p[1] - p[0], p[2] - p[0])) > kFlat * squared[longest]) continue;
        const EdgeRef ref = 4 * t + longest, other = c.across(ref);
        if (c.is_constrained(ref) || c.is_ghost(other >> 2)) continue;
        const Point2 a = c.point[c.origin(ref)], b = c.point[c.target(ref)], q = c.point[c.apex(ref)],
                     d = c.point[c.apex(other)];
        if (orient2d(a, d, q) <= 0 || orient2d(d, b, q) <= 0) continue;
        c.flip(ref);
        ++count;
      }
    }
  }

  Point place_of(VertexIndex v) const {
    return vertex_[v].is_valid() ? support_.model.points[vertex_[v]] : face_.surface->at(uv_[v]);
  }

  void triangulate(Context& context) {
    PlanarGrid plane;
    TriComplex& c = plane.complex;
    c.point.assign(domain_.points.begin(), domain_.points.end());
    PlanarKernel kernel(c);
    std::vector<VertexIndex> same_as(domain_.points.size());
    for (VertexIndex v = 0; v < same_as.size(); ++v) same_as[v] = v;
    for (const auto& [v, first] : build_delaunay(c, kernel, context)) same_as[v] = first;
    insert_segments(domain_, same_as, plane, context);
    colour_regions(domain_, DomainOptions{}, plane);
    flip_flat(c);
    Model& m = support_.model;
    for (TriIndex t = 0; t < c.tri.size(); ++t) {
      if (c.is_dead(t) || c.is_ghost(t) || c.tri[t].region == kOutside) continue;
      const VertexIndex* n = c.tri[t].node;
      const std::array<VertexId, 3> corner = {vertex_of(n[0]), vertex_of(n[1]), vertex_of(n[2])};
      if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
      m.input_face.push_back(static_cast<std::uint32_t>(m.triangles.size()));
      m.triangles.push_back(corner);
      m.patch_of_triangle.push_back(PatchId(std::size_t(0)));
      support_.corner_uv.push_back({uv_[n[0]], uv_[n[1]], uv_[n[2]]});
    }
    m.patches.push_back({"surface", ""});
    m.feature_angle = 180;
  }

  const Brep& brep_;
  const BrepFace& face_;
  const Array<EdgeId, EdgePoints>& edges_;
  FaceSupport support_;
  std::map<std::pair<std::uint32_t, std::size_t>, VertexId> known_;
  std::vector<Point2> uv_;        ///< of the border's points, then the lattice's
  std::vector<VertexId> vertex_;  ///< of the support, by point
  PlanarDomain domain_;
  Point2 low_, high_;
  std::array<int, 2> cells_{};
};

}  // namespace

FaceSupport make_face_support(const Brep& brep, const BrepFace& face, const Array<EdgeId, EdgePoints>& edges,
                              Context& context) {
  return SupportMaker(brep, face, edges).run(context);
}

}  // namespace delfront
