// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <random>
#include <vector>

#include "tetra/tet_complex.hpp"

namespace delfront::fixtures {

/// @brief A complex of given positive tets: bonds, ghosts on the hull, hull faces constrained, their vertices on the
/// boundary, everything in region 0.
TetComplex complex_from_tets(const std::vector<Point>& points, const std::vector<std::array<VertexIndex, 4>>& tets,
                             double h);

/// @brief The unit cube as n^3 cells of six tets each (Kuhn); interior points moved at random by up to
/// `jitter` cells an axis. The tets stay positive for jitter <= 0.1; larger ones are halved until they are.
TetComplex jittered_cube(int n, double jitter, unsigned seed);

/// @brief As jittered_cube, n even, with a constrained wall at z = 1/2; what lies above it is region 1.
TetComplex jittered_cube_with_wall(int n, double jitter, unsigned seed);

/// @brief n tets around the edge of vertices 0 (bottom) and 1 (top); the ring is 2 ... n + 1.
/// @param wobble  radii vary by up to this share
TetComplex tets_around_edge(int n, double wobble, unsigned seed);

/// @brief Delaunay grid of the unit ball: surface points along a spiral about h apart, interior points at random no
/// nearer than 0.6 h to each other, and `near_surface` points at random 0.02 h below the surface. Full of slivers.
TetComplex sliver_ball(double h, int near_surface, unsigned seed);

/// @brief Delaunay tetrahedrization of the complex's vertices, as one region with a constrained hull.
void connect_hull(TetComplex& complex);

/// @brief Sum of the volumes of the live real tets.
double total_volume(const TetComplex& complex);

/// @brief Constrained faces, each once, as sorted vertex triples in sorted order.
std::vector<std::array<VertexIndex, 3>> constrained_faces(const TetComplex& complex);

}  // namespace delfront::fixtures
