// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "delfront/errors.hpp"
#include "delfront/geometry_sizes.hpp"
#include "geometry_fixtures.hpp"
#include "spatial/bvh.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using fixtures::kTurn;
using fixtures::Range;
using fixtures::range_of;
using fixtures::SurfaceBuilder;

GapSizes cells(double n, double hmin = 0) {
  GapSizes wish;
  wish.cells = n;
  wish.hmin = hmin;
  return wish;
}

/// Size on a place: the least of all sources that hold it.
double size_at(const GeometrySources& found, Point at) {
  double size = 1e300;
  for (const SizeSource& source : found.sources) {
    const Simplex& s = std::get<Simplex>(source.shape);
    // a small ball of places, since sources are thin
    const Point a = s.corner[0], b = s.corner[std::size_t(std::min(1, s.num_corners - 1))],
                c = s.corner[std::size_t(s.num_corners - 1)];
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; i + j <= 20; ++j) {
        const Point p = a + (i / 20.0) * (b - a) + (j / 20.0) * (c - a);
        if (distance(p, at) < 0.05) size = std::min(size, source.law.delta0);
      }
  }
  return size;
}

TEST(GapSizes, S10_between_two_spheres) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_sphere(builder, 1, 40, 20, 0);
  fixtures::add_sphere(builder, 0.9, 40, 20, 0, true);
  const GeometrySources found = find_gap_sizes(builder.model(), cells(4), context);
  const Range range = range_of(found);
  EXPECT_EQ(range.count, builder.model().triangles.size());
  EXPECT_NEAR(range.low, 0.1 / 4, 0.1 * 0.1 / 4);
  EXPECT_NEAR(range.high, 0.1 / 4, 0.1 * 0.1 / 4);
}

TEST(GapSizes, S10_progress_is_told_by_the_callers_thread_while_a_large_surface_is_looked_at) {
  SurfaceBuilder builder;
  fixtures::add_sphere(builder, 1, 120, 60, 0);
  Context context;
  context.threads = 2;
  std::vector<Progress> told;
  const auto caller = std::this_thread::get_id();
  context.on_progress = [&](const Progress& progress) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    told.push_back(progress);
  };
  find_gap_sizes(builder.model(), cells(1), context);
  ASSERT_GE(told.size(), 4u);
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_EQ(told[i].stage, "sizes");
    EXPECT_EQ(told[i].total, builder.model().triangles.size());
    EXPECT_EQ(told[i].done > (i > 0 ? told[i - 1].done : 0), i > 0);
  }
  EXPECT_EQ(told.back().done, told.back().total);
}

TEST(GapSizes, S10_inside_of_a_sphere_it_is_the_diameter) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_sphere(builder, 1, 24, 12, 0);
  const Range range = range_of(find_gap_sizes(builder.model(), cells(1), context));
  EXPECT_GT(range.low, 0.85 * 2);
  EXPECT_LE(range.high, 2);
}

TEST(GapSizes, S10_plate_over_plate) {
  Context context;
  SurfaceBuilder builder;  // two plates in a box: a gap of 0.05 between them, 0.2 above and below is no smaller
  builder.box({-4, -4, -4}, {4, 4, 4}, "box");
  builder.box({-1, -1, 0}, {1, 1, 0.5}, "lower", true);
  builder.box({-1, -1, 0.55}, {1, 1, 1}, "upper", true);
  const GeometrySources found = find_gap_sizes(builder.model(), cells(2), context);
  EXPECT_NEAR(range_of(found).low, 0.025, 1e-9);
  EXPECT_NEAR(size_at(found, {0, 0, 0.5}), 0.025, 1e-9);
  EXPECT_NEAR(size_at(found, {0.9, -0.9, 0.55}), 0.025, 1e-9);
  EXPECT_GT(size_at(found, {0, 0, 1}), 1);  // outer face of a plate: 3 to the box
  EXPECT_GT(size_at(found, {3, 3, -4}), 1);
  GapSizes solid = cells(2);
  solid.side = GapSizes::Side::ahead;
  EXPECT_NEAR(size_at(find_gap_sizes(builder.model(), solid, context), {0, 0, 1}), 0.225, 1e-9);
}

