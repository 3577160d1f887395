// SPDX-License-Identifier: Apache-2.0
// Halved edges without a geometry: counts, volumes, conformity, names, values; the same for any number of threads.
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "delfront/grid_check.hpp"
#include "predicates/predicates.hpp"
#include "unit/refine/refine_fixtures.hpp"

namespace delfront {
namespace {

using namespace refine_fixtures;

double volume_of(const Mesh& mesh) {
  Context context;
  return measure_quality(mesh, context).volume;
}

/// Area of the faces of each group, by name.
std::map<std::string, double> areas_of(const Mesh& mesh) {
  std::map<std::string, double> areas;
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t i = 0; i < block.size() && dimension(block.type) == 2; ++i) {
      const auto v = block[i];
      const Point a = mesh.points[v[0]], last = mesh.points[v[v.size() - 1]];
      const Point diagonal = v.size() == 4 ? mesh.points[v[3]] - mesh.points[v[1]] : last - mesh.points[v[1]];
      areas[mesh.groups[block.group[i]].name] += 0.5 * length(cross(mesh.points[v[2]] - a, diagonal));
    }
  return areas;
}

std::string first_error(const Mesh& mesh) {
  for (const Finding& f : check(mesh))
    if (f.severity == Severity::error) return f.message;
  return "";
}

bool are_same(const Mesh& a, const Mesh& b) {
  if (a.points != b.points || a.blocks.size() != b.blocks.size() || a.fields.size() != b.fields.size()) return false;
  for (std::size_t i = 0; i < a.blocks.size(); ++i)
    if (a.blocks[i].type != b.blocks[i].type || a.blocks[i].vertices != b.blocks[i].vertices ||
        a.blocks[i].group != b.blocks[i].group)
      return false;
  for (std::size_t i = 0; i < a.fields.size(); ++i)
    if (a.fields[i].values != b.fields[i].values) return false;
  if (a.vertex_entity.size() != b.vertex_entity.size()) return false;
  for (std::size_t i = 0; i < a.vertex_entity.size(); ++i)
    if (a.vertex_entity[i].dimension != b.vertex_entity[i].dimension || a.vertex_entity[i].id != b.vertex_entity[i].id)
      return false;
  return true;
}

TEST(RefineGrid, each_type_becomes_its_children_and_keeps_its_volume) {
  const std::map<CellType, std::size_t> children = {{CellType::triangle, 4},    {CellType::quad, 4},
                                                    {CellType::tetrahedron, 8}, {CellType::pyramid, 6},
                                                    {CellType::prism, 8},       {CellType::hexahedron, 8}};
  for (const OneCell& one : one_of_each()) {
    SCOPED_TRACE(name_of(one.type));
    const Mesh coarse = grids::single_cell(one.type, one.points);
    EXPECT_NEAR(volume_of(coarse), one.measure, 1e-14);
    const Mesh fine = refined(coarse);
    EXPECT_EQ(first_error(fine), "");
    EXPECT_EQ(fine.num_cells(one.type), children.at(one.type));
    if (one.type == CellType::pyramid) {
      EXPECT_EQ(fine.num_cells(CellType::tetrahedron), 4u);
    }
    EXPECT_EQ(fine.num_cells_of_dimension(fine.top_dimension()), num_cells_after(coarse, 1));
    EXPECT_NEAR(volume_of(fine), one.measure, 1e-14);
    const Mesh finer = refined(coarse, 3);
    EXPECT_EQ(first_error(finer), "");
    EXPECT_EQ(finer.num_cells_of_dimension(finer.top_dimension()), num_cells_after(coarse, 3));
    EXPECT_NEAR(volume_of(finer), one.measure, 1e-13);
  }
}

TEST(RefineGrid, old_points_stay_and_new_ones_are_middles) {
  const Mesh coarse = grids::corner_tet();
  const Mesh fine = refined(coarse);
  ASSERT_EQ(fine.points.size(), 10u);
  for (std::size_t v = 0; v < 4; ++v) EXPECT_EQ(fine.points[VertexId(v)], coarse.points[VertexId(v)]);
  std::size_t next = 4;  // by lower end, then higher
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b)
      EXPECT_EQ(fine.points[VertexId(next++)], 0.5 * (coarse.points[VertexId(a)] + coarse.points[VertexId(b)]));
}

