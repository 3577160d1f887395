// SPDX-License-Identifier: Apache-2.0
// An OpenFOAM case for potentialFoam, then simpleFoam: incompressible, steady. k-omega SST with wall functions where
// the grid has patches of type wall (wall functions and the distance to walls need that type), laminar elsewhere.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "delfront/errors.hpp"
#include "io/foam_case.hpp"
#include "io/foam_text.hpp"
#include "io/names.hpp"
#include "io/source.hpp"
#include "io/starter.hpp"

namespace delfront {

namespace {

/// A type that every field must have too.
bool is_constraint(const std::string& type) { return type == "symmetry" || type == "empty" || type == "wedge"; }

/// Kinds by the names that the grid's file has; a baffle's two sides have its group's.
std::map<std::string, GroupId> groups_by_name(const Mesh& mesh) {
  std::vector<std::string> said_by_the_writer;
  const std::vector<std::string> names =
      fit_names(mesh, NameRule::foam_word, "OpenFOAM", said_by_the_writer, {mesh.dimension - 1, mesh.dimension});
  std::map<std::string, GroupId> groups;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (mesh.groups[GroupId(i)].dimension != mesh.dimension - 1) continue;
    groups.emplace(names[i], GroupId(i));
    for (const char* side : {"_master", "_slave"})
      if (mesh.groups[GroupId(i)].two_sided) groups.emplace(names[i] + side, GroupId(i));
  }
  return groups;
}

class FoamStarter {
 public:
  FoamStarter(std::string folder, const std::vector<StarterBoundary>& boundaries)
      : folder_(std::move(folder)), boundaries_(boundaries) {
    const auto has_kind = [&](const char* kind) {
      return std::any_of(boundaries.begin(), boundaries.end(), [&](const auto& b) { return b.kind == kind; });
    };
    has_far_field_ = has_kind("farfield");
    is_turbulent_ = std::any_of(boundaries.begin(), boundaries.end(),
                                [](const StarterBoundary& b) { return b.patch_type == "wall"; });
    velocity_ = {has_far_field_ ? starter::kSpeed : 0, 0, 0};
  }

  std::vector<StarterFile> files() {
    add_velocity();
    add_pressure();
    if (has_far_field_) add_potential();
    if (is_turbulent_) add_turbulence();
    add_constant();
    add_system();
    return std::move(files_);
  }

 private:
  void add(const std::string& location, const char* name, const char* kind, const std::string& text,
           bool names_boundaries = false) {
    files_.push_back({fmt::format("{}/{}/{}", folder_, location, name), foam_header(kind, location, name) + text,
                      names_boundaries, location == "system" ? minimal_system_file(name) : ""});
  }

  /// @param condition  the entries of a boundary whose patch type leaves the choice
  template <class Condition>
  void add_field(const char* name, const char* kind, const std::string& head, const Condition& condition) {
    std::string text = head + "\nboundaryField\n{\n";
    for (const StarterBoundary& boundary : boundaries_) {
      const std::string entries =
          is_constraint(boundary.patch_type) ? fmt::format("type {};", boundary.patch_type) : condition(boundary);
      text += fmt::format("    {:<15} {{ {} }}{}\n", boundary.name, entries, wall_note(boundary, "// CHANGE,"));
    }
    add("0", name, kind, text + "}\n", true);
  }

  static std::string vector_text(const Point& v) { return fmt::format("({} {} {})", v.x, v.y, v.z); }

  void add_velocity() {
    const std::string head = fmt::format(
        "// m/s. CHANGE the velocity here and where fixedValue and freestream conditions give it.\n"
        "dimensions      [0 1 -1 0 0 0 0];\ninternalField   uniform {};\n",
        vector_text(velocity_));
    add_field("U", "volVectorField", head, [&](const StarterBoundary& b) -> std::string {
      if (b.kind == "inlet")
        return fmt::format("type fixedValue; value uniform {};", vector_text(starter::kSpeed * b.inward));
      if (b.kind == "outlet") return "type inletOutlet; inletValue uniform (0 0 0); value uniform (0 0 0);";
      if (b.kind == "farfield")
        return fmt::format("type freestreamVelocity; freestreamValue uniform {};", vector_text(velocity_));
      return "type noSlip;";
    });
  }

