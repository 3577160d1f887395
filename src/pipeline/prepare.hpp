// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "delfront/generate.hpp"
#include "delfront/size_field.hpp"
#include "volume/recover.hpp"

namespace delfront {

/// @brief What stands before points are put in: the boundary as a grid without inner points, and the sizes.
struct Prepared {
  BoundaryGrid grid;
  std::shared_ptr<const SizeField> size;
};

/// @brief Whether sizes have directions and the method follows them: only the front does, the others take the least
/// size over all directions. @param size  may be null
bool makes_stretched_cells(const Options& options, const SizeField* size);

/// @brief The first half of generate(): look at the surface, recover it, make the size field.
/// @param asked  lowers the sizes that come from the boundary; null: nothing else is asked for
/// @throws as generate()
Prepared prepare_volume(Model& model, const Options& options, std::shared_ptr<const SizeField> asked, Report& report,
                        Context& context);

}  // namespace delfront
