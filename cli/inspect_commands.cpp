// SPDX-License-Identifier: Apache-2.0
// delfront check and delfront info: look at a surface or a grid and say what it is.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "delfront/brep.hpp"
#include "delfront/cad.hpp"
#include "delfront/errors.hpp"
#include "delfront/geometry_text.hpp"
#include "delfront/io.hpp"
#include "delfront/model.hpp"
#include "delfront/surface_check.hpp"
#include "geometry_facts.hpp"
#include "guard.hpp"
#include "pipeline/boundaries.hpp"
#include "pipeline/geometry_job.hpp"
#include "pipeline/planar_job.hpp"
#include "pipeline/report_json.hpp"

namespace delfront::cli {

namespace {

using Json = nlohmann::ordered_json;

/// What is written must not stand where the file to look at stands.
void check_output(const std::string& path, const std::string& input) {
  if (path.empty() || path == "-") return;
  check_writable(path);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored) && std::filesystem::equivalent(path, input, ignored))
    throw UsageError(path + " is the input and would be overwritten; give the output another name");
}

constexpr std::size_t kManyFaces = 2000;  ///< of geometry whose usual grid would take long

const char* yes_no(bool value) { return value ? "yes" : "no"; }

/// What both commands do first: a file becomes a surface with its report, or a grid with its findings.
struct Inspected {
  Mesh mesh;
  bool is_grid = false;
  SurfaceReport surface;
  std::vector<Finding> findings;  ///< of the surface, or of the grid
  QualityReport quality;          ///< of a valid grid
  bool is_of_lines = false;       ///< lines in the plane
  CadReport cad;                  ///< of a CAD file
  Brep brep;                      ///< smooth geometry; the surface is then its grid of usual sizes
  BrepGridReport brep_grid;
  bool is_quick = false;  ///< that grid is a coarse one: what is open or large need not be gridded to be told about
  bool is_usable() const { return is_grid || is_of_lines ? !has_errors(findings) : surface.can_bound_volume; }
};

Inspected inspect(const std::string& path, const std::string& format, Context& context) {
  Inspected result;
  if (is_smooth_file(path)) {
    result.brep = read_brep(path, context, result.cad);
    result.is_quick = result.cad.free_edges > 0 || result.brep.faces.size() > kManyFaces;
    with_file(path, doubt_of(result.cad),
              [&] { result.mesh = grid_to_look_at(result.brep, result.is_quick, context, result.brep_grid); });
  } else {
    result.mesh = read_mesh(path, context, format);
  }
  const NamedMesh input{result.mesh, std::filesystem::path(path).stem().string()};
  const bool is_planar = is_planar_job({input});
  result.is_of_lines = is_planar && result.mesh.top_dimension() == 1;
  if (result.is_of_lines) {
    result.findings = check_planar_domain(build_planar_domain({input}, context), context);
    return result;
  }
  if (result.mesh.top_dimension() < 2)
    throw InputError(fmt::format("{} has neither faces nor volume cells; there is nothing to look at", path));
  result.is_grid = is_planar || result.mesh.top_dimension() == 3;
  if (result.is_grid) {
    result.findings = check(result.mesh);
    if (!has_errors(result.findings)) result.quality = measure_quality(result.mesh, context);
    return result;
  }
  const Model model = build_model({{result.mesh, std::filesystem::path(path).stem().string()}}, context);
  result.surface = check_surface(model, context);
  if (!result.cad.unit.empty()) result.surface.likely_unit.clear();  // it is known
  result.findings = result.surface.findings;
  result.mesh = surface_mesh(model);  // the facts are those of the welded, triangulated surface
  return result;
}

