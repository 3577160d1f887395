// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/ids.hpp"
#include "delfront/mesh.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief A named piece of the boundary (from a solid, group or object of the input).
struct Patch {
  std::string name;
  std::string kind;  ///< "wall", "patch", "farfield", …; empty: not said
};

/// @brief A chain of straight edges that the grid keeps: along edges of triangles (a feature), through the volume
/// (embedded), or both.
struct Curve {
  std::string name;
  std::vector<VertexId> vertices;
};

/// @brief A bounded component of space to be gridded.
struct Region {
  std::string name;
};

/// @brief What is to be gridded: corners, curves, patches, regions with names. Discrete now; CAD feeds the same shape.
///
/// Curves come from the line cells of the input, corners from its vertex cells: points that the grid keeps where they
/// are, on triangles and curves or alone in the volume.
/// `points` are the welded input vertices in input order (exact equality, -0 = +0, first occurrence wins);
/// triangles keep the order of the input; n-gons are ear-clipped.
struct Model {
  Array<VertexId, Point> points;
  Array<TriangleId, std::array<VertexId, 3>> triangles;
  Array<TriangleId, PatchId> patch_of_triangle;
  Array<TriangleId, std::uint32_t> input_face;  ///< which face of the input file(s) a triangle came from
  Array<PatchId, Patch> patches;
  Array<CurveId, Curve> curves;
  std::vector<VertexId> corners;
  std::vector<std::string> corner_names;  ///< one a corner
  Array<RegionId, Region> regions;        ///< those that the input declares, in its order; names are unique or empty
  /// The region behind a triangle, out of which its normal points, and the one ahead; empty: the input says nothing.
  Array<TriangleId, std::array<RegionId, 2>> sides;
  double feature_angle = 40;  ///< degrees, for curves and corners found by angle

  Box bounding_box() const;
  Box surface_box() const;  ///< of the triangles alone: curves and points in the volume do not count
};

/// @brief One named input: a mesh as a reader gave it, and the stem used for unnamed patches.
struct NamedMesh {
  Mesh mesh;
  std::string stem;
  std::vector<std::string> regions{};  ///< what its faces bound, where that is known; "": has no name
  std::vector<std::array<RegionId, 2>>
      sides{};  ///< of its faces: the region behind and the one ahead; empty: not known
};

/// @brief Build a model from surface meshes: weld exactly, triangulate n-gons, name patches and regions.
///
/// Nothing is mended and nothing dropped: degenerate and duplicate facets stay, for check_surface to name. An input may
/// hold lines or points alone. Of lines given twice the first stays.
/// @throws InputError  no faces at all; a coordinate that is not finite (places given)
/// @par Cost  O(n log n)
Model build_model(const std::vector<NamedMesh>& inputs, Context& context);

}  // namespace delfront
