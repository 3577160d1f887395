// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <set>

#include "planar/front.hpp"
#include "planar/prepare.hpp"
#include "planar_fixtures.hpp"

namespace delfront::fixtures {

/// @brief Sizes by a function of the place.
class Formula : public SizeField {
 public:
  explicit Formula(std::function<double(Point2)> h) : h_(std::move(h)) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = h_({at[i].x, at[i].y});
  }
  double lower_bound(const Box&) const override { return 1e-6; }

 private:
  std::function<double(Point2)> h_;
};

/// @brief Size h everywhere, s1 h along a direction of 30 degrees.
class Stretched : public SizeField {
 public:
  Stretched(double h, double s1)
      : h_(h), metric_(stretched_metric(h, {s1, 1, {kCosine, kSine, 0}, {-kSine, kCosine, 0}})) {}
  void sizes(std::span<const Point>, std::span<double> size) const override { std::fill(size.begin(), size.end(), h_); }
  void metrics(std::span<const Point>, std::span<Metric> metric) const override {
    std::fill(metric.begin(), metric.end(), metric_);
  }
  bool is_isotropic() const override { return false; }
  double lower_bound(const Box&) const override { return h_; }

 private:
  static constexpr double kCosine = 0.86602540378443865, kSine = 0.5;
  double h_;
  Metric metric_;
};

/// @brief Add a chain of points, not closed, as a curve of its own.
inline void add_line(PlanarDomain& domain, const std::vector<Point2>& line, const std::string& name) {
  const CurveId curve = domain.curves.next_id();
  domain.curves.push_back({name, ""});
  const std::size_t first = domain.points.size();
  for (const Point2 p : line) domain.points.push_back(p);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    domain.segments.push_back({VertexId(first + i), VertexId(first + i + 1)});
    domain.curve_of_segment.push_back(curve);
  }
}

/// @brief A star-shaped polygon of radius 0.6 to 1 with about n corners; in it, apart from each other, a hole, a
/// region, a line, two lines with a thin slot between them, and points, some of them very near to others. One in five
/// has spikes instead: radii from 0.01 on.
inline PlanarDomain random_domain(std::mt19937_64& random, int n) {
  std::uniform_real_distribution<double> unit(0, 1);
  PlanarDomain domain;
  const bool is_spiky = random() % 5 == 0;
  add_loop(domain, star(random, {0, 0}, is_spiky ? 0.01 : 0.6, 1, std::max(n, 8)), "outer");
  if (is_spiky) return domain;
  const auto few = [&](int least) { return least + int(random() % 12); };
  if (random() % 2) add_loop(domain, reversed(star(random, {0.3, 0}, 0.01, 0.1 + 0.1 * unit(random), few(4))), "hole");
  if (random() % 2) add_loop(domain, star(random, {-0.3, 0}, 0.05, 0.2, few(4)), "region");
  if (random() % 2) {
    std::vector<Point2> line;
    for (int i = 0, k = few(2); i < k; ++i)
      line.push_back({-0.25 + 0.5 * i / k + 0.01 * unit(random), 0.3 + 0.05 * unit(random)});
    add_line(domain, line, "line");
  }
  if (random() % 3 == 0) {
    const double gap = std::pow(10, -1.5 - 6 * unit(random));
    for (const double y : {-0.36, -0.36 + gap})
      add_line(domain, {{-0.15, y}, {0.1 * unit(random), y}, {0.15, y}}, "slot");
  }
  for (int i = 0, k = few(0); i < k; ++i) {
    const Point2 p = {-0.2 + 0.4 * unit(random), -0.3 + 0.08 * unit(random)};
    domain.points.push_back(p);
    if (random() % 4 == 0) domain.points.push_back({p.x + 1e-3 * unit(random), p.y});
  }
  return domain;
}

/// @brief Sizes from `least` at a random place to 1e4 times that, or as far as a slope of 0.1 to 0.5 goes.
inline std::shared_ptr<const SizeField> random_sizes(std::mt19937_64& random, double least) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Point2 centre = {unit(random) - 0.5, unit(random) - 0.5};
  const double slope = 0.1 + 0.4 * unit(random);
  return std::make_shared<Formula>(
      [=](Point2 p) { return std::min(1e4 * least, least + slope * std::sqrt(squared_length(p - centre))); });
}

/// @brief What a front made of a domain, looked at by fill_domain().
struct Filled {
  FrontReport report;
  std::size_t num_triangles = 0, num_regions = 0;
  double mean_quality = 0, min_angle = 180;
  std::vector<double> lengths;  ///< of edges inside, over those wanted
  std::vector<std::array<VertexIndex, 3>> corners;

  double share_within(double low, double high) const {
    const auto n = std::count_if(lengths.begin(), lengths.end(), [&](double l) { return l >= low && l <= high; });
    return double(n) / double(lengths.size());
  }
};

