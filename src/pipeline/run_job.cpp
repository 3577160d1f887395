// SPDX-License-Identifier: Apache-2.0
// A whole job. The steps stand in `work`; everything around it sees to it that however they end, the result, the
// defects file and the report say so.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>

#include "base/name_pattern.hpp"
#include "base/report_name.hpp"
#include "delfront/errors.hpp"
#include "delfront/geometry_text.hpp"
#include "delfront/io.hpp"
#include "delfront/job.hpp"
#include "geometry/enclose.hpp"
#include "pipeline/boundaries.hpp"
#include "pipeline/face_selectors.hpp"
#include "pipeline/geometry_job.hpp"
#include "pipeline/job_checks.hpp"
#include "pipeline/job_leavings.hpp"
#include "pipeline/job_sizes.hpp"
#include "pipeline/levels.hpp"
#include "pipeline/option_table.hpp"
#include "pipeline/patch_colours.hpp"
#include "pipeline/planar_job.hpp"
#include "pipeline/quantities.hpp"
#include "pipeline/report_files.hpp"
#include "pipeline/run.hpp"
#include "pipeline/size_survey.hpp"
#include "pipeline/surface_job.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

/// FNV-1a, 64 bits: tells whether two runs had the same input; no protection against malice.
void hash_file(InputFile& file) {
  if (fs::is_directory(file.path)) return;
  std::ifstream in(file.path, std::ios::binary);
  std::uint64_t hash = 14695981039346656037ull;
  std::vector<char> chunk(1 << 16);
  while (in) {
    in.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    const auto got = static_cast<std::size_t>(in.gcount());
    for (std::size_t i = 0; i < got; ++i) hash = (hash ^ static_cast<unsigned char>(chunk[i])) * 1099511628211ull;
    file.bytes += got;
  }
  file.hash = fmt::format("fnv1a64:{:016x}", hash);
}

std::string stem_of(const std::string& path) {
  if (is_smooth_file(path)) return geometry_stem(path);
  fs::path p(path);
  if (!p.has_filename()) p = p.parent_path();  // a folder's name that ends in '/'
  return p.stem().string();
}

/// A grid given instead of a surface: its boundary is gridded, which not everyone means.
void say_what_is_unused(const Mesh& mesh, const std::string& path, Context& context) {
  const int top = mesh.top_dimension();
  const bool is_planar_grid = top == 2 && mesh.dimension == 2 && mesh.num_cells_of_dimension(1) > 0;
  if (top < 3 && !is_planar_grid) return;
  context.warn(fmt::format("{} is a grid of {} cells: they are not used, its {} stored {} are gridded anew", path,
                           mesh.num_cells_of_dimension(top), mesh.num_cells_of_dimension(top - 1),
                           is_planar_grid ? "boundary lines" : "faces"));
}

/// What the caller holds of an input; null: it is to be read.
const HeldInput* held_input(const Run& run, const std::string& path) {
  const auto held = run.extras.held.find(path);
  return held == run.extras.held.end() ? nullptr : held->second.get();
}

/// So that a selection that catches other faces than were meant is seen.
void say_selected_faces(const Run& run, const GeometryInput& smooth) {
  for (const BoundaryOptions& boundary : run.options.boundaries) {
    if (!boundary.selects_faces()) continue;
    std::vector<std::size_t> faces;
    for (std::size_t f = 0; f < smooth.brep.faces.size(); ++f)
      if (smooth.brep.faces[FaceId(f)].name == boundary.name) faces.push_back(f + 1);
    run.context.log(LogLevel::info, fmt::format("boundary '{}': face{} {}", boundary.name, faces.size() == 1 ? "" : "s",
                                                fmt::join(faces, ", ")));
  }
}

