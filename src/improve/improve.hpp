// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief Raise the worst cells of a complex: switch faces and edges, remove and add points, move points (T5).
///
/// Works on live tets whose region is not TetComplex::kOutside. Constrained faces and vertices with on_boundary stay
/// as they are. A change is accepted only where the worst quality of what it touches rises, and every new tet is
/// positive by the exact predicate.
/// @pre, @post complex.find_defect() is empty
/// @par Source  Freitag & Ollivier-Gooch (1997); Klingner & Shewchuk (2007); edge removal: Shewchuk (2002)
ImproveReport improve_complex(TetComplex& complex, const SizeField& size, const ImproveOptions& options,
                              Context& context);

}  // namespace delfront
