// SPDX-License-Identifier: Apache-2.0
// Quality of a grid in two sweeps on all threads: cells (angles, ratios, volumes), then facets and edges (what two
// neighbours make of each other). Each sweep is cut into tasks that depend on the grid only; each task has a Tally, and
// these are merged in order, so that no list of values is kept and the report is the same for any number of threads.
// Centres and volumes are made where they are needed: memory is that of FacetSweep. Tetrahedra are measured four at a
// time (tet_lanes.hpp), all else one by one.
//
// 3-D: min_dihedral, max_dihedral (all cells); mean_ratio 12 (3V)^(2/3) / sum l^2, radius_ratio 3 r_in / R,
// aspect_ratio l_max / (2 sqrt(6) r_in) (tetrahedra; 1 for the regular one). 2-D and surfaces: min_angle, max_angle;
// mean_ratio 4 sqrt(3) A / sum l^2, radius_ratio 2 r_in / R, aspect_ratio l_max / (2 sqrt(3) r_in) (triangles).
// max_nonortho, skewness, openfoam_aspect: as OpenFOAM's checkMesh defines them; the mean of max_nonortho is the angle
// of the mean cosine, which is what checkMesh prints as the average. volume_ratio: larger over smaller of two cells
// with a common facet. edge_length: every edge once.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.hpp"
#include "delfront/grid_check.hpp"
#include "fmt/format.h"
#include "mesh/cell_geometry.hpp"
#include "mesh/facet_table.hpp"
#include "mesh/measure.hpp"
#include "mesh/tet_lanes.hpp"

namespace delfront {

namespace {

constexpr std::size_t kMaxTasks = 128, kLeastCells = 16384, kLeastBins = 4;
constexpr std::size_t kCellsBetweenChecks = 16384;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <std::size_t... i>
std::array<MeasureBuilder, kNumMeasures> make_builders(std::size_t num_worst, std::index_sequence<i...>) {
  return {MeasureBuilder(static_cast<MeasureId>(i), num_worst)...};
}

/// What one task found.
struct Tally {
  explicit Tally(std::size_t num_worst)
      : builders(make_builders(num_worst, std::make_index_sequence<kNumMeasures>())) {}

  std::array<MeasureBuilder, kNumMeasures> builders;
  double volume = 0, sum_of_cosines = 0;
  double shortest_squared = kInfinity, longest_squared = 0;  ///< edges
  std::size_t below_5_deg = 0, below_10_deg = 0, boundary_facets = 0, inner_facets = 0;

  MeasureBuilder& operator[](MeasureId id) { return builders[static_cast<std::size_t>(id)]; }
  void merge(const Tally& other);
};

void Tally::merge(const Tally& other) {
  for (std::size_t i = 0; i < kNumMeasures; ++i) builders[i].merge(other.builders[i]);
  volume += other.volume;
  sum_of_cosines += other.sum_of_cosines;
  shortest_squared = std::min(shortest_squared, other.shortest_squared);
  longest_squared = std::max(longest_squared, other.longest_squared);
  below_5_deg += other.below_5_deg;
  below_10_deg += other.below_10_deg;
  boundary_facets += other.boundary_facets;
  inner_facets += other.inner_facets;
}

class QualitySweep {
 public:
  QualitySweep(const Mesh& mesh, Context& context, std::size_t num_worst);
  QualityReport run();

 private:
  struct Corners {
    Point at[8];
    std::size_t count;
    std::span<const Point> all() const { return {at, count}; }
  };
  struct FacetBatch;

  void check_indices() const;
  void sweep_cells();
  void measure_cells(std::size_t first, std::size_t last, Tally& tally) const;
  void measure_some_tets(const VertexId* vertices, std::size_t count, std::size_t cell, Tally& tally) const;
  void measure_plane_cell(std::span<const VertexId> vertices, std::size_t cell, Tally& tally) const;
  void measure_volume_cell(const CellShape& shape, std::span<const VertexId> vertices, std::size_t cell,
                           Tally& tally) const;
  void measure_cell_edges(const CellShape& shape, const Corners& corners, Tally& tally) const;

