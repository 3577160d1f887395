// SPDX-License-Identifier: Apache-2.0
// XDMF 2 and 3: uniform grids of one type of cells or mixed ones, whose data stand in the XML or in HDF5 files beside
// it. Grids of collections become one mesh. Names and ids of groups: see write_xdmf.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <memory>

#include "delfront/errors.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/hdf5/hdf5_reader.hpp"
#include "io/hdf5/library_reading.hpp"
#include "io/hdf5/xdmf.hpp"
#include "io/vtk_grid.hpp"
#include "io/whole_numbers.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

class XdmfReader {
 public:
  XdmfReader(std::string_view bytes, const std::string& path, Context& context)
      : bytes_(bytes), path_(path), context_(context), root_(parse_xml(bytes, path)), grid_(path) {}

  Mesh read() {
    if (root_.name != "Xdmf") fail(root_, "this is no XDMF file");
    for (const XmlElement& domain : root_.children) {
      if (domain.name != "Domain") continue;
      read_names(domain);
      for (const XmlElement& child : domain.children)
        if (child.name == "Grid") read_grid(child);
    }
    return grid_.finish(is_flat_ ? 2 : 0, false, names_, context_);
  }

 private:
  [[noreturn]] void fail(const XmlElement& where, const std::string& message) const {
    const std::string name = where.get("Name");
    const std::string tag =
        fmt::format("<{}>{}", where.name.substr(0, 40), name.empty() ? "" : fmt::format(" '{}'", name.substr(0, 80)));
    const bool is_here = where.name.data() >= bytes_.data() && where.name.data() < bytes_.data() + bytes_.size();
    if (!is_here) throw InputError(fmt::format("{}: {}: {}", path_, tag, message));
    Cursor(bytes_, path_)
        .fail_at(static_cast<std::size_t>(where.name.data() - bytes_.data()), fmt::format("{}: {}", tag, message));
  }
  VtkGrid::Fail at(const XmlElement& where) const {
    return [this, &where](const std::string& message) { fail(where, message); };
  }

  static bool is_either(const std::string& text, std::string_view word) { return equal_ignoring_case(text, word); }

  /// XDMF 2 writes GeometryType, XDMF 3 Type.
  static std::string type_of(const XmlElement& element) {
    const std::string* old = element.find(std::string(element.name) + "Type");
    return old ? *old : element.get("Type");
  }

  void read_grid(const XmlElement& grid) {
    context_.check_limits();
    const std::string type = type_of(grid);
    if (is_either(type, "Collection") || is_either(type, "Tree")) return read_collection(grid);
    if (!type.empty() && !is_either(type, "Uniform")) fail(grid, fmt::format("grids of type '{}' are not read", type));
    read_names(grid);
    const XmlElement* geometry = grid.child("Geometry");
    const XmlElement* topology = grid.child("Topology");
    if (!geometry || !topology) fail(grid, "its <Geometry> or <Topology> is missing (links are not followed)");
    read_geometry(*geometry);
    read_topology(*topology);
    for (const XmlElement& child : grid.children)
      if (child.name == "Attribute") read_attribute(child);
    grid_.end_piece();
  }

  void read_collection(const XmlElement& collection) {
    const auto num_grids = std::count_if(collection.children.begin(), collection.children.end(),
                                         [](const XmlElement& child) { return child.name == "Grid"; });
    if (is_either(collection.get("CollectionType"), "Temporal") && num_grids > 1)
      fail(collection, fmt::format("it holds {} time steps; save one of them", num_grids));
    for (const XmlElement& child : collection.children)
      if (child.name == "Grid") read_grid(child);
  }

  void read_geometry(const XmlElement& geometry) {
    const std::string type = type_of(geometry);
    std::vector<double> values;
    if (type.empty() || is_either(type, "XYZ")) {
      check_columns(item(geometry), "XYZ", 3);
      values = reals(item(geometry));
      if (values.size() % 3 != 0) fail(geometry, fmt::format("{} numbers are no points in space", values.size()));
    } else if (is_either(type, "XY")) {
      check_columns(item(geometry), "XY", 2);
      const std::vector<double> flat = reals(item(geometry));
      if (flat.size() % 2 != 0) fail(geometry, fmt::format("{} numbers are no points in the plane", flat.size()));
      for (std::size_t i = 0; i < flat.size(); i += 2) values.insert(values.end(), {flat[i], flat[i + 1], 0.0});
      is_flat_ = true;
    } else if (is_either(type, "X_Y_Z")) {
      values = interleaved(geometry);
    } else {
      fail(geometry, fmt::format("geometry of type '{}' is not read; XYZ and XY are", type.substr(0, 40)));
    }
    grid_.add_points(values, at(geometry));
  }

