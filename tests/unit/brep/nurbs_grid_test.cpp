// SPDX-License-Identifier: Apache-2.0
// Splines as faces: gridded through their parameters, with seams and poles found from the data.
#include "brep_fixtures.hpp"
#include "delfront/nurbs.hpp"
#include "support/errors.hpp"

namespace delfront {
namespace {

using namespace fixtures;

void expect_closed_grid(const NurbsSurfaceData& data, double h, double volume, long euler) {
  const SurfacePointer surface = make_nurbs_surface(data);
  const Brep brep = make_rectangle_on(surface, surface->box());
  for (const double grading : {1.0, 8.0}) {
    const LinearSize size(h / std::sqrt(grading), grading, {}, -2, 2);
    const Gridded made = grid(brep, size);
    Context context;
    const SurfaceReport look = check_surface(made.model, context);
    EXPECT_TRUE(look.can_bound_volume);
    for (const Finding& f : look.findings) EXPECT_NE(f.severity, Severity::error) << f.message;
    EXPECT_EQ(topology_of(made.model).euler, euler);
    EXPECT_NEAR(look.volume / volume, 1, grading > 1 ? 0.06 : 0.03);
    EXPECT_GT(smallest_angle(made.model), 20);
    EXPECT_GT(share_of_right_lengths(made.model, size), 0.9);
    EXPECT_LT(farthest_from_entity(made, brep), 1e-12 * look.box.diagonal());
  }
}

TEST(NurbsGrid, SphereWithPoles) { expect_closed_grid(nurbs_sphere({}, 1), 0.15, 4 * kPi / 3, 2); }

TEST(NurbsGrid, Torus) { expect_closed_grid(nurbs_torus({}, 2, 0.6), 0.25, 2 * kPi * kPi * 0.72, 0); }

TEST(NurbsGrid, ClosedLoftBetweenTwoPoints) {
  std::vector<std::vector<Point>> sections;
  for (int s = 0; s <= 10; ++s) {
    const double r = s == 0 || s == 10 ? 0 : std::sin(kPi * s / 10) * (1 + 0.2 * std::sin(double(s)));
    sections.emplace_back();
    for (int i = 0; i < 16; ++i)
      sections.back().push_back({r * std::cos(2 * kPi * i / 16), 0.6 * r * std::sin(2 * kPi * i / 16), 0.3 * s});
  }
  const SurfacePointer surface = make_nurbs_surface(interpolate_sections(sections, true));
  EXPECT_TRUE(surface->degenerate_sides().v_low && surface->degenerate_sides().v_high);
  EXPECT_EQ(surface->period()[0], 1);
  const Brep brep = make_rectangle_on(surface, surface->box());
  const LinearSize size(0.12, 1, {}, 0, 1);
  const Gridded made = grid(brep, size);
  Context context;
  const SurfaceReport look = check_surface(made.model, context);
  EXPECT_TRUE(look.can_bound_volume);
  EXPECT_EQ(topology_of(made.model).euler, 2);
}

}  // namespace
}  // namespace delfront
