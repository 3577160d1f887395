// SPDX-License-Identifier: Apache-2.0
// Gaps between faces. From places on the true surface rays leave into the space to be gridded, along the normal and,
// where that sees none, 30 degrees round it. The first face of the look that a ray leaves that space through ends it;
// chords of the face that it starts on are met from the other side, and do not count. The other side of the gap is the
// place on the true face that belongs to the nearest place of that triangle.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "base/parallel.hpp"
#include "brep_sizes/size_parts.hpp"
#include "delfront/surface_check.hpp"
#include "sizing/geometry_facets.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

constexpr double kTilt = std::numbers::pi / 6;
constexpr int kTilted = 3;
constexpr int kMostCuts = 7;          ///< of a piece, in four
constexpr double kShortPiece = 0.01;  ///< of the extent: no shorter ones are cut
constexpr double kInset = 0.05;       ///< of places near corners, from them to the middle
constexpr std::size_t kGrain = 64;

struct Opposite {
  double distance = std::numeric_limits<double>::infinity();
  bool is_wedge = false;
};

/// Shares of the corners at a place of a triangle.
std::array<double, 3> shares(Point p, const std::array<Point, 3>& corner) {
  const Point u = corner[1] - corner[0], v = corner[2] - corner[0], w = p - corner[0];
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
  const double det = uu * vv - uv * uv;
  if (!(det > 0)) return {1, 0, 0};
  const double b = (vv * wu - uv * wv) / det, c = (uu * wv - uv * wu) / det;
  return {1 - b - c, b, c};
}

class BrepGaps {
 public:
  BrepGaps(const Brep& brep, const Model& grid, std::span<const FacePiece> pieces, double extent, const BrepSizes& wish,
           Context& context)
      : pieces_(pieces.begin(), pieces.end()),
        hmin_(wish.gap_hmin > 0 ? wish.gap_hmin : wish.hmin),
        cells_(wish.gap_cells),
        largest_(wish.hmax * wish.gap_cells),
        shortest_(kShortPiece * extent),
        cos_facing_(std::cos(GapSizes{}.facing_deg * std::numbers::pi / 180)) {
    point_outwards(grid, context);
    std::vector<std::array<Point, 3>> corners;
    for (const FacePiece& p : pieces_) {
      corners.push_back(p.at);
      const Point twice = cross(p.at[1] - p.at[0], p.at[2] - p.at[0]);
      normal_.push_back(twice / std::max(length(twice), 1e-300));
    }
    tree_ = TriangleTree(std::move(corners));
    find_neighbours(brep);
  }

  GeometrySources look(std::size_t piece, double side) const {
    GeometrySources found;
    look(pieces_[piece], side, 0, found);
    return found;
  }

 private:
  /// Sides are told by normals: shells that point inwards are turned.
  void point_outwards(const Model& grid, Context& context) {
    Model turned = grid;
    if (orient_shells(turned, context) == 0) return;
    for (std::size_t t = 0; t < pieces_.size(); ++t) {
      if (turned.triangles[TriangleId(t)] == grid.triangles[TriangleId(t)]) continue;
      FacePiece& p = pieces_[t];
      p.is_reversed = !p.is_reversed;
      std::swap(p.at[1], p.at[2]);
      std::swap(p.uv[1], p.uv[2]);
      std::swap(p.pole[1], p.pole[2]);
    }
  }

  void find_neighbours(const Brep& brep) {
    std::vector<std::vector<std::uint32_t>> faces(brep.edges.size());
    for (std::uint32_t f = 0; f < brep.faces.size(); ++f)
      for (const auto& loop : brep.faces[FaceId(std::size_t(f))].loops)
        for (const BrepUse& use : loop) faces[use.edge.index()].push_back(f);
    for (const auto& at_edge : faces)
      for (const std::uint32_t f : at_edge)
        for (const std::uint32_t g : at_edge) neighbours_.insert({f, g});
  }
  bool are_joined(std::uint32_t f, std::uint32_t g) const { return f == g || neighbours_.count({f, g}) > 0; }

