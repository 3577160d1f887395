// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace delfront {

/// @brief The FoamFile dictionary that every file of a case begins with.
std::string foam_header(const char* kind, const std::string& location, const char* object,
                        const std::string& note = "");

/// @brief Makes folders that are missing, and removes those it made (if still empty) unless kept.
class CaseFolders {
 public:
  CaseFolders() = default;
  CaseFolders(const CaseFolders&) = delete;
  CaseFolders& operator=(const CaseFolders&) = delete;
  ~CaseFolders();
  /// @throws IoError  it cannot be made
  void make(const std::string& folder);
  void keep() { made_.clear(); }

 private:
  std::vector<std::string> made_;
};

/// @brief A small text file, whole or not at all. @throws IoError
void write_whole(const std::string& path, const std::string& text);

/// @brief The least that checkMesh and potentialFoam need to start.
/// @param name  controlDict, fvSchemes or fvSolution
/// @return the file's whole text; "" for another name
std::string minimal_system_file(const std::string& name);

/// @brief Those three in `folder`/system, each only where there is no file of that name. @throws IoError
void write_minimal_system(const std::string& folder, CaseFolders& folders);

}  // namespace delfront
