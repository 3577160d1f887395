// SPDX-License-Identifier: Apache-2.0
// Quality and check() against brute force: maps of facets and edges, one cell at a time, plain formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "delfront/grid_check.hpp"
#include "mesh/cell_geometry.hpp"
#include "mesh/tet_lanes.hpp"
#include "unit/mesh/grids.hpp"

namespace delfront {
namespace {

using Key = std::vector<std::uint32_t>;

double degrees(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi; }

/// A block of n^3 cubes with bent sides, each one hexahedron, two prisms, three pyramids or six tetrahedra by chance,
/// so that not all sides fit; vertices in random order, some cells there twice or three times.
Mesh random_mixed_mesh(int n, unsigned seed, double share_of_tets) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.12, 0.12), chance(0, 1);
  const auto side = static_cast<std::uint32_t>(n + 1);
  std::vector<std::uint32_t> number(side * side * side);
  std::iota(number.begin(), number.end(), 0u);
  std::shuffle(number.begin(), number.end(), random);
  Mesh mesh;
  mesh.points.resize(number.size());
  for (std::uint32_t v = 0; v < number.size(); ++v)
    mesh.points[VertexId(number[v])] = {v % side + jitter(random), v / side % side + jitter(random),
                                        v / side / side + jitter(random)};
  // local corners as VTK numbers those of a hexahedron
  const std::vector<std::vector<std::vector<std::uint32_t>>> splits = {
      {{0, 1, 2, 3, 4, 5, 6, 7}},
      {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}},
      {{0, 1, 2, 3, 6}, {0, 4, 5, 1, 6}, {0, 3, 7, 4, 6}},
      {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
  for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(n * n * n); ++c) {
    const auto m = static_cast<std::uint32_t>(n);
    const std::uint32_t at = c % m + side * (c / m % m + side * (c / m / m));
    const std::uint32_t corner[8] = {at,
                                     at + 1,
                                     at + 1 + side,
                                     at + side,
                                     at + side * side,
                                     at + 1 + side * side,
                                     at + 1 + side + side * side,
                                     at + side + side * side};
    const std::size_t kind = chance(random) < share_of_tets ? 3 : random() % 3;
    const int copies = chance(random) < 0.97 ? 1 : 2 + static_cast<int>(random() % 2);
    for (int copy = 0; copy < copies; ++copy)
      for (std::vector<std::uint32_t> cell : splits[kind]) {
        for (std::uint32_t& v : cell) v = number[corner[v]];
        const CellType type = cell.size() == 8   ? CellType::hexahedron
                              : cell.size() == 6 ? CellType::prism
                              : cell.size() == 5 ? CellType::pyramid
                                                 : CellType::tetrahedron;
        grids::add_cell(mesh, type, cell);
      }
  }
  return mesh;
}

/// One cell, with its vertices spelt out.
struct Cell {
  const CellShape* shape;
  Key vertices;
  std::vector<Point> corners;
  std::vector<FacetGeometry> facets;
  CellGeometry geometry;
};

struct Oracle {
  explicit Oracle(const Mesh& grid) : mesh(grid) {
    for (const CellBlock& block : mesh.blocks)
      for (std::size_t c = 0; dimension(block.type) == 3 && c < block.size(); ++c) add(shape_of(block.type), block[c]);
    for (const auto& [key, list] : sides) measure_facet(list);
    for (const auto& [a, b] : edges)
      values["edge_length"].push_back(distance(mesh.points[VertexId(a)], mesh.points[VertexId(b)]));
  }

