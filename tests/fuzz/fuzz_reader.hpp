// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "delfront/errors.hpp"
#include "io/formats.hpp"

namespace delfront {

/// @brief What must hold for every mesh that a reader returns: finite points, ids in range, a group a cell.
inline bool is_sound(const Mesh& mesh) {
  for (const Point& p : mesh.points)
    if (!is_finite(p)) return false;
  for (const CellBlock& block : mesh.blocks) {
    if (block.group.size() != block.size()) return false;
    for (GroupId group : block.group)
      if (group.is_valid() && group.index() >= mesh.groups.size()) return false;
    if (block.type == CellType::polyhedron) continue;  // its stream holds counts among the vertices
    for (VertexId v : block.vertices)
      if (v.index() >= mesh.points.size()) return false;
  }
  return true;
}

/// @brief One run of a fuzzer: InputError is a fine answer; anything else thrown, or an unsound mesh, is a find.
inline int fuzz_reader(Reader reader, const std::uint8_t* data, std::size_t size) {
  Context context;
  try {
    const Mesh mesh = reader({reinterpret_cast<const char*>(data), size}, "fuzz", context);
    if (!is_sound(mesh)) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}

}  // namespace delfront
