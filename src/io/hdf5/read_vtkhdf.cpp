// SPDX-License-Identifier: Apache-2.0
// VTKHDF unstructured grids, versions 1 and 2: all partitions become one mesh. Names and ids: see write_vtkhdf.cpp.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/formats.hpp"
#include "io/hdf5/hdf5_reader.hpp"
#include "io/hdf5/library_reading.hpp"
#include "io/vtk_grid.hpp"

namespace delfront {

namespace {

const std::string kRoot = "/VTKHDF";
constexpr std::size_t kMaxComponents = 256;

class VtkHdfReader {
 public:
  VtkHdfReader(const std::string& path, Context& context) : file_(path), context_(context), grid_(path) {}

  Mesh read() {
    check_head();
    const auto num_points = counts("NumberOfPoints"), num_cells = counts("NumberOfCells");
    const auto num_corners = counts("NumberOfConnectivityIds");
    if (num_points.size() != num_cells.size() || num_points.size() != num_corners.size())
      file_.fail(kRoot, fmt::format("numbers of points, cells and corners for {}, {} and {} partitions",
                                    num_points.size(), num_cells.size(), num_corners.size()));
    read_arrays();
    for (std::size_t part = 0; part < num_points.size(); ++part) {
      context_.check_limits();
      add_part(num_points[part], num_cells[part], num_corners[part]);
    }
    const std::vector<std::int64_t> dimension = file_.integer_attribute(kRoot, "dimension");
    return grid_.finish(dimension.size() == 1 ? static_cast<int>(dimension[0]) : 0, false, names(), context_);
  }

 private:
  struct Data {
    Field::On on;
    std::string name, path;
    std::size_t components;
    std::vector<double> values;
    std::size_t at = 0;
  };

  VtkGrid::Fail at(const std::string& where) const {
    return [this, where](const std::string& message) { file_.fail(where, message); };
  }

  void check_head() const {
    if (!file_.has_group(kRoot)) file_.fail(kRoot, "there is no such group: this HDF5 file is no VTKHDF");
    const std::vector<std::int64_t> version = file_.integer_attribute(kRoot, "Version");
    if (version.size() != 2 || version[0] < 1 || version[0] > 2)
      file_.fail(kRoot, version.size() == 2
                            ? fmt::format("version {}.{} is not read; 1 and 2 are", version[0], version[1])
                            : "its version is not said; the file is damaged");
    const std::string type = file_.text_attribute(kRoot, "Type");
    if (type != "UnstructuredGrid")
      file_.fail(kRoot, fmt::format("it holds '{}', not UnstructuredGrid; convert it there", type.substr(0, 40)));
    const std::vector<std::int64_t> steps = file_.integer_attribute(kRoot + "/Steps", "NSteps");
    if (!steps.empty() && steps[0] > 1)
      file_.fail(kRoot + "/Steps", fmt::format("it holds {} time steps; save one of them", steps[0]));
  }

  std::vector<std::size_t> counts(const std::string& name) const {
    std::vector<std::size_t> all;
    const std::string path = kRoot + "/" + name;
    for (const std::int64_t value : file_.integers(path)) {
      if (value < 0 || value > std::int64_t{1} << 42) file_.fail(path, fmt::format("{} cannot be", value));
      all.push_back(static_cast<std::size_t>(value));
    }
    return all;
  }

  void read_arrays() {
    points_ = file_.reals(kRoot + "/Points");
    types_ = file_.integers(kRoot + "/Types");
    offsets_ = file_.integers(kRoot + "/Offsets");
    corners_ = file_.integers(kRoot + "/Connectivity");
    for (const auto& [group, on] :
         {std::pair("PointData", Field::On::vertices), std::pair("CellData", Field::On::cells)}) {
      const std::string folder = kRoot + "/" + group;
      for (const std::string& name : file_.names(folder)) {
        const std::string path = folder + "/" + name;
        const Hdf5Reader::Array array = file_.array(path);
        if (array.holds == Hdf5Reader::Holds::text) {
          grid_.leave_out_text(on, name, context_);
          continue;
        }
        context_.check_limits();
        const std::size_t rows = array.shape.empty() ? 1 : array.shape[0];
        const std::size_t components = rows > 0 ? array.count / rows : 1;
        if (components > kMaxComponents) file_.fail(path, fmt::format("{} components are not supported", components));
        data_.push_back({on, name, path, components, file_.reals(array)});
      }
    }
  }

  /// The next `n` of an array that all partitions share.
  template <class T>
  std::span<const T> take(const std::vector<T>& values, std::size_t& at, std::size_t n, const std::string& path) const {
    if (n > values.size() - at)
      file_.fail(path, fmt::format("{} numbers more are announced, and {} are there; the file is damaged or truncated",
                                   n, values.size() - at));
    const std::span<const T> taken(values.data() + at, n);
    at += n;
    return taken;
  }

  void add_part(std::size_t num_points, std::size_t num_cells, std::size_t num_corners) {
    grid_.add_points(take(points_, next_coordinate_, 3 * num_points, kRoot + "/Points"), at(kRoot + "/Points"));
    const auto types = take(types_, next_type_, num_cells, kRoot + "/Types");
    const auto offsets = take(offsets_, next_offset_, num_cells + 1, kRoot + "/Offsets");
    const auto corners = take(corners_, next_corner_, num_corners, kRoot + "/Connectivity");
    const VtkGrid::Fail fail = at(kRoot + "/Connectivity"), fail_offset = at(kRoot + "/Offsets");
    for (std::size_t cell = 0; cell < num_cells; ++cell) {
      const std::int64_t begin = offsets[cell], end = offsets[cell + 1];
      if (begin < 0 || end < begin || end > static_cast<std::int64_t>(corners.size()))
        fail_offset(
            fmt::format("cell {} has the corners {} to {}, and there are {}", cell, begin, end, corners.size()));
      if (types[cell] == VtkGrid::kPolyhedron) fail("polyhedra are not read from VTKHDF; save the grid as VTU");
      grid_.add_cell(types[cell],
                     corners.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin)), fail);
    }
    for (Data& data : data_) {
      const std::size_t n = data.on == Field::On::vertices ? num_points : num_cells;
      grid_.add_data(data.on, data.name, data.components, take(data.values, data.at, n * data.components, data.path),
                     at(data.path));
    }
    grid_.end_piece();
  }

  std::vector<VtkName> names() const {
    std::vector<VtkName> found;
    const std::string folder = kRoot + "/FieldData";
    for (const std::string& label : file_.names(folder)) {
      if (!VtkName::is_label(label)) continue;
      const std::string path = folder + "/" + label;
      const Hdf5Reader::Array array = file_.array(path);
      const bool is_read = array.holds != Hdf5Reader::Holds::text && array.count == 2;
      found.push_back(VtkName::of(label, is_read ? file_.reals(array) : std::vector<double>(),
                                  file_.text_attribute(path, "kind"),
                                  !file_.integer_attribute(path, "two_sided").empty()));
    }
    return found;
  }

  Hdf5Reader file_;
  Context& context_;
  VtkGrid grid_;
  std::vector<double> points_;
  std::vector<std::int64_t> types_, offsets_, corners_;
  std::vector<Data> data_;
  std::size_t next_coordinate_ = 0, next_type_ = 0, next_offset_ = 0, next_corner_ = 0;
};

}  // namespace

Mesh read_vtkhdf(const std::string& path, Context& context) {
  const Hdf5Turn turn;
  const LibraryReading reading(path, context);
  return VtkHdfReader(path, context).read();
}

}  // namespace delfront
