// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "fuzz_reader.hpp"

namespace {

/// A polyMesh in one piece of bytes: its files, parted by form feeds.
delfront::Mesh read_parted(std::string_view bytes, const std::string& path, delfront::Context& context) {
  std::array<std::string_view, 7> parts;
  for (std::string_view& part : parts) {
    const std::size_t end = std::min(bytes.find('\f'), bytes.size());
    part = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
  return delfront::read_foam_files({parts[0], parts[1], parts[2], parts[3], parts[4], parts[5], parts[6]}, path,
                                   context);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return delfront::fuzz_reader(read_parted, data, size);
}
