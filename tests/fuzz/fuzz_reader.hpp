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

using FieldReader = void (*)(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context);

/// @brief The same of a reader of fields: those of a mesh of three points have a value for each.
template <FieldReader Read>
int fuzz_field_reader(const std::uint8_t* data, std::size_t size) {
  const auto read = [](std::string_view bytes, const std::string& path, Context& context) {
    Mesh mesh;
    mesh.points.resize(3);
    Read(bytes, path, mesh, context);
    for (const Field& field : mesh.fields)
      if (field.values.size() != mesh.points.size() * static_cast<std::size_t>(field.components)) std::abort();
    return mesh;
  };
  return fuzz_reader(read, data, size);
}

}  // namespace delfront
