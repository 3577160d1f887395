// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "delfront/planar.hpp"
#include "delfront/size_field.hpp"
#include "planar/constrain.hpp"

namespace delfront {

/// @brief What stands before points are put in: the domain triangulated, and the sizes.
struct PlanarPrepared {
  PlanarGrid grid;
  std::shared_ptr<const SizeField> size;
  bool is_kept_too_long = false;  ///< segments that stay as given are longer than the sizes asked for
};

/// @brief The first half of generate_planar().
/// @throws as generate_planar()
PlanarPrepared prepare_planar(const PlanarDomain& domain, const Options& options,
                              const std::shared_ptr<const SizeField>& asked, Context& context);

/// @brief The second half: points, improvement, the mesh.
/// @throws as generate_planar()
Outcome fill_planar(PlanarPrepared prepared, const PlanarDomain& domain, const Options& options, Context& context);

}  // namespace delfront
