// SPDX-License-Identifier: Apache-2.0
// VTK XML unstructured grids (.vtu) and surfaces (.vtp). All pieces become one mesh; names and ids: see write_vtk.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "delfront/errors.hpp"
#include "io/formats.hpp"
#include "io/vtk_arrays.hpp"
#include "io/vtk_grid.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

class VtkReader {
 public:
  VtkReader(std::string_view bytes, const std::string& path, Context& context, const char* kind)
      : context_(context), root_(parse_xml(bytes, path)), arrays_(root_, bytes, path), grid_(path) {
    if (root_.name != "VTKFile") arrays_.fail(root_, "this is not a VTK XML file");
    if (root_.get("type") != kind)
      arrays_.fail(root_, fmt::format("the file holds '{}', not {}", root_.get("type").substr(0, 40), kind));
    is_surface_ = std::string_view(kind) == "PolyData";
  }

  Mesh read() {
    const XmlElement* grid = root_.child(is_surface_ ? "PolyData" : "UnstructuredGrid");
    if (!grid) arrays_.fail(root_, "the grid element is missing");
    for (const XmlElement& child : grid->children) {
      context_.check_limits();
      if (child.name == "Piece") read_piece(child);
    }
    const std::string said = grid->get("dimension");
    const XmlElement* names = grid->child("FieldData");
    return grid_.finish(said == "2"   ? 2
                        : said == "3" ? 3
                                      : 0,
                        is_surface_, names ? names_of(*names) : std::vector<VtkName>(), context_);
  }

 private:
  VtkGrid::Fail at(const XmlElement& where) const {
    return [this, &where](const std::string& message) { arrays_.fail(where, message); };
  }

  std::size_t attribute_count(const XmlElement& piece, const char* name) const {
    const std::string text = piece.get(name);
    std::uint64_t value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (!text.empty() && (error != std::errc() || stop != text.data() + text.size()))
      arrays_.fail(piece, fmt::format("{}=\"{}\" is no number", name, text.substr(0, 40)));
    return value;
  }

  void read_piece(const XmlElement& piece) {
    read_points(piece);
    if (is_surface_) {
      for (const char* kind : {"Verts", "Lines", "Polys", "Strips"}) read_surface_cells(piece, kind);
    } else {
      read_cells(piece);
    }
    take_data(piece.child("PointData"), Field::On::vertices);
    take_data(piece.child("CellData"), Field::On::cells);
    grid_.end_piece();
  }

  void read_points(const XmlElement& piece) {
    const std::size_t claimed = attribute_count(piece, "NumberOfPoints");
    const XmlElement* points = piece.child("Points");
    if (claimed == 0) return;
    if (!points || points->children.empty()) arrays_.fail(piece, "the points are missing");
    const std::vector<double> values = arrays_.reals(points->children.front());
    if (values.size() / 3 != claimed || values.size() % 3 != 0)
      arrays_.fail(points->children.front(), fmt::format("{} numbers for {} points", values.size(), claimed));
    grid_.add_points(values, at(piece));
  }

  const XmlElement& array(const XmlElement& parent, std::string_view name) const {
    for (const XmlElement& child : parent.children)
      if (child.get("Name") == name) return child;
    arrays_.fail(parent, fmt::format("the array '{}' is missing", name));
  }

  /// The cells of one element as spans of a list; offsets are checked.
  template <class Function>
  void for_each_cell(const XmlElement& cells, std::size_t num_cells, Function&& take) {
    const std::vector<std::int64_t> vertices = arrays_.integers(array(cells, "connectivity"));
    const std::vector<std::int64_t> offsets = arrays_.integers(array(cells, "offsets"));
    if (offsets.size() != num_cells)
      arrays_.fail(cells, fmt::format("{} offsets for {} cells", offsets.size(), num_cells));
    std::int64_t begin = 0;
    for (std::size_t cell = 0; cell < num_cells; ++cell) {
      const std::int64_t end = offsets[cell];
      if (end < begin || end > static_cast<std::int64_t>(vertices.size()))
        arrays_.fail(cells, fmt::format("the offset {} of cell {} is out of range", end, cell));
      take(cell, std::span<const std::int64_t>(vertices.data() + begin, static_cast<std::size_t>(end - begin)));
      begin = end;
    }
  }

