// SPDX-License-Identifier: Apache-2.0
// Sizes of smooth geometry: what its shape asks for (delfront/brep_sizes.hpp) by the numbers of the job, with what else
// is asked for.
#include "pipeline/geometry_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <utility>

#include "base/plain_name.hpp"
#include "delfront/geometry_sizes.hpp"
#include "delfront/geometry_text.hpp"
#include "delfront/io.hpp"
#include "delfront/size_sources.hpp"
#include "delfront/uniform_size.hpp"
#include "pipeline/boundaries.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {
namespace {

constexpr double kDeviationMargin = 0.4;  ///< of the deviation: sizes are for that, so that few places are beyond
constexpr double kUsualMargin = 0.3;      ///< the same where nothing is asked for: nothing but misses are beyond
constexpr double kTurnMargin = 1.5;       ///< times that of cells a turn: neighbours that turn by more are regridded
constexpr std::size_t kManySources = 200'000;

/// Which space is gridded: gaps matter there.
GapSizes::Side gridded_side(const DomainOptions& domain) {
  const bool has_outside = domain.enclose.shape != "none";
  if (!domain.keep_points.empty()) return GapSizes::Side::both;
  if (domain.keep.empty()) return has_outside ? GapSizes::Side::ahead : GapSizes::Side::behind;
  return domain.keep == "outside" ? GapSizes::Side::ahead : GapSizes::Side::both;
}

/// By itself the shape asks for nothing where something else has an opinion everywhere.
bool is_automatic(const SizeOptions& size) { return size.automatic.value_or(!has_field_everywhere(size)); }

double cells_of(const GapOptions& asked, double usual, bool is_automatic) {
  return asked.cells > 0 ? asked.cells : is_automatic ? usual : 0;
}

CurvatureSizes curvature_wish(const SizeOptions& size, const AccuracyNumbers& usual, double extent) {
  CurvatureSizes wish;
  if (size.curvature > 0) wish.cells_per_turn = size.curvature;
  if (size.angle > 0) wish.angle_deg = size.angle;
  if (size.deviation) wish.deviation = kDeviationMargin * size.deviation->value;
  if (!wish.cells_per_turn && !wish.angle_deg && !wish.deviation) {
    wish.cells_per_turn = usual.cells_per_turn;
    if (is_automatic(size)) wish.deviation = kUsualMargin * usual.deviation_share * extent;
  }
  if (size.angle_form == "tangent") wish.form = CurvatureSizes::Form::tangent;
  return wish;
}

/// The wish of the whole; the least size is that of the body, a far field has no details.
BrepSizes geometry_wish(const Options& options, const BrepExtent& extent, bool has_field) {
  const SizeOptions& size = options.size;
  const AccuracyNumbers usual = accuracy_numbers(size.accuracy);
  BrepSizes wish;
  wish.hmax = size.hmax ? size.hmax->value : has_field ? extent.whole : size.steeper * usual.hmax_share * extent.whole;
  wish.hmin = std::min(wish.hmax, size.hmin ? size.hmin->value : usual.hmin_share * extent.body);
  wish.curvature = curvature_wish(size, usual, extent.whole);
  wish.line_cells = cells_of(size.proximity, usual.line_cells, is_automatic(size));
  wish.gap_cells = cells_of(size.gap, usual.gap_cells, is_automatic(size));
  if (size.proximity.hmin) wish.line_hmin = size.proximity.hmin->value;
  if (size.gap.hmin) wish.gap_hmin = size.gap.hmin->value;
  wish.gap_side = gridded_side(options.domain);
  return wish;
}

BrepOptions gridding_options(const Options& options, const BrepExtent& extent) {
  BrepOptions how;
  if (options.surface.bridge) how.bridge_below = geometry_wish(options, extent, false).hmin;
  if (options.surface.method == "front") how.method = BrepOptions::Method::direct;
  return how;
}

/// The first of each kind, and how many more there are.
void tell_notes(const std::vector<CadNote>& notes, const std::string& path, LogLevel level, Context& context) {
  std::map<std::string, std::size_t> count;
  for (const CadNote& note : notes) ++count[note.kind];
  for (const CadNote& note : notes) {
    const std::size_t all = std::exchange(count[note.kind], 0);
    if (all == 0) continue;
    context.log(level, fmt::format("{}: {}{}", path, note.message,
                                   all > 1 ? fmt::format(" (and {} more of this kind)", all - 1) : ""));
  }
}

std::string first_place(const CadReport& cad) {
  if (cad.open_at.empty()) return {};
  const Point at = cad.open_at[0].at;
  return fmt::format(" ({} at ({:g}, {:g}, {:g}))", cad.free_edges == 1 ? "its middle" : "the middle of the first",
                     at.x, at.y, at.z);
}

void tell(const CadReport& cad, const std::string& path, Context& context) {
  tell_notes(cad.repairs, path, LogLevel::info, context);
  tell_notes(cad.suspicious, path, LogLevel::warning, context);
  if (cad.free_edges > 0)
    context.warn(
        fmt::format("{}: {} edges bound one face only{}: the surface is open there, and bounds no volume unless "
                    "something else closes it (the surface alone: --stop-after surface)",
                    path, cad.free_edges, first_place(cad)));
}

/// Of faces, edges, corners and parts, wherever they stand.
void plain_names(Brep& brep, CadReport& cad, const std::string& path, Context& context) {
  std::set<std::string> changed;
  const auto make_plain = [&](std::string& name) {
    const std::string plain = plain_name(name);
    if (plain == name) return;
    changed.insert(name);
    name = plain;
  };
  for (BrepFace& face : brep.faces) make_plain(face.name);
  for (BrepEdge& edge : brep.edges) make_plain(edge.name);
  for (BrepCorner& corner : brep.corners) make_plain(corner.name);
  for (std::string& region : brep.regions) make_plain(region);
  for (CadFace& face : cad.faces) {
    make_plain(face.name);
    make_plain(face.layer);
    for (std::string& solid : face.solids) make_plain(solid);
  }
  if (!changed.empty()) context.warn(say_plain_names(path, changed.size()));
}

/// Null where the input is another kind of file.
std::shared_ptr<const GeometryText> text_of_input(const std::string& file, const JobExtras& extras) {
  const auto held = extras.held.find(file);
  if (held != extras.held.end()) return held->second->text;
  return is_geometry_file(file) ? std::make_shared<GeometryText>(read_geometry(file)) : nullptr;
}

/// Whoever holds it may read a CAD file; the others wait, and can be stopped.
class CadTurn {
 public:
  explicit CadTurn(const Context& context) : lock_(mutex(), std::defer_lock) {
    while (!lock_.try_lock_for(std::chrono::milliseconds(50))) context.check_limits();
  }

