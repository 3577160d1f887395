// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "delfront/brep.hpp"
#include "delfront/cad.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Sizes of a surface grid of smooth geometry, and how it is gridded.
///
/// No size exceeds options.size.hmax, else a twentieth of the diagonal; round things get options.size.curvature cells a
/// turn (or what size.angle and size.deviation say; 18 where none of them is given), by the curvature of the surfaces
/// and edges themselves; sizes grow by options.size.growth (1.2). The asked field lowers them.
/// @param options  lengths in model units
/// @param asked    null: nothing else is asked for
std::shared_ptr<const SizeField> geometry_sizes(const Brep& brep, const Options& options,
                                                std::shared_ptr<const SizeField> asked, Context& context);

/// @brief The sizes above with nothing asked for: to look at the geometry, and to ask for sizes on its names.
Mesh grid_to_look_at(const Brep& brep, Context& context, BrepGridReport& report);

/// @brief grid_brep() by options.surface.method, as a surface mesh with the names of faces, edges and corners.
Mesh grid_geometry(const Brep& brep, const SizeField& size, const Options& options, Context& context,
                   BrepGridReport& report);

/// @brief Whether a file holds smooth geometry: as text (.geom.toml) or from CAD (.step, .iges, …).
bool is_smooth_file(const std::string& path);

/// @brief Read a file of geometry; faces without a name get the file's stem. What was mended and what is suspicious is
/// told to the context's log.
/// @param cad  filled where it is a CAD file
Brep read_brep(const std::string& path, Context& context, CadReport& cad);

/// @return the name of a file without folder and suffix
std::string geometry_stem(const std::string& path);

}  // namespace delfront
