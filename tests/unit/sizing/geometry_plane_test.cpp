// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "delfront/geometry_sizes.hpp"
#include "geometry_fixtures.hpp"

namespace delfront {
namespace {

constexpr double kPi = 3.14159265358979323846;

using fixtures::range_of;
using Line = std::vector<Point>;

/// Lines in the plane; closed ones end at their first vertex. `cut`: in two pieces with shared ends.
class PlaneBuilder {
 public:
  PlaneBuilder& add(const Line& line, bool is_closed, bool cut = false) {
    Curve curve{"line", {}};
    for (const Point p : line) {
      curve.vertices.push_back(model_.points.next_id());
      model_.points.push_back(p);
    }
    if (is_closed) curve.vertices.push_back(curve.vertices[0]);
    if (cut) {
      const auto middle = curve.vertices.begin() + static_cast<std::ptrdiff_t>(curve.vertices.size() / 2);
      model_.curves.push_back({"line", {curve.vertices.begin(), middle + 1}});
      curve.vertices.erase(curve.vertices.begin(), middle);
    }
    model_.curves.push_back(std::move(curve));
    return *this;
  }
  const Model& model() const { return model_; }

 private:
  Model model_;
};

Line ellipse(double a, double b, int n, Point centre = {}) {
  Line line;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * kPi * i / n;
    line.push_back(centre + Point{a * std::cos(t), b * std::sin(t), 0});
  }
  return line;
}

Line rectangle(Point low, Point high) { return {low, {high.x, low.y, 0}, high, {low.x, high.y, 0}}; }

/// NACA 00tt of chord 1 from the trailing edge (a corner) over the top; at x = (1 - cos) / 2.
Line naca(double t, int n, double unit = 0) {
  Line line;
  for (int i = 0; i < 2 * n; ++i) {
    const double x = 0.5 * (1 + std::cos(kPi * i / n));
    const double half =
        5 * t * (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x);
    Point p{x, i == 0 ? 0 : i < n ? half : -half, 0};
    if (unit > 0) p = {unit * std::round(p.x / unit), unit * std::round(p.y / unit), 0};
    line.push_back(p);
  }
  return line;
}

const Simplex& shape_of(const SizeSource& source) { return std::get<Simplex>(source.shape); }

double size_at(const GeometrySources& found, Point at) {
  double size = std::numeric_limits<double>::infinity();
  for (const SizeSource& source : found.sources)
    if (distance_to(source.shape, at) < 1e-9) size = std::min(size, source.law.delta0);
  return size;
}

CurvatureSizes per_turn(double n) {
  CurvatureSizes wish;
  wish.cells_per_turn = n;
  return wish;
}

GapSizes cells(double n, double hmin = 0) {
  GapSizes wish;
  wish.cells = n;
  wish.hmin = hmin;
  return wish;
}

TEST(PlaneCurvature, S9_circles_of_any_spacing_are_exact) {
  std::mt19937 random(5);
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const bool cut : {false, true}) {
      Line line;
      double angle = 0;
      std::uniform_real_distribution<double> exponent(-6, 0);
      while (angle < 2 * kPi - 0.02) {
        line.push_back(scale * Point{3 + 2 * std::cos(angle), 1 + 2 * std::sin(angle), 0});
        angle += 0.5 * std::exp2(exponent(random));
      }
      Context context;
      const Model model = PlaneBuilder().add(line, true, cut).model();
      const GeometrySources found = find_curvature_sizes(model, per_turn(24), context);
      const double expected = scale * 2 * kPi * 2 / 24;
      EXPECT_NEAR(range_of(found, 0).low, expected, 1e-8 * expected) << "seed 5";
      EXPECT_NEAR(range_of(found, 0).high, expected, 1e-8 * expected) << "seed 5";
      for (std::size_t i = 0; i < line.size(); ++i) {
        const Point p = line[i], q = line[(i + 1) % line.size()];
        EXPECT_TRUE(std::isfinite(size_at(found, p)) || scale > 1) << i;
        if (scale == 1) {
          EXPECT_NEAR(size_at(found, 0.5 * (p + q)), expected, 1e-8) << i;
        }
      }
    }
}

