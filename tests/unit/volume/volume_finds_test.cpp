// SPDX-License-Identifier: Apache-2.0
// Surfaces whose boundary once could not be recovered, each by the name of what was wrong.
#include <gtest/gtest.h>

#include "support/plc_fixtures.hpp"

namespace delfront {
namespace {

using fixtures::expect_recovered;
using fixtures::Facets;
using fixtures::Recovered;

Facets stretched(Facets facets, Point factor) {
  for (Point& p : facets.points)
    for (int axis = 0; axis < 3; ++axis) p[axis] *= factor[axis];
  return facets;
}

// Points on edges went into the ten thousands, and recovery gave up, where a body was thin along an axis.
TEST(VolumeFinds, a_thin_body_needs_about_as_many_points_as_a_thick_one) {
  const Facets body = fixtures::chazelle(2, 0.1);
  const std::size_t plain = expect_recovered(body, body.volume()).report.steiner_points;
  for (const Point factor : {Point{1, 1, 1e-5}, {1, 1e-5, 1e-5}, {1e-4, 1, 1e-6}, {1, 1e5, 1}}) {
    SCOPED_TRACE(testing::Message() << factor.x << " " << factor.y << " " << factor.z);
    const Facets thin = stretched(body, factor);
    const Recovered r = expect_recovered(thin, thin.volume());
    EXPECT_EQ(r.report.steiner_left, 0u);
    EXPECT_LE(r.report.steiner_points, 3 * plain + 300);
  }
}

}  // namespace
}  // namespace delfront
