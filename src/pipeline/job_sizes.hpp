// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "delfront/job.hpp"
#include "delfront/planar.hpp"
#include "delfront/size_sources.hpp"

namespace delfront {

/// @brief The sources of [[size.source]] and [[size.box]]; those of a group in size.without are left out.
/// @throws UsageError  an entry that is none: its place in the job file and what is wrong
/// @throws InputError  a file of facets that cannot be read
std::vector<SizeSource> job_sources(const Options& options, Context& context);

/// @brief The sources of [size.on.NAME], size.curvature, angle, deviation, gap, proximity and automatic (S7, S9 to
/// S11).
/// @throws UsageError  with the place of the key
/// @param is_kept  as GapSizes::is_kept
std::vector<SizeSource> geometry_sources(const Options& options, const Model& model,
                                         const std::function<bool(Point)>& is_kept, Context& context);

/// @brief The curves and points of a planar domain as a model, for sizes on names, from curvature and gaps.
Model model_of(const PlanarDomain& domain);

/// @brief Whether places of the plane lie in what is gridded: as holes, regions and the far field of the domain say.
/// The result may be called from several threads.
/// @throws as generate_planar()
/// @par Cost  that of the domain's triangulation; then O(log n) a place
std::function<bool(Point)> kept_part(PlanarDomain domain, CurveId far_field, const Options& options, Context& context);

}  // namespace delfront