void print_surface_facts(const SurfaceReport& r) {
  fmt::print("closed         {}; manifold {}; oriented {}; can bound a volume {}\n", yes_no(r.is_closed),
             yes_no(r.is_manifold), yes_no(r.is_oriented), yes_no(r.can_bound_volume));
  fmt::print("area           {:.9g}\n", r.area);
  if (r.is_closed)
    fmt::print("volume         {:.9g}{}\n", std::abs(r.volume),
               r.volume < 0 ? ", inside out: its faces look inwards (they are turned for a grid)" : "");
  fmt::print("edges          {:.4g} to {:.4g}, mean {:.4g}\n", r.min_edge, r.max_edge, r.mean_edge);
  fmt::print("angles         of triangles from {:.3g} deg; between neighbours from {:.3g} deg\n", r.min_angle_deg,
             r.min_dihedral_deg);
  if (!r.likely_unit.empty()) fmt::print("unit           probably {}\n", r.likely_unit);
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(kShown, r.components.size()); ++i) {
    const SurfaceComponent& c = r.components[i];
    fmt::print("component {:<4} {} triangles, {}{}\n", i, with_commas(c.num_triangles),
               c.is_closed ? fmt::format("closed, volume {:.6g}{}", std::abs(c.signed_volume),
                                         c.signed_volume < 0 ? ", faces look inwards" : "")
                           : "open",
               c.inside_of >= 0 ? fmt::format(", inside component {}", c.inside_of) : "");
  }
  if (r.components.size() > kShown) fmt::print("               and {} more components\n", r.components.size() - kShown);
}

/// In which unit, and who says so.
std::string coordinates_of(const Inspected& it) {
  if (!it.cad.unit.empty()) return fmt::format("in {}, as the file says", it.cad.unit);
  if (it.surface.likely_unit.empty()) return "in a unit that the file does not say";
  return fmt::format("the file does not say the unit; probably {}", it.surface.likely_unit);
}

