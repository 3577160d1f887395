// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "support/plc_fixtures.hpp"
#include "volume/facets.hpp"

namespace delfront {
namespace {

using Face = std::array<std::uint32_t, 3>;
using Tet = std::array<std::uint32_t, 4>;

std::vector<ExactPoint> exact(const std::vector<Point>& points) {
  std::vector<ExactPoint> out;
  for (const Point& p : points) out.push_back(ExactPoint::explicit_point(p));
  return out;
}

/// Triangles with normals inwards, as fill_polyhedron takes them.
std::vector<Face> inward_faces(const fixtures::Facets& facets) {
  std::vector<Face> faces;
  for (const auto& f : facets.faces)
    for (std::size_t k = 1; k + 1 < f.size(); ++k)
      faces.push_back(
          {static_cast<std::uint32_t>(f[0]), static_cast<std::uint32_t>(f[k + 1]), static_cast<std::uint32_t>(f[k])});
  return faces;
}

Face rotated(Face f) {
  std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  return f;
}

double volume_of(const std::vector<Point>& p, const std::vector<Tet>& tets) {
  double sum = 0;
  for (const Tet& t : tets) sum += dot(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]), p[t[3]] - p[t[0]]) / 6;
  return sum;
}

/// Positive tets whose faces, seen from inside, are the given ones once each; all others in pairs.
void expect_filled(const std::vector<Point>& points, const std::vector<Face>& faces, double volume,
                   std::size_t tets_min, std::size_t tets_max) {
  std::vector<Tet> tets;
  ASSERT_TRUE(fill_polyhedron(exact(points), faces, tets));
  std::map<Face, int> seen;  // + 1 a tet's face, - 1 a given one
  for (const Tet& t : tets) {
    ASSERT_GT(orient3d(points[t[0]], points[t[1]], points[t[2]], points[t[3]]), 0);
    for (const auto& f : kFaceNodes) ++seen[rotated({t[f[0]], t[f[1]], t[f[2]]})];
  }
  for (const Face& f : faces) --seen[rotated(f)];
  for (const auto& [face, count] : seen) {
    const auto other = seen.find(rotated({face[0], face[2], face[1]}));
    EXPECT_EQ(count, other == seen.end() ? 0 : other->second);
    EXPECT_TRUE(count == 0 || count == 1);
  }
  EXPECT_NEAR(volume_of(points, tets), volume, 1e-12);
  EXPECT_GE(tets.size(), tets_min);
  EXPECT_LE(tets.size(), tets_max);
}

TEST(FillPolyhedron, a_tetrahedron) {
  const auto tet = fixtures::tetrahedron_facets({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  expect_filled(tet.points, inward_faces(tet), 1.0 / 6, 1, 1);
}

TEST(FillPolyhedron, a_cube_of_twelve_faces) {
  const auto cube = fixtures::box_facets({0, 0, 0}, {1, 1, 1});
  expect_filled(cube.points, inward_faces(cube), 1, 5, 6);
}

TEST(FillPolyhedron, an_octahedron_takes_four_tets) {
  const std::vector<Point> p = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Face> faces;
  for (const Face f : {Face{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}})
    faces.push_back({f[0], f[2], f[1]});
  expect_filled(p, faces, 4.0 / 3, 4, 4);
}

TEST(FillPolyhedron, schoenhardt_cannot_be_filled) {
  for (const double twist : {5.0, 15.0, 30.0, 45.0, 55.0}) {
    const auto prism = fixtures::schoenhardt(twist, 1);
    ASSERT_GT(prism.volume(), 0);
    std::vector<Tet> tets;
    EXPECT_FALSE(fill_polyhedron(exact(prism.points), inward_faces(prism), tets)) << twist;
  }
}

TEST(FillPolyhedron, the_other_diagonals_of_the_same_prism_can) {
  auto prism = fixtures::schoenhardt(-30, 1);  // the diagonals bend outwards: convex
  std::vector<Tet> tets;
  EXPECT_TRUE(fill_polyhedron(exact(prism.points), inward_faces(prism), tets));
  EXPECT_NEAR(volume_of(prism.points, tets), prism.volume(), 1e-12);
}

TEST(FillPolyhedron, a_face_inside_stands_there_once_each_way) {
  // Two tets over a common face: without the slit three tets around the edge between the apices would do as well.
  const std::vector<Point> p = {{1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}, {0, 0, 2}, {0, 0, -2}};
  std::vector<Face> faces = {{0, 3, 1}, {1, 3, 2}, {2, 3, 0}, {1, 4, 0}, {2, 4, 1}, {0, 4, 2}};
  const double volume = 2 * (1.5 * 1.6 / 2) * 2 / 3;
  expect_filled(p, faces, volume, 2, 3);
  faces.push_back({0, 1, 2});
  faces.push_back({0, 2, 1});
  expect_filled(p, faces, volume, 2, 2);
}

TEST(FillPolyhedron, a_hole_in_the_faces_is_noticed) {
  const auto cube = fixtures::box_facets({0, 0, 0}, {1, 1, 1});
  std::vector<Face> faces = inward_faces(cube);
  faces.pop_back();
  std::vector<Tet> tets;
  EXPECT_FALSE(fill_polyhedron(exact(cube.points), faces, tets));
}

TEST(FillPolyhedron, the_hull_of_random_points_fills_with_their_delaunay_tets) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Point> points;
    TetComplex c;
    for (int i = 0; i < 12; ++i) {
      points.push_back({uniform(random), uniform(random), uniform(random)});
      c.add_vertex(points.back(), 1);
    }
    Context context;
    build_delaunay(c, context);
    std::vector<Face> faces;
    double volume = 0;
    std::size_t real = 0;
    for (TetIndex t = 0; t < c.num_slots(); ++t) {
      if (c.is_dead(t)) continue;
      const std::uint32_t* n = &c.node[4 * t];
      if (c.is_ghost(t)) {
        faces.push_back(c.face_nodes(c.neigh[4 * t + 3]));
        continue;
      }
      volume += volume_of(points, {{n[0], n[1], n[2], n[3]}});
      ++real;
    }
    expect_filled(points, faces, volume, real,
                  real);  // Delaunay is the only answer where no five points lie on a sphere
  }
}

}  // namespace
}  // namespace delfront