TEST(GapSizes, S10_a_small_thing_over_a_large_face) {
  Context context;
  SurfaceBuilder builder;
  builder.box({-10, -10, 0}, {10, 10, 10}, "box");
  builder.box({2.3, 3.1, 0.04}, {2.5, 3.3, 0.24}, "chip", true);
  const GeometrySources found = find_gap_sizes(builder.model(), cells(1), context);
  EXPECT_NEAR(size_at(found, {2.4, 3.2, 0}), 0.04, 1e-9);
  EXPECT_NEAR(size_at(found, {2.4, 3.2, 0.04}), 0.04, 1e-9);
  EXPECT_GT(size_at(found, {-5, -5, 0}), 1);
}

TEST(GapSizes, S10_wall_of_a_tube) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_cylinder(builder, 1, 3, 48, 3, 0);
  fixtures::add_cylinder(builder, 0.8, 3, 48, 3, 0, true);
  const Range range = range_of(find_gap_sizes(builder.model(), cells(3), context));
  EXPECT_EQ(range.count, builder.model().triangles.size());
  EXPECT_NEAR(range.low, 0.2 / 3, 0.005);
  EXPECT_NEAR(range.high, 0.2 / 3, 0.005);
}

TEST(GapSizes, S10_a_cube_alone_is_as_wide_as_its_side) {
  Context context;
  const Model model = build_model({{fixtures::cube_surface(), "cube"}}, context);
  const GeometrySources found = find_gap_sizes(model, cells(3), context);
  EXPECT_EQ(range_of(found).count, 12u);
  EXPECT_NEAR(range_of(found).low, 1.0 / 3, 1e-12);
  EXPECT_NEAR(range_of(found).high, 1.0 / 3, 1e-12);
}

/// A prism over a profile in the plane (x, y), convex or not, of height 1 along z; ends fanned from `hub`.
Model prism(const std::vector<Point>& profile, const std::vector<std::array<int, 3>>& ends) {
  SurfaceBuilder builder;
  builder.patch("prism");
  const int n = static_cast<int>(profile.size());
  const Point up{0, 0, 1};
  for (int i = 0; i < n; ++i) {
    const Point a = profile[std::size_t(i)], b = profile[std::size_t((i + 1) % n)];
    builder.quad(a, b, b + up, a + up);
  }
  for (const auto& [i, j, k] : ends) {
    const Point a = profile[std::size_t(i)], b = profile[std::size_t(j)], c = profile[std::size_t(k)];
    builder.triangle(a, c, b);
    builder.triangle(a + up, b + up, c + up);
  }
  return builder.model();
}

TEST(GapSizes, S10_a_thin_wedge_is_bounded_by_hmin) {
  Context context;
  const double slope = std::tan(10 * kTurn / 360);
  const Model wedge = prism({{0, 0, 0}, {1, 0, 0}, {1, slope, 0}}, {{0, 1, 2}});
  const GeometrySources found = find_gap_sizes(wedge, cells(2, 0.01), context);
  EXPECT_EQ(found.report.smallest, 0.01);
  EXPECT_GT(found.report.num_at_hmin, 0u);
  EXPECT_LT(found.report.num_sources, 20000u);
  for (const double x : {0.4, 0.7}) {
    const double width = x * slope, size = size_at(found, {x, 0, 0.5});
    EXPECT_LT(size, 0.55 * width) << x;
    EXPECT_GT(size, 0.25 * width) << x;
  }
  // 60 degrees: a corner, no gap
  const Model roof = prism({{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}}, {{0, 1, 2}});
  EXPECT_NEAR(range_of(find_gap_sizes(roof, cells(1), context)).low, 1, 1e-9);  // between the ends
}

TEST(GapSizes, S10_a_step_has_the_gaps_of_its_two_heights) {
  Context context;
  const Model step = prism({{0, 0, 0}, {2, 0, 0}, {2, 0.25, 0}, {1, 0.25, 0}, {1, 1, 0}, {0, 1, 0}},
                           {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}, {0, 4, 5}});
  const GeometrySources found = find_gap_sizes(step, cells(1), context);
  EXPECT_NEAR(range_of(found).low, 0.25, 1e-9);
  EXPECT_NEAR(size_at(found, {1.5, 0.25, 0.5}), 0.25, 1e-9);
  EXPECT_GT(size_at(found, {0.3, 1, 0.5}), 0.95);
}