/// Smooth geometry has a grid to look at until sizes are known.
void read_smooth(Run& run, const std::string& path) {
  CadReport cad;
  GeometryInput smooth{run.inputs.size(), {}, {}, {}};
  const HeldInput* const held = held_input(run, path);
  {
    const StageTimer timer(run.context, "read");
    if (held) cad = held->cad;
    smooth.brep = held ? *held->brep : read_brep(path, run.context, cad);
    smooth.doubt = doubt_of(cad);
  }
  Options& options = run.options;  // several files might differ in their units
  if (options.input.units == "auto" && options.input.files.size() == 1 && metres_per_unit(cad.unit) > 0)
    options.input.units = cad.unit;
  const StageTimer timer(run.context, "look");
  with_file(path, smooth.doubt,
            [&] { smooth.look = held && held->look ? *held->look : look_at_brep(smooth.brep, run.context); });
  name_selected_faces(run.options.boundaries, path, cad, smooth);
  say_selected_faces(run, smooth);
  const std::string stem = held ? held->stem : stem_of(path);
  add_face_colours(smooth.brep, cad, stem, run.face_colours);
  run.inputs.push_back(named_surface(smooth.look.grid, smooth.brep, stem));
  run.smooth.push_back(std::move(smooth));
}

void read_inputs(Run& run) {
  const std::vector<std::string>& files = run.options.input.files;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (std::find(files.begin(), files.begin() + std::ptrdiff_t(i), files[i]) != files.begin() + std::ptrdiff_t(i))
      throw usage_error(run.options, "input.files", fmt::format("{} is given twice", files[i]));
    run.context.progress("read", i, files.size(), "files");
    const HeldInput* const held = held_input(run, files[i]);
    const bool is_smooth = is_smooth_input(files[i], run.extras);
    if (is_smooth) read_smooth(run, files[i]);
    const StageTimer timer(run.context, "read");
    if (held && !is_smooth) run.inputs.push_back({held->mesh, held->stem});
    if (!held && !is_smooth) run.inputs.push_back({read_mesh(files[i], run.context), stem_of(files[i])});
    InputFile file{files[i], 0, "", run.inputs.back().mesh.points.size(), 0};
    for (const CellBlock& block : run.inputs.back().mesh.blocks) file.num_cells += block.size();
    if (!held) hash_file(file);
    say_what_is_unused(run.inputs.back().mesh, files[i], run.context);
    run.result.inputs.push_back(std::move(file));
  }
  const StageTimer timer(run.context, "read");
  if (!has_far_field(run.options)) refuse_holes_in_nothing(run.inputs, files, run.extras);
  std::vector<NamedMesh> curves = curves_of_job(coarse_options(run.options), run.inputs, run.context);
  std::move(curves.begin(), curves.end(), std::back_inserter(run.inputs));
  run.context.progress("read", files.size(), files.size(), "files");
}

void read_geometry(Run& run) {
  const std::string& file = run.options.refine.geometry;
  if (file.empty()) return;
  const StageTimer timer(run.context, "read");
  with_place(run.options, "refine.geometry", [&] {
    Mesh mesh = read_mesh(file, run.context);
    run.geometry = is_planar_job(run.inputs) ? model_of_lines(mesh, stem_of(file))
                                             : build_model({{std::move(mesh), stem_of(file)}}, run.context);
  });
}

const Model* geometry_of(const Run& run) { return run.geometry.points.empty() ? nullptr : &run.geometry; }

/// What percent, longest sides and units mean is known once the input's box is.
void set_scale(Run& run, const Box& box) {
  Options& options = run.options;
  run.result.scale = {box.diagonal(), box.longest_side(), metres_per_unit(options.input.units)};
  resolve_lengths(options, run.result.scale);
  EncloseOptions& enclose = options.domain.enclose;
  if (!has_far_field(options) || !options.size.hmax) return;
  if (!is_planar_job(run.inputs) && options.domain.keep.empty() && options.domain.keep_points.empty())
    refuse_tiny_hmax(far_field_volume(enclose) - box.volume(), options, run.context);
  if (!enclose.h)  // no side above hmax, on the far field neither
    enclose.h = Length{std::min(default_far_field_side(enclose), options.size.hmax->value), ""};
}

/// The far field of the coarse grid, where there are levels.
EncloseOptions coarse_far_field(const Options& options) {
  EncloseOptions enclose = coarse_options(options).domain.enclose;
  if (options.refine.levels > 0 && !enclose.h)
    enclose.h = Length{std::min(coarsening(options), 2.0) * default_far_field_side(enclose), ""};
  return enclose;
}

