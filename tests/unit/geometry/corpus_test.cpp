// SPDX-License-Identifier: Apache-2.0
// Every facet file of the shared geometry against tests/corpus.toml.
#include <gtest/gtest.h>

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "delfront/io.hpp"
#include "delfront/surface_check.hpp"
#include "geometry/shells.hpp"
#include "support/support.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

namespace fs = std::filesystem;
constexpr double kRelativeTolerance = 2e-7;  // the table gives 8 digits

const toml::array& corpus() {
  static const toml::table table = toml::parse_file(DELFRONT_SOURCE_DIR "/tests/corpus.toml");
  return *table["file"].as_array();
}

void expect_findings(const toml::table& expected, const SurfaceReport& report) {
  if (const toml::array* defects = expected["defects"].as_array()) {
    for (const toml::node& node : *defects) {
      const std::string kind = node.value_or(std::string());
      const Finding* finding = fixtures::find(report, kind);
      ASSERT_NE(finding, nullptr) << kind << " not among " << fixtures::summary(report);
      EXPECT_EQ(finding->severity, Severity::error) << kind;
      EXPECT_FALSE(finding->message.empty() || finding->remedy.empty() || finding->places.empty()) << kind;
    }
  }
  if (const toml::table* counts = expected["counts"].as_table()) {
    for (const auto& [kind, count] : *counts) {
      const Finding* finding = fixtures::find(report, std::string(kind.str()));
      EXPECT_EQ(finding ? std::int64_t(finding->count) : 0, count.value_or(std::int64_t(-1))) << kind.str();
    }
  }
  if (const auto loops = expected["loops"].value<std::int64_t>()) {
    const Finding* open = fixtures::find(report, "open_edges");
    ASSERT_NE(open, nullptr);
    EXPECT_EQ(std::int64_t(open->places.size()), *loops);
  }
  for (const Finding& finding : report.findings) EXPECT_LE(finding.places.size(), kMaxPlaces);
}

template <class T, class Found>
void expect_if_stated(const toml::table& expected, const char* key, Found found) {
  if (const auto value = expected[key].value<T>()) {
    EXPECT_EQ(static_cast<T>(found), *value) << key;
  }
}

void expect_facts(const toml::table& expected, const SurfaceReport& report) {
  expect_if_stated<bool>(expected, "closed", report.is_closed);
  expect_if_stated<bool>(expected, "manifold", report.is_manifold);
  expect_if_stated<bool>(expected, "oriented", report.is_oriented);
  expect_if_stated<std::int64_t>(expected, "components", report.components.size());
  expect_if_stated<std::int64_t>(expected, "reoriented", report.reoriented);
}

void expect_volumes(const toml::table& expected, Model& model, Context& context) {
  std::vector<double> volumes;
  for (const auto& region : find_shells(Surface(model), context).regions()) volumes.push_back(region.volume);
  std::sort(volumes.begin(), volumes.end());
  const toml::array* regions = expected["regions"].as_array();
  ASSERT_NE(regions, nullptr) << "a valid file states its regions";
  ASSERT_EQ(volumes.size(), regions->size());
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const double volume = (*regions)[i].value_or(0.0);
    EXPECT_NEAR(volumes[i], volume, kRelativeTolerance * volume) << "region " << i;
  }
  orient_shells(model, context);
  const SurfaceReport turned = check_surface(model, context);
  EXPECT_TRUE(turned.is_oriented) << "after orient_shells";
  const double volume = expected["volume"].value_or(0.0);
  EXPECT_NEAR(turned.volume, volume, kRelativeTolerance * std::abs(volume));
}

class Corpus : public testing::TestWithParam<std::size_t> {};

TEST_P(Corpus, gives_what_the_table_says) {
  DELFRONT_NEEDS_SHARED_DATA(data);
  const toml::table& expected = *corpus()[GetParam()].as_table();
  const fs::path path = *data / expected["path"].value_or(std::string());
  SCOPED_TRACE(path.string());
  Context context;
  Mesh mesh;
  if (const auto words = expected["unreadable"].value<std::string>()) {
    try {
      read_mesh(path.string(), context);
      FAIL() << "was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(*words), std::string::npos) << error.what();
    }
    return;
  }
  Model model = build_model({{read_mesh(path.string(), context), path.stem().string()}}, context);
  const SurfaceReport report = check_surface(model, context);
  const bool is_valid = expected["valid"].value_or(false);
  EXPECT_EQ(report.can_bound_volume, is_valid) << fixtures::summary(report);
  EXPECT_EQ(has_errors(report.findings), !is_valid) << fixtures::summary(report);
  expect_findings(expected, report);
  expect_facts(expected, report);
  if (is_valid) expect_volumes(expected, model, context);
}

std::string name_of_file(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = (*corpus()[info.param].as_table())["path"].value_or(std::string());
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Files, Corpus, testing::Range(std::size_t(0), corpus().size()), name_of_file);

TEST(CorpusTable, lists_every_facet_file_of_the_shared_data) {
  DELFRONT_NEEDS_SHARED_DATA(data);
  std::set<std::string> listed, present;
  for (const toml::node& node : corpus()) listed.insert((*node.as_table())["path"].value_or(std::string()));
  for (const char* folder : {"surface", "defects", "plc", "synthetic"}) {
    for (const fs::directory_entry& entry : fs::directory_iterator(*data / folder)) {
      std::string extension = entry.path().extension().string();
      std::transform(extension.begin(), extension.end(), extension.begin(),
                     [](unsigned char c) { return char(std::tolower(c)); });
      if (std::set<std::string>{".stl", ".obj", ".off", ".ply"}.count(extension))
        present.insert(std::string(folder) + "/" + entry.path().filename().string());
    }
  }
  EXPECT_EQ(listed, present);
}

}  // namespace
}  // namespace delfront
