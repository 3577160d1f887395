// SPDX-License-Identifier: Apache-2.0
#include "fuzz_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return delfront::fuzz_reader(delfront::read_exodus, data, size);
}
