// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "delfront/context.hpp"

namespace delfront {

/// @brief A CGNS file as the library here takes it: it refuses those of a later version (4.x where it is 3.4) for the
/// number alone, though nodes of unstructured grids are the same. Such a file is copied, with the library's own number,
/// among the temporary files, until this ends. Hold a Hdf5Turn.
class OlderVersion {
 public:
  /// @throws IoError  where there is no room for the copy
  OlderVersion(const std::string& path, Context& context);
  ~OlderVersion() { remove(); }
  OlderVersion(const OlderVersion&) = delete;
  OlderVersion& operator=(const OlderVersion&) = delete;

  /// @brief What to open: the file itself, or its copy.
  const std::string& path() const { return path_; }
  /// @brief Take the copy's name away once it is open: whatever crashes afterwards, no file is left.
  void remove();

 private:
  std::string path_, copy_;
};

}  // namespace delfront
