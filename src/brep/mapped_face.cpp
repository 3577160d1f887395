// SPDX-License-Identifier: Apache-2.0
// A face in its parameter plane: parts with a chart each, the planar front with the metric of the chart, then flips and
// moves by what triangles are in space.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <unordered_map>

#include "brep/chart_mesh.hpp"
#include "brep/face_parts.hpp"
#include "brep/step_metric.hpp"
#include "delfront/errors.hpp"
#include "planar/front.hpp"
#include "planar/kernel.hpp"
#include "predicates/predicates.hpp"

namespace delfront {
namespace {

constexpr double kLeastRatio = 1e-16;   ///< between squared lengths along the axes of a chart
constexpr double kMostSkew = 1 - 1e-9;  ///< cosine between what the axes are in space
constexpr double kMostStretch = 25;     ///< of lengths over directions, in a chart that is used
constexpr double kMostChange = 3;       ///< of lengths in space over one wanted side, in a chart that is used
constexpr double kStepChange = 1.5;     ///< the same, from where the metric is that of whole sides
constexpr double kTryPolar = 2.5;       ///< stretch of a linear chart from where a polar one is tried
constexpr double kEven = 1.02;          ///< of stretch, and of lengths anywhere over those elsewhere
constexpr int kSamples = 17;            ///< each way, to look at a chart
constexpr std::size_t kMostOfLoop = 200;
constexpr double kSamePlace = 1e-9;  ///< of the extent: copies of a seam's points in a polar chart
constexpr int kPoleDirections = 8;

constexpr int kMetricBits = 14;     ///< of metrics, and ...
constexpr double kSteps = 1 << 28;  ///< ... steps a unit of a chart's border: see rounded()

/// Turned and scaled copies of a model differ in their last bits. Where numbers tie, as they do all over shapes with
/// symmetry, that would give each another grid: so the front sees numbers without those bits.
double rounded(double value, double unit) {
  if (!(unit > 0) || !std::isfinite(unit)) return value;
  const double step = std::ldexp(1.0, std::ilogb(unit) - kMetricBits);
  return step * std::round(value / step);
}
Point2 rounded(Point2 xy) { return {std::round(xy.x * kSteps) / kSteps, std::round(xy.y * kSteps) / kSteps}; }

/// What a chart asks of lengths in it: M = J^T J / h^2.
class ChartMetric : public SizeField {
 public:
  ChartMetric(const Chart& chart, const WantedSize& size, bool is_lowered, double at_origin)
      : chart_(chart), size_(size), is_lowered_(is_lowered), origin_(at_origin) {}

  void metrics(std::span<const Point> at, std::span<Metric> metric) const override {
    std::vector<Chart::Place> place(at.size());
    std::vector<Point> in_space(at.size());
    std::vector<double> h(at.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      place[i] = chart_.place({at[i].x, at[i].y});
      in_space[i] = place[i].at;
    }
    size_.asked().sizes(in_space, h);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const bool is_pole = chart_.is_polar() && at[i].x * at[i].x + at[i].y * at[i].y < origin_ * origin_;
      metric[i] = is_pole ? metric_at_pole(h[i]) : metric_of(place[i], h[i]);
    }
  }
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    std::vector<Metric> metric(at.size());
    metrics(at, metric);
    for (std::size_t i = 0; i < at.size(); ++i)
      size[i] = 1 / std::sqrt(std::max(metric[i].xx + metric[i].yy, 1e-300));  // a bound is enough
  }
  bool is_isotropic() const override { return false; }
  double lower_bound(const Box&) const override { return 1e-300; }

 private:
  Metric metric_of(const Chart::Place& place, double h) const {
    if (is_lowered_) h = size_.lowered(h, largest_curvature(chart_.surface().derivatives(place.uv)), place.at);
    const double f = 1 / (h * h);
    const double xx = f * dot(place.x, place.x), yy = f * dot(place.y, place.y);
    Metric m;
    m.xx = rounded(xx, xx);
    m.xy = rounded(f * dot(place.x, place.y), std::sqrt(xx * yy));
    m.yy = rounded(yy, yy);
    // Where the mapping is all but singular a front needs a metric all the same.
    const double least = kLeastRatio * std::max(m.xx, m.yy);
    m.xx = std::max(m.xx, least);
    m.yy = std::max(m.yy, least);
    const double most = kMostSkew * std::sqrt(m.xx * m.yy);
    m.xy = std::clamp(m.xy, -most, most);
    return m;
  }
  /// It has no direction there.
  Metric metric_at_pole(double h) const {
    double sum = 0;
    for (int k = 0; k < kPoleDirections; ++k) {
      const double angle = k * 2 * std::numbers::pi / kPoleDirections;
      const Metric m = metric_of(chart_.place({2 * origin_ * std::cos(angle), 2 * origin_ * std::sin(angle)}), h);
      sum += 0.5 * (m.xx + m.yy) / kPoleDirections;
    }
    Metric m;
    m.xx = m.yy = rounded(sum, sum);
    return m;
  }

