// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "delfront/errors.hpp"
#include "delfront/size_sources.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

constexpr std::uint64_t kSeed = 20261124;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Random {
  explicit Random(std::uint64_t seed = kSeed) : engine(seed) {}
  std::mt19937_64 engine;
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  Point point(double size) {
    const double x = between(-size, size), y = between(-size, size);
    return {x, y, between(-size, size)};
  }
};

enum class Kinds { simplices, all };

SourceShape random_shape(Random& random, int kind, double size) {
  const Point a = random.point(1), b = a + random.point(size), c = a + random.point(size);
  if (kind == 3)
    return AlignedBox{{{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
                       {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}}};
  if (kind == 4) return SolidSphere{a, size * random.between(0, 1)};
  if (kind == 5) return Frustum{a, b, size * random.between(0, 1), size * random.between(0, 1)};
  return Simplex{{a, b, c}, kind + 1};
}

std::vector<SizeSource> random_sources(int n, Kinds kinds, Random& random) {
  std::vector<SizeSource> sources;
  for (int i = 0; i < n; ++i) {
    SizeLaw law;
    law.kind = static_cast<SizeLaw::Kind>(kinds == Kinds::all ? i % 4 : 1 + i % 3);
    law.delta0 = 0.001 * std::pow(100, random.between(0, 1));
    law.r0 = i % 2 ? 0 : random.between(0, 0.1);
    law.r1 = 0.05 * std::pow(20, random.between(0, 1));
    law.gamma = random.between(0.5, 2);
    law.polynomial = {random.between(0, 1), random.between(0, 1)};
    sources.push_back({random_shape(random, i / 4 % (kinds == Kinds::all ? 6 : 3), 0.2), law, {}, {}, "g"});
  }
  return sources;
}

Point random_place(Random& random) { return std::pow(10, random.between(-3, 1.5)) * random.point(1); }

std::unique_ptr<SizeField> build(const std::vector<SizeSource>& sources, double growth = kInfinity,
                                 SourceSearch search = SourceSearch::tree) {
  Context context;
  SourceFieldOptions options;
  options.growth = growth;
  options.search = search;
  return build_source_size_field(sources, options, context);
}

TEST(SourceSizeField, S5_equals_the_minimum_over_all_sources_to_the_bit) {
  Random random;
  for (const Kinds kinds : {Kinds::simplices, Kinds::all})
    for (const int n : {1, 2, 7, 8, 9, 33, 300, 2000}) {
      const std::vector<SizeSource> sources = random_sources(n, kinds, random);
      const auto field = build(sources);
      std::vector<Point> at;
      for (int i = 0; i < 300; ++i) at.push_back(random_place(random));
      std::vector<double> size(at.size());
      field->sizes(at, size);
      for (std::size_t i = 0; i < at.size(); ++i) {
        double best = kInfinity;
        for (const SizeSource& source : sources)
          best = std::min(best, source.law.size_at(distance_to(source.shape, at[i])));
        ASSERT_EQ(size[i], best) << "seed " << kSeed << " n " << n << " place " << i;
      }
    }
}

TEST(SourceSizeField, S5_search_and_order_change_no_bit) {
  Random random;
  const std::vector<SizeSource> sources = random_sources(3000, Kinds::all, random);
  for (const double growth : {kInfinity, 1.2}) {
    const auto tree = build(sources, growth), scan = build(sources, growth, SourceSearch::scan);
    std::vector<Point> at;
    for (int i = 0; i < 1000; ++i) at.push_back(random_place(random));
    std::vector<double> size(at.size()), again(at.size());
    tree->sizes(at, size);
    scan->sizes(at, again);
    EXPECT_EQ(size, again);
    std::vector<Point> reversed(at.rbegin(), at.rend());
    tree->sizes(reversed, again);
    std::reverse(again.begin(), again.end());
    EXPECT_EQ(size, again);
    for (std::size_t i = 0; i < at.size(); ++i) ASSERT_EQ(tree->size(at[i]), size[i]);
  }
}

/// Sources of one size on a ball: many are nearly as near as the nearest, and lists stay long.
std::vector<SizeSource> body_sources(int n, Random& random) {
  std::vector<SizeSource> sources;
  for (int i = 0; i < n; ++i) {
    const Point p = random.point(1), at = (0.3 / std::max(1e-3, length(p))) * p;
    SizeLaw law;
    law.kind = SizeLaw::Kind::step;
    law.delta0 = 0.01;
    const Point u = cross(at, random.point(0.1)), v = cross(at, u);
    sources.push_back({Simplex{{at, at + u, at + v}, 3}, law, {}, {}, ""});
  }
  return sources;
}

TEST(SourceSizeField, S5_lists_tree_and_scan_give_the_same_bits) {
  Random random;
  for (const int n : {1, 9, 100, 3000})
    for (const bool is_body : {false, true})
      for (const bool has_domain : {false, true}) {
        const double growth = is_body || n == 100 ? 1.2 : kInfinity;
        const auto sources = is_body ? body_sources(n, random) : random_sources(n, Kinds::all, random);
        std::vector<Point> at;
        for (int i = 0; i < 2000; ++i) at.push_back(i % 4 == 0 ? random_place(random) : random.point(1.2));
        for (const int i : {1, 2, 3}) at.push_back(random.point(0) + Point{0.5 * i, 0.25 * i, 0});  // on sides of cells
        Context context;
        SourceFieldOptions options;
        options.growth = growth;
        options.search = SourceSearch::lists;
        if (has_domain) options.domain = {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
        const auto lists = build_source_size_field(sources, options, context);
        std::vector<double> by_lists(at.size()), by_tree(at.size()), by_scan(at.size());
        lists->sizes(at, by_lists);
        build(sources, growth)->sizes(at, by_tree);
        build(sources, growth, SourceSearch::scan)->sizes(at, by_scan);
        EXPECT_EQ(by_lists, by_scan) << "seed " << kSeed << " n " << n << " body " << is_body;
        EXPECT_EQ(by_tree, by_scan) << "seed " << kSeed << " n " << n << " body " << is_body;
      }
}

TEST(SourceSizeField, S5_flat_and_long_sources_far_from_the_origin) {
  Random random;
  for (const double far : {0.0, 1e3, 1e6}) {
    std::vector<SizeSource> sources = body_sources(2000, random);
    for (SizeSource& source : sources)
      for (Point& corner : std::get<Simplex>(source.shape).corner) corner = corner + far * Point{1, -0.5, 0.25};
    const auto tree = build(sources, 1.2), scan = build(sources, 1.2, SourceSearch::scan);
    std::vector<Point> at;
    for (int i = 0; i < 2000; ++i) at.push_back(far * Point{1, -0.5, 0.25} + random_place(random));
    std::vector<double> size(at.size()), again(at.size());
    tree->sizes(at, size);
    scan->sizes(at, again);
    EXPECT_EQ(size, again) << "seed " << kSeed << " far " << far;
  }
}

TEST(SourceSizeField, S5_runs_of_near_places_change_no_bit) {
  Random random;
  for (const int n : {3, 40, 4000})
    for (const double growth : {kInfinity, 1.2}) {
      const std::vector<SizeSource> sources = random_sources(n, Kinds::all, random);
      const auto tree = build(sources, growth), scan = build(sources, growth, SourceSearch::scan);
      for (const double step : {1e-9, 1e-3, 0.03, 1.0}) {
        std::vector<Point> at = {random.point(1)};
        while (at.size() < 400) at.push_back(at.back() + step * random.point(1));
        std::vector<double> size(at.size()), again(at.size());
        tree->sizes(at, size);
        scan->sizes(at, again);
        ASSERT_EQ(size, again) << "seed " << kSeed << " n " << n << " step " << step;
      }
    }
}

TEST(SourceSizeField, S5_clusters_of_many_scales_and_equal_sources) {
  Random random;
  std::vector<SizeSource> sources = random_sources(500, Kinds::simplices, random);
  for (SizeSource& source : sources) {
    const double scale = std::pow(10, random.between(-9, 2));
    for (Point& p : std::get<Simplex>(source.shape).corner) p = scale * p;
    source.law.delta0 *= scale;
    source.law.r1 *= scale;
    source.law.r0 *= scale;
  }
  for (int i = 0; i < 100; ++i) sources.push_back(sources[static_cast<std::size_t>(i % 3)]);
  const auto tree = build(sources), scan = build(sources, kInfinity, SourceSearch::scan);
  for (int i = 0; i < 2000; ++i) {
    const Point p = std::pow(10, random.between(-10, 8)) * random.point(1);
    ASSERT_EQ(tree->size(p), scan->size(p)) << "seed " << kSeed << " place " << i;
  }
  EXPECT_EQ(tree->size({1e200, 0, 0}), scan->size({1e200, 0, 0}));
}

TEST(SourceSizeField, S5_small_bodies_far_from_the_origin) {
  Random random;
  std::vector<SizeSource> sources;
  for (int i = 0; i < 300; ++i) {
    SizeLaw law;
    law.delta0 = 1e-5 * random.between(1, 2);
    law.r1 = 1e-3;
    sources.push_back({SolidSphere{Point{1e9, -1e9, 1e9} + 1e-3 * random.point(1), 1e-4}, law, {}, {}, ""});
  }
  const auto tree = build(sources), scan = build(sources, kInfinity, SourceSearch::scan);
  for (int i = 0; i < 1000; ++i) {
    const Point p = Point{1e9, -1e9, 1e9} + 3e-3 * random.point(1);
    ASSERT_EQ(tree->size(p), scan->size(p)) << "seed " << kSeed << " place " << i;
  }
}

TEST(SourceSizeField, S5_lower_bounds_are_never_violated) {
  Random random;
  for (const double growth : {kInfinity, 1.3}) {
    const std::vector<SizeSource> sources = random_sources(200, Kinds::all, random);
    const auto field = build(sources, growth);
    std::vector<Box> boxes;
    for (int i = 0; i < 1000; ++i) {
      const Point centre = random_place(random);
      const Point half = std::pow(10, random.between(-6, 0.5)) * Point{1, random.between(0, 1), random.between(0, 1)};
      boxes.push_back({centre - half, centre + half});
    }
    std::vector<Point> at(500);
    std::vector<double> size(at.size());
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      const double bound = field->lower_bound(boxes[b]);
      ASSERT_GT(bound, 0);
      for (Point& p : at) {
        for (int k = 0; k < 3; ++k)
          p[k] = boxes[b].low[k] + random.between(0, 1) * (boxes[b].high[k] - boxes[b].low[k]);
      }
      field->sizes(at, size);
      for (std::size_t i = 0; i < at.size(); ++i) ASSERT_GE(size[i], bound) << "seed " << kSeed << " box " << b;
      // Tight for a place.
      EXPECT_GE(field->lower_bound({at[0], at[0]}), size[0] * (1 - 1e-9)) << "box " << b;
    }
  }
}

TEST(SourceSizeField, S4_growth_is_never_exceeded_and_never_raises_a_size) {
  Random random;
  const std::vector<SizeSource> sources = random_sources(300, Kinds::all, random);
  const auto free = build(sources);
  for (const double growth : {1.05, 1.2, 2.0}) {
    const auto field = build(sources, growth);
    const double slope = (growth - 1) / growth;
    for (int i = 0; i < 4000; ++i) {
      const Point p = random.point(2), q = p + std::pow(10, random.between(-8, 0)) * random.point(1);
      const double at_p = field->size(p), at_q = field->size(q);
      EXPECT_LE(at_p, free->size(p));
      EXPECT_LE(std::abs(at_p - at_q), slope * distance(p, q) + 1e-13) << "seed " << kSeed;
    }
  }
}

TEST(SourceSizeField, S4_growth_limited_field_equals_the_largest_one_along_lines) {
  // One steep source: from everywhere the limited field is what lines of the slope allow.
  SizeLaw law;
  law.delta0 = 0.01;
  law.r1 = 0.1;
  law.gamma = 2;
  const auto field = build({{Simplex{{Point{}}, 1}, law, {}, {}, ""}}, 1.25);
  for (double d = 0; d < 3; d += 0.01) {
    double best = kInfinity;
    for (int i = 0; i <= 10000; ++i) best = std::min(best, law.size_at(d * i / 10000) + 0.2 * d * (1 - i / 10000.0));
    EXPECT_NEAR(field->size({0, d, 0}), best, 1e-7);
  }
}

TEST(SourceSizeField, S3_the_smallest_of_all_boxes_wins) {
  auto box = [](double low, double high, double h) {
    SizeLaw law;
    law.kind = SizeLaw::Kind::step;
    law.delta0 = h;
    return SizeSource{AlignedBox{{{low, low, low}, {high, high, high}}}, law, {}, {}, ""};
  };
  const auto field = build({box(0, 4, 0.5), box(1, 2, 0.1), box(1.5, 3, 0.2)});
  EXPECT_EQ(field->size({0.5, 0.5, 0.5}), 0.5);
  EXPECT_EQ(field->size({1.7, 1.7, 1.7}), 0.1);
  EXPECT_EQ(field->size({2.7, 2.7, 2.7}), 0.2);
  EXPECT_EQ(field->size({4.1, 0, 0}), kInfinity);
  EXPECT_EQ(field->lower_bound({{5, 5, 5}, {6, 6, 6}}), kInfinity);
  EXPECT_EQ(field->largest(), kInfinity);
  const auto grown = build({box(0, 4, 0.5), box(1, 2, 0.1), box(1.5, 3, 0.2)}, 1.25);
  EXPECT_DOUBLE_EQ(grown->size({5, 2, 2}), 0.2 + 0.2 * 2);
}

TEST(SourceSizeField, S4_constant_laws_have_a_largest_size) {
  SizeLaw law;
  law.kind = SizeLaw::Kind::polynomial;
  law.delta0 = 0.25;
  EXPECT_EQ(build({{Simplex{}, law, {}, {}, ""}})->largest(), 0.25);
}

TEST(SourceSizeField, S4_turned_and_scaled_sources_give_turned_and_scaled_sizes) {
  Random random;
  const std::vector<SizeSource> sources = random_sources(400, Kinds::simplices, random);
  const auto field = build(sources, 1.3);
  const Motion turn{{}, {}, {1, 2, -0.5}, 33};
  for (const double scale : {1.0, 1e-6, 1e6, 0x1p-20, 0x1p20}) {
    const bool is_exact = scale != 1 && std::exp2(std::round(std::log2(scale))) == scale;
    std::vector<SizeSource> others = sources;
    for (SizeSource& source : others) {
      for (Point& p : std::get<Simplex>(source.shape).corner) p = scale * (is_exact ? p : turn.at(1, p));
      source.law.delta0 *= scale;
      source.law.r0 *= scale;
      source.law.r1 *= scale;
    }
    const auto other = build(others, 1.3);
    for (int i = 0; i < 300; ++i) {
      const Point p = random.point(2);
      const double size = other->size(scale * (is_exact ? p : turn.at(1, p))) / scale;
      if (is_exact) {
        EXPECT_EQ(size, field->size(p));
      } else {
        EXPECT_NEAR(size, field->size(p), 1e-12);
      }
    }
  }
}

TEST(SourceSizeField, S4_sources_move_with_time) {
  Random random;
  std::vector<SizeSource> sources = random_sources(60, Kinds::all, random), moved = sources;
  const Motion motion{{1, 0.5, 0}, {0.2, 0, 0}, {0, 1, 1}, 40};
  for (SizeSource& source : moved) source.motion = motion;
  Context context;
  SourceFieldOptions options;
  options.time = 2.5;
  const auto still = build(sources);
  const auto field = build_source_size_field(moved, options, context);
  for (int i = 0; i < 500; ++i) {
    const Point p = random.point(2);
    const double size = still->size(p), other = field->size(motion.at(2.5, p));
    // Steps may fall to either side of a border.
    if (std::abs(other - size) < 1e-11 * size) continue;
    bool is_at_step = false;
    for (const SizeSource& source : sources)
      is_at_step |=
          source.law.kind == SizeLaw::Kind::step && std::abs(distance_to(source.shape, p) - source.law.r0) < 1e-12;
    EXPECT_TRUE(is_at_step) << "seed " << kSeed << " place " << i;
  }
}

std::vector<SizeSource> stretched_sources(int n, Random& random) {
  std::vector<SizeSource> sources = random_sources(n, Kinds::simplices, random);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (i % 4 == 0) continue;
    const Motion turn{{}, {}, random.point(1), random.between(0, 360)};
    sources[i].stretching = Stretching{random.between(0.2, 5), random.between(0.2, 5), turn.turned(1, {1, 0, 0}),
                                       turn.turned(1, {0, 1, 0})};
    if (i % 4 == 1) sources[i].stretching->s1 = sources[i].stretching->s2 = 1;
    sources[i].law.delta0 = 0.01 * random.between(1, 2);
  }
  return sources;
}

