// SPDX-License-Identifier: Apache-2.0
// Medit solutions (.sol, ASCII), which stand beside a .mesh of the same stem. Scalars have 1 component, vectors 2 or 3.
// Tensors come in rows of the lower triangle, m11 m12 m22 m13 m23 m33; as a field xx yy zz xy yz xz (VTK's order), in
// the plane xx xy yy.
#include <fmt/format.h>

#include "delfront/errors.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

class SolReader {
 public:
  SolReader(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context)
      : cursor_(bytes, path, "#"), mesh_(mesh), context_(context) {}

  void read() {
    if (cursor_.next() != "MeshVersionFormatted")
      cursor_.fail("an ASCII Medit solution begins with MeshVersionFormatted; save binary ones (.solb) as .sol");
    cursor_.integer("version");
    for (std::string_view word = cursor_.next(); !word.empty() && word != "End"; word = cursor_.next()) {
      if (word == "Dimension")
        dimension_ = static_cast<int>(cursor_.integer_in("dimension", 2, 3));
      else if (word == "SolAtVertices")
        read_at_vertices();
      else
        skip(word);
    }
  }

 private:
  void skip(std::string_view word) {
    const auto is_word = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    if (!is_word(word[0])) cursor_.fail(fmt::format("'{}' where a keyword should stand", word.substr(0, 40)));
    while (!cursor_.peek().empty() && !is_word(cursor_.peek()[0])) cursor_.next();
  }

  /// Numbers a node of a type: 1 scalar, 2 vector, 3 symmetric tensor.
  int components(std::int64_t type) const {
    return type == 1 ? 1 : type == 2 ? dimension_ : dimension_ * (dimension_ + 1) / 2;
  }

  void read_at_vertices() {
    const std::size_t n = cursor_.count("number of nodes", 2);
    const std::size_t num_fields = cursor_.count("number of solutions", 2);
    std::vector<std::int64_t> types;
    std::vector<Field> fields;
    for (std::size_t i = 0; i < num_fields; ++i) {
      types.push_back(cursor_.integer_in("type of a solution", 1, 3));
      const std::string name = num_fields == 1 ? "sol" : fmt::format("sol{}", i + 1);
      fields.push_back({name, Field::On::vertices, CellType::vertex, components(types.back()), {}});
    }
    for (std::size_t node = 0; node < n; ++node) {
      if (node % kCheckEvery == 0) context_.check_limits();
      for (std::size_t i = 0; i < num_fields; ++i) read_values(types[i], fields[i]);
    }
    if (n != mesh_.points.size()) {
      context_.warn(fmt::format("{}: it has values for {} nodes, but the mesh has {} points; they are left out",
                                cursor_.path(), n, mesh_.points.size()));
      return;
    }
    for (Field& field : fields) mesh_.fields.push_back(std::move(field));
  }

  void read_values(std::int64_t type, Field& field) {
    std::array<double, 6> v{};
    for (int k = 0; k < field.components; ++k) v[static_cast<std::size_t>(k)] = cursor_.number("value of a solution");
    if (type == 3 && dimension_ == 3) v = {v[0], v[2], v[5], v[1], v[4], v[3]};
    field.values.insert(field.values.end(), v.begin(), v.begin() + field.components);
  }

  Cursor cursor_;
  Mesh& mesh_;
  Context& context_;
  int dimension_ = 3;
};

}  // namespace

void read_sol(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context) {
  SolReader(bytes, path, mesh, context).read();
}

}  // namespace delfront
