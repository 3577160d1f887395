// SPDX-License-Identifier: Apache-2.0
#include "fuzz_reader.hpp"

namespace {

using namespace delfront;

/// Names for a mesh of three patches and one volume.
Mesh read_names(std::string_view bytes, const std::string& path, Context& context) {
  Mesh mesh;
  for (const char* name : {"patch_1", "patch_2", "patch_3"}) mesh.add_group(2, name);
  mesh.add_group(3, "region_1");
  read_mapbc(bytes, path, mesh, context);
  return mesh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return delfront::fuzz_reader(read_names, data, size);
}
