// SPDX-License-Identifier: Apache-2.0
#include "view/page_data.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "delfront/errors.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/io.hpp"
#include "support/support.hpp"
#include "unit/mesh/grids.hpp"
#include "view/cell_values.hpp"
#include "view/page.hpp"

namespace delfront {
namespace {

using Json = nlohmann::json;

/// Reads as the page does.
struct Data {
  explicit Data(const std::string& all) : bytes(all) {
    EXPECT_EQ(bytes.substr(0, 7), "DFVIEW1");
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 8, 4);
    EXPECT_EQ(size % 4, 0u);
    header = Json::parse(bytes.substr(16, size));
    begin = 16 + size;
  }
  std::vector<std::uint32_t> words(const Json& at) const {
    const std::size_t n = at["length"], offset = begin + at["offset"].get<std::size_t>();
    std::vector<std::uint32_t> result(n);
    EXPECT_LE(offset + 4 * n, bytes.size());
    const auto* p = reinterpret_cast<const unsigned char*>(bytes.data() + offset);
    if (at["filter"] == "none") {
      std::memcpy(result.data(), p, 4 * n);
      return result;
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 4; ++k) result[i] |= static_cast<std::uint32_t>(p[k * n + i]) << (8 * k);
    if (at["filter"] == "planes") return result;
    std::uint32_t before = 0;
    for (std::uint32_t& word : result) word = before += (word >> 1) ^ (0u - (word & 1));
    return result;
  }
  std::vector<float> values(const Json& at) const {
    std::vector<float> result;
    for (const std::uint32_t word : words(at)) result.push_back(std::bit_cast<float>(word));
    return result;
  }

