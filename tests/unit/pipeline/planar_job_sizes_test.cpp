// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "delfront/errors.hpp"
#include "delfront/options.hpp"
#include "pipeline/job_sizes.hpp"

namespace delfront {
namespace {

void add_square(PlanarDomain& domain, Point2 centre, double half, bool is_reversed = false) {
  const CurveId curve(domain.curves.size());
  domain.curves.push_back({"square", ""});
  std::vector<VertexId> corners;
  for (int i = 0; i < 4; ++i) {
    corners.push_back(domain.points.next_id());
    domain.points.push_back({centre.x + (i == 0 || i == 3 ? -half : half), centre.y + (i < 2 ? -half : half)});
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const VertexId a = corners[i], b = corners[(i + 1) % 4];
    domain.segments.push_back(is_reversed ? std::array{b, a} : std::array{a, b});
    domain.curve_of_segment.push_back(curve);
  }
}

TEST(KeptPart, holes_and_what_lies_beyond_are_not_kept) {
  PlanarDomain domain;
  add_square(domain, {0, 0}, 4);
  add_square(domain, {-2, 0}, 1);       // a hole by its seed
  add_square(domain, {2, 0}, 1, true);  // a hole by its direction
  add_square(domain, {0, 2.5}, 0.5);    // a region of its own
  domain.holes.push_back({-2, 0});
  Context context;
  const auto is_kept = kept_part(domain, CurveId(), Options(), context);
  for (int i = -50; i <= 50; ++i)
    for (int j = -50; j <= 50; ++j) {
      const double x = 0.0987 * i + 0.0123, y = 0.0987 * j + 0.0123;
      const bool is_in_hole = std::abs(std::abs(x) - 2) < 1 && std::abs(y) < 1;
      EXPECT_EQ(is_kept({x, y, 0}), std::max(std::abs(x), std::abs(y)) < 4 && !is_in_hole) << x << " " << y;
    }
}

TEST(KeptPart, in_a_far_field_the_body_is_a_hole_whichever_way_it_runs) {
  for (const bool is_reversed : {false, true}) {
    PlanarDomain domain;
    add_square(domain, {0, 0}, 1, is_reversed);
    Context context;
    EXPECT_TRUE(kept_part(domain, CurveId(), Options(), context)({0.1, 0.2, 0}));
    add_square(domain, {0, 0}, 9);
    const auto is_kept = kept_part(domain, CurveId(1), Options(), context);
    EXPECT_FALSE(is_kept({0.1, 0.2, 0}));
    EXPECT_TRUE(is_kept({3, 0.2, 0}));
    EXPECT_FALSE(is_kept({10, 0.2, 0}));
  }
}

TEST(KeptPart, the_gap_in_a_job_is_that_of_what_is_gridded) {
  PlanarDomain domain;
  add_square(domain, {0, 0}, 4);
  add_square(domain, {0, 0}, 0.01, true);
  Options options;
  options.size.gap.cells = 2;
  Context context;
  const Model model = model_of(domain);
  const std::vector<SizeSource> all = geometry_sources(options, model, {}, context);
  const std::vector<SizeSource> kept =
      geometry_sources(options, model, kept_part(domain, CurveId(), options, context), context);
  const auto least = [](const std::vector<SizeSource>& sources) {
    double h = 1e300;
    for (const SizeSource& source : sources) h = std::min(h, source.law.delta0);
    return h;
  };
  EXPECT_NEAR(least(all), 0.01131, 1e-5);  // hmin, a thousandth of the diagonal
  EXPECT_NEAR(least(kept), 3.99 / 2, 1e-9);
}

}  // namespace
}  // namespace delfront
