// SPDX-License-Identifier: Apache-2.0
// Medit solutions, text and binary: the fields on vertices that are scalars, vectors or symmetric tensors, in their
// order and without names. Tensors go as rows of the lower triangle (see read_sol.cpp).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <limits>

#include "delfront/errors.hpp"
#include "io/formats.hpp"
#include "io/gmf_output.hpp"

namespace delfront {

namespace {

/// 1 scalar, 2 vector, 3 symmetric tensor; 0 where Medit has none of so many components.
int solution_type(const Field& field, int dimension) {
  if (field.components == 1) return 1;
  if (field.components == dimension) return 2;
  return field.components == dimension * (dimension + 1) / 2 ? 3 : 0;
}

/// Those that the file can hold; sentences say which these are, and what is left out.
std::vector<const Field*> solutions_of(const Mesh& mesh, std::vector<std::string>& notes) {
  std::vector<const Field*> fields;
  std::vector<std::string> names;
  std::size_t num_left_out = 0;
  for (const Field& field : mesh.fields) {
    if (field.on != Field::On::vertices || solution_type(field, mesh.dimension) == 0) {
      ++num_left_out;
      continue;
    }
    fields.push_back(&field);
    constexpr const char* kTypes[] = {"scalar", "vector", "tensor"};
    names.push_back(fmt::format("{} ({})", field.name, kTypes[solution_type(field, mesh.dimension) - 1]));
  }
  if (fields.empty())
    throw InputError("Medit solutions hold fields on points (scalars, vectors, symmetric tensors), and there are none");
  notes.push_back(fmt::format("Medit solutions have no names; written in this order: {}", fmt::join(names, ", ")));
  if (num_left_out > 0)
    notes.push_back(fmt::format(
        "Medit solutions: {} field(s) on cells or of other components are left out; VTU keeps them", num_left_out));
  return fields;
}

/// Calls `put` for each value, node by node.
template <class Function>
void for_each_value(const Mesh& mesh, const std::vector<const Field*>& fields, std::size_t node, Function&& put) {
  for (const Field* field : fields) {
    const auto n = static_cast<std::size_t>(field->components);
    const double* const v = field->values.data() + node * n;
    constexpr std::array<std::size_t, 6> kRows = {0, 3, 1, 5, 4, 2};  // of xx yy zz xy yz xz
    const bool is_tensor_in_space = mesh.dimension == 3 && n == 6;
    for (std::size_t k = 0; k < n; ++k) put(v[is_tensor_in_space ? kRows[k] : k]);
  }
}

}  // namespace

void write_sol(const Mesh& mesh, Output& out, const WriteOptions&, Context& context, std::vector<std::string>& notes) {
  const std::vector<const Field*> fields = solutions_of(mesh, notes);
  out.text(fmt::format("MeshVersionFormatted 2\n\nDimension {}\n\nSolAtVertices\n{}\n{}", mesh.dimension,
                       mesh.points.size(), fields.size()));
  for (const Field* field : fields) out.text(fmt::format(" {}", solution_type(*field, mesh.dimension)));
  out.character('\n');
  for (std::size_t node = 0; node < mesh.points.size(); ++node) {
    if (node % 65536 == 0) context.check_limits();
    bool is_first = true;
    for_each_value(mesh, fields, node, [&](double value) {
      if (!is_first) out.character(' ');
      is_first = false;
      out.real(value);
    });
    out.character('\n');
  }
  out.text("\nEnd\n");
}

void write_solb(const Mesh& mesh, Output& out, const WriteOptions&, Context& context, std::vector<std::string>& notes) {
  if (mesh.points.size() > std::numeric_limits<std::int32_t>::max())
    throw InputError("binary Medit is written with at most 2^31 - 1 vertices; write .sol");
  const std::vector<const Field*> fields = solutions_of(mesh, notes);
  std::uint64_t num_values = 0;
  for (const Field* field : fields) num_values += field->values.size();
  const std::uint64_t bytes = 8 + 4 * fields.size() + 8 * num_values;
  GmfWriter gmf(out, bytes + 1000 < std::numeric_limits<std::int32_t>::max() ? 2 : 3);
  gmf.begin(gmf::kDimension, 4);
  gmf.integer(mesh.dimension);
  gmf.begin(gmf::kSolAtVertices, bytes);
  gmf.integer(static_cast<std::int64_t>(mesh.points.size()));
  gmf.integer(static_cast<std::int64_t>(fields.size()));
  for (const Field* field : fields) gmf.integer(solution_type(*field, mesh.dimension));
  for (std::size_t node = 0; node < mesh.points.size(); ++node) {
    if (node % 65536 == 0) context.check_limits();
    for_each_value(mesh, fields, node, [&](double value) { gmf.real(value); });
  }
  gmf.end();
}

}  // namespace delfront
