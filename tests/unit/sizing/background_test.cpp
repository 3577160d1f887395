// SPDX-License-Identifier: Apache-2.0
#include "delfront/background.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "background_grids.hpp"
#include "base/hilbert.hpp"
#include "delfront/errors.hpp"
#include "support/errors.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using namespace fixtures;

std::unique_ptr<BackgroundField> build(Mesh mesh, const BackgroundOptions& options = {}) {
  Context context;
  BackgroundGrid grid;
  grid.mesh = std::move(mesh);
  return build_background_size_field(grid, options, context);
}

template <class Error>
std::string message_of_building(const BackgroundGrid& grid, const BackgroundOptions& options = {}) {
  Context context;
  return message_of<Error>([&] { build_background_size_field(grid, options, context); });
}

double linear(Point p) { return 0.3 + 0.1 * p.x - 0.05 * p.y + 0.07 * p.z; }
double wavy(Point p) { return 0.1 + 0.05 * std::sin(7 * p.x + 3 * p.y) * std::cos(5 * p.z - p.x); }

TEST(Background, S6_linear_sizes_come_back_exactly) {
  Mesh mesh = kuhn_box(6, 0.2);
  add_node_field(mesh, "h", linear);
  const auto field = build(std::move(mesh));
  EXPECT_TRUE(field->is_isotropic());
  for (const Point& p : random_points(20000, 0, 1, 3)) ASSERT_NEAR(field->size(p), linear(p), 1e-12 * linear(p));
}

TEST(Background, S6_plane_sizes_hold_for_every_z) {
  Mesh mesh = square_grid(8, 0.2);
  add_node_field(mesh, "h", linear);
  const auto field = build(std::move(mesh));
  for (Point p : random_points(5000, 0, 1, 4)) {
    const Point flat{p.x, p.y, 0};
    ASSERT_NEAR(field->size(p), linear(flat), 1e-12 * linear(flat));
    ASSERT_EQ(field->size(p), field->size(flat));
    const double r = 0.05;
    ASSERT_LE(field->lower_bound({p - Point{r, r, r}, p + Point{r, r, r}}), field->size(p));
  }
}

TEST(Background, S6_outside_is_the_value_of_the_nearest_boundary_point) {
  Mesh mesh = kuhn_box(4, 0.2);
  add_node_field(mesh, "h", linear);
  const auto field = build(std::move(mesh));
  std::size_t outside = 0;
  for (const Point& p : random_points(5000, -1, 2, 5)) {
    const Point near{std::clamp(p.x, 0.0, 1.0), std::clamp(p.y, 0.0, 1.0), std::clamp(p.z, 0.0, 1.0)};
    outside += !(near == p);
    ASSERT_NEAR(field->size(p), linear(near), 1e-12);
  }
  EXPECT_DOUBLE_EQ(field->share_outside(random_points(5000, -1, 2, 5)), double(outside) / 5000);
}

TEST(Background, S6_holes_take_the_value_of_their_rim) {
  Mesh mesh = kuhn_box(8, 0, 1, [](Point c) { return std::abs(c.x - 0.5) > 0.25 || std::abs(c.y - 0.5) > 0.25; });
  add_node_field(mesh, "h", [](Point p) { return linear({p.x, 0, 0}); });
  const auto field = build(std::move(mesh));
  // The hole is 0.25 < x, y < 0.75 for all z: the nearest rim of this place is x = 0.25.
  EXPECT_NEAR(field->size({0.3, 0.5, 0.5}), linear({0.25, 0, 0}), 1e-14);
  EXPECT_NEAR(field->size({0.5, 0.74, 0.5}), linear({0.5, 0, 0}), 1e-14);
  EXPECT_EQ(field->share_outside(std::vector<Point>{{0.5, 0.5, 0.5}, {0.1, 0.5, 0.5}}), 0.5);
}