  std::string bytes;
  Json header;
  std::size_t begin = 0;
};

Data data_of(const Mesh& mesh, bool is_compact, std::vector<Finding> findings = {}) {
  Context context;
  return Data(make_page_data({"a <b>.vtu", &mesh, true, std::move(findings)}, is_compact, context));
}

TEST(PageData, holds_points_cells_groups_and_names) {
  Mesh mesh = grids::regular_tet();
  mesh.blocks[0].group = {mesh.add_group(3, "air \"<>\"")};
  const Data data = data_of(mesh, false);
  EXPECT_EQ(data.header["name"], "a <b>.vtu");
  EXPECT_EQ(data.header["top_dimension"], 3);
  EXPECT_EQ(data.header["groups"].back()["name"], "air \"<>\"");
  const std::vector<float> points = data.values(data.header["points"]);
  ASSERT_EQ(points.size(), 3 * mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(points[3 * i + static_cast<std::size_t>(k)] +
                    data.header["centre"][static_cast<std::size_t>(k)].get<double>(),
                mesh.points[VertexId(i)][k]);
  for (const Json& block : data.header["blocks"]) {
    if (block["type"] != "tetrahedron") continue;
    const std::vector<std::uint32_t> vertices = data.words(block["vertices"]);
    ASSERT_EQ(vertices.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(vertices[i], mesh.find_block(CellType::tetrahedron)->vertices[i].value);
    EXPECT_EQ(data.words(block["groups"])[0], mesh.blocks[0].group[0].value);
  }
}

/// Cells no two of which are alike, as in real grids.
Mesh jittered_cube(int n) {
  Mesh mesh = grids::cube(n);
  std::mt19937 random(7);
  for (Point& p : mesh.points)
    for (int k = 0; k < 3; ++k) p[k] += 0.1 / n * (static_cast<double>(random()) / 4294967296.0 - 0.5);
  return mesh;
}

TEST(PageData, compact_data_say_the_same_and_pack_smaller) {
  Context context;
  const Mesh mesh = jittered_cube(12);
  const Data plain = data_of(mesh, false), compact = data_of(mesh, true);
  EXPECT_EQ(plain.values(plain.header["points"]), compact.values(compact.header["points"]));
  for (std::size_t b = 0; b < plain.header["blocks"].size(); ++b)
    for (const char* name : {"vertices", "groups"})
      EXPECT_EQ(plain.words(plain.header["blocks"][b][name]), compact.words(compact.header["blocks"][b][name]));
  ASSERT_GE(plain.header["measures"].size(), 4u);
  for (std::size_t m = 0; m < plain.header["measures"].size(); ++m) {
    const std::vector<float> exact = plain.values(plain.header["measures"][m]["values"]);
    const std::vector<float> rounded = compact.values(compact.header["measures"][m]["values"]);
    for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(rounded[i], exact[i], std::abs(exact[i]) / 2048);
  }
  const auto packed = [](const std::string& bytes) { return make_export("<!--delfront-data-->", bytes).size(); };
  EXPECT_LT(packed(compact.bytes), packed(plain.bytes) * 2 / 3);
}

TEST(PageData, findings_keep_places_outlines_and_ids) {
  const Mesh mesh = grids::regular_tet();
  Finding finding{"flat_cell", Severity::error, 7, "seven flat cells", "heal", {{{1, 2, 3}, {42}}, {{0, 0, 0}, {}}}};
  finding.outlines = {{42, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {43, {{0, 0, 0}, {0, 0, 1}}}};
  const Data data = data_of(mesh, true, {finding});
  const Json& found = data.header["findings"][0];
  EXPECT_EQ(found["kind"], "flat_cell");
  EXPECT_EQ(found["severity"], "error");
  EXPECT_EQ(found["count"], 7);
  EXPECT_EQ(data.words(found["ids"]), (std::vector<std::uint32_t>{42, 0xffffffffu}));
  EXPECT_EQ(data.words(found["offsets"]), (std::vector<std::uint32_t>{0, 3, 5}));
  EXPECT_EQ(data.values(found["outlines"]).size(), 15u);
  const double x = data.header["centre"][0];
  EXPECT_FLOAT_EQ(data.values(found["places"])[0], static_cast<float>(1 - x));
}

TEST(PageData, an_index_out_of_range_is_refused) {
  Mesh mesh = grids::regular_tet();
  mesh.block(CellType::tetrahedron).vertices[2] = VertexId(99);
  EXPECT_THROW(data_of(mesh, false), InputError);
}

/// Each cell's value lies where the report says they lie, and the ends are met.
void expect_agrees_with_the_report(const Mesh& mesh) {
  Context context;
  const QualityReport report = measure_quality(mesh, context);
  const std::vector<CellValues> all = measure_each_cell(mesh, context);
  std::size_t compared = 0;
  for (const CellValues& values : all) {
    const Measure* measure = report.find(values.name);
    EXPECT_EQ(values.is_quality, measure != nullptr) << values.name;
    if (!measure) continue;
    ++compared;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const float v : values.values) {
      if (std::isnan(v)) continue;
      low = std::min(low, static_cast<double>(v));
      high = std::max(high, static_cast<double>(v));
    }
    // a cell has its worst facet's value, so that only that end is the report's
    const double wanted = measure->worst_is_low ? measure->min : measure->max;
    EXPECT_NEAR(measure->worst_is_low ? low : high, wanted, 1e-6 * std::max(1.0, std::abs(wanted))) << values.name;
    for (std::size_t i = 0; i < measure->worst.size(); ++i) {
      const float here = values.values[measure->worst[i].ids[0]];
      const double there = measure->worst_values[i];
      EXPECT_TRUE(measure->worst_is_low ? here <= there + 1e-5 : here >= there - 1e-5 * std::abs(there)) << values.name;
    }
  }
  EXPECT_GE(compared, 2u);
}

TEST(CellValues, agree_with_the_quality_report) {
  expect_agrees_with_the_report(grids::regular_tet());
  expect_agrees_with_the_report(grids::corner_tet());
  expect_agrees_with_the_report(grids::cube(3));
  expect_agrees_with_the_report(grids::mixed_cells());
  expect_agrees_with_the_report(grids::square(4));
  expect_agrees_with_the_report(fixtures::sphere_surface(3));
}

TEST(CellValues, regular_tetrahedron_has_the_known_values) {
  Context context;
  for (const CellValues& values : measure_each_cell(grids::regular_tet(), context)) {
    ASSERT_EQ(values.values.size(), 1u);
    if (values.name == "min_dihedral") {
      EXPECT_FLOAT_EQ(values.values[0], 70.528779365509308f);
    }
    if (values.name == "volume") {
      EXPECT_FLOAT_EQ(values.values[0], 8.0f / 3);
    }
    if (values.name == "size") {
      EXPECT_FLOAT_EQ(values.values[0], std::sqrt(8.0f));
    }
  }
}

TEST(CellValues, the_same_for_any_number_of_threads) {
  const Mesh mesh = fixtures::sphere_surface(5);
  Context one, four;
  four.threads = 4;
  const std::vector<CellValues> a = measure_each_cell(mesh, one), b = measure_each_cell(mesh, four);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].values, b[i].values);
}

TEST(ReadDefects, gives_what_was_written) {
  Context context;
  const std::string path = (fixtures::scratch_folder() / "defects.vtp").string();
  Finding open{"open_edges", Severity::error, 2, "", "", {{{0.1, 0.2, 0.3}, {5}}, {{1, 1, 1}, {6}}}};
  open.outlines = {{5, {{0, 0, 0}, {1, 0, 0}}}};
  Finding thin{"thin", Severity::warning, 1, "", "", {{{2, 0, 0}, {}}}};
  thin.outlines = {{9, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
  write_defects({open, thin}, path, context);
  const std::vector<Finding> read = read_defects(path, context);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].kind, "open_edges");
  EXPECT_EQ(read[0].severity, Severity::error);
  ASSERT_EQ(read[0].places.size(), 2u);
  EXPECT_EQ(read[0].places[0].at, (Point{0.1, 0.2, 0.3}));
  EXPECT_EQ(read[0].places[0].ids, (std::vector<std::uint32_t>{5}));
  ASSERT_EQ(read[0].outlines.size(), 1u);
  EXPECT_EQ(read[0].outlines[0].corners.size(), 2u);
  EXPECT_EQ(read[1].kind, "thin");
  EXPECT_EQ(read[1].severity, Severity::warning);
  EXPECT_TRUE(read[1].places[0].ids.empty());
  EXPECT_EQ(read[1].outlines[0].corners.size(), 3u);
}

TEST(ReadDefects, another_file_is_refused) {
  Context context;
  const std::string path = (fixtures::scratch_folder() / "ball.vtp").string();
  write_mesh(fixtures::sphere_surface(1), path, context);
  EXPECT_THROW(read_defects(path, context), InputError);
}

TEST(Page, an_export_holds_page_and_data) {
  const std::string page = make_export("<p>a</p><!--delfront-data--><script>b</script>", std::string(1000, 'x'));
  EXPECT_TRUE(page.starts_with("<p>a</p><script type=\"text/plain\" id=\"delfront-data\">"));
  EXPECT_TRUE(page.ends_with("</script><script>b</script>"));
  EXPECT_LT(page.size(), 200u);
}

}  // namespace
}  // namespace delfront
