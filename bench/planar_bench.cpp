// SPDX-License-Identifier: Apache-2.0
// planar_bench [points] [airfoil.dat …]: Delaunay of uniform points in the plane, then grids of the unit square (about
// 1.4 million triangles) and of the sections in a circular far field. One JSON line a case and stage, with the keys
// case, stage, seconds, triangles, min_angle_deg; work a point where the kernel counts it.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "delfront/io.hpp"
#include "delfront/uniform_size.hpp"
#include "planar/far_field.hpp"
#include "planar/improve.hpp"
#include "planar/kernel.hpp"
#include "planar/refine.hpp"

namespace {

using namespace delfront;

constexpr int kSquareSide = 788;       // segments: 1.43 million triangles
constexpr double kSectionSize = 0.02;  // largest side and
constexpr double kFarField = 8;        // radius of the circle: about a million triangles

double seconds_of(auto&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void print_line(const std::string& name, const std::string& stage, double seconds, std::size_t triangles,
                const std::string& min_angle, const std::string& more = "") {
  fmt::print(R"({{"case": "{}", "stage": "{}", "seconds": {:.4f}, "triangles": {}, "min_angle_deg": {}, )"
             R"("triangles_per_second": {:.0f}{}}})"
             "\n",
             name, stage, seconds, triangles, min_angle, static_cast<double>(triangles) / seconds, more);
}

std::string work_a_point(const PlanarCounts& counts) {
  const auto share = [&](std::uint64_t count) {
    return static_cast<double>(count) / static_cast<double>(counts.points);
  };
  return fmt::format(
      R"(, "walk_steps_a_point": {:.2f}, "incircle_tests_a_point": {:.2f}, "triangles_made_a_point": {:.2f})",
      share(counts.walk_steps), share(counts.incircle_tests), share(counts.triangles_created));
}

void delaunay_case(std::size_t n) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  TriComplex complex;
  for (std::size_t i = 0; i < n; ++i) complex.point.push_back({uniform(random), uniform(random)});
  PlanarKernel kernel(complex);
  Context context;
  const double seconds = seconds_of([&] { build_delaunay(complex, kernel, context); });
  print_line(fmt::format("uniform_{}", n), "delaunay", seconds, complex.num_live(), "null",
             work_a_point(kernel.counts));
}

PlanarDomain square() {
  PlanarDomain domain;
  domain.curves.push_back({"wall", ""});
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < kSquareSide; ++i) {
      const double t = static_cast<double>(i) / kSquareSide;
      const Point2 place[4] = {{t, 0}, {1, t}, {1 - t, 1}, {0, 1 - t}};
      domain.points.push_back(place[side]);
    }
  for (std::size_t i = 0; i < domain.points.size(); ++i) {
    domain.segments.push_back({VertexId(i), VertexId((i + 1) % domain.points.size())});
    domain.curve_of_segment.push_back(CurveId(0));
  }
  return domain;
}

/// Stage by stage, for the kernel's counts.
void square_case() {
  const PlanarDomain domain = square();
  const DomainOptions keep;
  Context context;
  PlanarGrid grid;
  const double constrained = seconds_of([&] {
    grid.complex.point.assign(domain.points.begin(), domain.points.end());
    PlanarKernel kernel(grid.complex);
    build_delaunay(grid.complex, kernel, context);
    std::vector<VertexIndex> same(domain.points.size());
    for (VertexIndex v = 0; v < same.size(); ++v) same[v] = v;
    insert_segments(domain, same, grid, context);
    colour_regions(domain, keep, grid);
  });
  print_line("square", "triangulate", constrained, grid.complex.num_live(), "null");
  const UniformSize field(1.0 / kSquareSide);
  grid.complex.h.assign(domain.points.size(), 1.0 / kSquareSide);
  PlanarCounts counts;
  const double refined = seconds_of([&] { refine_complex(grid, field, context, PointPlacement::frontal, &counts); });
  ImproveReport report;
  const double improved = seconds_of([&] {
    report = improve_complex(
        grid, {.min_angle = 30, .max_passes = 8, .first_free = static_cast<VertexIndex>(domain.points.size())},
        context);
  });
  const std::size_t triangles = grid.complex.num_live() - domain.points.size();  // without the ghosts
  print_line("square", "refine", refined, triangles, fmt::format("{:.2f}", report.min_dihedral_before_deg),
             work_a_point(counts));
  print_line("square", "improve", improved, triangles, fmt::format("{:.2f}", report.min_dihedral_after_deg));
}

void print_run(const std::string& name, const PlanarDomain& domain, const Options& options) {
  Context context;
  Outcome outcome;
  const double whole = seconds_of([&] { outcome = generate_planar(domain, options, context); });
  const std::size_t triangles = outcome.report.quality.num_cells;
  const std::string min_angle = fmt::format("{:.2f}", outcome.report.quality.find("min_angle")->min);
  for (const StageTime& stage : context.stage_times)
    print_line(name, stage.stage, stage.seconds, triangles, stage.stage == "improve" ? min_angle : "null");
  print_line(name, "whole", whole, triangles, min_angle);
}

void section_case(const std::string& path) {
  Context context;
  const std::string stem = std::filesystem::path(path).stem().string();
  PlanarDomain domain = build_planar_domain({{read_mesh(path, context), stem}}, context);
  EncloseOptions enclose;
  enclose.shape = "circle";
  enclose.size = {kFarField, ""};
  Options options;
  options.size.hmax = Length{kSectionSize, ""};
  options.planar.boundary = "split";
  options.domain.keep = "outside";
  add_far_field(domain, enclose, options.size, {}, context);
  print_run(stem, domain, options);
}

}  // namespace

int main(int argc, char** argv) {
  delaunay_case(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000);
  square_case();
  const Options defaults;
  print_run("square_whole", square(), defaults);
  for (int i = 2; i < argc; ++i) section_case(argv[i]);
  return 0;
}