TEST(Background, S6_same_bits_in_any_order_also_on_faces_and_nodes) {
  Mesh mesh = kuhn_box(5, 0.15);
  add_node_field(mesh, "h", wavy);
  std::vector<Point> points = random_points(4000, -0.2, 1.2, 6);
  points.insert(points.end(), mesh.points.begin(), mesh.points.end());
  const CellBlock& tets = mesh.block(CellType::tetrahedron);
  for (std::size_t cell = 0; cell < tets.size(); ++cell) {  // middles of edges and faces
    const auto v = tets[cell];
    points.push_back(0.5 * (mesh.points[v[0]] + mesh.points[v[1]]));
    points.push_back((mesh.points[v[0]] + mesh.points[v[1]] + mesh.points[v[2]]) / 3);
  }
  const auto field = build(std::move(mesh));
  std::vector<double> alone(points.size()), batch(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) alone[i] = field->size(points[i]);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::vector<std::size_t> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    std::vector<Point> shuffled;
    for (std::size_t i : order) shuffled.push_back(points[i]);
    field->sizes(shuffled, batch);
    for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(batch[i], alone[order[i]]) << "seed " << seed;
  }
}

void expect_lower_bounds(const SizeField& field, unsigned seed, bool is_plane) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const std::vector<Point> centres = random_points(500, -0.5, 1.5, seed, is_plane);
  for (const Point& c : centres) {
    const double r = std::pow(10, -3 * unit(random));
    Box box;
    std::vector<Point> inside;
    const auto place = [&] {
      return c + r * Point{2 * unit(random) - 1, 2 * unit(random) - 1, is_plane ? 0 : 2 * unit(random) - 1};
    };
    for (int k = 0; k < 2; ++k) box.add(place());
    for (int k = 0; k < 60; ++k) {
      Point p;
      for (int a = 0; a < 3; ++a) p[a] = box.low[a] + unit(random) * (box.high[a] - box.low[a]);
      inside.push_back(p);
    }
    inside.push_back(box.low);
    inside.push_back(box.high);
    std::vector<double> size(inside.size());
    field.sizes(inside, size);
    const double bound = field.lower_bound(box);
    ASSERT_GT(bound, 0);
    for (std::size_t k = 0; k < size.size(); ++k) ASSERT_LE(bound, size[k]) << "seed " << seed;
    ASSERT_LE(*std::max_element(size.begin(), size.end()), field.largest() * (1 + 1e-12));
  }
}

bool is_off_the_bar(Point c) { return std::abs(c.x - 0.5) > 0.25 || std::abs(c.y - 0.5) > 0.25; }

TEST(Background, S6_lower_bounds_hold) {
  Mesh box = kuhn_box(6, 0.2), holed = kuhn_box(8, 0, 1, is_off_the_bar), plane = square_grid(9, 0.2);
  for (Mesh* mesh : {&box, &holed, &plane}) {
    add_node_field(*mesh, "h", wavy);
    expect_lower_bounds(*build(*mesh), 7, mesh->dimension == 2);
    expect_lower_bounds(*build(*mesh, {.growth = 1.1}), 8, mesh->dimension == 2);
  }
}

TEST(Background, S6_lower_bound_is_tight_inside) {
  Mesh mesh = kuhn_box(10);
  add_node_field(mesh, "h", linear);
  const auto field = build(std::move(mesh));
  // A box of one cell's width: no lower than the least over it and one ring.
  for (const Point& p : random_points(500, 0.2, 0.8, 9)) {
    const Box box{p - Point{0.05, 0.05, 0.05}, p + Point{0.05, 0.05, 0.05}};
    EXPECT_GT(field->lower_bound(box), linear({box.low.x - 0.1, box.high.y + 0.1, box.low.z - 0.1}) - 1e-9);
  }
}

void expect_slope(const SizeField& field, double slope, unsigned seed, bool is_plane) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::vector<Point> from = random_points(5000, -0.5, 1.5, seed, is_plane);
  std::vector<Point> to;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double r = std::pow(10, 2 * unit(random) - 2);
    to.push_back(from[i] + r * Point{unit(random), unit(random), is_plane ? 0 : unit(random)});
  }
  std::vector<double> a(from.size()), b(to.size());
  field.sizes(from, a);
  field.sizes(to, b);
  for (std::size_t i = 0; i < from.size(); ++i)
    ASSERT_LE(std::abs(a[i] - b[i]), slope * distance(from[i], to[i]) * (1 + 1e-9) + 1e-11) << "seed " << seed;
}