 private:
  static std::timed_mutex& mutex() {
    static std::timed_mutex of_process;
    return of_process;
  }
  std::unique_lock<std::timed_mutex> lock_;
};

}  // namespace

std::shared_ptr<const SizeField> geometry_sizes(const Brep& brep, const BrepLook& look, const Options& options,
                                                std::shared_ptr<const SizeField> asked, Context& context) {
  const StageTimer timer(context, "sizes");
  const bool has_field = asked && has_field_everywhere(options.size);
  const BrepSizes wish = geometry_wish(options, look.extent, has_field);
  GeometrySources found = find_brep_sizes(brep, look, wish, context);
  if (!found.sources.empty())
    context.log(
        LogLevel::info,
        fmt::format("sizes of the geometry: {:g} to {:g}, {} places, {} of them at hmin; the least at {:g} {:g} {:g}",
                    found.report.smallest, wish.hmax, found.report.num_sources, found.report.num_at_hmin,
                    found.report.smallest_at.x, found.report.smallest_at.y, found.report.smallest_at.z));
  if (found.sources.size() > kManySources) merge_close_sources(found);
  std::vector<std::shared_ptr<const SizeField>> parts = {std::make_shared<UniformSize>(wish.hmax), std::move(asked)};
  if (!found.sources.empty())
    parts.push_back(build_source_size_field(std::move(found.sources), {.growth = growth_asked(options.size)}, context));
  return combine_size_fields(std::move(parts), options.size.hmin ? wish.hmin : 0, wish.hmax);
}

BrepGoals geometry_goals(const Options& options, const BrepExtent& extent) {
  const SizeOptions& size = options.size;
  const AccuracyNumbers usual = accuracy_numbers(size.accuracy);
  BrepGoals goals;
  goals.hmin = geometry_wish(options, extent, false).hmin;
  if (size.deviation) goals.deviation = size.deviation->value;
  if (size.angle > 0) goals.turn_deg = size.angle;
  if (!is_automatic(size)) {
    goals.angle_deg = 0;
  } else if (!size.deviation && !(size.angle > 0)) {
    goals.turn_deg = kTurnMargin * 360 / (size.curvature > 0 ? size.curvature : usual.cells_per_turn);
    if (!(size.curvature > 0)) goals.deviation = usual.deviation_share * extent.whole;
  }
  return goals;
}

NamedMesh named_surface(const Model& grid, const Brep& brep, const std::string& stem) {
  NamedMesh named{surface_mesh(grid), stem, brep.regions, {}};
  if (brep.regions.empty()) return named;
  for (const std::uint32_t face : grid.input_face) named.sides.push_back(brep.faces[FaceId(std::size_t(face))].regions);
  return named;
}