TEST(PlaneCurvature, S9_an_ellipse_has_its_own_curvature) {
  const double a = 3, b = 1;
  const int n = 200;
  Context context;
  const Line line = ellipse(a, b, n);
  const GeometrySources found = find_curvature_sizes(PlaneBuilder().add(line, true).model(), per_turn(12), context);
  for (int i = 0; i < n; ++i) {
    const double t = 2 * kPi * (i + 0.5) / n;
    const double r = std::pow(std::hypot(a * std::sin(t), b * std::cos(t)), 3) / (a * b);
    const Point middle = 0.5 * (line[std::size_t(i)] + line[std::size_t((i + 1) % n)]);
    // the smaller size of both ends
    EXPECT_LE(size_at(found, middle), 1.01 * 2 * kPi * r / 12) << i;
    EXPECT_GE(size_at(found, middle), 0.85 * 2 * kPi * r / 12) << i;
  }
}

TEST(PlaneCurvature, S9_the_nose_of_an_airfoil) {
  const double r = 1.1019 * 0.12 * 0.12;
  Context context;
  for (const int n : {40, 100}) {
    const GeometrySources found =
        find_curvature_sizes(PlaneBuilder().add(naca(0.12, n), true).model(), per_turn(24), context);
    EXPECT_NEAR(found.report.smallest, 2 * kPi * r / 24, (n == 40 ? 0.06 : 0.02) * 2 * kPi * r / 24) << n;
    EXPECT_NEAR(found.report.smallest_at.x, 0, 0.01);
    // the rear part of the thickness law is nearly straight: r > 2
    EXPECT_GT(size_at(found, naca(0.12, n)[std::size_t(n) / 4]), 0.4);
  }
}

TEST(PlaneCurvature, S9_points_read_off_a_drawing_give_no_nonsense) {
  // five decimals, and a point doubled but for the last of them: its circles have radii of 1e-3 and less
  Line line = naca(0.12, 60, 1e-5);
  const Point p = line[20];
  line.insert(line.begin() + 21, p + Point{-2e-5, -1e-5, 0});
  Context context;
  const GeometrySources found = find_curvature_sizes(PlaneBuilder().add(line, true).model(), per_turn(24), context);
  const double r = 1.1019 * 0.12 * 0.12;
  EXPECT_NEAR(found.report.smallest, 2 * kPi * r / 24, 0.06 * 2 * kPi * r / 24);
  for (std::size_t i = 10; i < 30; ++i) EXPECT_GT(size_at(found, line[i]), 0.05) << i;
}

TEST(PlaneCurvature, S9_noise_on_a_straight_line_is_laid_over_three) {
  Line line;
  for (int i = 0; i <= 40; ++i) line.push_back({0.1 * i, i % 2 == 0 ? 1e-3 : -1e-3, 0});
  Context context;
  const GeometrySources found = find_curvature_sizes(PlaneBuilder().add(line, false).model(), per_turn(12), context);
  const double raw = 0.1 * 0.1 / 4e-3;  // radius of the circle through three
  EXPECT_NEAR(size_at(found, line[20]), 3 * 2 * kPi * raw / 12, 0.1);
}

TEST(PlaneCurvature, S9_straight_sides_and_corners_give_none) {
  Context context;
  for (const int n : {3, 4, 6, 8}) {  // turns of 45 degrees and more are corners
    Line line;
    const Line corners = ellipse(1, 1, n, {7, -3, 0});
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (int k = 0; k < 10; ++k)
        line.push_back(corners[i] + 0.1 * k * (corners[(i + 1) % corners.size()] - corners[i]));
    EXPECT_EQ(find_curvature_sizes(PlaneBuilder().add(line, true).model(), per_turn(24), context).sources.size(), 0u)
        << n;
  }
  Model octagon = PlaneBuilder().add(ellipse(1, 1, 8), true).model();
  octagon.feature_angle = 50;
  EXPECT_NEAR(find_curvature_sizes(octagon, per_turn(24), context).report.smallest, 2 * kPi / 24, 1e-12);
}

TEST(PlaneCurvature, S9_rounding_of_coordinates_is_no_curvature) {
  const Point at{1e6, -1e6, 0}, along{std::cos(0.3), std::sin(0.3), 0};
  Line line{at - along};  // a place of 1e-10 here is what the coordinates resolve
  for (int i = 0; i < 50; ++i) line.push_back(at + (1e-6 * i) * along);
  line.push_back(at + along);
  Context context;
  EXPECT_EQ(find_curvature_sizes(PlaneBuilder().add(line, false).model(), per_turn(24), context).sources.size(), 0u);
}

