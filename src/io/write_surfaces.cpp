// SPDX-License-Identifier: Apache-2.0
// The writers of formats that hold faces only: STL, OBJ, PLY, OFF.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/names.hpp"
#include "io/output.hpp"
#include "io/surface_faces.hpp"

namespace delfront {

namespace {

constexpr std::string_view kStlNameMark = "delfront patch: ";
constexpr std::size_t kStlHeader = 80;

void write_coordinates(Output& out, Point p) {
  out.real(p.x);
  out.character(' ');
  out.real(p.y);
  out.character(' ');
  out.real(p.z);
}

bool fits_float(const Mesh& mesh, const SurfaceFaces& surface) {
  for (VertexId v : surface.points())
    for (int k = 0; k < 3; ++k)
      if (const double x = mesh.points[v][k]; static_cast<double>(static_cast<float>(x)) != x) return false;
  return true;
}

std::vector<std::array<VertexId, 3>> triangles_of(const Mesh& mesh, std::span<const VertexId> corners) {
  if (corners.size() == 3) return {{corners[0], corners[1], corners[2]}};
  return split_polygon(mesh, corners);
}

Point unit_normal(const Mesh& mesh, const std::array<VertexId, 3>& t) {
  const Point normal = cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
  const double size = length(normal);
  return size > 0 && std::isfinite(size) ? normal / size : Point{};
}

void write_stl_binary(const Mesh& mesh, const SurfaceFaces& surface, const std::string& name, Output& out) {
  char header[kStlHeader] = {};
  const std::string text = name.empty() ? "delfront" : std::string(kStlNameMark) + name;
  std::memcpy(header, text.data(), std::min(text.size(), sizeof(header)));
  out.bytes(header, sizeof(header));
  std::size_t count = 0;
  for (const SurfaceFaces::Face& face : surface.faces()) count += surface.corners(face).size() - 2;
  if (count > 0xffffffffu) throw InputError("binary STL holds at most 2^32 - 1 facets");
  out.binary(static_cast<std::uint32_t>(count));
  for (const SurfaceFaces::Face& face : surface.faces())
    for (const std::array<VertexId, 3>& t : triangles_of(mesh, surface.corners(face))) {
      const Point facet[4] = {unit_normal(mesh, t), mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
      for (const Point& p : facet)
        for (int k = 0; k < 3; ++k) out.binary(static_cast<float>(p[k]));
      out.binary(std::uint16_t{0});
    }
}

void write_facet(const Mesh& mesh, const std::array<VertexId, 3>& t, Output& out) {
  out.text("facet normal ");
  write_coordinates(out, unit_normal(mesh, t));
  out.text("\n outer loop\n");
  for (VertexId v : t) {
    out.text("  vertex ");
    write_coordinates(out, mesh.points[v]);
    out.character('\n');
  }
  out.text(" endloop\nendfacet\n");
}

void write_stl_text(const Mesh& mesh, const SurfaceFaces& surface, const std::vector<std::string>& names, Output& out) {
  const auto name_of_group = [&](GroupId group) { return group.is_valid() ? names[group.index()] : std::string(); };
  std::string open;
  GroupId last;
  bool is_open = false;
  for (const SurfaceFaces::Face& face : surface.faces()) {
    const GroupId group = surface.group(face);
    if (!is_open || group != last) {
      if (is_open) out.text(fmt::format("endsolid {}\n", open));
      open = name_of_group(group);
      out.text(fmt::format("solid {}\n", open));
      last = group;
      is_open = true;
    }
    for (const std::array<VertexId, 3>& t : triangles_of(mesh, surface.corners(face))) write_facet(mesh, t, out);
  }
  out.text(fmt::format("endsolid {}\n", open));
}

/// Unnamed groups stay unnamed here: readers name them by the file.
std::vector<std::string> names_or_empty(const Mesh& mesh, const char* format, std::vector<std::string>& notes) {
  std::vector<std::string> changes;
  std::vector<std::string> names = fit_names(mesh, NameRule::line, format, changes);
  for (const std::string& change : changes)
    if (change.find("an unnamed ") == std::string::npos) notes.push_back(change);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (mesh.groups[GroupId(i)].name.empty()) names[i].clear();
  return names;
}

std::string header_name(const Mesh& mesh) {
  std::string name;
  for (const Group& group : mesh.groups)
    if (group.dimension == 2) name = group.name;
  return name;
}

std::size_t num_groups_of_faces(const Mesh& mesh) {
  std::size_t n = 0;
  for (const Group& group : mesh.groups) n += group.dimension == 2;
  return n;
}

}  // namespace

void write_stl(const Mesh& mesh, Output& out, const WriteOptions& options, Context& context,
               std::vector<std::string>& notes) {
  context.check_limits();
  const SurfaceFaces surface(mesh, "STL", notes);
  const std::vector<std::string> names = names_or_empty(mesh, "STL", notes);
  // Binary STL has one nameless solid in single precision: it is used only where that loses nothing.
  const bool is_one = num_groups_of_faces(mesh) <= 1 && header_name(mesh).size() <= kStlHeader - kStlNameMark.size();
  if (options.binary && is_one && fits_float(mesh, surface))
    return write_stl_binary(mesh, surface, header_name(mesh), out);
  if (options.binary)
    notes.push_back(is_one ? "STL: written as text, since binary STL would round the coordinates to single precision"
                           : "STL: written as text, since binary STL holds no patch names");
  write_stl_text(mesh, surface, names, out);
}

void write_obj(const Mesh& mesh, Output& out, const WriteOptions&, Context& context, std::vector<std::string>& notes) {
  context.check_limits();
  const SurfaceFaces surface(mesh, "OBJ", notes);
  const std::vector<std::string> names = fit_names(mesh, NameRule::line, "OBJ", notes);
  out.text("# written by delfront\n");
  for (VertexId v : surface.points()) {
    out.text("v ");
    write_coordinates(out, mesh.points[v]);
    out.character('\n');
  }
  GroupId last;
  for (const SurfaceFaces::Face& face : surface.faces()) {
    if (const GroupId group = surface.group(face); group != last) {
      out.text(fmt::format("g {}\n", group.is_valid() ? names[group.index()] : ""));
      last = group;
    }
    out.character('f');
    for (VertexId v : surface.corners(face)) {
      out.character(' ');
      out.integer(static_cast<std::int64_t>(surface.number(v)) + 1);
    }
    out.character('\n');
  }
}

void write_ply(const Mesh& mesh, Output& out, const WriteOptions& options, Context& context,
               std::vector<std::string>& notes) {
  context.check_limits();
  const SurfaceFaces surface(mesh, "PLY", notes);
  const std::vector<std::string> names = names_or_empty(mesh, "PLY", notes);
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  out.text(fmt::format("ply\nformat {} 1.0\ncomment written by delfront\n",
                       options.binary ? "binary_little_endian" : "ascii"));
  for (std::size_t i = 0; i < names.size(); ++i)
    if (mesh.groups[GroupId(i)].dimension == 2)
      out.text(fmt::format("comment patch_name {} {}\n", number[i], names[i]));
  out.text(
      fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\n"
                  "property list int int vertex_indices\nproperty int patch_id\nend_header\n",
                  surface.points().size(), surface.faces().size()));
  for (VertexId v : surface.points()) {
    if (options.binary) {
      out.binary(mesh.points[v]);
      continue;
    }
    write_coordinates(out, mesh.points[v]);
    out.character('\n');
  }
  for (const SurfaceFaces::Face& face : surface.faces()) {
    const GroupId group = surface.group(face);
    std::vector<std::int32_t> row = {static_cast<std::int32_t>(surface.corners(face).size())};
    for (VertexId v : surface.corners(face)) row.push_back(static_cast<std::int32_t>(surface.number(v)));
    row.push_back(group.is_valid() ? number[group.index()] : -1);
    if (options.binary) {
      out.binary_all(std::span<const std::int32_t>(row));
      continue;
    }
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k > 0) out.character(' ');
      out.integer(row[k]);
    }
    out.character('\n');
  }
}

void write_off(const Mesh& mesh, Output& out, const WriteOptions&, Context& context, std::vector<std::string>& notes) {
  context.check_limits();
  const SurfaceFaces surface(mesh, "OFF", notes);
  if (num_groups_of_faces(mesh) > 1)
    notes.push_back(fmt::format("OFF: the names of {} patches are left out; OBJ, PLY and STL keep them",
                                num_groups_of_faces(mesh)));
  out.text(fmt::format("OFF\n{} {} 0\n", surface.points().size(), surface.faces().size()));
  for (VertexId v : surface.points()) {
    write_coordinates(out, mesh.points[v]);
    out.character('\n');
  }
  for (const SurfaceFaces::Face& face : surface.faces()) {
    const auto corners = surface.corners(face);
    out.integer(static_cast<std::int64_t>(corners.size()));
    for (VertexId v : corners) {
      out.character(' ');
      out.integer(static_cast<std::int64_t>(surface.number(v)));
    }
    out.character('\n');
  }
}

}  // namespace delfront