/// The far field and the patches' names and kinds. What the input holds is a wall in the flow unless said otherwise.
void set_boundaries(Run& run, Model& model) {
  Options& options = run.options;
  for (const GeometryInput& smooth : run.smooth)
    if (has_far_field(options) && smooth.look.extent.body < smooth.look.extent.whole)
      run.context.log(
          LogLevel::warning,
          fmt::format("{} looks as if it had a far field of its own, {:.3g} wide round a body of {:.3g}: "
                      "another one round it makes the domain outside of both",
                      options.input.files[smooth.input], smooth.look.extent.whole, smooth.look.extent.body));
  const bool looks_only = has_far_field(options) && options.stop_after == "geometry";
  const std::vector<BoundaryOptions> boundaries = looks_only ? boundaries_of_input(options) : options.boundaries;
  if (has_far_field(options) && !looks_only) {
    run.far_field = add_far_field(model, coarse_far_field(options), run.result.scale, run.context);
    if (options.domain.keep.empty() && options.domain.keep_points.empty()) options.domain.keep = "outside";
  }
  const PatchesBefore before(model);
  run.far_field = apply_boundaries(boundaries, model, run.far_field);
  run.result.colours = colours_after(before, model, run.face_colours);
  if (has_far_field(options)) {
    for (Patch& patch : model.patches)
      if (patch.kind.empty()) patch.kind = "wall";
  } else if (options.domain.keep == "outside" &&
             std::none_of(model.patches.begin(), model.patches.end(),
                          [](const Patch& patch) { return patch.kind == "farfield"; })) {
    throw usage_error(options, "domain.keep",
                      "there is no far field that bounds the outside; add e.g. --farfield box:10c, or "
                      "give the outer patch the kind farfield ([boundaries.NAME])");
  }
}

/// What can be asked of triangles to look at: not their curvature, the surfaces' own counts; nothing on the far
/// field, which has no name yet.
Options options_for_looks(const Options& options, const Model& model, bool is_all_smooth) {
  Options result = options;
  if (is_all_smooth) {  // these look at the geometry itself
    result.size.automatic = false;
    result.size.gap = result.size.proximity = {};
  }
  result.size.curvature = result.size.angle = 0;
  result.size.deviation.reset();
  std::vector<std::string> names = model.corner_names;
  for (const Patch& patch : model.patches) names.push_back(patch.name);
  for (const Curve& curve : model.curves) names.push_back(curve.name);
  std::vector<std::string> later;  // of the far field, which is not there yet
  if (has_far_field(options)) later.push_back(options.domain.enclose.name);
  for (const BoundaryOptions& b : options.boundaries)
    if (const auto patterns = b.patterns();
        !later.empty() && std::find(patterns.begin(), patterns.end(), later[0]) != patterns.end())
      later.push_back(b.name);
  std::erase_if(result.size.on, [&](const SizeOnOptions& on) {
    const auto fits = [&](const std::string& name) { return matches_pattern(name, on.name); };
    return std::none_of(names.begin(), names.end(), fits) && std::any_of(later.begin(), later.end(), fits);
  });
  return result;
}

void log_rounds(const GeometryGrid& made, Context& context) {
  for (std::size_t i = 0; i < made.rounds.rounds.size(); ++i) {
    const BrepAccuracy& a = made.rounds.rounds[i];
    context.log(
        LogLevel::info,
        fmt::format("{}, round {}: {} triangles, angles from {:.1f} degrees ({} places below the goal), at most "
                    "{:.3g} off ({} beyond), neighbours turn by up to {:.1f} degrees ({} beyond)",
                    made.file, i + 1, a.triangles, a.angle_deg.value, a.angle_deg.num_beyond, a.deviation.value,
                    a.deviation.num_beyond, a.turn_deg.value, a.turn_deg.num_beyond));
  }
}