inline std::vector<double> areas_of_regions(const PlanarGrid& grid) {
  std::vector<double> areas(grid.region_h.size(), 0);
  const TriComplex& c = grid.complex;
  for (TriIndex t = 0; t < c.tri.size(); ++t) {
    const Triangle& s = c.tri[t];
    if (c.is_dead(t) || c.is_ghost(t) || s.region == kOutside) continue;
    areas[s.region] += 0.5 * cross(c.point[s.node[1]] - c.point[s.node[0]], c.point[s.node[2]] - c.point[s.node[0]]);
  }
  return areas;
}

inline void measure(const PlanarGrid& grid, const SizeField& size, Filled& filled) {
  const TriComplex& c = grid.complex;
  for (TriIndex t = 0; t < c.tri.size(); ++t) {
    const Triangle& s = c.tri[t];
    if (c.is_dead(t) || c.is_ghost(t) || s.region == kOutside) continue;
    filled.corners.push_back({s.node[0], s.node[1], s.node[2]});
    const Point2 p[3] = {c.point[s.node[0]], c.point[s.node[1]], c.point[s.node[2]]};
    double sum = 0;
    for (unsigned k = 0; k < 3; ++k) {
      const Point2 u = p[next_of(k)] - p[k], v = p[previous_of(k)] - p[k], e = p[previous_of(k)] - p[next_of(k)];
      sum += squared_length(u);
      filled.min_angle = std::min(filled.min_angle, std::atan2(cross(u, v), dot(u, v)) * 180 / std::numbers::pi);
      if (c.is_constrained(4 * t + k)) continue;
      const Point2 middle = 0.5 * (p[next_of(k)] + p[previous_of(k)]);
      const Point at{middle.x, middle.y, 0};
      Metric metric;
      size.metrics({&at, 1}, {&metric, 1});
      filled.lengths.push_back(length_in(metric, {e.x, e.y, 0}));
    }
    filled.mean_quality += 2 * std::sqrt(3.0) * cross(p[1] - p[0], p[2] - p[0]) / sum;
    ++filled.num_triangles;
  }
  filled.mean_quality /= double(filled.num_triangles);
}

/// @brief Fill a domain, and expect what always holds: a valid complex, the areas of the regions, all segments, all
/// points.
inline Filled fill_domain(const PlanarDomain& domain, const Options& options, std::shared_ptr<const SizeField> sizes,
                          FrontWatcher* watcher = nullptr) {
  Context context;
  const bool is_stretched = sizes && !sizes->is_isotropic();
  auto [grid, size, is_too_long] = prepare_planar(domain, options, is_stretched ? nullptr : sizes, context);
  if (is_stretched) size = sizes;
  const std::vector<double> areas = areas_of_regions(grid);
  std::set<VertexIndex> used_before, used;
  const auto collect = [&c = grid.complex](std::set<VertexIndex>& all) {
    for (TriIndex t = 0; t < c.tri.size(); ++t)
      if (!c.is_dead(t) && !c.is_ghost(t) && c.tri[t].region != kOutside)
        all.insert(std::begin(c.tri[t].node), std::end(c.tri[t].node));
  };
  collect(used_before);
  const std::size_t num_given = grid.complex.point.size();
  Filled filled;
  filled.report = fill_by_front(grid, *size, context, watcher);
  EXPECT_STREQ(grid.complex.find_defect(), "");
  grid.complex.index_vertices();
  for (const PlanarPiece& piece : grid.pieces) {
    const EdgeRef ref = grid.complex.find_edge(piece.a, piece.b);
    EXPECT_TRUE(ref != kNoTri && grid.complex.is_constrained(ref));
  }
  collect(used);
  EXPECT_TRUE(std::includes(used.begin(), used.end(), used_before.begin(), used_before.end()));
  EXPECT_EQ(used.size(), used_before.size() + filled.report.points);
  EXPECT_EQ(grid.complex.point.size(), num_given + filled.report.points);
  const std::vector<double> after = areas_of_regions(grid);
  double total = 0;
  for (const double area : areas) total += area;
  for (std::size_t r = 0; r < areas.size(); ++r) EXPECT_NEAR(after[r], areas[r], 1e-11 * total);
  measure(grid, *size, filled);
  EXPECT_EQ(filled.num_triangles, filled.report.cells + filled.report.closed_by_delaunay);
  filled.num_regions = areas.size();
  return filled;
}

inline Filled fill_domain(const PlanarDomain& domain, std::shared_ptr<const SizeField> sizes,
                          FrontWatcher* watcher = nullptr) {
  const Options defaults;
  return fill_domain(domain, defaults, sizes, watcher);
}

}  // namespace delfront::fixtures
