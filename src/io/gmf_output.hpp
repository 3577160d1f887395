// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "io/gmf.hpp"
#include "io/output.hpp"

namespace delfront {

/// @brief Writes the keywords of a binary Medit file, little endian. Version 2 has places of 4 bytes, 3 of 8.
class GmfWriter {
 public:
  GmfWriter(Output& out, int version) : out_(out), version_(version) {
    integer(1);
    integer(version);
    at_ = 8;
  }

  /// @param bytes  behind the head: what the keyword holds
  void begin(std::int32_t keyword, std::uint64_t bytes) {
    const std::uint64_t head = version_ < 3 ? 8 : 12;
    at_ += head + bytes;
    integer(keyword);
    if (version_ < 3)
      integer(static_cast<std::int64_t>(at_));
    else
      out_.binary(at_);
  }
  void integer(std::int64_t value) { out_.binary(static_cast<std::int32_t>(value)); }
  void real(double value) { out_.binary(value); }
  void end() {
    integer(gmf::kEnd);
    version_ < 3 ? integer(0) : out_.binary(std::uint64_t{0});
  }

 private:
  Output& out_;
  int version_;
  std::uint64_t at_ = 0;
};

}  // namespace delfront
