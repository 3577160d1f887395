// SPDX-License-Identifier: Apache-2.0
#include "surface/line_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.hpp"

namespace delfront {
namespace {

constexpr double kSamplesPerSide = 4;
constexpr double kTurnPerSide = 3.14159265358979323846 / 3;
constexpr double kMostForTurns = 4;           ///< times the sides that the size asks for
constexpr std::size_t kMostSamples = 100000;  ///< on one given edge
constexpr std::size_t kPointsPerLimitCheck = std::size_t{1} << 16;
constexpr std::size_t kSidesOfTet = 12;  ///< of its faces: no more sides of lines come with a cell

/// A line with the integral of 1 / h along it, at samples.
struct MeasuredLine {
  std::vector<LinePoint> at;
  std::vector<double> sum;
};

MeasuredLine measure(const SurfaceParts& parts, const SurfaceLine& line, const SizeField& size,
                     const Context& context) {
  MeasuredLine result;
  std::vector<Point> places;
  std::size_t checked = 0;
  for (std::uint32_t i = 0; i < line.edges.size(); ++i) {
    if (places.size() - checked > kPointsPerLimitCheck) {
      context.check_limits();
      checked = places.size();
    }
    const Point a = parts.model.points[line.vertices[i]], b = parts.model.points[line.vertices[i + 1]];
    const double h = std::min({size.size(a), size.size(b), size.size(0.5 * (a + b))});
    const double wanted = std::ceil(kSamplesPerSide * distance(a, b) / h);
    const auto n = static_cast<std::size_t>(std::clamp(wanted, 1.0, double(kMostSamples)));
    for (std::size_t k = 0; k < n; ++k) {
      result.at.push_back({i, double(k) / double(n)});
      places.push_back(a + (double(k) + 0.5) / double(n) * (b - a));
    }
  }
  result.at.push_back({static_cast<std::uint32_t>(line.edges.size() - 1), 1});
  std::vector<double> h(places.size());
  size.sizes(places, h);
  result.sum.push_back(0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LinePoint from = result.at[i], to = result.at[i + 1];
    const Point a = parts.model.points[line.vertices[from.edge]], b = parts.model.points[line.vertices[from.edge + 1]];
    const double share = (to.edge == from.edge ? to.t : 1) - from.t;
    result.sum.push_back(result.sum.back() + share * distance(a, b) / h[i]);
  }
  return result;
}

LinePoint place_at(const MeasuredLine& line, double sum) {
  const auto above = std::upper_bound(line.sum.begin(), line.sum.end(), sum);
  const auto i = std::clamp<std::size_t>(std::size_t(above - line.sum.begin()), 1, line.sum.size() - 1) - 1;
  const double share = (sum - line.sum[i]) / (line.sum[i + 1] - line.sum[i]);
  const LinePoint from = line.at[i], to = line.at[i + 1];
  const double end = to.edge == from.edge ? to.t : 1;
  return {from.edge, std::clamp(from.t + share * (end - from.t), 0.0, 1.0)};
}

/// A line that turns gets sides enough to tell, as far as it has them: an arc should not become its chord.
double sides_for_turns(const SurfaceParts& parts, const SurfaceLine& line) {
  double turn = 0;
  for (std::size_t i = 1; i + 1 < line.vertices.size(); ++i) {
    const Point p = parts.model.points[line.vertices[i]];
    const Point in = p - parts.model.points[line.vertices[i - 1]], out = parts.model.points[line.vertices[i + 1]] - p;
    turn += std::atan2(length(cross(in, out)), dot(in, out));
  }
  return std::min(std::round(turn / kTurnPerSide), double(line.edges.size()));
}

std::size_t number_of_sides(const SurfaceParts& parts, const SurfaceLine& line, double wanted) {
  const double turns = sides_for_turns(parts, line);
  const bool is_closed = line.vertices.front() == line.vertices.back();
  const double least =
      is_closed ? std::max(3.0, turns) : std::max(1.0, std::round(std::min(turns, kMostForTurns * wanted)));
  return static_cast<std::size_t>(std::clamp(std::round(wanted), least, 1e8));
}

std::vector<LinePoint> keep(const SurfaceLine& line) {
  std::vector<LinePoint> places;
  for (std::uint32_t i = 0; i < line.edges.size(); ++i) places.push_back({i, 0});
  places.push_back({static_cast<std::uint32_t>(line.edges.size() - 1), 1});
  return places;
}

/// The integral in n equal parts.
std::vector<LinePoint> divide(const SurfaceLine& line, const MeasuredLine& measured, std::size_t n,
                              const Context& context) {
  context.check_cells(n / kSidesOfTet);
  std::vector<LinePoint> places = {{0, 0}};
  for (std::size_t k = 1; k < n; ++k) {
    if (k % kPointsPerLimitCheck == 0) context.check_limits();
    places.push_back(place_at(measured, measured.sum.back() * double(k) / double(n)));
  }
  places.push_back({static_cast<std::uint32_t>(line.edges.size() - 1), 1});
  return places;
}

/// Two lines of one side each between the same corners would be the same side: the longer one gets two.
void raise_doubles(const SurfaceParts& parts, const SizeField& size, const std::vector<bool>& is_kept,
                   LineDivision& division, const Context& context) {
  std::map<std::pair<VertexId, VertexId>, std::size_t> single;
  for (std::size_t l = 0; l < parts.lines.size(); ++l) {
    const SurfaceLine& line = parts.lines[l];
    if (division[l].size() != 2) continue;
    const auto [it, is_new] = single.try_emplace(std::minmax(line.vertices.front(), line.vertices.back()), l);
    if (is_new) continue;
    std::size_t raised = l;
    const std::size_t other = it->second;
    if (is_kept[l] || (!is_kept[other] && parts.lines[other].edges.size() > line.edges.size())) {
      raised = other;
      it->second = l;
    }
    division[raised] = divide(parts.lines[raised], measure(parts, parts.lines[raised], size, context), 2, context);
  }
}

}  // namespace

void divide_lines(const SurfaceParts& parts, const SizeField& size, const std::vector<bool>& is_due,
                  const std::vector<bool>& is_kept, LineDivision& division, Context& context) {
  division.resize(parts.lines.size());
  parallel_for(context.threads, parts.lines.size(), [&](std::size_t l) {
    if (!is_due[l]) return;
    context.check_limits();
    const SurfaceLine& line = parts.lines[l];
    if (is_kept[l]) {
      division[l] = keep(line);
      return;
    }
    const MeasuredLine measured = measure(parts, line, size, context);
    division[l] = divide(line, measured, number_of_sides(parts, line, measured.sum.back()), context);
  });
  raise_doubles(parts, size, is_kept, division, context);
}

LinePoints make_line_points(const SurfaceParts& parts, const LineDivision& division, const Context& context) {
  LinePoints result;
  std::vector<std::uint32_t> point_of(parts.model.points.size(), kNoTriangle);
  const auto given = [&](VertexId v) {
    if (point_of[v.index()] == kNoTriangle) {
      point_of[v.index()] = static_cast<std::uint32_t>(result.points.size());
      result.points.push_back(parts.model.points[v]);
      result.given.push_back(v);
    }
    return point_of[v.index()];
  };
  for (std::uint32_t v = 0; v < parts.is_corner.size(); ++v)
    if (parts.is_corner[v]) given(VertexId(v));
  for (std::size_t l = 0; l < parts.lines.size(); ++l) {
    const SurfaceLine& line = parts.lines[l];
    std::vector<std::uint32_t> chain;
    for (std::size_t i = 0; i < division[l].size(); ++i) {
      if (result.points.size() % kPointsPerLimitCheck == 0) context.check_limits();
      const LinePoint at = division[l][i];
      if (at.t <= 0 || at.t >= 1) {
        chain.push_back(given(line.vertices[at.edge + (at.t >= 1)]));
        continue;
      }
      const Point a = parts.model.points[line.vertices[at.edge]], b = parts.model.points[line.vertices[at.edge + 1]];
      chain.push_back(static_cast<std::uint32_t>(result.points.size()));
      result.points.push_back(a + at.t * (b - a));
      result.given.push_back({});
    }
    result.chain.push_back(std::move(chain));
  }
  return result;
}

}  // namespace delfront
