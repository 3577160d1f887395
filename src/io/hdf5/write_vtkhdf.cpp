// SPDX-License-Identifier: Apache-2.0
// VTKHDF 2.0, one partition: the arrays of a VTU as datasets. Names of groups are arrays of FieldData as there
// (vtk_names.hpp); their kind and two_sided are attributes of these. VTK before 9.5 and this version know no polyhedra.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/hdf5/hdf5_writer.hpp"
#include "io/vtk_blocks.hpp"

namespace delfront {

namespace {

const std::string kRoot = "/VTKHDF";

class VtkHdfWriter {
 public:
  VtkHdfWriter(const Mesh& mesh, Hdf5Writer& file, Context& context, std::vector<std::string>& notes)
      : mesh_(mesh), file_(file), context_(context), notes_(notes), blocks_(blocks_of(mesh, 0, 3)) {}

  void write() {
    file_.add_group(kRoot);
    const std::int64_t version[] = {2, 0}, dimension[] = {mesh_.dimension};
    file_.add_attribute(kRoot, "Version", version);
    file_.add_attribute(kRoot, "Type", std::string("UnstructuredGrid"));
    file_.add_attribute(kRoot, "dimension", dimension);
    write_cells();
    context_.check_limits();
    file_.add<double>(kRoot + "/Points", raw_coordinates(mesh_), 3);
    write_names();
    write_data();
  }

 private:
  void write_cells() {
    std::vector<std::span<const std::uint32_t>> pieces;
    std::vector<std::int64_t> offsets = {0};
    std::vector<std::uint8_t> types;
    for (const CellBlock* block : blocks_) {
      context_.check_limits();
      pieces.push_back(raw_ids(block->vertices));
      types.insert(types.end(), block->size(), static_cast<std::uint8_t>(vtk_number(block->type)));
      for (std::size_t cell = 0; cell < block->size(); ++cell)
        offsets.push_back(offsets.back() + static_cast<std::int64_t>((*block)[cell].size()));
    }
    const std::int64_t num_points[] = {static_cast<std::int64_t>(mesh_.points.size())};
    const std::int64_t num_cells[] = {static_cast<std::int64_t>(types.size())};
    const std::int64_t num_corners[] = {offsets.back()};
    file_.add<std::int64_t>(kRoot + "/NumberOfPoints", num_points);
    file_.add<std::int64_t>(kRoot + "/NumberOfCells", num_cells);
    file_.add<std::int64_t>(kRoot + "/NumberOfConnectivityIds", num_corners);
    file_.add<std::uint8_t>(kRoot + "/Types", types);
    file_.add<std::int64_t>(kRoot + "/Offsets", offsets);
    file_.add_integers(kRoot + "/Connectivity", pieces);
  }

  void write_names() {
    file_.add_group(kRoot + "/FieldData");
    for (const VtkName& name : group_names(mesh_, NameRule::hdf5, "VTKHDF", notes_)) {
      const std::string path = fmt::format("{}/FieldData/{}", kRoot, name.label);
      const std::int32_t values[] = {static_cast<std::int32_t>(name.id), static_cast<std::int32_t>(name.dimension)};
      file_.add<std::int32_t>(path, values);
      if (!name.kind.empty()) file_.add_attribute(path, "kind", name.kind);
      const std::int64_t yes[] = {1};
      if (name.two_sided) file_.add_attribute(path, "two_sided", yes);
    }
  }

  /// Where an array goes: names without '/', each once.
  std::string path_of(const char* group, const std::string& name) {
    std::string fitted = name.empty() || name == "." ? "field" : name;
    std::replace(fitted.begin(), fitted.end(), '/', '_');
    const std::string base = fitted;
    for (int number = 2; !taken_.insert(fmt::format("{}/{}", group, fitted)).second; ++number)
      fitted = fmt::format("{}_{}", base, number);
    if (fitted != name) notes_.push_back(fmt::format("VTKHDF: field \"{}\" is written as \"{}\"", name, fitted));
    return fmt::format("{}/{}/{}", kRoot, group, fitted);
  }

  void write_data() {
    file_.add_group(kRoot + "/PointData");
    for (const Field& field : mesh_.fields)
      if (field.on == Field::On::vertices)
        write_array(path_of("PointData", field.name), field.values, field.components);
    file_.add_group(kRoot + "/CellData");
    for (const IdArray& ids : id_arrays(mesh_, blocks_))
      file_.add<std::int32_t>(path_of("CellData", ids.name), ids.values);
    for (const auto& [name, components] : cell_field_names(mesh_))
      write_array(path_of("CellData", name), cell_field(mesh_, blocks_, name, components), components);
  }

  void write_array(const std::string& path, const std::vector<double>& values, int components) {
    context_.check_limits();
    file_.add<double>(path, values, components > 1 ? static_cast<std::size_t>(components) : 0);
  }

  const Mesh& mesh_;
  Hdf5Writer& file_;
  Context& context_;
  std::vector<std::string>& notes_;
  Blocks blocks_;
  std::set<std::string> taken_;
};

}  // namespace

void write_vtkhdf(const Mesh& mesh, const std::string& path, const std::string& shown_path, const WriteOptions& options,
                  Context& context, std::vector<std::string>& notes) {
  context.check_limits();
  check_size(mesh, "VTKHDF");
  if (const std::size_t n = mesh.num_cells(CellType::polyhedron); n > 0)
    throw InputError(fmt::format("VTKHDF 2.0 cannot hold {} polyhedra; write VTU", n));
  const Hdf5Turn turn;
  Hdf5Writer file(path, shown_path, options.compress);
  VtkHdfWriter(mesh, file, context, notes).write();
  file.close();
}

}  // namespace delfront
