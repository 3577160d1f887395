// SPDX-License-Identifier: Apache-2.0
#include "fuzz_reader.hpp"

namespace {

using namespace delfront;

/// The fields of a mesh of three points.
Mesh read_solution(std::string_view bytes, const std::string& path, Context& context) {
  Mesh mesh;
  mesh.points.resize(3);
  read_solb(bytes, path, mesh, context);
  for (const Field& field : mesh.fields)
    if (field.values.size() != mesh.points.size() * static_cast<std::size_t>(field.components)) std::abort();
  return mesh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return delfront::fuzz_reader(read_solution, data, size);
}
