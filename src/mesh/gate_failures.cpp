// SPDX-License-Identifier: Apache-2.0
// The grid is measured once more, with long lists of the worst: gates rarely fail, and a report should stay short.
#include <algorithm>
#include <optional>

#include "delfront/grid_check.hpp"
#include "mesh/cell_shape.hpp"
#include "mesh/facet_table.hpp"
#include "mesh/gates.hpp"

namespace delfront {

namespace {

/// What a gate asks of each place. Counts of cells below an angle ask it of the angle.
struct PlaceGate {
  const Measure* measure;
  Gate gate;
};

std::optional<PlaceGate> gate_of_places(const QualityReport& report, const Gate& gate) {
  for (const auto& [count, limit] : {std::pair{"cells_below_5_deg", 5.0}, {"cells_below_10_deg", 10.0}}) {
    if (gate.name != count) continue;
    const Measure* angle = report.find("min_dihedral");
    if (!angle) angle = report.find("min_angle");
    if (!angle || gate.is_from_below()) return std::nullopt;
    return PlaceGate{angle, {angle->name, ">=", limit}};
  }
  const Measure* measure = report.find(gate.name);
  if (!measure || measure->worst_is_low != gate.is_from_below()) return std::nullopt;
  return PlaceGate{measure, gate};
}

class OutlineMaker {
 public:
  explicit OutlineMaker(const Mesh& mesh) : mesh_(mesh), cells_(mesh, mesh.top_dimension()) {}

  void add(const Measure& measure, const std::vector<std::uint32_t>& ids, Finding& finding) const {
    if (measure.name == "edge_length")
      add_outline(ids[0], {VertexId(ids[0]), VertexId(ids[1])}, finding);
    else if (ids.size() == 1)
      for (const std::vector<VertexId>& face : faces_of(ids[0])) add_outline(ids[0], face, finding);
    else
      add_common_face(ids[0], ids[1], finding);
  }

 private:
  /// Facets of a volume cell, edges of a face.
  std::vector<std::vector<VertexId>> facets_of(std::uint32_t cell) const {
    const CellShape& shape = shape_of(cells_.part_of(cell).block->type);
    const std::span<const VertexId> vertices = cells_[cell];
    std::vector<std::vector<VertexId>> facets(static_cast<std::size_t>(shape.num_facets));
    for (std::size_t f = 0; f < facets.size(); ++f)
      for (int i = 0; i < shape.facets[f].num_vertices; ++i)
        facets[f].push_back(vertices[static_cast<std::size_t>(shape.facets[f].vertices[i])]);
    return facets;
  }

  std::vector<std::vector<VertexId>> faces_of(std::uint32_t cell) const {
    if (mesh_.top_dimension() == 3) return facets_of(cell);
    const std::span<const VertexId> vertices = cells_[cell];
    return {{vertices.begin(), vertices.end()}};
  }

  void add_common_face(std::uint32_t one, std::uint32_t other, Finding& finding) const {
    const std::span<const VertexId> there = cells_[other];
    for (const std::vector<VertexId>& facet : facets_of(one)) {
      const auto is_there = [&](VertexId v) { return std::find(there.begin(), there.end(), v) != there.end(); };
      if (std::all_of(facet.begin(), facet.end(), is_there)) add_outline(one, facet, finding);
    }
  }

  void add_outline(std::uint32_t id, const std::vector<VertexId>& corners, Finding& finding) const {
    Outline outline{id, {}};
    for (const VertexId v : corners) outline.corners.push_back(mesh_.points[v]);
    finding.outlines.push_back(std::move(outline));
  }

  const Mesh& mesh_;
  CellRange cells_;
};

}  // namespace

std::vector<Finding> find_gate_failures(const Mesh& mesh, const std::string& gates, Context& context) {
  const QualityReport report = measure_quality(mesh, context, kMaxPlaces);
  const OutlineMaker outlines(mesh);
  std::vector<Finding> findings;
  for (const Gate& gate : parse_gates(gates)) {
    Finding finding{"gate_" + gate.name, Severity::error, 0, judge(report, gate), "", {}};
    if (finding.message.empty()) continue;
    if (const auto asked = gate_of_places(report, gate)) {
      const Measure& measure = *asked->measure;
      for (std::size_t i = 0; i < measure.worst.size() && !is_met(measure.worst_values[i], asked->gate); ++i) {
        finding.places.push_back(measure.worst[i]);
        outlines.add(measure, measure.worst[i].ids, finding);
      }
    }
    finding.count = std::max<std::size_t>(finding.places.size(), 1);
    findings.push_back(std::move(finding));
  }
  return findings;
}

}  // namespace delfront
