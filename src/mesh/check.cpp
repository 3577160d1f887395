// SPDX-License-Identifier: Apache-2.0
// Is it a grid at all? Stages, each exact: the arrays (sizes, indices, finite coordinates), the points (doubled,
// unused), the cells (repeated vertices, the sign of every corner), the facets (one or two cells, from opposite sides,
// the stored ones beside them), the boundary (its edges). Later stages need sound indices and are left out without.
//
// Ids in the places: of points for findings about points, edges and facets (the vertices of the facet); of cells,
// numbered through over the blocks of the highest dimension, for findings about cells. Cells that overlap without
// sharing a facet are not seen here: that needs a search in space.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>

#include "delfront/grid_check.hpp"
#include "fmt/format.h"
#include "mesh/cell_shape.hpp"
#include "mesh/facet_table.hpp"
#include "predicates/predicates.hpp"

namespace delfront {

namespace {

struct Kind {
  const char* key;
  Severity severity;
  const char* what;  ///< after the count
  const char* remedy;
};

// In the order in which they are reported.
constexpr Kind kKinds[] = {
    {"bad_block", Severity::error, "blocks of cells whose arrays do not fit each other",
     "the file or its writer is at fault"},
    {"index_out_of_range", Severity::error, "cells with a vertex that does not exist",
     "the file or its writer is at fault"},
    {"not_finite", Severity::error, "points with a coordinate that is not a number",
     "the file or its writer is at fault"},
    {"no_cells", Severity::error, "grids without a cell", "a grid needs cells of dimension 2 or 3"},
    {"unchecked_cells", Severity::warning, "polygons or polyhedra, which are neither checked nor measured", ""},
    {"points_off_plane", Severity::error, "points of a plane grid with z other than 0", "set z = 0"},
    {"repeated_vertex", Severity::error, "cells with the same vertex twice", "drop these cells"},
    {"inverted_cell", Severity::error, "cells that are inside out at a corner",
     "turn their vertices round, or grid again"},
    {"flat_cell", Severity::error, "cells that are flat at a corner", "drop them, or grid again"},
    {"overfull_facets", Severity::error, "faces with more than two cells", "grid again"},
    {"overlapping_cells", Severity::error, "faces with two cells on the same side", "grid again"},
    {"missing_boundary_facets", Severity::error, "boundary faces that are not stored",
     "store each face that has one cell"},
    {"repeated_boundary_facets", Severity::error, "faces that are stored more than once", "store each face once"},
    {"loose_facets", Severity::error, "stored faces that no cell has", "drop them, or grid again"},
    {"loose_lines", Severity::error, "lines that are no edge of a cell", "drop them, or grid again"},
    {"turned_boundary_facets", Severity::warning, "stored boundary faces that point inwards",
     "turn their vertices round"},
    {"open_boundary", Severity::error, "edges at which the boundary ends", "grid again"},
    {"nonmanifold_edges", Severity::note, "edges with more than two boundary faces", ""},
    {"doubled_points", Severity::error, "points at the place of an earlier one", "merge them"},
    {"unused_points", Severity::error, "points that no cell uses", "drop them"},
};

/// Collects the places of each kind; the message is written at the end, when the count is known.
class Findings {
 public:
  void add(const char* key, const Place& place, std::vector<Point> outline = {}) {
    Finding& finding = findings_[index_of(key)];
    if (finding.count++ >= kMaxPlaces) return;
    finding.places.push_back(place);
    if (!outline.empty()) finding.outlines.push_back({place.ids.empty() ? 0 : place.ids[0], std::move(outline)});
  }

  std::vector<Finding> take() {
    std::vector<Finding> result;
    for (std::size_t i = 0; i < std::size(kKinds); ++i) {
      Finding& finding = findings_[i];
      if (finding.count == 0) continue;
      const Place& first = finding.places.front();
      finding.kind = kKinds[i].key;
      finding.severity = kKinds[i].severity;
      finding.remedy = kKinds[i].remedy;
      finding.message = fmt::format("{} {}; the first at ({:.9g}, {:.9g}, {:.9g})", finding.count, kKinds[i].what,
                                    first.at.x, first.at.y, first.at.z);
      const char* before = ", id ";
      for (const std::uint32_t id : first.ids) {
        finding.message += fmt::format("{}{}", before, id);
        before = " ";
      }
      result.push_back(std::move(finding));
    }
    return result;
  }

