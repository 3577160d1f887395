// SPDX-License-Identifier: Apache-2.0
// Gaps between lines in the plane: from three places on each segment (or a piece of one), to both sides, five rays
// along the normal and up to 30 degrees beside it. The first segment met ends a ray; where it faces ours, its nearest
// point is the other side of a gap. A segment that shares an end with ours blocks the view, but is no other side: sharp
// corners of two segments are no gap. Pieces are cut in two where the gap changes.
#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "sizing/geometry_plane.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<double, 5> kTilts{0, 15 * kPi / 180, -15 * kPi / 180, 30 * kPi / 180, -30 * kPi / 180};
constexpr std::array<double, 3> kPlaces{0.05, 0.5, 0.95};
constexpr double kEvenWidth = 1.5;     // gaps within this ratio count as one width
constexpr int kMostCuts = 14;          // of one segment, one after the other
constexpr double kShortPiece = 0.005;  // of the diagonal: no shorter ones are cut, which bounds their number
constexpr double kClosed = 1e-12;      // rays that meet where two segments do pass neither

double cross_z(Point a, Point b) { return a.x * b.y - a.y * b.x; }

Point nearest_on_segment(Point p, Point a, Point b) {
  const Point along = b - a;
  return a + std::clamp(dot(p - a, along) / squared_length(along), 0.0, 1.0) * along;
}

struct Opposite {
  double distance = kInfinity;
  Point at;
};

class PlaneGapFinder {
 public:
  PlaneGapFinder(const PlaneLines& lines, const GapSizes& wish)
      : lines_(lines),
        wish_(wish),
        hmin_(wish.hmin > 0 ? wish.hmin : kUsualShare * lines.diagonal()),
        largest_(std::min(wish.hmax * wish.cells, lines.diagonal())),
        shortest_(kShortPiece * lines.diagonal()),
        cos_facing_(std::cos(wish.facing_deg * kPi / 180)) {
    std::vector<Box> boxes(lines.segments.size());
    for (std::uint32_t s = 0; s < boxes.size(); ++s) {
      boxes[s].add(lines.start(s));
      boxes[s].add(lines.end(s));
      boxes[s].low.z -= lines.diagonal();  // rays in the plane meet them safely
      boxes[s].high.z += lines.diagonal();
    }
    tree_ = Bvh(boxes);
  }

  GeometrySources look(std::uint32_t segment) const {
    GeometrySources found;
    for (const double side : {-1.0, 1.0}) look(segment, side, {lines_.start(segment), lines_.end(segment)}, 0, found);
    return found;
  }

 private:
  struct Hit {
    std::uint32_t segment = 0;
    double distance = kInfinity;
  };

  Hit first_on_ray(std::uint32_t own, Point from, Point direction, double largest) const {
    Hit hit;
    tree_.for_each_on_ray(from, direction, largest, [&](std::uint32_t s) {
      if (s == own) return;
      const Point a = lines_.start(s), along = lines_.end(s) - a;
      const double square = cross_z(direction, along);
      if (!(std::abs(square) > 0)) return;
      const double at = cross_z(a - from, direction) / square, far = cross_z(a - from, along) / square;
      if (at < -kClosed || at > 1 + kClosed || far < 0 || far > largest) return;
      if (far < hit.distance || (far == hit.distance && s < hit.segment)) hit = {s, far};
    });
    return hit;
  }

  Opposite from_place(std::uint32_t own, double side, Point from) const {
    const Point along = (lines_.end(own) - lines_.start(own)) / lines_.segments[own].length;
    const Point ahead = side * Point{-along.y, along.x, 0};
    Opposite best;
    for (const double tilt : kTilts) {
      const Point direction = std::cos(tilt) * ahead + std::sin(tilt) * along;
      const Hit hit = first_on_ray(own, from, direction, std::min(largest_, 2 * best.distance));
      if (std::isinf(hit.distance) || lines_.share_an_end(own, hit.segment)) continue;
      const Point a = lines_.start(hit.segment), b = lines_.end(hit.segment);
      const double facing = std::abs(dot(along, b - a)) / lines_.segments[hit.segment].length;
      if (facing < cos_facing_) continue;
      const Point nearest = nearest_on_segment(from, a, b);
      // where its nearest point lies behind us or to the side, the place met stands for it
      const bool is_ahead = dot(nearest - from, ahead) >= cos_facing_ * distance(nearest, from);
      const Point to = is_ahead ? nearest : from + hit.distance * direction;
      const double width = distance(from, to);
      if (!(width > 0 && width < best.distance)) continue;
      if (!wish_.is_kept || wish_.is_kept(0.5 * (from + to))) best = {width, to};
    }
    return best;
  }

  void look(std::uint32_t segment, double side, const std::array<Point, 2>& p, int cuts, GeometrySources& found) const {
    std::array<Point, kPlaces.size()> places;
    std::array<Opposite, kPlaces.size()> seen;
    std::size_t nearest = 0;
    double most = 0;
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
      places[i] = p[0] + kPlaces[i] * (p[1] - p[0]);
      seen[i] = from_place(segment, side, places[i]);
      if (seen[i].distance < seen[nearest].distance) nearest = i;
      most = std::max(most, seen[i].distance);
    }
    const double least = seen[nearest].distance, length = distance(p[0], p[1]);
    if (!(least < largest_)) return;
    const bool is_even = most <= kEvenWidth * least || most <= hmin_ * wish_.cells;
    if (!is_even && cuts < kMostCuts && length > std::max({least, hmin_ * wish_.cells, shortest_})) {
      const Point cut = 0.5 * (p[0] + p[1]);
      look(segment, side, {p[0], cut}, cuts + 1, found);
      look(segment, side, {cut, p[1]}, cuts + 1, found);
      return;
    }
    const auto add = [&](const Simplex& shape) { add_source(found, shape, least / wish_.cells, hmin_, "gap"); };
    add(simplex(p[0], p[1]));
    if (!is_even || length <= least) return add(simplex(places[nearest], seen[nearest].at));
    // a long piece: the strip up to the other side, so that its middle is as fine as its walls
    for (std::size_t i = 0; i + 1 < kPlaces.size(); ++i) {
      add(simplex({places[i], places[i + 1], seen[i].at}));
      add(simplex({places[i + 1], seen[i].at, seen[i + 1].at}));
    }
  }

  const PlaneLines& lines_;
  const GapSizes& wish_;
  Bvh tree_;
  double hmin_, largest_, shortest_, cos_facing_;
};

}  // namespace

GeometrySources find_plane_gap_sizes(const Model& model, const GapSizes& wish, Context& context) {
  const PlaneLines lines(model);
  const PlaneGapFinder finder(lines, wish);
  constexpr std::size_t kGrain = 64;
  const std::size_t n = lines.segments.size(), num_blocks = (n + kGrain - 1) / kGrain;
  std::vector<GeometrySources> blocks(num_blocks);
  parallel_for(context.threads, num_blocks, [&](std::size_t block) {
    context.check_limits();
    for (std::size_t s = block * kGrain; s < std::min(n, (block + 1) * kGrain); ++s)
      blocks[block].append(finder.look(static_cast<std::uint32_t>(s)));
  });
  GeometrySources found;
  for (GeometrySources& block : blocks) found.append(std::move(block));
  return found;
}

}  // namespace delfront
