// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inspect.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "delfront/model.hpp"
#include "pipeline/boundaries.hpp"
#include "pipeline/facts_text.hpp"
#include "pipeline/geometry_job.hpp"
#include "pipeline/planar_job.hpp"
#include "pipeline/report_json.hpp"

namespace delfront {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t kManyFaces = 2000;  ///< of geometry whose usual grid would take long

/// Lines, or a surface: what build_model and build_planar_domain take.
void look_at_inputs(const std::vector<NamedMesh>& inputs, Inspected& result, Context& context) {
  result.is_of_lines = is_planar_job(inputs) && inputs[0].mesh.top_dimension() == 1;
  if (result.is_of_lines) {
    result.findings = check_planar_domain(build_planar_domain(inputs, context), context);
    result.mesh = std::make_shared<Mesh>(inputs[0].mesh);
    return;
  }
  const Model model = build_model(inputs, context);
  result.surface = check_surface(model, context);
  if (!result.cad.unit.empty()) result.surface.likely_unit.clear();  // it is known
  result.findings = result.surface.findings;
  result.mesh = std::make_shared<Mesh>(surface_mesh(model));  // the facts are those of the welded surface
}

/// Smooth geometry that gets no grid is told about by its edges.
void tell_without_grid(const MeshingError& fault, Inspected& result) {
  constexpr int kPieces = 16;
  const std::size_t num_faces = result.brep.faces.size();
  result.brep_grid = {};
  result.brep_grid.faces.resize(num_faces);
  result.face_places.resize(num_faces);
  auto mesh = std::make_shared<Mesh>();
  std::vector<Box> box_of_edge;
  for (const BrepEdge& edge : result.brep.edges) {
    Box& box = box_of_edge.emplace_back();
    for (int i = 0; i <= kPieces && !edge.is_degenerate(); ++i) {
      mesh->points.push_back(edge.curve->at(edge.range[0] + i * (edge.range[1] - edge.range[0]) / kPieces));
      box.add(mesh->points[VertexId(mesh->points.size() - 1)]);
    }
  }
  for (std::size_t f = 0; f < num_faces; ++f) {
    FacePlace& place = result.face_places[f];
    for (const auto& loop : result.brep.faces[FaceId(f)].loops)
      for (const BrepUse& use : loop) {
        if (result.brep.edges[use.edge].is_degenerate()) continue;
        place.box.add(box_of_edge[use.edge.index()].low);
        place.box.add(box_of_edge[use.edge.index()].high);
      }
    place.at = 0.5 * (place.box.low + place.box.high);
  }
  result.findings = {{"no_grid", Severity::error, 1, fault.what(), "", fault.places}};
  result.surface.findings = result.findings;
  result.mesh = std::move(mesh);
}

/// @param path  what errors name
Inspected inspect_brep(Brep brep, CadReport cad, const std::string& stem, const std::string& path, Context& context) {
  Inspected result;
  result.brep = std::move(brep);
  result.cad = std::move(cad);
  result.is_quick = result.cad.free_edges > 0 || result.brep.faces.size() > kManyFaces;
  Model grid;
  try {
    with_file(path, doubt_of(result.cad),
              [&] { grid = grid_to_look_at(result.brep, result.is_quick, context, result.brep_grid); });
  } catch (const MeshingError& e) {
    tell_without_grid(e, result);
    return result;
  }
  result.face_places = places_of_faces(grid, result.brep.faces.size());
  look_at_inputs({{surface_mesh(grid), stem}}, result, context);
  return result;
}

/// In which unit, and who says so.
std::string coordinates_of(const Inspected& it) {
  if (!it.cad.unit.empty()) return fmt::format("in {}, as the file says", it.cad.unit);
  if (it.surface.likely_unit.empty()) return "in a unit that the file does not say";
  return fmt::format("the file does not say the unit; probably {}", it.surface.likely_unit);
}

}  // namespace

Inspected inspect_mesh(std::shared_ptr<const Mesh> mesh, const std::string& name, Context& context) {
  const bool is_planar = is_planar_input(*mesh), is_of_lines = is_planar && mesh->top_dimension() == 1;
  if (!is_of_lines && mesh->top_dimension() < 2)
    throw InputError(fmt::format("{} has neither faces nor volume cells; there is nothing to look at", name));
  Inspected result;
  result.is_grid = !is_of_lines && (is_planar || mesh->top_dimension() == 3);
  if (!result.is_grid) {
    look_at_inputs({{*mesh, std::filesystem::path(name).stem().string()}}, result, context);
    return result;
  }
  result.mesh = std::move(mesh);
  result.findings = check(*result.mesh);
  if (!has_errors(result.findings)) result.quality = measure_quality(*result.mesh, context);
  return result;
}

