// SPDX-License-Identifier: Apache-2.0
// What is wrong with a job is said before any work, with the key and the place where it was set.
#include "pipeline/job_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "delfront/errors.hpp"
#include "delfront/geometry_text.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/io.hpp"
#include "io/grid_files.hpp"
#include "pipeline/geometry_job.hpp"
#include "pipeline/option_table.hpp"
#include "pipeline/quantities.hpp"
#include "pipeline/report_files.hpp"
#include "pipeline/run.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

/// The gates' measures are those of volume cells, or of triangles.
bool are_planar_gates(const std::string& gates) {
  Mesh cell;
  cell.dimension = 2;
  cell.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  cell.block(CellType::triangle).vertices = {VertexId(0), VertexId(1), VertexId(2)};
  cell.block(CellType::triangle).group = {cell.add_group(2, "cell")};
  Context quiet;
  try {
    failed_gates(measure_quality(cell, quiet), gates);
    return true;
  } catch (const UsageError&) {
    return false;
  }
}

/// Malformed gates and unknown measures are refused before the work: tried on grids of one cell.
void try_gates(const std::string& gates) {
  if (gates.empty() || are_planar_gates(gates)) return;
  Mesh cell;
  cell.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cell.block(CellType::tetrahedron).vertices = {VertexId(0), VertexId(1), VertexId(2), VertexId(3)};
  cell.block(CellType::tetrahedron).group = {cell.add_group(3, "cell")};
  Context quiet;
  failed_gates(measure_quality(cell, quiet), gates);
}

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const bool is_device = fs::exists(a, ignored) && !fs::is_regular_file(a, ignored) && !fs::is_directory(a, ignored);
  if (is_device) return false;  // such as /dev/null
  fs::path whole_a = fs::weakly_canonical(a, ignored), whole_b = fs::weakly_canonical(b, ignored);
  for (fs::path* whole : {&whole_a, &whole_b})
    if (!whole->has_filename()) *whole = whole->parent_path();  // a case folder's name ends in '/' only if it is new
  return !whole_a.empty() && whole_a == whole_b;
}

/// Whether a path is that of a file of a case, or of a starter file: those of the run itself.
bool is_of_grid(const Options& options, const std::string& path, const std::string& grid) {
  const std::string& format = format_of(grid, options.output.format, true).name;
  if (format == "su2" && options.output.solver == "su2")
    return is_same_file(path, fs::path(grid).replace_extension(".cfg").string());
  if (format != "openfoam") return false;
  std::error_code ignored;
  const fs::path below = fs::weakly_canonical(path, ignored).lexically_relative(fs::weakly_canonical(grid, ignored));
  return !below.empty() && (*below.begin() == "constant" || *below.begin() == "system" || *below.begin() == "0");
}

/// What the grid consists of and its solver's files are written by the run, too.
void check_stands_beside(const Options& options, const std::string& path, const std::string& key) {
  for (const std::string& grid : options.output.files)
    if (!path.empty() && is_of_grid(options, path, grid))
      throw usage_error(options, key, fmt::format("{} is one of the files of {}; give it another name", path, grid));
}

/// No file may be written over an input or over another output of the same run.
void check_files_differ(const Options& options) {
  std::vector<std::string> inputs = options.input.files, taken;
  if (!options.refine.geometry.empty()) inputs.push_back(options.refine.geometry);
  for (std::size_t i = 0, given = inputs.size(); i < given; ++i)
    for (const std::string& file : files_read_as(inputs[i])) inputs.push_back(file);
  for (const std::string& job : job_files(options)) inputs.push_back(job);
  const auto add = [&](const std::string& path, const std::string& key) {
    if (path.empty()) return;
    const std::string* const input = find_same_file(path, inputs);
    const std::string* const other = input ? input : find_same_file(path, taken);
    if (other)
      throw usage_error(options, key,
                        fmt::format("{} would be written over {}, {} of the same run; give it another name", path,
                                    *other, input ? "an input" : "a file"));
    taken.push_back(path);
  };
  if (writes_grid(options))
    for (std::size_t i = 0; i < options.output.files.size(); ++i)
      for (const std::string& file : files_written_as(options.output.files[i], options.output.format))
        add(file, fmt::format("output.files[{}]", i));
  for (const std::string& path : report_files(options.output.report)) add(path, "output.report");
  add(options.output.defects, "output.defects");
  if (writes_grid(options)) check_stands_beside(options, options.output.report, "output.report");
  if (writes_grid(options)) check_stands_beside(options, options.output.defects, "output.defects");
}

/// A grid without its cells is never written under the asked name.
void check_holds_cells(const Options& options, const std::string& path) {
  if (options.stop_after == "surface" || options.volume.method == "none") return;
  const std::string& name = format_of(path, options.output.format, true).name;
  for (const char* surface_only : {"stl", "obj", "ply", "off", "vtp"})
    if (name == surface_only)
      throw UsageError(
          fmt::format("{}: {} holds surfaces only, and the result is a grid of cells; write vtu, msh, mesh, "
                      "su2 or an OpenFOAM case (or the surface alone: --stop-after surface)",
                      path, name));
}

