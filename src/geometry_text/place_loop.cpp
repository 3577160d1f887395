// SPDX-License-Identifier: Apache-2.0
#include "geometry_text/place_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delfront/brep_shapes.hpp"
#include "delfront/errors.hpp"
#include "geometry_text/projection.hpp"

namespace delfront {
namespace {

constexpr double kSame = 1e-6;  ///< of the loop's extent in the parameter plane, or of a period
constexpr int kSamples = 16;
constexpr int kOutline = 64;  ///< places along each edge, to tell what is inside a loop

/// Which side of the box is a pole, seen from a place on it: how the anticlockwise way along it runs.
struct PoleSide {
  bool is_pole = false;
  bool along_u = true;
  double way = 1;  ///< +1: the parameter rises on the way
};

class LoopPlacer {
 public:
  LoopPlacer(Brep& brep, const SmoothSurface& surface, std::vector<LoosePart> parts)
      : brep_(brep), surface_(surface), parts_(std::move(parts)) {}

  std::vector<BrepUse> run(bool is_hole) {
    const std::size_t edges = brep_.edges.size();
    const double wanted = is_hole ? -1 : 1;
    for (int turned = 0; turned < 2; ++turned) {
      std::string why = place();
      if (why.empty() && wanted * area() > 0) return std::move(made_);
      if (turned == 1) {
        if (why.empty()) why = "the loop encloses nothing in the parameter plane";
        throw InputError(first_.empty() ? why : first_, {{at_, {}}});
      }
      first_ = why;
      while (brep_.edges.size() > edges) brep_.edges.pop_back();
      std::reverse(parts_.begin(), parts_.end());
      for (LoosePart& part : parts_) part.use.is_reversed = !part.use.is_reversed;
    }
    return {};
  }

 private:
  Point2 end_of(const BrepUse& use, bool is_first) const {
    return use.curve->at(brep_.edges[use.edge].range[is_first == use.is_reversed ? 1 : 0]);
  }

  PoleSide pole_at(Point2 uv) const {
    const ParameterBox box = surface_.box();
    const DegenerateSides sides = surface_.degenerate_sides();
    const auto near = [](double value, double side, double end) {
      return std::isfinite(side) && std::abs(value - side) <= kSame * (std::isfinite(end) ? std::abs(end - side) : 1);
    };
    if (sides.v_low && near(uv.y, box.low.y, box.high.y)) return {true, true, 1};
    if (sides.v_high && near(uv.y, box.high.y, box.low.y)) return {true, true, -1};
    if (sides.u_low && near(uv.x, box.low.x, box.high.x)) return {true, false, -1};
    if (sides.u_high && near(uv.x, box.high.x, box.low.x)) return {true, false, 1};
    return {};
  }

  /// Along a pole from one parameter on the way to the next like `to`, a whole period where they are the same.
  static double pole_step(double from, double to, double way, double period, bool is_back) {
    if (period == 0) return to - from;
    double step = way * std::fmod(way * (to - from), period);
    if (way * step < 0) step += way * period;
    const bool is_same = std::abs(step) < kSame * period || std::abs(step) > (1 - kSame) * period;
    return is_same ? (is_back ? way * period : 0) : step;
  }

  void add_pole(Point2 from, Point2 to, CornerId corner) {
    BrepEdge edge;
    edge.corners = {corner, corner};
    brep_.edges.push_back(edge);
    made_.push_back({EdgeId(brep_.edges.size() - 1), make_parameter_line(from, to), false});
  }

  CornerId corner_of(const BrepUse& use, bool is_first) const {
    return brep_.edges[use.edge].corners[is_first == use.is_reversed ? 1 : 0];
  }

  /// How far the next curve is to be moved so that it follows a place; poles are filled in.
  Point2 follow(Point2 from, const LoosePart& last, const LoosePart& next, Point2 begin) {
    const auto [period_u, period_v] = surface_.period();
    const PoleSide side = pole_at(from);
    if (side.is_pole && corner_of(next.use, true).is_valid()) {
      const bool is_back = last.use.edge == next.use.edge && last.use.is_reversed != next.use.is_reversed;
      const double step = side.along_u ? pole_step(from.x, begin.x, side.way, period_u, is_back)
                                       : pole_step(from.y, begin.y, side.way, period_v, is_back);
      const Point2 to = side.along_u ? Point2{from.x + step, begin.y} : Point2{begin.x, from.y + step};
      if (step != 0) add_pole(from, to, corner_of(next.use, true));
      return {to.x - begin.x, to.y - begin.y};
    }
    Point2 by = {0, 0};
    if (period_u > 0) by.x = period_u * std::round((from.x - begin.x) / period_u);
    if (period_v > 0) by.y = period_v * std::round((from.y - begin.y) / period_v);
    return by;
  }

