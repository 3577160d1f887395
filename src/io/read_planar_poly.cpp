// SPDX-License-Identifier: Apache-2.0
// Triangle's .poly in the plane with its points inside: segments (their marker is the group), seeds of holes and of
// regions. Seeds become points of groups of dimension 0 and kind "hole" or "region"; the field "h" holds the size that
// a region's largest area asks for. The group of holes is there even when it is empty: in these files, only seeds make
// holes.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/poly_points.hpp"

namespace delfront {

namespace {

class PlanarPolyReader {
 public:
  PlanarPolyReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path, "#"), context_(context), groups_(mesh_) {}

  Mesh read() {
    mesh_.dimension = 2;
    read_points();
    read_segments();
    read_seeds("hole");
    read_seeds("region");
    check_finite(mesh_, cursor_.path());
    return std::move(mesh_);
  }

 private:
  void read_points() {
    const std::size_t n = cursor_.count("number of points", 6);
    cursor_.integer("dimension");
    cursor_.skip_line();
    first_index_ = read_poly_points(cursor_, n, 2, mesh_);
  }

  void read_segments() {
    const std::size_t n = cursor_.count("number of segments", 6);
    const bool has_markers = !cursor_.at_line_end() && cursor_.integer("marker flag") != 0;
    cursor_.skip_line();
    if (n == 0) cursor_.fail("the file has no segments");
    const auto last = first_index_ + static_cast<std::int64_t>(mesh_.points.size()) - 1;
    for (std::size_t i = 0; i < n; ++i) {
      if (i % 1024 == 0) context_.check_limits();
      cursor_.integer("index of a segment");
      VertexId ends[2];
      for (VertexId& end : ends)
        end = VertexId(static_cast<std::size_t>(cursor_.integer_in("point", first_index_, last) - first_index_));
      std::int64_t marker = 0;
      if (has_markers && !cursor_.at_line_end()) marker = cursor_.integer("marker");
      cursor_.skip_line();
      add_cell(mesh_, CellType::line, ends, groups_.by_marker(1, marker));
    }
  }

  void read_seeds(const std::string& kind) {
    if (kind == "hole") mesh_.groups.push_back({"holes", 0, kind, false});
    const GroupId holes(mesh_.groups.size() - 1);
    if (cursor_.at_end()) return;
    const std::size_t n = cursor_.count(kind.c_str(), 6);
    cursor_.skip_line();
    for (std::size_t i = 0; i < n; ++i) {
      cursor_.integer("index of a seed");
      Point p;
      for (int k = 0; k < 2; ++k) p[k] = cursor_.number("coordinate of a seed");
      const VertexId v = mesh_.points.next_id();
      mesh_.points.push_back(p);
      GroupId group = holes;
      if (kind == "region") {
        double number = 0, area = -1;
        if (!cursor_.at_line_end()) number = cursor_.number("attribute of a region");
        if (!cursor_.at_line_end()) area = cursor_.number("largest area of a region");
        group = mesh_.add_group(0, fmt::format("region_{:g}", number), kind);
        if (area > 0) set_size(v, std::sqrt(4 / std::sqrt(3.0) * area));
      }
      cursor_.skip_line();
      add_cell(mesh_, CellType::vertex, {&v, 1}, group);
    }
  }

  void set_size(VertexId v, double h) {
    if (mesh_.fields.empty()) mesh_.fields.push_back({"h", Field::On::vertices, CellType::vertex, 1, {}});
    std::vector<double>& values = mesh_.fields[0].values;
    values.resize(mesh_.points.size(), std::numeric_limits<double>::infinity());
    values[v.index()] = h;
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  TagGroups groups_;
  std::int64_t first_index_ = 1;
};

}  // namespace

Mesh read_planar_poly(std::string_view bytes, const std::string& path, Context& context) {
  return PlanarPolyReader(bytes, path, context).read();
}

}  // namespace delfront