TEST(Background, S6_growth_is_never_exceeded_anywhere) {
  // One small node in a corner, one in the middle, wild ones elsewhere; with a hole the slope holds across it too.
  std::mt19937 random(11);
  std::uniform_real_distribution<double> wild(0.01, 1);
  Mesh box = kuhn_box(6, 0.25), holed = kuhn_box(8, 0, 1, is_off_the_bar), plane = square_grid(9, 0.25),
       bent = square_grid(8, 0.1, 1, [](Point c) { return c.x < 0.5 || c.y < 0.25; });
  for (Mesh* mesh : {&box, &holed, &plane, &bent}) {
    add_node_field(*mesh, "h", [&](Point) { return wild(random); });
    for (const double growth : {1.05, 1.2, 2.0}) {
      const auto field = build(*mesh, {.growth = growth});
      expect_slope(*field, (growth - 1) / growth, 12, mesh->dimension == 2);
    }
  }
}

TEST(Background, S6_growth_never_raises_and_keeps_the_least) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> wild(0.01, 1);
  Mesh mesh = kuhn_box(6, 0.25);
  add_node_field(mesh, "h", [&](Point) { return wild(random); });
  const std::vector<double> asked = mesh.fields[0].values;
  const std::vector<Point> nodes(mesh.points.begin(), mesh.points.end());
  const auto free = build(mesh), limited = build(mesh, {.growth = 1.2});
  std::size_t lowered = 0;
  for (const Point& p : random_points(5000, -0.5, 1.5, 14)) {
    ASSERT_LE(limited->size(p), free->size(p) * (1 + 1e-12));
    lowered += limited->size(p) < free->size(p);
  }
  EXPECT_GT(lowered, 2500u);
  const auto least = static_cast<std::size_t>(std::min_element(asked.begin(), asked.end()) - asked.begin());
  EXPECT_DOUBLE_EQ(limited->size(nodes[least]), asked[least]);
}

TEST(Background, S6_growth_leaves_a_field_alone_that_keeps_it) {
  Mesh mesh = kuhn_box(6, 0.2);
  const Point rise{0.1, -0.05, 0.07};
  add_node_field(mesh, "h", linear);
  const double slope = length(rise);
  const auto field = build(std::move(mesh), {.growth = 1 / (1 - slope)});
  for (const Point& p : random_points(5000, 0, 1, 15)) ASSERT_NEAR(field->size(p), linear(p), 1e-10);
}

TEST(Background, S6_growth_from_one_small_node_is_the_cone) {
  // The largest field with slope k below this one is min(1, 0.01 + k r), but near the top in the last cells.
  Mesh mesh = kuhn_box(16);
  add_node_field(mesh, "h", [](Point p) { return length(p) == 0 ? 0.01 : 1; });
  const double k = 0.2 / 1.2;
  const auto field = build(std::move(mesh), {.growth = 1.2});
  for (const Point& p : random_points(5000, -0.5, 1, 16)) {
    const Point near{std::max(p.x, 0.0), std::max(p.y, 0.0), std::max(p.z, 0.0)};
    ASSERT_NEAR(field->size(p), 0.01 + k * length(near), 1e-12);
  }
}

TEST(Background, S6_growth_is_the_largest_field_with_that_slope) {
  // Against the least over a fine sampling of all cells: never above it, and never below by more than it is coarse.
  std::mt19937 random(27);
  std::uniform_real_distribution<double> wild(0.1, 0.6);
  Mesh mesh = square_grid(4, 0.2);
  add_node_field(mesh, "h", [&](Point) { return wild(random); });
  const auto free = build(mesh), limited = build(mesh, {.growth = 1.3});
  const double k = 0.3 / 1.3, step = 1.0 / 200;
  std::vector<Point> samples;
  for (int j = 0; j <= 200; ++j)
    for (int i = 0; i <= 200; ++i) samples.push_back({i * step, j * step, 0});
  std::vector<double> size(samples.size());
  free->sizes(samples, size);
  for (const Point& p : random_points(100, 0, 1, 28, true)) {
    double least = free->size(p);
    for (std::size_t i = 0; i < samples.size(); ++i) least = std::min(least, size[i] + k * distance(p, samples[i]));
    ASSERT_LE(limited->size(p), least + 1e-12);
    ASSERT_GE(limited->size(p), least - 10 * step);
  }
}

TEST(Background, S6_scaling_by_a_power_of_two_is_exact) {
  Mesh mesh = kuhn_box(5, 0.2);
  add_node_field(mesh, "h", wavy);
  const double s = 1048576;
  Mesh large = mesh;
  for (Point& p : large.points) p = s * p;
  for (double& h : large.fields[0].values) h *= s;
  const auto small_field = build(mesh, {.growth = 1.1}), large_field = build(large, {.growth = 1.1});
  for (const Point& p : random_points(5000, -0.5, 1.5, 17))
    ASSERT_EQ(large_field->size(s * p), s * small_field->size(p));
}

