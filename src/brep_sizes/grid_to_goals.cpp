// SPDX-License-Identifier: Apache-2.0
// The loop of 3.2.8: grid, measure, lower, again.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/brep_sizes.hpp"
#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr double kGrowth = 1.3;      ///< of sizes from where they are lowered
constexpr double kHelps = 0.95;      ///< of the places beyond the goals: a round that leaves more helps no more
constexpr double kFaceShare = 0.88;  ///< of sizes, all over a face that misses a goal for the second time
constexpr int kRoundsWithout = 2;    ///< help, before it ends
constexpr int kRoundsOfBetter = 2;   ///< within a grid that is to be better than one there is

std::size_t num_beyond(const BrepAccuracy& a) {
  return a.deviation.num_beyond + a.turn_deg.num_beyond + a.angle_deg.num_beyond;
}

/// All over the faces that miss a goal: where few places are beyond, the next grid has others.
void lower_faces(const Model& grid, const std::vector<std::uint32_t>& faces, const SizeField& size,
                 BoundarySizes& lowered, const BrepGoals& goals, const Context& context) {
  std::vector<bool> is_on(grid.points.size(), false);
  for (std::size_t t = 0; t < grid.triangles.size(); ++t)
    if (std::binary_search(faces.begin(), faces.end(), grid.input_face[TriangleId(t)]))
      for (const VertexId v : grid.triangles[TriangleId(t)]) is_on[v.index()] = true;
  std::vector<Point> at;
  for (std::size_t v = 0; v < is_on.size(); ++v)
    if (is_on[v]) at.push_back(grid.points[VertexId(v)]);
  std::vector<double> asked(at.size());
  evaluate_sizes(size, at, asked, context);
  for (std::size_t i = 0; i < at.size(); ++i) {
    lowered.points.push_back(at[i]);
    lowered.size.push_back(std::max(kFaceShare * asked[i], goals.hmin));
  }
}

}  // namespace

Model grid_brep_to_goals(const Brep& brep, std::shared_ptr<const SizeField> size, const BrepOptions& options,
                         const BrepGoals& goals, BrepRounds& report, Context& context) {
  BrepOptions how = options;
  how.keeps_parameters = true;
  how.least_size = std::max(how.least_size, goals.hmin);
  report = {};
  Model best;
  BoundarySizes lowered;
  lowered.growth = kGrowth;
  std::shared_ptr<const SizeField> wanted = size;
  std::size_t least_beyond = 0;
  int without_help = 0;
  for (int round = 1; round <= std::max(1, goals.rounds); ++round) {
    context.progress("surface", std::uint64_t(round - 1), std::uint64_t(std::max(1, goals.rounds)), "rounds");
    if (round > 1) how.most_rounds = std::min(options.most_rounds, kRoundsOfBetter);
    BrepGridReport made;
    Model grid;
    try {
      grid = grid_brep(brep, *wanted, how, made, context);
    } catch (const MeshingError& e) {
      if (report.rounds.empty()) throw;
      report.stopped = fmt::format("round {} has no grid: {}", round, e.what());
      return best;
    }
    const StageTimer timer(context, "measure");
    report.rounds.push_back(measure_brep_grid(brep, grid, made, *wanted, goals, &lowered, context));
    best = std::move(grid);
    report.grid = std::move(made);
    report.stopped.clear();
    if (report.last().is_reached()) return best;
    const std::size_t beyond = num_beyond(report.last());
    without_help = round > 1 && double(beyond) > kHelps * double(least_beyond) ? without_help + 1 : 0;
    least_beyond = round > 1 ? std::min(least_beyond, beyond) : beyond;
    report.stopped = fmt::format("{} places are beyond the goals after {} rounds", beyond, round);
    if (without_help >= kRoundsWithout || round == goals.rounds) break;
    if (round > 1) lower_faces(best, report.last().faces_beyond, *wanted, lowered, goals, context);
    wanted = combine_size_fields({size, build_boundary_size_field(lowered, context)}, 0,
                                 std::numeric_limits<double>::infinity());
  }
  return best;
}

}  // namespace delfront