void check_domain(const Options& options) {
  const EncloseOptions& enclose = options.domain.enclose;
  if (has_far_field(options) && !enclose.corners && enclose.size.value <= 0)
    throw UsageError(place_of_key(options, "domain.enclose.shape") +
                     "domain.enclose.size: the size of the far field is missing, e.g. size = \"20c\"");
  if (enclose.shape == "sphere" && enclose.corners)
    throw usage_error(options, "domain.enclose.corners", "a sphere has none; give size, or shape = \"box\"");
  if (enclose.h && !has_far_field(options))
    throw usage_error(options, "domain.enclose.h", "there is no far field; add e.g. --farfield box:10c");
}

/// Starter files stand beside a grid that the solver reads.
void check_solver(const Options& options) {
  const std::string& solver = options.output.solver;
  if (solver.empty()) return;
  const auto& files = options.output.files;
  if (std::any_of(files.begin(), files.end(),
                  [&](const std::string& path) { return format_of(path, options.output.format, true).name == solver; }))
    return;
  throw usage_error(options, "output.solver",
                    solver == "openfoam"
                        ? "openfoam needs an output that is an OpenFOAM case, a name ending in /: -o case/"
                        : "su2 needs an output that SU2 reads: -o grid.su2");
}

void check_files(const Options& options, const JobExtras& extras) {
  std::size_t smooth = 0;
  for (std::size_t i = 0; i < options.input.files.size(); ++i) {
    const std::string& path = options.input.files[i];
    if (is_smooth_input(path, extras))
      ++smooth;
    else if (!extras.held.contains(path))
      with_place(options, fmt::format("input.files[{}]", i), [&] { format_of(path); });
  }
  if (options.surface.method == "delaunay" && smooth > 0 && smooth == options.input.files.size())
    throw usage_error(options, "surface.method", "delaunay is for facets; smooth geometry takes mapped or front");
  for (const BoundaryOptions& boundary : options.boundaries)
    if (boundary.selects_faces() && smooth != 1)
      throw usage_error(options, "boundaries." + boundary.name + ".select",
                        "faces are selected in one file of smooth geometry (CAD, .geom.toml); facets and several files "
                        "are selected by name");
  if (options.surface.method == "mapped" && smooth == 0)
    throw usage_error(
        options, "surface.method",
        fmt::format("mapped is for smooth geometry ({}); facets take keep, front or delaunay", kGeometrySuffix));
  if (writes_grid(options) && !options.output.format.empty())
    with_place(options, "output.format", [&] { format_of("", options.output.format, true); });
  for (std::size_t i = 0; writes_grid(options) && i < options.output.files.size(); ++i)
    with_place(options, fmt::format("output.files[{}]", i), [&] {
      const std::string& path = options.output.files[i];
      format_of(path, options.output.format, true);
      check_holds_cells(options, path);
      check_writable(path);
    });
  if (writes_grid(options)) check_solver(options);
  if (options.output.report == "-")
    throw usage_error(options, "output.report", "it goes to a file, not to the terminal; give it a name");
  for (const std::string& path : report_files(options.output.report))
    with_place(options, "output.report", [&] { check_writable(path); });
  if (const std::string& path = options.output.defects; !path.empty())
    with_place(options, "output.defects", [&] { check_writable(path); });
  check_files_differ(options);
}

}  // namespace

std::vector<std::string> job_files(const Options& options) {
  std::set<std::string> files;
  for (const auto& [key, place] : options.set_at) {
    std::string file = place.substr(0, place.find_last_not_of("0123456789") + 1);
    if (file.size() < place.size() && file.ends_with(':')) file.pop_back();
    std::error_code ignored;
    for (const std::string& name : {place, file})
      if (fs::is_regular_file(name, ignored)) files.insert(name);
  }
  return {files.begin(), files.end()};
}

void refuse_to_overwrite(const std::string& input, const std::string& input_format,
                         const std::vector<std::string>& written) {
  std::error_code ignored;
  for (const std::string& output : written)
    for (const std::string& read : files_read_as(input, input_format))
      if (!read.empty() && fs::equivalent(read, output, ignored))
        throw UsageError(fmt::format("{} is {} and would be overwritten; give the output another name", output,
                                     read == input ? "an input" : "a file of the input " + input));
}

const std::string* find_same_file(const std::string& path, const std::vector<std::string>& others) {
  const auto found =
      std::find_if(others.begin(), others.end(), [&](const std::string& other) { return is_same_file(path, other); });
  return found == others.end() ? nullptr : &*found;
}

