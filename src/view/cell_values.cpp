// SPDX-License-Identifier: Apache-2.0
// Two sweeps as in mesh/quality.cpp, by the same formulas: cells, each for itself; then facets, of which each cell
// keeps the worst value. The worst of several is the same in any order, so threads meet at single values without locks.
#include "view/cell_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"
#include "mesh/cell_geometry.hpp"
#include "mesh/facet_table.hpp"
#include "mesh/measure.hpp"
#include "mesh/tet_lanes.hpp"

namespace delfront {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kGrain = 16384;

/// Columns of the table, by what they hold.
enum Column : std::size_t {
  kLowAngle,
  kHighAngle,
  kMeanRatio,
  kAspect,
  kNonortho,
  kSkewness,
  kVolumeRatio,
  kVolume,
  kSize,
  kNumColumns
};

class CellSweep {
 public:
  CellSweep(const Mesh& mesh, Context& context);
  std::vector<CellValues> run();

 private:
  void check_indices() const;
  void measure_part(const CellRange::Part& part, std::size_t first, std::size_t last);
  void measure_tets(const CellRange::Part& part, std::size_t cell, std::size_t count);
  void measure_cell(const CellRange::Part& part, std::size_t cell);
  void measure_facet(std::span<const HalfFacet> sides);
  void keep_largest(Column column, std::size_t cell, double value);
  std::vector<CellValues> take();

