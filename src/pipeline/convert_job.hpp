// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/io.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

struct ConvertOptions {
  std::string from, to;  ///< formats, instead of by extension
  WriteOptions how = {};
  std::string solver = {};  ///< also starter files for it (write_starter_files)
};

/// @brief Write a surface or a grid in another format.
/// @param[out] changes  what the new format could not hold and how it was changed, as sentences
/// @param[out] starter  starter files, where options.solver asks for them
/// @return what was read
/// @throws UsageError  a version of MSH that there is not; the output is the input; smooth geometry
/// @throws as read_mesh, write_mesh
Mesh convert_file(const std::string& in, const std::string& out, const ConvertOptions& options,
                  std::vector<std::string>& changes, Context& context, StarterFiles* starter = nullptr);

/// @brief Write a grid with starter files of options.solver; options.from is not used.
/// @return what the format could not hold and how it was changed, as sentences
/// @throws UsageError  a version of MSH that there is not; a solver that there is not, or that reads another format
/// @throws as write_mesh, write_starter_files
std::vector<std::string> write_for_solver(const Mesh& mesh, const std::string& out, const ConvertOptions& options,
                                          Context& context, StarterFiles& starter);

/// @brief That the version of an MSH file is one that can be written. @throws UsageError
void check_write_options(const WriteOptions& options);

}  // namespace delfront