  void add_pressure() {
    add_field("p", "volScalarField",
              "// Over density, m^2/s^2.\ndimensions      [0 2 -2 0 0 0 0];\ninternalField   uniform 0;\n",
              [](const StarterBoundary& b) -> std::string {
                if (b.kind == "outlet") return "type fixedValue; value uniform 0;";
                if (b.kind == "farfield") return "type freestreamPressure; freestreamValue uniform 0;";
                return "type zeroGradient;";
              });
  }

  /// potentialFoam would fix Phi wherever p fixes its value, and the flow through the far field would be none.
  void add_potential() {
    add_field("Phi", "volScalarField",
              "// Velocity potential, of potentialFoam only: the far field's velocity is that of U.\n"
              "dimensions      [0 2 -1 0 0 0 0];\ninternalField   uniform 0;\n",
              [](const StarterBoundary& b) -> std::string {
                return b.kind == "outlet" ? "type fixedValue; value uniform 0;" : "type zeroGradient;";
              });
  }

  void add_turbulence() {
    const double rms = starter::kSpeed * starter::kIntensity;
    const double k = 1.5 * rms * rms;
    const double omega = k / (starter::kViscosityRatio * starter::kViscosity);
    const auto inflow = [](const char* wall_function) {
      return [wall_function](const StarterBoundary& b) -> std::string {
        if (b.kind == "inlet") return "type fixedValue; value $internalField;";
        if (b.kind == "outlet" || b.kind == "farfield")
          return "type inletOutlet; inletValue $internalField; value $internalField;";
        if (b.patch_type == "wall") return fmt::format("type {}; value $internalField;", wall_function);
        return "type zeroGradient;";
      };
    };
    add_field("k", "volScalarField",
              fmt::format("// 3/2 (intensity {} x speed {} m/s)^2. CHANGE with the velocity.\n"
                          "dimensions      [0 2 -2 0 0 0 0];\ninternalField   uniform {:.6g};\n",
                          starter::kIntensity, starter::kSpeed, k),
              inflow("kqRWallFunction"));
    add_field("omega", "volScalarField",
              fmt::format("// k / nut, with nut {} times the viscosity. CHANGE with k.\n"
                          "dimensions      [0 0 -1 0 0 0 0];\ninternalField   uniform {:.6g};\n",
                          starter::kViscosityRatio, omega),
              inflow("omegaWallFunction"));
    add_field("nut", "volScalarField",
              "// Computed from k and omega.\ndimensions      [0 2 -1 0 0 0 0];\ninternalField   uniform 0;\n",
              [](const StarterBoundary& b) -> std::string {
                return fmt::format("type {}; value uniform 0;",
                                   b.patch_type == "wall" ? "nutkWallFunction" : "calculated");
              });
  }

  void add_constant() {
    add("constant", "transportProperties", "dictionary",
        fmt::format("// Air; coordinates are taken as metres. CHANGE for another fluid, m^2/s.\n"
                    "transportModel  Newtonian;\nnu              {:.6g};\n",
                    starter::kViscosity));
    add("constant", "turbulenceProperties", "dictionary",
        is_turbulent_
            ? "simulationType  RAS;\nRAS\n{\n    RASModel        kOmegaSST;\n    turbulence      on;\n"
              "    printCoeffs     on;\n}\n"
            : "// No patch is of type wall. CHANGE: with walls (boundaries.NAME.kind = \"wall\") this would be\n"
              "// RAS with kOmegaSST, and 0/ would hold k, omega and nut.\nsimulationType  laminar;\n");
  }

  /// Coefficients of the force on boundaries of kind wall; a floor among them is the user's to leave out.
  std::string forces() const {
    std::vector<std::string> walls;
    for (const StarterBoundary& boundary : boundaries_)
      if (boundary.patch_type == "wall") walls.push_back(boundary.name);
    if (walls.empty()) return "";
    return fmt::format(
        "functions\n{{\n    // Coefficients of the force on these patches, in postProcessing/. CHANGE: leave out "
        "floors and sides;\n"
        "    // directions, speed (m/s), reference length (m) and area (m^2) are yours to say.\n"
        "    forces\n    {{\n        type forceCoeffs; libs (\"libforces.so\");\n        patches ({});\n"
        "        rho rhoInf; rhoInf 1.2; magUInf {}; lRef 1; Aref 1;\n"
        "        dragDir (1 0 0); liftDir (0 0 1); pitchAxis (0 1 0); CofR (0 0 0);\n    }}\n}}\n",
        fmt::join(walls, " "), starter::kSpeed);
  }

