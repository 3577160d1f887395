// SPDX-License-Identifier: Apache-2.0
// Quality of a grid in three sweeps: cells (angles, ratios, centres, volumes), facets (what two neighbours make of each
// other), edges. Each sweep feeds its values to MeasureBuilders, so that no list of values is kept.
//
// 3-D: min_dihedral, max_dihedral (all cells); mean_ratio 12 (3V)^(2/3) / sum l^2, radius_ratio 3 r_in / R,
// aspect_ratio l_max / (2 sqrt(6) r_in) (tetrahedra; 1 for the regular one). 2-D and surfaces: min_angle, max_angle;
// mean_ratio 4 sqrt(3) A / sum l^2, radius_ratio 2 r_in / R, aspect_ratio l_max / (2 sqrt(3) r_in) (triangles).
// max_nonortho, skewness, openfoam_aspect: as OpenFOAM's checkMesh defines them; the mean of max_nonortho is the angle
// of the mean cosine, which is what checkMesh prints as the average. volume_ratio: larger over smaller of two cells
// with a common facet. edge_length: every edge once.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "delfront/grid_check.hpp"
#include "fmt/format.h"
#include "mesh/cell_geometry.hpp"
#include "mesh/facet_table.hpp"
#include "mesh/measure.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCellsBetweenChecks = 16384;

class QualitySweep {
 public:
  QualitySweep(const Mesh& mesh, Context& context);
  QualityReport run();

 private:
  void sweep_cells();
  void measure_cell(const CellShape& shape, std::span<const VertexId> vertices, std::size_t cell);
  void measure_openfoam_aspect(std::span<const FacetGeometry> facets, std::size_t cell);
  void sweep_facets();
  void measure_facet(std::span<const HalfFacet> sides);
  void sweep_edges();
  void take_measures();
  MeasureBuilder& measure(MeasureId id);

  const Mesh& mesh_;
  Context& context_;
  int dimension_;
  CellRange cells_;
  std::vector<CellGeometry> geometry_;
  std::array<std::optional<MeasureBuilder>, kNumMeasures> builders_;
  double sum_of_cosines_ = 0;
  std::size_t num_inner_facets_ = 0;
  QualityReport report_;
};

void check_indices(const Mesh& mesh, const CellRange& cells) {
  for (const CellRange::Part& part : cells.parts())
    for (const VertexId v : part.block->vertices)
      if (v.index() >= mesh.points.size())
        throw InputError(fmt::format("quality: a {} names point {}, but the grid has {} points; see check()",
                                     name_of(part.block->type), v.value, mesh.points.size()));
}

QualitySweep::QualitySweep(const Mesh& mesh, Context& context)
    : mesh_(mesh), context_(context), dimension_(mesh.top_dimension()), cells_(mesh, dimension_) {
  check_indices(mesh, cells_);
  // These exist without a value too (one cell has no inner facet), so that a gate on them is met, not unknown.
  using enum MeasureId;
  if (dimension_ == 3)
    for (const MeasureId id : {min_dihedral, max_dihedral, openfoam_aspect}) measure(id);
  if (dimension_ == 2)
    for (const MeasureId id : {min_angle, max_angle}) measure(id);
  if (dimension_ == 3 || (dimension_ == 2 && mesh.dimension == 2))
    for (const MeasureId id : {max_nonortho, skewness, volume_ratio}) measure(id);
}

MeasureBuilder& QualitySweep::measure(MeasureId id) {
  auto& builder = builders_[static_cast<std::size_t>(id)];
  if (!builder) builder.emplace(id);
  return *builder;
}

QualityReport QualitySweep::run() {
  report_.num_points = mesh_.points.size();
  report_.num_cells = cells_.size();
  if (dimension_ < 2) return std::move(report_);
  sweep_cells();
  sweep_facets();
  sweep_edges();
  take_measures();
  return std::move(report_);
}