TEST(RefineGrid, the_inner_diagonal_is_the_shortest) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Point> p(4);
    for (Point& q : p) q = {coordinate(random), coordinate(random), coordinate(random)};
    const int sign = orient3d(p[0], p[1], p[2], p[3]);
    if (sign == 0) continue;
    if (sign < 0) std::swap(p[0], p[1]);
    const Mesh fine = refined(grids::single_cell(CellType::tetrahedron, p));
    const double lengths[3] = {length(p[2] + p[3] - p[0] - p[1]) / 2, length(p[1] + p[3] - p[0] - p[2]) / 2,
                               length(p[1] + p[2] - p[0] - p[3]) / 2};
    const CellBlock& tets = *fine.find_block(CellType::tetrahedron);
    const double inner = distance(fine.points[tets[4][0]], fine.points[tets[4][1]]);
    EXPECT_NEAR(inner, *std::min_element(lengths, lengths + 3), 1e-14) << "trial " << trial << ", seed 11";
  }
}

TEST(RefineGrid, mixed_grids_stay_conforming_with_their_volume_and_groups) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    Mesh coarse = mixed_block(4, seed, 0);
    add_groups(coarse, 2);
    ASSERT_EQ(first_error(coarse), "");
    const Mesh fine = refined(coarse, 2);
    EXPECT_EQ(first_error(fine), "");
    EXPECT_EQ(fine.num_cells_of_dimension(3), num_cells_after(coarse, 2));
    EXPECT_NEAR(volume_of(fine), volume_of(coarse), 1e-10);
    const auto before = areas_of(coarse), after = areas_of(fine);
    ASSERT_EQ(before.size(), after.size());
    for (const auto& [name, area] : before) EXPECT_NEAR(after.at(name), area, 1e-11) << name;
    for (std::size_t g = 0; g < coarse.groups.size(); ++g) {
      EXPECT_EQ(fine.groups[GroupId(g)].name, coarse.groups[GroupId(g)].name);
      EXPECT_EQ(fine.groups[GroupId(g)].kind, coarse.groups[GroupId(g)].kind);
      EXPECT_EQ(fine.groups[GroupId(g)].two_sided, coarse.groups[GroupId(g)].two_sided);
    }
  }
}

TEST(RefineGrid, bent_mixed_grids_stay_valid) {
  for (const unsigned seed : {4u, 5u}) {
    const Mesh coarse = mixed_block(4, seed, 0.08);
    ASSERT_EQ(first_error(coarse), "") << "seed " << seed;
    EXPECT_EQ(first_error(refined(coarse)), "") << "seed " << seed;
  }
}

TEST(RefineGrid, twice_one_level_is_two_levels) {
  Mesh coarse = mixed_block(3, 6, 0.05);
  add_groups(coarse, 1.5);
  EXPECT_TRUE(are_same(refined(refined(coarse)), refined(coarse, 2)));
  const Mesh square = grids::square(4);
  EXPECT_TRUE(are_same(refined(refined(square)), refined(square, 2)));
}

TEST(RefineGrid, any_number_of_threads_gives_the_same_bytes) {
  Mesh coarse = mixed_block(16, 7, 0.05);
  add_groups(coarse, 8);
  coarse.fields.push_back({"height", Field::On::vertices, CellType::tetrahedron, 1, {}});
  for (const Point& p : coarse.points) coarse.fields[0].values.push_back(p.z);
  const Mesh one = refined(coarse, 1);
  for (const int threads : {2, 3, 8}) EXPECT_TRUE(are_same(one, refined(coarse, 1, nullptr, nullptr, threads)));
}

TEST(RefineGrid, linear_fields_stay_linear_and_cell_fields_are_inherited) {
  Mesh coarse = mixed_block(3, 8, 0.05);
  const auto linear = [](Point p) { return 3 * p.x - 2 * p.y + 0.5 * p.z + 7; };
  Field nodes{"T", Field::On::vertices, CellType::tetrahedron, 2, {}};
  for (const Point& p : coarse.points) nodes.values.insert(nodes.values.end(), {linear(p), -linear(p)});
  coarse.fields.push_back(nodes);
  double number = 0;
  for (const CellBlock& block : coarse.blocks) {
    Field cells{"id", Field::On::cells, block.type, 1, {}};
    for (std::size_t i = 0; i < block.size(); ++i) cells.values.push_back(number++);
    if (dimension(block.type) == 3) coarse.fields.push_back(cells);
  }
  const Mesh fine = refined(coarse);
  const std::vector<double>& values = fine.fields[0].values;
  ASSERT_EQ(values.size(), 2 * fine.points.size());
  for (std::size_t v = 0; v < fine.points.size(); ++v) {
    EXPECT_NEAR(values[2 * v], linear(fine.points[VertexId(v)]), 1e-13);
    EXPECT_EQ(values[2 * v + 1], -values[2 * v]);
  }
  std::map<double, std::size_t> children;  // each parent's number stands in all its children
  for (const Field& f : fine.fields)
    if (f.on == Field::On::cells) {
      EXPECT_EQ(f.values.size(), fine.num_cells(f.block));
      for (const double id : f.values) ++children[id];
    }
  EXPECT_EQ(children.size(), coarse.num_cells_of_dimension(3));
  std::size_t tens = 0;
  for (const auto& [id, count] : children) {
    EXPECT_TRUE(count == 8 || count == 10);
    tens += count == 10;
  }
  EXPECT_EQ(tens, coarse.num_cells(CellType::pyramid));
}

