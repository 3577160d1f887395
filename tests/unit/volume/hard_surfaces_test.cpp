// SPDX-License-Identifier: Apache-2.0
// Families of surfaces made to break boundary recovery: reflex prisms, Chazelle's notches, needles, wedges, gaps,
// fans of slivers, far from the origin and very small.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "support/plc_fixtures.hpp"

namespace delfront {
namespace {

using fixtures::box_facets;
using fixtures::expect_recovered;
using fixtures::Facets;
using fixtures::Recovered;

TEST(HardSurfaces, schoenhardt_at_many_twists) {
  for (const double twist : {1.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 55.0, 58.0, 59.0, 59.9})
    for (const double height : {0.01, 1.0, 10.0}) {
      SCOPED_TRACE(std::to_string(twist) + " degrees, height " + std::to_string(height));
      const Facets prism = fixtures::schoenhardt(twist, height);
      const Recovered r = expect_recovered(prism, prism.volume());
      EXPECT_EQ(r.report.steiner_left, 0u);
      EXPECT_GT(r.mesh.points.size(), 6u);  // it cannot be done without further points
      EXPECT_EQ(r.mesh.num_cells(CellType::triangle), 8u);
    }
}

TEST(HardSurfaces, chazelle_polyhedra) {
  for (const int n : {1, 2, 3, 4})
    for (const double gap : {1.0, 0.1, 0.01}) {
      SCOPED_TRACE("n " + std::to_string(n) + ", gap " + std::to_string(gap));
      const Facets body = fixtures::chazelle(n, gap);
      const Recovered r = expect_recovered(body, body.volume());
      EXPECT_EQ(r.report.steiner_left, 0u);
      EXPECT_EQ(r.grid.regions.size(), 1u);
    }
}

/// A needle of a width, alone, in a box, and eight that nearly meet.
void expect_needles(double width) {
  SCOPED_TRACE(width);
  const Facets spike = fixtures::tetrahedron_facets({0, 0, 0}, {width, 0, 0}, {0, width, 0}, {0.3, 0.2, 1});
  expect_recovered(spike, spike.volume());
  Facets inside = box_facets({-1, -1, -1}, {2, 2, 2});
  inside.add(spike);
  EXPECT_EQ(expect_recovered(inside, 27).grid.regions.size(), 2u);
  Facets star = box_facets({-1, -1, -1}, {1, 1, 1});
  for (int i = 0; i < 8; ++i) {  // they nearly meet at the origin
    const double angle = 0.3 + 2 * std::numbers::pi * i / 8;
    const Point along{std::cos(angle), std::sin(angle), 0.1 * i - 0.35};
    const Point side{-width * along.y, width * along.x, 0};
    Facets needle = fixtures::tetrahedron_facets(0.01 * along, 0.9 * along, 0.9 * along + side,
                                                 0.9 * along + 0.5 * side + Point{0, 0, width});
    if (needle.volume() < 0) needle.turn();
    star.add(needle);
  }
  EXPECT_EQ(expect_recovered(star, 8).grid.regions.size(), 9u);
}

TEST(HardSurfaces, needles) {
  for (const double width : {1e-1, 1e-2, 1e-3}) expect_needles(width);
}
TEST(HardSurfaces, needles_of_a_ten_thousandth) { expect_needles(1e-4); }
TEST(HardSurfaces, needles_of_a_hundred_thousandth) { expect_needles(1e-5); }
TEST(HardSurfaces, needles_of_a_millionth) { expect_needles(1e-6); }

/// A wedge over the x axis, opening by `degrees`, cut into n slices along it.
Facets wedge(double degrees, int n) {
  Facets body;
  const double rise = std::tan(degrees * std::numbers::pi / 180);
  for (int i = 0; i <= n; ++i) {
    const double x = double(i) / n;
    body.points.push_back({x, 0, 0});
    body.points.push_back({x, 1, 0});
    body.points.push_back({x, 1, rise});
  }
  for (std::size_t i = 0; i + 1 < body.points.size() / 3; ++i) {
    const std::size_t a = 3 * i, b = a + 3;
    body.faces.push_back({a, a + 1, b + 1, b});
    body.faces.push_back({a, b, b + 2, a + 2});
    body.faces.push_back({a + 1, a + 2, b + 2, b + 1});
  }
  body.faces.push_back({0, 2, 1});
  const std::size_t last = body.points.size() - 3;
  body.faces.push_back({last, last + 1, last + 2});
  return body;
}

TEST(HardSurfaces, wedges_down_to_a_thousandth_of_a_degree) {
  for (const double degrees : {30.0, 1.0, 0.1, 0.01, 0.001})
    for (const int n : {1, 7, 20}) {
      SCOPED_TRACE(std::to_string(degrees) + " degrees, slices " + std::to_string(n));
      Facets body = wedge(degrees, n);
      ASSERT_GT(body.volume(), 0);
      expect_recovered(body, body.volume());
      Facets inside = box_facets({-1, -1, -1}, {2, 2, 2});
      inside.add(body);
      EXPECT_EQ(expect_recovered(inside, 27).grid.regions.size(), 2u);
    }
}

TEST(HardSurfaces, two_boxes_a_small_gap_apart) {
  for (const double gap : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
    SCOPED_TRACE(gap);
    Facets boxes = box_facets({-2, -2, -2}, {3, 3, 3});
    boxes.add(box_facets({0, 0, 0}, {1, 1, 0.5}));
    boxes.add(box_facets({0.1, 0.2, 0.5 + gap}, {1.1, 0.9, 1}));
    EXPECT_EQ(expect_recovered(boxes, 125).grid.regions.size(), 3u);
    Facets holes = box_facets({-2, -2, -2}, {3, 3, 3}), body = box_facets({0, 0, 0}, {1, 1, 0.5});
    body.add(box_facets({0, 0, 0.5 + gap}, {1, 1, 1}));
    const double volume = 125 - body.volume();
    body.turn();
    holes.add(body);
    EXPECT_EQ(expect_recovered(holes, volume).grid.regions.size(), 1u);
  }
}

TEST(HardSurfaces, fans_of_slivers) {
  for (const int n : {2, 10, 100, 800}) {  // 800: one diagonal crosses 400 edges
    SCOPED_TRACE(n);
    const Recovered r = expect_recovered(fixtures::fan_box(n), 1);
    EXPECT_EQ(r.report.steiner_left, 0u);
  }
}

TEST(HardSurfaces, far_from_the_origin_and_very_small) {
  const Facets bodies[] = {box_facets({0, 0, 0}, {1, 1, 1}), fixtures::schoenhardt(30, 1), fixtures::chazelle(2, 0.1),
                           fixtures::fan_box(20), wedge(1, 7)};
  for (const Facets& body : bodies) {
    Facets far;
    far.add(body, {1e6, -2e6, 3e6});
    expect_recovered(far, far.volume());
    for (const double scale : {1e-6, 1e6}) {
      Facets scaled;
      scaled.add(body, {}, scale);
      expect_recovered(scaled, scaled.volume());
    }
  }
}

TEST(HardSurfaces, a_field_of_twisted_prisms_in_a_box) {
  Facets field = box_facets({0, 0, 0}, {12, 12, 12});
  double volume = 0;
  for (int i = 0; i < 27; ++i) {
    Facets prism = fixtures::schoenhardt(5 + 2 * i, 1 + 0.05 * i);
    volume += prism.volume();
    prism.turn();
    field.add(prism, {2.0 + 4 * (i % 3), 2.0 + 4 * (i / 3 % 3), 1.0 + 4.0 * (i / 9)});
  }
  const Recovered outside = expect_recovered(field, 12.0 * 12 * 12 - volume);
  EXPECT_EQ(outside.grid.regions.size(), 1u);
  DomainOptions all;
  all.keep = "all";
  EXPECT_EQ(expect_recovered(field, 12.0 * 12 * 12, all).grid.regions.size(), 28u);
}

/// Prisms that stand on each other, twisted in turn: the bottom of one is the top of the other.
TEST(HardSurfaces, a_tower_of_twisted_prisms) {
  for (const int floors : {2, 5, 10}) {
    SCOPED_TRACE(floors);
    Facets tower;
    for (int i = 0; i <= floors; ++i)
      for (int k = 0; k < 3; ++k) {
        const double angle = (120.0 * k + 30 * i) * std::numbers::pi / 180;
        tower.points.push_back({std::cos(angle), std::sin(angle), double(i)});
      }
    for (std::size_t i = 0; i < static_cast<std::size_t>(floors); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t at = 3 * i + k, next = 3 * i + (k + 1) % 3;
        tower.faces.push_back({at, next, next + 3});
        tower.faces.push_back({at, next + 3, at + 3});
      }
    tower.faces.push_back({0, 2, 1});
    const std::size_t top = 3 * static_cast<std::size_t>(floors);
    tower.faces.push_back({top, top + 1, top + 2});
    const Recovered hollow = expect_recovered(tower, tower.volume());
    EXPECT_EQ(hollow.grid.regions.size(), 1u);
    for (std::size_t i = 1; i < static_cast<std::size_t>(floors); ++i)
      tower.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    EXPECT_EQ(expect_recovered(tower, hollow.volume).grid.regions.size(), static_cast<std::size_t>(floors));
  }
}

}  // namespace
}  // namespace delfront