TEST(SourceSizeField, S4_one_stretched_source_gives_its_metric) {
  Random random;
  std::vector<SizeSource> sources = stretched_sources(3, random);
  sources = {sources[1]};
  const auto field = build(sources);
  EXPECT_FALSE(field->is_isotropic());
  for (int i = 0; i < 100; ++i) {
    const Point p = random.point(2);
    Metric metric;
    field->metrics({&p, 1}, {&metric, 1});
    const double delta = sources[0].law.size_at(distance_to(sources[0].shape, p));
    const Metric expected = stretched_metric(delta, *sources[0].stretching);
    const Point e = random.point(1);
    EXPECT_NEAR(length_in(metric, e) / length_in(expected, e), 1, 1e-9);
    const double least = delta * std::min({1.0, sources[0].stretching->s1, sources[0].stretching->s2});
    EXPECT_NEAR(field->size(p) / least, 1, 1e-9);
  }
}

TEST(SourceSizeField, S4_metrics_respect_every_source_and_skip_only_what_cannot_matter) {
  Random random;
  const std::vector<SizeSource> sources = stretched_sources(40, random);
  const auto field = build(sources);
  for (int i = 0; i < 200; ++i) {
    const Point p = random.point(1.5);
    Metric metric, all{0, 0, 0, 0, 0, 0};
    field->metrics({&p, 1}, {&metric, 1});
    double plain = kInfinity;
    for (const SizeSource& source : sources)
      if (!source.stretching) plain = std::min(plain, source.law.size_at(distance_to(source.shape, p)));
    all = isotropic_metric(plain);
    for (const SizeSource& source : sources) {
      if (!source.stretching) continue;
      all = intersection(all, stretched_metric(source.law.size_at(distance_to(source.shape, p)), *source.stretching));
    }
    for (int k = 0; k < 20; ++k) {
      const Point e = random.point(1);
      EXPECT_GE(length_in(metric, e), length_in(isotropic_metric(plain), e) * (1 - 1e-9));
      EXPECT_NEAR(length_in(metric, e) / length_in(all, e), 1, 1e-6) << "seed " << kSeed << " place " << i;
      for (const SizeSource& source : sources) {
        if (!source.stretching) continue;
        const Metric one = stretched_metric(source.law.size_at(distance_to(source.shape, p)), *source.stretching);
        ASSERT_GE(length_in(metric, e), length_in(one, e) * (1 - 1e-7));
      }
    }
    EXPECT_DOUBLE_EQ(field->size(p), least_size(metric));
  }
}

