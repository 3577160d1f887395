// SPDX-License-Identifier: Apache-2.0
// Surfaces that are turned, squeezed and sheared: what was flat is flat only to rounding, so that cells of four
// vertices of one flat part are positive by the exact test and have almost no volume. They must not stay.
// DELFRONT_RANDOM_CASES=n makes n copies of each instead of a few, DELFRONT_RANDOM_SEED=s starts at seed s.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "delfront/generate.hpp"
#include "delfront/io.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

/// Of the sharpest angle of the surface: what the worst cell must have. Cells that are flat to rounding have 1e-6
/// degrees at most.
constexpr double kShare = 0.02;

/// A rotation; for odd seeds with a stretch and a shear before it, of up to 4 and 1.
class Turn {
 public:
  explicit Turn(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    double q[4];
    for (double& x : q) x = normal(random);
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& x : q) x /= n;
    const auto [w, x, y, z] = q;
    row_[0] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)};
    row_[1] = {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)};
    row_[2] = {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    std::uniform_real_distribution<double> unit(-1, 1);
    if (seed % 2 == 0) return;
    for (int axis = 0; axis < 3; ++axis) stretch_[axis] = std::exp2(2 * unit(random));
    shear_ = {unit(random), unit(random), unit(random)};
  }
  Point operator()(Point p) const {
    p = {stretch_.x * p.x + shear_.x * p.y + shear_.y * p.z, stretch_.y * p.y + shear_.z * p.z, stretch_.z * p.z};
    return {dot(row_[0], p), dot(row_[1], p), dot(row_[2], p)};
  }

 private:
  Point row_[3], stretch_{1, 1, 1}, shear_;
};

/// Rounding may make a copy cross itself; that is refused, and rare.
/// @param gap  width of the thinnest part of the model, of the length of its edges there
void expect_no_flat_cells(const Model& given, const std::string& what, double gap = 1) {
  const unsigned first = fixtures::setting("DELFRONT_RANDOM_SEED", 1),
                 cases = fixtures::setting("DELFRONT_RANDOM_CASES", 6);
  unsigned refused = 0;
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE(what + ": DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    Model copy = given;
    const Turn turn(seed);
    for (Point& p : copy.points) p = turn(p);
    Context context;
    try {
      const Outcome outcome = generate(copy, Options(), context);
      EXPECT_TRUE(check(outcome.mesh).empty());
      const SurfaceReport& surface = outcome.report.surface;
      const double sharpest = std::min({surface.min_angle_deg, surface.min_dihedral_deg, gap * 180 / std::numbers::pi});
      EXPECT_GT(outcome.report.quality.find("min_dihedral")->min, std::min(1.0, kShare * sharpest));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_LE(2 * refused, cases);
}

TEST(TurnedCopies, of_the_corpus_leave_no_cells_without_volume) {
  DELFRONT_NEEDS_SHARED_DATA(shared);
  for (const char* name :
       {"schoenhardt_30deg", "schoenhardt_flat", "wedge_half_degree", "chazelle_n3", "gap_1e-4_two_bodies"}) {
    Context context;
    const auto path = *shared / "plc" / (std::string(name) + ".off");
    const double gap = std::string(name).starts_with("gap") ? 1e-4 : 1;
    expect_no_flat_cells(build_model({{read_mesh(path.string(), context), name}}, context), name, gap);
  }
}

TEST(TurnedCopies, of_bodies_with_flat_sides_leave_no_cells_without_volume) {
  fixtures::Facets field = fixtures::box_facets({0, 0, 0}, {4, 4, 4});
  field.add(fixtures::box_facets({1, 1, 1}, {2, 2, 2}));
  field.add(fixtures::box_facets({2.5, 1, 1}, {3, 3, 3}));
  expect_no_flat_cells(fixtures::to_model(field), "boxes");
  expect_no_flat_cells(fixtures::to_model(fixtures::fan_box(12)), "fan");
  expect_no_flat_cells(fixtures::to_model(fixtures::chazelle(2, 0.2)), "chazelle");
}

}  // namespace
}  // namespace delfront