  /// @return what is wrong, or nothing
  std::string place() {
    made_.clear();
    extent_ = Box();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const LoosePart& part = parts_[i];
      Point2 by = {0, 0};
      if (i > 0) by = follow(end_of(made_.back(), false), parts_[i - 1], part, end_of(part.use, true));
      made_.push_back(part.use);
      made_.back().curve = move_parameter_curve(part.use.curve, by);
      const auto& range = brep_.edges[part.use.edge].range;
      for (int k = 0; k <= kSamples; ++k) {
        const Point2 p = made_.back().curve->at(range[0] + (range[1] - range[0]) * k / kSamples);
        extent_.add(Point{p.x, p.y, 0});
      }
    }
    const Point2 begin = end_of(made_.front(), true), end = end_of(made_.back(), false);
    const Point2 by = follow(end, parts_.back(), parts_.front(), begin);
    const double period_u = surface_.period()[0], period_v = surface_.period()[1];
    const Point from = surface_.at(end), to = surface_.at(begin);
    const bool meets = distance(from, to) <= kSame * (length(from) + length(to));
    if (meets &&
        ((period_u > 0 && std::abs(by.x) > kSame * period_u) || (period_v > 0 && std::abs(by.y) > kSame * period_v))) {
      at_ = from;
      return "the loop runs once round the surface and does not come back; add a seam, an edge that is used twice: "
             "[\"low\", \"seam\", \"-high\", \"-seam\"]";
    }
    return find_gap();
  }

  std::string find_gap() {
    const Point size = extent_.high - extent_.low;
    for (std::size_t i = 0; i < made_.size(); ++i) {
      const Point2 a = end_of(made_[i], false), b = end_of(made_[(i + 1) % made_.size()], true);
      if (std::abs(a.x - b.x) <= kSame * size.x && std::abs(a.y - b.y) <= kSame * size.y) continue;
      at_ = surface_.at(a);
      const Point there = surface_.at(b);
      return fmt::format(
          "the loop is open: an edge ends at ({:g}, {:g}, {:g}), the next begins at ({:g}, {:g}, {:g}); give its edges "
          "one after the other, with a minus those that run backwards",
          at_.x, at_.y, at_.z, there.x, there.y, there.z);
    }
    return "";
  }

  double area() const {
    double sum = 0;
    Point2 last = end_of(made_.back(), false);
    const Point2 start = last;
    for (const BrepUse& use : made_) {
      const auto& range = brep_.edges[use.edge].range;
      for (int k = 0; k <= kSamples; ++k) {
        const double f = double(use.is_reversed ? kSamples - k : k) / kSamples;
        const Point2 p = use.curve->at(range[0] + (range[1] - range[0]) * f);
        sum += (last.x - start.x) * (p.y - start.y) - (p.x - start.x) * (last.y - start.y);
        last = p;
      }
    }
    return 0.5 * sum;
  }

  Brep& brep_;
  const SmoothSurface& surface_;
  std::vector<LoosePart> parts_;
  std::vector<BrepUse> made_;
  Box extent_;
  std::string first_;
  Point at_;
};

/// Places along a loop, in its order.
std::vector<Point2> outline(const Brep& brep, const std::vector<BrepUse>& loop) {
  std::vector<Point2> places;
  for (const BrepUse& use : loop) {
    const auto& range = brep.edges[use.edge].range;
    for (int k = 0; k < kOutline; ++k) {
      const double f = double(use.is_reversed ? kOutline - k : k) / kOutline;
      places.push_back(use.curve->at(range[0] + (range[1] - range[0]) * f));
    }
  }
  return places;
}

/// Whether the line to the right of a place crosses the polygon an odd number of times.
bool is_inside(const std::vector<Point2>& polygon, Point2 p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point2 a = polygon[i], b = polygon[j];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

/// Whole periods from which a middle comes to lie between low and high; 0 alone where there is no period.
std::vector<double> moves_into(double low, double high, double middle, double period) {
  std::vector<double> moves = {0};
  if (period > 0)
    for (double k = std::ceil((low - middle) / period); k <= std::floor((high - middle) / period); ++k)
      if (k != 0) moves.push_back(k * period);
  return moves;
}

Box box_of(const std::vector<Point2>& places) {
  Box box;
  for (const Point2 p : places) box.add(Point{p.x, p.y, 0});
  return box;
}

}  // namespace

void move_hole_into(const Brep& brep, const SmoothSurface& surface, const std::vector<BrepUse>& outer,
                    std::vector<BrepUse>& hole) {
  const std::vector<Point2> polygon = outline(brep, outer), places = outline(brep, hole);
  const Box around = box_of(polygon);
  const Point middle = box_of(places).centre();
  Point2 best;
  std::size_t most = 0;
  for (const double u : moves_into(around.low.x, around.high.x, middle.x, surface.period()[0]))
    for (const double v : moves_into(around.low.y, around.high.y, middle.y, surface.period()[1])) {
      std::size_t inside = 0;
      for (const Point2 p : places) inside += is_inside(polygon, {p.x + u, p.y + v});
      if (inside <= most) continue;
      most = inside;
      best = {u, v};
    }
  if (best.x == 0 && best.y == 0) return;
  for (BrepUse& use : hole) use.curve = move_parameter_curve(use.curve, best);
}

std::vector<BrepUse> place_loop(Brep& brep, const SmoothSurface& surface, std::vector<LoosePart> parts, bool is_hole) {
  return LoopPlacer(brep, surface, std::move(parts)).run(is_hole);
}

}  // namespace delfront