  /// Rows of points, where the dimensions say rows.
  void check_columns(const XmlElement& data, const char* type, double wanted) const {
    const std::string dimensions = data.get("Dimensions");
    Cursor text(dimensions, path_);
    double last = wanted;
    std::size_t rank = 0;
    for (std::string_view token = text.next(); !token.empty(); token = text.next(), ++rank)
      if (!parse_number(token, last)) return;  // said where the values are counted
    if (rank > 1 && last != wanted)
      fail(data, fmt::format("points of type {} have {} numbers each, which Dimensions=\"{}\" are not", type, wanted,
                             dimensions.substr(0, 40)));
  }

  std::vector<double> interleaved(const XmlElement& geometry) {
    std::vector<std::vector<double>> axes;
    for (const XmlElement& child : geometry.children)
      if (child.name == "DataItem") axes.push_back(reals(child));
    if (axes.size() != 3 || axes[1].size() != axes[0].size() || axes[2].size() != axes[0].size())
      fail(geometry, "X_Y_Z is three lists of the same length");
    std::vector<double> values;
    for (std::size_t i = 0; i < axes[0].size(); ++i) values.insert(values.end(), {axes[0][i], axes[1][i], axes[2][i]});
    return values;
  }

  void read_topology(const XmlElement& topology) {
    const std::string type = type_of(topology);
    std::vector<std::int64_t> numbers = integers(item(topology));
    if (const std::int64_t base = number_of(topology, "BaseOffset", 0); base != 0)
      fail(topology, fmt::format("numbers that begin at {} are not read", base));
    if (is_either(type, "Mixed")) {
      add_mixed(topology, numbers);
    } else {
      const auto known = std::find_if(kXdmfTypes.begin(), kXdmfTypes.end(),
                                      [&](const XdmfType& candidate) { return is_either(type, candidate.name); });
      if (known == kXdmfTypes.end() || known->vtk_number == VtkGrid::kPolyhedron)
        fail(topology, fmt::format("cells of type '{}' are not read; linear ones are", type.substr(0, 40)));
      add_uniform(topology, *known, numbers);
    }
    const std::int64_t claimed = number_of(topology, "NumberOfElements", -1);
    if (claimed >= 0 && static_cast<std::size_t>(claimed) != grid_.num_cells_of_piece())
      fail(topology, fmt::format("{} cells are announced, {} are there", claimed, grid_.num_cells_of_piece()));
  }

  void add_uniform(const XmlElement& topology, const XdmfType& type, std::span<const std::int64_t> numbers) {
    std::int64_t width = type.num_corners;
    if (width == 0) width = number_of(topology, "NodesPerElement", type.number == 1 ? 1 : type.number == 2 ? 2 : 0);
    if (width < 1 || numbers.size() % static_cast<std::size_t>(width) != 0)
      fail(topology, fmt::format("{} numbers are no cells of {} corners", numbers.size(), width));
    const VtkGrid::Fail fail_here = at(topology);
    const auto step = static_cast<std::size_t>(width);
    for (std::size_t i = 0; i < numbers.size(); i += step)
      grid_.add_cell(type.vtk_number, numbers.subspan(i, step), fail_here);
  }