static void check_sizes(const Options& options) {
  constexpr std::size_t kMostCells = 200;  // cubed, of six tetrahedra each
  if (options.size.adaptive.cells > kMostCells)
    throw usage_error(
        options, "size.adaptive.cells",
        fmt::format("{} cells a side are too many to begin with; give {} or less (8 is usual), the grid is "
                    "refined where sizes ask for it",
                    options.size.adaptive.cells, kMostCells));
  const BackgroundFileOptions& background = options.size.background;
  if (background.file.empty() && (background.combine != "min" || !background.metric.empty() || background.factor != 1))
    throw usage_error(options, background.combine != "min" ? "size.background.combine" : "size.background.factor",
                      "there is no background grid; name one: size.background.file");
  const SolutionFileOptions& solution = options.size.solution;
  if (solution.file.empty()) return;
  if (solution.stretched && options.volume.method != "front" && options.planar.method != "front")
    throw usage_error(options, "size.solution.stretched",
                      "only the front makes stretched cells, and cells as small as their least size would be many "
                      "times those asked for; leave it out, or ask for volume.method (in the plane planar.method) = "
                      "\"front\"");
  if (solution.indicator == "hessian" && solution.complexity == 0)
    throw UsageError(place_of_key(options, "size.solution.file") +
                     "size.solution.complexity is missing: how fine the grid is to be, about a tenth of the wanted "
                     "number of tetrahedra (in the plane 0.4 of that of triangles)");
}

static void check_levels(const Options& options) {
  constexpr int kMostLevels = 8;
  const LevelOptions& refine = options.refine;
  if (refine.levels > kMostLevels)
    throw usage_error(options, "refine.levels",
                      fmt::format("{} levels would make 8^{} of every cell; give {} or fewer (1 or 2 are usual)",
                                  refine.levels, refine.levels, kMostLevels));
  if (refine.geometry.empty()) return;
  if (refine.levels == 0)
    throw usage_error(options, "refine.geometry", "there is no new point to put on it; say how often: refine.levels");
  with_place(options, "refine.geometry", [&] { format_of(refine.geometry); });
}

void check_output_units(const Options& options) {
  if (!options.output.units.empty() && metres_per_unit(options.input.units) == 0)
    throw usage_error(options, "output.units", "the unit of the input is not known; say it with --units (input.units)");
}

void check_job(const Options& options, const JobExtras& extras) {
  if (options.input.files.empty() && options.planar.curves.empty())
    throw UsageError("no input: name a surface file (STL, OBJ, PLY, OFF, …)");
  if (writes_grid(options) && options.output.files.empty() && !extras.wants_result)
    throw UsageError("no output: say where the grid goes, e.g. -o grid.vtu (or --stop-after geometry to look only)");
  check_domain(options);
  check_sizes(options);
  check_levels(options);
  const auto& files = options.input.files;
  if (std::none_of(files.begin(), files.end(), [](const std::string& file) { return is_cad_file(file); }))
    check_output_units(options);  // CAD may say its unit
  with_place(options, "output.require", [&] { try_gates(options.output.require); });
  check_files(options, extras);
}

/// Of sources, boxes and names; errors are said with the entry's place.
static void resolve_entries(Options& options, const LengthScale& scale) {
  const auto resolve = [&](const std::string& entry, const char* name, auto& length) {
    const std::string key = fmt::format("{}.{}", entry, name);
    if constexpr (std::is_same_v<std::decay_t<decltype(length)>, Length>)
      with_place(options, key, [&] { length = Length{resolve_length(length, scale), ""}; });
    else if (length)
      with_place(options, key, [&] { length = Length{resolve_length(*length, scale), ""}; });
  };
  for (std::size_t i = 0; i < options.size.sources.size(); ++i) {
    const std::string entry = fmt::format("size.source[{}]", i);
    SourceOptions& source = options.size.sources[i];
    resolve(entry, "delta0", source.delta0);
    resolve(entry, "r0", source.r0);
    resolve(entry, "r1", source.r1);
  }
  for (std::size_t i = 0; i < options.size.boxes.size(); ++i) {
    const std::string entry = fmt::format("size.box[{}]", i);
    SizeBoxOptions& box = options.size.boxes[i];
    resolve(entry, "h", box.h);
    resolve(entry, "radius", box.radius);
    resolve(entry, "radius_to", box.radius_to);
  }
  for (SizeOnOptions& on : options.size.on) resolve("size.on." + on.name, "h", on.h);
}

void resolve_lengths(Options& options, const LengthScale& scale) {
  const auto resolve = [&](const char* key, auto& length) {
    if (length) with_place(options, key, [&] { length = Length{resolve_length(*length, scale), ""}; });
  };
  resolve("size.hmin", options.size.hmin);
  resolve("size.hmax", options.size.hmax);
  resolve("domain.enclose.h", options.domain.enclose.h);
  resolve("size.deviation", options.size.deviation);
  resolve("size.gap.hmin", options.size.gap.hmin);
  resolve("size.proximity.hmin", options.size.proximity.hmin);
  resolve_entries(options, scale);
  EncloseOptions& enclose = options.domain.enclose;
  if (enclose.size.value > 0)
    with_place(options, "domain.enclose.size", [&] { enclose.size = {resolve_length(enclose.size, scale), ""}; });
  if (options.size.hmin && options.size.hmax && options.size.hmin->value > options.size.hmax->value) {
    const std::string other = place_of_key(options, "size.hmax");
    throw usage_error(
        options, "size.hmin",
        fmt::format("{:g} is above size.hmax, which is {:g}{}", options.size.hmin->value, options.size.hmax->value,
                    other.empty() ? "" : fmt::format(" ({})", other.substr(0, other.size() - 2))));
  }
}

}  // namespace delfront
