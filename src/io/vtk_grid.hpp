// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

class TagGroups;

/// @brief What a file says of one group: "patch:wing" = id, dimension, kind, two-sided (vtk_names.hpp).
struct VtkName {
  std::string label;
  std::int64_t id = 0, dimension = 0;
  std::string kind;
  bool two_sided = false;

  /// @return true for "patch:…", "region:…" and so on
  static bool is_label(const std::string& label);
  /// @brief Of what an array holds; number and dimension -1 where that is not two whole numbers.
  static VtkName of(const std::string& label, std::span<const double> values, const std::string& kind, bool two_sided);
};

/// @brief Makes a Mesh of points, cells and data as VTK has them; its files (VTU, VTP, VTKHDF) and XDMF differ in how
/// they store those only. Cells are sorted by type, and each remembers which of the file it came from, so that cell
/// data finds it. All functions throw through `fail`, which says where in the file.
class VtkGrid {
 public:
  using Fail = std::function<void(const std::string&)>;  ///< must throw
  static constexpr int kPolyVertex = 2, kPolyLine = 4, kStrip = 6, kPixel = 8, kVoxel = 11, kPolyhedron = 42;

  explicit VtkGrid(std::string path) : path_(std::move(path)) {}

  /// @brief Begin a piece: its points, three numbers each; indices of its cells count from its first one.
  void add_points(std::span<const double> coordinates, const Fail& fail);
  /// @param type  VTK's number
  void add_cell(std::int64_t type, std::span<const std::int64_t> corners, const Fail& fail);
  /// @brief Number of faces, then of each its number of corners and the corners.
  void add_polyhedron(std::span<const std::int64_t> faces, const Fail& fail);
  /// @brief End a piece with one array on its points or cells.
  void add_data(Field::On on, const std::string& name, std::size_t components, std::span<const double> values,
                const Fail& fail);
  /// @brief The next piece begins behind what there is.
  void end_piece();

  std::size_t num_cells() const { return num_cells_; }
  std::size_t num_cells_of_piece() const { return num_cells_ - first_cell_; }
  std::size_t num_points_of_piece() const { return mesh_.points.size() - first_point_; }

  /// @brief The whole: groups by id arrays and names, fields.
  /// @param dimension  2 or 3 where the file says it, 0: found from the points (3 for surfaces)
  /// @param context  told which names and numbers of groups cannot be used
  /// @throws InputError  no cells, coordinates that are not finite
  Mesh finish(int dimension, bool is_surface, std::span<const VtkName> names, Context& context);

  /// @brief An array of text is no field; it is said where it should hold the numbers of groups.
  void leave_out_text(Field::On on, const std::string& name, Context& context) const;

 private:
  struct Data {
    int components = 1;
    std::vector<double> values;
  };

  VertexId vertex(std::int64_t index, const Fail& fail) const;
  void add(CellType type, std::span<const VertexId> vertices);
  void add_polygon(const Fail& fail);
  void add_plain_cell(std::int64_t number, const Fail& fail);
  void name_groups(TagGroups& groups, std::span<const VtkName> names, Context& context);
  void set_groups(std::span<const VtkName> names, Context& context);
  void set_fields();
  void set_cell_field(const std::string& name, const Data& data, CellType type);

  std::string path_;
  Mesh mesh_;
  std::size_t first_point_ = 0, first_cell_ = 0, num_cells_ = 0;
  std::vector<VertexId> corners_;
  std::array<std::vector<std::uint32_t>, kNumCellTypes> source_;  // cell of the file, by type
  std::map<std::string, Data> point_data_, cell_data_;
};

}  // namespace delfront
