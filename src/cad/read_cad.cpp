// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>

#include "cad/build_cad.hpp"
#include "cad/load_module.hpp"
#include "delfront/cad.hpp"

namespace delfront {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffixes[] = {".step", ".stp", ".iges", ".igs", ".brep", ".brp", ".egads"};

/// The caller's exception waits on this side until the module has ended.
struct Listener {
  Context& context;
  std::exception_ptr thrown;

  static bool hear(void* user, const char* what, double fraction) {
    auto& self = *static_cast<Listener*>(user);
    try {
      const bool is_known = fraction >= 0;
      self.context.progress("read", is_known ? std::uint64_t(100 * std::min(fraction, 1.0)) : 0, is_known ? 100 : 0,
                            is_known ? fmt::format("% {}", what) : what);
      return true;
    } catch (...) {
      self.thrown = std::current_exception();
      return false;
    }
  }
};

void check_file(const std::string& path) {
  std::error_code problem;
  if (!fs::exists(path, problem)) throw InputError(fmt::format("{}: no such file", path));
  if (fs::is_directory(path, problem)) throw InputError(fmt::format("{} is a folder, not a CAD file", path));
  if (fs::file_size(path, problem) == 0 && !problem) throw InputError(fmt::format("{}: the file is empty", path));
}

}  // namespace

bool is_cad_file(const std::string& path) {
  std::string suffix = fs::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return std::find(std::begin(kSuffixes), std::end(kSuffixes), suffix) != std::end(kSuffixes);
}

bool has_cad_module(std::string& why) { return cad::find_module(why) != nullptr; }

Brep read_cad(const std::string& path, const CadOptions& options, CadReport& report, Context& context) {
  report = {};
  check_file(path);
  std::string why;
  const cad::ModuleInfo* const module = cad::find_module(why);
  if (!module) throw InputError(fmt::format("{} is a CAD file, and this delfront reads none: {}", path, why));
  Listener listener{context, nullptr};
  cad::Request request;
  request.path = path.c_str();
  request.options = options;
  request.progress = &Listener::hear;
  request.user = &listener;
  context.log(LogLevel::debug, kCadReadingBegins + path);
  const std::unique_ptr<cad::Result, void (*)(cad::Result*)> result(module->read(&request), module->release);
  context.log(LogLevel::debug, kCadReadingEnds + path);
  if (listener.thrown) std::rethrow_exception(listener.thrown);
  if (result->ending != cad::Result::Ending::done) throw InputError(fmt::format("{}: {}", path, result->error));
  report = result->report;
  try {
    return cad::build_cad(*result, report, context);
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path, e.what()), e.places);
  }
}

}  // namespace delfront