Model grid_geometry(const Brep& brep, const SizeField& size, const Options& options, Context& context,
                    BrepGridReport& report) {
  return grid_brep(brep, size, gridding_options(options, measure_extent(brep)), report, context);
}

Model grid_geometry_to_goals(const GeometryInput& input, std::shared_ptr<const SizeField> size, const Options& options,
                             Context& context, BrepRounds& report) {
  return grid_brep_to_goals(input.brep, std::move(size), gridding_options(options, input.look.extent),
                            geometry_goals(options, input.look.extent), report, context);
}

Model grid_to_look_at(const Brep& brep, bool is_quick, Context& context, BrepGridReport& report) {
  const Options usual;
  BrepLook look = look_at_brep(brep, context);
  if (is_quick) {
    report = std::move(look.report);
    return std::move(look.grid);
  }
  return grid_geometry(brep, *geometry_sizes(brep, look, usual, nullptr, context), usual, context, report);
}

bool is_smooth_file(const std::string& path) { return is_geometry_file(path) || is_cad_file(path); }

bool is_smooth_input(const std::string& path, const JobExtras& extras) {
  const auto held = extras.held.find(path);
  return held == extras.held.end() ? is_smooth_file(path) : held->second->brep != nullptr;
}

HeldInput read_input(const std::string& path, Context& context, const std::string& format) {
  HeldInput held;
  if (!is_smooth_file(path)) {
    const std::filesystem::path whole(path);
    held.stem = (whole.has_filename() ? whole : whole.parent_path()).stem().string();
    held.mesh = read_mesh(path, context, format);
    return held;
  }
  held.stem = geometry_stem(path);
  if (is_geometry_file(path)) held.text = std::make_shared<GeometryText>(read_geometry(path));
  held.brep = std::make_shared<Brep>(read_brep(path, context, held.cad));
  held.look = std::make_shared<BrepLook>(look_at_brep(*held.brep, context));
  held.mesh = surface_mesh(held.look->grid);
  return held;
}

Brep read_brep(const std::string& path, Context& context, CadReport& cad) {
  Brep brep;
  if (is_cad_file(path)) {
    const CadTurn turn(context);
    brep = read_cad(path, {}, cad, context);
    tell(cad, path, context);
  } else {
    brep = build_brep(read_geometry(path), path);
  }
  plain_names(brep, cad, path, context);
  for (BrepFace& face : brep.faces)
    if (face.name.empty()) face.name = geometry_stem(path);
  return brep;
}

void refuse_holes_in_nothing(const std::vector<NamedMesh>& inputs, const std::vector<std::string>& files,
                             const JobExtras& extras) {
  std::vector<NamedGeometry> texts;
  std::vector<Box> others;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (const auto text = text_of_input(files[i], extras))
      texts.push_back({*text, files[i]});
    else
      others.push_back(inputs[i].mesh.bounding_box());
  }
  if (std::any_of(texts.begin(), texts.end(), [](const NamedGeometry& it) { return has_holes(it.text); }))
    check_holes(texts, others);
}

std::string doubt_of(const CadReport& cad) {
  for (const CadNote& note : cad.suspicious)
    for (const char* kind : {"not_translated", "lost_face", "not_mended", "not_imprinted", "parameter_curve_off",
                             "edge_off_its_corner", "edge_without_curve"})
      if (note.kind == kind) return note.message;
  return {};
}

void with_file(const std::string& path, const std::string& doubt, const std::function<void()>& work) {
  const std::string hint = doubt.empty() ? "" : "; suspicious about the file: " + doubt;
  const auto said = [&](const char* what) {
    const std::string message = what;
    return (message.starts_with(path) ? message : path + ": " + message) + hint;
  };
  const auto no_memory = [&] {
    return LimitError(
        fmt::format("{}: its grid takes more memory than there is; ask for larger sizes (--hmax), or look "
                    "whether the geometry is what it should be (delfront info){}",
                    path, hint));
  };
  try {
    work();
  } catch (const MeshingError& e) {
    throw MeshingError(said(e.what()), e.places, e.partial);
  } catch (const InputError& e) {
    throw InputError(said(e.what()), e.places);
  } catch (const std::bad_alloc&) {
    throw no_memory();
  } catch (const std::length_error&) {  // more than any memory holds
    throw no_memory();
  }
}

std::string geometry_stem(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (is_cad_file(path)) return std::filesystem::path(path).stem().string();
  return name.substr(0, name.size() - std::string(kGeometrySuffix).size());
}

}  // namespace delfront