Inspected inspect_file(const std::string& path, const std::string& format, Context& context) {
  if (!is_smooth_file(path))
    return inspect_mesh(std::make_shared<Mesh>(read_mesh(path, context, format)), path, context);
  CadReport cad;
  Brep brep = read_brep(path, context, cad);
  return inspect_brep(std::move(brep), std::move(cad), geometry_stem(path), path, context);
}

Inspected inspect_inputs(const std::vector<std::shared_ptr<const HeldInput>>& inputs, Context& context) {
  if (inputs.empty()) throw InputError("there is no input to look at");
  if (inputs.size() == 1 && inputs[0]->brep)
    return inspect_brep(*inputs[0]->brep, inputs[0]->cad, inputs[0]->stem, inputs[0]->stem, context);
  Inspected result;
  std::vector<NamedMesh> meshes;
  for (const std::shared_ptr<const HeldInput>& input : inputs) meshes.push_back({input->mesh, input->stem});
  look_at_inputs(meshes, result, context);
  return result;
}

Json facts_json(const std::string& name, const Inspected& it) {
  Json groups = Json::array();
  for (const Group& g : it.mesh->groups)
    groups.push_back({{"name", g.name}, {"dimension", g.dimension}, {"kind", g.kind}});
  Json cells = Json::object();
  for (const CellBlock& block : it.mesh->blocks) cells[name_of(block.type)] = block.size();
  Json json = {
      {"file", name},   {"is_grid", it.is_grid}, {"is_usable", it.is_usable()}, {"num_points", it.mesh->points.size()},
      {"cells", cells}, {"groups", groups}};
  if (it.is_grid) {
    json["findings"] = to_json(it.findings);
    json["quality"] = to_json(it.quality);
  } else if (it.is_of_lines) {
    json["findings"] = to_json(it.findings);
  } else {
    json["surface"] = to_json(it.surface);
    if (!it.brep.faces.empty()) json["geometry"] = geometry_json(it.brep, it.face_places, it.brep_grid, it.cad);
    if (!it.cad.format.empty()) json["geometry"]["cad"]["coordinates"] = coordinates_of(it);
  }
  return json;
}

std::string facts_text(const std::string& name, const Inspected& it) {
  std::string text = fmt::format("file           {}\n", name);
  if (!it.brep.faces.empty()) text += geometry_text(it.brep, it.face_places, it.brep_grid, it.cad, it.is_quick);
  text += mesh_facts_text(*it.mesh);
  if (!it.is_grid && !it.is_of_lines && !it.mesh->blocks.empty()) text += surface_facts_text(it.surface);
  if (it.is_grid && it.is_usable())
    text += fmt::format("{:<14} {:.9g}\n", it.mesh->dimension == 2 ? "area" : "volume", it.quality.volume);
  for (const Finding& f : it.findings)
    text += fmt::format("{:<14} {}: {}\n", severity_name(f.severity), f.kind, f.message);
  return text;
}

std::string check_text(const Inspected& it) {
  const bool is_surface = !it.is_grid && !it.is_of_lines && !it.mesh->blocks.empty();
  std::string text = is_surface ? surface_facts_text(it.surface) : mesh_facts_text(*it.mesh);
  if (it.findings.empty()) text += "findings       none\n";
  text += findings_text(it.findings);
  if (it.is_grid && it.is_usable()) text += quality_text(it.quality, 3);
  return text;
}

std::string verdict_text(const std::string& name, const Inspected& it) {
  const char* what = it.is_grid       ? "is not a valid grid"
                     : it.is_of_lines ? "cannot be gridded as it is"
                                      : "cannot bound a volume as it is";
  return fmt::format("{} {}", name, what);
}

std::vector<Finding> findings_with_gates(const Inspected& it, const std::string& gates, Context& context) {
  std::vector<Finding> findings = it.findings;
  if (!it.is_grid || !it.is_usable() || gates.empty()) return findings;
  for (Finding& failure : find_gate_failures(*it.mesh, gates, context)) findings.push_back(std::move(failure));
  return findings;
}

}  // namespace delfront
