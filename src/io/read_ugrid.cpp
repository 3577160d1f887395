// SPDX-License-Identifier: Apache-2.0
// AFLR's UGRID: a header of seven counts, points, boundary faces, their surface numbers, volume cells, and perhaps the
// volume numbers of these. Text, or binary of either byte order with numbers of 4 or 8 bytes; the second suffix (.b8,
// .lb8, …) says which, else what fits the length of the file does. Names and kinds stand in a .mapbc beside it, as
// FUN3D reads it: its number of surfaces, then a line "number condition name" each. write_ugrid adds names of volumes
// there as
// "# volume <number> <name>", which those who read only the surfaces do not see.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/ugrid.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

struct Encoding {
  const char* suffix;
  bool is_big;
  int integer_bytes, real_bytes;
};
constexpr Encoding kEncodings[] = {{".b8.", true, 4, 8},   {".lb8.", false, 4, 8}, {".b4.", true, 4, 4},
                                   {".lb4.", false, 4, 4}, {".b8l.", true, 8, 8},  {".lb8l.", false, 8, 8}};

using Header = std::array<std::int64_t, 7>;

class UgridReader {
 public:
  UgridReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path), context_(context), groups_(mesh_) {}

  Mesh read() {
    is_text_ = looks_like_text();
    if (!is_text_) choose_encoding();
    std::array<std::size_t, 7> counts{};
    for (std::size_t i = 0; i < 7; ++i) counts[i] = read_count(i);
    read_points(counts[0]);
    has_volume_ = counts[3] + counts[4] + counts[5] + counts[6] > 0;
    const std::size_t last = mesh_.points.size();
    read_cells(CellType::triangle, counts[1], last);
    read_cells(CellType::quad, counts[2], last);
    if (!has_volume_) guess_dimension(mesh_);
    read_numbers({CellType::triangle, CellType::quad}, "surface number");
    for (std::size_t i = 2; i < kUgridTypes.size(); ++i) read_cells(kUgridTypes[i], counts[i + 1], last);
    if (has_volume_) read_volume_numbers();
    if (mesh_.top_dimension() < 0) throw InputError(fmt::format("{}: the UGRID file has no cells", cursor_.path()));
    check_finite(mesh_, cursor_.path());
    return std::move(mesh_);
  }

 private:
  bool looks_like_text() const {
    for (const char c : cursor_.bytes().substr(0, 64))
      if (static_cast<unsigned char>(c) > 126 ||
          (static_cast<unsigned char>(c) < 32 && c != '\t' && c != '\r' && c != '\n'))
        return false;
    return true;
  }

  /// @return bytes that a file with the header at its begin needs so; nullopt where the counts are none
  std::optional<double> length_in(const Encoding& encoding) {
    Cursor cursor(cursor_.bytes(), cursor_.path());
    cursor.swap_bytes = encoding.is_big;
    if (cursor.left() < 7 * static_cast<std::size_t>(encoding.integer_bytes)) return std::nullopt;
    double integers = 7, reals = 0;
    for (std::size_t i = 0; i < 7; ++i) {
      const std::int64_t n =
          encoding.integer_bytes == 4 ? cursor.binary<std::int32_t>("header") : cursor.binary<std::int64_t>("header");
      if (n < 0 || n > 0xffffffff) return std::nullopt;
      const double each = i == 0 ? 0 : num_vertices(kUgridTypes[i - 1]) + (i <= 2 ? 1 : 0);
      integers += each * static_cast<double>(n);
      if (i == 0) reals = 3 * static_cast<double>(n);
    }
    return integers * encoding.integer_bytes + reals * encoding.real_bytes;
  }

  void choose_encoding() {
    const auto size = static_cast<double>(cursor_.bytes().size());
    const std::string_view name = std::string_view(cursor_.path()).substr(cursor_.path().find_last_of('/') + 1);
    const Encoding* chosen = nullptr;
    double best = 0;
    for (const Encoding& encoding : kEncodings) {
      const std::optional<double> length = length_in(encoding);
      if (name.find(encoding.suffix) != std::string_view::npos) {
        if (!length || *length > size)
          throw InputError(
              fmt::format("{}: byte 0: the counts of the header need {} bytes in the encoding '{}', and the "
                          "file has {}; it is truncated, or its name says the wrong encoding",
                          cursor_.path(), length ? fmt::format("{:.0f}", *length) : "other", encoding.suffix,
                          cursor_.bytes().size()));
        chosen = &encoding;
        break;
      }
      if (length && *length <= size && (!chosen || *length > best)) {
        chosen = &encoding;
        best = *length;
      }
    }
    if (!chosen)
      throw InputError(
          fmt::format("{}: byte 0: no UGRID header fits the length of the file ({} bytes); it is truncated, "
                      "or of another kind (Fortran records, .r8 and .lr8, are not read: write .b8 or .lb8)",
                      cursor_.path(), cursor_.bytes().size()));
    cursor_.swap_bytes = chosen->is_big;
    encoding_ = *chosen;
  }

  std::int64_t integer(const char* what) {
    if (is_text_) return cursor_.integer(what);
    return encoding_.integer_bytes == 4 ? cursor_.binary<std::int32_t>(what) : cursor_.binary<std::int64_t>(what);
  }
  double real(const char* what) {
    if (is_text_) return cursor_.number(what);
    return encoding_.real_bytes == 4 ? static_cast<double>(cursor_.binary<float>(what)) : cursor_.binary<double>(what);
  }
  [[noreturn]] void fail(const std::string& message) const {
    if (is_text_) cursor_.fail(message);
    cursor_.fail_in_binary(message);
  }

  std::size_t read_count(std::size_t i) {
    const char* what = i == 0 ? "number of nodes" : "number of cells";
    const std::size_t entries = i == 0 ? 3 : static_cast<std::size_t>(num_vertices(kUgridTypes[i - 1]));
    const std::int64_t claimed = integer(what);
    if (claimed < 0) fail(fmt::format("{} {} is negative", what, claimed));
    const auto bytes_each = static_cast<std::size_t>(is_text_ ? 2
                                                     : i == 0 ? encoding_.real_bytes
                                                              : encoding_.integer_bytes);
    return cursor_.checked_count(claimed, what, entries * bytes_each);
  }

  void read_points(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      Point p;
      for (int k = 0; k < 3; ++k) p[k] = real("coordinate of a node");
      mesh_.points.push_back(p);
    }
  }

  void read_cells(CellType type, std::size_t n, std::size_t last) {
    const auto num = static_cast<std::size_t>(num_vertices(type));
    std::vector<VertexId> corners(num);
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      for (std::size_t k = 0; k < num; ++k) {
        const std::int64_t v = integer("node of a cell");
        if (v < 1 || static_cast<std::size_t>(v) > last)
          fail(fmt::format("{} {} has the node {}, and nodes are 1 to {}", name_of(type), i + 1, v, last));
        const bool is_face = dimension(type) == 2;
        corners[is_face && has_volume_ ? turned_place(type, k) : ugrid_place(type, k)] =
            VertexId(static_cast<std::size_t>(v - 1));
      }
      add_cell(mesh_, type, corners, GroupId());
    }
  }

  void read_numbers(std::initializer_list<CellType> types, const char* what) {
    for (const CellType type : types) {
      if (!mesh_.find_block(type)) continue;
      CellBlock& block = mesh_.block(type);
      for (GroupId& group : block.group) {
        const std::int64_t number = integer(what);
        if (number != 0) group = groups_(dimension(type), number);
      }
    }
  }

  /// Behind the cells there may be the number of cells in layers, and the volume of each cell.
  void read_volume_numbers() {
    if (is_text_ ? cursor_.at_end() : cursor_.left() == 0) return;
    const std::size_t num_cells = mesh_.num_cells_of_dimension(3);
    if (!is_text_ && cursor_.left() < (num_cells + 1) * static_cast<std::size_t>(encoding_.integer_bytes)) return;
    integer("number of cells in layers");
    read_numbers({CellType::tetrahedron, CellType::pyramid, CellType::prism, CellType::hexahedron}, "volume number");
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  TagGroups groups_;
  Encoding encoding_{};
  bool is_text_ = true, has_volume_ = false;
};