/// Smooth geometry gridded to the sizes asked for; with levels the final sizes are those of the true geometry.
void grid_smooth(Run& run, Model& model) {
  const Options& options = run.options;
  apply_boundaries(boundaries_of_input(options), model);  // sizes are asked for on their names
  const bool is_all_smooth = run.smooth.size() == options.input.files.size();
  const std::shared_ptr<const SizeField> asked =
      build_job_size_field(options_for_looks(options, model, is_all_smooth), model, model.bounding_box(), run.context);
  std::vector<NamedMesh> fine = run.inputs;
  for (const GeometryInput& smooth : run.smooth) {
    std::shared_ptr<const SizeField> size = geometry_sizes(smooth.brep, smooth.look, options, asked, run.context);
    refuse_too_many_triangles(smooth.look.grid, *size, options.refine.levels, run.context);
    GeometryGrid made{options.input.files[smooth.input], {}};
    const auto named = [&](const Model& grid) {
      return named_surface(grid, smooth.brep, run.inputs[smooth.input].stem);
    };
    if (options.refine.levels == 0) {
      with_file(made.file, smooth.doubt, [&] {
        run.inputs[smooth.input] = named(grid_geometry_to_goals(smooth, size, options, run.context, made.rounds));
      });
    } else {
      BrepGridReport coarse;
      if (run.geometry.points.empty())
        fine[smooth.input] = named(grid_geometry_to_goals(smooth, size, options, run.context, made.rounds));
      size = coarse_sizes(std::move(size), options, model.bounding_box(), run.context);
      run.inputs[smooth.input] = named(grid_geometry(smooth.brep, *size, options, run.context, coarse));
    }
    log_rounds(made, run.context);
    if (!made.rounds.rounds.empty()) run.result.geometry.push_back(std::move(made));
  }
  if (options.refine.levels > 0 && run.geometry.points.empty()) run.geometry = build_model(fine, run.context);
  model = build_model(run.inputs, run.context);
  model.feature_angle = options.input.feature_angle;
  if (options.surface.method == "mapped" || is_all_smooth) run.options.surface.method = "keep";
  if (is_all_smooth) run.options.size.automatic = false;  // its grid says it all
}

Model make_model(Run& run) {
  Model model = build_model(run.inputs, run.context);
  model.feature_angle = run.options.input.feature_angle;
  set_scale(run, model.surface_box());
  if (!run.smooth.empty()) grid_smooth(run, model);
  set_boundaries(run, model);
  return model;
}

void rescale(const Options& options, Mesh& mesh) {
  if (options.output.units.empty()) return;
  const double factor = metres_per_unit(options.input.units) / metres_per_unit(options.output.units);
  for (Point& p : mesh.points) p = factor * p;
}

/// Beside each output of that solver's format; what they assume is a warning.
void write_starters(Run& run, const std::string& path) {
  const OutputOptions& output = run.options.output;
  if (output.solver.empty() || format_of(path, output.format, true).name != output.solver) return;
  StarterFiles made = write_starter_files(run.result.mesh, path, output.solver, run.context, output.format);
  const std::string& unit = output.units.empty() ? run.options.input.units : output.units;
  if (const double metres = metres_per_unit(unit); metres > 0 && metres != 1)
    made.notes.push_back(
        fmt::format("{}: coordinates are in {}, and the solver takes them as metres; rescale them with "
                    "--output-units m",
                    path, unit == "in" ? "inches" : unit));
  for (const std::string& note : made.notes) run.context.warn(note);
  StarterFiles& all = run.result.starter;
  std::move(made.written.begin(), made.written.end(), std::back_inserter(all.written));
  std::move(made.kept.begin(), made.kept.end(), std::back_inserter(all.kept));
  std::move(made.notes.begin(), made.notes.end(), std::back_inserter(all.notes));
}

void write_outputs(Run& run) {
  const StageTimer timer(run.context, "write");
  const OutputOptions& output = run.options.output;
  rescale(run.options, run.result.mesh);
  for (std::size_t i = 0; i < output.files.size(); ++i) {
    run.context.progress("write", i, output.files.size(), "files");
    const WriteOptions how{.binary = !output.ascii, .version = output.msh_version, .compress = output.compress};
    for (std::string& change : write_mesh(run.result.mesh, output.files[i], run.context, how, output.format))
      run.result.name_changes.push_back(fmt::format("{}: {}", output.files[i], change));
    run.result.files_written.push_back(output.files[i]);
    write_starters(run, output.files[i]);
  }
  run.context.progress("write", output.files.size(), output.files.size(), "files");
}