TEST(SourceSizeField, S4_lower_bounds_hold_with_stretchings) {
  Random random;
  const auto field = build(stretched_sources(40, random));
  EXPECT_GT(field->lower_bound(Box{}), 0);
  EXPECT_LE(field->lower_bound(Box{}), 0.02);
  for (int b = 0; b < 200; ++b) {
    const Point centre = random.point(1.5);
    const Point half = std::pow(10, random.between(-4, 0)) * Point{1, 1, 1};
    const double bound = field->lower_bound({centre - half, centre + half});
    ASSERT_GT(bound, 0);
    for (int i = 0; i < 20; ++i) {
      const Point p = centre + half.x * random.point(1);
      ASSERT_GE(field->size(p), bound) << "seed " << kSeed << " box " << b;
    }
  }
}

TEST(SourceSizeField, S4_groups_are_selected_by_pattern) {
  std::vector<SizeSource> sources(4);
  sources[0].group = "wing_left";
  sources[1].group = "wing_right";
  sources[2].group = "tail";
  EXPECT_EQ(select_sources(sources, "wing*").size(), 2u);
  EXPECT_EQ(select_sources(sources, "*").size(), 4u);
  EXPECT_EQ(select_sources(sources, "t?il").size(), 1u);
  EXPECT_EQ(select_sources(sources, "").size(), 1u);
  EXPECT_EQ(select_sources(sources, "*_*t").size(), 2u);
}

TEST(SourceSizeField, S4_bad_sources_are_named) {
  auto message = [](std::vector<SizeSource> sources, double growth = 1.2) -> std::string {
    try {
      build(sources, growth);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  std::vector<SizeSource> sources(3);
  EXPECT_EQ(message(sources), "");
  sources[1].group = "wing";
  sources[1].law.delta0 = -2;
  EXPECT_NE(message(sources).find("size source 2 of group \"wing\": delta0 = -2"), std::string::npos);
  EXPECT_NE(message({}).find("there is none"), std::string::npos);
  sources[1].law.delta0 = 1;
  EXPECT_NE(message(sources, 1).find("growth is 1"), std::string::npos);
  sources[2].motion = Motion{{}, {}, {}, 10};
  EXPECT_NE(message(sources).find("size source 3: motion: rate = 10"), std::string::npos);
  sources[2].motion.reset();
  sources[0].stretching = Stretching{0, 1, {1, 0, 0}, {0, 1, 0}};
  EXPECT_NE(message(sources).find("size source 1: stretchings 0 and 1"), std::string::npos);
}

}  // namespace
}  // namespace delfront
