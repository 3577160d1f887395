// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/findings.hpp"
#include "delfront/job.hpp"
#include "delfront/model.hpp"
#include "pipeline/geometry_job.hpp"

namespace delfront {

/// @brief A job under way: what goes in, and what its steps have made so far.
struct Run {
  Options options;  ///< lengths are resolved to model units on the way
  Context& context;
  JobResult& result;
  std::vector<NamedMesh> inputs;
  PatchId far_field;  ///< the patch of domain.enclose, where there is one
  JobKind kind = JobKind::grid;
  Model geometry;  ///< where new boundary points of refine.levels belong; empty: in the middle of their edges
  std::vector<GeometryInput> smooth;  ///< inputs whose mesh is made from them
  JobExtras extras = {};
  std::map<std::string, std::string> face_colours = {};  ///< of CAD files, see patch_colours.hpp
};

inline bool has_far_field(const Options& options) { return options.domain.enclose.shape != "none"; }

inline bool writes_grid(const Options& options) {
  return options.stop_after != "geometry" && options.stop_after != "improve";
}

}  // namespace delfront