  void add(const CellShape& shape, std::span<const VertexId> vertices) {
    Cell cell{&shape, {}, {}, {}, {}};
    for (const VertexId v : vertices) {
      cell.vertices.push_back(v.value);
      cell.corners.push_back(mesh.points[v]);
    }
    const std::size_t id = cells.size();
    for (int f = 0; f < shape.num_facets; ++f) {
      const auto [corners, key] = facet(cell, f);
      cell.facets.push_back(facet_geometry(corners));
      sides[key].push_back({id, f});
    }
    for (int e = 0; e < shape.num_edges; ++e)
      edges.insert(std::minmax({cell.vertices[static_cast<std::size_t>(shape.edges[e][0])],
                                cell.vertices[static_cast<std::size_t>(shape.edges[e][1])]}));
    cell.geometry = cell_geometry(cell.corners, shape, cell.facets);
    measure_cell(cell);
    cells.push_back(std::move(cell));
  }

  static std::pair<std::vector<Point>, Key> facet(const Cell& cell, int f) {
    const LocalFacet& local = cell.shape->facets[f];
    std::pair<std::vector<Point>, Key> result;
    for (int i = 0; i < local.num_vertices; ++i) {
      result.first.push_back(cell.corners[static_cast<std::size_t>(local.vertices[i])]);
      result.second.push_back(cell.vertices[static_cast<std::size_t>(local.vertices[i])]);
    }
    std::sort(result.second.begin(), result.second.end());
    return result;
  }

  void measure_cell(const Cell& cell) {
    volume += cell.geometry.volume;
    CellQuality quality;
    measure_dihedrals(*cell.shape, cell.facets, quality);
    values["min_dihedral"].push_back(quality.min_angle);
    values["max_dihedral"].push_back(quality.max_angle);
    double sum[3] = {0, 0, 0}, area = 0;
    for (const FacetGeometry& f : cell.facets) {
      for (int k = 0; k < 3; ++k) sum[k] += std::abs(f.area[k]);
      area += length(f.area);
    }
    const double by_volume = (sum[0] + sum[1] + sum[2]) / 6 / std::pow(cell.geometry.volume, 2.0 / 3);
    values["openfoam_aspect"].push_back(
        std::max(*std::max_element(sum, sum + 3) / *std::min_element(sum, sum + 3), by_volume));
    if (cell.vertices.size() > 4) return;
    double squares = 0, longest = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        squares += squared_length(cell.corners[i] - cell.corners[j]);
        longest = std::max(longest, distance(cell.corners[i], cell.corners[j]));
      }
    const double v = cell.geometry.volume, inradius = 3 * v / area;
    // the circumradius by opposite edges (Crelle): the area of the triangle with sides a a', b b', c c', over 6 V
    const auto product = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
      return distance(cell.corners[i], cell.corners[j]) * distance(cell.corners[k], cell.corners[l]);
    };
    const double a = product(0, 1, 2, 3), b = product(0, 2, 1, 3), c = product(0, 3, 1, 2), s = (a + b + c) / 2;
    values["mean_ratio"].push_back(12 * std::pow(3 * v, 2.0 / 3) / squares);
    values["radius_ratio"].push_back(3 * inradius * 6 * v / std::sqrt(s * (s - a) * (s - b) * (s - c)));
    values["aspect_ratio"].push_back(longest / (2 * std::sqrt(6.0) * inradius));
  }

  void measure_facet(const std::vector<std::pair<std::size_t, int>>& list) {
    num_boundary += list.size() == 1;
    if (list.size() > 2) return;
    const Cell& owner = cells[list[0].first];
    const std::vector<Point> corners = facet(owner, list[0].second).first;
    const FacetGeometry f = facet_geometry(corners);
    if (list.size() == 1) return values["skewness"].push_back(boundary_skewness(corners, f, owner.geometry.centre));
    const CellGeometry& other = cells[list[1].first].geometry;
    const Point d = other.centre - owner.geometry.centre;
    values["max_nonortho"].push_back(degrees(dot(d, f.area) / std::max(length(d) * length(f.area), 1e-150)));
    values["skewness"].push_back(inner_skewness(corners, f, owner.geometry.centre, other.centre));
    const double ratio = owner.geometry.volume / other.volume;
    values["volume_ratio"].push_back(std::max(ratio, 1 / ratio));
  }

  const Mesh& mesh;
  std::vector<Cell> cells;
  std::map<Key, std::vector<std::pair<std::size_t, int>>> sides;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::map<std::string, std::vector<double>> values;
  double volume = 0;
  std::size_t num_boundary = 0;
};

