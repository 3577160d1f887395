// SPDX-License-Identifier: Apache-2.0
// Findings as a VTP: one vertex a place with kind_id, severity, finding and first_id; the triangles that the places
// name where their ids are triangles. The kinds' names stand in the field data, "kind:<name>" = its kind_id.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "io/cells.hpp"
#include "io/output.hpp"
#include "io/vtk_output.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

/// Kinds whose ids are triangles of the surface.
bool names_triangles(const std::string& kind) {
  return kind.find("triangle") != std::string::npos || kind.find("self_intersection") != std::string::npos ||
         kind.find("overlap") != std::string::npos;
}

/// The values that every vertex and every triangle carries.
struct Columns {
  std::vector<std::int32_t> kind, severity, finding;
  std::vector<std::int64_t> first_id;
  void add(std::int32_t kind_id, const Finding& from, std::int32_t index, std::int64_t id) {
    kind.push_back(kind_id);
    severity.push_back(static_cast<std::int32_t>(from.severity));
    finding.push_back(index);
    first_id.push_back(id);
  }
  void append(const Columns& other) {
    kind.insert(kind.end(), other.kind.begin(), other.kind.end());
    severity.insert(severity.end(), other.severity.begin(), other.severity.end());
    finding.insert(finding.end(), other.finding.begin(), other.finding.end());
    first_id.insert(first_id.end(), other.first_id.begin(), other.first_id.end());
  }
  void write(VtkOutput& vtk) const {
    vtk.own("kind_id", 1, kind);
    vtk.own("severity", 1, severity);
    vtk.own("finding", 1, finding);
    vtk.own("first_id", 1, first_id);
  }
};

struct DefectData {
  std::map<std::string, std::int32_t> kinds;
  std::vector<double> points;  // of the places, then corners of the triangles
  Columns places, corners, triangles;

  void add_point(Point p) { points.insert(points.end(), {p.x, p.y, p.z}); }
};

void add_triangles(const Finding& finding, std::int32_t index, std::int32_t kind, const Mesh& surface,
                   DefectData& data) {
  const CellBlock* block = surface.find_block(CellType::triangle);
  if (!block) return;
  std::vector<std::uint32_t> ids;
  for (const Place& place : finding.places) ids.insert(ids.end(), place.ids.begin(), place.ids.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (std::uint32_t id : ids) {
    if (id >= block->size()) continue;
    for (VertexId v : (*block)[id]) {
      data.add_point(surface.points[v]);
      data.corners.add(kind, finding, index, id);
    }
    data.triangles.add(kind, finding, index, id);
  }
}

DefectData gather(const std::vector<Finding>& findings, const Mesh* surface) {
  DefectData data;
  std::int32_t index = 0;
  for (const Finding& finding : findings) {
    const std::int32_t kind =
        data.kinds.emplace(finding.kind, static_cast<std::int32_t>(data.kinds.size())).first->second;
    for (const Place& place : finding.places) {
      data.add_point(is_finite(place.at) ? place.at : Point{});
      data.places.add(kind, finding, index, place.ids.empty() ? -1 : std::int64_t{place.ids[0]});
    }
    ++index;
  }
  index = 0;
  for (const Finding& finding : findings) {
    if (surface && names_triangles(finding.kind))
      add_triangles(finding, index, data.kinds[finding.kind], *surface, data);
    ++index;
  }
  return data;
}

void write_cells(VtkOutput& vtk, const char* tag, std::size_t first, std::size_t count, std::size_t corners) {
  std::vector<std::int64_t> connectivity, offsets;
  for (std::size_t i = 0; i < count * corners; ++i) connectivity.push_back(static_cast<std::int64_t>(first + i));
  for (std::size_t i = 1; i <= count; ++i) offsets.push_back(static_cast<std::int64_t>(i * corners));
  vtk.open(tag);
  vtk.own("connectivity", 1, connectivity);
  vtk.own("offsets", 1, offsets);
  vtk.close(tag);
}

void write_vtp(const DefectData& data, Output& out) {
  VtkOutput vtk(out, {}, "PolyData");
  const std::size_t num_places = data.places.kind.size(), num_triangles = data.triangles.kind.size();
  vtk.open("PolyData");
  if (!data.kinds.empty()) {
    vtk.open("FieldData");
    for (const auto& [kind, id] : data.kinds)
      vtk.line(
          fmt::format("<DataArray type=\"Int32\" Name=\"kind:{}\" NumberOfComponents=\"1\" NumberOfTuples=\"1\" "
                      "format=\"ascii\">{}</DataArray>",
                      escape_xml(kind), id));
    vtk.close("FieldData");
  }
  vtk.open(
      fmt::format("Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                  "NumberOfPolys=\"{}\"",
                  data.points.size() / 3, num_places, num_triangles));
  Columns of_points = data.places, of_cells = data.places;
  of_points.append(data.corners);
  of_cells.append(data.triangles);
  vtk.open("PointData");
  of_points.write(vtk);
  vtk.close("PointData");
  vtk.open("CellData");
  of_cells.write(vtk);
  vtk.close("CellData");
  vtk.open("Points");
  vtk.own("Points", 3, data.points);
  vtk.close("Points");
  write_cells(vtk, "Verts", 0, num_places, 1);
  write_cells(vtk, "Polys", num_places, num_triangles, 3);
  vtk.close("Piece");
  vtk.close("PolyData");
  vtk.finish();
}

}  // namespace

void write_defects(const std::vector<Finding>& findings, const std::string& path, const Mesh* surface,
                   Context& context) {
  context.check_limits();
  Replacement replacement(path);
  Output out(replacement.temporary(), path);
  write_vtp(gather(findings, surface), out);
  out.close();
  replacement.commit();
}

}  // namespace delfront
