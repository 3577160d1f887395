// SPDX-License-Identifier: Apache-2.0
// Sizes of whole jobs: every part of [size] at once, in one field, through the gridding.
#include "pipeline/job_sizes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using Transform = std::function<Point(Point)>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Model sphere(const Transform& at) {
  Context context;
  Mesh surface = fixtures::sphere_surface(3);
  for (Point& p : surface.points) p = at(p);
  return build_model({{surface, "ball"}}, context);
}

Length length_of(double value) { return {value, ""}; }

/// Sources, boxes, a patch and its curvature; places moved, lengths scaled.
Options many_ways(const Transform& at, double scale) {
  Options options;
  SizeOptions& size = options.size;
  size.hmin = length_of(0.02 * scale);
  size.growth = 1.25;
  size.curvature = 24;
  size.gap.cells = 3;
  size.on = {{"sph*", length_of(0.2 * scale)}};
  SourceOptions line;
  line.type = "polyline";
  line.at = {at({-0.6, 0, 0}), at({0, 0.3, 0.2}), at({0.5, -0.2, 0.1})};
  line.delta0 = length_of(0.05 * scale);
  line.r0 = length_of(0.03 * scale);
  line.r1 = length_of(0.4 * scale);
  line.gamma = 1.5;
  SourceOptions point = line;
  point.type = "point";
  point.at = {at({0.1, 0.1, -0.6})};
  point.law = "exponential";
  size.sources = {line, point};
  SizeBoxOptions ball;
  ball.shape = "sphere";
  ball.centre = at({-0.3, -0.4, 0.3});
  ball.radius = length_of(0.2 * scale);
  ball.h = length_of(0.06 * scale);
  size.boxes = {ball};
  return options;
}

Mesh grid_of(const Transform& at, double scale, int threads = 1) {
  Context context;
  context.threads = threads;
  const Model model = sphere(at);
  const Options options = many_ways(at, scale);
  const auto asked = build_job_size_field(options, model, model.bounding_box(), context);
  return generate(model, options, context, asked).mesh;
}

Point same(Point p) { return p; }

TEST(JobSizes, nothing_asked_for_is_no_field) {
  Context context;
  const Model model = sphere(same);
  EXPECT_EQ(build_job_size_field({}, model, model.bounding_box(), context), nullptr);
}

TEST(JobSizes, any_number_of_threads_gives_the_same_grid) {
  const Mesh one = grid_of(same, 1), two = grid_of(same, 1, 2), three = grid_of(same, 1, 3);
  EXPECT_GT(one.num_cells(CellType::tetrahedron), 20000u);
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.find_block(CellType::tetrahedron)->vertices, two.find_block(CellType::tetrahedron)->vertices);
  EXPECT_EQ(one.points, three.points);
}

TEST(JobSizes, scaling_by_a_power_of_two_keeps_the_connectivity) {
  const Mesh plain = grid_of(same, 1);
  for (const double scale : {0x1p20, 0x1p-20}) {
    const Mesh scaled = grid_of([=](Point p) { return scale * p; }, scale);
    EXPECT_EQ(scaled.find_block(CellType::tetrahedron)->vertices, plain.find_block(CellType::tetrahedron)->vertices);
  }
}

TEST(JobSizes, turning_and_scaling_keep_the_number_of_cells) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto turned = [=](Point p) { return Point{c * p.x - s * p.z, p.y, s * p.x + c * p.z}; };
  const auto plain = static_cast<double>(grid_of(same, 1).num_cells(CellType::tetrahedron));
  const auto count = [](const Mesh& mesh) { return static_cast<double>(mesh.num_cells(CellType::tetrahedron)); };
  EXPECT_NEAR(count(grid_of(turned, 1)), plain, 0.01 * plain);
  for (const double scale : {1e6, 1e-6}) {
    const auto both = [=](Point p) { return scale * turned(p) + scale * Point{3, -2, 1}; };
    EXPECT_NEAR(count(grid_of(both, scale)), plain, 0.01 * plain) << scale;
  }
}

/// All kinds in one field: sources, regions, names, curvature, a formula with steep places.
std::shared_ptr<const SizeField> field_of_all(Box& domain) {
  Context context;
  const Model model = sphere(same);
  Options options = many_ways(same, 1);
  options.size.expression.delta = "0.05 + 0.3*max(0, hypot(x - 0.3, y + 0.5) - 0.1) + (z > 0.8 ? 0 : 0.2)";
  domain = model.bounding_box();
  return build_job_size_field(options, model, domain, context);
}