 private:
  static std::size_t index_of(const char* key) {
    std::size_t i = 0;
    while (std::strcmp(kKinds[i].key, key) != 0) ++i;
    return i;
  }
  Finding findings_[std::size(kKinds)];
};

class Checker {
 public:
  explicit Checker(const Mesh& mesh)
      : mesh_(mesh), dimension_(mesh.top_dimension()), cells_(mesh, dimension_), stored_(mesh, dimension_ - 1) {}
  std::vector<Finding> run();

 private:
  bool check_arrays();
  bool check_indices(const CellBlock& block);
  bool check_coordinates();
  void check_doubled_points();
  void check_unused_points();
  void check_cells();
  void check_cell_corners(const CellRange::Part& part, std::size_t cell);
  int corner_sign(const VertexId* vertices, const std::array<int, 4>& corner) const;
  void check_facets();
  void check_facets(const FacetSweep& sweep, std::size_t bin, FacetSweep::Scratch& scratch);
  void check_facet(std::span<const HalfFacet> sides, std::span<const HalfFacet> stored);
  void check_boundary_edges();
  void check_lines();

  Place point_place(std::size_t point) const;
  Place cell_place(std::span<const VertexId> vertices, std::size_t cell) const;
  Place facet_place(const HalfFacet& facet) const;
  bool is_plane() const { return dimension_ == 2 && mesh_.dimension == 2; }

