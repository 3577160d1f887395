// SPDX-License-Identifier: Apache-2.0
// Sides along edges (F3), on random curves and sizes: equal parts of the integral of 1 / h, the same from either end,
// lengths within sqrt(2) of what is asked for, closed edges even all round.
#include "brep/edge_points.hpp"

#include <functional>
#include <random>

#include "brep_fixtures.hpp"
#include "delfront/nurbs.hpp"

namespace delfront {
namespace {

using namespace fixtures;

SampleCurve sample_of(const CurvePointer& curve) {
  return [curve](double t, bool) {
    const CurveDerivatives c = curve->derivatives(t);
    return CurveSample{c.at, c.first, 0};
  };
}

/// The integral of 1 / h along a part, by many small steps.
double wanted_sides(const SmoothCurve& curve, const SizeField& size, double from, double to) {
  constexpr int kSteps = 400;
  double sum = 0;
  Point last = curve.at(from);
  for (int i = 1; i <= kSteps; ++i) {
    const Point next = curve.at(from + (to - from) * i / kSteps);
    sum += distance(last, next) / size.size(0.5 * (last + next));
    last = next;
  }
  return sum;
}

CurvePointer random_spline(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Point> points;
  for (int i = 0; i < 7; ++i) points.push_back({double(i) + 0.3 * any(random), any(random), any(random)});
  return make_nurbs_curve(interpolate_points(points));
}

/// The same curve from its other end.
class Turned : public SmoothCurve {
 public:
  explicit Turned(CurvePointer curve) : curve_(std::move(curve)) {}
  CurveDerivatives derivatives(double t) const override {
    const auto [low, high] = curve_->range();
    CurveDerivatives c = curve_->derivatives(low + high - t);
    c.first = -1.0 * c.first;
    return c;
  }
  std::array<double, 2> range() const override { return curve_->range(); }

 private:
  CurvePointer curve_;
};

TEST(EdgePoints, SidesAreEqualPartsAndWithinRootTwoOfTheSize) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> log_size(-2, 1), log_grading(-1, 1);
  for (int round = 0; round < 40; ++round) {
    const CurvePointer curve = random_spline(random);
    const auto range = curve->range();
    const LinearSize size(std::exp(log_size(random)), std::exp(2 * log_grading(random)), {}, 0, 6);
    const WantedSize wanted(size, 100);
    const std::vector<double> t = divide_curve(sample_of(curve), range, wanted, 1);
    const double all = wanted_sides(*curve, size, range[0], range[1]), each = all / double(t.size() - 1);
    if (all > std::sqrt(0.5)) {
      EXPECT_GT(each, std::sqrt(0.5) - 1e-3);
    }
    EXPECT_LT(each, std::sqrt(2.0) + 1e-3);
    for (std::size_t i = 0; i + 1 < t.size(); ++i)
      EXPECT_NEAR(wanted_sides(*curve, size, t[i], t[i + 1]) / each, 1, 5e-3) << round;
  }
}

TEST(EdgePoints, TheSameFromEitherEnd) {
  constexpr unsigned kSeed = 6;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (int round = 0; round < 20; ++round) {
    const CurvePointer curve = random_spline(random);
    const auto range = curve->range();
    const LinearSize size(0.05, 10, {}, 0, 6);
    const WantedSize wanted(size, 100);
    const std::vector<double> t = divide_curve(sample_of(curve), range, wanted, 1);
    const std::vector<double> back = divide_curve(sample_of(std::make_shared<Turned>(curve)), range, wanted, 1);
    ASSERT_EQ(t.size(), back.size());
    for (std::size_t i = 0; i < t.size(); ++i)
      EXPECT_NEAR(t[i], range[0] + range[1] - back[t.size() - 1 - i], 1e-10 * (range[1] - range[0]));
  }
}

TEST(EdgePoints, SymmetricCurvesAndSizesGiveSymmetricPoints) {
  // x -> -x; sizes that rise to both ends
  class VSize : public SizeField {
   public:
    void sizes(std::span<const Point> at, std::span<double> size) const override {
      for (std::size_t i = 0; i < at.size(); ++i) size[i] = 0.02 + 0.15 * std::abs(at[i].x);
    }
    double lower_bound(const Box&) const override { return 0.02; }
  } size;
  const CurvePointer curve = make_cubic({Point{-2, 0, 0}, {-1, 2, 1}, {1, 2, 1}, {2, 0, 0}});
  const WantedSize wanted(size, 100);
  const std::vector<double> t = divide_curve(sample_of(curve), {0, 1}, wanted, 1);
  ASSERT_GT(t.size(), 10u);
  for (std::size_t i = 0; i < t.size(); ++i) EXPECT_NEAR(t[i], 1 - t[t.size() - 1 - i], 1e-10);
}

TEST(EdgePoints, ClosedEdgesAreEvenAllRoundWithoutACorner) {
  const CurvePointer circle = make_ellipse({}, 1, 1);
  const NurbsCurveData spline = nurbs_circle({}, 1);
  const LinearSize size(0.1, 1, {}, 0, 1);
  const WantedSize wanted(size, 100);
  for (const CurvePointer& curve : {circle, make_nurbs_curve(spline)}) {
    const std::vector<double> t = divide_curve(sample_of(curve), curve->range(), wanted, 3);
    EXPECT_EQ(t.size() - 1, 63u);
    double shortest = 1e300, longest = 0;
    for (std::size_t i = 0; i + 1 < t.size(); ++i) {
      const double side = distance(curve->at(t[i]), curve->at(t[i + 1]));
      shortest = std::min(shortest, side);
      longest = std::max(longest, side);
    }
    EXPECT_NEAR(longest / shortest, 1, 1e-3);
  }
}

TEST(EdgePoints, OfADegenerateEdgeThereIsOnePlace) {
  const Brep sphere = make_sphere({}, 1);
  const LinearSize size(0.2, 1, {}, 0, 1);
  const WantedSize wanted(size, 0.7);
  Context context;
  std::size_t num_vertices = 0;
  Array<EdgeId, EdgePoints> points(sphere.edges.size());
  divide_edges(sphere, wanted, {}, points, num_vertices, context);
  std::size_t degenerate = 0;
  for (std::size_t e = 0; e < points.size(); ++e) {
    const EdgePoints& made = points[EdgeId(e)];
    if (!sphere.edges[EdgeId(e)].is_degenerate()) continue;
    ++degenerate;
    EXPECT_EQ(made.t.size(), 2u);
    EXPECT_EQ(made.vertex[0], made.vertex[1]);
    EXPECT_EQ(made.at[0], made.at[1]);
  }
  EXPECT_EQ(degenerate, 2u);
  // the seam: as many sides as its length asks for, the same for both faces' sides of it
  EXPECT_EQ(num_vertices, 2 + std::size_t(std::lround(kPi / 0.2)) - 1);
}

}  // namespace
}  // namespace delfront
