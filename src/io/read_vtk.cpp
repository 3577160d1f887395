// SPDX-License-Identifier: Apache-2.0
// VTK XML unstructured grids (.vtu) and surfaces (.vtp). All pieces become one mesh; cells are sorted by type, and each
// remembers which cell of the file it came from, so that cell data finds it. Names and ids: see write_vtk.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/vtk_arrays.hpp"
#include "io/vtk_names.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

constexpr int kPolyVertex = 2, kPolyLine = 4, kStrip = 6, kPixel = 8, kVoxel = 11, kPolyhedron = 42;
constexpr std::size_t kMaxComponents = 256;  // pieces without an array are filled up: this bounds by how much

/// One array over all pieces.
struct Data {
  int components = 1;
  std::vector<double> values;
};

class VtkReader {
 public:
  VtkReader(std::string_view bytes, const std::string& path, Context& context, const char* kind)
      : path_(path), context_(context), root_(parse_xml(bytes, path)), arrays_(root_, bytes, path) {
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
    if (num_cells_ == 0) throw InputError(fmt::format("{}: the file has no cells", path_));
    check_finite(mesh_, path_);
    set_dimension(*grid);
    set_groups(*grid);
    set_fields();
    return std::move(mesh_);
  }

 private:
  std::size_t attribute_count(const XmlElement& piece, const char* name) const {
    const std::string text = piece.get(name);
    std::uint64_t value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (!text.empty() && (error != std::errc() || stop != text.data() + text.size()))
      arrays_.fail(piece, fmt::format("{}=\"{}\" is no number", name, text.substr(0, 40)));
    return value;
  }

  void read_piece(const XmlElement& piece) {
    const std::size_t num_points = read_points(piece);
    const std::size_t first_cell = num_cells_;
    if (is_surface_) {
      for (const char* kind : {"Verts", "Lines", "Polys", "Strips"}) read_surface_cells(piece, kind);
    } else {
      read_cells(piece);
    }
    take_data(piece.child("PointData"), num_points, first_point_, point_data_);
    take_data(piece.child("CellData"), num_cells_ - first_cell, first_cell, cell_data_);
    first_point_ += num_points;
  }