void expect_measure(const Measure& measure, std::vector<double> values) {
  SCOPED_TRACE(measure.name);
  std::sort(values.begin(), values.end());
  const auto near = [](double a, double b) { EXPECT_NEAR(a, b, 1e-9 * std::max(1.0, std::abs(b))); };
  near(measure.min, values.front());
  near(measure.max, values.back());
  double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  if (measure.name == "max_nonortho") {
    double sum = 0;
    for (const double angle : values) sum += std::cos(angle * std::numbers::pi / 180);
    mean = degrees(sum / static_cast<double>(values.size()));
  }
  near(measure.mean, mean);
  std::vector<std::size_t> bins(measure.histogram.size(), 0);
  const double low = measure.histogram_low, width = (measure.histogram_high - low) / static_cast<double>(bins.size());
  for (const double value : values)
    ++bins[static_cast<std::size_t>(std::clamp((value - low) / width, 0.0, static_cast<double>(bins.size()) - 1))];
  EXPECT_EQ(measure.histogram, bins);
  ASSERT_EQ(measure.worst_values.size(), 10u);
  if (!measure.worst_is_low) std::reverse(values.begin(), values.end());
  for (std::size_t i = 0; i < 10; ++i) near(measure.worst_values[i], values[i]);
}

TEST(QualitySweep, gives_what_brute_force_gives_on_random_mixed_grids) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    const Mesh mesh = random_mixed_mesh(13, seed, seed == 3 ? 0.97 : 0.5);
    const Oracle oracle(mesh);
    Context context;
    context.threads = static_cast<int>(seed);
    const QualityReport report = measure_quality(mesh, context);
    EXPECT_EQ(report.num_cells, oracle.cells.size());
    EXPECT_EQ(report.num_boundary_faces, oracle.num_boundary);
    EXPECT_NEAR(report.volume, oracle.volume, 1e-9 * oracle.volume);
    EXPECT_EQ(report.measures.size(), oracle.values.size());
    for (const Measure& measure : report.measures) expect_measure(measure, oracle.values.at(measure.name));
  }
}

void expect_identical(const QualityReport& a, const QualityReport& b) {
  EXPECT_EQ(a.volume, b.volume);
  EXPECT_EQ(a.num_boundary_faces, b.num_boundary_faces);
  EXPECT_EQ(a.cells_below_5_deg, b.cells_below_5_deg);
  EXPECT_EQ(a.cells_below_10_deg, b.cells_below_10_deg);
  ASSERT_EQ(a.measures.size(), b.measures.size());
  for (std::size_t i = 0; i < a.measures.size(); ++i) {
    const Measure &m = a.measures[i], &n = b.measures[i];
    SCOPED_TRACE(m.name);
    EXPECT_EQ(m.name, n.name);
    EXPECT_EQ(m.min, n.min);
    EXPECT_EQ(m.max, n.max);
    EXPECT_EQ(m.mean, n.mean);
    EXPECT_EQ(m.histogram, n.histogram);
    EXPECT_EQ(m.histogram_low, n.histogram_low);
    EXPECT_EQ(m.histogram_high, n.histogram_high);
    EXPECT_EQ(m.worst_values, n.worst_values);
    ASSERT_EQ(m.worst.size(), n.worst.size());
    for (std::size_t k = 0; k < m.worst.size(); ++k) {
      EXPECT_EQ(m.worst[k].ids, n.worst[k].ids);
      EXPECT_EQ(m.worst[k].at, n.worst[k].at);
    }
  }
}

