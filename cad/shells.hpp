// SPDX-License-Identifier: Apache-2.0
// Shells put together from faces.
#pragma once
#include <BRep_Builder.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <vector>

namespace delfront::cad {

/// @brief A shell with each of these faces, in this order; nothing is joined.
inline TopoDS_Shell shell_of(const std::vector<TopoDS_Face>& faces) {
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (const TopoDS_Face& face : faces) builder.Add(shell, face);
  return shell;
}

}  // namespace delfront::cad