TEST(GapSizes, S10_same_at_any_scale_turn_and_number_of_threads) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_sphere(builder, 1, 20, 10, 0);
  fixtures::add_sphere(builder, 0.7, 24, 14, 0, true);
  const Model model = builder.model();
  const GeometrySources plain = find_gap_sizes(model, cells(2), context);
  context.threads = 3;
  const GeometrySources threads = find_gap_sizes(model, cells(2), context);
  ASSERT_EQ(plain.sources.size(), threads.sources.size());
  for (std::size_t i = 0; i < plain.sources.size(); ++i)
    EXPECT_EQ(plain.sources[i].law.delta0, threads.sources[i].law.delta0);
  for (const double scale : {1e-6, 1048576.0}) {
    Model scaled = model;
    for (Point& p : scaled.points) p = scale * p;
    const GeometrySources other = find_gap_sizes(scaled, cells(2), context);
    EXPECT_NEAR(other.report.smallest, scale * plain.report.smallest, 1e-9 * scale);
    if (scale > 1) {
      EXPECT_EQ(other.report.smallest, scale * plain.report.smallest);
    }
  }
}

TEST(GapSizes, S10_bad_wishes_are_refused) {
  Context context;
  const Model model = build_model({{fixtures::cube_surface(), "cube"}}, context);
  for (const double n : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW(find_gap_sizes(model, cells(n), context), UsageError);
    EXPECT_THROW(find_line_gap_sizes(model, cells(n), context), UsageError);
  }
  EXPECT_THROW(find_gap_sizes(model, cells(1, -1), context), UsageError);
  GapSizes wish;
  wish.facing_deg = 90;
  EXPECT_THROW(find_gap_sizes(model, wish, context), UsageError);
}

TEST(LineGapSizes, S10_strips_of_a_surface) {
  Context context;
  SurfaceBuilder builder;  // a flat sheet with a strip 0.1 wide across it as a patch of its own
  const auto sheet = [&](const char* name, double from, double to, int n) {
    builder.patch(name);
    builder.grid(
        1, n,
        [&](int i, int j) {
          return Point{i ? to : from, double(j) / n, 0};
        },
        2);
  };
  sheet("left", 0, 0.45, 4);
  sheet("strip", 0.45, 0.55, 4);
  sheet("right", 0.55, 1, 4);
  const GeometrySources found = find_line_gap_sizes(builder.model(), cells(2), context);
  EXPECT_NEAR(found.report.smallest, 0.05, 1e-12);
  EXPECT_NEAR(size_at(found, {0.45, 0.5, 0}), 0.05, 1e-12);
  EXPECT_NEAR(size_at(found, {0, 0.5, 0}), 0.225, 1e-12);
}

TEST(LineGapSizes, S10_across_a_curved_patch_it_is_the_length_on_the_surface) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_cylinder(builder, 1, 0.3, 36, 3, 2);
  const GeometrySources found = find_line_gap_sizes(builder.model(), cells(1), context);
  const Range range = range_of(found, 2);
  EXPECT_NEAR(range.low, 0.3, 1e-12);
  EXPECT_NEAR(range.high, 0.3, 1e-12);
}

TEST(LineGapSizes, S10_corners_are_no_gaps) {
  Context context;
  const Model model = build_model({{fixtures::cube_surface(), "cube"}}, context);
  const Range range = range_of(find_line_gap_sizes(model, cells(1), context), 2);
  EXPECT_NEAR(range.low, 1, 1e-12);
  EXPECT_NEAR(range.high, 1, 1e-12);
}