TEST(QualitySweep, any_number_of_threads_gives_the_same_report_bit_for_bit) {
  Mesh plane = grids::square(150);
  for (Point& p : plane.points) p.x += 1e-3 * std::sin(40 * p.y);
  for (const Mesh& mesh : {random_mixed_mesh(24, 5, 0.8), grids::cube(20), plane}) {
    Context one;
    const QualityReport expected = measure_quality(mesh, one);
    for (const int threads : {2, 5}) {
      Context context;
      context.threads = threads;
      expect_identical(expected, measure_quality(mesh, context));
    }
  }
}

TEST(QualitySweep, of_equally_bad_cells_those_with_the_lowest_numbers_are_named) {
  Context context;
  context.threads = 2;
  const QualityReport report = measure_quality(grids::cube(20), context);
  const Measure& measure = *report.find("radius_ratio");  // all cells are alike but for rounding
  for (std::size_t i = 1; i < measure.worst.size(); ++i) {
    if (measure.worst_values[i - 1] != measure.worst_values[i]) continue;
    EXPECT_LT(measure.worst[i - 1].ids[0], measure.worst[i].ids[0]);
  }
}

TEST(QualitySweep, stops_when_told_to) {
  std::atomic<bool> cancel{true};
  Context context;
  context.threads = 3;
  context.cancel = &cancel;
  EXPECT_THROW(measure_quality(grids::cube(20), context), Cancelled);
}

TEST(CheckSweep, reports_facets_in_the_order_of_their_vertices) {
  const Mesh mesh = grids::cube_cells(9);
  Mesh stored = mesh;
  grids::store_boundary(stored);  // by a map: in that order too
  const std::vector<Finding> findings = check(mesh);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, "missing_boundary_facets");
  EXPECT_EQ(findings[0].count, stored.find_block(CellType::triangle)->size());
  for (std::size_t i = 0; i < findings[0].places.size(); ++i) {
    const auto face = (*stored.find_block(CellType::triangle))[i];
    Key key = {face[0].value, face[1].value, face[2].value};
    std::sort(key.begin(), key.end());
    EXPECT_EQ(findings[0].places[i].ids, key);
  }
}

/// Dihedral angle at edge (i, j) of a tetrahedron with the other corners k and l, by the arc tangent.
double dihedral(const Point* p, int i, int j, int k, int l) {
  const Point along = (p[j] - p[i]) / distance(p[i], p[j]);
  const Point u = cross(along, p[k] - p[i]), v = cross(along, p[l] - p[i]);
  return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

TEST(TetLanes, angles_of_flat_and_of_sharp_tetrahedra_are_right) {
  // A ridge along the z axis whose dihedral angle grows from nearly nothing to nearly flat.
  for (double angle = 0.01; angle < 179.99; angle += 0.37) {
    const double half = angle / 2 * std::numbers::pi / 180;
    const Point p[4] = {
        {0, 0, -1}, {std::cos(half), -std::sin(half), 0}, {std::cos(half), std::sin(half), 0.3}, {0, 0, 1}};
    LanePoints corners[4];
    for (int i = 0; i < 4; ++i)
      for (int lane = 0; lane < kLanes; ++lane) corners[i].set(lane, p[i]);
    TetLanes tets;
    measure_tets(corners, tets);
    const double angles[6] = {dihedral(p, 0, 1, 2, 3), dihedral(p, 0, 2, 1, 3), dihedral(p, 0, 3, 1, 2),
                              dihedral(p, 1, 2, 0, 3), dihedral(p, 1, 3, 0, 2), dihedral(p, 2, 3, 0, 1)};
    EXPECT_GT(tets.volume.lane[0], 0);
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_NEAR(tets.min_dihedral.lane[lane], *std::min_element(angles, angles + 6), 1e-9) << angle;
      EXPECT_NEAR(tets.max_dihedral.lane[lane], *std::max_element(angles, angles + 6), 1e-9) << angle;
    }
  }
}

}  // namespace
}  // namespace delfront
