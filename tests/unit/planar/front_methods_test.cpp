// SPDX-License-Identifier: Apache-2.0
// The three methods as a whole, and the smoothing that comes after a front.
#include <gtest/gtest.h>

#include "delfront/grid_check.hpp"
#include "delfront/io.hpp"
#include "front_fixtures.hpp"
#include "planar/far_field.hpp"
#include "planar/refine.hpp"
#include "planar/smooth.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using namespace fixtures;

constexpr const char* kMethods[] = {"front", "front-delaunay", "delaunay"};

Outcome run(const PlanarDomain& domain, const std::string& method, Options options,
            std::shared_ptr<const SizeField> sizes = nullptr) {
  Context context;
  options.planar.method = method;
  Outcome outcome = generate_planar(domain, options, context, std::move(sizes));
  for (const Finding& finding : check(outcome.mesh)) ADD_FAILURE() << method << ": " << finding.message;
  return outcome;
}

double min_angle(const Outcome& outcome) { return outcome.report.quality.find("min_angle")->min; }

TEST(PlanarMethods, F6_each_reaches_the_angle_at_one_size) {
  PlanarDomain domain;
  add_loop(domain, square(50), "wall");
  const Options defaults;
  for (const char* method : kMethods) {
    SCOPED_TRACE(method);
    const Outcome outcome = run(domain, method, defaults);
    EXPECT_NEAR(outcome.report.quality.volume, 1, 1e-12);
    EXPECT_GE(min_angle(outcome), 30);
    EXPECT_EQ(outcome.report.improve.below_goal, 0u);
    // An ideal grid of this size has 2 / (sqrt(3) / 2) * 2500 = 5774 triangles.
    EXPECT_NEAR(double(outcome.report.quality.num_cells), 5774, 0.2 * 5774);
    const bool is_front = outcome.report.front.cells > 0;
    EXPECT_EQ(is_front, std::string(method) == "front");
    EXPECT_EQ(outcome.report.refine.points_inserted == 0, is_front);
  }
  EXPECT_GT(min_angle(run(domain, "front", defaults)), 35);
}

TEST(PlanarMethods, F6_a_front_places_points_more_regularly_than_circumcentres_do) {
  PlanarDomain domain;
  add_loop(domain, square(50), "wall");
  const Options defaults;
  const auto quality_of = [&](PointPlacement placement) {
    Context context;
    auto [grid, size, is_too_long] = prepare_planar(domain, defaults, nullptr, context);
    refine_complex(grid, *size, context, placement);
    EXPECT_STREQ(grid.complex.find_defect(), "");
    EXPECT_TRUE(grid.complex.is_delaunay());
    Filled filled;
    measure(grid, *size, filled);
    return filled.mean_quality;
  };
  const double circumcentres = quality_of(PointPlacement::circumcentres);
  EXPECT_GT(circumcentres, 0.85);
  EXPECT_GT(quality_of(PointPlacement::frontal), circumcentres + 0.03);
  EXPECT_GT(fill_domain(domain, nullptr).mean_quality, circumcentres + 0.03);
}

TEST(PlanarMethods, D5_sections_in_a_far_field) {
  DELFRONT_NEEDS_SHARED_DATA(shared);
  for (const char* name : {"naca0012", "rae2822", "s1223"}) {
    SCOPED_TRACE(name);
    Context context;
    const std::string path = (*shared / "airfoil" / (std::string(name) + ".dat")).string();
    PlanarDomain domain = build_planar_domain({{read_mesh(path, context), name}}, context);
    EncloseOptions enclose;
    enclose.shape = "circle";
    enclose.size = {50, ""};
    Options options;
    options.domain.keep = "outside";
    add_far_field(domain, enclose, options.size, {}, context);
    for (const char* method : kMethods) {
      SCOPED_TRACE(method);
      const Outcome outcome = run(domain, method, options);
      EXPECT_GT(min_angle(outcome), std::string(method) == "front" ? 30 : 29);
      EXPECT_EQ(outcome.report.front.closed_by_delaunay, 0u);
      EXPECT_EQ(outcome.mesh.find_block(CellType::line)->size(), domain.segments.size());
    }
  }
}

TEST(PlanarMethods, F5_stretched_sizes_are_not_improved_and_that_is_said) {
  PlanarDomain domain;
  add_loop(domain, square(40), "wall");
  const Options defaults;
  const Outcome outcome = run(domain, "front", defaults, std::make_shared<Stretched>(0.025, 8));
  EXPECT_EQ(outcome.report.improve.passes, 0u);
  EXPECT_TRUE(std::any_of(outcome.report.warnings.begin(), outcome.report.warnings.end(),
                          [](const std::string& w) { return w.find("stretched") != std::string::npos; }));
}

TEST(SmoothComplex, F18_raises_the_mean_and_keeps_what_is_given) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    Options options;
    if (seed % 2 == 0) options.planar.boundary = "split";
    const PlanarDomain domain = random_domain(random, 40);
    Context context;
    auto [grid, size, is_too_long] = prepare_planar(domain, options, random_sizes(random, 0.01), context);
    const std::size_t num_given = grid.complex.point.size();
    fill_by_front(grid, *size, context);
    grid.complex.index_vertices();
    Filled before, after;
    measure(grid, *size, before);
    const std::vector<Point2> points = grid.complex.point;
    const std::vector<double> areas = areas_of_regions(grid);
    // Also those of a divided boundary stay, though they are not given.
    const ImproveReport report =
        smooth_complex(grid, {.first_free = static_cast<VertexIndex>(domain.points.size())}, context);
    EXPECT_STREQ(grid.complex.find_defect(), "");
    measure(grid, *size, after);
    EXPECT_EQ(after.num_triangles, before.num_triangles);
    EXPECT_GT(after.mean_quality, before.mean_quality);
    EXPECT_NEAR(report.min_dihedral_after_deg, after.min_angle, 1e-6);
    for (std::size_t v = 0; v < num_given; ++v) EXPECT_EQ(grid.complex.point[v], points[v]);
    const std::vector<double> areas_after = areas_of_regions(grid);
    for (std::size_t r = 0; r < areas.size(); ++r) EXPECT_NEAR(areas_after[r], areas[r], 1e-11);
  }
}

}  // namespace
}  // namespace delfront
