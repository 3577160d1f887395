// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"
#include "delfront/surface_grid.hpp"

namespace delfront {

/// @brief Grid the surface anew where options.surface.method asks for that; far fields keep their triangles.
///
/// Sizes are those asked for, not those of the given triangles: the asked field and hmax, hmin. Where nothing is asked
/// for, the mean side of the given triangles; where something is, but no hmax, at most a tenth of the diagonal.
/// @param asked  null: hmin and hmax alone
void regrid_as_asked(Model& model, const Options& options, const SizeField* asked, SurfaceGridReport& report,
                     Context& context);

}  // namespace delfront
