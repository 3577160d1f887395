// SPDX-License-Identifier: Apache-2.0
// Airfoil coordinates and Triangle's .poly: what is read, and what is refused with its line.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "io/formats.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

struct Read {
  Mesh mesh;
  std::vector<std::string> warnings;
};

Read read_dat_text(const std::string& text) {
  Read result;
  Context context;
  context.on_log = [&](LogLevel, const std::string& message) { result.warnings.push_back(message); };
  result.mesh = read_dat(text, "foil.dat", context);
  return result;
}

std::string refusal_of(Reader reader, const std::string& text) {
  Context context;
  try {
    reader(text, "file", context);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

double area_of(const Mesh& mesh) {
  const CellBlock& lines = *mesh.find_block(CellType::line);
  double area = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Point a = mesh.points[lines[i][0]], b = mesh.points[lines[i][1]];
    area += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return area;
}

const char* const kSelig = "a section\n1 0.01\n0.5 0.06\n0 0\n0.5 -0.06\n1 -0.01\n";

TEST(ReadDat, D5_selig_with_an_open_trailing_edge_is_closed) {
  const Read read = read_dat_text(kSelig);
  EXPECT_EQ(read.mesh.dimension, 2);
  EXPECT_EQ(read.mesh.points.size(), 5u);
  EXPECT_EQ(read.mesh.num_cells(CellType::line), 5u);
  EXPECT_NEAR(area_of(read.mesh), 0.065, 1e-15);
  EXPECT_TRUE(read.warnings.empty());
}

TEST(ReadDat, D5_lednicer_reads_as_selig) {
  const Mesh lednicer = read_dat_text("a section\n  3.  3.\n\n0 0\n0.5 0.06\n1 0.01\n\n0 0\n0.5 -0.06\n1 -0.01\n").mesh;
  EXPECT_EQ(lednicer.points, read_dat_text(kSelig).mesh.points);
}

TEST(ReadDat, D5_without_a_name_with_commas_and_windows_lines) {
  const Mesh mesh = read_dat_text("1, 0.01\r\n0.5, 0.06\r\n0, 0\r\n0.5, -0.06\r\n1, -0.01\r\n").mesh;
  EXPECT_EQ(mesh.points, read_dat_text(kSelig).mesh.points);
}

TEST(ReadDat, D5_a_closed_outline_has_no_point_twice) {
  EXPECT_EQ(read_dat_text("x\n1 0\n0.5 0.06\n0 0\n0.5 -0.06\n1 0\n").mesh.points.size(), 4u);
}

TEST(ReadDat, D5_several_elements) {
  const Mesh mesh = read_dat_text("x\n1 0\n0.5 0.06\n0 0\n999 999\n2 0\n1.6 0.06\n1.5 0\n").mesh;
  EXPECT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.groups.size(), 2u);
}

TEST(ReadDat, D5_what_is_odd_is_said) {
  const Read turned = read_dat_text("x\n1 0\n0.6 0.06\n0.7 0.06\n0 0\n0.5 -0.06\n");
  ASSERT_FALSE(turned.warnings.empty());
  EXPECT_NE(turned.warnings[0].find("line 3"), std::string::npos) << turned.warnings[0];
  EXPECT_FALSE(read_dat_text("x\n1 0.2\n0.5 0.06\n0 0\n0.5 -0.06\n1 -0.2\n").warnings.empty());
  EXPECT_FALSE(read_dat_text("x\n0 0\n1 0\n1 1\n0 1\n").warnings.empty()) << "a side is missing";
  EXPECT_TRUE(read_dat_text("x\n0 0\n1 0\n1 1\n0 1\n0 0\n").warnings.empty()) << "closed by its last point";
  EXPECT_EQ(read_dat_text("x\n0 0\n1 0\n1 1\n999 999\n3 0\n4 0\n4 1\n3 0\n").warnings.size(), 1u) << "the first";
}

TEST(ReadDat, D5_malformed_files_are_refused_with_the_line) {
  EXPECT_NE(refusal_of(read_dat, "x\n1 0\n0.5 o.06\n0 0\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal_of(read_dat, "x\n1 0\n0.5\n0 0\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal_of(read_dat, "x\n1 0 3\n0.5 1\n0 0\n").find("line 2"), std::string::npos);
  EXPECT_NE(refusal_of(read_dat, "x\n4. 5.\n0.5 1\n0 0\n").find("announces 4 + 5"), std::string::npos);
  EXPECT_NE(refusal_of(read_dat, "x\n1 0\nnan 1\n0 0\n").find("not finite"), std::string::npos);
  EXPECT_NE(refusal_of(read_dat, "only a name\n").find("no coordinates"), std::string::npos);
  EXPECT_NE(refusal_of(read_dat, "").find("no coordinates"), std::string::npos);
  EXPECT_NE(refusal_of(read_dat, "x\n1 0\n2 0\n").find("fewer than three"), std::string::npos);
}

TEST(ReadDat, D5_shared_sections) {
  DELFRONT_NEEDS_SHARED_DATA(shared);
  Context context;
  const auto read = [&](const char* name) { return read_mesh((*shared / name).string(), context); };
  // From the folder's README.md: points and areas. A first point that is also the last is there once.
  EXPECT_EQ(read("airfoil/naca0012.dat").points.size(), 69u);
  EXPECT_NEAR(area_of(read("airfoil/naca0012.dat")), 0.08209, 5e-6);
  EXPECT_EQ(read("airfoil/rae2822.dat").points.size(), 128u);
  EXPECT_NEAR(area_of(read("airfoil/rae2822.dat")), 0.07784, 5e-6);
  EXPECT_NEAR(area_of(read("airfoil/s1223.dat")), 0.06492, 5e-6);
  EXPECT_NEAR(area_of(read("synthetic/naca0012_sharp_selig.dat")), 0.081685, 5e-7);
  EXPECT_GT(area_of(read("synthetic/naca0012_blunt_lednicer.dat")), 0.08);
}

const char* const kPoly =
    "# a square with a hole and two regions\n"
    "8 2 0 1\n"
    "1 0 0 1\n2 4 0 1\n3 4 4 1\n4 0 4 1\n5 1 1 2\n6 2 1 2\n7 2 2 2\n8 1 2 2\n"
    "8 1\n1 1 2 1\n2 2 3 1\n3 3 4 1\n4 4 1 1\n5 5 6 2\n6 6 7 2\n7 7 8 2\n8 8 5 0\n"
    "1\n1 1.5 1.5\n"
    "1\n1 3 3 7 0.433\n";

TEST(ReadPoly, T2_planar_files_of_triangle) {
  Context context;
  const Mesh mesh = read_poly(kPoly, "square.poly", context);
  EXPECT_EQ(mesh.dimension, 2);
  EXPECT_EQ(mesh.num_cells(CellType::line), 8u);
  EXPECT_EQ(mesh.num_cells(CellType::vertex), 2u);
  const GroupId hole = mesh.find_group(0, "holes"), region = mesh.find_group(0, "region_7");
  ASSERT_TRUE(hole.is_valid() && region.is_valid());
  EXPECT_EQ(mesh.groups[hole].kind, "hole");
  EXPECT_EQ(mesh.groups[region].kind, "region");
  ASSERT_EQ(mesh.fields.size(), 1u);
  EXPECT_NEAR(mesh.fields[0].values.back(), 1.0, 1e-3);  // the side of a regular triangle of area 0.433
}

TEST(ReadPoly, T2_malformed_planar_files_are_refused) {
  EXPECT_NE(refusal_of(read_poly, "0 2 0 0\n").find(".node"), std::string::npos);
  EXPECT_NE(refusal_of(read_poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n0 0\n0\n").find("no segments"), std::string::npos);
  EXPECT_NE(refusal_of(read_poly, "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n1 0\n1 1 4\n0\n").find("line 6"), std::string::npos);
  EXPECT_NE(refusal_of(read_poly, "3 2 0 0\n1 0 0\n2 1 0\n5 0 1\n").find("numbered"), std::string::npos);
}

}  // namespace
}  // namespace delfront