  void add_system() {
    add("system", "controlDict", "dictionary",
        "// simpleFoam starts from 0/U as it is; potentialFoam before it overwrites 0/U. CHANGE endTime: iterations.\n"
        "application     simpleFoam;\nstartFrom       startTime;\nstartTime       0;\nstopAt          endTime;\n"
        "endTime         500;\ndeltaT          1;\nwriteControl    timeStep;\nwriteInterval   100;\npurgeWrite      "
        "2;\n"
        "writeFormat     ascii;\nwritePrecision  8;\nwriteCompression off;\ntimeFormat      general;\n"
        "timePrecision   6;\nrunTimeModifiable true;\n" +
            forces());
    add("system", "fvSchemes", "dictionary",
        "// Cautious, for grids of tetrahedra: limited gradients, half of the correction for non-orthogonality.\n"
        "ddtSchemes { default steadyState; }\n"
        "gradSchemes { default Gauss linear; grad(U) cellLimited Gauss linear 1; grad(k) cellLimited Gauss linear 1;\n"
        "              grad(omega) cellLimited Gauss linear 1; }\n"
        "divSchemes\n{\n    default none;\n    div(phi,U) bounded Gauss linearUpwind grad(U);\n"
        "    div(phi,k) bounded Gauss upwind;\n    div(phi,omega) bounded Gauss upwind;\n"
        "    div((nuEff*dev2(T(grad(U))))) Gauss linear;\n    div(div(phi,U)) Gauss linear;\n}\n"
        "laplacianSchemes { default Gauss linear limited corrected 0.5; }\n"
        "interpolationSchemes { default linear; }\nsnGradSchemes { default limited corrected 0.5; }\n"
        "wallDist { method meshWave; }\n");
    add("system", "fvSolution", "dictionary",
        "solvers\n{\n    p { solver GAMG; smoother GaussSeidel; tolerance 1e-8; relTol 0.05; }\n    Phi { $p; relTol "
        "0.01; }\n"
        "    \"(U|k|omega)\" { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-8; relTol 0.1; }\n}\n"
        "SIMPLE\n{\n    nNonOrthogonalCorrectors 1;\n    consistent no;\n"
        "    // Used only where no patch fixes the pressure.\n    pRefCell 0;\n    pRefValue 0;\n"
        "    residualControl { p 1e-4; U 1e-5; \"(k|omega)\" 1e-5; }\n}\n"
        "potentialFlow { nNonOrthogonalCorrectors 10; PhiRefCell 0; PhiRefValue 0; pRefCell 0; pRefValue 0; }\n"
        "relaxationFactors\n{\n    fields { p 0.3; }\n    equations { U 0.6; \"(k|omega)\" 0.5; }\n}\n");
  }

  std::string folder_;
  const std::vector<StarterBoundary>& boundaries_;
  bool has_far_field_ = false, is_turbulent_ = false;
  Point velocity_;
  std::vector<StarterFile> files_;
};

}  // namespace

std::vector<StarterBoundary> foam_boundaries(const Mesh& mesh, const std::string& folder) {
  const std::string path = folder + "/constant/polyMesh/boundary";
  const FileBytes bytes(path);
  FoamText text(bytes.view(), path);
  text.header("polyBoundaryMesh");
  const std::map<std::string, GroupId> groups = groups_by_name(mesh);
  std::vector<StarterBoundary> boundaries(text.count("number of patches", 4));
  text.expect("(");
  for (StarterBoundary& boundary : boundaries) {
    boundary.name = text.next();
    text.expect("{");
    for (std::string_view key = text.next(); key != "}"; key = text.next()) {
      if (key.empty()) text.fail("a patch has no end; the file is truncated");
      if (key == "type") boundary.patch_type = text.peek();
      text.skip_entry();
    }
    const auto found = groups.find(boundary.name);
    if (found != groups.end()) boundary.kind = mesh.groups[found->second].kind;
    if (boundary.kind.empty() && boundary.patch_type != "patch") boundary.kind = boundary.patch_type;
    if (boundary.kind == "inlet") boundary.inward = inward_direction(mesh, found->second);
  }
  text.expect(")");
  return boundaries;
}

std::vector<StarterFile> foam_starter(const std::string& folder, const std::vector<StarterBoundary>& boundaries) {
  return FoamStarter(folder, boundaries).files();
}

}  // namespace delfront