struct Condition {
  std::int64_t low, high;
  const char* kind;
};
/// FUN3D's numbers by what they are here.
constexpr Condition kConditions[] = {{3000, 3099, "wall"},     {4000, 4999, "wall"},     {5026, 5026, "outlet"},
                                     {5051, 5052, "outlet"},   {5000, 5050, "farfield"}, {6021, 6021, "symmetry"},
                                     {6661, 6663, "symmetry"}, {6100, 6199, "cyclic"},   {7011, 7011, "inlet"},
                                     {7021, 7021, "inlet"},    {7036, 7036, "inlet"},    {7100, 7199, "inlet"},
                                     {7012, 7012, "outlet"},   {7031, 7031, "outlet"}};

/// A grid of one region has no numbers of volumes.
void name_only_region(Mesh& mesh, const std::string& name) {
  for (const Group& group : mesh.groups)
    if (group.dimension == 3) return;
  if (name.empty() || mesh.num_cells_of_dimension(3) == 0) return;
  const GroupId region = mesh.add_group(3, name);
  for (CellBlock& block : mesh.blocks)
    if (dimension(block.type) == 3) std::fill(block.group.begin(), block.group.end(), region);
}

std::string kind_of_condition(std::int64_t number) {
  for (const Condition& condition : kConditions)
    if (number >= condition.low && number <= condition.high) return condition.kind;
  return "";
}

}  // namespace

Mesh read_ugrid(std::string_view bytes, const std::string& path, Context& context) {
  Mesh mesh = UgridReader(bytes, path, context).read();
  mark_inner_groups(mesh);
  return mesh;
}

void read_mapbc(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context) {
  Cursor cursor(bytes, path, "!");
  const std::size_t n = cursor.count("number of surfaces", 4);
  cursor.skip_line();
  std::size_t num_unknown = 0;
  const auto rename = [&](int dimension, std::int64_t number, std::string_view name, const std::string& kind) {
    const std::string given = fmt::format("{}_{}", role_name(mesh, dimension), number);
    const GroupId group = mesh.find_group(dimension, given);
    if (!group.is_valid()) return false;
    if (!name.empty()) mesh.groups[group].name = name;
    mesh.groups[group].kind = kind;
    return true;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t number = cursor.integer("number of a surface"), condition = cursor.integer("condition");
    num_unknown += !rename(2, number, cursor.rest_of_line(), kind_of_condition(condition));
  }
  while (!cursor.at_end()) {
    Cursor line(cursor.rest_of_line(), path);
    if (line.next_on_line() != "#" || line.next_on_line() != "volume") continue;
    std::int64_t number = 0;
    double value = 0;
    if (parse_number(line.next_on_line(), value) && value > 0 && value < 1e9) number = static_cast<std::int64_t>(value);
    const std::string name(line.rest_of_line());
    if (!rename(3, number, name, "") && number == 1) name_only_region(mesh, name);
  }
  if (num_unknown > 0) context.warn(fmt::format("{}: {} of its surfaces have no faces in the grid", path, num_unknown));
}

}  // namespace delfront
