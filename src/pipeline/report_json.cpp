// SPDX-License-Identifier: Apache-2.0
#include "pipeline/report_json.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "delfront/version.hpp"
#include "io/output.hpp"
#include "mesh/cell_geometry.hpp"
#include "pipeline/option_table.hpp"
#include "pipeline/quantities.hpp"
#include "pipeline/run.hpp"

namespace delfront {

using Json = nlohmann::ordered_json;

namespace {

/// JSON has no infinity and no NaN; they stand for "no cells at all" here.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json to_json(Point p) { return Json::array({number(p.x), number(p.y), number(p.z)}); }

Json to_json(const Box& box) {
  return box.is_empty() ? Json(nullptr) : Json{{"low", to_json(box.low)}, {"high", to_json(box.high)}};
}

Json to_json(const JobValue& value) {
  switch (value.kind) {
    case JobValue::Kind::none:
      return nullptr;
    case JobValue::Kind::boolean:
      return value.boolean;
    case JobValue::Kind::integer:
      return value.integer;
    case JobValue::Kind::number:
      return number(value.number);
    case JobValue::Kind::text:
      return value.text;
    case JobValue::Kind::list: {
      Json list = Json::array();
      for (const JobValue& item : value.items) list.push_back(to_json(item));
      return list;
    }
    case JobValue::Kind::table: {
      Json table = Json::object();
      for (std::size_t i = 0; i < value.items.size(); ++i) table[value.names[i]] = to_json(value.items[i]);
      return table;
    }
  }
  return nullptr;
}

Json to_json(const Estimate& e) {
  return {{"cells", number(e.cells)},
          {"points", number(e.points)},
          {"measure", number(e.measure)},
          {"least_size", number(e.least_size)},
          {"greatest_size", number(e.greatest_size)},
          {"memory_bytes", number(e.memory)},
          {"seconds", number(e.seconds)},
          {"is_at_least", e.is_at_least}};
}

Json to_json(const Measure& m) {
  Json worst = Json::array();
  for (std::size_t i = 0; i < m.worst.size(); ++i) {
    const double value = i < m.worst_values.size() ? m.worst_values[i] : std::nan("");
    worst.push_back({{"value", number(value)}, {"at", to_json(m.worst[i].at)}, {"cells", m.worst[i].ids}});
  }
  return {
      {"unit", m.unit},
      {"min", number(m.min)},
      {"max", number(m.max)},
      {"mean", number(m.mean)},
      {"histogram", {{"low", number(m.histogram_low)}, {"high", number(m.histogram_high)}, {"counts", m.histogram}}},
      {"worst", worst}};
}

Json to_json(const SizeFit& fit) {
  return {{"ratio", to_json(fit.ratio)}, {"share_of_right_sides", number(fit.share_right)}};
}

Json to_json(const SurfaceComponent& c) {
  return {{"num_triangles", c.num_triangles},
          {"is_closed", c.is_closed},
          {"signed_volume", number(c.signed_volume)},
          {"area", number(c.area)},
          {"inside_of", c.inside_of < 0 ? Json(nullptr) : Json(c.inside_of)},
          {"box", to_json(c.box)}};
}

/// Places that stayed divided, each with the reason.
Json left_json(const RecoveryReport& r) {
  Json left = to_json(r.left, kMaxPlaces);
  for (std::size_t i = 0; i < left.size(); ++i) left[i]["why"] = i < r.left_why.size() ? r.left_why[i] : "";
  return left;
}

Json to_json(const RecoveryReport& r) {
  return {{"missing_edges", r.missing_edges},
          {"missing_faces", r.missing_faces},
          {"steiner_points", r.steiner_points},
          {"steiner_moved", r.steiner_moved},
          {"steiner_left", r.steiner_left},
          {"curve_edges", r.curve_edges},
          {"curve_edges_inside", r.curve_edges_inside},
          {"curve_edges_split", r.curve_edges_split},
          {"curve_points_left", r.curve_points_left},
          {"embedded_points", r.embedded_points},
          {"left", left_json(r)}};
}

Json to_json(const KernelCounts& k) {
  return {{"points", k.points},           {"walk_steps", k.walk_steps},     {"insphere_tests", k.insphere_tests},
          {"exact_tests", k.exact_tests}, {"tets_deleted", k.tets_deleted}, {"tets_created", k.tets_created}};
}

Json to_json(const RefineReport& r) {
  return {{"points_inserted", r.points_inserted},
          {"points_in_core", r.points_in_core},
          {"candidates", r.candidates},
          {"rounds", r.rounds},
          {"kernel", to_json(r.kernel)}};
}

Json to_json(const FrontReport& r) {
  return {{"sides_processed", r.sides_processed},
          {"cells", r.cells},
          {"points", r.points},
          {"rounds", r.rounds},
          {"sweeps", r.sweeps},
          {"sides_left", r.sides_left},
          {"cavities", r.cavities},
          {"cells_emptied", r.cells_emptied},
          {"cells_refilled", r.cells_refilled},
          {"cavities_by_stars", r.cavities_by_stars},
          {"cavities_left", r.cavities_left},
          {"closed_by_delaunay", r.closed_by_delaunay},
          {"delaunay_places", to_json(r.delaunay_places, kMaxPlaces)},
          {"crossing_share", number(r.crossing_share)},
          {"gave_up", r.gave_up}};
}

Json to_json(const ImproveReport& r) {
  return {{"passes", r.passes},
          {"face_swaps", r.face_swaps},
          {"edge_swaps", r.edge_swaps},
          {"points_moved", r.points_moved},
          {"points_removed", r.points_removed},
          {"points_added", r.points_added},
          {"min_dihedral_before", number(r.min_dihedral_before_deg)},
          {"min_dihedral_after", number(r.min_dihedral_after_deg)},
          {"below_goal", r.below_goal},
          {"below_goal_forced", r.below_goal_forced}};
}

/// Null without levels.
Json to_json(const LevelsReport& r) {
  if (r.refined.levels == 0) return nullptr;
  return {{"levels", r.refined.levels},
          {"coarse_cells", r.coarse_cells},
          {"coarse_points", r.coarse_points},
          {"points_on_surface", r.refined.points_on_surface},
          {"points_on_features", r.refined.points_on_features},
          {"largest_move", number(r.refined.largest_move)},
          {"boundary_points", r.refined.boundary_points},
          {"out_of_reach", r.refined.out_of_reach},
          {"halved", r.refined.halved},
          {"reversed", r.refined.reversed},
          {"reversed_places", to_json(r.refined.reversed_places, kMaxPlaces)},
          {"groups_not_in_geometry", r.refined.groups_not_in_model}};
}

Json to_json(const SurfaceGridReport& r) {
  Json patches = Json::array(), fallbacks = Json::array();
  for (const SurfacePatchReport& p : r.patches)
    patches.push_back({{"name", p.name},
                       {"triangles_given", p.triangles_given},
                       {"triangles", p.triangles},
                       {"min_angle", number(p.min_angle_deg)}});
  for (const SurfaceFallback& f : r.fallbacks)
    fallbacks.push_back({{"kind", f.kind == SurfaceFallback::Kind::kept ? "kept" : "remeshed"},
                         {"patch", f.patch},
                         {"at", to_json(f.at)},
                         {"why", f.why}});
  return {{"regions", r.regions},
          {"lines", r.lines},
          {"corners", r.corners},
          {"triangles_given", r.triangles_given},
          {"triangles", r.triangles},
          {"points", r.points},
          {"min_angle", number(r.min_angle_deg)},
          {"mean_min_angle", number(r.mean_min_angle_deg)},
          {"below_25_deg", r.below_25_deg},
          {"largest_distance", number(r.largest_distance)},
          {"largest_distance_at", to_json(r.largest_distance_at)},
          {"shortest_edge", number(r.shortest_edge)},
          {"longest_edge", number(r.longest_edge)},
          {"front_steps", r.front_steps},
          {"rounds", r.rounds},
          {"sizes_lowered", r.sizes_lowered},
          {"patches", patches},
          {"fallbacks", fallbacks}};
}

Json to_json(const BrepAccuracy::Worst& w) {
  return {{"value", number(w.value)}, {"at", to_json(w.at)}, {"num_beyond", w.num_beyond}};
}

Json to_json(const BrepAccuracy& a) {
  Json patches = Json::array();
  for (const BrepAccuracy::Patch& p : a.patches)
    patches.push_back({{"name", p.name},
                       {"triangles", p.triangles},
                       {"min_angle", number(p.min_angle_deg)},
                       {"largest_deviation", number(p.largest_deviation)}});
  return {{"triangles", a.triangles},
          {"points", a.points},
          {"min_angle", number(a.min_angle_deg)},
          {"min_angle_away_from_sharp_corners", to_json(a.angle_deg)},
          {"mean_min_angle", number(a.mean_min_angle_deg)},
          {"angles", {{"low", 0}, {"high", 60}, {"counts", a.angles}}},
          {"deviation", to_json(a.deviation)},
          {"mean_deviation", number(a.mean_deviation)},
          {"turn", to_json(a.turn_deg)},
          {"share_of_right_sides", number(a.share_of_right_sides)},
          {"mean_side", number(a.mean_side)},
          {"patches", patches}};
}

Json to_json(const GeometryGrid& g) {
  Json rounds = Json::array();
  for (const BrepAccuracy& a : g.rounds.rounds) rounds.push_back(to_json(a));
  for (std::size_t i = 0; i + 1 < rounds.size(); ++i) rounds[i].erase("patches");
  Json bridges = Json::array(), faces = Json::array();
  for (const BrepBridge& bridge : g.rounds.grid.bridges)
    bridges.push_back({{"at", to_json(bridge.at)}, {"width", number(bridge.width)}});
  for (const BrepFaceReport& face : g.rounds.grid.faces)
    if (face.triangles == 0) faces.push_back(face.name);
  return {{"file", g.file},
          {"stopped", g.rounds.stopped},
          {"rounds", rounds},
          {"bridges", bridges},
          {"faces_bridged", faces}};
}

Json geometry_json(const std::vector<GeometryGrid>& grids) {
  Json result = Json::array();
  for (const GeometryGrid& grid : grids) result.push_back(to_json(grid));
  return result;
}

Json inputs_json(const std::vector<InputFile>& inputs) {
  Json result = Json::array();
  for (const InputFile& file : inputs)
    result.push_back({{"path", file.path},
                      {"bytes", file.bytes},
                      {"hash", file.hash},
                      {"num_points", file.num_points},
                      {"num_cells", file.num_cells}});
  return result;
}

}  // namespace

Json to_json(const std::vector<Place>& places, std::size_t most) {
  Json result = Json::array();
  for (std::size_t i = 0; i < std::min(most, places.size()); ++i)
    result.push_back({{"at", to_json(places[i].at)}, {"ids", places[i].ids}});
  return result;
}

Json to_json(const std::vector<Finding>& findings) {
  Json result = Json::array();
  for (const Finding& f : findings)
    result.push_back({{"kind", f.kind},
                      {"severity", severity_name(f.severity)},
                      {"count", f.count},
                      {"message", f.message},
                      {"remedy", f.remedy},
                      {"places", to_json(f.places)}});
  return result;
}

Json to_json(const SurfaceReport& r) {
  Json components = Json::array();
  for (const SurfaceComponent& c : r.components) components.push_back(to_json(c));
  return {{"num_vertices", r.num_vertices},
          {"num_triangles", r.num_triangles},
          {"num_edges", r.num_edges},
          {"box", to_json(r.box)},
          {"area", number(r.area)},
          {"volume", number(r.volume)},
          {"min_edge", number(r.min_edge)},
          {"max_edge", number(r.max_edge)},
          {"mean_edge", number(r.mean_edge)},
          {"min_angle", number(r.min_angle_deg)},
          {"min_dihedral", number(r.min_dihedral_deg)},
          {"is_closed", r.is_closed},
          {"is_manifold", r.is_manifold},
          {"is_oriented", r.is_oriented},
          {"can_bound_volume", r.can_bound_volume},
          {"reoriented", r.reoriented},
          {"likely_unit", r.likely_unit},
          {"components", components},
          {"findings", to_json(r.findings)}};
}

Json to_json(const QualityReport& r) {
  Json measures = Json::object();
  for (const Measure& m : r.measures) measures[m.name] = to_json(m);
  return {{"num_points", r.num_points},
          {"num_cells", r.num_cells},
          {"num_boundary_faces", r.num_boundary_faces},
          {"volume", number(r.volume)},
          {"cells_below_5_deg", r.cells_below_5_deg},
          {"cells_below_10_deg", r.cells_below_10_deg},
          {"measures", measures}};
}

Json to_json(const RefineGridReport& r) {
  return {{"levels", r.levels},
          {"num_points", r.num_points},
          {"points_on_surface", r.points_on_surface},
          {"points_on_features", r.points_on_features},
          {"largest_move", number(r.largest_move)},
          {"boundary_points", r.boundary_points},
          {"out_of_reach", r.out_of_reach},
          {"halved", r.halved},
          {"reversed", r.reversed},
          {"reversed_places", to_json(r.reversed_places, kMaxPlaces)},
          {"groups_not_in_geometry", r.groups_not_in_model}};
}

/// Length, area or volume of one cell; 0 of a point, NaN of what has no fixed shape.
static double measure_of(const Mesh& mesh, CellType type, std::span<const VertexId> vertices) {
  std::vector<Point> corners;
  for (const VertexId v : vertices) corners.push_back(mesh.points[v]);
  if (type == CellType::vertex) return 0;
  if (type == CellType::line) return distance(corners[0], corners[1]);
  if (dimension(type) == 2) return length(facet_geometry(corners).area);
  const CellShape& shape = shape_of(type);
  if (shape.num_facets == 0) return std::nan("");
  std::vector<FacetGeometry> facets;
  for (int f = 0; f < shape.num_facets; ++f) {
    const LocalFacet& local = shape.facets[f];
    std::array<Point, 4> p;
    for (int i = 0; i < local.num_vertices; ++i) p[i] = corners[local.vertices[i]];
    facets.push_back(facet_geometry({p.data(), static_cast<std::size_t>(local.num_vertices)}));
  }
  return cell_geometry(corners, shape, facets).volume;
}

Json groups_json(const Mesh& mesh, int dim, double factor, const std::map<std::string, std::string>& colours) {
  std::vector<std::size_t> count(mesh.groups.size());
  std::vector<double> measure(mesh.groups.size());
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != dim) continue;
    for (std::size_t cell = 0; cell < block.group.size(); ++cell) {
      const GroupId group = block.group[cell];
      if (!group.is_valid()) continue;
      ++count[group.index()];
      measure[group.index()] += measure_of(mesh, block.type, block[cell]);
    }
  }
  Json result = Json::array();
  for (std::size_t g = 0; g < count.size(); ++g) {
    const Group& group = mesh.groups[GroupId(g)];
    if (group.dimension != dim) continue;
    const auto colour = colours.find(group.name);
    result.push_back({{"name", group.name},
                      {"kind", group.kind},
                      {"colour", colour == colours.end() ? "" : colour->second},
                      {"num_cells", count[g]},
                      {"measure", number(std::pow(factor, dim) * measure[g])}});
  }
  return result;
}