TEST(Background, S6_turned_and_scaled_grids_give_the_same_sizes) {
  const double a = 0.7, b = 0.4;
  const auto turn = [&](Point p) {
    const Point q{std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
    return Point{q.x, std::cos(b) * q.y - std::sin(b) * q.z, std::sin(b) * q.y + std::cos(b) * q.z};
  };
  Mesh mesh = kuhn_box(5, 0.2);
  add_node_field(mesh, "h", wavy);
  const auto field = build(mesh, {.growth = 1.15});
  for (const double s : {1e-6, 1.0, 1e6}) {
    Mesh turned = mesh;
    for (Point& p : turned.points) p = s * turn(p);
    for (double& h : turned.fields[0].values) h *= s;
    const auto other = build(turned, {.growth = 1.15});
    for (const Point& p : random_points(2000, -0.5, 1.5, 18))
      ASSERT_NEAR(other->size(s * turn(p)) / s, field->size(p), 1e-9);
  }
}

TEST(Background, S6_other_cells_are_split_alike_on_both_sides) {
  // A linear field over mixed cells is met by every split; a hexahedron beside a prism beside a pyramid leave no gap.
  Mesh mesh;
  for (Point p : {Point{0, 0, 0},
                  {1, 0, 0},
                  {1, 1, 0},
                  {0, 1, 0},
                  {0, 0, 1},
                  {1, 0, 1},
                  {1, 1, 1},
                  {0, 1, 1},
                  {2, 0.5, 0},
                  {2, 0.5, 1},
                  {0.5, 0.5, 2}})
    mesh.points.push_back(p);
  const auto add = [&](CellType type, std::initializer_list<std::size_t> corners) {
    CellBlock& block = mesh.block(type);
    for (std::size_t v : corners) block.vertices.push_back(VertexId(v));
    block.group.push_back(GroupId());
  };
  add(CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  add(CellType::prism, {1, 8, 2, 5, 9, 6});
  add(CellType::pyramid, {4, 5, 6, 7, 10});
  add_node_field(mesh, "h", linear);
  const auto field = build(std::move(mesh));
  std::vector<Point> inside;
  for (const Point& p : random_points(4000, 0, 1, 19)) {
    inside.push_back(p);
    inside.push_back({2 - p.x, 0.5 + (p.y - 0.5) * p.x, p.z});
    inside.push_back({0.5 + (p.x - 0.5) * (1 - p.z), 0.5 + (p.y - 0.5) * (1 - p.z), 1 + p.z});
  }
  EXPECT_EQ(field->share_outside(inside), 0);
  for (const Point& p : inside) ASSERT_NEAR(field->size(p), linear(p), 1e-12);
}

TEST(Background, S6_metrics_are_log_euclidean_means) {
  Mesh mesh = kuhn_box(1);
  // Sizes e^(x) along x, e^(2 y) along y, 0.1 along z: their logarithms are linear, so the mean is exact.
  add_node_field(mesh, "M",
                 [](Point p) { return std::array{std::exp(-2 * p.x), std::exp(-4 * p.y), 100.0, 0.0, 0.0, 0.0}; });
  const auto field = build(std::move(mesh));
  EXPECT_FALSE(field->is_isotropic());
  std::vector<Point> at = random_points(2000, 0, 1, 20);
  std::vector<Metric> metric(at.size());
  field->metrics(at, metric);
  for (std::size_t i = 0; i < at.size(); ++i) {
    ASSERT_NEAR(metric[i].xx, std::exp(-2 * at[i].x), 1e-12);
    ASSERT_NEAR(metric[i].yy, std::exp(-4 * at[i].y), 1e-12);
    ASSERT_NEAR(metric[i].zz, 100, 1e-10);
    ASSERT_NEAR(field->size(at[i]), 0.1, 1e-13);
  }
}

std::array<double, 6> vtk_order(const Metric& m) { return {m.xx, m.yy, m.zz, m.xy, m.yz, m.xz}; }

TEST(Background, S6_stretchings_metrics_and_nine_components_agree) {
  const Point first = Point{1, 2, 0} / std::sqrt(5.0), second = Point{-2, 1, 0} / std::sqrt(5.0);
  Mesh mesh = kuhn_box(3, 0.1);
  const auto delta = [](Point p) { return 0.1 * std::exp(p.x); };
  const auto metric_at = [&](Point p) { return stretched_metric(delta(p), {10, 3, first, second}); };
  add_node_field(mesh, "h", delta);
  add_node_field(mesh, "S1", [](Point) { return 10.0; });
  add_node_field(mesh, "S2", [](Point) { return 3.0; });
  add_node_field(mesh, "s1", [&](Point) { return std::array{2 * first.x, 2 * first.y, 0.0}; });
  add_node_field(mesh, "s2", [&](Point) { return std::array{second.x, second.y, 0.0}; });
  add_node_field(mesh, "M6", [&](Point p) { return vtk_order(metric_at(p)); });
  add_node_field(mesh, "M9", [&](Point p) {
    const Metric m = metric_at(p);
    return std::array{m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz};
  });
  Context context;
  BackgroundGrid by_stretching{mesh, "bg", "h", "", "S1", "S2", "s1", "s2"}, six{mesh, "bg", "", "M6", "", "", "", ""},
      nine{mesh, "bg", "", "M9", "", "", "", ""};
  std::vector<Point> at = random_points(500, 0, 1, 21);
  std::vector<Metric> metric(at.size());
  for (const BackgroundGrid* grid : {&by_stretching, &six, &nine}) {
    build_background_size_field(*grid, {}, context)->metrics(at, metric);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Metric want = metric_at(at[i]);
      ASSERT_NEAR(metric[i].xx, want.xx, 1e-10 * want.zz);
      ASSERT_NEAR(metric[i].xy, want.xy, 1e-10 * want.zz);
      ASSERT_NEAR(metric[i].zz, want.zz, 1e-10 * want.zz);
    }
  }
}

TEST(Background, S6_metric_bounds_and_growth_along_edges) {
  std::mt19937 random(22);
  std::uniform_real_distribution<double> power(-2, 0);
  for (Mesh mesh : {kuhn_box(5, 0.2), square_grid(7, 0.2)}) {
    const bool is_plane = mesh.dimension == 2;
    add_node_field(mesh, "M", [&](Point p) {
      const double angle = 3 * p.x + p.y;
      const Point first{std::cos(angle), std::sin(angle), 0}, second{-std::sin(angle), std::cos(angle), 0};
      const auto weight = [&] { return std::pow(10, -2 * power(random)); };
      const double a = weight(), b = weight(), c = is_plane ? std::max(a, b) : weight();
      return vtk_order(metric_from_axes({{a, b, c}, {first, second, Point{0, 0, 1}}}));
    });
    const auto free = build(mesh), limited = build(mesh, {.growth = 1.3});
    expect_lower_bounds(*free, 23, is_plane);
    expect_lower_bounds(*limited, 24, is_plane);
    const CellBlock& cells = mesh.blocks[0];
    std::vector<Metric> metric(mesh.points.size()), before(mesh.points.size());
    const std::vector<Point> nodes(mesh.points.begin(), mesh.points.end());
    limited->metrics(nodes, metric);
    free->metrics(nodes, before);
    const double k = 0.3 / 1.3;
    for (std::size_t cell = 0; cell < cells.size(); ++cell)
      for (VertexId a : cells[cell])
        for (VertexId b : cells[cell]) {
          if (a == b) continue;
          const double l = distance(mesh.points[a], mesh.points[b]);
          // The least size that a allows at b, over all directions, is no less than b has in that direction.
          const MetricAxes axes = metric_axes(metric[a.index()]);
          for (int i = 0; i < (is_plane ? 2 : 3); ++i) {
            const Point d = axes.direction[std::size_t(i)];
            const double h = 1 / length_in(metric[b.index()], d);
            if (is_plane && std::abs(d.z) > 0.5) continue;
            ASSERT_LE(h, (1 / std::sqrt(axes.value[std::size_t(i)]) + k * l) * (1 + 1e-5));
          }
        }
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (const Point d : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0.6, 0.8, 0}})
        ASSERT_GE(length_in(metric[i], d), length_in(before[i], d) * (1 - 1e-9));
  }
}

