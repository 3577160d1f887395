// SPDX-License-Identifier: Apache-2.0
// Values on nodes come through reading and writing.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

const Field& field_of(const Mesh& mesh, const std::string& name) {
  for (const Field& field : mesh.fields)
    if (field.name == name && field.on == Field::On::vertices) return field;
  ADD_FAILURE() << "no node field " << name;
  static const Field kNone;
  return kNone;
}

std::string message_of(const std::string& name, const std::string& text) {
  return message_of_reading<InputError>(write_text(name, text));
}

Mesh read(const std::filesystem::path& path, Recorder& recorder) { return read_mesh(path.string(), recorder.context); }

TEST(NodeFields, vtk_keeps_one_to_nine_components) {
  Mesh mesh = two_boxes();
  for (int components : {1, 3, 6, 9}) {
    Field field{fmt::format("f{}", components), Field::On::vertices, CellType::vertex, components, {}};
    for (std::size_t i = 0; i < mesh.points.size() * std::size_t(components); ++i)
      field.values.push_back(std::sin(double(i)) / 3);
    mesh.fields.push_back(field);
  }
  for (const std::string name : {"m.vtu", "m.vtp"})
    for (const WriteOptions& options : {WriteOptions{.binary = true, .version = "", .compress = false},
                                        WriteOptions{.binary = false, .version = "", .compress = false},
                                        WriteOptions{.binary = true, .version = "", .compress = true}}) {
      const Mesh back = round_trip(mesh, name, options);
      ASSERT_EQ(back.fields.size(), 4u);
      for (const Field& field : mesh.fields) {
        EXPECT_EQ(field_of(back, field.name).components, field.components);
        EXPECT_EQ(field_of(back, field.name).values, field.values) << name;
      }
    }
}

const char* const kMsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 1 1 0\n$EndNodes\n"
    "$Elements\n2\n7 2 2 0 1 10 20 30\n9 2 2 0 1 20 40 30\n$EndElements\n";
const char* const kMsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 10 40\n2 1 0 4\n10\n20\n30\n40\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
    "$EndNodes\n$Elements\n1 2 7 9\n2 1 2 2\n7 10 20 30\n9 20 40 30\n$EndElements\n";

std::string view(const std::string& section, const std::string& name, int components, int entries,
                 const std::string& values, double time = 0) {
  return fmt::format("${0}\n1\n\"{1}\"\n1\n{2}\n3\n0\n{3}\n{4}\n{5}${6}\n", section, name, time, components, entries,
                     values, "End" + section);
}