/// A surface alone: to look at it (geometry), or to write it, with its far field (surface).
void stop_at_surface(Run& run, Model model) {
  std::shared_ptr<const SizeField> size;
  const bool is_new = run.options.surface.method != "keep";
  if (run.options.stop_after != "geometry" && (is_new || run.options.output.sizes)) {
    if (is_new) orient_shells(model, run.context);  // as before gridding, so that both give the same surface
    if (run.far_field.is_valid()) run.options.surface.kept = {run.far_field};
    size =
        surface_sizes(model, run.options, build_job_size_field(run.options, model, model.bounding_box(), run.context));
    regrid_as_asked(model, run.options, *size, run.result.report.surface_grid, run.context);
  }
  run.result.report.surface = check_surface(model, run.context);
  run.result.mesh = surface_mesh(model);
  if (run.options.output.sizes && size) add_size_field(run.result.mesh, *size, run.context);
  if (run.options.stop_after == "geometry") {
    if (!run.result.report.surface.can_bound_volume)
      throw InputError("the surface cannot bound a volume; see the findings");
    return;
  }
  write_outputs(run);
}

/// generate() knows the outer boundary by its kind, "farfield"; a kind that the job gives it goes to the grid alone.
Outcome generate_in_far_field(const Run& run, Model model) {
  std::shared_ptr<const SizeField> sizes = build_job_size_field(run.options, model, model.bounding_box(), run.context);
  const Model* geometry = geometry_of(run);
  if (!run.far_field.is_valid())
    return generate(std::move(model), run.options, run.context, std::move(sizes), geometry);
  const Patch asked = model.patches[run.far_field];
  model.patches[run.far_field].kind = "farfield";
  Outcome outcome = generate(std::move(model), run.options, run.context, std::move(sizes), geometry);
  const GroupId group = outcome.mesh.find_group(2, asked.name);
  if (group.is_valid()) outcome.mesh.groups[group].kind = asked.kind;
  return outcome;
}

void judge_grid(Run& run) {
  const std::string& gates = run.options.output.require;
  if (gates.empty()) return;
  run.result.failed_gates = failed_gates(run.result.report.quality, gates);
  if (run.result.failed_gates.empty()) return;
  Context quiet;  // looking for the places must not cost the grid
  quiet.threads = run.context.threads;
  run.result.gate_failures = find_gate_failures(run.result.mesh, gates, quiet);
}

/// A page says of a grid that it is valid; that is looked at.
void look_at_grid(Run& run) {
  if (!is_page_name(run.options.output.report)) return;
  const StageTimer timer(run.context, "check");
  run.result.grid_findings = check(run.result.mesh);
}

void finish(Run& run, Outcome outcome) {
  run.result.report = std::move(outcome.report);
  run.result.mesh = std::move(outcome.mesh);
  run.context.check_cells(run.result.report.quality.num_cells);
  judge_grid(run);
  if (writes_grid(run.options)) write_outputs(run);
  look_at_grid(run);
  if (run.result.failed_gates.empty()) return;
  run.result.exit_code = ExitCode::gate_not_met;
  run.result.error = fmt::format("the grid {}: {}",
                                 run.result.files_written.empty() ? "does not meet" : "was written, but does not meet",
                                 fmt::join(run.result.failed_gates, "; "));
}

/// Goes as far as a grid would, and writes sizes or nothing.
void prepare_survey(Run& run) {
  run.options.stop_after = run.kind == JobKind::estimate ? "improve" : "";
  run.options.output.solver.clear();
  if (run.options.volume.method == "none") run.options.volume.method = VolumeOptions().method;
}

void check_size_outputs(const Options& options) {
  for (std::size_t i = 0; i < options.output.files.size(); ++i)
    if (const std::string& path = options.output.files[i]; format_of(path, options.output.format, true).name != "vtu")
      throw usage_error(options, fmt::format("output.files[{}]", i),
                        fmt::format("{}: sizes are written as VTU; say e.g. -o sizes.vtu", path));
}