  void sweep_facets();
  void measure_facet(std::span<const HalfFacet> sides, FacetBatch& batch, Tally& tally) const;
  bool is_between_tets(std::span<const HalfFacet> sides) const;
  void add_to_batch(std::span<const HalfFacet> sides, FacetBatch& batch, Tally& tally) const;
  void measure_batch(FacetBatch& batch, Tally& tally) const;
  void measure_any_facet(std::span<const HalfFacet> sides, Tally& tally) const;
  void measure_edges(std::span<const FacetSweep::Edge> edges, Tally& tally) const;

  Corners corners_of(std::span<const VertexId> vertices) const;
  CellGeometry geometry_of(std::size_t cell) const;
  bool is_reported(MeasureId id) const;
  QualityReport report() const;

  const Mesh& mesh_;
  Context& context_;
  int dimension_;
  CellRange cells_;
  const CellBlock* tets_ = nullptr;
  std::size_t first_tet_ = 0;
  std::size_t num_worst_;
  Tally total_;
};

/// Facets between two tetrahedra, until there are enough to measure: some more than fit into the lanes, since what was
/// just written in pieces cannot be loaded in one yet.
struct QualitySweep::FacetBatch {
  static constexpr int kGroups = 4, kSize = kGroups * kLanes;
  LanePoints points[kGroups][5] = {};
  std::uint32_t cells[kSize][2] = {};
  int size = 0;
};

QualitySweep::QualitySweep(const Mesh& mesh, Context& context, std::size_t num_worst)
    : mesh_(mesh),
      context_(context),
      dimension_(mesh.top_dimension()),
      cells_(mesh, dimension_),
      num_worst_(num_worst),
      total_(num_worst) {
  for (const CellRange::Part& part : cells_.parts()) {
    if (part.block->type != CellType::tetrahedron) continue;
    tets_ = part.block;
    first_tet_ = part.first;
  }
}

QualityReport QualitySweep::run() {
  check_indices();
  if (dimension_ >= 2) {
    sweep_cells();
    sweep_facets();
  }
  return report();
}

void QualitySweep::check_indices() const {
  constexpr std::size_t kGrain = std::size_t{1} << 18;
  for (const CellRange::Part& part : cells_.parts()) {
    const std::vector<VertexId>& vertices = part.block->vertices;
    std::atomic<std::uint32_t> largest{0};
    parallel_ranges(context_.threads, vertices.size(), kGrain, [&](std::size_t first, std::size_t last) {
      std::uint32_t here = 0;
      for (std::size_t i = first; i < last; ++i) here = std::max(here, vertices[i].value);
      for (std::uint32_t seen = largest; here > seen && !largest.compare_exchange_weak(seen, here);) {
      }
    });
    if (!vertices.empty() && largest >= mesh_.points.size())
      throw InputError(fmt::format("quality: a {} names point {}, but the grid has {} points; see check()",
                                   name_of(part.block->type), largest.load(), mesh_.points.size()));
  }
}

/// Runs task(first, last, tally) over 0 … size - 1 in ranges that depend on `size` only; the tallies in order.
template <class Task>
void merge_tasks(Context& context, std::size_t size, std::size_t least, Tally& total, const Tally& empty,
                 const Task& task) {
  const std::size_t grain = std::max(least, size / kMaxTasks + 1);
  std::vector<Tally> tallies((size + grain - 1) / grain, empty);
  parallel_ranges(context.threads, size, grain,
                  [&](std::size_t first, std::size_t last) { task(first, last, tallies[first / grain]); });
  for (const Tally& tally : tallies) total.merge(tally);
}

void QualitySweep::sweep_cells() {
  merge_tasks(context_, cells_.size(), kLeastCells, total_, Tally(num_worst_),
              [this](std::size_t first, std::size_t last, Tally& tally) { measure_cells(first, last, tally); });
}

void QualitySweep::measure_cells(std::size_t first, std::size_t last, Tally& tally) const {
  for (const CellRange::Part& part : cells_.parts()) {
    const CellShape& shape = shape_of(part.block->type);
    if (shape.num_facets == 0) continue;
    const std::size_t end = std::min(last, part.first + part.block->size());
    const std::size_t step = part.block == tets_ ? kLanes : 1;
    for (std::size_t cell = std::max(first, part.first), n = 0; cell < end; cell += step, n += step) {
      if (n % kCellsBetweenChecks == 0) context_.check_limits();
      const std::span<const VertexId> vertices = (*part.block)[cell - part.first];
      if (part.block == tets_)
        measure_some_tets(vertices.data(), std::min(end - cell, step), cell, tally);
      else if (dimension_ == 2)
        measure_plane_cell(vertices, cell, tally);
      else
        measure_volume_cell(shape, vertices, cell, tally);
    }
  }
}

void QualitySweep::measure_some_tets(const VertexId* vertices, std::size_t count, std::size_t cell,
                                     Tally& tally) const {
  LanePoints corners[4];
  for (std::size_t lane = 0; lane < kLanes; ++lane)  // lanes beyond `count` repeat the last one
    for (std::size_t i = 0; i < 4; ++i)
      corners[i].set(static_cast<int>(lane), mesh_.points[vertices[4 * std::min(lane, count - 1) + i]]);
  TetLanes tets;
  measure_tets(corners, tets);
  using enum MeasureId;
  for (std::size_t lane = 0; lane < count; ++lane) {
    const auto id = static_cast<std::uint32_t>(cell + lane);
    const double angle = tets.min_dihedral.lane[lane];
    tally.volume += tets.volume.lane[lane];
    tally.shortest_squared = std::min(tally.shortest_squared, tets.shortest_squared.lane[lane]);
    tally.longest_squared = std::max(tally.longest_squared, tets.longest_squared.lane[lane]);
    tally.below_5_deg += angle < 5;
    tally.below_10_deg += angle < 10;
    tally[min_dihedral].add(angle, id);
    tally[max_dihedral].add(tets.max_dihedral.lane[lane], id);
    tally[mean_ratio].add(tets.mean_ratio.lane[lane], id);
    tally[radius_ratio].add(tets.radius_ratio.lane[lane], id);
    tally[aspect_ratio].add(tets.aspect_ratio.lane[lane], id);
    tally[openfoam_aspect].add(tets.openfoam_aspect.lane[lane], id);
  }
}

QualitySweep::Corners QualitySweep::corners_of(std::span<const VertexId> vertices) const {
  Corners corners;
  corners.count = vertices.size();
  for (std::size_t i = 0; i < vertices.size(); ++i) corners.at[i] = mesh_.points[vertices[i]];
  return corners;
}

CellGeometry plane_geometry(std::span<const Point> corners, bool is_plane) {
  const FacetGeometry face = facet_geometry(corners);
  return {face.centre, is_plane ? face.area.z : length(face.area)};
}

/// Geometry of the facets of a volume cell, outward.
struct CellFacets {
  FacetGeometry facet[6];
  std::size_t count;