  Opposite from_place(const FacePiece& piece, double side, Point2 uv) const {
    const SurfaceTangents s = piece.surface->tangents(uv);
    const Point ahead = side * piece.normal(uv);
    Point u = s.u - dot(s.u, ahead) * ahead;
    if (!(length(u) > 0)) u = piece.at[1] - piece.at[0];
    u = u / std::max(length(u), 1e-300);
    const Point v = cross(ahead, u);
    Opposite best;
    for (int k = -1; k < (best.distance < largest_ ? 0 : kTilted); ++k) {  // askew only where nothing is straight ahead
      const double turn = 2 * std::numbers::pi * k / kTilted;
      const Point direction =
          k < 0 ? ahead : std::cos(kTilt) * ahead + std::sin(kTilt) * (std::cos(turn) * u + std::sin(turn) * v);
      const auto hit = tree_.first_on_ray(s.at, direction, std::min(largest_, 2 * best.distance),
                                          [&](std::uint32_t t) { return -side * dot(normal_[t], direction) > 0; });
      if (hit.found()) take(piece, side, s.at, ahead, hit, best);
    }
    return best;
  }

  void take(const FacePiece& piece, double side, Point from, Point ahead, const TriangleTree::Hit& hit,
            Opposite& best) const {
    const FacePiece& other = pieces_[hit.triangle];
    const auto [a, b, c] = other.at;
    const Point nearest = nearest_point_on_triangle(from, a, b, c);
    const bool is_ahead = dot(nearest - from, ahead) >= cos_facing_ * distance(nearest, from);
    const std::array<double, 3> share = shares(is_ahead ? nearest : hit.at, other.at);
    Point2 uv{0, 0};
    for (std::size_t k = 0; k < 3; ++k) uv = {uv.x + share[k] * other.uv[k].x, uv.y + share[k] * other.uv[k].y};
    const double facing = -side * dot(other.normal(uv), ahead);
    if (facing < cos_facing_) return;
    const bool is_joined = are_joined(piece.face, other.face);
    if (is_joined && facing < std::cos(kWedge)) return;
    const double width = distance(from, other.surface->at(uv));
    if (width > 0 && width < best.distance) best = {width, is_joined};
  }

  void look(const FacePiece& piece, double side, int cuts, GeometrySources& found) const {
    const Point2 middle = piece.middle();
    Opposite nearest = from_place(piece, side, middle);
    double most = nearest.distance;
    for (std::size_t k = 0; k < 3; ++k) {
      if (piece.pole[k] != 0) continue;
      const Opposite seen = from_place(
          piece, side,
          {(1 - kInset) * piece.uv[k].x + kInset * middle.x, (1 - kInset) * piece.uv[k].y + kInset * middle.y});
      most = std::max(most, seen.distance);
      if (seen.distance < nearest.distance) nearest = seen;
    }
    const double least = nearest.distance;
    if (!(least < largest_)) return;
    const double floor = nearest.is_wedge ? kWedgeFloor * hmin_ : hmin_;
    const bool is_even = most <= std::max(kEvenGaps * least, floor * cells_);
    if (!is_even && cuts < kMostCuts && piece.longest_side() > std::max({least, floor * cells_, shortest_})) {
      for (const FacePiece& part : piece.quarters()) look(part, side, cuts + 1, found);
      return;
    }
    add_source(found, simplex(piece.at), least / cells_, floor, "gap");
  }

  std::vector<FacePiece> pieces_;
  std::vector<Point> normal_;
  TriangleTree tree_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> neighbours_;
  double hmin_, cells_, largest_, shortest_, cos_facing_;
};

}  // namespace

GeometrySources find_gaps(const Brep& brep, const Model& grid, std::span<const FacePiece> pieces, double extent,
                          const BrepSizes& wish, Context& context) {
  const BrepGaps gaps(brep, grid, pieces, extent, wish, context);
  std::vector<GeometrySources> blocks((pieces.size() + kGrain - 1) / kGrain);
  parallel_ranges(context.threads, pieces.size(), kGrain, [&](std::size_t first, std::size_t last) {
    context.check_limits();
    GeometrySources& block = blocks[first / kGrain];
    for (std::size_t i = first; i < last; ++i) {
      if (wish.gap_side != GapSizes::Side::ahead) block.append(gaps.look(i, -1));
      if (wish.gap_side != GapSizes::Side::behind) block.append(gaps.look(i, 1));
    }
  });
  GeometrySources found;
  for (GeometrySources& block : blocks) found.append(std::move(block));
  return found;
}

}  // namespace delfront
