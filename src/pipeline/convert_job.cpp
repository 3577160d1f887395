// SPDX-License-Identifier: Apache-2.0
#include "pipeline/convert_job.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "delfront/errors.hpp"
#include "pipeline/geometry_job.hpp"

namespace delfront {

void check_write_options(const WriteOptions& options) {
  if (!options.version.empty() && options.version != "2.2" && options.version != "4.1")
    throw UsageError(fmt::format("version {} of MSH (--msh-version): allowed are 2.2 and 4.1", options.version));
}

Mesh convert_file(const std::string& in, const std::string& out, const ConvertOptions& options,
                  std::vector<std::string>& changes, Context& context) {
  check_write_options(options.how);
  std::error_code ignored;
  if (std::filesystem::equivalent(in, out, ignored))
    throw UsageError(fmt::format("{} is the input and would be overwritten; give OUT another name", out));
  check_writable(out);
  if (is_smooth_file(in))
    throw UsageError(fmt::format(
        "{} is smooth geometry, which has no cells yet: delfront mesh {} -o {} --stop-after surface grids it", in, in,
        out));
  Mesh mesh = read_mesh(in, context, options.from);
  changes = write_mesh(mesh, out, context, options.how, options.to);
  return mesh;
}

}  // namespace delfront