  const Mesh& mesh_;
  Context& context_;
  int dimension_;
  CellRange cells_;
  std::vector<float> table_[kNumColumns];
  std::vector<CellGeometry> geometry_;
};

CellSweep::CellSweep(const Mesh& mesh, Context& context)
    : mesh_(mesh), context_(context), dimension_(mesh.top_dimension()), cells_(mesh, dimension_) {
  for (std::vector<float>& column : table_) column.assign(cells_.size(), kNone);
  geometry_.resize(cells_.size());
}

void CellSweep::check_indices() const {
  for (const CellBlock& block : mesh_.blocks) {
    if (block.type == CellType::polyhedron) continue;  // its stream holds counts too
    for (const VertexId v : block.vertices)
      if (v.index() >= mesh_.points.size())
        throw InputError(fmt::format("a {} names point {}, but there are {} points; delfront check shows where",
                                     name_of(block.type), v.value, mesh_.points.size()));
  }
}

std::vector<CellValues> CellSweep::run() {
  check_indices();
  if (dimension_ < 2) return {};
  for (const CellRange::Part& part : cells_.parts())
    parallel_ranges(context_.threads, part.block->size(), kGrain, [&](std::size_t first, std::size_t last) {
      context_.check_limits();
      measure_part(part, first, last);
    });
  if (dimension_ == 3 || mesh_.dimension == 2) {
    const CellRange none(mesh_, -1);
    const FacetSweep sweep(mesh_, cells_, none, context_.threads);
    parallel_ranges(context_.threads, sweep.num_bins(), 4, [&](std::size_t first, std::size_t last) {
      FacetSweep::Scratch scratch;
      context_.check_limits();
      for (std::size_t bin = first; bin < last; ++bin)
        sweep.for_each_facet(bin, scratch, [&](auto sides, auto) { measure_facet(sides); });
    });
  }
  return take();
}

void CellSweep::measure_part(const CellRange::Part& part, std::size_t first, std::size_t last) {
  if (shape_of(part.block->type).num_facets == 0) return;
  const bool is_tets = part.block->type == CellType::tetrahedron;
  const std::size_t step = is_tets ? kLanes : 1;
  for (std::size_t cell = first; cell < last; cell += step) {
    if (is_tets) measure_tets(part, cell, std::min(last - cell, step));
    for (std::size_t i = cell; i < std::min(last, cell + step); ++i) measure_cell(part, i);
  }
}

void CellSweep::measure_tets(const CellRange::Part& part, std::size_t cell, std::size_t count) {
  LanePoints corners[4];
  for (std::size_t lane = 0; lane < kLanes; ++lane)  // lanes beyond `count` repeat the last one
    for (std::size_t i = 0; i < 4; ++i)
      corners[i].set(static_cast<int>(lane), mesh_.points[(*part.block)[cell + std::min(lane, count - 1)][i]]);
  TetLanes tets;
  delfront::measure_tets(corners, tets);
  for (std::size_t lane = 0; lane < count; ++lane) {
    const std::size_t id = part.first + cell + lane;
    table_[kLowAngle][id] = static_cast<float>(tets.min_dihedral.lane[lane]);
    table_[kHighAngle][id] = static_cast<float>(tets.max_dihedral.lane[lane]);
    table_[kMeanRatio][id] = static_cast<float>(tets.mean_ratio.lane[lane]);
    table_[kAspect][id] = static_cast<float>(tets.aspect_ratio.lane[lane]);
  }
}

/// Volume, centre and size of any cell; the shape of those that are no tetrahedra.
void CellSweep::measure_cell(const CellRange::Part& part, std::size_t cell) {
  const CellShape& shape = shape_of(part.block->type);
  const std::span<const VertexId> vertices = (*part.block)[cell];
  const std::size_t id = part.first + cell;
  Point storage[8];
  for (std::size_t i = 0; i < vertices.size(); ++i) storage[i] = mesh_.points[vertices[i]];
  const std::span<const Point> corners(storage, vertices.size());
  CellQuality quality;
  if (dimension_ == 2) {
    const FacetGeometry face = facet_geometry(corners);
    geometry_[id] = {face.centre, mesh_.dimension == 2 ? face.area.z : length(face.area)};
    quality = measure_polygon(corners);
    if (corners.size() == 3) table_[kMeanRatio][id] = static_cast<float>(quality.mean_ratio);
    if (corners.size() == 3) table_[kAspect][id] = static_cast<float>(quality.aspect_ratio);
  } else {
    FacetGeometry facets[6];
    for (int f = 0; f < shape.num_facets; ++f) {
      Point p[4];
      for (int i = 0; i < shape.facets[f].num_vertices; ++i) p[i] = storage[shape.facets[f].vertices[i]];
      facets[f] = facet_geometry({p, static_cast<std::size_t>(shape.facets[f].num_vertices)});
    }
    const std::span<const FacetGeometry> all(facets, static_cast<std::size_t>(shape.num_facets));
    geometry_[id] = cell_geometry(corners, shape, all);
    measure_dihedrals(shape, all, quality);
  }
  if (part.block->type != CellType::tetrahedron) {
    table_[kLowAngle][id] = static_cast<float>(quality.min_angle);
    table_[kHighAngle][id] = static_cast<float>(quality.max_angle);
  }
  table_[kVolume][id] = static_cast<float>(geometry_[id].volume);
  double sum = 0;
  for (int e = 0; e < shape.num_edges; ++e) sum += distance(storage[shape.edges[e][0]], storage[shape.edges[e][1]]);
  table_[kSize][id] = static_cast<float>(sum / shape.num_edges);
}

void CellSweep::measure_facet(std::span<const HalfFacet> sides) {
  if (sides.empty() || sides.size() > 2) return;
  const std::size_t owner = sides[0].cell;
  const CellRange::Part& part = cells_.part_of(owner);
  const LocalFacet& local = shape_of(part.block->type).facets[sides[0].local_facet];
  const std::span<const VertexId> vertices = (*part.block)[owner - part.first];
  Point storage[4];
  for (int i = 0; i < local.num_vertices; ++i) storage[i] = mesh_.points[vertices[local.vertices[i]]];
  const std::span<const Point> corners(storage, static_cast<std::size_t>(local.num_vertices));
  const FacetGeometry facet = facet_geometry(corners);
  const CellGeometry& here = geometry_[owner];
  if (sides.size() == 1) return keep_largest(kSkewness, owner, boundary_skewness(corners, facet, here.centre));
  const CellGeometry& there = geometry_[sides[1].cell];
  const double small = std::min(here.volume, there.volume), large = std::max(here.volume, there.volume);
  const double angle = nonorthogonality(here.centre, there.centre, facet.area);
  const double skewness = inner_skewness(corners, facet, here.centre, there.centre);
  for (const std::size_t cell : {owner, std::size_t{sides[1].cell}}) {
    keep_largest(kNonortho, cell, angle);
    keep_largest(kSkewness, cell, skewness);
    keep_largest(kVolumeRatio, cell, small > 0 ? large / small : std::numeric_limits<double>::infinity());
  }
}

void CellSweep::keep_largest(Column column, std::size_t cell, double value) {
  const std::atomic_ref<float> kept(table_[column][cell]);
  const auto wanted = static_cast<float>(value);
  for (float seen = kept; !(seen >= wanted) && !kept.compare_exchange_weak(seen, wanted);) {
  }
}

std::vector<CellValues> CellSweep::take() {
  using enum MeasureId;
  const bool is_plane = dimension_ == 2;
  const auto of_kind = [](MeasureId id) {
    const MeasureKind& kind = kind_of(id);
    return CellValues{kind.name, kind.unit, true, kind.worst_is_low, kind.histogram_low, kind.histogram_high, {}};
  };
  std::vector<CellValues> all = {of_kind(is_plane ? min_angle : min_dihedral),
                                 of_kind(is_plane ? max_angle : max_dihedral),
                                 of_kind(mean_ratio),
                                 of_kind(aspect_ratio),
                                 of_kind(max_nonortho),
                                 of_kind(skewness),
                                 of_kind(volume_ratio),
                                 {is_plane ? "area" : "volume", "", false, true, 0, 0, {}},
                                 {"size", "", false, true, 0, 0, {}}};
  std::vector<CellValues> result;
  for (std::size_t i = 0; i < kNumColumns; ++i) {
    if (std::all_of(table_[i].begin(), table_[i].end(), [](float v) { return std::isnan(v); })) continue;
    all[i].values = std::move(table_[i]);
    result.push_back(std::move(all[i]));
  }
  return result;
}

}  // namespace

std::vector<CellValues> measure_each_cell(const Mesh& mesh, Context& context) { return CellSweep(mesh, context).run(); }

}  // namespace delfront
