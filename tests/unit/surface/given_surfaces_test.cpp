// SPDX-License-Identifier: Apache-2.0
// Real surfaces, far coarser and finer than they are: closed, without crossings, with the same topology.
#include "delfront/io.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

class GivenSurface : public testing::TestWithParam<const char*> {};

TEST_P(GivenSurface, StaysValidAtAnySize) {
  DELFRONT_NEEDS_SHARED_DATA(shared);
  Context context;
  Model model = build_model({{read_mesh((*shared / GetParam()).string(), context), "body"}}, context);
  orient_shells(model, context);
  const SurfaceReport before = check_surface(model, context);
  for (const double share : {0.3, 0.05, 0.01}) {
    SCOPED_TRACE(share);
    const Regridded made = regrid(model, UniformSize(share * model.bounding_box().diagonal()));
    EXPECT_EQ(made.look.can_bound_volume, before.can_bound_volume);
    EXPECT_EQ(made.look.is_closed, before.is_closed);
    EXPECT_EQ(made.look.components.size(), before.components.size());
    const auto euler = [](const SurfaceReport& r) {
      return long(r.num_vertices) - long(r.num_edges) + long(r.num_triangles);
    };
    EXPECT_EQ(euler(made.look), euler(before));
    EXPECT_FALSE(has_errors(made.look.findings));
    EXPECT_NEAR(made.look.area / before.area, 1, 0.05);
    EXPECT_EQ(made.model.patches.size(), model.patches.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Corpus, GivenSurface,
                         testing::Values("surface/heatedDuct.stl", "surface/hinge.stl", "surface/spot_triangulated.obj",
                                         "surface/1002_tray_bottom.STL", "surface/NACA0012.obj", "plc/chazelle_n3.off",
                                         "synthetic/two_materials_shared_face.off", "synthetic/box_with_baffle.obj"));

}  // namespace
}  // namespace delfront