TEST(PlaneCurvature, S9_a_flat_side_beside_a_fillet_stays_coarse) {
  Line line{{10, 0, 0}};  // a straight side of 10, a quarter of a circle of 0.1, another side
  for (int i = 0; i <= 9; ++i) {
    const double t = 1.5 * kPi - 0.5 * kPi * i / 9;
    line.push_back({0.1 + 0.1 * std::cos(t), 0.1 + 0.1 * std::sin(t), 0});
  }
  line.push_back({0, 10, 0});
  Context context;
  const GeometrySources found = find_curvature_sizes(PlaneBuilder().add(line, false).model(), per_turn(36), context);
  EXPECT_NEAR(size_at(found, line[5]), 2 * kPi * 0.1 / 36, 1e-9);
  EXPECT_GT(size_at(found, {5, 0, 0}), 5);
}

TEST(PlaneCurvature, S9_sizes_turn_and_scale_with_the_line) {
  const Line line = naca(0.15, 30);
  Line other;
  for (const Point p : line) other.push_back(1024 * Point{-p.y, p.x, 0});
  Context context;
  const GeometrySources a = find_curvature_sizes(PlaneBuilder().add(line, true).model(), per_turn(20), context);
  const GeometrySources b = find_curvature_sizes(PlaneBuilder().add(other, true).model(), per_turn(20), context);
  ASSERT_EQ(a.sources.size(), b.sources.size());
  for (std::size_t i = 0; i < a.sources.size(); ++i)
    EXPECT_NEAR(1024 * a.sources[i].law.delta0, b.sources[i].law.delta0, 1e-12 * b.sources[i].law.delta0);
}

TEST(PlaneGaps, S10_between_two_circles) {
  Context context;
  const Line outer = ellipse(1, 1, 120);
  const Model model = PlaneBuilder().add(outer, true).add(ellipse(0.9, 0.9, 100), true).model();
  GapSizes wish = cells(4);
  wish.is_kept = [](Point p) { return std::hypot(p.x, p.y) > 0.9; };
  const GeometrySources found = find_gap_sizes(model, wish, context);
  EXPECT_NEAR(range_of(found, 0).low, 0.025, 0.001);
  EXPECT_NEAR(range_of(found, 0).high, 0.025, 0.001);
  for (std::size_t i = 0; i < outer.size(); ++i) EXPECT_LT(size_at(found, outer[i]), 0.026) << i;
  wish.is_kept = {};  // the inside of the inner circle counts too
  EXPECT_GT(range_of(find_gap_sizes(model, wish, context), 0).high, 0.4);
}

TEST(PlaneGaps, S10_a_channel_is_as_fine_in_its_middle) {
  Context context;
  const Model model = PlaneBuilder().add(rectangle({0, 0, 0}, {10, 1, 0}), true).model();
  const GeometrySources found = find_gap_sizes(model, cells(5), context);
  for (const double x : {0.6, 2.0, 5.0, 7.7, 9.4})
    for (const double y : {0.0, 0.25, 0.5, 0.75, 1.0})
      EXPECT_NEAR(size_at(found, {x, y, 0}), 0.2, 1e-12) << x << " " << y;
  EXPECT_NEAR(size_at(found, {0, 0.5, 0}), 2, 1e-12);  // its ends are 10 apart
}

TEST(PlaneGaps, S10_a_gap_that_narrows_is_followed) {
  Context context;
  const Model model =
      PlaneBuilder().add({{0, 0, 0}, {10, 0, 0}}, false).add({{0, 0.1, 0}, {10, 2.1, 0}}, false).model();
  const GeometrySources found = find_gap_sizes(model, cells(1), context);
  for (double x = 0.5; x < 9.5; x += 0.5) {
    const double width = (0.1 + 0.2 * x) / std::hypot(1, 0.2);  // to the nearest place
    EXPECT_LE(size_at(found, {x, 0, 0}), 1.05 * width) << x;
    EXPECT_GE(size_at(found, {x, 0, 0}), 0.6 * width) << x;
  }
}

