// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief The faces of a mesh as surface formats take them: sorted by group, points numbered anew.
///
/// With volume cells in the mesh only the points of faces are kept; a mesh of faces alone keeps all points and order.
class SurfaceFaces {
 public:
  /// @param[in,out] notes  sentences on what is left out (volume cells, fields)
  /// @throws InputError  the mesh has no faces
  SurfaceFaces(const Mesh& mesh, const char* format, std::vector<std::string>& notes);

  struct Face {
    std::uint32_t block, cell;
  };
  std::span<const VertexId> points() const { return points_; }  ///< mesh vertices in the order of the file
  std::size_t number(VertexId vertex) const { return number_.empty() ? vertex.index() : number_[vertex.index()]; }
  const std::vector<Face>& faces() const { return faces_; }  ///< sorted by group; those without one come last
  std::span<const VertexId> corners(Face face) const { return mesh_.blocks[face.block][face.cell]; }
  GroupId group(Face face) const;

 private:
  const Mesh& mesh_;
  std::vector<VertexId> points_;
  std::vector<std::uint32_t> number_;  // empty: all points, as they are
  std::vector<Face> faces_;
};

/// @brief A planar polygon as triangles that are not flat where the polygon allows it: ears, the best shaped first.
/// Corners that lie straight between their neighbours block the ears they would make flat, so none is.
/// @par Cost  O(n^3), n = corners
std::vector<std::array<VertexId, 3>> split_polygon(const Mesh& mesh, std::span<const VertexId> corners);

}  // namespace delfront
