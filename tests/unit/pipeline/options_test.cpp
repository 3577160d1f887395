// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "delfront/errors.hpp"
#include "delfront/job.hpp"
#include "pipeline/job_file.hpp"
#include "pipeline/option_table.hpp"
#include "support/errors.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

namespace fs = std::filesystem;

std::string write_job(const std::string& name, const std::string& text) {
  const fs::path folder = fixtures::scratch_folder("options_test");
  std::ofstream(folder / name, std::ios::binary) << text;
  return (folder / name).string();
}

Options read(const std::string& name, const std::string& text) {
  Options options;
  read_job_file(write_job(name, text), options);
  return options;
}

/// The message that a job file is refused with.
std::string refusal(const std::string& name, const std::string& text) {
  try {
    read(name, text);
  } catch (const UsageError& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted: " << text;
  return "";
}

#define EXPECT_SAYS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << (text)

TEST(OptionTable, keys_and_flags_are_unique_and_documented) {
  std::set<std::string> seen;
  for (const OptionRow& row : option_table()) {
    EXPECT_TRUE(seen.insert(row.key).second) << row.key;
    EXPECT_TRUE(row.flags.empty() || seen.insert(row.flags).second) << row.flags;
    EXPECT_FALSE(row.help.empty()) << row.key;
    EXPECT_FALSE(row.allowed.empty()) << row.key;
  }
}

TEST(JobFile, fills_the_options) {
  const Options o = read("case.toml", R"(
stop_after = "volume"
[input]
files = ["/abs/a.stl", "b.obj"]
units = "mm"
feature_angle = 30
[domain]
enclose = { shape = "sphere", size = "20c", name = "outer" }
keep = { point = [5, 5.5, -5] }
[boundaries.wing]
select = { name = "OML*" }
kind = "wall"
[boundaries."odd name"]
kind = "inlet"
[size]
hmin = 2e-4
hmax = "5%"
growth = 1.25
[improve]
goals = { min_dihedral = 12, max_nonortho = 70 }
[limits]
time = "2h"
memory = "20GB"
max_cells = 50e6
[output]
files = ["wing.su2", "foam/"]
require = "min_dihedral > 8"
)");
  EXPECT_EQ(o.stop_after, "volume");
  ASSERT_EQ(o.input.files.size(), 2u);
  EXPECT_EQ(o.input.files[0], "/abs/a.stl");
  EXPECT_EQ(o.input.units, "mm");
  EXPECT_EQ(o.input.feature_angle, 30);
  EXPECT_EQ(o.domain.enclose.shape, "sphere");
  EXPECT_EQ(o.domain.enclose.size.value, 20);
  EXPECT_EQ(o.domain.enclose.size.unit, "c");
  EXPECT_EQ(o.domain.enclose.name, "outer");
  ASSERT_EQ(o.domain.keep_points.size(), 1u);
  EXPECT_EQ(o.domain.keep_points[0], (Point{5, 5.5, -5}));
  ASSERT_EQ(o.boundaries.size(), 2u);
  const std::size_t wing = o.boundaries[0].name == "wing" ? 0 : 1;
  EXPECT_EQ(o.boundaries[wing].select, std::vector<std::string>{"OML*"});
  EXPECT_EQ(o.boundaries[wing].kind, "wall");
  EXPECT_EQ(o.boundaries[1 - wing].name, "odd name");
  EXPECT_EQ(o.size.hmin->value, 2e-4);
  EXPECT_EQ(o.size.hmax->unit, "%");
  EXPECT_EQ(o.size.growth, 1.25);
  EXPECT_EQ(o.improve.min_dihedral, 12);
  EXPECT_EQ(o.limits.time, 7200);
  EXPECT_EQ(o.limits.memory, 20000000000u);
  EXPECT_EQ(o.limits.max_cells, 50000000u);
  EXPECT_EQ(o.output.require, "min_dihedral > 8");
}

TEST(JobFile, paths_are_relative_to_its_folder) {
  const std::string path = write_job("case.toml", "input.files = ['b.obj']\noutput.files = ['out/foam/']\n");
  Options o;
  read_job_file(path, o);
  const fs::path folder = fs::path(path).parent_path();
  EXPECT_EQ(o.input.files[0], (folder / "b.obj").string());
  EXPECT_EQ(o.output.files[0], (folder / "out/foam/").string());
}

TEST(JobFile, json_has_the_same_tree_and_lines) {
  const Options o =
      read("case.json", "{\n \"size\": {\"hmax\": \"5%\", \"growth\": 1.5},\n \"improve\": {\"enabled\": false}\n}");
  EXPECT_EQ(o.size.hmax->unit, "%");
  EXPECT_EQ(o.size.growth, 1.5);
  EXPECT_FALSE(o.improve.enabled);
  EXPECT_SAYS(refusal("case.json", "{\n \"size\": {\n  \"hmin\": 1,\n  \"hmaxx\": 5\n }\n}"),
              "case.json:4: unknown key");
  EXPECT_SAYS(refusal("case.json", "{\n \"size\": {\n  \"hmax\": true\n }\n}"), "case.json:3: size.hmax");
  EXPECT_SAYS(refusal("case.json", "{\n \"size\": {\n"), "not valid JSON");
  EXPECT_SAYS(refusal("case.json", "{\n \"size\": {},\n \"size\": {}}"), "case.json:3: key 'size' is given twice");
  EXPECT_SAYS(refusal("case.json", "[1]"), "expected a table");
  EXPECT_SAYS(refusal("case.json", std::string(100000, '[')), "nested too deeply");
}

TEST(JobFile, unknown_key_names_line_and_nearest) {
  EXPECT_SAYS(refusal("case.toml", "\n[size]\nhmxa = 5\n"),
              "case.toml:3: unknown key 'size.hmxa' (did you mean 'size.hmax'?)");
  EXPECT_SAYS(refusal("case.toml", "[sizes]\nhmax = 5\n"), "did you mean 'size'?");
  EXPECT_SAYS(refusal("case.toml", "hmax = 5\n"), "did you mean 'size.hmax'?");
  EXPECT_SAYS(refusal("case.toml", "[size]\nzzzzzzzz = 5\n"), "allowed in [size]: hmin, hmax, growth");
  EXPECT_SAYS(refusal("case.toml", "[boundaries.wing]\nkinds = 'wall'\n"), "did you mean 'kind'?");
}

TEST(JobFile, keys_of_later_versions_are_said_to_be_so) {
  for (const char* text : {"[[layers]]\non = ['wing']\n", "[input]\nheal = { sew = true }\n",
                           "[domain]\nkeep = { seeds = { a = [0,0,0] } }\n"})
    EXPECT_SAYS(refusal("case.toml", text), "not in this version") << text;
}

TEST(JobFile, wrong_type_names_line_and_what_is_allowed) {
  const std::string message = refusal("case.toml", "[size]\n\nhmax = true\n");
  EXPECT_SAYS(message, "case.toml:3: size.hmax: expected a length");
  EXPECT_SAYS(message, "got the boolean true");
  EXPECT_SAYS(refusal("case.toml", "[size]\ngrowth = 'fast'\n"), "case.toml:2: size.growth: expected a number over 1");
  EXPECT_SAYS(refusal("case.toml", "[input]\nunits = 'mmm'\n"), "did you mean 'mm'?");
  EXPECT_SAYS(refusal("case.toml", "[size]\nhmax = '5 parsec'\n"), "unknown unit 'parsec'");
  EXPECT_SAYS(refusal("case.toml", "size = 5\n"), "case.toml:1: size: expected a table");
  EXPECT_SAYS(refusal("case.toml", "[size\nhmax = 5\n"), "case.toml:1: not valid TOML");
  EXPECT_SAYS(refusal("case.toml", "[size]\nhmax = 1\nhmax = 2\n"), "case.toml:3");
}

TEST(JobFile, refuses_values_out_of_range) {
  for (const char* text :
       {"size.hmax = 0", "size.hmin = -1", "size.hmax = nan", "size.growth = 1", "size.growth = 0.5",
        "size.growth = inf", "input.feature_angle = 181", "limits.max_cells = -1", "limits.max_cells = 1.5",
        "limits.memory = '-1GB'", "domain.enclose.corners = [0,0,0,1,1]", "domain.enclose.corners = [0,0,0,1,1,0]",
        "domain.keep = 'none'", "domain.keep = { point = [1,2] }", "boundaries.a.kind = 'wal'", "input.files = [1]",
        "input.files = ['']", "volume.method = 'fronts'", "improve.max_passes = 99999999999"})
    EXPECT_FALSE(refusal("case.toml", text).empty()) << text;
}

TEST(SetOption, takes_words_of_the_command_line) {
  Options o;
  set_option(o, "size.hmax", "5%");
  EXPECT_EQ(o.size.hmax->unit, "%");
  set_option(o, "size.hmax", "0.25");
  EXPECT_EQ(o.size.hmax->value, 0.25);
  set_option(o, "improve.enabled", "false");
  EXPECT_FALSE(o.improve.enabled);
  set_option(o, "output.files", "[\"a.vtu\", 'b.su2']");
  EXPECT_EQ(o.output.files, (std::vector<std::string>{"a.vtu", "b.su2"}));
  set_option(o, "output.files", "c.vtu");
  EXPECT_EQ(o.output.files, std::vector<std::string>{"c.vtu"});
  set_option(o, "limits.max_cells", "5e6");
  EXPECT_EQ(o.limits.max_cells, 5000000u);
  set_option(o, "boundaries.wing.kind", "wall");
  set_option(o, "boundaries.wing.select", "OML*");
  ASSERT_EQ(o.boundaries.size(), 1u);
  EXPECT_EQ(o.boundaries[0].select, std::vector<std::string>{"OML*"});
  set_option(o, "domain.enclose", "{ shape = \"box\", size = \"10c\" }");
  EXPECT_EQ(o.domain.enclose.shape, "box");
  set_option(o, "domain.keep", "1,2,3");
  EXPECT_EQ(o.domain.keep_points.at(0), (Point{1, 2, 3}));
  EXPECT_THROW(set_option(o, "size.hmaxx", "1"), UsageError);
  EXPECT_THROW(set_option(o, "size.hmax", "{"), UsageError);
  EXPECT_THROW(set_option(o, "size.growth", ""), UsageError);
  EXPECT_THROW(set_option(o, "", "1"), UsageError);
  EXPECT_THROW(set_option(o, "size.growth", "1.2\nhmax = 3"), UsageError);
}

TEST(SetOption, changes_keys_of_entries_that_a_list_has) {
  Options o = read("case.toml", R"([[size.box]]
min = [0, 0, 0]
max = [1, 1, 1]
h = 1
[[size.box]]
shape = "sphere"
centre = [0, 0, 0]
radius = 1
h = "5%"
[[size.source]]
type = "point"
at = [[0, 0, 0]]
delta0 = 1
)");
  set_option(o, "size.box[1].h", "0.25");
  set_option(o, "size.box[0].max", "[2, 3, 4]");
  set_option(o, "size.box[1]", "{ centre = [1, 2, 3], radius = 2 }");
  set_option(o, "size.source[0].law", "exponential");
  ASSERT_EQ(o.size.boxes.size(), 2u);
  const auto said = [&](const char* table) { return to_toml(*option_tree(o).find("size")->find(table)); };
  EXPECT_EQ(said("box"),
            "[{ shape = \"box\", min = [0, 0, 0], max = [2, 3, 4], radius_to = 0, h = 1 }, "
            "{ shape = \"sphere\", centre = [1, 2, 3], radius = 2, radius_to = 0, h = 0.25 }]");
  EXPECT_SAYS(said("source"), "type = \"exponential\"");
  EXPECT_EQ(o.set_at.at("size.box[1].h"), "");
  EXPECT_SAYS(o.set_at.at("size.box[0].h"), ":4");
  const auto refused = [&](const std::string& key, const std::string& value = "1") {
    return fixtures::message_of<UsageError>([&] { set_option(o, key, value); });
  };
  fixtures::expect_mentions(refused("size.box[2].h"), {"size.box[2].h", "the last entry is size.box[1]"});
  fixtures::expect_mentions(refused("size.box[0].hh"), {"unknown key 'size.box[0].hh'", "did you mean 'h'?"});
  fixtures::expect_mentions(refused("size.box[0].h", "-1"), {"size.box[0].h", "not positive"});
  for (const char* key : {"size.box[].h", "size.box[-1].h", "size.box[x]", "size.box[0", "size.box[0].", "size.box[0]h",
                          "size.box[99999999999999999999].h"})
    fixtures::expect_mentions(refused(key), {key, "size.box[0].KEY"});
  set_option(o, "size.box", "[]");
  fixtures::expect_mentions(refused("size.box[0].h"), {"there are no entries of size.box yet"});
  EXPECT_FALSE(o.set_at.contains("size.box[0].h"));
}

TEST(Shorthand, farfield_reads_spheres_and_boxes) {
  const Shorthand* farfield = nullptr;
  for (const Shorthand& s : shorthand_table())
    if (s.flags == "--farfield") farfield = &s;
  ASSERT_TRUE(farfield);
  Options o;
  farfield->apply(o, "sphere:20c");
  EXPECT_EQ(o.domain.enclose.shape, "sphere");
  EXPECT_EQ(o.domain.enclose.size.value, 20);
  farfield->apply(o, "box:-1,-2,-3,1,2,3.5");
  EXPECT_EQ(o.domain.enclose.shape, "box");
  ASSERT_TRUE(o.domain.enclose.corners);
  EXPECT_EQ((*o.domain.enclose.corners)[5], 3.5);
  farfield->apply(o, "box:2");
  EXPECT_FALSE(o.domain.enclose.corners);
  for (const char* text : {"", "cube:2", "sphere", "sphere:", "sphere:0", "box:1,2,3", "box:1,1,1,0,2,2", "box:x"})
    EXPECT_THROW(farfield->apply(o, text), UsageError) << text;
}

/// Options that differ from the defaults in every row that the table has.
Options unusual_options() {
  Options o;
  const std::pair<const char*, const char*> settings[] = {
      {"stop_after", "improve"},
      {"input.files", "[\"/a b.stl\", \"/c\\\"d.stl\"]"},
      {"input.units", "in"},
      {"input.feature_angle", "33.3"},
      {"domain.keep", "{ point = [[0.1, 2, 3], [4, 5, 6e-20]] }"},
      {"domain.enclose.shape", "box"},
      {"domain.enclose.size", "7.5c"},
      {"domain.enclose.corners", "[-1, -1, -1, 1, 1, 0.30000000000000004]"},
      {"domain.enclose.name", "outer wall"},
      {"domain.enclose.h", "3 mm"},
      {"size.hmin", "1e-7"},
      {"size.hmax", "12.5%"},
      {"size.growth", "1.1"},
      {"size.without", "[\"wake*\"]"},
      {"size.time", "0.5"},
      {"size.curvature", "18"},
      {"size.angle", "12"},
      {"size.deviation", "0.01%"},
      {"size.angle_form", "tangent"},
      {"size.accuracy", "fine"},
      {"size.automatic", "true"},
      {"size.gap", "3"},
      {"size.gap.hmin", "1e-4"},
      {"size.proximity.cells", "2.5"},
      {"size.proximity.hmin", "1e-5"},
      {"size.expression", "0.01 + 0.1*abs(z)"},
      {"size.expression.s1", "10"},
      {"size.expression.s2", "2 + x"},
      {"size.expression.first", "[\"1\", \"0\", \"0\"]"},
      {"size.expression.second", "[\"0\", \"1\", \"0\"]"},
      {"size.background", "/bg.vtu"},
      {"size.background.size", "spacing"},
      {"size.background.metric", "M"},
      {"size.background.combine", "alone"},
      {"size.background.factor", "0.5"},
      {"size.solution.file", "/flow.vtu"},
      {"size.solution.sensor", "Mach"},
      {"size.solution.indicator", "error"},
      {"size.solution.norm", "4"},
      {"size.solution.complexity", "2e5"},
      {"size.solution.hgrad", "1.3"},
      {"size.solution.error", "0.2"},
      {"size.solution.stretched", "true"},
      {"size.adaptive.cells", "12"},
      {"size.adaptive.refine_above", "2"},
      {"size.adaptive.smooth", "true"},
      {"planar.boundary", "split"},
      {"planar.method", "front"},
      {"planar.min_angle", "25"},
      {"surface.method", "front"},
      {"surface.bridge", "false"},
      {"volume.method", "none"},
      {"volume.core", "false"},
      {"improve.enabled", "false"},
      {"refine.levels", "2"},
      {"refine.geometry", "/fine.stl"},
      {"improve.max_passes", "3"},
      {"improve.goals.min_dihedral", "9.5"},
      {"improve.goals.max_nonortho", "71"},
      {"limits.time", "10min"},
      {"limits.memory", "3GiB"},
      {"limits.max_cells", "123456789"},
      {"output.files", "[\"/x.su2\", \"/foam/\"]"},
      {"output.format", "msh"},
      {"output.units", "mm"},
      {"output.ascii", "true"},
      {"output.compress", "true"},
      {"output.sizes", "true"},
      {"output.msh_version", "2.2"},
      {"output.report", "/r.json"},
      {"output.defects", "/d.vtp"},
      {"output.require", "min_dihedral > 8"},
  };
  for (const auto& [key, value] : settings) set_option(o, key, value);
  set_option(o, "boundaries.wing.select", "O?L*");
  set_option(o, "boundaries.wing.kind", "wall");
  set_option(o, "boundaries.tip.select", "{ id = [3, 4] }");
  set_option(o, "boundaries.root.select", "{ normal = [0, -1, 0] }");
  set_option(o, "boundaries.red.select", "{ colour = ['#ff0000', 'colour_00FF00'] }");
  set_option(o, "boundaries.low.select", "{ box = { min = [0, -1, 0], max = [1, 2.5, 0] } }");
  set_option(o, "boundaries.ends.select", "{ near = [[0, 1, 2], [3, 4, 5]] }");
  set_option(o, "boundaries.below.select", "{ expression = 'z < 0.1' }");
  set_option(o, "size.on.'le*'.h", "0.5%");
  set_option(
      o, "size.source",
      "[{ type = 'point', at = [[1, 2, 3]], delta0 = '1%', r0 = 0, r1 = '2 mm', law = 'exponential', group = 'a' "
      "}, { type = 'surface', file = '/w.stl', delta0 = 2, law = { type = 'polynomial', coefficients = [0, 1e-20] "
      "}, stretch = { s1 = 10, first = [0, 0, 1] }, motion = { velocity = [1, 0, 0], axis = [0, 0, 1], rate = 90 "
      "} }]");
  set_option(
      o, "size.box",
      "[{ min = [0, 0, 0], max = [1, 1, 2], h = '5%' }, { shape = 'cone', from = [0, 0, 0], to = [0, 0, 1], radius "
      "= 1, radius_to = 0.25, centre = [0, 0, 9], file = '/x.stl', h = 1 }]");
  set_option(
      o, "planar.curve",
      "[{ name = 'wing', at = [[0, 0], [1, 0.1], [0.5, 1]], closed = true, h = '1%' }, { type = 'line', at = [[0, "
      "0], [1, 2]] }]");
  o.boundaries.push_back({"two words.", {"a b", "c*"}, "inlet"});
  return o;
}

TEST(Boundaries, a_selector_set_again_forgets_the_one_before) {
  Options o;
  set_option(o, "boundaries.wing.kind", "wall");
  for (const char* selector : {"{ id = [3, 4] }", "{ box = { min = [0, 0, 0], max = [1, 1, 1] } }",
                               "{ near = [0, 0, 1] }", "{ colour = 'ff8000' }"})
    set_option(o, "boundaries.wing.select", selector);
  ASSERT_EQ(o.boundaries.size(), 1u);
  const BoundaryOptions& b = o.boundaries[0];
  EXPECT_EQ(b.colours, std::vector<std::string>{"FF8000"});
  EXPECT_TRUE(b.faces.empty() && !b.box && b.near.empty() && b.select.empty());
  EXPECT_EQ(b.kind, "wall");
  set_option(o, "boundaries.wing.select", "OML*");
  EXPECT_FALSE(o.boundaries[0].selects_faces());
}

TEST(PrintConfig, read_back_gives_the_same_options) {
  const Options unusual = unusual_options(), defaults;
  for (const OptionRow& row : option_table())
    EXPECT_NE(to_toml(row.get(unusual)), to_toml(row.get(defaults))) << row.key << " is not in the test";
  for (const EntryTable& table : entry_tables())
    for (const EntryRow& row : table.rows) {
      std::size_t set = 0;
      for (std::size_t i = 0; i < table.count(unusual); ++i)
        set += row.get(unusual, i).is(JobValue::Kind::none) ? 0 : 1;
      EXPECT_GT(set, 0u) << table.key << "." << row.name << " is not in the test";
    }
  for (const Options& options : std::vector<Options>{defaults, unusual}) {
    const std::string text = print_config(options);
    const Options again = read("effective.toml", text);
    EXPECT_EQ(print_config(again), text);
    EXPECT_EQ(to_toml(option_tree(again)), to_toml(option_tree(options)));
  }
}

TEST(PrintConfig, shows_every_key) {
  const Options defaults;
  const std::string text = print_config(defaults);
  for (const OptionRow& row : option_table()) {
    const std::size_t dot = row.key.find_last_of('.');
    EXPECT_SAYS(text, (dot == std::string::npos ? row.key : row.key.substr(dot + 1)) + " = ");
  }
}

}  // namespace
}  // namespace delfront