  std::size_t read_points(const XmlElement& piece) {
    const std::size_t claimed = attribute_count(piece, "NumberOfPoints");
    const XmlElement* points = piece.child("Points");
    if (claimed == 0) return 0;
    if (!points || points->children.empty()) arrays_.fail(piece, "the points are missing");
    const std::vector<double> values = arrays_.reals(points->children.front());
    if (values.size() / 3 != claimed || values.size() % 3 != 0)
      arrays_.fail(points->children.front(), fmt::format("{} numbers for {} points", values.size(), claimed));
    if (mesh_.points.size() + claimed >= Id<VertexTag>::kNone)
      arrays_.fail(piece, "more than 2^32 - 1 points are not supported");
    for (std::size_t i = 0; i < values.size(); i += 3)
      mesh_.points.push_back({values[i], values[i + 1], values[i + 2]});
    return claimed;
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
      corners_.clear();
      for (std::int64_t k = begin; k < end; ++k)
        corners_.push_back(vertex(cells, cell, vertices[static_cast<std::size_t>(k)]));
      take(cell);
      begin = end;
    }
  }

  VertexId vertex(const XmlElement& cells, std::size_t cell, std::int64_t index) const {
    const auto num_points = static_cast<std::int64_t>(mesh_.points.size() - first_point_);
    if (index < 0 || index >= num_points)
      arrays_.fail(cells, fmt::format("cell {} has the vertex {}, but there are {} points", cell, index, num_points));
    return VertexId(first_point_ + static_cast<std::size_t>(index));
  }

  void read_cells(const XmlElement& piece) {
    const std::size_t num_cells = attribute_count(piece, "NumberOfCells");
    if (num_cells == 0) return;
    const XmlElement* cells = piece.child("Cells");
    if (!cells) arrays_.fail(piece, "the cells are missing");
    const std::vector<std::int64_t> types = arrays_.integers(array(*cells, "types"));
    if (types.size() != num_cells) arrays_.fail(*cells, fmt::format("{} types for {} cells", types.size(), num_cells));
    std::vector<std::int64_t> faces, face_offsets;
    faces_end_ = 0;
    if (std::find(types.begin(), types.end(), kPolyhedron) != types.end()) {
      faces = arrays_.integers(array(*cells, "faces"));
      face_offsets = arrays_.integers(array(*cells, "faceoffsets"));
    }
    for_each_cell(*cells, num_cells, [&](std::size_t cell) {
      if (types[cell] == kPolyhedron)
        take_polyhedron(*cells, cell, faces, face_offsets);
      else
        take_cell(*cells, cell, types[cell]);
      ++num_cells_;
    });
  }

  void read_surface_cells(const XmlElement& piece, const std::string& kind) {
    const std::size_t num_cells = attribute_count(piece, ("NumberOf" + kind).c_str());
    if (num_cells == 0) return;
    const XmlElement* cells = piece.child(kind);
    if (!cells) arrays_.fail(piece, fmt::format("{} are missing", kind));
    for_each_cell(*cells, num_cells, [&](std::size_t cell) {
      if (kind == "Polys")
        take_cell(*cells, cell, 7);
      else
        take_cell(*cells, cell, kind == "Verts" ? kPolyVertex : kind == "Lines" ? kPolyLine : kStrip);
      ++num_cells_;
    });
  }

  void add(CellType type, std::span<const VertexId> vertices) {
    add_cell(mesh_, type, vertices, GroupId());
    source_[static_cast<std::size_t>(type)].push_back(static_cast<std::uint32_t>(num_cells_));
  }

  void take_cell(const XmlElement& cells, std::size_t cell, std::int64_t type) {
    const std::size_t n = corners_.size();
    const auto v = [&](std::size_t k) { return corners_[k]; };
    if (type == kPolyVertex) {
      for (std::size_t k = 0; k < n; ++k) add(CellType::vertex, {&corners_[k], 1});
    } else if (type == kPolyLine) {
      for (std::size_t k = 0; k + 1 < n; ++k) add(CellType::line, {&corners_[k], 2});
    } else if (type == kStrip) {
      for (std::size_t k = 0; k + 2 < n; ++k) {
        const std::array<VertexId, 3> corner = {v(k + k % 2), v(k + 1 - k % 2), v(k + 2)};
        add(CellType::triangle, corner);
      }
    } else if (type == kPixel && n == 4) {
      add(CellType::quad, std::array{v(0), v(1), v(3), v(2)});
    } else if (type == kVoxel && n == 8) {
      add(CellType::hexahedron, std::array{v(0), v(1), v(3), v(2), v(4), v(5), v(7), v(6)});
    } else if (type == vtk_number(CellType::polygon)) {
      if (n < 3) arrays_.fail(cells, fmt::format("polygon {} has {} corners", cell, n));
      add(n == 3 ? CellType::triangle : n == 4 ? CellType::quad : CellType::polygon, corners_);
    } else {
      take_plain_cell(cells, cell, type);
    }
  }

  void take_plain_cell(const XmlElement& cells, std::size_t cell, std::int64_t number) {
    const std::optional<CellType> type =
        number >= 0 && number < 256 ? type_from_vtk(static_cast<int>(number)) : std::nullopt;
    if (!type)
      arrays_.fail(cells,
                   fmt::format("cell {} has the VTK type {}, which is not supported; linear cells are", cell, number));
    if (corners_.size() != static_cast<std::size_t>(num_vertices(*type)))
      arrays_.fail(cells, fmt::format("cell {} is a {} with {} vertices", cell, name_of(*type), corners_.size()));
    add(*type, corners_);
  }

  void take_polyhedron(const XmlElement& cells, std::size_t cell, const std::vector<std::int64_t>& faces,
                       const std::vector<std::int64_t>& face_offsets) {
    const auto fail_stream = [&] { arrays_.fail(cells, fmt::format("the faces of polyhedron {} are damaged", cell)); };
    if (cell >= face_offsets.size()) fail_stream();
    const std::int64_t end = face_offsets[cell];
    const std::int64_t begin = faces_end_;
    if (end <= begin || end > static_cast<std::int64_t>(faces.size())) fail_stream();
    const std::span<const std::int64_t> stream(faces.data() + begin, static_cast<std::size_t>(end - begin));
    corners_.clear();
    corners_.push_back(VertexId(static_cast<std::size_t>(stream[0])));
    std::size_t i = 1;
    for (std::int64_t face = 0; face < stream[0]; ++face) {
      if (i >= stream.size() || stream[i] < 3 || stream[i] > static_cast<std::int64_t>(stream.size() - i - 1))
        fail_stream();
      const auto n = static_cast<std::size_t>(stream[i]);
      corners_.push_back(VertexId(n));
      for (std::size_t k = 1; k <= n; ++k) corners_.push_back(vertex(cells, cell, stream[i + k]));
      i += n + 1;
    }
    if (i != stream.size() || stream[0] < 4) fail_stream();
    faces_end_ = end;
    add(CellType::polyhedron, corners_);
  }

  void take_data(const XmlElement* parent, std::size_t count, std::size_t before, std::map<std::string, Data>& into) {
    if (!parent) return;
    for (const XmlElement& child : parent->children) {
      const std::string name = child.get("Name");
      if (child.name != "DataArray" || name.empty() || child.get("type") == "String") continue;
      std::vector<double> values = arrays_.reals(child);
      const std::size_t components = std::max<std::size_t>(attribute_count(child, "NumberOfComponents"), 1);
      if (components > kMaxComponents) arrays_.fail(child, fmt::format("{} components are not supported", components));
      if (values.size() / components != count || values.size() % components != 0)
        arrays_.fail(child,
                     fmt::format("{} numbers for {} entries of {} components", values.size(), count, components));
      if (count == 0) continue;
      Data& data = into[name];
      if (!data.values.empty() && data.components != static_cast<int>(components))
        arrays_.fail(child, "its number of components differs between pieces");
      data.components = static_cast<int>(components);
      data.values.resize(before * components, std::numeric_limits<double>::quiet_NaN());
      data.values.insert(data.values.end(), values.begin(), values.end());
    }
  }

  void set_dimension(const XmlElement& grid) {
    const std::string said = grid.get("dimension");
    if (said == "2" || said == "3")
      mesh_.dimension = said == "2" ? 2 : 3;
    else if (!is_surface_)
      guess_dimension(mesh_);
  }

  void set_groups(const XmlElement& grid) {
    TagGroups groups(mesh_);
    if (const XmlElement* names = grid.child("FieldData")) take_names(*names, groups);
    for (const CellBlock& cells : mesh_.blocks) {
      const int d = dimension(cells.type);
      const auto found = cell_data_.find(vtk_id_array(mesh_, d));
      if (found == cell_data_.end() || found->second.components != 1) continue;
      CellBlock& block = mesh_.block(cells.type);
      const std::vector<std::uint32_t>& source = source_[static_cast<std::size_t>(block.type)];
      for (std::size_t cell = 0; cell < source.size(); ++cell) {
        if (source[cell] >= found->second.values.size()) continue;
        const double id = found->second.values[source[cell]];
        if (id >= 0 && id < 2147483648.0) block.group[cell] = groups(d, static_cast<std::int64_t>(id));
      }
    }
    for (int d = 0; d <= 3; ++d) cell_data_.erase(vtk_id_array(mesh_, d));
  }

  void take_names(const XmlElement& field_data, TagGroups& groups) {
    for (const XmlElement& child : field_data.children) {
      const std::string label = child.get("Name");
      const std::size_t colon = label.find(':');
      if (child.name != "DataArray" || colon == std::string::npos || !is_vtk_role(label.substr(0, colon))) continue;
      const std::vector<std::int64_t> values = arrays_.integers(child);
      if (values.size() != 2 || values[0] < 0 || values[1] < 0 || values[1] > 3) continue;
      const int d = static_cast<int>(values[1]);
      groups.name(d, values[0], label.substr(colon + 1), child.get("kind"));
      mesh_.groups[groups(d, values[0])].two_sided = child.get("two_sided") == "1";
    }
  }

  void set_fields() {
    for (auto& [name, data] : point_data_) {
      data.values.resize(mesh_.points.size() * static_cast<std::size_t>(data.components),
                         std::numeric_limits<double>::quiet_NaN());
      mesh_.fields.push_back({name, Field::On::vertices, CellType::vertex, data.components, std::move(data.values)});
    }
    for (const auto& [name, data] : cell_data_)
      for (const CellBlock& block : mesh_.blocks) set_cell_field(name, data, block.type);
  }

  /// Left out where all values are NaN: write_vtk fills blocks that lack a field with it.
  void set_cell_field(const std::string& name, const Data& data, CellType type) {
    const auto n = static_cast<std::size_t>(data.components);
    Field field{name, Field::On::cells, type, data.components, {}};
    bool has_value = false;
    for (std::uint32_t cell : source_[static_cast<std::size_t>(type)])
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t at = cell * n + k;
        field.values.push_back(at < data.values.size() ? data.values[at] : std::numeric_limits<double>::quiet_NaN());
        has_value |= !std::isnan(field.values.back());
      }
    if (has_value) mesh_.fields.push_back(std::move(field));
  }

  std::string path_;
  Context& context_;
  XmlElement root_;
  VtkArrays arrays_;
  bool is_surface_ = false;
  Mesh mesh_;
  std::size_t first_point_ = 0, num_cells_ = 0;
  std::int64_t faces_end_ = 0;  // of the polyhedra of this piece so far
  std::vector<VertexId> corners_;
  std::array<std::vector<std::uint32_t>, kNumCellTypes> source_;  // cell of the file, by type
  std::map<std::string, Data> point_data_, cell_data_;
};

}  // namespace

Mesh read_vtu(std::string_view bytes, const std::string& path, Context& context) {
  return VtkReader(bytes, path, context, "UnstructuredGrid").read();
}

Mesh read_vtp(std::string_view bytes, const std::string& path, Context& context) {
  return VtkReader(bytes, path, context, "PolyData").read();
}

}  // namespace delfront