Json options_json(const Options& options) { return to_json(option_tree(options)); }

const char* severity_name(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      return "error";
  }
  return "error";
}

const char* outcome_name(ExitCode code) {
  switch (code) {
    case ExitCode::done:
      return "done";
    case ExitCode::internal_error:
      return "internal_error";
    case ExitCode::usage:
      return "usage";
    case ExitCode::bad_input:
      return "bad_input";
    case ExitCode::meshing_failed:
      return "meshing_failed";
    case ExitCode::gate_not_met:
      return "gate_not_met";
    case ExitCode::limit_reached:
      return "limit_reached";
    case ExitCode::cannot_write:
      return "cannot_write";
    case ExitCode::interrupted:
      return "interrupted";
  }
  return "internal_error";
}

void write_text_file(const std::string& path, const std::string& text) {
  Replacement file(path);
  Output out(file.temporary(), path);
  out.text(text);
  out.close();
  file.commit();
}

/// The mesh is as it was written, perhaps in other units than all else. @return what its lengths are times of
static double units_of_mesh(const JobResult& result, const Options& options) {
  const bool is_rescaled = !options.output.units.empty() && writes_grid(options) && result.scale.metres_per_unit > 0;
  return is_rescaled ? metres_per_unit(options.output.units) / result.scale.metres_per_unit : 1;
}