TEST(RefineGrid, pyramids_alone_hand_their_field_to_their_tetrahedra) {
  Mesh coarse = grids::single_cell(CellType::pyramid, one_of_each()[3].points);
  coarse.fields.push_back({"k", Field::On::cells, CellType::pyramid, 1, {5}});
  const Mesh fine = refined(coarse);
  ASSERT_EQ(fine.fields.size(), 2u);
  EXPECT_EQ(fine.fields[0].values, std::vector<double>(6, 5));
  EXPECT_EQ(fine.fields[1].block, CellType::tetrahedron);
  EXPECT_EQ(fine.fields[1].values, std::vector<double>(4, 5));
  EXPECT_EQ(refined(fine).fields[1].values, std::vector<double>(8 * 4 + 4 * 6, 5));
}

TEST(RefineGrid, a_plane_grid_keeps_its_area_and_its_lines) {
  Mesh coarse = grids::square(4);
  CellBlock& lines = coarse.block(CellType::line);
  const GroupId rim = coarse.add_group(1, "rim", "wall");
  lines.group.assign(lines.size(), rim);
  const Mesh fine = refined(coarse, 2);
  EXPECT_EQ(first_error(fine), "");
  EXPECT_EQ(fine.dimension, 2);
  EXPECT_EQ(fine.num_cells(CellType::quad), 16 * coarse.num_cells(CellType::quad));
  EXPECT_EQ(fine.num_cells(CellType::triangle), 16 * coarse.num_cells(CellType::triangle));
  EXPECT_NEAR(volume_of(fine), 1, 1e-14);
  const CellBlock& edges = *fine.find_block(CellType::line);
  EXPECT_EQ(edges.size(), 64u);
  double length_of_all = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(edges.group[i], rim);
    length_of_all += distance(fine.points[edges[i][0]], fine.points[edges[i][1]]);
  }
  EXPECT_DOUBLE_EQ(length_of_all, 4);
}

TEST(RefineGrid, a_surface_and_lines_alone_are_divided_too) {
  const Mesh sphere = fixtures::sphere_surface(1);
  const Mesh fine = refined(sphere);
  EXPECT_EQ(first_error(fine), "");
  EXPECT_EQ(fine.points.size(), 162u);  // V - E + F = 2
  EXPECT_EQ(fine.num_cells(CellType::triangle), 320u);
  Mesh lines;
  lines.points = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}};
  grids::add_cell(lines, CellType::line, {1, 0});
  grids::add_cell(lines, CellType::line, {1, 2});
  const Mesh halves = refined(lines, 2);
  EXPECT_EQ(halves.points.size(), 9u);
  EXPECT_EQ(halves.num_cells(CellType::line), 8u);
}

TEST(RefineGrid, a_vertex_of_very_many_cells) {
  constexpr std::uint32_t kRim = 20000;
  Mesh fan;
  fan.dimension = 2;
  fan.points.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i < kRim; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRim;
    fan.points.push_back({std::cos(angle), std::sin(angle), 0});
    grids::add_cell(fan, CellType::triangle, {0, 1 + i, 1 + (i + 1) % kRim});
  }
  grids::store_boundary(fan);
  const Mesh fine = refined(fan);
  EXPECT_EQ(first_error(fine), "");
  EXPECT_NEAR(volume_of(fine), volume_of(fan), 1e-12);
}

