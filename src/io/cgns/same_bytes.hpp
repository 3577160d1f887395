// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace delfront {

/// @brief Write an HDF5 file anew without times and with texts padded by zeros: the CGNS library notes when each node
/// was made, and pads with whatever memory held, so that the same grid gave other bytes each time.
/// @throws IoError  it cannot be read or written, naming `shown_path`
/// @par Cost  the file once more; memory: the largest array
void write_same_bytes(const std::string& from, const std::string& to, const std::string& shown_path);

}  // namespace delfront
