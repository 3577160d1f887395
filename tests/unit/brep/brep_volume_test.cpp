// SPDX-License-Identifier: Apache-2.0
// Closed shapes on to their volume grids.
#include "brep_fixtures.hpp"
#include "delfront/generate.hpp"
#include "delfront/grid_check.hpp"

namespace delfront {
namespace {

using namespace fixtures;

TEST(BrepVolume, ClosedShapesAreFilled) {
  const double volumes[] = {4 * kPi / 3, 2 * kPi * kPi * 2 * 0.36, 3 * kPi, 8 * kPi / 9};
  std::size_t i = 0;
  for (const Shape& shape : all_shapes()) {
    if (!shape.is_closed) continue;
    SCOPED_TRACE(shape.name);
    const LinearSize size(shape.h, 1, {}, shape.low, shape.high);
    const Gridded made = grid(shape.brep, size);
    Context context;
    const Outcome outcome = generate(made.model, Options{}, context);
    for (const Finding& f : check(outcome.mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
    EXPECT_EQ(outcome.mesh.num_cells(CellType::triangle), made.model.triangles.size());
    EXPECT_EQ(outcome.report.recovery.steiner_left, 0u);
    EXPECT_NEAR(outcome.report.quality.volume / volumes[i], 1, 0.03);
    EXPECT_GT(outcome.report.quality.find("min_dihedral")->min, 8);
    ++i;
  }
  EXPECT_EQ(i, std::size(volumes));
}

}  // namespace
}  // namespace delfront
