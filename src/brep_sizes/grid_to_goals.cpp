// SPDX-License-Identifier: Apache-2.0
// The loop of 3.2.8: grid, measure, lower, again.
#include <fmt/format.h>

#include "delfront/brep_sizes.hpp"
#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr double kGrowth = 1.3;    ///< of sizes from where they are lowered
constexpr double kHelps = 0.95;    ///< of the places beyond the goals: a round that leaves more helps no more
constexpr int kRoundsWithout = 2;  ///< help, before it ends

std::size_t num_beyond(const BrepAccuracy& a) {
  return a.deviation.num_beyond + a.turn_deg.num_beyond + a.angle_deg.num_beyond;
}

}  // namespace

Model grid_brep_to_goals(const Brep& brep, std::shared_ptr<const SizeField> size, const BrepOptions& options,
                         const BrepGoals& goals, BrepRounds& report, Context& context) {
  BrepOptions how = options;
  how.keeps_parameters = true;
  report = {};
  Model best;
  BoundarySizes lowered;
  lowered.growth = kGrowth;
  std::shared_ptr<const SizeField> wanted = size;
  std::size_t least_beyond = 0;
  int without_help = 0;
  for (int round = 1; round <= std::max(1, goals.rounds); ++round) {
    context.progress("surface", std::uint64_t(round - 1), std::uint64_t(std::max(1, goals.rounds)), "rounds");
    BrepGridReport made;
    Model grid;
    try {
      grid = grid_brep(brep, *wanted, how, made, context);
    } catch (const MeshingError& e) {
      if (report.rounds.empty()) throw;
      report.stopped = fmt::format("round {} has no grid: {}", round, e.what());
      return best;
    }
    report.rounds.push_back(measure_brep_grid(brep, grid, made, *wanted, goals, &lowered, context));
    best = std::move(grid);
    report.grid = std::move(made);
    report.stopped.clear();
    if (report.last().is_reached()) return best;
    const std::size_t beyond = num_beyond(report.last());
    without_help = round > 1 && double(beyond) > kHelps * double(least_beyond) ? without_help + 1 : 0;
    least_beyond = round > 1 ? std::min(least_beyond, beyond) : beyond;
    report.stopped = fmt::format("{} places are beyond the goals after {} rounds", beyond, round);
    if (without_help >= kRoundsWithout) break;
    wanted = combine_size_fields({size, build_boundary_size_field(lowered, context)}, 0,
                                 std::numeric_limits<double>::infinity());
  }
  return best;
}

}  // namespace delfront
