// SPDX-License-Identifier: Apache-2.0
#include "cad/load_module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace delfront::cad {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "libdelfront_cad.so";

/// Beside the program and beside the library that holds this code, and in the folders lib next to them; last by name
/// alone, where the system's loader looks (a program that cannot find itself, as where /proc is not mounted).
std::vector<std::string> places() {
  std::vector<fs::path> folders;
  std::error_code ignored;
  if (const fs::path program = fs::read_symlink("/proc/self/exe", ignored); !ignored)
    folders.push_back(program.parent_path());
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&find_module), &info) != 0 && info.dli_fname)
    if (const fs::path library = fs::weakly_canonical(info.dli_fname, ignored); !ignored)
      folders.push_back(library.parent_path());
  std::vector<std::string> found;
  for (const fs::path& folder : folders)
    for (const fs::path& at :
         {folder, folder.parent_path() / "lib", folder.parent_path() / "lib" / "delfront", folder.parent_path()}) {
      const std::string path = (at / kFile).string();
      if (fs::exists(path, ignored) && std::find(found.begin(), found.end(), path) == found.end())
        found.push_back(path);
    }
  found.push_back(kFile);
  return found;
}

struct Loaded {
  const ModuleInfo* info = nullptr;
  std::string why;
};

Loaded open(const std::string& path) {
  Loaded result;
  void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char* const reason = dlerror();
    result.why = fmt::format("{} cannot be loaded: {}", path, reason ? reason : "no reason given");
    return result;
  }
  const auto entry = reinterpret_cast<EntryPoint>(dlsym(handle, kEntryPoint));
  const ModuleInfo* const info = entry ? entry() : nullptr;
  const bool fits = info && info->version == kInterfaceVersion && info->request_size == sizeof(Request) &&
                    info->result_size == sizeof(Result) && info->face_size == sizeof(Face);
  if (!fits) {
    result.why = fmt::format("{} is of another version of delfront; build both together", path);
    return result;
  }
  result.info = info;
  result.why = fmt::format("{} ({})", path, info->library);
  return result;
}

Loaded load() {
  if (const char* const given = std::getenv("DELFRONT_CAD_MODULE"); given && *given) return open(given);
  Loaded first;
  for (const std::string& path : places()) {
    Loaded result = open(path);
    if (result.info) return result;
    if (first.why.empty() && path != kFile) first = std::move(result);
  }
  if (first.why.empty())
    first.why = fmt::format(
        "{} is not there (beside the program or in ../lib; DELFRONT_CAD_MODULE names another place). Install the "
        "package delfront-cad; or, where you build: libocct-data-exchange-dev and libocct-ocaf-dev (scripts/setup "
        "does), and build again",
        kFile);
  return first;
}

}  // namespace

const ModuleInfo* find_module(std::string& why) {
  static const Loaded loaded = load();
  why = loaded.why;
  return loaded.info;
}

}  // namespace delfront::cad