TEST(MergeSources, S11_no_size_rises_and_few_are_left) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_sphere(builder, 1, 160, 80, 0);
  CurvatureSizes wish;
  wish.cells_per_turn = 12;
  const GeometrySources plain = find_curvature_sizes(builder.model(), wish, context);
  GeometrySources merged = plain;
  const std::size_t gone = merge_close_sources(merged);
  EXPECT_EQ(merged.sources.size() + gone, plain.sources.size());
  EXPECT_LT(merged.sources.size(), plain.sources.size() / 20);
  EXPECT_EQ(merged.report.num_sources, merged.sources.size());
  for (std::size_t i = 0; i < plain.sources.size(); i += 37)
    for (const Point& corner : std::get<Simplex>(plain.sources[i].shape).corner) {
      double size = 1e300;
      for (const SizeSource& source : merged.sources) {
        const Simplex& shape = std::get<Simplex>(source.shape);
        const bool is_inside = shape.num_corners == 1 && distance(corner, shape.corner[0]) <= source.law.r0;
        const bool is_corner = corner == shape.corner[0] || corner == shape.corner[1] || corner == shape.corner[2];
        if (is_inside || is_corner) size = std::min(size, source.law.delta0);
      }
      EXPECT_LE(size, plain.sources[i].law.delta0);
      EXPECT_GE(size, 0.75 * plain.sources[i].law.delta0);
    }
  // the same under powers of two
  GeometrySources scaled = plain;
  for (SizeSource& source : scaled.sources) {
    source.law.delta0 *= 0.125;
    for (Point& p : std::get<Simplex>(source.shape).corner) p = 0.125 * p;
  }
  EXPECT_EQ(merge_close_sources(scaled), gone);
  for (std::size_t i = 0; i < merged.sources.size(); ++i)
    EXPECT_EQ(scaled.sources[i].law.r0, 0.125 * merged.sources[i].law.r0);
}

TEST(MergeSources, S11_segments_across_a_gap) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_sphere(builder, 1, 120, 60, 0);
  fixtures::add_sphere(builder, 0.8, 120, 60, 0, true);
  const GeometrySources plain = find_gap_sizes(builder.model(), cells(1), context);
  GeometrySources merged = plain;
  merge_close_sources(merged);
  EXPECT_LT(merged.sources.size(), plain.sources.size() / 3);
  for (std::size_t i = 0; i < plain.sources.size(); i += 997) {
    const Simplex& old = std::get<Simplex>(plain.sources[i].shape);
    for (const double t : {0.0, 0.3, 0.5, 1.0}) {
      const Point at = old.corner[0] + t * (old.corner[1] - old.corner[0]);
      double size = 1e300;
      for (const SizeSource& source : merged.sources) {
        const Simplex& shape = std::get<Simplex>(source.shape);
        const double d = length(nearest_point_on_triangle(at, shape.corner[0], shape.corner[1], shape.corner[2]) - at);
        if (d <= source.law.r0 + 1e-12) size = std::min(size, source.law.delta0);
      }
      EXPECT_LE(size, plain.sources[i].law.delta0);
    }
  }
}

TEST(GapSizes, S10_same_when_turned) {
  Context context;
  SurfaceBuilder builder;
  builder.box({-4, -4, -4}, {4, 4, 4}, "box");
  builder.box({-1, -1, 0}, {1, 1, 0.5}, "lower", true);
  builder.box({-1, -1, 0.55}, {1, 1, 1}, "upper", true);
  Model model = builder.model();
  const double plain = find_gap_sizes(model, cells(2), context).report.smallest;
  for (Point& p : model.points)
    p = 1e6 * Point{0.6 * p.x - 0.8 * p.y, 0.48 * p.x + 0.36 * p.y - 0.8 * p.z, 0.64 * p.x + 0.48 * p.y + 0.6 * p.z};
  EXPECT_NEAR(find_gap_sizes(model, cells(2), context).report.smallest, 1e6 * plain, 1e-3 * 1e6 * plain);
}

TEST(AutomaticSizes, S11_puts_all_together) {
  Context context;
  SurfaceBuilder builder;
  builder.box({-3, -3, -3}, {3, 3, 3}, "box");
  fixtures::add_sphere(builder, 1, 32, 16, 0, true);
  AutomaticSizes wish;
  wish.named = {{"box", 0.75}};
  const GeometrySources found = find_automatic_sizes(builder.model(), wish, context);
  EXPECT_NEAR(found.report.smallest, kTurn / 12, 0.1 * kTurn / 12);
  EXPECT_EQ(found.report.num_sources, found.sources.size());
  EXPECT_NEAR(size_at(found, {0, 0, 3}), 0.75, 1e-12);
  // without any wish the cube is as coarse as itself
  const Model cube = build_model({{fixtures::cube_surface(), "cube"}}, context);
  EXPECT_NEAR(find_automatic_sizes(cube, {}, context).report.smallest, 1, 1e-12);
}

}  // namespace
}  // namespace delfront