void QualitySweep::sweep_cells() {
  geometry_.resize(cells_.size());
  for (const CellRange::Part& part : cells_.parts()) {
    const CellShape& shape = shape_of(part.block->type);
    const std::size_t end = shape.num_facets > 0 ? part.block->size() : 0;
    for (std::size_t cell = 0; cell < end; ++cell) {
      if (cell % kCellsBetweenChecks == 0) context_.check_limits();
      measure_cell(shape, (*part.block)[cell], part.first + cell);
    }
  }
}

void QualitySweep::measure_cell(const CellShape& shape, std::span<const VertexId> vertices, std::size_t cell) {
  Point corners[8];
  for (std::size_t i = 0; i < vertices.size(); ++i) corners[i] = mesh_.points[vertices[i]];
  const std::span<const Point> all(corners, vertices.size());
  const auto id = static_cast<std::uint32_t>(cell);
  if (dimension_ == 2) {
    const CellQuality quality = measure_polygon(all);
    const FacetGeometry face = facet_geometry(all);
    geometry_[cell] = {face.centre, mesh_.dimension == 2 ? face.area.z : length(face.area)};
    measure(MeasureId::min_angle).add(quality.min_angle, id);
    measure(MeasureId::max_angle).add(quality.max_angle, id);
    if (all.size() == 3) {
      measure(MeasureId::mean_ratio).add(quality.mean_ratio, id);
      measure(MeasureId::radius_ratio).add(quality.radius_ratio, id);
      measure(MeasureId::aspect_ratio).add(quality.aspect_ratio, id);
    }
    report_.volume += geometry_[cell].volume;
    return;
  }
  FacetGeometry facet_storage[6];
  for (int f = 0; f < shape.num_facets; ++f) {
    const LocalFacet& facet = shape.facets[f];
    Point p[4];
    for (int i = 0; i < facet.num_vertices; ++i) p[i] = corners[facet.vertices[i]];
    facet_storage[f] = facet_geometry({p, static_cast<std::size_t>(facet.num_vertices)});
  }
  const std::span<const FacetGeometry> facets(facet_storage, static_cast<std::size_t>(shape.num_facets));
  geometry_[cell] = cell_geometry(all, shape, facets);
  report_.volume += geometry_[cell].volume;
  CellQuality quality;
  measure_dihedrals(shape, facets, quality);
  measure(MeasureId::min_dihedral).add(quality.min_angle, id);
  measure(MeasureId::max_dihedral).add(quality.max_angle, id);
  report_.cells_below_5_deg += quality.min_angle < 5;
  report_.cells_below_10_deg += quality.min_angle < 10;
  measure_openfoam_aspect(facets, cell);
  if (shape.num_corners > 1) return;
  measure_tet_ratios(corners, facets, geometry_[cell].volume, quality);
  measure(MeasureId::mean_ratio).add(quality.mean_ratio, id);
  measure(MeasureId::radius_ratio).add(quality.radius_ratio, id);
  measure(MeasureId::aspect_ratio).add(quality.aspect_ratio, id);
}

/// OpenFOAM's cell aspect ratio: of the sums of |area| along the axes the largest over the smallest, or a sixth of all
/// three over V^(2/3) where that is larger.
void QualitySweep::measure_openfoam_aspect(std::span<const FacetGeometry> facets, std::size_t cell) {
  Point sum;
  for (const FacetGeometry& facet : facets)
    sum = sum + Point{std::abs(facet.area.x), std::abs(facet.area.y), std::abs(facet.area.z)};
  const double tiny = 1e-150;
  const double largest = std::max({sum.x, sum.y, sum.z}), smallest = std::min({sum.x, sum.y, sum.z});
  const double root = std::cbrt(std::max(geometry_[cell].volume, tiny));
  const double by_volume = (sum.x + sum.y + sum.z) / 6 / (root * root);
  measure(MeasureId::openfoam_aspect)
      .add(std::max(largest / (smallest + tiny), by_volume), static_cast<std::uint32_t>(cell));
}