  void read_cells(const XmlElement& piece) {
    const std::size_t num_cells = attribute_count(piece, "NumberOfCells");
    if (num_cells == 0) return;
    const XmlElement* cells = piece.child("Cells");
    if (!cells) arrays_.fail(piece, "the cells are missing");
    const std::vector<std::int64_t> types = arrays_.integers(array(*cells, "types"));
    if (types.size() != num_cells) arrays_.fail(*cells, fmt::format("{} types for {} cells", types.size(), num_cells));
    std::vector<std::int64_t> faces, face_offsets;
    if (std::find(types.begin(), types.end(), VtkGrid::kPolyhedron) != types.end()) {
      faces = arrays_.integers(array(*cells, "faces"));
      face_offsets = arrays_.integers(array(*cells, "faceoffsets"));
    }
    const VtkGrid::Fail fail = at(*cells);
    std::int64_t faces_end = 0;  // of the polyhedra so far
    for_each_cell(*cells, num_cells, [&](std::size_t cell, std::span<const std::int64_t> corners) {
      if (types[cell] != VtkGrid::kPolyhedron) return grid_.add_cell(types[cell], corners, fail);
      const std::int64_t begin = faces_end;
      faces_end = cell < face_offsets.size() ? face_offsets[cell] : -1;
      if (faces_end <= begin || faces_end > static_cast<std::int64_t>(faces.size()))
        fail(fmt::format("the faces of polyhedron {} are damaged", cell));
      grid_.add_polyhedron({faces.data() + begin, static_cast<std::size_t>(faces_end - begin)}, fail);
    });
  }

  void read_surface_cells(const XmlElement& piece, const std::string& kind) {
    const std::size_t num_cells = attribute_count(piece, ("NumberOf" + kind).c_str());
    if (num_cells == 0) return;
    const XmlElement* cells = piece.child(kind);
    if (!cells) arrays_.fail(piece, fmt::format("{} are missing", kind));
    const int type = kind == "Polys"   ? 7
                     : kind == "Verts" ? VtkGrid::kPolyVertex
                     : kind == "Lines" ? VtkGrid::kPolyLine
                                       : VtkGrid::kStrip;
    const VtkGrid::Fail fail = at(*cells);
    for_each_cell(*cells, num_cells,
                  [&](std::size_t, std::span<const std::int64_t> corners) { grid_.add_cell(type, corners, fail); });
  }

  void take_data(const XmlElement* parent, Field::On on) {
    if (!parent) return;
    for (const XmlElement& child : parent->children) {
      const std::string name = child.get("Name");
      if (child.name != "DataArray" || name.empty()) continue;
      if (child.get("type") == "String") {
        grid_.leave_out_text(on, name, context_);
        continue;
      }
      grid_.add_data(on, name, attribute_count(child, "NumberOfComponents"), arrays_.reals(child), at(child));
    }
  }

  std::vector<VtkName> names_of(const XmlElement& field_data) const {
    std::vector<VtkName> names;
    for (const XmlElement& child : field_data.children) {
      const std::string label = child.get("Name");
      if (child.name != "DataArray" || !VtkName::is_label(label)) continue;
      names.push_back(VtkName::of(label, arrays_.reals(child), child.get("kind"), child.get("two_sided") == "1"));
    }
    return names;
  }

  Context& context_;
  XmlElement root_;
  VtkArrays arrays_;
  VtkGrid grid_;
  bool is_surface_ = false;
};

}  // namespace

Mesh read_vtu(std::string_view bytes, const std::string& path, Context& context) {
  return VtkReader(bytes, path, context, "UnstructuredGrid").read();
}

Mesh read_vtp(std::string_view bytes, const std::string& path, Context& context) {
  return VtkReader(bytes, path, context, "PolyData").read();
}

}  // namespace delfront