TEST(Background, S6_factor_and_limits) {
  Mesh mesh = kuhn_box(4);
  add_node_field(mesh, "h", linear);
  const auto field = build(std::move(mesh), {.factor = 2, .hmin = 0.65, .hmax = 0.7});
  for (const Point& p : random_points(1000, 0, 1, 25)) {
    ASSERT_GE(field->size(p), 0.65);
    ASSERT_LE(field->size(p), 0.7);
  }
  EXPECT_EQ(field->largest(), 0.7);
}

TEST(Background, S6_bad_input_is_refused_with_place_and_names) {
  Mesh mesh = kuhn_box(2);
  add_node_field(mesh, "size", linear);
  add_node_field(mesh, "M", [](Point) { return std::array{1.0, 1.0, -1.0, 0.0, 0.0, 0.0}; });
  BackgroundGrid grid;
  grid.mesh = mesh;
  grid.name = "bg.vtu";
  expect_mentions(message_of_building<UsageError>(grid), {"bg.vtu", "'size' (1)", "'M' (6)"});
  grid.size = "sise";
  expect_mentions(message_of_building<UsageError>(grid), {"bg.vtu", "'sise'", "did you mean 'size'", "'M' (6)"});
  grid.size = "M";
  expect_mentions(message_of_building<InputError>(grid), {"'M' has 6 components", "takes 1"});
  grid.size = "size";
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    BackgroundGrid broken = grid;
    broken.mesh.fields[0].values[5] = bad;
    expect_mentions(message_of_building<InputError>(broken), {"bg.vtu", "node 5 at (1, 0.5, 0)", "'size'", "positive"});
  }
  grid.metric = "M";
  expect_mentions(message_of_building<InputError>(grid), {"node 0", "'M'", "positive definite"});
  grid.metric = "size";
  expect_mentions(message_of_building<InputError>(grid), {"has 1 components", "6 or 9"});
  grid.metric = "";
  grid.s1 = "size";
  expect_mentions(message_of_building<UsageError>(grid), {"direction1"});
  grid.s1 = "";
  grid.mesh.fields.push_back({"p", Field::On::cells, CellType::tetrahedron, 1, std::vector<double>(48, 1.0)});
  grid.size = "p";
  expect_mentions(message_of_building<UsageError>(grid), {"'p'", "on cells"});
  grid.size = "size";
  expect_mentions(message_of_building<UsageError>(grid, {.factor = 0}), {"factor is 0"});
  expect_mentions(message_of_building<UsageError>(grid, {.hmin = 2, .hmax = 1}), {"hmin = 2"});
  expect_mentions(message_of_building<UsageError>(grid, {.growth = 1}), {"growth is 1"});
  BackgroundGrid surface;
  surface.mesh = cube_surface();
  surface.name = "cube.stl";
  expect_mentions(message_of_building<InputError>(surface), {"cube.stl", "12 faces", "no volume cells"});
}