TEST(JobSizes, lower_bounds_hold_in_a_million_boxes) {
  Box domain;
  const auto field = field_of_all(domain);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> in(-1, 1), log_side(-9, 0), share(0, 1);
  const unsigned num_boxes = fixtures::setting("DELFRONT_RANDOM_BOXES", 1'000'000);
  constexpr unsigned kPoints = 2, kRun = 1000;
  std::vector<Point> at;
  std::vector<double> low, size(kRun * kPoints);
  for (unsigned done = 0; done < num_boxes; done += kRun) {
    at.clear();
    low.clear();
    const Point near{in(random), in(random), in(random)};  // boxes of a run lie together, as queries do
    for (unsigned i = 0; i < kRun; ++i) {
      const Point corner = near + 0.05 * Point{in(random), in(random), in(random)};
      const Point side{std::exp(log_side(random)), std::exp(log_side(random)), std::exp(log_side(random))};
      low.push_back(field->lower_bound({corner, corner + side}));
      for (unsigned k = 0; k < kPoints; ++k)
        at.push_back(corner + Point{share(random) * side.x, share(random) * side.y, share(random) * side.z});
    }
    field->sizes(at, size);
    for (std::size_t i = 0; i < size.size(); ++i)
      ASSERT_LE(low[i / kPoints], size[i]) << "at " << at[i].x << " " << at[i].y << " " << at[i].z;
    ASSERT_GT(*std::min_element(low.begin(), low.end()), 0);
  }
}

TEST(JobSizes, grow_no_faster_than_asked) {
  Box domain;
  const auto field = field_of_all(domain);
  std::mt19937 random(12);
  std::uniform_real_distribution<double> in(-0.95, 0.95), near(-0.05, 0.05);
  constexpr std::size_t kPairs = 200'000;
  std::vector<Point> at;
  for (std::size_t i = 0; i < kPairs; ++i) {
    at.push_back({in(random), in(random), in(random)});
    at.push_back(at.back() + Point{near(random), near(random), near(random)});
  }
  std::vector<double> size(at.size());
  field->sizes(at, size);
  const double growth = 1.25, k = (growth - 1) / growth;
  for (std::size_t i = 0; i < at.size(); i += 2) {
    const double away = distance(at[i], at[i + 1]);
    const auto [low, high] = std::minmax(size[i], size[i + 1]);
    ASSERT_LE(high - low, k * away * (1 + 1e-12) + 1e-15) << at[i].x << " " << at[i].y << " " << at[i].z;
    if (away <= high) {
      ASSERT_LE(high / low, growth * (1 + 1e-12));
    }
  }
}

TEST(JobSizes, lowering_gives_the_lesser_bit_for_bit) {
  Box domain;
  const auto field = field_of_all(domain);
  std::mt19937 random(14);
  std::uniform_real_distribution<double> in(-1, 1), given(0, 0.3);
  for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{3000}}) {
    std::vector<Point> at;
    std::vector<double> size(count), lowered;
    const double spread = count > 100 ? 0.2 : 1;
    for (std::size_t i = 0; i < count; ++i) {
      at.push_back(spread * Point{in(random), in(random), in(random)});
      lowered.push_back(i % 11 == 0 ? kInfinity : given(random));
    }
    const std::vector<double> before = lowered;
    field->sizes(at, size);
    field->lower_sizes(at, lowered);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(lowered[i], std::min(before[i], size[i])) << i;
  }
}

TEST(JobSizes, sizes_that_ask_for_far_too_many_cells_end_before_the_work) {
  Context context;
  Options options;
  options.size.hmax = length_of(1e-6);
  try {
    generate(sphere(same), options, context);
    FAIL();
  } catch (const LimitError& e) {
    EXPECT_NE(std::string(e.what()).find("before gridding"), std::string::npos) << e.what();
  }
  EXPECT_LT(peak_resident_memory(), std::uint64_t{2'000'000'000});
  context.max_cells = 200'000;  // what the sizes ask for is below: no refusal
  options.size.hmax = length_of(0.1);
  EXPECT_GT(generate(sphere(same), options, context).report.quality.num_cells, 20'000u);
}

TEST(JobSizes, the_least_of_all_counts) {
  Context context;
  const Model model = sphere(same);
  Options options = many_ways(same, 1);
  const auto all = build_job_size_field(options, model, model.bounding_box(), context);
  std::vector<std::shared_ptr<const SizeField>> alone;
  for (int part = 0; part < 3; ++part) {
    Options one = options;
    if (part != 0) one.size.sources.clear();
    if (part != 1) one.size.boxes.clear();
    if (part != 2) one.size.on.clear();
    one.size.curvature = one.size.gap.cells = 0;
    alone.push_back(build_job_size_field(one, model, model.bounding_box(), context));
  }
  std::mt19937 random(13);
  std::uniform_real_distribution<double> in(-1, 1);
  for (int i = 0; i < 10'000; ++i) {
    const Point p{in(random), in(random), in(random)};
    double least = kInfinity;
    for (const auto& field : alone) least = std::min(least, field->size(p));
    ASSERT_LE(all->size(p), least);
  }
}

}  // namespace
}  // namespace delfront