Json facts_json(const std::string& path, const Inspected& it) {
  Json groups = Json::array();
  for (const Group& g : it.mesh.groups)
    groups.push_back({{"name", g.name}, {"dimension", g.dimension}, {"kind", g.kind}});
  Json cells = Json::object();
  for (const CellBlock& block : it.mesh.blocks) cells[name_of(block.type)] = block.size();
  Json json = {
      {"file", path},   {"is_grid", it.is_grid}, {"is_usable", it.is_usable()}, {"num_points", it.mesh.points.size()},
      {"cells", cells}, {"groups", groups}};
  if (it.is_grid) {
    json["findings"] = to_json(it.findings);
    json["quality"] = to_json(it.quality);
  } else if (it.is_of_lines) {
    json["findings"] = to_json(it.findings);
  } else {
    json["surface"] = to_json(it.surface);
    if (!it.brep.faces.empty()) json["geometry"] = geometry_json(it.brep, it.brep_grid, it.cad);
    if (!it.cad.format.empty()) json["geometry"]["cad"]["coordinates"] = coordinates_of(it);
  }
  return json;
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

class CheckCommand : public Command {
 public:
  explicit CheckCommand(CLI::App& parent) {
    app = parent.add_subcommand("check", "Every defect of a surface or a grid, with its place; quality of a grid");
    app->allow_extras();
    app->footer(
        "Exit code: 0 usable, 3 not (a surface that cannot bound a volume, an invalid grid), 5 a gate not met.\n"
        "Examples:\n"
        "  delfront check body.stl --defects defects.vtp\n"
        "  delfront check body.vtu --require \"min_dihedral > 8, max_nonortho < 70\" --json body.json");
    app->add_option("FILE", file_, "surface, grid, or folder of an OpenFOAM case")->required();
    app->add_option("--require", require_, "gates for a grid: \"min_dihedral > 8, max_nonortho < 70\"")
        ->type_name("GATES");
    app->add_option("--defects", defects_, "write all places to this file (.vtp)")->type_name("FILE");
    app->add_option("--json", json_, "write the findings as JSON; - for stdout")->type_name("FILE");
    app->add_option("--format", format_, "file type, instead of by extension")->type_name("FORMAT");
    add_common_flags();
  }

  int run(const std::string&) override {
    Terminal terminal = make_terminal();
    if (is_cad_file(file_))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    prepare(context, terminal);
    for (const std::string& path : {defects_, json_}) check_output(path, file_);
    if (!defects_.empty() && defects_ == json_) throw UsageError("--defects and --json name the same file");
    const Inspected it = inspect(file_, format_, context);
    const bool is_valid_grid = it.is_grid && it.is_usable();
    const std::vector<std::string> failed =
        is_valid_grid ? failed_gates(it.quality, require_) : std::vector<std::string>();
    terminal.clear_bar();
    if (!it.is_grid && !require_.empty())
      terminal.log(LogLevel::warning, "--require is for grids; " + file_ + " is a surface");
    if (terminal.verbosity() >= 0 && json_ != "-") print(it);
    if (!defects_.empty()) write_defects(with_gate_failures(it, failed.empty(), context), defects_, context);
    if (!json_.empty()) {
      Json json = facts_json(file_, it);
      json["failed_gates"] = failed;
      write_json(json_, dump(json));
    }
    if (!it.is_usable()) {
      terminal.error(ExitCode::bad_input, verdict(it), {});
      return static_cast<int>(ExitCode::bad_input);
    }
    for (const std::string& gate : failed) terminal.error(ExitCode::gate_not_met, "gate not met: " + gate, {});
    return static_cast<int>(failed.empty() ? ExitCode::done : ExitCode::gate_not_met);
  }

 private:
  std::vector<Finding> with_gate_failures(const Inspected& it, bool are_met, Context& context) const {
    std::vector<Finding> findings = it.findings;
    if (are_met) return findings;
    for (Finding& failure : find_gate_failures(it.mesh, require_, context)) findings.push_back(std::move(failure));
    return findings;
  }

  std::string verdict(const Inspected& it) const {
    const char* what = it.is_grid       ? "is not a valid grid"
                       : it.is_of_lines ? "cannot be gridded as it is"
                                        : "cannot bound a volume as it is";
    const std::string hint =
        defects_.empty() ? "; --defects FILE.vtp shows all places" : "; all places are in " + defects_;
    return fmt::format("{} {}{}", file_, what, hint);
  }

  static void print(const Inspected& it) {
    if (it.is_grid || it.is_of_lines)
      print_mesh_facts(it.mesh);
    else
      print_surface_facts(it.surface);
    if (it.findings.empty()) fmt::print("findings       none\n");
    print_findings(it.findings);
    if (it.is_grid && it.is_usable()) print_quality(it.quality, 3);
  }

  std::string file_, require_, defects_, json_, format_;
};

class InfoCommand : public Command {
 public:
  explicit InfoCommand(CLI::App& parent) {
    app = parent.add_subcommand("info", "Facts about a file: size, patches, units, closed or not");
    app->allow_extras();
    app->footer(
        "Exit code: 0, or 3 where it cannot be gridded as it is (then: delfront check FILE).\n"
        "Example:\n  delfront info body.stl --json body.json");
    app->add_option("FILE", file_, "surface, grid, or folder of an OpenFOAM case")->required();
    app->add_option("--json", json_, "write the facts as JSON; - for stdout")->type_name("FILE");
    app->add_option("--format", format_, "file type, instead of by extension")->type_name("FORMAT");
    add_common_flags();
  }

  int run(const std::string&) override {
    Terminal terminal = make_terminal();
    if (is_cad_file(file_))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    prepare(context, terminal);
    check_output(json_, file_);
    const Inspected it = inspect(file_, format_, context);
    terminal.clear_bar();
    if (terminal.verbosity() >= 0 && json_ != "-") print(it);
    if (!json_.empty()) write_json(json_, dump(facts_json(file_, it)));
    if (it.is_usable()) return static_cast<int>(ExitCode::done);
    terminal.error(ExitCode::bad_input, verdict(it), {});
    return static_cast<int>(ExitCode::bad_input);
  }

 private:
  std::string verdict(const Inspected& it) const {
    if (it.cad.free_edges == 0 || it.cad.solids > 0)
      return fmt::format("{} cannot be used as it is; 'delfront check' shows where", file_);
    return fmt::format(
        "{} is an open sheet with {} free edge{}: it bounds no volume; its surface can be gridded (delfront mesh "
        "--stop-after surface)",
        file_, it.cad.free_edges, it.cad.free_edges == 1 ? "" : "s");
  }

  void print(const Inspected& it) const {
    fmt::print("file           {}\n", file_);
    if (!it.brep.faces.empty()) print_geometry(it.brep, it.brep_grid, it.cad, it.is_quick);
    print_mesh_facts(it.mesh);
    if (!it.is_grid && !it.is_of_lines) print_surface_facts(it.surface);
    if (it.is_grid && it.is_usable())
      fmt::print("{:<14} {:.9g}\n", it.mesh.dimension == 2 ? "area" : "volume", it.quality.volume);
    for (const Finding& f : it.findings) fmt::print("{:<14} {}: {}\n", severity_name(f.severity), f.kind, f.message);
  }

  std::string file_, json_, format_;
};

}  // namespace

std::unique_ptr<Command> make_check_command(CLI::App& app) { return std::make_unique<CheckCommand>(app); }
std::unique_ptr<Command> make_info_command(CLI::App& app) { return std::make_unique<InfoCommand>(app); }

}  // namespace delfront::cli
