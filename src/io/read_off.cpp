// SPDX-License-Identifier: Apache-2.0
// OFF and its variants with normals, colours or texture coordinates (NOFF, COFF, STOFF, …), whose extras are skipped.
#include <fmt/format.h>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

void read_header(Cursor& cursor) {
  const std::string_view word = cursor.next();
  if (!word.ends_with("OFF"))
    cursor.fail(fmt::format("an OFF file begins with OFF, this with '{}'", word.substr(0, 20)));
  const std::string_view kind = word.substr(0, word.size() - 3);
  if (kind.find('n') != std::string_view::npos || kind.find('4') != std::string_view::npos)
    cursor.fail(fmt::format("{} has points that are not of three coordinates; convert it to OFF", word));
  if (kind.find_first_not_of("STCN") != std::string_view::npos)
    cursor.fail(fmt::format("'{}' is no kind of OFF file known here", word.substr(0, 20)));
  if (cursor.peek() == "BINARY") cursor.fail("binary OFF is not read; convert it to text OFF, PLY or STL");
}

void read_face(Cursor& cursor, Mesh& mesh, std::vector<VertexId>& corners) {
  const std::size_t n = cursor.count("number of a face's corners", 2);
  if (n < 3) cursor.fail(fmt::format("a face needs three corners or more, this has {}", n));
  corners.clear();
  for (std::size_t k = 0; k < n; ++k)
    corners.push_back(VertexId(
        static_cast<std::size_t>(cursor.integer_in("vertex", 0, static_cast<std::int64_t>(mesh.points.size()) - 1))));
  cursor.skip_line();  // colour
  add_face(mesh, corners, GroupId(0));
}

}  // namespace

Mesh read_off(std::string_view bytes, const std::string& path, Context& context) {
  Cursor cursor(bytes, path, "#");
  read_header(cursor);
  const std::size_t num_points = cursor.count("number of vertices", 6);
  const std::size_t num_faces = cursor.count("number of faces", 2);
  if (!cursor.at_line_end()) cursor.integer("number of edges");
  cursor.skip_line();
  if (num_faces == 0) throw InputError(fmt::format("{}: the OFF file has no faces", path));
  Mesh mesh;
  mesh.groups.push_back({"", 2, "", false});
  mesh.points.reserve(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    Point p;
    for (int k = 0; k < 3; ++k) p[k] = cursor.number("coordinate of a vertex");
    cursor.skip_line();  // normal, colour, texture
    mesh.points.push_back(p);
  }
  std::vector<VertexId> corners;
  for (std::size_t i = 0; i < num_faces; ++i) {
    if (i % kCheckEvery == 0) context.check_limits();
    read_face(cursor, mesh, corners);
  }
  check_finite(mesh, path);
  return mesh;
}

}  // namespace delfront
