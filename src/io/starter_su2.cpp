// SPDX-License-Identifier: Apache-2.0
// The configuration of SU2 (7 and later). Without boundary layers in the grid the flow is taken as inviscid: what is
// compressible has a far field, everything else is incompressible, driven by its inlets. How to make it viscous stands
// in the file. Keys as in SU2's config_template.cfg.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "io/starter.hpp"

namespace delfront {

namespace {

/// The key of SU2's condition for a kind.
const char* marker_key(const StarterBoundary& boundary) {
  if (boundary.kind == "farfield") return "MARKER_FAR";
  if (boundary.kind == "inlet") return "MARKER_INLET";
  if (boundary.kind == "outlet") return "MARKER_OUTLET";
  if (boundary.kind == "symmetry" || boundary.kind == "empty" || boundary.kind == "wedge") return "MARKER_SYM";
  return "MARKER_EULER";
}

class Su2Starter {
 public:
  Su2Starter(const Mesh& mesh, const std::string& grid, const std::vector<StarterBoundary>& boundaries)
      : mesh_(mesh), grid_(grid), boundaries_(boundaries) {
    is_compressible_ = !names_of("MARKER_FAR").empty();
  }

  std::string text() {
    add(
        fmt::format("% SU2 on {}; every boundary of the grid is named once below.\n"
                    "% SI: coordinates are taken as metres. What is likely to be changed is marked CHANGE.\n"
                    "SOLVER= {}\nMATH_PROBLEM= DIRECT\nRESTART_SOL= NO\nSYSTEM_MEASUREMENTS= SI\n\n",
                    grid_, is_compressible_ ? "EULER" : "INC_EULER"));
    add_flow();
    add_reference();
    add_markers();
    add_viscous_hint();
    add_numerics();
    return std::move(text_);
  }

 private:
  void add(const std::string& piece) { text_ += piece; }

  std::vector<std::string> names_of(const std::string& key) const {
    std::vector<std::string> names;
    for (const StarterBoundary& boundary : boundaries_)
      if (marker_key(boundary) == key) names.push_back(boundary.name);
    return names;
  }

  /// The way in where there is an inlet, else along x.
  Point direction() const {
    for (const StarterBoundary& boundary : boundaries_)
      if (boundary.kind == "inlet") return boundary.inward;
    return {1, 0, 0};
  }

  void add_flow() {
    if (is_compressible_) {
      add(fmt::format(
          "% The free stream. CHANGE Mach number and angles (degrees); AOA turns the flow in the {} plane.\n"
          "MACH_NUMBER= 0.3\nAOA= 0.0\nSIDESLIP_ANGLE= 0.0\n"
          "FREESTREAM_PRESSURE= 101325.0\nFREESTREAM_TEMPERATURE= 288.15\n",
          mesh_.dimension == 2 ? "x-y" : "x-z"));
      if (!names_of("MARKER_INLET").empty()) add("INLET_TYPE= TOTAL_CONDITIONS\n");
      add("\n");
      return;
    }
    const Point u = starter::kSpeed * direction();
    add(
        fmt::format("% Air, m/s and kg/m^3. CHANGE the velocity here and at the inlets.\n"
                    "INC_DENSITY_MODEL= CONSTANT\nINC_ENERGY_EQUATION= NO\nINC_DENSITY_INIT= 1.225\n"
                    "INC_VELOCITY_INIT= ( {}, {}, {} )\nINC_TEMPERATURE_INIT= 288.15\n",
                    u.x, u.y, u.z));
    const auto add_types = [&](const char* key, const char* type, std::size_t count) {
      if (count > 0) add(fmt::format("{}= {}\n", key, fmt::join(std::vector<std::string>(count, type), ", ")));
    };
    add_types("INC_INLET_TYPE", "VELOCITY_INLET", names_of("MARKER_INLET").size());
    add_types("INC_OUTLET_TYPE", "PRESSURE_OUTLET", names_of("MARKER_OUTLET").size());
    add("\n");
  }

  void add_reference() {
    add("% CHANGE: of the coefficients; metres, square metres (0: the area is computed from the grid).\n"
        "REF_ORIGIN_MOMENT_X= 0.0\nREF_ORIGIN_MOMENT_Y= 0.0\nREF_ORIGIN_MOMENT_Z= 0.0\n"
        "REF_LENGTH= 1.0\nREF_AREA= 0\n\n");
  }

  std::string entry(const StarterBoundary& boundary) const {
    const Point& n = boundary.inward;
    if (boundary.kind == "inlet")
      return is_compressible_
                 ? fmt::format("{}, 293.34, 107853.0, {}, {}, {}", boundary.name, n.x, n.y, n.z)
                 : fmt::format("{}, 288.15, {}, {}, {}, {}", boundary.name, starter::kSpeed, n.x, n.y, n.z);
    if (boundary.kind == "outlet") return fmt::format("{}, {}", boundary.name, is_compressible_ ? "101325.0" : "0.0");
    return boundary.name;
  }