void QualitySweep::sweep_facets() {
  const std::vector<HalfFacet> table = build_facet_table(mesh_, cells_, CellRange(mesh_, -1));
  context_.check_limits();
  std::size_t visited = 0;
  for_each_facet(table, [&](std::span<const HalfFacet> sides, std::span<const HalfFacet>) {
    if (++visited % kCellsBetweenChecks == 0) context_.check_limits();
    measure_facet(sides);
  });
}

void QualitySweep::measure_facet(std::span<const HalfFacet> sides) {
  report_.num_boundary_faces += sides.size() == 1;
  if (sides.size() > 2 || (dimension_ == 2 && mesh_.dimension == 3)) return;
  const CellRange::Part& part = cells_.part_of(sides[0].cell);
  const auto vertices = (*part.block)[sides[0].cell - part.first];
  const LocalFacet& local = shape_of(part.block->type).facets[sides[0].local_facet];
  Point storage[4];
  for (int i = 0; i < local.num_vertices; ++i) storage[i] = mesh_.points[vertices[local.vertices[i]]];
  const std::span<const Point> corners(storage, static_cast<std::size_t>(local.num_vertices));
  const FacetGeometry facet = facet_geometry(corners);
  const CellGeometry& owner = geometry_[sides[0].cell];
  if (sides.size() == 1) {
    measure(MeasureId::skewness).add(boundary_skewness(corners, facet, owner.centre), sides[0].cell);
    return;
  }
  const CellGeometry& neighbour = geometry_[sides[1].cell];
  const double angle = nonorthogonality(owner.centre, neighbour.centre, facet.area);
  sum_of_cosines_ += std::cos(angle / 180 * std::numbers::pi);
  ++num_inner_facets_;
  const double small = std::min(owner.volume, neighbour.volume), large = std::max(owner.volume, neighbour.volume);
  const auto add = [&](MeasureId id, double value) { measure(id).add(value, sides[0].cell, sides[1].cell); };
  add(MeasureId::max_nonortho, angle);
  add(MeasureId::skewness, inner_skewness(corners, facet, owner.centre, neighbour.centre));
  add(MeasureId::volume_ratio, small > 0 ? large / small : std::numeric_limits<double>::infinity());
}

void QualitySweep::sweep_edges() {
  const auto edges = find_edges(mesh_, cells_);
  context_.check_limits();
  if (edges.empty()) return;
  const auto length_of = [&](std::pair<std::uint32_t, std::uint32_t> edge) {
    return distance(mesh_.points[VertexId(edge.first)], mesh_.points[VertexId(edge.second)]);
  };
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const auto& edge : edges) {
    low = std::min(low, length_of(edge));
    high = std::max(high, length_of(edge));
  }
  MeasureBuilder& lengths = measure(MeasureId::edge_length);
  lengths.set_range(low, high);
  for (const auto& edge : edges) lengths.add(length_of(edge), edge.first, edge.second);
}

void QualitySweep::take_measures() {
  for (std::size_t i = 0; i < kNumMeasures; ++i) {
    if (!builders_[i]) continue;
    Measure measure = builders_[i]->take();
    const auto id = static_cast<MeasureId>(i);
    const auto place_of = [&](std::uint32_t entity) {
      return id == MeasureId::edge_length ? mesh_.points[VertexId(entity)] : geometry_[entity].centre;
    };
    for (Place& place : measure.worst) {
      for (const std::uint32_t entity : place.ids)
        place.at = place.at + place_of(entity) / static_cast<double>(place.ids.size());
    }
    if (id == MeasureId::max_nonortho && num_inner_facets_ > 0)
      measure.mean = std::acos(std::clamp(sum_of_cosines_ / static_cast<double>(num_inner_facets_), -1.0, 1.0)) * 180 /
                     std::numbers::pi;
    report_.measures.push_back(std::move(measure));
  }
}

}  // namespace

const Measure* QualityReport::find(const std::string& name) const {
  for (const Measure& measure : measures)
    if (measure.name == name) return &measure;
  return nullptr;
}

QualityReport measure_quality(const Mesh& mesh, Context& context) { return QualitySweep(mesh, context).run(); }

}  // namespace delfront
