// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "delfront/brep.hpp"
#include "delfront/brep_sizes.hpp"
#include "delfront/cad.hpp"
#include "delfront/job.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief An input of smooth geometry: which, what it holds, and its first grid.
struct GeometryInput {
  std::size_t input = 0;
  std::string doubt;  ///< what is suspicious about the file, a sentence; empty: nothing
  Brep brep;
  BrepLook look;
};

/// @brief Sizes of a surface grid of smooth geometry.
///
/// No size exceeds options.size.hmax, else a share of the extent; curvature, close lines and gaps ask for what
/// options.size says, else for what its accuracy stands for; sizes grow by options.size.growth or that of the accuracy.
/// The asked field lowers them.
/// @param options  lengths in model units
/// @param asked    null: nothing else is asked for
std::shared_ptr<const SizeField> geometry_sizes(const Brep& brep, const BrepLook& look, const Options& options,
                                                std::shared_ptr<const SizeField> asked, Context& context);

/// @brief What the surface grid has to reach, by what is asked for.
BrepGoals geometry_goals(const Options& options, const BrepExtent& extent);

/// @brief A grid of the sizes that are usual: to look at the geometry.
/// @param is_quick  the coarse grid alone that sizes are found by
Model grid_to_look_at(const Brep& brep, bool is_quick, Context& context, BrepGridReport& report);

/// @brief A grid of smooth geometry as an input: with the names of faces, edges and corners, and what the faces bound.
NamedMesh named_surface(const Model& grid, const Brep& brep, const std::string& stem);

/// @brief grid_brep() by options.surface.method.
Model grid_geometry(const Brep& brep, const SizeField& size, const Options& options, Context& context,
                    BrepGridReport& report);

/// @brief The same by grid_brep_to_goals().
Model grid_geometry_to_goals(const GeometryInput& input, std::shared_ptr<const SizeField> size, const Options& options,
                             Context& context, BrepRounds& report);

/// @brief Whether a file holds smooth geometry: as text (.geom.toml) or from CAD (.step, .iges, …).
bool is_smooth_file(const std::string& path);

/// @brief The same of an entry of input.files, which the caller may hold.
bool is_smooth_input(const std::string& path, const JobExtras& extras);

/// @brief Read a file of geometry; faces without a name get the file's stem. What was mended and what is suspicious is
/// told to the context's log.
/// @param cad  filled where it is a CAD file
/// @par Threads  CAD files wait for each other: OpenCASCADE has settings for the whole process
Brep read_brep(const std::string& path, Context& context, CadReport& cad);

/// @brief A hole (TextShape::reversed) that lies in no body would be filled. In a far field it is a body like others.
/// @param inputs  of the files, in their order; more may follow
/// @throws InputError  as check_holes
void refuse_holes_in_nothing(const std::vector<NamedMesh>& inputs, const std::vector<std::string>& files,
                             const JobExtras& extras);

/// @brief The first thing about a CAD file that may keep it from being gridded; empty: nothing.
std::string doubt_of(const CadReport& cad);

/// @brief Runs some work on the geometry of a file: errors in gridding it name the file and what is suspicious about
/// it.
/// @throws MeshingError, InputError, LimitError (also where it takes more memory than there is)
void with_file(const std::string& path, const std::string& doubt, const std::function<void()>& work);

/// @return the name of a file without folder and suffix
std::string geometry_stem(const std::string& path);

}  // namespace delfront
