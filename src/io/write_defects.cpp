// SPDX-License-Identifier: Apache-2.0
// Findings as a VTP: one vertex a place, one line or polygon an outline, each with kind_id, severity, finding and
// first_id. The kinds' names stand in the field data, "kind:<name>" = its kind_id.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "io/output.hpp"
#include "io/vtk_output.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

/// The values that every point and every cell carries.
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

/// Cells of one sort: offsets into the points, which stand one after the other, and their columns.
struct Drawn {
  std::vector<std::int64_t> connectivity, offsets;
  Columns columns;
};

struct DefectData {
  std::map<std::string, std::int32_t> kinds;
  std::vector<double> points;
  Columns of_points;
  Drawn verts, lines, polys;

  void add(Drawn& sort, const std::vector<Point>& corners, std::int32_t kind, const Finding& finding,
           std::int32_t index, std::int64_t id) {
    for (Point p : corners) {
      if (!is_finite(p)) p = {};  // the viewer would refuse the whole file
      sort.connectivity.push_back(static_cast<std::int64_t>(points.size() / 3));
      points.insert(points.end(), {p.x, p.y, p.z});
      of_points.add(kind, finding, index, id);
    }
    sort.offsets.push_back(static_cast<std::int64_t>(sort.connectivity.size()));
    sort.columns.add(kind, finding, index, id);
  }
};

/// The outlines of a finding, each once: a triangle that crosses ten others is named ten times.
std::vector<const Outline*> distinct_outlines(const Finding& finding) {
  std::vector<const Outline*> all;
  for (const Outline& outline : finding.outlines) all.push_back(&outline);
  const auto key = [](Point p) { return std::tuple(p.x, p.y, p.z); };
  const auto is_before = [&](const Outline* a, const Outline* b) {
    if (a->id != b->id) return a->id < b->id;
    return std::lexicographical_compare(a->corners.begin(), a->corners.end(), b->corners.begin(), b->corners.end(),
                                        [&](Point p, Point q) { return key(p) < key(q); });
  };
  std::sort(all.begin(), all.end(), is_before);
  const auto is_same = [](const Outline* a, const Outline* b) { return a->id == b->id && a->corners == b->corners; };
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
  return all;
}

DefectData gather(const std::vector<Finding>& findings) {
  DefectData data;
  std::int32_t index = 0;
  for (const Finding& finding : findings) {
    const std::int32_t kind =
        data.kinds.emplace(finding.kind, static_cast<std::int32_t>(data.kinds.size())).first->second;
    for (const Place& place : finding.places)
      data.add(data.verts, {place.at}, kind, finding, index, place.ids.empty() ? -1 : std::int64_t{place.ids[0]});
    for (const Outline* outline : distinct_outlines(finding)) {
      if (outline->corners.size() < 2) continue;
      Drawn& sort = outline->corners.size() == 2 ? data.lines : data.polys;
      data.add(sort, outline->corners, kind, finding, index, outline->id);
    }
    ++index;
  }
  return data;
}

void write_cells(VtkOutput& vtk, const char* tag, const Drawn& cells) {
  vtk.open(tag);
  vtk.own("connectivity", 1, cells.connectivity);
  vtk.own("offsets", 1, cells.offsets);
  vtk.close(tag);
}

void write_vtp(const DefectData& data, Output& out) {
  VtkOutput vtk(out, {}, "PolyData");
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
  vtk.open(fmt::format(
      "Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\"",
      data.points.size() / 3, data.verts.offsets.size(), data.lines.offsets.size(), data.polys.offsets.size()));
  Columns of_cells = data.verts.columns;
  of_cells.append(data.lines.columns);
  of_cells.append(data.polys.columns);
  vtk.open("PointData");
  data.of_points.write(vtk);
  vtk.close("PointData");
  vtk.open("CellData");
  of_cells.write(vtk);
  vtk.close("CellData");
  vtk.open("Points");
  vtk.own("Points", 3, data.points);
  vtk.close("Points");
  write_cells(vtk, "Verts", data.verts);
  write_cells(vtk, "Lines", data.lines);
  write_cells(vtk, "Polys", data.polys);
  vtk.close("Piece");
  vtk.close("PolyData");
  vtk.finish();
}

}  // namespace

void write_defects(const std::vector<Finding>& findings, const std::string& path, Context& context) {
  context.check_limits();
  Replacement replacement(path);
  Output out(replacement.temporary(), path);
  write_vtp(gather(findings), out);
  out.close();
  replacement.commit();
}

}  // namespace delfront
