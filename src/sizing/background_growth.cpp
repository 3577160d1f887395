// SPDX-License-Identifier: Apache-2.0
#include "sizing/background_growth.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

#include "sizing/background_values.hpp"

namespace delfront {

namespace {

constexpr double kSteep = 1 + 1e-12;  // a gradient this much above the slope is rounding

/// The least over the inside of a triangle; infinite where it lies on its border.
double least_cone_inside(Point p, const SizedFace& face, double slope) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto& [a, b, c] = face.corner;
  const Point u = b - a, v = c - a, normal = cross(u, v);
  const double squared = squared_length(normal);
  if (!(squared > 0)) return kNone;
  const Point rise =
      ((face.size[1] - face.size[0]) * cross(v, normal) + (face.size[2] - face.size[0]) * cross(normal, u)) / squared;
  if (!(length(rise) < slope)) return kNone;
  const double away = dot(p - a, normal) / std::sqrt(squared);
  const Point foot = p - (dot(p - a, normal) / squared) * normal;
  const Point at = foot - (std::abs(away) / std::sqrt(slope * slope - squared_length(rise))) * rise;
  const double wb = dot(cross(at - a, v), normal) / squared, wc = dot(cross(u, at - a), normal) / squared;
  if (!(wb > 0 && wc > 0 && wb + wc < 1)) return kNone;
  return face.size[0] + dot(rise, at - a) + slope * distance(p, at);
}

}  // namespace

double least_cone_on_segment(Point p, Point a, Point b, double size_a, double size_b, double slope) {
  const Point along = b - a;
  const double l = length(along);
  double best = std::min(size_a + slope * distance(p, a), size_b + slope * distance(p, b));
  if (!(l > 0)) return best;
  const double rise = (size_b - size_a) / l;
  if (!(std::abs(rise) < slope)) return best;
  const double at = dot(p - a, along) / l;
  const double away = distance(p, a + (at / l) * along);
  const double t = at - away * rise / std::sqrt(slope * slope - rise * rise);
  if (t > 0 && t < l) best = std::min(best, size_a + rise * t + slope * std::hypot(away, at - t));
  return best;
}

double least_cone_on_face(Point p, const SizedFace& face, double slope) {
  double best = least_cone_inside(p, face, slope);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    best = std::min(best,
                    least_cone_on_segment(p, face.corner[k], face.corner[next], face.size[k], face.size[next], slope));
  }
  return best;
}

double least_cone_on_cell(Point p, const SimplexGrid& grid, std::size_t cell, const std::vector<double>& size,
                          double slope) {
  const std::span<const std::uint32_t> v = grid.corners(cell);
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t j = i + 1; j < v.size(); ++j) {
      const Point a = grid.points[v[i]], b = grid.points[v[j]];
      best = std::min(best, least_cone_on_segment(p, a, b, size[v[i]], size[v[j]], slope));
      if (grid.dimension == 2) continue;
      for (std::size_t k = j + 1; k < v.size(); ++k)
        best = std::min(best,
                        least_cone_inside(p, {{a, b, grid.points[v[k]]}, {size[v[i]], size[v[j]], size[v[k]]}}, slope));
    }
  return best;
}

std::vector<std::uint32_t> find_steep_cells(const SimplexGrid& grid, const std::vector<double>& size, double slope) {
  std::vector<std::uint32_t> steep;
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell) {
    const std::array<Point, 4> gradient = grid.gradients(cell);
    const std::span<const std::uint32_t> v = grid.corners(cell);
    Point rise;  // from the first corner: constant sizes have none, exactly
    for (std::size_t k = 1; k < v.size(); ++k) rise = rise + (size[v[k]] - size[v[0]]) * gradient[k];
    if (length(rise) > kSteep * slope) steep.push_back(static_cast<std::uint32_t>(cell));
  }
  return steep;
}

namespace {

// Metrics settle in ascending order of their least size, as Dijkstra's search does: a node that was changed again goes
// back into the heap. Ties go by number, so the result is the same in every run.

constexpr std::size_t kCheckEvery = std::size_t{1} << 14;
constexpr double kMetricChange = 1e-6;  // of a size, below which a metric counts as unchanged

using Entry = std::pair<double, std::uint32_t>;
using Heap = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

Metric grown(const MetricAxes& axes, double by) {
  MetricAxes result = axes;
  for (double& value : result.value) {
    const double size = 1 / std::sqrt(value) + by;
    value = 1 / (size * size);
  }
  return metric_from_axes(result);
}

/// Whether m - other has no eigenvalue below -kMetricChange of m: the other one asks for nothing smaller.
bool covers(const Metric& m, const Metric& other) {
  const double s = 1 + 2 * kMetricChange;
  const Metric d{s * m.xx - other.xx, s * m.xy - other.xy, s * m.xz - other.xz,
                 s * m.yy - other.yy, s * m.yz - other.yz, s * m.zz - other.zz};
  const double minor = d.xx * d.yy - d.xy * d.xy;
  const double det =
      d.xx * (d.yy * d.zz - d.yz * d.yz) - d.xy * (d.xy * d.zz - d.yz * d.xz) + d.xz * (d.xy * d.yz - d.yy * d.xz);
  return d.xx >= 0 && minor >= 0 && det >= 0 && d.zz >= 0 && d.yy >= 0 && d.xx * d.zz >= d.xz * d.xz &&
         d.yy * d.zz >= d.yz * d.yz;
}

}  // namespace

std::size_t limit_metric_growth(const SimplexGrid& grid, double slope, std::vector<Metric>& metric, Context& context) {
  const VertexNeighbours neighbours(grid);
  const std::vector<char> used = used_vertices(grid);
  std::vector<double> least(metric.size());
  std::vector<char> is_changed(metric.size(), 0);
  Heap heap;
  for (std::uint32_t v = 0; v < metric.size(); ++v) {
    if (!used[v]) continue;
    least[v] = least_size(metric[v]);
    heap.push({least[v], v});
  }
  std::vector<char> pending(metric.size(), 1);  // a node is settled again only after a change
  std::size_t done = 0;
  while (!heap.empty()) {
    const auto [value, node] = heap.top();
    heap.pop();
    if (value != least[node] || !pending[node]) continue;
    pending[node] = 0;
    if (++done % kCheckEvery == 0) context.check_limits();
    const MetricAxes axes = metric_axes(metric[node]);
    for (const std::uint32_t other : neighbours[node]) {
      Metric allowed = grown(axes, slope * distance(grid.points[node], grid.points[other]));
      if (grid.dimension == 2) allowed = plane_metric(allowed);
      if (covers(metric[other], allowed)) continue;
      metric[other] = intersection(metric[other], allowed);
      if (grid.dimension == 2) metric[other] = plane_metric(metric[other]);
      least[other] = least_size(metric[other]);
      is_changed[other] = 1;
      pending[other] = 1;
      heap.push({least[other], other});
    }
  }
  return static_cast<std::size_t>(std::count(is_changed.begin(), is_changed.end(), 1));
}

}  // namespace delfront
