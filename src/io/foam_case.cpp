// SPDX-License-Identifier: Apache-2.0
#include "io/foam_case.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "delfront/errors.hpp"
#include "io/output.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

constexpr const char* kControl =
    "application     potentialFoam;\nstartFrom       startTime;\nstartTime       0;\nstopAt          endTime;\n"
    "endTime         1;\ndeltaT          1;\nwriteControl    timeStep;\nwriteInterval   1;\nwriteFormat     ascii;\n"
    "writePrecision  8;\n";
constexpr const char* kSchemes =
    "ddtSchemes { default steadyState; }\ngradSchemes { default Gauss linear; }\n"
    "divSchemes { default none; div(phi,U) bounded Gauss linear; div(div(phi,U)) Gauss linear; }\n"
    "laplacianSchemes { default Gauss linear corrected; }\ninterpolationSchemes { default linear; }\n"
    "snGradSchemes { default corrected; }\n";
constexpr const char* kSolution =
    "solvers\n{\n    Phi { solver GAMG; smoother DIC; tolerance 1e-06; relTol 0.01; }\n"
    "    p { $Phi; }\n}\npotentialFlow { nNonOrthogonalCorrectors 10; }\n";

constexpr const char* kSystemFiles[][2] = {
    {"controlDict", kControl}, {"fvSchemes", kSchemes}, {"fvSolution", kSolution}};

}  // namespace

std::string foam_header(const char* kind, const std::string& location, const char* object, const std::string& note) {
  return fmt::format(
      "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {};\n{}"
      "    location    \"{}\";\n    object      {};\n}}\n\n",
      kind, note.empty() ? "" : fmt::format("    note        \"{}\";\n", note), location, object);
}

CaseFolders::~CaseFolders() {
  std::error_code ignored;
  for (auto it = made_.rbegin(); it != made_.rend(); ++it) fs::remove(*it, ignored);  // fails where it is not empty
}

void CaseFolders::make(const std::string& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return;
  if (!fs::create_directory(folder, error))
    throw IoError(fmt::format("cannot make folder {}: {}", folder, error ? error.message() : "it is a file"));
  made_.push_back(folder);
}

void write_whole(const std::string& path, const std::string& text) {
  Replacement replacement(path);
  Output out(replacement.temporary(), path);
  out.text(text);
  out.close();
  replacement.commit();
}

std::string minimal_system_file(const std::string& name) {
  for (const auto& [known, text] : kSystemFiles)
    if (name == known) return foam_header("dictionary", "system", known) + text;
  return "";
}

void write_minimal_system(const std::string& folder, CaseFolders& folders) {
  const std::string system = folder + "/system";
  folders.make(system);
  for (const auto& [name, text] : kSystemFiles) {
    const std::string path = fmt::format("{}/{}", system, name);
    std::error_code error;
    if (!fs::exists(path, error)) write_whole(path, minimal_system_file(name));
  }
}

}  // namespace delfront
