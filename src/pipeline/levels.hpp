// SPDX-License-Identifier: Apache-2.0
// Global h-refinement as a way to grid (F19): a grid of 2^n times the sizes asked for, then every edge halved n times.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "delfront/planar.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @return 2^levels: coarse sizes over those asked for
double coarsening(const Options& options);

/// @brief The options of the coarse grid: bounds of sizes, and lengths of pieces that we make, times coarsening().
///
/// Sizes that grow from the boundary rise as fast over coarse lengths as those asked for would over fine ones, but by
/// no more than half of the distance. options.refine is empty in the result, and options.output.sizes is not set.
Options coarse_options(const Options& options);

/// @brief The field asked for, times coarsening(); it rises by at most half of the distance.
/// @param asked  null: stays null
std::shared_ptr<const SizeField> coarse_sizes(std::shared_ptr<const SizeField> asked, const Options& options,
                                              const Box& domain, Context& context);

/// @brief While it lives the context's limit of cells is that of the coarse grid, and messages say so.
class CoarseLimit {
 public:
  CoarseLimit(Context& context, const Options& options, bool is_planar);
  ~CoarseLimit() { end(); }
  CoarseLimit(const CoarseLimit&) = delete;
  CoarseLimit& operator=(const CoarseLimit&) = delete;
  void end();

 private:
  Context& context_;
  std::uint64_t max_cells_;
  std::string limit_advice_;
};

/// @brief Halve the edges of a coarse grid as often as the options say; nothing where they say 0.
///
/// Fields "h" and "metric" of the grid become those of the finer sizes. Quality is not measured anew.
/// @param geometry  where new boundary points belong; null: in the middle of their edges
/// @throws as refine_grid()
void refine_levels(Outcome& outcome, const Options& options, const Model* geometry, Context& context);

/// @brief generate_planar with options.refine: coarse, then refined.
/// @param domain   made with coarse_options()
/// @param asked    final sizes, as for generate_planar
Outcome generate_planar_in_levels(const PlanarDomain& domain, const Options& options, Context& context,
                                  std::shared_ptr<const SizeField> asked, const Model* geometry);

}  // namespace delfront
