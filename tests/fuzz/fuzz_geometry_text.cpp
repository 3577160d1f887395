// SPDX-License-Identifier: Apache-2.0
// Any text: geometry or an InputError; geometry is written as text that reads as the same, and built or refused.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "delfront/errors.hpp"
#include "delfront/geometry_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace delfront;
  GeometryText geometry;
  try {
    geometry = parse_geometry({reinterpret_cast<const char*>(data), size}, "fuzz");
  } catch (const InputError&) {
    return 0;
  }
  const std::string text = to_text(geometry);
  const GeometryText again = parse_geometry(text, "again");
  if (!(again == geometry) || to_text(again) != text) std::abort();
  try {
    const Brep brep = build_brep(geometry, "fuzz");
    if (brep.faces.empty()) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
