// SPDX-License-Identifier: Apache-2.0
// Binary Medit files (GMF versions 1 to 4, either byte order) and their solutions (.solb). A file is a chain of
// keywords, each with the place of the next: those that say nothing about the grid here are jumped over. Reals have 4
// bytes in version 1, else 8; places have 8 bytes from version 3 on, counts and numbers in version 4. Names stand in
// comments as in the .mesh that write_medit makes.
#include <fmt/format.h>

#include <set>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/gmf.hpp"
#include "io/grid_parts.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

/// The chain of keywords and the numbers of a version.
class GmfFile {
 public:
  GmfFile(std::string_view bytes, const std::string& path, Context& context) : cursor_(bytes, path), context_(context) {
    const auto one = cursor_.binary<std::int32_t>("the byte order mark");
    cursor_.swap_bytes = one != 1;
    if (one != 1 && Cursor::swapped(one) != 1)
      cursor_.fail_in_binary("a binary Medit file begins with the number 1; this is none, or it is damaged");
    version_ = cursor_.binary<std::int32_t>("version");
    if (version_ < 1 || version_ > 4)
      cursor_.fail_in_binary(fmt::format("version {} of binary Medit files is not read; 1 to 4 are", version_));
  }

  /// Calls `take(keyword)` for each with the cursor behind its head.
  template <class Take>
  void for_each_keyword(const Take& take) {
    while (cursor_.left() >= 4) {
      const std::size_t begin = cursor_.position();
      const auto keyword = cursor_.binary<std::int32_t>("a keyword");
      if (keyword == gmf::kEnd && cursor_.left() < (version_ < 3 ? 4u : 8u)) return;
      const std::int64_t next = version_ < 3 ? cursor_.binary<std::int32_t>("the place of the next keyword")
                                             : cursor_.binary<std::int64_t>("the place of the next keyword");
      if (keyword == gmf::kEnd) return;
      context_.check_limits();
      if (keyword == gmf::kDimension) {
        dimension_ = cursor_.binary<std::int32_t>("dimension");
        if (dimension_ != 2 && dimension_ != 3) cursor_.fail_in_binary(fmt::format("dimension {}", dimension_));
      } else {
        take(keyword);
      }
      if (next == 0) return;
      if (next <= static_cast<std::int64_t>(begin) || next > static_cast<std::int64_t>(cursor_.bytes().size()))
        cursor_.fail_in_binary(fmt::format(
            "keyword {} says that the next one is at byte {}, and the file has {}; it is truncated or damaged", keyword,
            next, cursor_.bytes().size()));
      cursor_.move_to(static_cast<std::size_t>(next));
    }
  }

  std::size_t count(const char* what, std::size_t num_integers, std::size_t num_reals, std::size_t more = 0) {
    const std::int64_t claimed = integer(what);
    const std::size_t each = num_integers * integer_bytes() + num_reals * real_bytes() + more;
    if (claimed < 0 || static_cast<std::uint64_t>(claimed) > cursor_.left() / std::max<std::size_t>(each, 1))
      cursor_.fail_in_binary(fmt::format("{} {}: only {} bytes follow, {} each; the file is truncated or damaged", what,
                                         claimed, cursor_.left(), each));
    return static_cast<std::size_t>(claimed);
  }
  std::int64_t integer(const char* what) {
    return version_ < 4 ? cursor_.binary<std::int32_t>(what) : cursor_.binary<std::int64_t>(what);
  }
  double real(const char* what) {
    return version_ < 2 ? static_cast<double>(cursor_.binary<float>(what)) : cursor_.binary<double>(what);
  }
  std::size_t integer_bytes() const { return version_ < 4 ? 4 : 8; }
  std::size_t real_bytes() const { return version_ < 2 ? 4 : 8; }
  int dimension() const { return dimension_; }
  Cursor& cursor() { return cursor_; }

 private:
  Cursor cursor_;
  Context& context_;
  std::int32_t version_ = 2;
  int dimension_ = 3;
};

class MeshbReader {
 public:
  MeshbReader(std::string_view bytes, const std::string& path, Context& context)
      : file_(bytes, path, context), context_(context), groups_(mesh_) {}

  Mesh read() {
    file_.for_each_keyword([&](std::int32_t keyword) { take(keyword); });
    for (std::string_view rest = file_.cursor().bytes().substr(file_.cursor().position()); !rest.empty();) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      take_name(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    const std::string& path = file_.cursor().path();
    if (mesh_.top_dimension() < 0) throw InputError(fmt::format("{}: the Medit file has no cells", path));
    for (const NamedNumber& named : names_) {
      groups_.name(named.dimension, named.number, named.name, named.kind);
      mesh_.groups[groups_(named.dimension, named.number)].two_sided = named.two_sided;
    }
    check_vertices(mesh_, path, 1);
    check_finite(mesh_, path);
    if (names_.empty()) mark_inner_groups(mesh_);
    return std::move(mesh_);
  }

 private:
  void take(std::int32_t keyword) {
    mesh_.dimension = file_.dimension();
    if (keyword == gmf::kVertices) return read_vertices();
    if (keyword == gmf::kComments) return read_names();
    if (keyword == gmf::kCorners || keyword == gmf::kRequiredVertices) return read_points();
    for (int i = 0; i < kNumCellTypes; ++i)
      if (gmf::keyword(static_cast<CellType>(i)) == keyword) return read_cells(static_cast<CellType>(i));
  }

  void read_vertices() {
    const auto d = static_cast<std::size_t>(file_.dimension());
    const std::size_t n = file_.count("number of vertices", 1, d);
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      Point p;
      for (int k = 0; k < file_.dimension(); ++k) p[k] = file_.real("coordinate of a vertex");
      file_.integer("reference of a vertex");
      mesh_.points.push_back(p);
    }
  }

