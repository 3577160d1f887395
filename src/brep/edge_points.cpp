// SPDX-License-Identifier: Apache-2.0
#include "brep/edge_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.hpp"
#include "brep/sharp_corners.hpp"
#include "delfront/errors.hpp"
#include "fmt/format.h"

namespace delfront {
namespace {

constexpr std::size_t kLeastPanels = 16, kMostPanels = std::size_t(1) << 22;
constexpr std::size_t kEnoughPanels = std::size_t(1) << 13;  ///< for densities that jump, and never converge
constexpr double kPanelsPerSide = 8;
constexpr double kConverged = 1e-4;  ///< change of the integral, of itself
constexpr double kMostSides = 1e8;   ///< of an edge
constexpr double kAlmost = 1e-9;     ///< of where one more part is taken, so that equal curves get equal numbers

/// To 24 bits of the range: rounding, which a turned or scaled copy has otherwise, does not change a grid.
double rounded(double t, std::array<double, 2> range) {
  constexpr double kSteps = 1 << 24;
  const double share = std::round((t - range[0]) / (range[1] - range[0]) * kSteps) / kSteps;
  return (1 - share) * range[0] + share * range[1];
}

/// 1/h times the speed at equal steps of t: what adds up to the number of sides. From one number of panels to twice
/// that, every second place is known.
class Density {
 public:
  Density(const SampleCurve& sample, std::array<double, 2> range, const WantedSize& size)
      : sample_(sample), range_(range), size_(size) {}

  const std::vector<double>& at(std::size_t panels) {
    const bool is_next = !value_.empty() && panels == 2 * (value_.size() - 1);
    const std::size_t step = is_next ? 2 : 1;
    std::vector<double> value(panels + 1);
    for (std::size_t i = 0; is_next && i <= panels; i += 2) value[i] = value_[i / 2];
    const bool wants_curvature = is_bent_ || panels <= 2 * kLeastPanels;
    std::vector<CurveSample> samples;
    std::vector<Point> at;
    for (std::size_t i = step - 1; i <= panels; i += step) {
      const double f = double(i) / double(panels);
      samples.push_back(sample_((1 - f) * range_[0] + f * range_[1], wants_curvature));
      at.push_back(samples.back().at);
    }
    std::vector<double> h(at.size());
    size_.asked().sizes(at, h);
    for (std::size_t k = 0; k < h.size(); ++k) {
      is_bent_ = is_bent_ || size_.is_nearly_lowered(h[k], samples[k].curvature);
      value[step - 1 + k * step] = length(samples[k].first) / size_.lowered(h[k], samples[k].curvature, at[k]);
    }
    value_ = std::move(value);
    return value_;
  }

 private:
  const SampleCurve& sample_;
  std::array<double, 2> range_;
  const WantedSize& size_;
  std::vector<double> value_;
  bool is_bent_ = false;  ///< bends may count
};

/// By Simpson's rule, to the middle of each pair of panels by the parabola through its three values.
std::vector<double> integrate(const std::vector<double>& density, double step) {
  std::vector<double> sum(density.size(), 0);
  for (std::size_t i = 0; i + 2 < density.size(); i += 2) {
    const double a = density[i], b = density[i + 1], c = density[i + 2];
    sum[i + 1] = sum[i] + step * (5 * a + 8 * b - c) / 12;
    sum[i + 2] = sum[i] + step * (a + 4 * b + c) / 3;
  }
  return sum;
}

}  // namespace

std::vector<double> divide_curve(const SampleCurve& sample, std::array<double, 2> range, const WantedSize& size,
                                 std::size_t least) {
  Density densities(sample, range, size);
  std::vector<double> density, sum;
  double before = -1;
  for (std::size_t panels = kLeastPanels; panels <= kMostPanels; panels *= 2) {
    density = densities.at(panels);
    sum = integrate(density, (range[1] - range[0]) / double(panels));
    const double now = sum.back();
    const bool is_fine = std::abs(now - before) <= kConverged * now || panels >= kEnoughPanels;
    if (is_fine && double(panels) >= kPanelsPerSide * now) break;
    before = now;
  }
  const double all = sum.back();
  if (!(all < kMostSides))
    throw LimitError(
        fmt::format("stopped before gridding: sizes ask for {:.1e} sides on one edge; ask for larger sizes "
                    "(--hmax, --hmin, --growth)",
                    all));
  // as many as make sides longer or shorter than wanted by the least factor: of at most sqrt(2), but of one short side
  const double fewer = std::floor(all);
  const bool takes_more = all * all * (1 + kAlmost) >= fewer * (fewer + 1);
  const auto parts = std::max(least, std::size_t(fewer) + (takes_more ? 1 : 0));
  const double step = (range[1] - range[0]) / double(sum.size() - 1);
  std::vector<double> t = {range[0]};
  std::size_t i = 0;
  for (std::size_t k = 1; k < parts; ++k) {
    const double wanted = all * double(k) / double(parts);
    while (i + 2 < sum.size() && sum[i + 1] <= wanted) ++i;
    // within a panel the density goes evenly from one value to the other, up to a factor
    const double a = density[i], b = density[i + 1], f = (wanted - sum[i]) / (sum[i + 1] - sum[i]) * 0.5 * (a + b);
    const double root = std::sqrt(std::max(a * a + 2 * (b - a) * f, 0.0));
    const double next = range[0] + step * (double(i) + 2 * f / (a + root)), even = rounded(next, range);
    t.push_back(even > t.back() && even < range[1] ? even : next);
  }
  t.push_back(range[1]);
  return t;
}

namespace {

class Divider {
 public:
  Divider(const Brep& brep, const WantedSize& size, const std::set<CornerId>& long_sided)
      : brep_(brep),
        size_(size),
        ranges_(ranges_between_sharp_corners(brep, size, long_sided)),
        uses_(brep.edges.size()) {
    for (const BrepFace& face : brep.faces)
      for (const auto& loop : face.loops)
        for (const BrepUse& use : loop) uses_[use.edge.index()].push_back({face.surface.get(), use.curve.get()});
  }

