// SPDX-License-Identifier: Apache-2.0
// Lines that come close across a face. The border of a face is a set of short segments, each with the direction into
// the face beside it. From a place on the border the nearest segment counts that lies ahead, within 60 degrees of that
// direction, and from which the place lies ahead in the same way; its true edge is then searched from there. A part of
// an edge that sees gaps of about one width becomes a source; others are halved, until they are no longer than the gap.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.hpp"
#include "brep_sizes/size_parts.hpp"
#include "sizing/geometry_facets.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

constexpr double kLongest = 0.05;   ///< of the extent: parts of edges
constexpr double kMostTurn = 0.97;  ///< cosine between directions at the ends of a part
constexpr int kLeastParts = 4;
constexpr int kMostHalvings = 10;    ///< of a part, to follow the edge
constexpr int kMostLooks = 12;       ///< halvings of a part, to follow the gap
constexpr double kAhead = 0.5;       ///< cosine to the direction into the face
constexpr double kSamePlace = 1e-9;  ///< of the extent
constexpr std::array<double, 3> kPlaces{0.05, 0.5, 0.95};

/// A place on the border of a face, the way into the face, and where it is on its edge.
struct Place {
  Point at, inward;
};

struct Part {
  const BrepUse* use = nullptr;
  double from = 0, to = 0;
  Place first, last;
};

struct Seen {
  double distance = std::numeric_limits<double>::infinity();
  bool is_wedge = false;
};

