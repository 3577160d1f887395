// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/context.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"

namespace delfront {

/// @brief Add an outer boundary around all that the model holds: a box or a sphere, triangulated here, facing outwards.
///
/// Its centre is that of the model's box, unless the box's corners are given. Its triangles' sides are about
/// options.h; by default a fifth of the radius or of the shortest half side. Points and triangles are appended, so that
/// ids of the input stay; `input_face` of the new triangles is no face (all bits set). A name that a patch has already
/// is numbered.
/// @param options  lengths in model units (as resolve_length gives them), % or c
/// @param scale    of the input, for lengths in % and c
/// @return the new patch, of kind "farfield"; invalid for shape "none"
/// @throws UsageError  an unknown shape; a length that is not positive; more than 50 million triangles asked for
/// @throws InputError  the model is not strictly inside (the place that is farthest out is given)
PatchId add_far_field(Model& model, const EncloseOptions& options, const LengthScale& scale, Context& context);

/// @brief A far field's length: resolve_length belongs to the job file, above us; what it makes of one (model units)
/// and the two units that need the input's box only are understood here.
/// @throws UsageError  another unit
double to_model_units(const Length& length, const LengthScale& scale);

/// @return the side of its triangles where options.h is absent, for a size in model units
double default_far_field_side(const EncloseOptions& options);

/// @return what it encloses, with the model itself, for a size in model units
double far_field_volume(const EncloseOptions& options);

/// @brief Append a box whose sides are grids of about h, with common vertices along its edges; outward.
void append_box(Model& model, const Box& box, double h, PatchId patch);

/// @brief Append an icosahedron, each face cut into n * n triangles and pushed out to the sphere; outward. Sides are
/// about h: between 0.83 and 1.2 of it for small h.
/// @par Source  class I geodesic polyhedron, Wenninger (1979), "Spherical Models"
void append_sphere(Model& model, Point centre, double radius, double h, PatchId patch);

}  // namespace delfront