  const Chart& chart_;
  const WantedSize& size_;
  bool is_lowered_;
  double origin_;
};

/// How far a chart is from lengths in space, over its part.
struct ChartLook {
  double stretch = 1;
  double change = 1;
  Point at;
};

/// What is looked at: places all over the box, and on the border, where poles of the surface are not told by a
/// degenerate side.
std::vector<Point2> places_to_look_at(const FaceGrid& grid, const FacePart& part, const ParameterBox& box) {
  std::vector<Point2> places;
  const double margin = 0.5 / kSamples;
  for (int i = 0; i < kSamples; ++i)
    for (int j = 0; j < kSamples; ++j) {
      const double f = margin + double(i) / kSamples, g = margin + double(j) / kSamples;
      places.push_back({(1 - f) * box.low.x + f * box.high.x, (1 - g) * box.low.y + g * box.high.y});
    }
  for (const auto& loop : part.loops)
    for (std::size_t i = 0; i < loop.size(); i += loop.size() / kMostOfLoop + 1)
      if (!grid.points[loop[i]].is_pole) places.push_back(grid.points[loop[i]].uv);
  return places;
}

ChartLook look_at(const Chart& chart, std::span<const Point2> places, const ParameterBox& box, const WantedSize& size) {
  ChartLook look;
  const auto scale = [](const Chart::Place& p) { return std::sqrt(length(cross(p.x, p.y))); };
  std::vector<Chart::Place> found;
  std::vector<Point> at;
  double least = 1e300, most = 0;
  for (const Point2 uv : places) {
    found.push_back(chart.place(chart.to_chart(uv)));
    at.push_back(found.back().at);
    least = std::min(least, scale(found.back()));
    most = std::max(most, scale(found.back()));
    const double stretch = Chart::stretch(found.back());
    if (!(stretch > look.stretch)) continue;
    look.stretch = stretch;
    look.at = found.back().at;
  }
  if (look.stretch < kEven && most < kEven * least) return look;  // a plane, a cylinder: nothing changes
  std::vector<double> asked(at.size());
  size.asked().sizes(at, asked);  // together: neighbours in the list are near in space
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Chart::Place& place = found[i];
    const Point2 xy = chart.to_chart(places[i]);
    // one wanted side on, but no farther than the part goes
    const double bend = largest_curvature(chart.surface().derivatives(place.uv));
    const double here = scale(place), h = size.lowered(asked[i], bend, place.at);
    for (int k = 0; k < 4; ++k) {
      const double ahead = (k % 2 ? -1 : 1) * h / std::max(length(k < 2 ? place.x : place.y), 1e-300);
      const Point2 to = chart.to_uv(k < 2 ? Point2{xy.x + ahead, xy.y} : Point2{xy.x, xy.y + ahead});
      const bool is_within = to.x >= box.low.x && to.x <= box.high.x && to.y >= box.low.y && to.y <= box.high.y;
      if (!is_within) continue;  // far beyond it need be no number
      const double there = scale(chart.place(chart.to_chart(to)));
      const double change = std::max(here / there, there / here);
      if (!(change > look.change)) continue;
      look.change = change;
      if (change > kMostChange) look.at = place.at;
    }
  }
  return look;
}