TEST(PlaneGaps, S10_slat_and_main) {
  // the slat stands 0.02 ahead of the nose of the main part, in its own chord's line
  Line slat = naca(0.12, 40), main = naca(0.12, 60);
  for (Point& p : slat) p = 0.2 * p + Point{-0.2, 0.06, 0};
  for (Point& p : main) p = p + Point{0, 0, 0};
  Context context;
  const Model model = PlaneBuilder().add(slat, true).add(main, true).add(ellipse(5, 5, 60), true).model();
  double width = 1e300;
  const auto distance_of = [](Point p, Point a, Point b) { return distance_to(Simplex{{a, b, b}, 2}, p); };
  for (std::size_t i = 0; i < slat.size(); ++i)
    for (std::size_t j = 0; j < main.size(); ++j) {
      width = std::min(width, distance_of(slat[i], main[j], main[(j + 1) % main.size()]));
      width = std::min(width, distance_of(main[j], slat[i], slat[(i + 1) % slat.size()]));
    }
  const auto is_in = [](const Line& line, Point p) {
    bool in = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Point a = line[i], b = line[(i + 1) % line.size()];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
    }
    return in;
  };
  GapSizes wish = cells(3, 1e-6);
  wish.hmax = 0.2;
  wish.is_kept = [&](Point p) { return !is_in(slat, p) && !is_in(main, p); };
  const GeometrySources found = find_gap_sizes(model, wish, context);
  ASSERT_FALSE(found.sources.empty());
  EXPECT_GE(found.report.smallest, 0.99 * width / 3);
  EXPECT_LE(found.report.smallest, 1.2 * width / 3);
  for (const SizeSource& source : found.sources) {  // none is inside of a body
    const Simplex& s = shape_of(source);
    if (s.num_corners == 2 && distance(s.corner[0], s.corner[1]) > 0.05) {
      EXPECT_FALSE(is_in(main, 0.5 * (s.corner[0] + s.corner[1])));
    }
  }
  EXPECT_EQ(found.report.num_at_hmin, 0u);
}

TEST(PlaneGaps, S10_a_thin_plate_as_a_hole) {
  Context context;
  const Line plate = rectangle({-1, -0.01, 0}, {1, 0.01, 0});
  const Model model = PlaneBuilder().add(rectangle({-4, -4, 0}, {4, 4, 0}), true).add(plate, true).model();
  GapSizes wish = cells(2, 1e-5);
  EXPECT_NEAR(find_gap_sizes(model, wish, context).report.smallest, 0.01, 1e-12);
  wish.is_kept = [](Point p) { return std::abs(p.x) > 1 || std::abs(p.y) > 0.01; };
  EXPECT_NEAR(find_gap_sizes(model, wish, context).report.smallest, 3 / 2.0, 1e-9);  // its ends to the box
  // gaps in space ask as well
  wish.is_kept = [](Point) { return false; };
  EXPECT_EQ(find_gap_sizes(model, wish, context).sources.size(), 0u);
}

TEST(PlaneGaps, S10_corners_are_no_gap) {
  Context context;  // of 90, and of 20 degrees between two segments
  for (const double angle : {0.5 * kPi, kPi / 9}) {
    const Model model =
        PlaneBuilder().add({{std::cos(angle), std::sin(angle), 0}, {0, 0, 0}, {1, 0, 0}}, false).model();
    EXPECT_EQ(find_gap_sizes(model, cells(1), context).sources.size(), 0u) << angle;
  }
}

TEST(PlaneGaps, S10_the_same_for_any_number_of_threads) {
  const Model model = PlaneBuilder().add(ellipse(2, 1, 300), true).add(ellipse(1.9, 0.8, 200), true).model();
  Context one, many;
  many.threads = 3;
  const GeometrySources a = find_gap_sizes(model, cells(3), one), b = find_gap_sizes(model, cells(3), many);
  ASSERT_EQ(a.sources.size(), b.sources.size());
  for (std::size_t i = 0; i < a.sources.size(); ++i) {
    EXPECT_EQ(a.sources[i].law.delta0, b.sources[i].law.delta0);
    EXPECT_EQ(shape_of(a.sources[i]).corner, shape_of(b.sources[i]).corner);
  }
}

TEST(PlaneSizes, S11_automatic_in_the_plane) {
  Context context;
  const Model model = PlaneBuilder().add(rectangle({-4, -4, 0}, {4, 4, 0}), true).add(ellipse(1, 1, 90), true).model();
  AutomaticSizes wish;
  wish.is_kept = [](Point p) { return std::hypot(p.x, p.y) > 1; };
  const GeometrySources found = find_automatic_sizes(model, wish, context);
  EXPECT_NEAR(found.report.smallest, 2 * kPi / 12, 1e-9);
  EXPECT_EQ(found.report.num_at_hmin, 0u);
}

}  // namespace
}  // namespace delfront