/// Estimate and sizes: what the boundary and the size field say, without a grid.
/// @param size  of the coarse grid, where there are levels
void survey(Run& run, const KeptDomain& domain, const std::shared_ptr<const SizeField>& size) {
  if (run.kind == JobKind::estimate) {
    run.result.estimate = estimate_grid(domain, *size, growth_of(coarse_options(run.options).size), run.context);
    if (!domain.is_planar() && run.options.volume.method == "front")
      slow_down_to_front(*run.result.estimate, run.context.threads);
    refine_estimate(*run.result.estimate, domain.is_planar(), run.options.refine.levels);
  } else {
    const std::shared_ptr<const SizeField> fine = scale_sizes(size, 1 / coarsening(run.options));
    run.result.mesh = size_mesh(domain, *fine, growth_of(run.options.size), run.context);
    write_outputs(run);
  }
}

void survey_volume(Run& run, Model model) {
  if (run.far_field.is_valid()) model.patches[run.far_field].kind = "farfield";
  std::shared_ptr<const SizeField> asked = build_job_size_field(run.options, model, model.bounding_box(), run.context);
  asked = coarse_sizes(std::move(asked), run.options, model.bounding_box(), run.context);
  const Options options = coarse_options(run.options);
  const Prepared prepared = prepare_volume(model, options, std::move(asked), run.result.report, run.context);
  survey(run, KeptDomain(prepared), prepared.size);
}

void survey_plane(Run& run, PlanarDomain domain, CurveId far_field, const std::shared_ptr<const SizeField>& asked) {
  if (far_field.is_valid()) domain.curves[far_field].kind = "farfield";
  const std::shared_ptr<const SizeField> coarse =
      coarse_sizes(asked, run.options, model_of(domain).bounding_box(), run.context);
  const PlanarPrepared prepared = prepare_planar(domain, coarse_options(run.options), coarse, run.context);
  survey(run, KeptDomain(prepared), prepared.size);
}

/// Lines in the plane: the same steps, over curves instead of patches.
void work_in_the_plane(Run& run) {
  check_planar_outputs(run.options);
  PlanarDomain domain = build_planar_domain(run.inputs, run.context);
  Box box;
  for (const Point2 p : domain.points) box.add(Point{p.x, p.y, 0});
  set_scale(run, box);
  const bool is_section = std::all_of(run.options.input.files.begin(), run.options.input.files.end(),
                                      [](const std::string& file) { return file.ends_with(".dat"); });
  if (is_section && !has_far_field(run.options))
    run.context.warn(
        "the inside of the section is gridded; for the flow around it give a far field: --farfield circle:50c");
  const CurveId far_field = set_curves(domain, run.options, run.result.scale, run.context);
  if (run.options.stop_after == "geometry" || run.options.stop_after == "surface" ||
      run.options.volume.method == "none") {
    run.result.mesh = line_mesh(domain);
    run.result.report.surface.findings = check_planar_domain(domain, run.context);
    if (run.options.stop_after != "geometry") return write_outputs(run);
    if (has_errors(run.result.report.surface.findings))
      throw InputError("the lines cannot be gridded; see the findings");
    return;
  }
  if (run.options.stop_after == "volume") run.options.improve.enabled = false;
  const Model names = model_of(domain);
  const SizeOptions& size = run.options.size;
  std::function<bool(Point)> is_kept;
  if (size.gap.cells > 0 || size.automatic.value_or(!size.accuracy.empty()))
    is_kept = kept_part(domain, far_field, run.options, run.context);
  const std::shared_ptr<const SizeField> sizes =
      build_job_size_field(run.options, names, names.bounding_box(), run.context, is_kept);
  if (run.kind != JobKind::grid) return survey_plane(run, std::move(domain), far_field, sizes);
  if (run.options.refine.levels > 0 && run.geometry.points.empty())
    run.geometry = true_lines(run.options, run.inputs, run.result.scale, run.context);
  Outcome outcome = generate_in_far_field(domain, far_field, run.options, sizes, geometry_of(run), run.context);
  finish(run, std::move(outcome));
}

void work(Run& run) {
  check_floating_point_mode();
  if (run.kind == JobKind::sizes) check_size_outputs(run.options);
  check_job(run.options, run.extras);
  read_inputs(run);
  check_output_units(run.options);
  read_geometry(run);
  if (is_planar_job(run.inputs)) return work_in_the_plane(run);
  Model model = make_model(run);
  if (run.options.stop_after == "geometry") return stop_at_surface(run, std::move(model));
  if (run.options.stop_after == "surface" || run.options.volume.method == "none")
    return stop_at_surface(run, std::move(model));
  if (run.kind != JobKind::grid) return survey_volume(run, std::move(model));
  if (run.options.stop_after == "volume") run.options.improve.enabled = false;
  finish(run, generate_in_far_field(run, std::move(model)));
}

