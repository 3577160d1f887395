// SPDX-License-Identifier: Apache-2.0
// Size sources (S5): time of one evaluation for growing numbers of sources, by scanning all and by the tree.
//
//   size_field_bench [--sources 10,100,...] [--layout scattered,curves,surfaces,body] [--points N] [--repeat N]
//                    [--methods scan,tree,lists,boundary]
//   size_field_bench --given SOURCES PLACES OUT     sources and places from files, as compare_sizes.py gives them
//
// Points lie in the unit cube in Hilbert order; sources are points, segments and triangles of all three laws, scattered
// in the cube, along curves, or on surfaces. Layout body: the triangles of a sphere, all of one size that grows with
// the distance, as sizes on a patch are; method boundary, for this layout, gives their corners to the field of sizes
// from the boundary instead. One line a case: layout, sources, method, build seconds, million evaluations a second
// (median; of this process's own time on one core), megabytes that the field took, million lower bounds over small
// boxes a second, and the sum of all sizes, which must not depend on the method.
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/hilbert.hpp"
#include "delfront/size_field.hpp"
#include "delfront/size_sources.hpp"

namespace {

using delfront::Point;
using delfront::SizeSource;

struct Random {
  std::mt19937_64 engine{7};
  double unit() { return static_cast<double>(engine() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  double log_between(double low, double high) { return low * std::pow(high / low, unit()); }
  Point in_cube() {
    const double x = unit(), y = unit();
    return {x, y, unit()};
  }
};

delfront::SizeLaw make_law(Random& random, std::size_t i, double delta0, double r1) {
  delfront::SizeLaw law;
  law.delta0 = delta0;
  law.r1 = r1;
  law.r0 = i % 2 ? 0 : random.between(0, 0.02);
  const std::size_t kind = i % 3;
  law.kind = kind == 0   ? delfront::SizeLaw::Kind::power
             : kind == 1 ? delfront::SizeLaw::Kind::exponential
                         : delfront::SizeLaw::Kind::polynomial;
  law.gamma = random.between(1, 2);
  law.polynomial = {random.between(0.5, 1.5), random.between(0, 1)};
  return law;
}

/// A point on curve or surface number `which`, by parameters in [0, 1].
Point on_curve(std::size_t which, double t) {
  const double phase = static_cast<double>(which) * 2.399963, turn = 2 * std::numbers::pi * t;
  const double radius = 0.1 + 0.03 * static_cast<double>(which % 10);
  return {0.5 + radius * std::cos(turn + phase), 0.5 + radius * std::sin(turn + phase),
          0.1 + 0.08 * static_cast<double>(which % 10) + 0.05 * std::sin(3 * turn)};
}
Point on_surface(std::size_t which, double u, double v) {
  const double z = 2 * v - 1, turn = 2 * std::numbers::pi * u, r = std::sqrt(1 - z * z);
  const double radius = which % 2 ? 0.3 : 0.15;
  const Point centre = which % 2 ? Point{0.4, 0.45, 0.5} : Point{0.8, 0.8, 0.8};
  return centre + radius * Point{r * std::cos(turn), r * std::sin(turn), z};
}

std::vector<SizeSource> make_sources(const std::string& layout, std::size_t n) {
  Random random;
  std::vector<SizeSource> sources;
  const double spacing = 1 / std::sqrt(static_cast<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    delfront::Simplex simplex;
    simplex.num_corners = 1 + static_cast<int>(i / 3 % 3);
    double delta0 = random.log_between(0.001, 0.1), r1 = random.log_between(0.05, 1);
    if (layout == "scattered") {
      simplex.corner[0] = random.in_cube();
      for (std::size_t k = 1; k < 3; ++k)
        simplex.corner[k] = simplex.corner[0] + 0.05 * (random.in_cube() - Point{0.5, 0.5, 0.5});
    } else if (layout == "curves") {
      const std::size_t curve = i % 10;
      const double t = static_cast<double>(i / 10) * 10 / static_cast<double>(n), dt = 10 / static_cast<double>(n);
      simplex.corner = {on_curve(curve, t), on_curve(curve, t + dt), on_curve(curve, t + 0.5 * dt) + Point{0, 0, 0.01}};
      delta0 = 0.002 * (1 + 0.5 * std::sin(20 * t)) * (1 + 0.2 * static_cast<double>(curve));
      r1 = 0.05 + 0.05 * static_cast<double>(curve % 3);
    } else {
      const double u = random.unit(), v = random.unit();
      simplex.corner = {on_surface(i, u, v), on_surface(i, u + 0.5 * spacing, v),
                        on_surface(i, u, std::min(1.0, v + 0.5 * spacing))};
      delta0 = 0.005 * (1.5 + std::sin(9 * u)) * random.between(0.9, 1.1);
      r1 = 0.1;
    }
    sources.push_back({simplex, make_law(random, i, delta0, r1), {}, {}, ""});
  }
  return sources;
}

std::vector<Point> make_points(std::size_t n) {
  Random random;
  std::vector<Point> points, ordered;
  for (std::size_t i = 0; i < n; ++i) points.push_back(random.in_cube());
  for (const std::uint32_t i : delfront::hilbert_order(points)) ordered.push_back(points[i]);
  return ordered;
}

double megabytes_in_use() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) * 1e-6;
}

double seconds_of(const auto& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

constexpr double kBodyGrowth = 1.25;

/// Triangles of a sphere, about n: each side of an octahedron in m^2, blown up.
std::vector<delfront::Simplex> make_body(std::size_t n) {
  const auto m = static_cast<int>(std::max(1.0, std::sqrt(static_cast<double>(n) / 8) + 0.5));
  std::vector<delfront::Simplex> body;
  for (int side = 0; side < 8; ++side) {
    const auto at = [&](int i, int j) {
      const Point p = {double(side & 1 ? -i : i), double(side & 2 ? -j : j), double(side & 4 ? i + j - m : m - i - j)};
      return Point{0.45, 0.5, 0.55} + (0.3 / length(p)) * p;
    };
    for (int i = 0; i < m; ++i)
      for (int j = 0; i + j < m; ++j) {
        body.push_back({{at(i, j), at(i + 1, j), at(i, j + 1)}, 3});
        if (i + j + 1 < m) body.push_back({{at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, 3});
      }
  }
  return body;
}

std::unique_ptr<delfront::SizeField> build_body(std::size_t n, const std::string& method,
                                                const delfront::SourceFieldOptions& options) {
  delfront::Context context;
  const double h = 1 / std::sqrt(static_cast<double>(n));
  if (method == "boundary") {
    delfront::BoundarySizes boundary;
    boundary.growth = kBodyGrowth;
    for (const delfront::Simplex& triangle : make_body(2 * n)) boundary.points.push_back(triangle.corner[0]);
    boundary.size.assign(boundary.points.size(), h);
    return build_boundary_size_field(boundary, context);
  }
  std::vector<SizeSource> sources;
  delfront::SizeLaw law;
  law.kind = delfront::SizeLaw::Kind::step;
  law.delta0 = h;
  for (const delfront::Simplex& triangle : make_body(n)) sources.push_back({triangle, law, {}, {}, ""});
  return build_source_size_field(std::move(sources), options, context);
}

std::unique_ptr<delfront::SizeField> build_field(const std::string& layout, std::size_t n, const std::string& method) {
  delfront::SourceFieldOptions options;
  options.search = method == "scan"    ? delfront::SourceSearch::scan
                   : method == "tree"  ? delfront::SourceSearch::tree
                   : method == "lists" ? delfront::SourceSearch::lists
                                       : delfront::SourceSearch::automatic;
  if (layout == "body") {
    options.growth = kBodyGrowth;
    return build_body(n, method, options);
  }
  delfront::Context context;
  return build_source_size_field(make_sources(layout, n), options, context);
}

/// Boxes as the gridding of a core asks for: one in eight a hundredth wide, the others smaller.
double bounds_a_second(const delfront::SizeField& field, const std::vector<Point>& at) {
  const std::size_t step = std::max<std::size_t>(1, at.size() / 20'000);
  double sum = 0;
  std::size_t count = 0;
  const double seconds = seconds_of([&] {
    for (std::size_t i = 0; i < at.size(); i += step, ++count) {
      const double half = count % 8 == 0 ? 0.005 : 0.001;
      const Point side{half, half, half};
      sum += field.lower_bound({at[i] - side, at[i] + side});
    }
  });
  return sum > 0 ? static_cast<double>(count) / seconds : 0;
}

void run_case(const std::string& layout, std::size_t n, const std::string& method, std::size_t num_points, int repeat) {
  const bool is_scan = method == "scan";
  const double before = megabytes_in_use();
  std::unique_ptr<delfront::SizeField> field;
  const double build = seconds_of([&] { field = build_field(layout, n, method); });
  const double megabytes = megabytes_in_use() - before;
  // Scanning: fewer points, so that a case stays within seconds.
  const std::size_t scanned = std::max<std::size_t>(200, 20'000'000 / n);
  const std::vector<Point> all = make_points(num_points);
  const std::size_t step = is_scan ? std::max<std::size_t>(1, num_points / scanned) : 1;
  std::vector<Point> at;
  for (std::size_t i = 0; i < all.size(); i += step) at.push_back(all[i]);
  std::vector<double> size(at.size()), times;
  for (int i = 0; i < repeat; ++i) times.push_back(seconds_of([&] { field->sizes(at, size); }));
  std::sort(times.begin(), times.end());
  double sum = 0;
  for (std::size_t i = 0; i < at.size(); ++i)
    if (is_scan || i % std::max<std::size_t>(1, num_points / scanned) == 0) sum += size[i];
  const double bounds = is_scan && n > 1000 ? 0 : bounds_a_second(*field, at);
  fmt::print("{:10} {:7} {:8} {:8.3f} {:9.4g} {:8.1f} {:9.4g} {:.15g}\n", layout, n, method, build,
             static_cast<double>(at.size()) / times[times.size() / 2] * 1e-6, megabytes, bounds * 1e-6, sum);
  std::fflush(stdout);
}

std::vector<double> read_numbers(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + " cannot be read");
  return {std::istream_iterator<double>(stream), {}};
}

/// Points with linear laws from a file (x y z delta0 r1), places from another (x y z), sizes to a third.
void run_given(const std::string& source_file, const std::string& place_file, const std::string& out_file) {
  const std::vector<double> s = read_numbers(source_file), p = read_numbers(place_file);
  std::vector<SizeSource> sources;
  for (std::size_t i = 0; i + 4 < s.size(); i += 5) {
    delfront::SizeLaw law;
    law.delta0 = s[i + 3];
    law.r1 = s[i + 4];
    sources.push_back({delfront::Simplex{{Point{s[i], s[i + 1], s[i + 2]}}, 1}, law, {}, {}, ""});
  }
  std::vector<Point> at;
  for (std::size_t i = 0; i + 2 < p.size(); i += 3) at.push_back({p[i], p[i + 1], p[i + 2]});
  std::vector<double> size(at.size());
  delfront::Context context;
  std::unique_ptr<delfront::SizeField> field;
  const double build = seconds_of([&] { field = build_source_size_field(std::move(sources), {}, context); });
  const double evaluate = seconds_of([&] { field->sizes(at, size); });
  std::ofstream out(out_file);
  for (const double value : size) out << fmt::format("{:.17g}\n", value);
  fmt::print("{:.6f} {:.6f}\n", build, evaluate);
}

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) result.push_back(word);
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc == 5 && std::string(argv[1]) == "--given") {
    run_given(argv[2], argv[3], argv[4]);
    return 0;
  }
  std::vector<std::string> layouts = {"scattered", "curves", "surfaces", "body"}, methods = {"scan", "tree"};
  std::vector<std::string> counts = {"10", "100", "1000", "10000", "100000"};
  std::size_t num_points = 1'000'000;
  int repeat = 3;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--sources") counts = words(value);
    if (key == "--layout" && value != "all") layouts = words(value);
    if (key == "--methods") methods = words(value);
    if (key == "--points") num_points = static_cast<std::size_t>(std::strtod(value.c_str(), nullptr));
    if (key == "--repeat") repeat = std::atoi(value.c_str());
  }
  fmt::print("layout     sources how       build s   Meval/s       MB Mbounds/s sum of sizes\n");
  for (const std::string& layout : layouts)
    for (const std::string& count : counts)
      for (const std::string& method : methods)
        if (layout == "body" || method != "boundary")
          run_case(layout, static_cast<std::size_t>(std::strtod(count.c_str(), nullptr)), method, num_points, repeat);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
