// SPDX-License-Identifier: Apache-2.0
// Gaps. A triangle (or a piece of one) is looked at from seven places on it: middle, near the corners, near the middles
// of the sides. From each, seven rays leave into the space to be gridded: along the normal and 30 degrees round it, so
// that a face that stands askew is met nearly square. The first face that a ray meets ends it; where that face turns
// its own inside towards us (the angle between both normals and opposite is small) its nearest point is the other side
// of a gap. Walls beside us, and faces round a convex corner, stand at more than that angle and do not count. A piece
// whose places see gaps of about one width becomes one source; others are cut in two across the longest side, until
// they are no longer than the gap they see or the size asked for is down to hmin.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"
#include "fmt/format.h"
#include "sizing/geometry_facets.hpp"
#include "sizing/geometry_plane.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTilt = 30 * kPi / 180;
constexpr int kTilted = 6;
constexpr double kEvenWidth = 1.5;     // gaps within this ratio count as one width
constexpr int kMostCuts = 14;          // of one triangle, one after the other: 2^14 pieces
constexpr double kShortPiece = 0.005;  // of the diagonal: no shorter ones are cut, which bounds their number
constexpr double kInset = 0.05;        // of places near corners and sides, from them towards the middle

void check_gap(const char* word, const GapSizes& wish) {
  check_bounds(word, wish.hmin, wish.hmax);
  if (!(wish.cells > 0) || std::isinf(wish.cells))
    throw UsageError(fmt::format("{} = {}: cells across, above 0; usual are 1 to 5", word, wish.cells));
  if (!(wish.facing_deg > 0 && wish.facing_deg < 90))
    throw UsageError(fmt::format("{}: facing angle {}, degrees above 0 and below 90", word, wish.facing_deg));
}

struct Opposite {
  double distance = kInfinity;
  Point at;
};

class GapFinder {
 public:
  GapFinder(const Facets& facets, const GapSizes& wish)
      : facets_(facets),
        is_kept_(wish.is_kept),
        cells_(wish.cells),
        hmin_(usual_hmin(facets, wish.hmin)),
        largest_(std::min(wish.hmax * wish.cells, facets.diagonal())),
        shortest_(kShortPiece * facets.diagonal()),
        cos_facing_(std::cos(wish.facing_deg * kPi / 180)) {
    std::vector<std::array<Point, 3>> corners(facets.num_triangles());
    for (std::size_t t = 0; t < corners.size(); ++t) corners[t] = facets.corners(t);
    tree_ = TriangleTree(std::move(corners));
  }

  GeometrySources look(std::uint32_t triangle, double sign) const {
    GeometrySources found;
    look(triangle, sign, facets_.corners(triangle), 0, found);
    return found;
  }

 private:
  Opposite from_place(std::uint32_t triangle, double sign, Point from) const {
    const Point ahead = sign * facets_.normal[triangle];
    const auto [u, v] = plane_frame(ahead);
    Opposite best;
    for (int k = -1; k < kTilted; ++k) {
      const double turn = 2 * kPi * k / kTilted;
      const Point direction =
          k < 0 ? ahead : std::cos(kTilt) * ahead + std::sin(kTilt) * (std::cos(turn) * u + std::sin(turn) * v);
      const auto hit = tree_.first_on_ray(from, direction, std::min(largest_, 2 * best.distance),
                                          [&](std::uint32_t t) { return t != triangle && facets_.is_used[t]; });
      if (!hit.found()) continue;
      // the side of the other face that we see must look back at us
      const double facing = dot(facets_.normal[hit.triangle], ahead);
      const bool is_seen_from_behind = dot(facets_.normal[hit.triangle], direction) > 0;
      if (std::abs(facing) < cos_facing_ || (facing > 0) != is_seen_from_behind) continue;
      const auto& [a, b, c] = tree_.corners(hit.triangle);
      const Point nearest = nearest_point_on_triangle(from, a, b, c);
      // where its nearest point lies behind us or to the side, the place met stands for it
      const Point to = dot(nearest - from, ahead) >= cos_facing_ * distance(nearest, from) ? nearest : hit.at;
      const double width = distance(from, to);
      if (!(width > 0 && width < best.distance)) continue;
      if (!is_kept_ || is_kept_(0.5 * (from + to))) best = {width, to};
    }
    return best;
  }

  /// What a piece sees: the nearest from all its places, and the farthest of what each place sees nearest.
  struct Sight {
    Opposite nearest;
    Point from;
    double most = 0;
  };

  Sight look_from(std::uint32_t triangle, double sign, const std::array<Point, 3>& p, double length) const {
    const Point middle = (p[0] + p[1] + p[2]) / 3;
    Sight sight{from_place(triangle, sign, middle), middle, 0};
    sight.most = sight.nearest.distance;
    if (length <= std::max(sight.nearest.distance, sight.nearest.distance < largest_ ? 0 : shortest_)) return sight;
    for (std::size_t k = 0; k < 6; ++k) {
      const Point edge = k < 3 ? p[k] : 0.5 * (p[k - 3] + p[(k - 2) % 3]);
      const Point from = (1 - kInset) * edge + kInset * middle;
      const Opposite seen = from_place(triangle, sign, from);
      sight.most = std::max(sight.most, seen.distance);
      if (seen.distance < sight.nearest.distance) {
        sight.nearest = seen;
        sight.from = from;
      }
    }
    return sight;
  }

