// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/planar.hpp"

namespace delfront {

/// @brief Whether a mesh is one in the plane z = 0: lines, or a grid with its boundary's lines.
bool is_planar_input(const Mesh& mesh);

/// @brief Whether all inputs are lines in the plane z = 0: then the job is one in the plane.
bool is_planar_job(const std::vector<NamedMesh>& inputs);

/// @brief Far field, curves' names and kinds, and what to keep: set_boundaries for the plane.
/// @param options  lengths resolved; domain.keep is set where it follows from the far field
/// @return the far field, or none
CurveId set_curves(PlanarDomain& domain, Options& options, const LengthScale& scale, Context& context);

/// @brief Formats that hold no 2-D grid are refused before any work.
/// @throws UsageError
void check_planar_outputs(const Options& options);

/// @brief The curves of [[planar.curve]] as meshes of lines, to stand beside those of the files.
/// @param inputs  what the files hold: lengths in % and c are of the box of all
/// @throws UsageError  a curve that cannot be, with the place of its entry
/// @throws LimitError  a length of pieces that makes too many
std::vector<NamedMesh> curves_of_job(const Options& options, const std::vector<NamedMesh>& inputs,
                                     const Context& context);

/// @brief generate_planar, knowing the far field by its kind whatever kind the job gives it in the grid.
Outcome generate_in_far_field(const PlanarDomain& domain, CurveId far_field, const Options& options,
                              const std::shared_ptr<const SizeField>& sizes, const Model* geometry, Context& context);

/// @brief The job's lines with its splines and a round far field in many more pieces than any grid has: where new
/// points of refine.levels belong. Empty where all lines are straight between given points.
Model true_lines(Options options, std::vector<NamedMesh> inputs, const LengthScale& scale, Context& context);

/// @brief The domain's lines as a mesh, to look at or to write.
Mesh line_mesh(const PlanarDomain& domain);

}  // namespace delfront
