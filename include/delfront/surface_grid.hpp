// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief A part of the surface that was not gridded by the front: which, where, why, and what took its place.
struct SurfaceFallback {
  enum class Kind : std::uint8_t {
    remeshed,  ///< its given triangles were split, collapsed and flipped until edges had the wanted length
    kept,      ///< it has its given triangles, and its borders their given points
  };
  Kind kind = Kind::kept;
  std::string patch;
  Point at;
  std::string why;
};

/// @brief One named patch of the new surface.
struct SurfacePatchReport {
  std::string name;
  std::size_t triangles_given = 0, triangles = 0;
  double min_angle_deg = 180;
};

/// @brief What regrid_surface() made.
struct SurfaceGridReport {
  std::size_t regions = 0;  ///< connected pieces between feature lines
  std::size_t lines = 0;    ///< feature lines, and borders of patches
  std::size_t corners = 0;
  std::size_t triangles_given = 0, triangles = 0, points = 0;
  double min_angle_deg = 0, mean_min_angle_deg = 0;  ///< smallest angle of all triangles; mean of each one's smallest
  std::size_t below_25_deg = 0;                      ///< triangles with an angle under 25 degrees
  double largest_distance = 0;                       ///< of samples on the new triangles from the given surface
  Point largest_distance_at;
  double shortest_edge = 0, longest_edge = 0;
  std::size_t front_steps = 0;    ///< sides of the front that were looked at, some more than once
  std::size_t rounds = 0;         ///< of gridding, with sizes lowered or parts kept where the one before failed
  std::size_t sizes_lowered = 0;  ///< places where the wanted size was too coarse for a valid grid
  std::vector<SurfacePatchReport> patches;
  std::vector<SurfaceFallback> fallbacks;
};

/// @brief Grid the surface of a model anew, with edges as long as the size field asks (D2, F3, F4).
///
/// Patches keep their names, kinds and borders, feature lines and corners their places: edges that turn by more than
/// model.feature_angle, open edges, those of more than two triangles, borders of patches, the model's curves. New
/// points lie on the given triangles (those on lines on the given lines). Each piece between lines is gridded by an
/// advancing front directly in space; where that comes to no good end its given triangles are changed locally, or,
/// failing that, kept as they are with their borders: the result is never worse to grid than what was given. Triangles
/// keep their orientation; the result is closed where the given surface is. Model::input_face counts the
/// new triangles.
/// @param size     wanted sides; of points on the surface
/// @param options  options.method "keep" returns the model as it is
/// @throws InputError  triangles without area, or twice the same (places given)
/// @par Cost     O(n log n) in the given and the new triangles
/// @par Source   Löhner (1996), Regridding surface triangulations, J. Comput. Phys. 126; Löhner (2008), 2.6, 3.6.
/// @par Threads  the same grid for any number
Model regrid_surface(const Model& model, const SizeField& size, const SurfaceOptions& options,
                     SurfaceGridReport& report, Context& context);

}  // namespace delfront