  VertexId vertex() {
    const std::int64_t v = file_.integer("vertex of a cell");
    if (v < 1 || v >= static_cast<std::int64_t>(Id<VertexTag>::kNone))
      file_.cursor().fail_in_binary(fmt::format("a cell has the vertex {}; they count from 1", v));
    return VertexId(static_cast<std::size_t>(v - 1));
  }

  void read_cells(CellType type) {
    const auto num = static_cast<std::size_t>(num_vertices(type));
    const std::size_t n = file_.count("number of cells", num + 1, 0);
    std::vector<VertexId> corners(num);
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      for (VertexId& v : corners) v = vertex();
      const std::int64_t reference = file_.integer("reference of a cell");
      add_cell(mesh_, type, corners, reference != 0 ? groups_(dimension(type), reference) : GroupId());
    }
  }

  /// A vertex may be both a corner and required.
  void read_points() {
    const std::size_t n = file_.count("number of vertices", 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const VertexId v = vertex();
      if (is_point_.insert(v).second) add_cell(mesh_, CellType::vertex, {&v, 1}, GroupId());
    }
  }

  void take_name(std::string_view text) {
    constexpr std::string_view kMark = "#delfront ";
    NamedNumber named;
    if (text.starts_with(kMark) && parse_name_line(text.substr(kMark.size()), named)) names_.push_back(named);
  }

  void read_names() {
    const std::size_t n = file_.count("number of comments", 0, 0, gmf::kCommentLength);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view text = file_.cursor().take_bytes(gmf::kCommentLength, "a comment");
      take_name(text.substr(0, text.find('\0')));
    }
  }

  GmfFile file_;
  Context& context_;
  Mesh mesh_;
  TagGroups groups_;
  std::vector<NamedNumber> names_;
  std::set<VertexId> is_point_;
};

/// Values of one keyword SolAtVertices.
void read_solutions(GmfFile& file, Mesh& mesh, Context& context) {
  const std::size_t n = file.count("number of nodes", 0, 1);
  const auto num_fields = file.cursor().binary<std::int32_t>("number of solutions");
  file.cursor().checked_count(num_fields, "number of solutions", 4);
  std::vector<std::int32_t> types;
  std::vector<Field> fields;
  const int d = file.dimension();
  std::size_t reals = 0;
  for (std::int32_t i = 0; i < num_fields; ++i) {
    types.push_back(file.cursor().binary<std::int32_t>("type of a solution"));
    if (types.back() < 1 || types.back() > 3)
      file.cursor().fail_in_binary(fmt::format("type {} of a solution; 1 to 3 are read", types.back()));
    const int components = types.back() == 1 ? 1 : types.back() == 2 ? d : d * (d + 1) / 2;
    reals += static_cast<std::size_t>(components);
    const std::string name = num_fields == 1 ? "sol" : fmt::format("sol{}", i + 1);
    fields.push_back({name, Field::On::vertices, CellType::vertex, components, {}});
  }
  if (reals > 0 && n > file.cursor().left() / (reals * file.real_bytes()))
    file.cursor().fail_short("the values of a solution");
  for (std::size_t node = 0; node < n; ++node) {
    if (node % kCheckEvery == 0) context.check_limits();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      std::array<double, 6> v{};
      for (int k = 0; k < fields[i].components; ++k) v[static_cast<std::size_t>(k)] = file.real("value of a solution");
      if (types[i] == 3 && d == 3)
        v = {v[0], v[2], v[5], v[1], v[4], v[3]};
      else if (types[i] == 3)
        v = {v[0], v[1], v[2]};
      fields[i].values.insert(fields[i].values.end(), v.begin(), v.begin() + fields[i].components);
    }
  }
  if (n != mesh.points.size()) {
    context.warn(fmt::format("{}: it has values for {} nodes, but the mesh has {} points; they are left out",
                             file.cursor().path(), n, mesh.points.size()));
    return;
  }
  for (Field& field : fields) mesh.fields.push_back(std::move(field));
}

}  // namespace

Mesh read_meshb(std::string_view bytes, const std::string& path, Context& context) {
  return MeshbReader(bytes, path, context).read();
}

void read_solb(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context) {
  GmfFile file(bytes, path, context);
  file.for_each_keyword([&](std::int32_t keyword) {
    if (keyword == gmf::kSolAtVertices) read_solutions(file, mesh, context);
  });
}

}  // namespace delfront
