// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "delfront/generate.hpp"
#include "delfront/model.hpp"
#include "volume/recover.hpp"

namespace delfront::fixtures {

/// @brief Facets as plain lists: what the makers of hard surfaces below put together.
struct Facets {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;  ///< any number of corners, anticlockwise seen from outside

  std::vector<std::vector<std::size_t>> curves = {};  ///< chains of points
  std::vector<std::size_t> corners = {};              ///< embedded points

  /// @brief Append another one; equal points are welded when the model is built.
  void add(const Facets& other, Point shift = {}, double scale = 1);
  /// @return its index
  std::size_t add_point(Point p);
  void turn();  ///< every face the other way round
  /// @brief Volume enclosed, by the divergence theorem; n-gons must be flat.
  double volume() const;
};

/// @brief sphere_surface(levels).
Facets sphere_facets(int levels);
Facets box_facets(Point low, Point high);
/// @brief The unit cube, each side as n by n squares.
Facets gridded_cube(int n);
/// @brief A box whose top is a fan of n slivers from one corner, the sides meeting them.
Facets fan_box(int n);
Facets tetrahedron_facets(Point a, Point b, Point c, Point d);
/// @brief Schönhardt's prism, twisted by `degrees` (0 < degrees < 60), of that height: no tetrahedrization without
/// further points. Radius 1 around the z axis.
Facets schoenhardt(double degrees, double height);
/// @brief Chazelle's polyhedron: a box with n notches from below and n from above, their ridges on z = xy and
/// z = xy + gap.
Facets chazelle(int n, double gap);

/// @brief Built, welded, n-gons triangulated.
Model to_model(const Facets& facets);

/// @brief A recovered boundary, with its report and the finished grid.
struct Recovered {
  BoundaryGrid grid;
  RecoveryReport report;
  Mesh mesh;
  double volume = 0;
};

/// @brief Recover a surface's boundary and test all that must hold whatever the surface:
/// the surface is valid (else the test's own input is wrong), find_defect() and check(mesh) find nothing, every
/// triangle at a kept region is a face vertex for vertex or is named in `split`, no other face is constrained, every
/// edge of a curve is an edge, kept, or a chain of points that the report names (all of them in kept regions), nothing
/// stays implicit, the counts of the report add up, and the volume is `volume` (to rounding; NaN: not tested).
Recovered expect_recovered(const Model& model, double volume, const DomainOptions& domain = {});
/// Fills small surfaces by the front as well (expect_filled_by_front), to the same volume.
Recovered expect_recovered(const Facets& facets, double volume, const DomainOptions& domain = {});

/// @brief A grid that the front made.
struct FilledByFront {
  BoundaryGrid grid;
  FrontReport report;
};

/// @brief Fill a recovered boundary by the front, with sizes of the boundary, and test all that must hold then.
FilledByFront expect_filled_by_front(const Model& model, const BoundaryGrid& empty, const DomainOptions& domain = {},
                                     int threads = 1);

}  // namespace delfront::fixtures
