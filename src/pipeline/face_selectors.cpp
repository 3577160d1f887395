// SPDX-License-Identifier: Apache-2.0
#include "pipeline/face_selectors.hpp"

#include <fmt/format.h>

#include <cmath>

#include "delfront/errors.hpp"
#include "geometry/angles.hpp"

namespace delfront {
namespace {

constexpr double kOneWay = 5 * kDegree;
constexpr int kPlaces = 8;  ///< along each edge of a face

/// Whether the face looks that way at places all along its border, and between those.
bool looks_along(const Brep& brep, const BrepFace& face, Point normal) {
  Point2 first;
  bool has_first = false;
  for (const auto& loop : face.loops)
    for (const BrepUse& use : loop) {
      const auto& range = brep.edges[use.edge].range;
      for (int i = 0; i < kPlaces; ++i) {
        const Point2 uv = use.curve->at(range[0] + (range[1] - range[0]) * (i + 0.5) / kPlaces);
        if (!has_first) first = uv;
        has_first = true;
        for (const Point2 place : {uv, Point2{0.5 * (uv.x + first.x), 0.5 * (uv.y + first.y)}}) {
          const Point n = (face.is_reversed ? -1.0 : 1.0) * face.surface->normal(place);
          if (!(angle_between(n, normal) < kOneWay)) return false;
        }
      }
    }
  return has_first;
}

}  // namespace

void name_selected_faces(const std::vector<BoundaryOptions>& boundaries, const std::string& file, Brep& brep) {
  const std::size_t num_faces = brep.faces.size();
  for (const BoundaryOptions& boundary : boundaries) {
    const std::string where =
        fmt::format("{}boundaries.{}", boundary.set_at.empty() ? "" : boundary.set_at + ": ", boundary.name);
    for (const std::uint32_t face : boundary.faces) {
      if (face > num_faces)
        throw UsageError(
            fmt::format("{}: {} has no face {}; it has {} (delfront info lists them)", where, file, face, num_faces));
      brep.faces[FaceId(std::size_t(face - 1))].name = boundary.name;
    }
    if (!boundary.normal) continue;
    bool is_any = false;
    for (BrepFace& face : brep.faces) {
      if (!looks_along(brep, face, *boundary.normal)) continue;
      face.name = boundary.name;
      is_any = true;
    }
    if (!is_any)
      throw UsageError(fmt::format("{}: no face of {} looks along ({:g}, {:g}, {:g}) all over, within 5 degrees", where,
                                   file, boundary.normal->x, boundary.normal->y, boundary.normal->z));
  }
}

}  // namespace delfront