  void add_mixed(const XmlElement& topology, std::span<const std::int64_t> numbers) {
    const VtkGrid::Fail fail_here = at(topology);
    for (std::size_t i = 0; i < numbers.size();) {
      const std::int64_t number = numbers[i++];
      const auto type = std::find_if(kXdmfTypes.begin(), kXdmfTypes.end(),
                                     [&](const XdmfType& candidate) { return candidate.number == number; });
      if (type == kXdmfTypes.end())
        fail(topology, fmt::format("cell {} is of type {}, which is not read; linear ones are",
                                   grid_.num_cells_of_piece(), number));
      if (type->vtk_number == VtkGrid::kPolyhedron) {
        const std::size_t length = length_of_polyhedron(topology, numbers.subspan(i));
        grid_.add_polyhedron(numbers.subspan(i, length), fail_here);
        i += length;
        continue;
      }
      std::int64_t n = type->num_corners;
      if (n == 0) n = i < numbers.size() ? numbers[i++] : -1;
      if (n < 0 || n > static_cast<std::int64_t>(numbers.size() - i))
        fail(topology, fmt::format("the list ends within cell {}; it is damaged", grid_.num_cells_of_piece()));
      grid_.add_cell(type->vtk_number, numbers.subspan(i, static_cast<std::size_t>(n)), fail_here);
      i += static_cast<std::size_t>(n);
    }
  }

  std::size_t length_of_polyhedron(const XmlElement& topology, std::span<const std::int64_t> numbers) const {
    std::size_t end = 1;
    const std::int64_t num_faces = numbers.empty() ? -1 : numbers[0];
    for (std::int64_t face = 0; face < num_faces && end <= numbers.size(); ++face) {
      if (end == numbers.size() || numbers[end] < 0 ||
          numbers[end] > static_cast<std::int64_t>(numbers.size() - end - 1))
        end = numbers.size();
      else
        end += static_cast<std::size_t>(numbers[end]);
      ++end;
    }
    if (num_faces < 0 || end > numbers.size())
      fail(topology, fmt::format("the list ends within polyhedron {}; it is damaged", grid_.num_cells_of_piece()));
    return end;
  }

  void read_attribute(const XmlElement& attribute) {
    const std::string centre = attribute.get("Center"), name = attribute.get("Name");
    const bool is_on_cells = is_either(centre, "Cell");
    if (name.empty() || (!is_on_cells && !centre.empty() && !is_either(centre, "Node"))) return;
    const std::vector<double> values = reals(item(attribute));
    const std::size_t n = is_on_cells ? grid_.num_cells_of_piece() : grid_.num_points_of_piece();
    grid_.add_data(is_on_cells ? Field::On::cells : Field::On::vertices, name, n > 0 ? values.size() / n : 1, values,
                   at(attribute));
  }

