// SPDX-License-Identifier: Apache-2.0
#include "mesh/cell_shape.hpp"

namespace delfront {

namespace {

constexpr bool contains_edge(const LocalFacet& facet, int a, int b) {
  for (int i = 0; i < facet.num_vertices; ++i) {
    const int u = facet.vertices[i], v = facet.vertices[(i + 1) % facet.num_vertices];
    if ((u == a && v == b) || (u == b && v == a)) return true;
  }
  return false;
}

/// Edges and the facets beside them follow from the facets: each edge runs upwards in one facet or the other.
constexpr CellShape with_edges(CellShape shape) {
  for (int a = 0; a < 8; ++a)
    for (int b = a + 1; b < 8; ++b) {
      int found = 0;
      for (int f = 0; f < shape.num_facets; ++f) {
        if (!contains_edge(shape.facets[f], a, b)) continue;
        if (found < 2) shape.facets_of_edge[shape.num_edges][found] = f;
        ++found;
      }
      if (found > 0) shape.edges[shape.num_edges++] = {a, b};
    }
  return shape;
}

constexpr CellShape kTriangle = with_edges(
    {.num_facets = 3, .facets = {{{2, {0, 1}}, {2, {1, 2}}, {2, {2, 0}}}}, .num_corners = 1, .corners = {{{0, 1, 2}}}});
constexpr CellShape kQuad = with_edges({.num_facets = 4,
                                        .facets = {{{2, {0, 1}}, {2, {1, 2}}, {2, {2, 3}}, {2, {3, 0}}}},
                                        .num_corners = 4,
                                        .corners = {{{0, 1, 3}, {1, 2, 0}, {2, 3, 1}, {3, 0, 2}}}});
constexpr CellShape kTetrahedron =
    with_edges({.num_facets = 4,
                .facets = {{{3, {1, 2, 3}}, {3, {0, 3, 2}}, {3, {0, 1, 3}}, {3, {0, 2, 1}}}},
                .num_corners = 1,
                .corners = {{{0, 1, 2, 3}}}});
constexpr CellShape kPyramid =
    with_edges({.num_facets = 5,
                .facets = {{{4, {0, 3, 2, 1}}, {3, {0, 1, 4}}, {3, {1, 2, 4}}, {3, {2, 3, 4}}, {3, {3, 0, 4}}}},
                .num_corners = 4,
                .corners = {{{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}}}});
constexpr CellShape kPrism =
    with_edges({.num_facets = 5,
                .facets = {{{3, {0, 2, 1}}, {3, {3, 4, 5}}, {4, {0, 1, 4, 3}}, {4, {1, 2, 5, 4}}, {4, {2, 0, 3, 5}}}},
                .num_corners = 6,
                .corners = {{{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}}}});
constexpr CellShape kHexahedron = with_edges({.num_facets = 6,
                                              .facets = {{{4, {0, 3, 2, 1}},
                                                          {4, {4, 5, 6, 7}},
                                                          {4, {0, 1, 5, 4}},
                                                          {4, {1, 2, 6, 5}},
                                                          {4, {2, 3, 7, 6}},
                                                          {4, {3, 0, 4, 7}}}},
                                              .num_corners = 8,
                                              .corners = {{{0, 1, 3, 4},
                                                           {1, 2, 0, 5},
                                                           {2, 3, 1, 6},
                                                           {3, 0, 2, 7},
                                                           {4, 7, 5, 0},
                                                           {5, 4, 6, 1},
                                                           {6, 5, 7, 2},
                                                           {7, 6, 4, 3}}}});
constexpr CellShape kOther{};
static_assert(kTetrahedron.num_edges == 6 && kPyramid.num_edges == 8 && kPrism.num_edges == 9 &&
              kHexahedron.num_edges == 12 && kQuad.num_edges == 4);

}  // namespace

const CellShape& shape_of(CellType type) {
  switch (type) {
    case CellType::triangle:
      return kTriangle;
    case CellType::quad:
      return kQuad;
    case CellType::tetrahedron:
      return kTetrahedron;
    case CellType::pyramid:
      return kPyramid;
    case CellType::prism:
      return kPrism;
    case CellType::hexahedron:
      return kHexahedron;
    default:
      return kOther;
  }
}

}  // namespace delfront
