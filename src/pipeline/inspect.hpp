// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/cad.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/job.hpp"
#include "delfront/mesh.hpp"
#include "delfront/surface_check.hpp"
#include "pipeline/geometry_facts.hpp"

namespace delfront {

/// @brief What a look at an input or a grid gives: a surface with its report, or a grid with its findings.
struct Inspected {
  std::shared_ptr<const Mesh> mesh;  ///< of a surface: welded and triangulated
  bool is_grid = false;
  SurfaceReport surface;
  std::vector<Finding> findings;  ///< of the surface, or of the grid
  QualityReport quality;          ///< of a valid grid
  bool is_of_lines = false;       ///< lines in the plane
  CadReport cad;                  ///< of a CAD file
  Brep brep;                      ///< smooth geometry; the surface is then its grid of usual sizes
  BrepGridReport brep_grid;
  std::vector<FacePlace> face_places;  ///< of the brep's faces, by that grid
  bool is_quick = false;  ///< that grid is a coarse one: what is open or large need not be gridded to be told about
  bool is_usable() const { return is_grid || is_of_lines ? !has_errors(findings) : surface.can_bound_volume; }
};

/// @brief A file of any kind that can be read. @param format  instead of by extension
/// @throws InputError  unreadable; neither faces nor volume cells
Inspected inspect_file(const std::string& path, const std::string& format, Context& context);
/// @brief A grid, a surface, or lines in the plane. @param name  in messages, and of patches without one
Inspected inspect_mesh(std::shared_ptr<const Mesh> mesh, const std::string& name, Context& context);
/// @brief Inputs of a job that are gridded together.
Inspected inspect_inputs(const std::vector<std::shared_ptr<const HeldInput>>& inputs, Context& context);

/// @brief All of it as JSON. @param name  file or what it is called
nlohmann::ordered_json facts_json(const std::string& name, const Inspected& it);
/// @brief The facts for people, as `delfront info` shows them.
std::string facts_text(const std::string& name, const Inspected& it);
/// @brief The findings and the quality for people, as `delfront check` shows them.
std::string check_text(const Inspected& it);
/// @return "x.stl cannot bound a volume as it is"
std::string verdict_text(const std::string& name, const Inspected& it);

/// @brief The findings, and the cells, faces and edges that keep gates from being met.
/// @throws UsageError  as failed_gates
std::vector<Finding> findings_with_gates(const Inspected& it, const std::string& gates, Context& context);

}  // namespace delfront