  void look(std::uint32_t triangle, double sign, const std::array<Point, 3>& p, int cuts,
            GeometrySources& found) const {
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (distance(p[k], p[(k + 1) % 3]) > distance(p[longest], p[(longest + 1) % 3])) longest = k;
    const double length = distance(p[longest], p[(longest + 1) % 3]);
    const Sight sight = look_from(triangle, sign, p, length);
    const double least = sight.nearest.distance;
    if (!(least < largest_)) return;
    const bool is_even = sight.most <= kEvenWidth * least || sight.most <= hmin_ * cells_;
    if (!is_even && cuts < kMostCuts && length > std::max({least, hmin_ * cells_, shortest_})) {
      const Point cut = 0.5 * (p[longest] + p[(longest + 1) % 3]), apex = p[(longest + 2) % 3];
      look(triangle, sign, {p[longest], cut, apex}, cuts + 1, found);
      look(triangle, sign, {cut, p[(longest + 1) % 3], apex}, cuts + 1, found);
      return;
    }
    add_source(found, simplex(p), least / cells_, hmin_, "gap");
    add_source(found, simplex(sight.from, sight.nearest.at), least / cells_, hmin_, "gap");
  }

  const Facets& facets_;
  const std::function<bool(Point)>& is_kept_;
  TriangleTree tree_;
  double cells_, hmin_, largest_, shortest_, cos_facing_;
};

/// Lines across a patch, from one side of one edge.
class LineFinder {
 public:
  LineFinder(const Facets& facets, const GapSizes& wish)
      : facets_(facets),
        cells_(wish.cells),
        hmin_(usual_hmin(facets, wish.hmin)),
        largest_(std::min(wish.hmax * wish.cells, facets.diagonal())),
        cos_facing_(std::cos(wish.facing_deg * kPi / 180)) {}

  void look(std::uint32_t half_edge, double from, double to, int cuts, GeometrySources& found) const {
    constexpr int kMostLineCuts = 10;
    constexpr std::array<double, 3> kPlaces{0.1, 0.5, 0.9};
    const Point start = facets_.start(half_edge), along = facets_.end(half_edge) - start;
    std::array<PatchCrossing, 3> seen;
    std::size_t nearest = 0;
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      seen[i] = cross_patch(facets_, half_edge, from + kPlaces[i] * (to - from), largest_, cos_facing_);
      if (seen[i].distance < seen[nearest].distance) nearest = i;
      most = std::max(most, seen[i].distance);
    }
    const double least = seen[nearest].distance;
    if (!(least < largest_)) return;
    const bool is_even = most <= kEvenWidth * least || most <= hmin_ * cells_;
    const double part = (to - from) * length(along);
    if (!is_even && cuts < kMostLineCuts && part > std::max(least, hmin_ * cells_)) {
      look(half_edge, from, 0.5 * (from + to), cuts + 1, found);
      look(half_edge, 0.5 * (from + to), to, cuts + 1, found);
      return;
    }
    const Point place = start + (from + kPlaces[nearest] * (to - from)) * along;
    add_source(found, simplex(start + from * along, start + to * along), least / cells_, hmin_, "proximity");
    add_source(found, simplex(place, seen[nearest].at), least / cells_, hmin_, "proximity");
  }

 private:
  const Facets& facets_;
  double cells_, hmin_, largest_, cos_facing_;
};

}  // namespace

GeometrySources find_gap_sizes(const Model& model, const GapSizes& wish, Context& context) {
  check_gap("gap", wish);
  if (is_in_the_plane(model)) return find_plane_gap_sizes(model, wish, context);
  const Facets facets(model);
  const GapFinder finder(facets, wish);
  constexpr std::size_t kGrain = 256, kBlocksPerReport = 16;
  const std::size_t n = facets.num_triangles(), num_blocks = (n + kGrain - 1) / kGrain;
  std::vector<GeometrySources> blocks(num_blocks);
  const auto look_from = [&](std::size_t block) {
    context.check_limits();
    for (std::size_t t = block * kGrain; t < std::min(n, (block + 1) * kGrain); ++t) {
      if (!facets.is_used[t]) continue;
      if (wish.side != GapSizes::Side::ahead) blocks[block].append(finder.look(static_cast<std::uint32_t>(t), -1));
      if (wish.side != GapSizes::Side::behind) blocks[block].append(finder.look(static_cast<std::uint32_t>(t), 1));
    }
  };
  for (std::size_t first = 0; first < num_blocks; first += kBlocksPerReport) {  // progress is told by this thread
    context.progress("sizes", std::min(n, first * kGrain), n, "triangles looked from");
    parallel_for(context.threads, std::min(kBlocksPerReport, num_blocks - first),
                 [&](std::size_t i) { look_from(first + i); });
  }
  context.progress("sizes", n, n, "triangles looked from");
  GeometrySources found;
  for (GeometrySources& block : blocks) found.append(std::move(block));
  return found;
}

GeometrySources find_line_gap_sizes(const Model& model, const GapSizes& wish, Context& context) {
  check_gap("proximity", wish);
  const Facets facets(model);
  const LineFinder finder(facets, wish);
  GeometrySources found;
  for (std::size_t e = 0; e < facets.edges.size(); ++e) {
    if (e % 256 == 0) context.progress("sizes", e, facets.edges.size(), "edges looked from");
    if (!facets.is_line[e]) continue;
    for (const std::uint32_t half : facets.edges.half_edges(e)) finder.look(half, 0, 1, 0, found);
  }
  return found;
}

}  // namespace delfront