  const Mesh& mesh_;
  int dimension_;
  CellRange cells_, stored_;
  double scale_ = 1;  ///< a power of two that brings the largest coordinate near 1, as the predicates want
  std::vector<std::pair<std::uint32_t, std::uint32_t>> boundary_edges_;
  Findings findings_;
};

std::vector<Finding> Checker::run() {
  const bool is_sound = check_arrays() && check_coordinates();
  if (cells_.size() == 0 || dimension_ < 2) findings_.add("no_cells", {});
  if (!is_sound || dimension_ < 2) return findings_.take();
  check_doubled_points();
  check_unused_points();
  check_cells();
  // A surface in space is check_surface's business: here its edges may have any number of faces.
  if (dimension_ == 3 || is_plane()) check_facets();
  if (dimension_ == 3) check_lines();
  return findings_.take();
}

Place Checker::point_place(std::size_t point) const {
  return {mesh_.points[VertexId(point)], {static_cast<std::uint32_t>(point)}};
}

Place Checker::cell_place(std::span<const VertexId> vertices, std::size_t cell) const {
  Point sum;
  for (const VertexId v : vertices) sum = sum + mesh_.points[v];
  const auto n = static_cast<double>(std::max<std::size_t>(vertices.size(), 1));
  return {sum / n, {static_cast<std::uint32_t>(cell)}};
}

Place Checker::facet_place(const HalfFacet& facet) const {
  const int n = facet.num_vertices();
  const std::uint32_t ids[4] = {facet.a, facet.b, facet.c, facet.d};
  Place place{{}, {ids, ids + n}};
  for (const std::uint32_t id : place.ids) place.at = place.at + mesh_.points[VertexId(id)] / n;
  return place;
}

bool Checker::check_arrays() {
  bool is_sound = true;
  for (const CellBlock& block : mesh_.blocks) {
    const auto n = static_cast<std::size_t>(num_vertices(block.type));
    bool fits = n == 0 || block.vertices.size() % n == 0;
    if (n == 0 && !block.offsets.empty())
      fits = std::is_sorted(block.offsets.begin(), block.offsets.end()) && block.offsets.front() == 0 &&
             block.offsets.back() == block.vertices.size();
    if (!block.group.empty() && block.group.size() != block.size()) fits = false;
    for (const GroupId group : block.group)
      if (group.is_valid() && group.index() >= mesh_.groups.size()) fits = false;
    if (!fits) findings_.add("bad_block", {{}, {static_cast<std::uint32_t>(&block - mesh_.blocks.data())}});
    is_sound = fits && check_indices(block) && is_sound;
  }
  return is_sound;
}

bool Checker::check_indices(const CellBlock& block) {
  if (block.type == CellType::polyhedron) return true;  // its stream holds counts too
  const std::size_t limit = mesh_.points.size();
  const bool all_in_range =
      std::all_of(block.vertices.begin(), block.vertices.end(), [&](VertexId v) { return v.index() < limit; });
  if (all_in_range) return true;
  for (std::size_t cell = 0; cell < block.size(); ++cell) {
    Place place{{}, {static_cast<std::uint32_t>(cell)}};
    bool is_bad = false;
    for (const VertexId v : block[cell]) {
      if (v.index() < limit)
        place.at = mesh_.points[v];
      else
        is_bad = true;
    }
    if (is_bad) findings_.add("index_out_of_range", place);
  }
  return false;
}

bool Checker::check_coordinates() {
  double largest = 0;
  bool all_finite = true;
  for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
    const Point p = mesh_.points[VertexId(i)];
    if (!is_finite(p)) findings_.add("not_finite", {{}, {static_cast<std::uint32_t>(i)}});
    all_finite = all_finite && is_finite(p);
    if (is_plane() && p.z != 0) findings_.add("points_off_plane", point_place(i));
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  if (all_finite && largest > 0) scale_ = std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
  return all_finite;
}

void Checker::check_doubled_points() {
  std::vector<std::uint32_t> order(mesh_.points.size());
  std::iota(order.begin(), order.end(), 0u);
  const Point* points = mesh_.points.data();
  std::sort(order.begin(), order.end(), [points](std::uint32_t i, std::uint32_t j) {
    const Point &p = points[i], &q = points[j];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return i < j;
  });
  std::vector<std::uint32_t> doubled;
  for (std::size_t i = 1; i < order.size(); ++i)
    if (points[order[i]] == points[order[i - 1]]) doubled.push_back(order[i]);
  std::sort(doubled.begin(), doubled.end());
  for (const std::uint32_t point : doubled) findings_.add("doubled_points", point_place(point));
}

void Checker::check_unused_points() {
  std::vector<bool> is_used(mesh_.points.size(), false);
  for (const CellRange::Part& part : cells_.parts()) {
    if (part.block->type == CellType::polyhedron) return;
    for (const VertexId v : part.block->vertices) is_used[v.index()] = true;
  }
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (!is_used[i]) findings_.add("unused_points", point_place(i));
}

bool has_repeated_vertex(std::span<const VertexId> vertices) {
  for (std::size_t i = 1; i < vertices.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (vertices[i] == vertices[j]) return true;
  return false;
}

void Checker::check_cells() {
  for (const CellRange* range : {&cells_, &stored_})
    for (const CellRange::Part& part : range->parts()) {
      const bool is_simple = num_vertices(part.block->type) > 0;
      for (std::size_t cell = 0; cell < part.block->size(); ++cell) {
        const auto vertices = (*part.block)[cell];
        if (!is_simple)
          findings_.add("unchecked_cells", {{}, {static_cast<std::uint32_t>(part.first + cell)}});
        else if (has_repeated_vertex(vertices))
          findings_.add("repeated_vertex", cell_place(vertices, part.first + cell));
        else if (range == &cells_ && (dimension_ == 3 || is_plane()))
          check_cell_corners(part, cell);
      }
    }
}

void Checker::check_cell_corners(const CellRange::Part& part, std::size_t cell) {
  const CellShape& shape = shape_of(part.block->type);
  const auto vertices = (*part.block)[cell];
  int worst = 1;
  for (int i = 0; i < shape.num_corners; ++i) worst = std::min(worst, corner_sign(vertices.data(), shape.corners[i]));
  if (worst == 1) return;
  findings_.add(worst == 0 ? "flat_cell" : "inverted_cell", cell_place(vertices, part.first + cell));
}

int Checker::corner_sign(const VertexId* vertices, const std::array<int, 4>& corner) const {
  Point p[4];
  for (int i = 0; i < dimension_ + 1; ++i) p[i] = scale_ * mesh_.points[vertices[corner[i]]];
  if (dimension_ == 3) return orient3d(p[0], p[1], p[2], p[3]);
  return orient2d(&p[0].x, &p[1].x, &p[2].x);
}

void Checker::check_facets() {
  for (const CellRange::Part& part : cells_.parts())
    if (num_vertices(part.block->type) == 0) return;  // said as unchecked_cells
  const FacetSweep sweep(mesh_, cells_, stored_, 1);
  FacetSweep::Scratch scratch;
  for (std::size_t bin = 0; bin < sweep.num_bins(); ++bin) check_facets(sweep, bin, scratch);
  check_boundary_edges();
}

/// What is not plainly right is looked at in the order of its vertices, in which it is reported.
void Checker::check_facets(const FacetSweep& sweep, std::size_t bin, FacetSweep::Scratch& scratch) {
  struct Facet {
    std::vector<HalfFacet> halves;
    std::size_t num_sides;
  };
  std::vector<Facet> facets;
  sweep.for_each_facet(bin, scratch, [&](auto sides, auto stored) {
    if (sides.size() == 2 && stored.empty() && sides[0].is_forward != sides[1].is_forward) return;
    facets.push_back({{sides.begin(), stored.end()}, sides.size()});
  });
  std::sort(facets.begin(), facets.end(), [](const Facet& p, const Facet& q) {
    const HalfFacet &f = p.halves[0], &g = q.halves[0];
    return std::tie(f.a, f.b, f.c, f.d) < std::tie(g.a, g.b, g.c, g.d);
  });
  for (const auto& [halves, num_sides] : facets)
    check_facet(std::span(halves).first(num_sides), std::span(halves).subspan(num_sides));
}

void Checker::check_facet(std::span<const HalfFacet> sides, std::span<const HalfFacet> stored) {
  if (stored.size() > 1) findings_.add("repeated_boundary_facets", facet_place(stored[0]));
  if (sides.empty()) return findings_.add("loose_facets", facet_place(stored[0]));
  if (sides.size() > 2) return findings_.add("overfull_facets", facet_place(sides[0]));
  if (sides.size() == 2) {
    if (sides[0].is_forward == sides[1].is_forward) findings_.add("overlapping_cells", facet_place(sides[0]));
    return;
  }
  if (stored.empty())
    findings_.add("missing_boundary_facets", facet_place(sides[0]));
  else if (stored[0].is_forward != sides[0].is_forward)
    findings_.add("turned_boundary_facets", facet_place(stored[0]));
  if (dimension_ < 3) return;
  const CellRange::Part& part = cells_.part_of(sides[0].cell);
  const auto vertices = (*part.block)[sides[0].cell - part.first];
  const LocalFacet& facet = shape_of(part.block->type).facets[sides[0].local_facet];
  for (int i = 0; i < facet.num_vertices; ++i) {
    const std::uint32_t u = vertices[facet.vertices[i]].value;
    const std::uint32_t v = vertices[facet.vertices[(i + 1) % facet.num_vertices]].value;
    boundary_edges_.push_back(std::minmax(u, v));
  }
}

/// Lines that no cell has among its edges. Only cells with two vertices on lines are looked at.
void Checker::check_lines() {
  const CellBlock* lines = mesh_.find_block(CellType::line);
  if (!lines || lines->size() == 0) return;
  std::vector<bool> is_end(mesh_.points.size(), false);
  for (const VertexId v : lines->vertices) is_end[v.index()] = true;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const CellRange::Part& part : cells_.parts()) {
    if (num_vertices(part.block->type) == 0) return;  // said as unchecked_cells
    const CellShape& shape = shape_of(part.block->type);
    for (std::size_t cell = 0; cell < part.block->size(); ++cell) {
      const auto vertices = (*part.block)[cell];
      for (int e = 0; e < shape.num_edges; ++e) {
        const std::uint32_t u = vertices[shape.edges[e][0]].value, v = vertices[shape.edges[e][1]].value;
        if (is_end[u] && is_end[v]) edges.push_back(std::minmax(u, v));
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const auto ends = (*lines)[i];
    const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(ends[0].value, ends[1].value);
    if (!std::binary_search(edges.begin(), edges.end(), edge))
      findings_.add("loose_lines",
                    {0.5 * (mesh_.points[ends[0]] + mesh_.points[ends[1]]), {ends[0].value, ends[1].value}});
  }
}

void Checker::check_boundary_edges() {
  std::sort(boundary_edges_.begin(), boundary_edges_.end());
  for (std::size_t first = 0, end = 0; first < boundary_edges_.size(); first = end) {
    while (end < boundary_edges_.size() && boundary_edges_[end] == boundary_edges_[first]) ++end;
    if (end - first == 2) continue;
    const auto [u, v] = boundary_edges_[first];
    const Point a = mesh_.points[VertexId(u)], b = mesh_.points[VertexId(v)];
    findings_.add((end - first) % 2 == 1 ? "open_boundary" : "nonmanifold_edges", {0.5 * (a + b), {u, v}}, {a, b});
  }
}

}  // namespace

std::vector<Finding> check(const Mesh& mesh) { return Checker(mesh).run(); }

}  // namespace delfront