  void run(Array<EdgeId, EdgePoints>& points, std::size_t& num_vertices, Context& context) {
    std::map<std::array<CornerId, 2>, int> single;  // open edges of one side, by their corners
    std::size_t next = brep_.corners.size();
    parallel_for(context.threads, points.size(), [&](std::size_t e) {
      context.check_limits();
      if (points[EdgeId(e)].t.empty()) points[EdgeId(e)].t = divide(e);
    });
    for (std::size_t e = 0; e < points.size(); ++e) {
      EdgePoints& made = points[EdgeId(e)];
      const BrepEdge& edge = brep_.edges[EdgeId(e)];
      if (!edge.is_degenerate() && made.t.size() == 2) {
        const auto [low, high] = std::minmax(edge.corners[0], edge.corners[1]);
        if (single[{low, high}]++ > 0) made.t.insert(made.t.begin() + 1, 0.5 * (made.t[0] + made.t[1]));
      }
      number(edge, made, next);
    }
    num_vertices = next;
  }

 private:
  struct Beside {
    const SmoothSurface* surface;
    const ParameterCurve* curve;
  };

  std::vector<double> divide(std::size_t e) const {
    const BrepEdge& edge = brep_.edges[EdgeId(e)];
    if (edge.is_degenerate()) return {edge.range[0], edge.range[1]};
    const bool is_closed = edge.corners[0] == edge.corners[1];
    const auto sample = [&](double t, bool wants_curvature) {
      const CurveDerivatives c = edge.curve->derivatives(t);
      if (!wants_curvature) return CurveSample{c.at, c.first, 0};
      const double speed = length(c.first);
      double bend = speed > 0 ? length(cross(c.first, c.second)) / (speed * speed * speed) : 0;
      for (const Beside& beside : uses_[e])
        bend = std::max(bend, largest_curvature(beside.surface->derivatives(beside.curve->at(t))));
      return CurveSample{c.at, c.first, bend};
    };
    const std::array<double, 2>& range = ranges_[EdgeId(e)];
    std::vector<double> t = divide_curve(sample, range, size_, is_closed ? 3 : 1);
    if (range[0] != edge.range[0]) t.insert(t.begin(), edge.range[0]);
    if (range[1] != edge.range[1]) t.push_back(edge.range[1]);
    return t;
  }

  void number(const BrepEdge& edge, EdgePoints& made, std::size_t& next) const {
    made.vertex.clear();
    made.at.clear();
    const bool has_corners = edge.corners[0].is_valid();
    for (std::size_t i = 0; i < made.t.size(); ++i) {
      const bool is_first = i == 0, is_last = i + 1 == made.t.size();
      if (has_corners && (is_first || is_last)) {
        const CornerId corner = edge.corners[is_last];
        made.vertex.push_back(corner.value);
        made.at.push_back(brep_.corners[corner].at);
      } else if (is_last) {
        made.vertex.push_back(made.vertex[0]);
        made.at.push_back(made.at[0]);
      } else {
        made.vertex.push_back(static_cast<std::uint32_t>(next++));
        made.at.push_back(edge.curve->at(made.t[i]));
      }
    }
  }

  const Brep& brep_;
  const WantedSize& size_;
  Array<EdgeId, std::array<double, 2>> ranges_;  ///< that sizes divide
  std::vector<std::vector<Beside>> uses_;
};

}  // namespace

void divide_edges(const Brep& brep, const WantedSize& size, const std::set<CornerId>& long_sided,
                  Array<EdgeId, EdgePoints>& points, std::size_t& num_vertices, Context& context) {
  Divider(brep, size, long_sided).run(points, num_vertices, context);
}

FaceGrid make_face_border(const Brep& brep, const BrepFace& face, const Array<EdgeId, EdgePoints>& edges) {
  FaceGrid grid;
  std::vector<std::uint32_t> poles;
  for (const auto& loop : face.loops) {
    std::vector<std::uint32_t> chain;
    for (const BrepUse& use : loop) {
      const EdgePoints& points = edges[use.edge];
      if (brep.edges[use.edge].is_degenerate()) poles.push_back(points.vertex[0]);
      const std::size_t last = points.t.size() - 1;
      for (std::size_t i = 0; i < last; ++i) {
        const std::size_t k = use.is_reversed ? last - i : i;
        chain.push_back(static_cast<std::uint32_t>(grid.points.size()));
        grid.points.push_back({points.at[k], use.curve->at(points.t[k]), points.vertex[k], false});
      }
    }
    grid.loops.push_back(std::move(chain));
  }
  for (FacePoint& p : grid.points) p.is_pole = std::find(poles.begin(), poles.end(), p.vertex) != poles.end();
  return grid;
}

}  // namespace delfront