  CellFacets(const CellShape& shape, const Point* corners) : count(static_cast<std::size_t>(shape.num_facets)) {
    for (std::size_t f = 0; f < count; ++f) {
      const LocalFacet& local = shape.facets[f];
      Point p[4];
      for (int i = 0; i < local.num_vertices; ++i) p[i] = corners[local.vertices[i]];
      facet[f] = facet_geometry({p, static_cast<std::size_t>(local.num_vertices)});
    }
  }
  std::span<const FacetGeometry> all() const { return {facet, count}; }
};

CellGeometry QualitySweep::geometry_of(std::size_t cell) const {
  const CellRange::Part& part = cells_.part_of(cell);
  const CellShape& shape = shape_of(part.block->type);
  const Corners corners = corners_of((*part.block)[cell - part.first]);
  if (dimension_ == 2) return plane_geometry(corners.all(), mesh_.dimension == 2);
  return cell_geometry(corners.all(), shape, CellFacets(shape, corners.at).all());
}

void QualitySweep::measure_cell_edges(const CellShape& shape, const Corners& corners, Tally& tally) const {
  for (int e = 0; e < shape.num_edges; ++e) {
    const double squared = squared_length(corners.at[shape.edges[e][0]] - corners.at[shape.edges[e][1]]);
    tally.shortest_squared = std::min(tally.shortest_squared, squared);
    tally.longest_squared = std::max(tally.longest_squared, squared);
  }
}

void QualitySweep::measure_plane_cell(std::span<const VertexId> vertices, std::size_t cell, Tally& tally) const {
  const Corners corners = corners_of(vertices);
  const auto id = static_cast<std::uint32_t>(cell);
  const CellQuality quality = measure_polygon(corners.all());
  tally.volume += plane_geometry(corners.all(), mesh_.dimension == 2).volume;
  measure_cell_edges(shape_of(corners.count == 3 ? CellType::triangle : CellType::quad), corners, tally);
  tally[MeasureId::min_angle].add(quality.min_angle, id);
  tally[MeasureId::max_angle].add(quality.max_angle, id);
  if (corners.count != 3) return;
  tally[MeasureId::mean_ratio].add(quality.mean_ratio, id);
  tally[MeasureId::radius_ratio].add(quality.radius_ratio, id);
  tally[MeasureId::aspect_ratio].add(quality.aspect_ratio, id);
}

/// OpenFOAM's cell aspect ratio: of the sums of |area| along the axes the largest over the smallest, or a sixth of all
/// three over V^(2/3) where that is larger.
double openfoam_aspect(std::span<const FacetGeometry> facets, double volume) {
  Point sum;
  for (const FacetGeometry& facet : facets)
    sum = sum + Point{std::abs(facet.area.x), std::abs(facet.area.y), std::abs(facet.area.z)};
  const double tiny = 1e-150;
  const double largest = std::max({sum.x, sum.y, sum.z}), smallest = std::min({sum.x, sum.y, sum.z});
  const double root = std::cbrt(std::max(volume, tiny));
  return std::max(largest / (smallest + tiny), (sum.x + sum.y + sum.z) / 6 / (root * root));
}

void QualitySweep::measure_volume_cell(const CellShape& shape, std::span<const VertexId> vertices, std::size_t cell,
                                       Tally& tally) const {
  const Corners corners = corners_of(vertices);
  const CellFacets facets(shape, corners.at);
  const double volume = cell_geometry(corners.all(), shape, facets.all()).volume;
  CellQuality quality;
  measure_dihedrals(shape, facets.all(), quality);
  const auto id = static_cast<std::uint32_t>(cell);
  tally.volume += volume;
  tally.below_5_deg += quality.min_angle < 5;
  tally.below_10_deg += quality.min_angle < 10;
  measure_cell_edges(shape, corners, tally);
  tally[MeasureId::min_dihedral].add(quality.min_angle, id);
  tally[MeasureId::max_dihedral].add(quality.max_angle, id);
  tally[MeasureId::openfoam_aspect].add(openfoam_aspect(facets.all(), volume), id);
}

/// Facets and edges of the same bin together: its cells are in the cache then.
void QualitySweep::sweep_facets() {
  const CellRange none(mesh_, -1);
  const FacetSweep sweep(mesh_, cells_, none, context_.threads);
  const double low = std::sqrt(total_.shortest_squared), high = std::sqrt(total_.longest_squared);
  Tally empty(num_worst_);
  empty[MeasureId::edge_length].set_range(low, high);
  total_[MeasureId::edge_length].set_range(low, high);
  merge_tasks(context_, sweep.num_bins(), kLeastBins, total_, empty,
              [&](std::size_t first, std::size_t last, Tally& tally) {
                FacetSweep::Scratch scratch;
                FacetBatch batch;
                for (std::size_t bin = first; bin < last; ++bin) {
                  context_.check_limits();
                  sweep.for_each_facet(bin, scratch, [&](auto sides, auto) { measure_facet(sides, batch, tally); });
                  measure_edges(sweep.edges(bin, scratch), tally);
                }
                measure_batch(batch, tally);
              });
}

void QualitySweep::measure_facet(std::span<const HalfFacet> sides, FacetBatch& batch, Tally& tally) const {
  tally.boundary_facets += sides.size() == 1;
  if (sides.size() > 2 || (dimension_ == 2 && mesh_.dimension == 3)) return;
  if (is_between_tets(sides))
    add_to_batch(sides, batch, tally);
  else
    measure_any_facet(sides, tally);
}

/// Two tetrahedra, from opposite sides as it should be: then the facet's normal gives the sign of both volumes.
bool QualitySweep::is_between_tets(std::span<const HalfFacet> sides) const {
  const auto is_tet = [&](const HalfFacet& half) {
    return half.cell >= first_tet_ && half.cell - first_tet_ < tets_->vertices.size() / 4;
  };
  return tets_ && sides.size() == 2 && sides[0].is_forward != sides[1].is_forward && is_tet(sides[0]) &&
         is_tet(sides[1]);
}

void QualitySweep::add_to_batch(std::span<const HalfFacet> sides, FacetBatch& batch, Tally& tally) const {
  const VertexId* owner = &tets_->vertices[4 * (sides[0].cell - first_tet_)];
  const VertexId* neighbour = &tets_->vertices[4 * (sides[1].cell - first_tet_)];
  const std::array<int, 4>& local = shape_of(CellType::tetrahedron).facets[sides[0].local_facet].vertices;
  LanePoints(&points)[5] = batch.points[batch.size / kLanes];
  const int lane = batch.size % kLanes;
  for (int i = 0; i < 3; ++i) points[i].set(lane, mesh_.points[owner[local[i]]]);
  // the facets of a tetrahedron lie opposite its corners, in the same order
  points[3].set(lane, mesh_.points[owner[sides[0].local_facet]]);
  points[4].set(lane, mesh_.points[neighbour[sides[1].local_facet]]);
  batch.cells[batch.size][0] = sides[0].cell;
  batch.cells[batch.size][1] = sides[1].cell;
  if (++batch.size == FacetBatch::kSize) measure_batch(batch, tally);
}

void QualitySweep::measure_batch(FacetBatch& batch, Tally& tally) const {
  FacetLanes facets[FacetBatch::kGroups];  // lanes beyond the size hold earlier facets, or nothing
  for (int group = 0; group * kLanes < batch.size; ++group) measure_tet_facets(batch.points[group], facets[group]);
  for (int i = 0; i < batch.size; ++i) {
    const FacetLanes& group = facets[i / kLanes];
    const int lane = i % kLanes;
    const auto [owner, neighbour] = batch.cells[i];
    tally.sum_of_cosines += group.cosine.lane[lane];
    tally[MeasureId::max_nonortho].add(group.nonortho.lane[lane], owner, neighbour);
    tally[MeasureId::skewness].add(group.skewness.lane[lane], owner, neighbour);
    tally[MeasureId::volume_ratio].add(group.volume_ratio.lane[lane], owner, neighbour);
  }
  tally.inner_facets += static_cast<std::size_t>(batch.size);
  batch.size = 0;
}

void QualitySweep::measure_any_facet(std::span<const HalfFacet> sides, Tally& tally) const {
  const CellRange::Part& part = cells_.part_of(sides[0].cell);
  const auto vertices = (*part.block)[sides[0].cell - part.first];
  const LocalFacet& local = shape_of(part.block->type).facets[sides[0].local_facet];
  Point storage[4];
  for (int i = 0; i < local.num_vertices; ++i) storage[i] = mesh_.points[vertices[local.vertices[i]]];
  const std::span<const Point> corners(storage, static_cast<std::size_t>(local.num_vertices));
  const FacetGeometry facet = facet_geometry(corners);
  const CellGeometry owner = geometry_of(sides[0].cell);
  if (sides.size() == 1)
    return tally[MeasureId::skewness].add(boundary_skewness(corners, facet, owner.centre), sides[0].cell);
  const CellGeometry neighbour = geometry_of(sides[1].cell);
  const double angle = nonorthogonality(owner.centre, neighbour.centre, facet.area);
  tally.sum_of_cosines += std::cos(angle / 180 * std::numbers::pi);
  ++tally.inner_facets;
  const double small = std::min(owner.volume, neighbour.volume), large = std::max(owner.volume, neighbour.volume);
  const auto add = [&](MeasureId id, double value) { tally[id].add(value, sides[0].cell, sides[1].cell); };
  add(MeasureId::max_nonortho, angle);
  add(MeasureId::skewness, inner_skewness(corners, facet, owner.centre, neighbour.centre));
  add(MeasureId::volume_ratio, small > 0 ? large / small : kInfinity);
}

void QualitySweep::measure_edges(std::span<const FacetSweep::Edge> edges, Tally& tally) const {
  for (const auto& [a, b] : edges)
    tally[MeasureId::edge_length].add(distance(mesh_.points[VertexId(a)], mesh_.points[VertexId(b)]), a, b);
}

/// Some are reported without a value too (one cell has no inner facet), so that a gate on them is met, not unknown.
bool QualitySweep::is_reported(MeasureId id) const {
  using enum MeasureId;
  if (!total_.builders[static_cast<std::size_t>(id)].is_empty()) return true;
  if (id == min_dihedral || id == max_dihedral || id == openfoam_aspect) return dimension_ == 3;
  if (id == min_angle || id == max_angle) return dimension_ == 2;
  if (id == max_nonortho || id == skewness || id == volume_ratio)
    return dimension_ == 3 || (dimension_ == 2 && mesh_.dimension == 2);
  return false;
}

QualityReport QualitySweep::report() const {
  QualityReport report;
  report.num_points = mesh_.points.size();
  report.num_cells = cells_.size();
  report.num_boundary_faces = total_.boundary_facets;
  report.volume = total_.volume;
  report.cells_below_5_deg = total_.below_5_deg;
  report.cells_below_10_deg = total_.below_10_deg;
  for (std::size_t i = 0; i < kNumMeasures; ++i) {
    const auto id = static_cast<MeasureId>(i);
    if (dimension_ < 2 || !is_reported(id)) continue;
    Measure measure = total_.builders[i].take();
    for (Place& place : measure.worst)
      for (const std::uint32_t entity : place.ids)
        place.at =
            place.at + (id == MeasureId::edge_length ? mesh_.points[VertexId(entity)] : geometry_of(entity).centre) /
                           static_cast<double>(place.ids.size());
    if (id == MeasureId::max_nonortho && total_.inner_facets > 0) {
      const double mean = total_.sum_of_cosines / static_cast<double>(total_.inner_facets);
      measure.mean = std::acos(std::clamp(mean, -1.0, 1.0)) * 180 / std::numbers::pi;
    }
    report.measures.push_back(std::move(measure));
  }
  return report;
}

}  // namespace

const Measure* QualityReport::find(const std::string& name) const {
  for (const Measure& measure : measures)
    if (measure.name == name) return &measure;
  return nullptr;
}

QualityReport measure_quality(const Mesh& mesh, Context& context, std::size_t num_worst) {
  return QualitySweep(mesh, context, num_worst).run();
}

}  // namespace delfront