TEST(NodeFields, msh_node_data_by_tag) {
  for (const std::string mesh : {kMsh2, kMsh4}) {
    Recorder recorder;
    const Mesh got = read(write_text("a.msh", mesh + view("NodeData", "my size", 1, 4, "40 .4\n10 .1\n20 .2\n30 .3\n") +
                                                  view("NodeData", "v", 3, 3, "10 1 2 3\n20 4 5 6\n30 7 8 9\n")),
                          recorder);
    EXPECT_EQ(field_of(got, "my size").values, (std::vector<double>{.1, .2, .3, .4}));
    const Field& v = field_of(got, "v");
    EXPECT_EQ(v.components, 3);
    EXPECT_EQ((std::vector<double>(v.values.begin(), v.values.begin() + 9)),
              (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    for (int k = 9; k < 12; ++k) EXPECT_TRUE(std::isnan(v.values[std::size_t(k)]));
    EXPECT_TRUE(recorder.warnings.empty());
  }
}

TEST(NodeFields, msh_element_node_data_are_means) {
  for (const std::string mesh : {kMsh2, kMsh4}) {
    Recorder recorder;
    const Mesh got =
        read(write_text("a.msh", mesh + view("ElementNodeData", "h", 1, 2, "9 3 .2 .4 .3\n7 3 .1 .4 .3\n")), recorder);
    const std::vector<double> values = field_of(got, "h").values;
    EXPECT_EQ(values.size(), 4u);
    EXPECT_DOUBLE_EQ(values[0], .1);
    EXPECT_DOUBLE_EQ(values[1], .3);  // of .4 and .2
    EXPECT_DOUBLE_EQ(values[2], .3);
    EXPECT_DOUBLE_EQ(values[3], .4);
    ASSERT_EQ(recorder.warnings.size(), 1u);
    expect_mentions(recorder.warnings[0], {"'h'", "differ", "mean"});
  }
}

TEST(NodeFields, msh_latest_time_step_is_kept) {
  Recorder recorder;
  const Mesh got = read(write_text("a.msh", kMsh2 + view("NodeData", "h", 1, 4, "10 1\n20 1\n30 1\n40 1\n", 2) +
                                                view("NodeData", "h", 1, 4, "10 2\n20 2\n30 2\n40 2\n", 1)),
                        recorder);
  EXPECT_EQ(field_of(got, "h").values, (std::vector<double>(4, 1)));
  ASSERT_EQ(recorder.warnings.size(), 1u);
  expect_mentions(recorder.warnings[0], {"'h'", "several times", "latest"});
}

TEST(NodeFields, msh_binary) {
  std::string text = "$MeshFormat\n2.2 1 8\n";
  const auto put = [&](auto value) { text.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  put(1);
  text += "\n$EndMeshFormat\n$Nodes\n3\n";
  for (int i = 1; i <= 3; ++i) {
    put(i);
    for (double x : {double(i == 2), double(i == 3), 0.0}) put(x);
  }
  text += "\n$EndNodes\n$Elements\n1\n";
  for (int i : {2, 1, 2, 7, 0, 1, 1, 2, 3}) put(i);
  text += "\n$EndElements\n$NodeData\n1\n\"h\"\n1\n0\n3\n0\n1\n3\n";
  for (int i = 3; i >= 1; --i) {
    put(i);
    put(i / 10.0);
  }
  text += "\n$EndNodeData\n";
  Recorder recorder;
  EXPECT_EQ(field_of(read(write_text("b.msh", text), recorder), "h").values, (std::vector<double>{.1, .2, .3}));
}

TEST(NodeFields, msh_defects_are_named) {
  const std::string mesh = kMsh2;
  expect_mentions(message_of("a.msh", mesh + view("NodeData", "h", 1, 1, "50 1\n")), {"'h'", "node 50"});
  expect_mentions(message_of("a.msh", mesh + view("ElementNodeData", "h", 1, 1, "8 3 1 1 1\n")), {"'h'", "element 8"});
  expect_mentions(message_of("a.msh", mesh + view("ElementNodeData", "h", 1, 1, "7 2 1 1\n")),
                  {"2 corners", "triangle"});
  expect_mentions(message_of("a.msh", mesh + view("NodeData", "h", 0, 1, "10 1\n")), {"number of components"});
  expect_mentions(message_of("a.msh", mesh + view("NodeData", "h", 1, 1, "10 x\n")), {"'x'"});
  expect_mentions(message_of("a.msh", mesh + "$NodeData\n1\n\"h\"\n1\n0\n3\n0\n1\n99999\n10 1\n"), {"99999"});
}

TEST(NodeFields, pos_cells_are_welded) {
  Recorder recorder;
  const Mesh got = read(write_text("bg.pos",
                                   "/* made by hand */\nView \"background size\" {\n"
                                   "SS(0,0,0, 1,0,0, 0,1,0, 0,0,1){.1,.2,.3,.4};\n"
                                   "SS(1,0,0,0,1,0,0,0,1,1,1,1){.2,.3,.4,5e-1}; // the second\n};\n"),
                        recorder);
  EXPECT_EQ(got.dimension, 3);
  EXPECT_EQ(got.points.size(), 5u);
  EXPECT_EQ(got.num_cells(CellType::tetrahedron), 2u);
  const std::vector<double> want{.1, .2, .3, .4, .5}, values = field_of(got, "background size").values;
  for (std::size_t i = 0; i < 5; ++i) EXPECT_DOUBLE_EQ(values[i], want[i]);
  EXPECT_TRUE(recorder.warnings.empty());
}

TEST(NodeFields, pos_all_cells_and_views) {
  Recorder recorder;
  const Mesh got =
      read(write_text("bg.pos",
                      "View \"a\" { ST(0,0,0,1,0,0,0,1,-0.){1,2,3}; SQ(1,0,0,2,0,0,2,1,0,0,1,0){2,1,1,3}; };\n"
                      "View \"b\" { VT(0,0,0,1,0,0,0,1,0){1,0,0,2,0,0,3,0,0}; SP(0,0,0){7};\n"
                      "TIME{0}; ST(0,0,0,1,0,0,0,1,0){1,2,3, 4,5,6}; };"),
           recorder);
  EXPECT_EQ(got.dimension, 2);
  EXPECT_EQ(got.points.size(), 5u);
  EXPECT_EQ(got.num_cells(CellType::triangle), 1u);
  EXPECT_EQ(got.num_cells(CellType::quad), 1u);
  EXPECT_EQ(got.num_cells(CellType::vertex), 1u);
  EXPECT_EQ(field_of(got, "b").components, 3);
  EXPECT_EQ(field_of(got, "b_1").values[0], 4);  // the mean of 7 and 1
  ASSERT_EQ(recorder.warnings.size(), 2u);       // several time steps; values that differ
  const Mesh volumes = read(
      write_text(
          "v.pos",
          "View \"a\" { SH(0,0,0,1,0,0,1,1,0,0,1,0,0,0,1,1,0,1,1,1,1,0,1,1){1,1,1,1,1,1,1,1};"
          "SI(1,0,0,2,0,0,1,1,0,1,0,1,2,0,1,1,1,1){1,1,1,1,1,1}; SY(0,0,1,1,0,1,1,1,1,0,1,1,.5,.5,2){1,1,1,1,1};};"),
      recorder);
  EXPECT_EQ(volumes.num_cells(CellType::hexahedron), 1u);
  EXPECT_EQ(volumes.num_cells(CellType::prism), 1u);
  EXPECT_EQ(volumes.num_cells(CellType::pyramid), 1u);
  EXPECT_EQ(volumes.points.size(), 11u);
}

TEST(NodeFields, pos_in_msh_format) {
  Recorder recorder;
  const Mesh got = read(write_text("a.pos", kMsh2 + view("NodeData", "h", 1, 4, "10 1\n20 2\n30 3\n40 4\n")), recorder);
  EXPECT_EQ(field_of(got, "h").values, (std::vector<double>{1, 2, 3, 4}));
}

TEST(NodeFields, pos_defects_are_named) {
  expect_mentions(message_of("a.pos", "$PostFormat\n1.4 0 8\n"), {"$PostFormat", "parsed view"});
  expect_mentions(message_of("a.pos", "Vew \"a\" {};"), {"'Vew'", "line 1"});
  expect_mentions(message_of("a.pos", "View \"a\" {\nST(0,0,0){1};};"), {"3 coordinates", "triangle", "line 2"});
  expect_mentions(message_of("a.pos", "View \"a\" {\nSP(0,0,0){};};"), {"0 values"});
  expect_mentions(message_of("a.pos", "View \"a\" {\nSP(0,0,0){1,2"), {"truncated"});
  expect_mentions(message_of("a.pos", "View \"a\" {\nST2(0,0,0){1};};"), {"'ST2'", "linear"});
  expect_mentions(message_of("a.pos", "View \"a\" {\nSP(0,0,a){1};};"), {"'a'", "number"});
  expect_mentions(message_of("a.pos", "View \"a\" {};"), {"no view with cells"});
  expect_mentions(message_of("a.pos", "View \"a\" {SP(0,0,nan){1};};"), {"not finite"});
}

const char* const kTet =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 "
    "0\nEnd\n";
const char* const kSolHead = "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n";

TEST(NodeFields, medit_solution_beside_its_mesh) {
  const std::filesystem::path mesh = write_text("a.mesh", kTet);
  const auto write_beside = [&](const std::string& name, const std::string& text) {
    std::ofstream(mesh.parent_path() / name, std::ios::binary) << text;
  };
  Recorder recorder;
  EXPECT_TRUE(read(mesh, recorder).fields.empty());
  write_beside("a.sol", std::string(kSolHead) + "4\n1 1\n.1\n.2\n.3\n4e-1\nEnd\n");
  EXPECT_EQ(field_of(read(mesh, recorder), "sol").values, (std::vector<double>{.1, .2, .3, .4}));
  write_beside("a.sol", std::string(kSolHead) + "4\n2 3 1\n" + "11 12 22 13 23 33 5\n11 12 22 13 23 33 6\n" +
                            "11 12 22 13 23 33 7\n11 12 22 13 23 33 8\nEnd\n");
  const Mesh got = read(mesh, recorder);
  const Field& metric = field_of(got, "sol1");
  EXPECT_EQ(metric.components, 6);
  EXPECT_EQ((std::vector<double>(metric.values.begin(), metric.values.begin() + 6)),
            (std::vector<double>{11, 22, 33, 12, 23, 13}));
  EXPECT_EQ(field_of(got, "sol2").values, (std::vector<double>{5, 6, 7, 8}));
  EXPECT_TRUE(recorder.warnings.empty());
  write_beside("a.sol", std::string(kSolHead) + "3\n1 1\n1\n1\n1\nEnd\n");
  EXPECT_TRUE(read(mesh, recorder).fields.empty());
  ASSERT_EQ(recorder.warnings.size(), 1u);
  expect_mentions(recorder.warnings[0], {"a.sol", "3 nodes", "4 points"});
  write_beside("a.sol", std::string(kSolHead) + "4\n1 4\n1\n");
  expect_mentions(message_of_reading<InputError>(mesh), {"a.sol", "type of a solution"});
  write_beside("a.sol", std::string(kSolHead) + "4\n1 1\n1\n");
  expect_mentions(message_of_reading<InputError>(mesh), {"a.sol", "value of a solution"});
}

TEST(NodeFields, medit_solutions_called_binary_may_be_text) {
  const std::filesystem::path mesh = write_text("b.mesh", kTet);
  const auto write_beside = [&](const std::string& text) {
    std::ofstream(mesh.parent_path() / "b.solb", std::ios::binary) << text;
  };
  Recorder recorder;
  write_beside(std::string("\1\0\0\0\2\0\0\0", 8));
  EXPECT_TRUE(read(mesh, recorder).fields.empty());
  EXPECT_TRUE(recorder.warnings.empty());
  write_beside("rubbish of more than eight bytes");
  expect_mentions(message_of_reading<InputError>(mesh), {"b.solb", "damaged"});
  write_beside(std::string(kSolHead) + "4\n1 1\n.1\n.2\n.3\n.4\nEnd\n");
  EXPECT_EQ(field_of(read(mesh, recorder), "sol").values, (std::vector<double>{.1, .2, .3, .4}));
}

TEST(NodeFields, medit_plane_metric) {
  const std::filesystem::path mesh = write_text(
      "p.mesh", "MeshVersionFormatted 2\nDimension 2\nVertices\n3\n0 0 0\n1 0 0\n0 1 0\nTriangles\n1\n1 2 3 0\nEnd\n");
  std::ofstream(mesh.parent_path() / "p.sol")
      << "MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n3\n1 3\n1 2 3\n1 2 3\n1 2 3\nEnd\n";
  Recorder recorder;
  const Mesh got = read(mesh, recorder);
  EXPECT_EQ(field_of(got, "sol").components, 3);
  EXPECT_EQ(field_of(got, "sol").values, (std::vector<double>{1, 2, 3, 1, 2, 3, 1, 2, 3}));
}

TEST(NodeFields, medit_solutions_come_back_beside_their_mesh) {
  const std::filesystem::path folder = scratch_folder("io_sol");
  for (const int dimension : {2, 3})
    for (const auto& [grid, solution] : {std::pair("a.mesh", "a.sol"), std::pair("b.meshb", "b.solb")}) {
      Mesh mesh = dimension == 3 ? two_boxes() : plane_grid();
      const int tensor = dimension * (dimension + 1) / 2;
      for (const int components : {1, dimension, tensor, 7}) {
        Field field{fmt::format("f{}", components), Field::On::vertices, CellType::vertex, components, {}};
        for (std::size_t i = 0; i < mesh.points.size() * std::size_t(components); ++i)
          field.values.push_back(1 / (double(i) + 3));
        mesh.fields.push_back(std::move(field));
      }
      Recorder recorder;
      write_mesh(mesh, (folder / grid).string(), recorder.context);
      const std::vector<std::string> notes = write_mesh(mesh, (folder / solution).string(), recorder.context);
      ASSERT_EQ(notes.size(), 2u);
      expect_mentions(notes[0],
                      {"f1 (scalar)", fmt::format("f{} (vector)", dimension), fmt::format("f{} (tensor)", tensor)});
      expect_mentions(notes[1], {"1 field(s)", "left out"});
      const Mesh got = read_mesh((folder / grid).string(), recorder.context);
      ASSERT_EQ(got.fields.size(), 3u);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(got.fields[i].components, mesh.fields[i].components);
        EXPECT_EQ(got.fields[i].values, mesh.fields[i].values);
      }
    }
  Context context;
  EXPECT_THROW(write_mesh(two_boxes(), (folder / "c.sol").string(), context), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "c.sol"));
}

}  // namespace
}  // namespace delfront