void put_error(JobResult& result, ExitCode code, const std::string& message, std::vector<Place> places = {}) {
  result.exit_code = code;
  result.error = message;
  result.places = std::move(places);
  if (code != ExitCode::interrupted && code != ExitCode::limit_reached) return;
  if (code == ExitCode::interrupted) result.error = "interrupted";
  if (result.files_written.empty())
    result.error += "; nothing was written";
  else
    result.error += fmt::format("; complete are: {}", fmt::join(result.files_written, " "));
}

constexpr const char* kOutOfMemory =
    "out of memory; ask for larger sizes (--hmax, --growth) or use a machine with more";

/// Run the steps; every way they can end becomes an exit code and a sentence.
void work_and_catch(Run& run) {
  JobResult& result = run.result;
  try {
    work(run);
  } catch (const MeshingError& e) {
    put_error(result, e.exit_code, e.what(), e.places);
    result.partial = e.partial;
  } catch (const Error& e) {
    put_error(result, e.exit_code, e.what(), e.places);
  } catch (const std::bad_alloc&) {
    put_error(result, ExitCode::limit_reached, kOutOfMemory);
  } catch (const std::length_error&) {  // more than any memory holds
    put_error(result, ExitCode::limit_reached, kOutOfMemory);
  } catch (const std::exception& e) {
    put_error(result, ExitCode::internal_error,
              fmt::format("unexpected error: {}; please report this with the input file and the command", e.what()));
  }
  if (result.exit_code == ExitCode::done || result.exit_code == ExitCode::gate_not_met) return;
  result.mesh = {};
}

/// The report of the run. That it cannot be written is the run's failure only where nothing worse happened.
void write_report(const Options& options, const std::string& command, JobResult& result) {
  try {
    write_report_files(options, command, result);
  } catch (const Error& e) {
    if (result.exit_code == ExitCode::done)
      put_error(result, e.exit_code, e.what());
    else
      result.warnings.push_back(fmt::format("no report: {}", e.what()));
  } catch (const std::exception& e) {  // memory, or a mistake of ours
    if (result.exit_code == ExitCode::done)
      put_error(result, ExitCode::internal_error, fmt::format("the report could not be made: {}", e.what()));
  }
}

void set_limits(const LimitOptions& limits, Context& context) {
  if (limits.time > 0) context.time_limit = limits.time;
  if (limits.memory > 0) context.memory_limit = limits.memory;
  if (limits.max_cells > 0) context.max_cells = limits.max_cells;
}

}  // namespace

JobResult run_job(const Options& options, Context& context, const std::string& command, JobKind kind,
                  const JobExtras& extras) {
  JobResult result;
  set_limits(options.limits, context);
  const auto outer_log = context.on_log;
  const auto outer_progress = context.on_progress;
  context.on_log = [&](LogLevel level, const std::string& message) {
    if (level == LogLevel::warning) result.warnings.push_back(message);
    if (outer_log) outer_log(level, message);
  };
  context.on_progress = [&](const Progress& progress) {
    result.stage = progress.stage;
    if (outer_progress) outer_progress(progress);
  };
  Run run{options, context, result, {}, {}, kind, {}, {}, extras};
  if (kind != JobKind::grid) prepare_survey(run);
  work_and_catch(run);
  context.on_log = outer_log;
  context.on_progress = outer_progress;
  leave_defects(run);
  leave_partial_grid(run);
  for (const std::string& warning : result.report.warnings)
    if (std::find(result.warnings.begin(), result.warnings.end(), warning) == result.warnings.end()) {
      result.warnings.push_back(warning);
      context.warn(warning);
    }
  result.stage_times = context.stage_times;
  result.seconds = context.seconds_since_start();
  result.peak_memory = peak_resident_memory();
  write_report(options, command, result);
  return result;
}

}  // namespace delfront