/// Linear, or polar round the part's pole, or round one that it has no part in where that is better (and was not cut
/// off, since a chart round it would span too much).
/// @param change  set to that of lengths over one wanted side
std::optional<Chart> choose_chart(const SmoothSurface& surface, const FacePart& part, const ParameterBox& box,
                                  const WantedSize& size, ChartWay way, FaceGrid& grid, double& change) {
  std::optional<Chart> best;
  best.emplace(surface, box, part.pole);
  const std::vector<Point2> places = places_to_look_at(grid, part, box);
  ChartLook look = look_at(*best, places, box, size);
  if (part.pole == Chart::Pole::none && way != ChartWay::cut_off &&
      (look.stretch > kTryPolar || look.change > kMostChange)) {
    const DegenerateSides at = surface.degenerate_sides();
    const std::pair<bool, Chart::Pole> sides[] = {{at.u_low, Chart::Pole::u_low},
                                                  {at.u_high, Chart::Pole::u_high},
                                                  {at.v_low, Chart::Pole::v_low},
                                                  {at.v_high, Chart::Pole::v_high}};
    for (const auto& [is_there, pole] : sides) {
      if (!is_there) continue;
      const Chart polar(surface, box, pole);
      const ChartLook other = look_at(polar, places, box, size);
      if (!(other.stretch < look.stretch)) continue;
      look = other;
      best.emplace(surface, box, pole);
    }
  }
  change = look.change;
  if (way != ChartWay::even) return best;
  if (look.stretch > kMostStretch)
    grid.fail(fmt::format("the mapping stretches lengths by {:.3g} in one direction over another", look.stretch),
              look.at);
  else if (look.change > kMostChange)
    grid.fail(fmt::format("lengths in the mapping change by {:.3g} over one side", look.change), look.at);
  if (!grid.gave_up.empty()) return std::nullopt;
  return best;
}

/// On the plane of the border's area.
std::optional<Chart> flat_chart(const SmoothSurface& surface, const FacePart& part, const ParameterBox& box,
                                FaceGrid& grid) {
  Point area;
  const Point first = grid.points[part.loops[0][0]].at;
  for (const auto& loop : part.loops)
    for (std::size_t i = 0; i < loop.size(); ++i)
      area = area + cross(grid.points[loop[i]].at - first, grid.points[loop[(i + 1) % loop.size()]].at - first);
  if (length(area) > 0) {
    const auto plane = std::make_shared<const PlaneMap>(surface, box, area / length(area));
    if (plane->is_flat()) {
      grid.up = area / length(area);
      return Chart(surface, plane);
    }
  }
  grid.fail("it is not flat", first);
  return std::nullopt;
}

/// A part in its chart, before and after the front.
class ChartedPart {
 public:
  ChartedPart(const FacePart& part, const Chart& chart, FaceGrid& grid) : chart_(chart), grid_(grid) {
    domain_.curves.push_back({});
    for (const auto& loop : part.loops)
      for (std::size_t i = 0; i < loop.size(); ++i)
        add_segment(chart_point(loop[i]), chart_point(loop[(i + 1) % loop.size()]));
  }

  /// @param by_steps  the metric is that of whole sides
  void fill(const WantedSize& size, bool is_lowered, bool by_steps, const ParameterBox& box, const BrepOptions& options,
            Context& context) {
    if (!has_area()) return grid_.fail("its border is a line in the parameter plane", grid_.points[origin_[0]].at);
    PlanarGrid plane;
    plane.complex.point.assign(domain_.points.begin(), domain_.points.end());
    PlanarKernel kernel(plane.complex);
    Context quiet = context.for_a_piece();
    quiet.threads = 1;
    if (!build_delaunay(plane.complex, kernel, quiet).empty())
      return grid_.fail("points of its border meet in the parameter plane", grid_.points[origin_[0]].at);
    std::vector<VertexIndex> same_as(domain_.points.size());
    for (VertexIndex v = 0; v < same_as.size(); ++v) same_as[v] = v;
    try {
      insert_segments(domain_, same_as, plane, quiet);
    } catch (const InputError& e) {
      const Point at =
          e.places.empty() ? Point{domain_.points[VertexId(0)].x, domain_.points[VertexId(0)].y, 0} : e.places[0].at;
      grid_.is_border_wrong = true;
      return grid_.fail(
          "its border crosses itself, or runs over itself: give its edges in order, and loops apart from "
          "each other",
          chart_.place({at.x, at.y}).at);
    }
    colour_regions(domain_, DomainOptions{}, plane);
    Box extent;
    for (const Point2 p : domain_.points) extent.add(Point{p.x, p.y, 0});
    const ChartMetric metric(chart_, size, is_lowered, 1e-7 * extent.diagonal());
    if (by_steps)
      fill_by_front(plane, StepMetric(metric, chart_, box), quiet);
    else
      fill_by_front(plane, metric, quiet);
    plane.complex.index_vertices();
    std::vector<Point> border;
    for (const std::uint32_t p : origin_) border.push_back(grid_.points[p].at);
    ChartMesh mesh(plane.complex, chart_, std::move(border));
    for (VertexIndex v = 0; v < origin_.size(); ++v)
      if (grid_.points[origin_[v]].is_vague) mesh.forget_normal(v);
    mesh.improve(options.smoothing_passes, context);
    take(plane.complex, mesh.at());
  }