  void add_markers() {
    const char* inlet = is_compressible_ ? "name, total temperature (K), total pressure (Pa), direction x y z"
                                         : "name, temperature (K), velocity (m/s), direction x y z";
    const std::pair<const char*, std::string> keys[] = {{"MARKER_EULER", "Walls, no flow through."},
                                                        {"MARKER_FAR", "Far field."},
                                                        {"MARKER_SYM", "Symmetry planes."},
                                                        {"MARKER_INLET", fmt::format("Inlets: {}.", inlet)},
                                                        {"MARKER_OUTLET", "Outlets: name, static pressure (Pa)."}};
    for (const auto& [key, comment] : keys) {
      std::vector<std::string> entries;
      std::string notes;
      for (const StarterBoundary& boundary : boundaries_) {
        if (std::string_view(marker_key(boundary)) != key) continue;
        entries.push_back(entry(boundary));
        if (const std::string note = wall_note(boundary, "CHANGE,"); !note.empty())
          notes += fmt::format("% {}:{}\n", boundary.name, note);
        if (boundary.kind == "empty" || boundary.kind == "wedge")
          notes += fmt::format("% {}: of kind {}, which SU2 has not\n", boundary.name, boundary.kind);
      }
      if (!entries.empty()) add(fmt::format("% {}\n{}{}= ( {} )\n", comment, notes, key, fmt::join(entries, ", ")));
    }
    const std::vector<std::string> walls = names_of("MARKER_EULER");
    if (!walls.empty())
      add(
          fmt::format("% Where forces are summed up, and what goes to the surface files.\n"
                      "MARKER_MONITORING= ( {0} )\nMARKER_PLOTTING= ( {0} )\n",
                      fmt::join(walls, ", ")));
    add("\n");
  }

  void add_viscous_hint() {
    std::vector<std::string> walls;
    for (const std::string& name : names_of("MARKER_EULER")) walls.push_back(name + ", 0.0");
    if (walls.empty()) return;
    add(
        fmt::format("% Viscous, on a grid with boundary layers: instead of SOLVER and MARKER_EULER above\n"
                    "% SOLVER= {}\n% KIND_TURB_MODEL= SA\n",
                    is_compressible_ ? "RANS" : "INC_RANS"));
    if (is_compressible_)
      add("% REYNOLDS_NUMBER= 1e6\n% REYNOLDS_LENGTH= 1.0\n% CONV_NUM_METHOD_TURB= SCALAR_UPWIND\n");
    else
      add("% VISCOSITY_MODEL= CONSTANT_VISCOSITY\n% MU_CONSTANT= 1.8e-5\n% CONV_NUM_METHOD_TURB= SCALAR_UPWIND\n");
    add(fmt::format("% MARKER_HEATFLUX= ( {} )\n\n", fmt::join(walls, ", ")));
  }

  void add_numerics() {
    add(fmt::format("% Cautious settings for grids of {}.\n", mesh_.dimension == 2 ? "triangles" : "tetrahedra"));
    add("NUM_METHOD_GRAD= WEIGHTED_LEAST_SQUARES\nCFL_NUMBER= 5.0\nCFL_ADAPT= NO\nMGLEVEL= 0\n");
    add(is_compressible_ ? "CONV_NUM_METHOD_FLOW= JST\nJST_SENSOR_COEFF= ( 0.5, 0.02 )\n"
                         : "CONV_NUM_METHOD_FLOW= FDS\nMUSCL_FLOW= YES\nSLOPE_LIMITER_FLOW= VENKATAKRISHNAN\n"
                           "VENKAT_LIMITER_COEFF= 0.05\n");
    const char* residual = is_compressible_ ? "RMS_DENSITY" : "RMS_PRESSURE";
    add(fmt::format(
        "TIME_DISCRE_FLOW= EULER_IMPLICIT\n"
        "LINEAR_SOLVER= FGMRES\nLINEAR_SOLVER_PREC= ILU\nLINEAR_SOLVER_ERROR= 1E-4\nLINEAR_SOLVER_ITER= 10\n"
        "ITER= 1000\nCONV_FIELD= {0}\nCONV_RESIDUAL_MINVAL= -8\nCONV_STARTITER= 10\n\n"
        "MESH_FILENAME= {1}\nMESH_FORMAT= SU2\nTABULAR_FORMAT= CSV\n"
        "OUTPUT_FILES= ( RESTART, PARAVIEW, SURFACE_PARAVIEW )\n"
        "SCREEN_OUTPUT= ( INNER_ITER, {0}, LIFT, DRAG )\n",
        residual, grid_));
  }

  const Mesh& mesh_;
  std::string grid_;
  const std::vector<StarterBoundary>& boundaries_;
  bool is_compressible_ = false;
  std::string text_;
};

}  // namespace

StarterFile su2_starter(const Mesh& mesh, const std::string& path, const std::vector<StarterBoundary>& boundaries) {
  const std::filesystem::path grid(path);
  StarterFile file;
  file.path = std::filesystem::path(path).replace_extension(".cfg").string();
  file.text = Su2Starter(mesh, grid.filename().string(), boundaries).text();
  file.names_boundaries = true;
  return file;
}

}  // namespace delfront