std::string report_json(const JobResult& result, const Options& options, const std::string& command) {
  Json stages = Json::array();
  for (const StageTime& stage : result.stage_times)
    stages.push_back({{"stage", stage.stage}, {"seconds", number(stage.seconds)}});
  const std::size_t cells = result.report.quality.num_cells;
  const double factor = units_of_mesh(result, options);
  Json json = {
      {"delfront", kVersion},
      {"command", command},
      {"outcome", outcome_name(result.exit_code)},
      {"exit_code", static_cast<int>(result.exit_code)},
      {"error", result.error.empty() ? Json(nullptr) : Json(result.error)},
      {"places", to_json(result.places, kMaxPlaces)},
      {"stage", result.stage},
      {"inputs", inputs_json(result.inputs)},
      {"options", options_json(options)},
      {"scale",
       {{"diagonal", number(result.scale.diagonal)},
        {"longest_side", number(result.scale.longest_side)},
        {"metres_per_unit", result.scale.metres_per_unit > 0 ? Json(result.scale.metres_per_unit) : Json(nullptr)}}},
      {"surface", to_json(result.report.surface)},
      {"surface_grid", result.report.surface_grid.triangles || !result.report.surface_grid.fallbacks.empty()
                           ? to_json(result.report.surface_grid)
                           : Json(nullptr)},
      {"geometry", geometry_json(result.geometry)},
      {"recovery", to_json(result.report.recovery)},
      {"refine", to_json(result.report.refine)},
      {"front", to_json(result.report.front)},
      {"improve", to_json(result.report.improve)},
      {"levels", to_json(result.report.levels)},
      {"quality", to_json(result.report.quality)},
      {"size_fit", result.report.size_fit ? to_json(*result.report.size_fit) : Json(nullptr)},
      {"grid_findings", result.grid_findings ? to_json(*result.grid_findings) : Json(nullptr)},
      {"boundaries", groups_json(result.mesh, 2, factor, result.colours)},
      {"regions", groups_json(result.mesh, 3, factor)},
      {"curves", groups_json(result.mesh, 1, factor)},
      {"points", groups_json(result.mesh, 0, factor)},
      {"estimate", result.estimate ? to_json(*result.estimate) : Json(nullptr)},
      {"failed_gates", result.failed_gates},
      {"files_written", result.files_written},
      {"starter_files", {{"written", result.starter.written}, {"kept", result.starter.kept}}},
      {"defects_file", result.defects_file},
      {"partial_file", result.partial_file},
      {"name_changes", result.name_changes},
      {"warnings", result.warnings},
      {"stages", stages},
      {"seconds", number(result.seconds)},
      {"peak_memory_bytes", result.peak_memory},
      {"bytes_per_cell", cells ? Json(result.peak_memory / cells) : Json(nullptr)},
  };
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace delfront