 private:
  /// Whether the points are finite, and not all on one line.
  bool has_area() const {
    bool is_flat = true;
    const Point2 a = domain_.points[VertexId(0)], b = domain_.points[VertexId(1)];
    for (const Point2 p : domain_.points) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y)) return false;
      is_flat = is_flat && orient2d(a, b, p) == 0;
    }
    return !is_flat;
  }

  /// Copies of a point that meet are one: those of a seam in a polar chart, those of a slit anywhere; so is a pole.
  VertexIndex chart_point(std::uint32_t p) {
    if (const auto known = number_.find(p); known != number_.end()) return known->second;
    const FacePoint& point = grid_.points[p];
    Point2 xy = rounded(chart_.to_chart(point.uv));
    if (point.is_pole && chart_.is_polar()) xy = {0, 0};
    if (point.vertex != kNoVertex) {
      const auto [first, last] = copies_.equal_range(point.vertex);
      for (auto it = first; it != last; ++it) {
        const Point2 other = domain_.points[VertexId(it->second)];
        const double near = kSamePlace * (std::abs(xy.x) + std::abs(xy.y));
        if (std::abs(other.x - xy.x) > near || std::abs(other.y - xy.y) > near) continue;
        number_.emplace(p, it->second);
        return it->second;
      }
    }
    const auto v = static_cast<VertexIndex>(domain_.points.size());
    domain_.points.push_back(xy);
    origin_.push_back(p);
    number_.emplace(p, v);
    if (point.vertex != kNoVertex) copies_.emplace(point.vertex, v);
    return v;
  }

  /// A seam in a polar chart is run both ways: one segment inside.
  void add_segment(VertexIndex a, VertexIndex b) {
    if (a == b) return;
    const auto [low, high] = std::minmax(a, b);
    if (!segments_.emplace(std::uint64_t(low) << 32 | high, 0).second) return;
    domain_.segments.push_back({VertexId(std::size_t(a)), VertexId(std::size_t(b))});
    domain_.curve_of_segment.push_back(CurveId(std::size_t(0)));
  }

  void take(const TriComplex& c, const std::vector<Point>& at) {
    const auto first = static_cast<std::uint32_t>(grid_.points.size());
    const auto num_border = static_cast<std::uint32_t>(origin_.size());
    for (VertexIndex v = num_border; v < c.point.size(); ++v)
      grid_.points.push_back({at[v], chart_.to_uv(c.point[v]), kNoVertex, false});
    for (TriIndex t = 0; t < c.tri.size(); ++t) {
      if (c.is_dead(t) || c.is_ghost(t) || c.tri[t].region == kOutside) continue;
      std::array<std::uint32_t, 3> corner;
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexIndex v = c.tri[t].node[k];
        corner[k] = v < num_border ? origin_[v] : first + (v - num_border);
      }
      grid_.triangles.push_back(corner);
    }
  }

  const Chart& chart_;
  FaceGrid& grid_;
  PlanarDomain domain_;
  std::vector<std::uint32_t> origin_;  ///< by chart point: the grid's
  std::unordered_map<std::uint32_t, VertexIndex> number_;
  std::unordered_multimap<std::uint32_t, VertexIndex> copies_;
  std::unordered_map<std::uint64_t, int> segments_;
};

}  // namespace

void grid_mapped(const BrepFace& face, const WantedSize& size, const BrepOptions& options, ChartWay way, FaceGrid& grid,
                 Context& context) {
  try {
    for (const FacePart& part : find_parts(face, size, way == ChartWay::cut_off, grid)) {
      const ParameterBox box = box_of(grid, part);
      double change = 1;
      const std::optional<Chart> chart = way == ChartWay::flat
                                             ? flat_chart(*face.surface, part, box, grid)
                                             : choose_chart(*face.surface, part, box, size, way, grid, change);
      if (!chart) return;
      ChartedPart charted(part, *chart, grid);
      const bool by_steps = way == ChartWay::any || way == ChartWay::cut_off || change > kStepChange;
      charted.fill(size, size.is_lowered_on(*face.surface, box), by_steps, box, options, context);
      if (!grid.gave_up.empty()) return;
    }
  } catch (const InputError& e) {
    grid.fail(fmt::format("its border in the parameter plane: {}", e.what()), grid.points[grid.loops[0][0]].at);
  }
  grid.is_mapped = grid.gave_up.empty();
}

}  // namespace delfront