TEST(RefineGrid, lines_points_and_entities_come_along) {
  Mesh coarse = grids::cube(2);
  add_groups(coarse, 0.5);
  const GroupId wire = coarse.add_group(1, "wire"), probe = coarse.add_group(0, "probe");
  grids::add_cell(coarse, CellType::line, {0, 1});
  coarse.block(CellType::line).group = {wire};
  grids::add_cell(coarse, CellType::vertex, {13});
  coarse.block(CellType::vertex).group = {probe};
  const auto entity_at = [](Point p) -> VertexEntity {  // patches 10, 11 at x = 0, 1, and so on; region 4
    VertexEntity e{3, 4, 0, 0};
    for (int k = 0; k < 3; ++k)
      if (p[k] == 0 || p[k] == 1)
        e = e.dimension == 3 ? VertexEntity{2, static_cast<std::uint32_t>(10 + 2 * k + (p[k] == 1)), 0, 0}
                             : VertexEntity{1, Id<struct EntityTag>::kNone, 0, 0};
    return e;
  };
  for (const Point& p : coarse.points) coarse.vertex_entity.push_back(entity_at(p));
  const Mesh fine = refined(coarse, 2);
  EXPECT_EQ(first_error(fine), "");
  EXPECT_EQ(fine.find_block(CellType::line)->group, std::vector<GroupId>(4, wire));
  EXPECT_EQ((*fine.find_block(CellType::vertex))[0][0], VertexId(13));
  ASSERT_EQ(fine.vertex_entity.size(), fine.points.size());
  for (std::size_t v = 0; v < fine.points.size(); ++v) {
    const VertexEntity e = fine.vertex_entity[v], expected = entity_at(fine.points[VertexId(v)]);
    EXPECT_EQ(e.dimension, expected.dimension) << v;
    EXPECT_EQ(e.id, expected.id) << v;
  }
}

TEST(RefineGrid, what_cannot_be_refined_is_refused) {
  Context context;
  RefineGridReport report;
  const Mesh tet = grids::corner_tet();
  EXPECT_THROW(refine_grid(tet, {.levels = 0}, report, context), UsageError);
  EXPECT_THROW(refine_grid(tet, {.levels = -1}, report, context), UsageError);
  EXPECT_THROW(refine_grid(Mesh(), {}, report, context), InputError);
  Mesh polygon = grids::square(2);
  polygon.block(CellType::polygon).vertices = {VertexId(0), VertexId(1), VertexId(2)};
  polygon.block(CellType::polygon).offsets = {0, 3};
  EXPECT_THROW(refine_grid(polygon, {}, report, context), InputError);
  Mesh loose = grids::cube(1);
  grids::add_cell(loose, CellType::triangle, {0, 2, 5});  // two of its sides are no edges
  EXPECT_THROW(refine_grid(loose, {}, report, context), InputError);
  const Model sphere = sphere_model(1);
  EXPECT_THROW(refine_grid(loose, {.model = &sphere}, report, context), InputError);
  EXPECT_THROW(refine_grid(grids::square(2), {.model = &sphere}, report, context), InputError);
  Mesh broken = tet;
  broken.block(CellType::tetrahedron).vertices[2] = VertexId(77);
  EXPECT_THROW(refine_grid(broken, {}, report, context), InputError);
  broken = tet;
  broken.fields.push_back({"short", Field::On::vertices, CellType::tetrahedron, 1, {1, 2}});
  EXPECT_THROW(refine_grid(broken, {}, report, context), InputError);
}

TEST(RefineGrid, limits_stop_it_before_it_starts) {
  Context context;
  RefineGridReport report;
  context.max_cells = 63;
  EXPECT_THROW(refine_grid(grids::corner_tet(), {.levels = 2}, report, context), LimitError);
  EXPECT_THROW(refine_grid(grids::corner_tet(), {.levels = 1000}, report, context), LimitError);
  context.max_cells = 64;
  EXPECT_EQ(refine_grid(grids::corner_tet(), {.levels = 2}, report, context).num_cells(CellType::tetrahedron), 64u);
  std::atomic<bool> stop = true;
  context.cancel = &stop;
  EXPECT_THROW(refine_grid(grids::corner_tet(), {}, report, context), Cancelled);
}

/// Positive, exactly, but so flat that the middles of its edges round into its base.
TEST(RefineGrid, a_cell_too_flat_for_its_children_is_named) {
  const double least = std::numeric_limits<double>::denorm_min();
  const Mesh coarse = grids::single_cell(CellType::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, least}});
  ASSERT_EQ(first_error(coarse), "");
  try {
    refined(coarse);
    FAIL() << "flat children are no grid";
  } catch (const MeshingError& e) {
    ASSERT_FALSE(e.places.empty());
    EXPECT_LE(distance(e.places[0].at, {0.3, 0.3, 0}), 0.5);
  }
}

}  // namespace
}  // namespace delfront
