// SPDX-License-Identifier: Apache-2.0
#pragma once
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
void add_geometry_sources(const Options& options, const Model& model, std::vector<SizeSource>& sources,
                          Context& context);

/// @brief The curves and points of a planar domain as a model, for sizes on names.
Model model_of(const PlanarDomain& domain);

}  // namespace delfront
