// SPDX-License-Identifier: Apache-2.0
#include "io/cgns/older_version.hpp"

#include <cgnslib.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "delfront/errors.hpp"
#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {

namespace {

constexpr const char* kVersion = "/CGNSLibraryVersion/ data";
constexpr float kKnown = CGNS_VERSION / 1000.0F;

/// @return 0 where the file is not HDF5 or does not say it
float version_of(const std::string& path) {
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.is_valid() || H5Lexists(file, "/CGNSLibraryVersion", H5P_DEFAULT) <= 0) return 0;
  const Hdf5Handle array(H5Dopen2(file, kVersion, H5P_DEFAULT), H5Dclose);
  const Hdf5Handle space(array.is_valid() ? H5Dget_space(array) : -1, H5Sclose);
  float version = 0;
  if (!space.is_valid() || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Dread(array, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, &version) < 0)
    return 0;
  return version;
}

bool set_version(const std::string& path) {
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  const Hdf5Handle array(file.is_valid() ? H5Dopen2(file, kVersion, H5P_DEFAULT) : -1, H5Dclose);
  return array.is_valid() && H5Dwrite(array, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, &kKnown) >= 0;
}

}  // namespace

OlderVersion::OlderVersion(const std::string& path, Context& context) : path_(path) {
  const float version = version_of(path);
  if (!(version >= static_cast<float>(CGNS_VERSION / 1000 + 1))) return;
  context.log(LogLevel::debug, fmt::format("{}: of CGNS {:.2f}, read as {:.2f}", path, version, kKnown));
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  std::string name = (folder / "delfront_XXXXXX").string();
  const int made = error ? -1 : ::mkstemp(name.data());
  if (made >= 0) {
    ::close(made);
    path_ = copy_ = name;
    std::ifstream source(path, std::ios::binary);
    std::ofstream target(copy_, std::ios::binary);  // onto the file just made, whose rights are ours alone
    target << source.rdbuf();
    target.close();
    if (source && target && set_version(copy_)) return;
    remove();
  }
  throw IoError(
      fmt::format("{}: of CGNS {:.2f}, of which a copy is read, and none can be made in {}; is the disk full? TMPDIR "
                  "names another folder",
                  path, version, folder.empty() ? "the folder of temporary files" : folder.string()));
}

void OlderVersion::remove() {
  if (!copy_.empty()) ::unlink(copy_.c_str());
  copy_.clear();
}

}  // namespace delfront
