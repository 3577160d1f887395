// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "pipeline/run.hpp"

namespace delfront {

// What a run leaves beside its grid. Best effort: nothing here may hide how the run ended, so nothing is thrown; what
// could not be written becomes a warning of the result. A file of ours that an earlier run left under the name is
// removed where this run has none to put there.

/// @brief Everything that is wrong, with places, for the viewer: in options.output.defects, or beside the first output.
void leave_defects(Run& run);

/// @brief The grid as far as it came, NAME_partial.vtu beside the first output, where gridding failed.
void leave_partial_grid(Run& run);

}  // namespace delfront