  /// <Information> of ours and of meshio.
  void read_names(const XmlElement& parent) {
    for (const XmlElement& child : parent.children) {
      if (child.name != "Information" || !trimmed(child.text).starts_with("<main")) continue;
      const XmlElement table = parse_xml(child.text, path_);
      for (const XmlElement& map : table.children) {
        const std::string label = map.get("key");
        if (map.name != "map" || !VtkName::is_label(label)) continue;
        const std::string_view text = trimmed(map.text);
        VtkName name{label, -1, number_of(map, "dim", -1), map.get("kind"), map.get("two_sided") == "1"};
        const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), name.id);
        if (error != std::errc() || stop != text.data() + text.size()) name.id = -1;  // which is said with the groups
        names_.push_back(name);
      }
    }
  }

  std::int64_t number_of(const XmlElement& element, std::string_view name, std::int64_t otherwise) const {
    const std::string* text = element.find(name);
    if (!text) return otherwise;
    std::int64_t value = 0;
    const std::string_view digits = trimmed(*text);
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || stop != digits.data() + digits.size())
      fail(element, fmt::format("{}=\"{}\" is no whole number", name, digits.substr(0, 40)));
    return value;
  }

  const XmlElement& item(const XmlElement& parent) const {
    const XmlElement* found = parent.child("DataItem");
    if (!found) fail(parent, "its <DataItem> is missing (links are not followed)");
    return *found;
  }

  std::vector<double> reals(const XmlElement& data) { return checked(data, values<double>(data)); }
  std::vector<std::int64_t> integers(const XmlElement& data) { return checked(data, values<std::int64_t>(data)); }

  template <class T>
  std::vector<T> values(const XmlElement& data) {
    context_.check_limits();
    const std::string item_type = data.get("ItemType"), format = data.get("Format");
    if (data.find("Reference")) fail(data, "references are not followed; write the data itself");
    if (!item_type.empty() && !is_either(item_type, "Uniform"))
      fail(data, fmt::format("items of type '{}' are not read; write the data itself", item_type.substr(0, 40)));
    if (is_either(format, "HDF")) {
      const auto [file, array] = hdf5_array(data);
      if constexpr (std::is_integral_v<T>)
        return file->integers(array);
      else
        return file->reals(array);
    }
    if (!format.empty() && !is_either(format, "XML"))
      fail(data, fmt::format("data of format '{}' are not read; XML and HDF are", format.substr(0, 40)));
    return parse_values<T>(data);
  }

  template <class T>
  std::vector<T> parse_values(const XmlElement& data) const {
    std::vector<T> values;
    Cursor text(data.text, path_);
    for (std::string_view token = text.next(); !token.empty(); token = text.next()) {
      double value = 0;
      std::int64_t whole = 0;
      const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), whole);
      if (std::is_integral_v<T> && error == std::errc() && stop == token.data() + token.size()) {
        values.push_back(static_cast<T>(whole));
        continue;
      }
      if (!parse_number(token, value)) fail(data, fmt::format("'{}' is no number", token.substr(0, 40)));
      if (std::is_integral_v<T> && !is_whole(value))
        fail(data, fmt::format("'{}' is no whole number of 64 bits", token.substr(0, 40)));
      values.push_back(static_cast<T>(value));
    }
    return values;
  }

  /// "NAME.h5:/path", the file as seen from the XML.
  std::pair<std::string, std::string> file_and_array(const XmlElement& data) const {
    const std::string_view raw = trimmed(data.text);
    const std::string text = data.is_cdata ? std::string(raw) : unescape_xml(raw);
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
      fail(data, fmt::format("'{}' is no array of an HDF5 file (NAME.h5:/array)", text.substr(0, 80)));
    std::string name = text.substr(0, colon), array = text.substr(colon + 1);
    if (!array.starts_with('/')) array.insert(array.begin(), '/');
    return {name, array};
  }

  std::pair<const Hdf5Reader*, Hdf5Reader::Array> hdf5_array(const XmlElement& data) {
    const auto [name, array] = file_and_array(data);
    std::unique_ptr<Hdf5Reader>& file = files_[name];
    try {
      if (!file) file = std::make_unique<Hdf5Reader>((std::filesystem::path(path_).parent_path() / name).string());
      return {file.get(), file->array(array)};
    } catch (const InputError& error) {
      fail(data, fmt::format("{}; {}", error.what(), both_files(name)));
    }
  }

  std::string both_files(const std::string& arrays) const {
    return fmt::format("{} takes its arrays from {}: both belong together, keep or export them so",
                       std::filesystem::path(path_).filename().string(), arrays.substr(0, 200));
  }

  /// The number of values must be the product of the dimensions, where these are said.
  template <class T>
  std::vector<T> checked(const XmlElement& data, std::vector<T> values) const {
    const std::string dimensions = data.get("Dimensions");
    Cursor text(dimensions, path_);
    double product = 1;
    for (std::string_view token = text.next(); !token.empty(); token = text.next()) {
      double extent = -1;
      if (!parse_number(token, extent) || extent < 0)
        fail(data, fmt::format("Dimensions=\"{}\" are no sizes", dimensions.substr(0, 40)));
      product *= extent;
    }
    if (!dimensions.empty() && product != static_cast<double>(values.size()))
      fail(data,
           fmt::format("{} values for Dimensions=\"{}\"{}", values.size(), dimensions.substr(0, 40),
                       is_either(data.get("Format"), "HDF") ? "; " + both_files(file_and_array(data).first) : ""));
    return values;
  }

  std::string_view bytes_;
  std::string path_;
  Context& context_;
  XmlElement root_;
  VtkGrid grid_;
  bool is_flat_ = false;
  std::vector<VtkName> names_;
  std::map<std::string, std::unique_ptr<Hdf5Reader>> files_;
};

}  // namespace

Mesh read_xdmf(std::string_view bytes, const std::string& path, Context& context) {
  const Hdf5Turn turn;
  const LibraryReading reading(path, context);
  return XdmfReader(bytes, path, context).read();
}

}  // namespace delfront
