// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"
#include "delfront/surface_grid.hpp"

namespace delfront {

/// @brief Sizes of a new surface: those asked for, not those of the given triangles.
///
/// The asked field between hmin and hmax. Where nothing is asked for, the mean side of the given triangles; where
/// something is, but no hmax, at most a tenth of the diagonal. Far fields do not count.
/// @param asked  null: hmin and hmax alone
std::shared_ptr<const SizeField> surface_sizes(const Model& model, const Options& options,
                                               std::shared_ptr<const SizeField> asked);

/// @brief Grid the surface anew where options.surface.method asks for that; far fields keep their triangles.
void regrid_as_asked(Model& model, const Options& options, const SizeField& size, SurfaceGridReport& report,
                     Context& context);

}  // namespace delfront
