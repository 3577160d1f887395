// SPDX-License-Identifier: Apache-2.0
#include "planar/constrain.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planar/edit.hpp"

namespace delfront {

namespace {

constexpr std::size_t kSegmentsPerCancelCheck = 1024;

class SegmentInserter {
 public:
  explicit SegmentInserter(PlanarGrid& grid) : grid_(grid), c_(grid.complex), replacer_(c_) {}

  void insert(VertexIndex a, VertexIndex b, std::uint32_t curve) {
    while (a != b) {
      const Step step = look_along(a, b);
      VertexIndex end = step.on_ray;
      if (end == kInfinity) {
        end = collect_cavity(a, b, step.crossed);
        if (end == kInfinity) return;  // it crosses another segment: said at the end
        retriangulate(a, end);
      }
      add_piece(a, end, curve);
      a = end;
    }
  }

  std::vector<Place> crossings;
  std::size_t num_overlaps = 0;

 private:
  struct Step {
    VertexIndex on_ray;  ///< the next vertex on the way, where an edge leads to it
    EdgeRef crossed;     ///< else the edge that is crossed first, run from the right of the way to its left
  };

  Point2 at(VertexIndex v) const { return c_.point[v]; }

  Step look_along(VertexIndex a, VertexIndex b) const {
    const EdgeRef first = c_.first_edge(a);
    EdgeRef ref = first;
    do {
      const VertexIndex t = c_.target(ref), u = c_.apex(ref);
      if (t == b) return {b, kNoTri};
      const int side = t == kInfinity ? 0 : orient2d(at(a), at(b), at(t));
      if (t != kInfinity && side == 0 &&
          dot_sign({at(a).x, at(a).y, 0}, {at(b).x, at(b).y, 0}, {at(t).x, at(t).y, 0}) > 0)
        return {t, kNoTri};
      if (side < 0 && u != kInfinity && orient2d(at(a), at(b), at(u)) > 0)
        return {kInfinity, TriComplex::next_edge(ref)};
      ref = c_.turn_left(ref);
    } while (ref != first);
    DELFRONT_CHECK(false && "a segment leaves its first vertex through a triangle");
    return {};
  }

  /// The triangles cut by a -> b as far as the first vertex on it, which is returned; kInfinity where a segment is cut.
  VertexIndex collect_cavity(VertexIndex a, VertexIndex b, EdgeRef crossed) {
    cavity_.assign(1, crossed >> 2);
    right_.assign(1, c_.origin(crossed));
    left_.assign(1, c_.target(crossed));
    for (;;) {
      if (c_.is_constrained(crossed)) {
        add_crossing(a, b, crossed);
        return kInfinity;
      }
      const EdgeRef other = c_.across(crossed);
      cavity_.push_back(other >> 2);
      const VertexIndex w = c_.apex(other);
      const int side = w == b ? 0 : orient2d(at(a), at(b), at(w));
      if (side == 0) return w;
      (side > 0 ? left_ : right_).push_back(w);
      crossed = side > 0 ? TriComplex::next_edge(other) : TriComplex::previous_edge(other);
    }
  }

  void add_crossing(VertexIndex a, VertexIndex b, EdgeRef crossed) {
    const VertexIndex p = c_.origin(crossed), q = c_.target(crossed);
    const double to_p = cross(at(b) - at(a), at(p) - at(a)), to_q = cross(at(b) - at(a), at(q) - at(a));
    const double t = to_p != to_q ? to_p / (to_p - to_q) : 0.5;
    const Point2 place = at(p) + t * (at(q) - at(p));
    crossings.push_back({{place.x, place.y, 0}, {a, b, p, q}});
  }

  void retriangulate(VertexIndex a, VertexIndex end) {
    corners_.clear();
    fill(a, end, left_);
    std::reverse(right_.begin(), right_.end());
    fill(end, a, right_);
    for (const Corners& t : corners_) DELFRONT_CHECK(orient2d(at(t[0]), at(t[1]), at(t[2])) > 0);
    replacer_.replace(cavity_, corners_);
  }

  /// Constrained Delaunay triangulation of what lies between the edge p -> q and a chain on its left from p to q.
  void fill(VertexIndex p, VertexIndex q, const std::vector<VertexIndex>& chain) {
    work_.assign(1, {p, q, 0, chain.size()});
    while (!work_.empty()) {
      const Part part = work_.back();
      work_.pop_back();
      if (part.first == part.end) continue;
      std::size_t best = part.first;
      for (std::size_t i = part.first + 1; i < part.end; ++i)
        if (incircle(at(part.p), at(part.q), at(chain[best]), at(chain[i])) > 0) best = i;
      corners_.push_back({part.p, part.q, chain[best]});
      work_.push_back({part.p, chain[best], part.first, best});
      work_.push_back({chain[best], part.q, best + 1, part.end});
    }
  }

  void add_piece(VertexIndex a, VertexIndex b, std::uint32_t curve) {
    const EdgeRef ref = c_.find_edge(a, b);
    DELFRONT_CHECK(ref != kNoTri);
    if (c_.is_constrained(ref)) {
      ++num_overlaps;  // given twice: the first stays
      return;
    }
    c_.set_constrained(ref, true);
    grid_.pieces.push_back({a, b, curve});
  }

  struct Part {
    VertexIndex p, q;
    std::size_t first, end;
  };

  PlanarGrid& grid_;
  TriComplex& c_;
  std::vector<TriIndex> cavity_;
  std::vector<VertexIndex> left_, right_;
  std::vector<Corners> corners_;
  std::vector<Part> work_;
  Replacer replacer_;
};

}  // namespace

void insert_segments(const PlanarDomain& domain, const std::vector<VertexIndex>& same_as, PlanarGrid& grid,
                     Context& context) {
  SegmentInserter inserter(grid);
  grid.complex.index_vertices();
  std::vector<std::size_t> without_length;
  for (std::size_t i = 0; i < domain.segments.size(); ++i) {
    if (i % kSegmentsPerCancelCheck == 0) context.progress("recover", i, domain.segments.size(), "segments");
    const VertexIndex a = same_as[domain.segments[i][0].index()], b = same_as[domain.segments[i][1].index()];
    if (a == b) without_length.push_back(i);
    inserter.insert(a, b, domain.curve_of_segment[i].value);
  }
  if (!without_length.empty()) {
    const Point2 p = grid.complex.point[same_as[domain.segments[without_length[0]][0].index()]];
    grid.warnings.push_back(fmt::format("{} segments of no length were left out, the first at ({:.9g}, {:.9g})",
                                        without_length.size(), p.x, p.y));
  }
  if (inserter.num_overlaps > 0)
    grid.warnings.push_back(fmt::format("{} segments lie on others; the first given stays", inserter.num_overlaps));
  if (inserter.crossings.empty()) return;
  const Place& first = inserter.crossings.front();
  throw InputError(
      fmt::format(
          "segments cross, in {} places; the first near ({:.9g}, {:.9g}), between points {} and {}, and {} and {}; "
          "give the point where they cross to both of them",
          inserter.crossings.size(), first.at.x, first.at.y, first.ids[0], first.ids[1], first.ids[2], first.ids[3]),
      inserter.crossings);
}

}  // namespace delfront