TEST(Background, S6_a_grid_elsewhere_is_refused_and_nan_places_too) {
  Mesh mesh = kuhn_box(2);
  add_node_field(mesh, "h", linear);
  const auto field = build(std::move(mesh));
  EXPECT_NO_THROW(field->require_overlap({{0.5, 0.5, 0.5}, {9, 9, 9}}));
  EXPECT_THROW(field->require_overlap({{2, 2, 2}, {9, 9, 9}}), InputError);
  EXPECT_THROW(field->size({std::nan(""), 0, 0}), InputError);
}

TEST(Background, S6_overlapping_cells_still_give_one_answer) {
  Mesh mesh = kuhn_box(3), other = kuhn_box(2, 0, 1);
  CellBlock& block = mesh.block(CellType::tetrahedron);
  const std::size_t shift = mesh.points.size();
  for (Point p : other.points) mesh.points.push_back(p + Point{0.3, 0.2, 0.1});
  for (VertexId v : other.blocks[0].vertices) block.vertices.push_back(VertexId(v.index() + shift));
  block.group.resize(block.vertices.size() / 4);
  std::size_t node = 0;
  add_node_field(mesh, "h", [&](Point) { return node++ < shift ? 0.1 : 0.2; });
  const auto field = build(std::move(mesh));
  const std::vector<Point> points = random_points(3000, -0.1, 1.4, 26);
  std::vector<double> batch(points.size());
  field->sizes(points, batch);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(batch[i], field->size(points[i]));
}

}  // namespace
}  // namespace delfront