class FaceLines {
 public:
  FaceLines(const Brep& brep, const BrepFace& face, double extent, const BrepSizes& wish)
      : brep_(brep),
        face_(face),
        longest_(kLongest * extent),
        same_place_(kSamePlace * extent),
        hmin_(wish.line_hmin > 0 ? wish.line_hmin : wish.hmin),
        cells_(wish.line_cells),
        largest_(wish.hmax * wish.line_cells) {
    for (const auto& loop : face.loops)
      for (const BrepUse& use : loop) {
        const BrepEdge& edge = brep.edges[use.edge];
        if (edge.is_degenerate()) continue;
        const double step = (edge.range[1] - edge.range[0]) / kLeastParts;
        for (int i = 0; i < kLeastParts; ++i)
          cut(use, edge.range[0] + i * step, i + 1 < kLeastParts ? edge.range[0] + (i + 1) * step : edge.range[1], 0);
      }
    std::vector<Box> boxes(parts_.size());
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      boxes[i].add(parts_[i].first.at);
      boxes[i].add(parts_[i].last.at);
    }
    tree_ = Bvh(boxes);
  }

  GeometrySources run() const {
    GeometrySources found;
    for (const Part& part : parts_) look(*part.use, part.from, part.to, 0, found);
    return found;
  }

 private:
  /// Left of the way that the loop goes, in the surface.
  Place place(const BrepUse& use, double t) const {
    const CurveDerivatives c = brep_.edges[use.edge].curve->derivatives(t);
    const Point ahead = use.is_reversed ? -1.0 * c.first : c.first;
    const Point inward = cross(face_.surface->normal(use.curve->at(t)), ahead);
    const double size = length(inward);
    return {c.at, size > 0 ? inward / size : Point{}};
  }

  void cut(const BrepUse& use, double from, double to, int halvings) {
    const Place a = place(use, from), b = place(use, to), m = place(use, 0.5 * (from + to));
    const double side = distance(a.at, m.at) + distance(m.at, b.at);
    const auto turns = [](Point p, Point q) { return dot(p, q) < kMostTurn; };
    const bool is_bent = turns(a.inward, m.inward) || turns(m.inward, b.inward) || distance(a.at, b.at) < 0.98 * side;
    if ((side > longest_ || is_bent) && halvings < kMostHalvings) {
      cut(use, from, 0.5 * (from + to), halvings + 1);
      cut(use, 0.5 * (from + to), to, halvings + 1);
      return;
    }
    parts_.push_back({&use, from, to, a, b});
  }

  /// How far a place is from a corner that the edges of both uses end in; infinite where there is none.
  double from_common_corner(const BrepUse& a, const BrepUse& b, Point at) const {
    double least = std::numeric_limits<double>::infinity();
    if (a.edge == b.edge) return least;
    for (const CornerId c : brep_.edges[a.edge].corners)
      for (const CornerId d : brep_.edges[b.edge].corners)
        if (c.is_valid() && c == d) least = std::min(least, distance(at, brep_.corners[c].at));
    return least;
  }

  static double share_along(Point p, const Part& part) {
    const Point along = part.last.at - part.first.at;
    const double square = squared_length(along);
    return square > 0 ? std::clamp(dot(p - part.first.at, along) / square, 0.0, 1.0) : 0.0;
  }

  Seen from_place(const BrepUse& use, double t) const {
    const Place p = place(use, t);
    const Bvh::Nearest nearest = tree_.nearest(
        p.at,
        [&](std::uint32_t i) {
          constexpr double kNo = std::numeric_limits<double>::infinity();
          const Part& part = parts_[i];
          const double f = share_along(p.at, part);
          const Point to = (1 - f) * part.first.at + f * part.last.at - p.at;
          const double d = length(to);
          const Point back = (1 - f) * part.first.inward + f * part.last.inward;
          if (!(d > same_place_) || dot(to, p.inward) < kAhead * d || -dot(to, back) < kAhead * d) return kNo;
          if (d > kWedge * from_common_corner(use, *part.use, p.at)) return kNo;
          return d * d;
        },
        largest_ * largest_);
    if (!nearest.found()) return {};
    const Part& part = parts_[nearest.item];
    return {refined(p.at, part), std::isfinite(from_common_corner(use, *part.use, p.at))};
  }

  /// Distance from the true edge, by Newton's method within the part.
  double refined(Point p, const Part& part) const {
    const SmoothCurve& curve = *brep_.edges[part.use->edge].curve;
    double t = part.from + share_along(p, part) * (part.to - part.from);
    double best = std::numeric_limits<double>::infinity();
    for (int step = 0; step < 6; ++step) {
      const CurveDerivatives c = curve.derivatives(t);
      const Point away = c.at - p;
      best = std::min(best, length(away));
      const double slope = dot(away, c.first), bend = dot(c.first, c.first) + dot(away, c.second);
      if (!(bend > 0)) break;
      t = std::clamp(t - slope / bend, std::min(part.from, part.to), std::max(part.from, part.to));
    }
    return best;
  }

  void look(const BrepUse& use, double from, double to, int cuts, GeometrySources& found) const {
    Seen nearest;
    double most = 0;
    for (const double f : kPlaces) {
      const Seen seen = from_place(use, (1 - f) * from + f * to);
      most = std::max(most, seen.distance);
      if (seen.distance < nearest.distance) nearest = seen;
    }
    if (!(nearest.distance < largest_)) return;
    const double floor = nearest.is_wedge ? kWedgeFloor * hmin_ : hmin_;
    const SmoothCurve& curve = *brep_.edges[use.edge].curve;
    const Point a = curve.at(from), b = curve.at(to);
    const bool is_even = most <= std::max(kEvenGaps * nearest.distance, floor * cells_);
    if (!is_even && cuts < kMostLooks && distance(a, b) > std::max(nearest.distance, floor * cells_)) {
      look(use, from, 0.5 * (from + to), cuts + 1, found);
      look(use, 0.5 * (from + to), to, cuts + 1, found);
      return;
    }
    add_source(found, simplex(a, b), nearest.distance / cells_, floor, "proximity");
  }

  const Brep& brep_;
  const BrepFace& face_;
  double longest_, same_place_, hmin_, cells_, largest_;
  std::vector<Part> parts_;
  Bvh tree_;
};

}  // namespace

GeometrySources find_lines(const Brep& brep, double extent, const BrepSizes& wish, Context& context) {
  std::vector<GeometrySources> of_face(brep.faces.size());
  parallel_for(context.threads, of_face.size(), [&](std::size_t f) {
    context.check_limits();
    of_face[f] = FaceLines(brep, brep.faces[FaceId(f)], extent, wish).run();
  });
  GeometrySources found;
  for (GeometrySources& part : of_face) found.append(std::move(part));
  return found;
}

}  // namespace delfront
