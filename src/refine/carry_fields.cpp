// SPDX-License-Identifier: Apache-2.0
#include "refine/carry_fields.hpp"

#include <algorithm>
#include <limits>

namespace delfront {

namespace {

Field carry_vertex_field(const Field& coarse, const MidPoints& mids, int threads) {
  Field fine = coarse;
  const auto n = static_cast<std::size_t>(coarse.components);
  fine.values.resize(n * mids.num_points());
  mids.for_each(threads, [&](std::size_t point, std::span<const std::uint32_t> corners) {
    const double share = 1 / static_cast<double>(corners.size());
    for (std::size_t k = 0; k < n; ++k) {
      double sum = 0;
      for (const std::uint32_t corner : corners) sum += share * coarse.values[n * corner + k];
      fine.values[n * point + k] = sum;
    }
  });
  return fine;
}

/// Each parent's values `copies` times, from child `first` on.
void copy_values(const Field& parents, std::size_t copies, std::size_t first, Field& children) {
  const auto n = static_cast<std::size_t>(parents.components);
  auto out = children.values.begin() + static_cast<std::ptrdiff_t>(first * n);
  for (std::size_t i = 0; i + n <= parents.values.size(); i += n)
    for (std::size_t copy = 0; copy < copies; ++copy)
      out = std::copy_n(parents.values.begin() + static_cast<std::ptrdiff_t>(i), n, out);
}

const Field* find_like(const Mesh& mesh, const Field& field, CellType block) {
  for (const Field& f : mesh.fields)
    if (f.on == Field::On::cells && f.block == block && f.name == field.name && f.components == field.components)
      return &f;
  return nullptr;
}

Field carry_cell_field(const Mesh& coarse, const Field& parents, const Mesh& fine) {
  Field children = parents;
  const ChildTable& table = child_table(parents.block);
  const std::size_t copies = parents.block == CellType::vertex ? 1 : table.num_children();
  children.values.assign(fine.num_cells(parents.block) * static_cast<std::size_t>(parents.components),
                         std::numeric_limits<double>::quiet_NaN());
  copy_values(parents, copies, 0, children);
  if (parents.block != CellType::tetrahedron) return children;
  if (const Field* pyramids = find_like(coarse, parents, CellType::pyramid))
    copy_values(*pyramids, child_table(CellType::pyramid).tets.size(), copies * coarse.num_cells(CellType::tetrahedron),
                children);
  return children;
}

/// A field of pyramids that tetrahedra do not have yet: for those that pyramids leave.
Field tet_field_of_pyramids(const Mesh& coarse, const Field& parents, const Mesh& fine) {
  Field none = parents;
  none.block = CellType::tetrahedron;
  none.values.assign(coarse.num_cells(CellType::tetrahedron) * static_cast<std::size_t>(parents.components),
                     std::numeric_limits<double>::quiet_NaN());
  return carry_cell_field(coarse, none, fine);
}

}  // namespace

void carry_fields(const Mesh& coarse, const MidPoints& mids, Mesh& fine, int threads) {
  for (const Field& field : coarse.fields) {
    if (field.on == Field::On::vertices) {
      fine.fields.push_back(carry_vertex_field(field, mids, threads));
      continue;
    }
    fine.fields.push_back(carry_cell_field(coarse, field, fine));
    if (field.block == CellType::pyramid && coarse.num_cells(CellType::pyramid) > 0 &&
        !find_like(coarse, field, CellType::tetrahedron))
      fine.fields.push_back(tet_field_of_pyramids(coarse, field, fine));
  }
}

}  // namespace delfront
