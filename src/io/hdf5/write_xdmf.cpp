// SPDX-License-Identifier: Apache-2.0
// XDMF 3: the XML names the arrays of NAME.h5 beside it. One grid, topology "Mixed" where there are several types of
// cells, in the plane with geometry XY. Ids of groups as in a VTU (vtk_names.hpp), their names in an <Information> as
// meshio writes its own: a CDATA section with <map key="patch:wing" dim="2">0</map> each.
#include <fmt/format.h>

#include <filesystem>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/hdf5/hdf5_writer.hpp"
#include "io/hdf5/xdmf.hpp"
#include "io/output.hpp"
#include "io/vtk_blocks.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

/// Vertices and lines go as poly-cells, which say their number of corners.
const XdmfType& xdmf_type(CellType type) {
  const int wanted = type == CellType::vertex ? 2 : type == CellType::line ? 4 : vtk_number(type);
  return *std::find_if(kXdmfTypes.begin(), kXdmfTypes.end(), [&](const XdmfType& t) { return t.vtk_number == wanted; });
}

/// How the XML names a file beside it. Readers cut blanks off both ends of what an element holds: "./" stands before
/// one.
std::string reference_to(const std::string& name) {
  return (static_cast<unsigned char>(name.front()) <= ' ' ? "./" : "") + name;
}

class XdmfWriter {
 public:
  XdmfWriter(const Mesh& mesh, Output& out, Hdf5Writer& arrays, std::string arrays_name, Context& context,
             std::vector<std::string>& notes)
      : mesh_(mesh),
        out_(out),
        arrays_(arrays),
        arrays_name_(std::move(arrays_name)),
        context_(context),
        notes_(notes),
        blocks_(blocks_of(mesh, 0, 3)) {}

  void write() {
    out_.text("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"grid\" GridType=\"Uniform\">\n");
    write_geometry();
    write_topology();
    write_names();
    write_data();
    out_.text("</Grid>\n</Domain>\n</Xdmf>\n");
  }

 private:
  /// The array of the number `next_`, and the item that names it.
  template <class T>
  void write_item(std::span<const T> values, std::size_t columns) {
    context_.check_limits();
    write_item_of<T>(values.size(), columns, [&](const std::string& path) { arrays_.add<T>(path, values, columns); });
  }

  template <class T, class Function>
  void write_item_of(std::size_t size, std::size_t columns, Function&& add) {
    const std::string path = fmt::format("/data{}", next_++);
    const std::string extents = columns > 0 ? fmt::format("{} {}", size / columns, columns) : fmt::format("{}", size);
    out_.text(
        fmt::format("<DataItem Dimensions=\"{}\" NumberType=\"{}\" Precision=\"{}\" Format=\"HDF\">{}:{}"
                    "</DataItem>\n",
                    extents, std::is_floating_point_v<T> ? "Float" : "Int", sizeof(T), escape_xml(arrays_name_), path));
    add(path);
  }

  void write_geometry() {
    const bool is_flat = mesh_.dimension == 2;
    out_.text(fmt::format("<Geometry GeometryType=\"{}\">\n", is_flat ? "XY" : "XYZ"));
    if (is_flat) {
      std::vector<double> values;
      values.reserve(2 * mesh_.points.size());
      for (const Point& p : mesh_.points) values.insert(values.end(), {p.x, p.y});
      write_item<double>(values, 2);
    } else {
      write_item<double>(raw_coordinates(mesh_), 3);
    }
    out_.text("</Geometry>\n");
  }

  void write_topology() {
    const XdmfType* only = blocks_.size() == 1 ? &xdmf_type(blocks_.front()->type) : nullptr;
    const bool is_mixed = !only || only->num_corners == 0;
    out_.text(fmt::format("<Topology TopologyType=\"{}\" NumberOfElements=\"{}\">\n", is_mixed ? "Mixed" : only->name,
                          num_cells(blocks_)));
    if (is_mixed) {
      write_item<std::int64_t>(mixed_cells(), 0);
    } else {
      const auto ids = raw_ids(blocks_.front()->vertices);
      const auto width = static_cast<std::size_t>(only->num_corners);
      write_item_of<std::uint32_t>(ids.size(), width,
                                   [&](const std::string& path) { arrays_.add<std::uint32_t>(path, ids, width); });
    }
    out_.text("</Topology>\n");
  }

  std::vector<std::int64_t> mixed_cells() const {
    std::vector<std::int64_t> stream;
    for (const CellBlock* block : blocks_) {
      context_.check_limits();
      const XdmfType& type = xdmf_type(block->type);
      for (std::size_t cell = 0; cell < block->size(); ++cell) {
        const std::span<const VertexId> corners = (*block)[cell];
        stream.push_back(type.number);
        if (type.num_corners == 0 && block->type != CellType::polyhedron)
          stream.push_back(static_cast<std::int64_t>(corners.size()));
        for (const VertexId v : corners) stream.push_back(v.value);
      }
    }
    return stream;
  }

  void write_names() {
    const std::vector<VtkName> names = group_names(mesh_, NameRule::line, "XDMF", notes_);
    if (names.empty()) return;
    out_.text(fmt::format("<Information Name=\"Information\" Value=\"{}\"><![CDATA[<main>\n", names.size()));
    for (const VtkName& name : names)
      out_.text(fmt::format("<map key=\"{}\" dim=\"{}\"{}{}>{}</map>\n", escape_xml(name.label), name.dimension,
                            name.kind.empty() ? "" : fmt::format(" kind=\"{}\"", escape_xml(name.kind)),
                            name.two_sided ? " two_sided=\"1\"" : "", name.id));
    out_.text("</main>]]></Information>\n");
  }

  void write_data() {
    for (const Field& field : mesh_.fields)
      if (field.on == Field::On::vertices) write_attribute<double>(field.name, "Node", field.values, field.components);
    for (const IdArray& ids : id_arrays(mesh_, blocks_)) write_attribute<std::int32_t>(ids.name, "Cell", ids.values, 1);
    for (const auto& [name, components] : cell_field_names(mesh_))
      write_attribute<double>(name, "Cell", cell_field(mesh_, blocks_, name, components), components);
  }

  template <class T>
  void write_attribute(const std::string& name, const char* centre, const std::vector<T>& values, int components) {
    const char* type = components == 1   ? "Scalar"
                       : components == 3 ? "Vector"
                       : components == 6 ? "Tensor6"
                       : components == 9 ? "Tensor"
                                         : "Matrix";
    out_.text(
        fmt::format("<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">\n", escape_xml(name), type, centre));
    write_item<T>(values, components > 1 ? static_cast<std::size_t>(components) : 0);
    out_.text("</Attribute>\n");
  }

  const Mesh& mesh_;
  Output& out_;
  Hdf5Writer& arrays_;
  std::string arrays_name_;
  Context& context_;
  std::vector<std::string>& notes_;
  Blocks blocks_;
  std::size_t next_ = 0;
};

}  // namespace

void write_xdmf(const Mesh& mesh, const std::string& path, const std::string& shown_path, const WriteOptions& options,
                Context& context, std::vector<std::string>& notes) {
  context.check_limits();
  check_size(mesh, "XDMF");
  const std::filesystem::path beside = std::filesystem::path(shown_path).replace_extension(".h5");
  Replacement replacement(beside.string());
  const Hdf5Turn turn;
  Hdf5Writer arrays(replacement.temporary(), beside.string(), options.compress);
  Output out(path, shown_path);
  XdmfWriter(mesh, out, arrays, reference_to(beside.filename().string()), context, notes).write();
  out.close();
  arrays.close();
  replacement.commit();
}

}  // namespace delfront
