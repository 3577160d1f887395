// SPDX-License-Identifier: Apache-2.0
#include "pipeline/boundaries.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/name_pattern.hpp"
#include "delfront/errors.hpp"
#include "mesh/named_groups.hpp"
#include "pipeline/option_table.hpp"

namespace delfront {

static std::vector<std::string> patch_names(const Model& model) {
  std::vector<std::string> names;
  for (const Patch& patch : model.patches) names.push_back(patch.name);
  return names;
}

/// Two patches of one name could not be told apart in the grid.
static void refuse_second_far_field(const std::vector<BoundaryOptions>& boundaries,
                                    const std::vector<std::size_t>& boundary_of, const Model& model,
                                    PatchId far_field) {
  const std::size_t own = boundary_of[far_field.index()];
  const std::string name = own < boundaries.size() ? boundaries[own].name : model.patches[far_field].name;
  for (std::size_t i = 0; i < boundary_of.size(); ++i)
    if (PatchId(i) != far_field && boundary_of[i] < boundaries.size() && boundaries[boundary_of[i]].name == name)
      throw UsageError(
          fmt::format("boundaries.{}: patch '{}' of the input would get the name of the far field; give the boundary "
                      "another name, or the far field (domain.enclose.name)",
                      name, model.patches[PatchId(i)].name));
}

constexpr std::size_t kKept = static_cast<std::size_t>(-1);  // no boundary selects the patch

static UsageError no_such_patch(const BoundaryOptions& boundary, const std::string& pattern,
                                const std::vector<std::string>& names) {
  return UsageError(fmt::format("{}boundaries.{}: no patch is called '{}'{}; the input has: {}",
                                boundary.set_at.empty() ? "" : boundary.set_at + ": ", boundary.name, pattern,
                                did_you_mean(pattern, names), fmt::join(names, ", ")));
}

/// By patch, the last boundary that selects it.
static std::vector<std::size_t> select_patches(const std::vector<BoundaryOptions>& boundaries, const Model& model,
                                               PatchId far_field) {
  std::vector<std::size_t> boundary_of(model.patches.size(), kKept);
  for (std::size_t b = 0; b < boundaries.size(); ++b) {
    for (const std::string& pattern : boundaries[b].patterns()) {
      bool found = false;
      for (std::size_t i = 0; i < model.patches.size(); ++i) {
        const std::string& name = model.patches[PatchId(i)].name;
        const bool is_far_field = PatchId(i) == far_field;
        if (is_far_field ? name != pattern : !matches_pattern(name, pattern)) continue;
        boundary_of[i] = b;
        found = true;
      }
      if (!found) throw no_such_patch(boundaries[b], pattern, patch_names(model));
    }
  }
  return boundary_of;
}

/// Patches of one boundary become one, at the place of the first. @return the new patch of each old one
static std::vector<PatchId> merge_patches(const std::vector<BoundaryOptions>& boundaries,
                                          const std::vector<std::size_t>& boundary_of, Model& model) {
  Array<PatchId, Patch> patches;
  std::vector<PatchId> patch_of_boundary(boundaries.size()), new_patch(model.patches.size());
  for (std::size_t i = 0; i < model.patches.size(); ++i) {
    const Patch& old = model.patches[PatchId(i)];
    const std::size_t b = boundary_of[i];
    if (b == kKept) {
      new_patch[i] = patches.next_id();
      patches.push_back(old);
      continue;
    }
    if (!patch_of_boundary[b].is_valid()) {
      patch_of_boundary[b] = patches.next_id();
      patches.push_back({boundaries[b].name, boundaries[b].kind.empty() ? old.kind : boundaries[b].kind});
    }
    new_patch[i] = patch_of_boundary[b];
  }
  model.patches = std::move(patches);
  return new_patch;
}

PatchId apply_boundaries(const std::vector<BoundaryOptions>& boundaries, Model& model, PatchId far_field) {
  if (boundaries.empty()) return far_field;
  const std::vector<std::size_t> boundary_of = select_patches(boundaries, model, far_field);
  if (far_field.is_valid()) refuse_second_far_field(boundaries, boundary_of, model, far_field);
  const std::vector<PatchId> new_patch = merge_patches(boundaries, boundary_of, model);
  for (PatchId& patch : model.patch_of_triangle) patch = new_patch[patch.index()];
  return far_field.is_valid() ? new_patch[far_field.index()] : far_field;
}

std::vector<BoundaryOptions> boundaries_of_input(const Options& options) {
  std::vector<BoundaryOptions> boundaries = options.boundaries;
  const std::string& name = options.domain.enclose.name;
  for (BoundaryOptions& b : boundaries) std::erase(b.select = b.patterns(), name);
  std::erase_if(boundaries, [](const BoundaryOptions& b) { return b.select.empty(); });
  return boundaries;
}

Mesh surface_mesh(const Model& model) {
  Mesh mesh;
  mesh.points = model.points;
  for (const Patch& patch : model.patches) mesh.groups.push_back({patch.name, 2, patch.kind, false});
  CellBlock& block = mesh.block(CellType::triangle);
  block.vertices.reserve(3 * model.triangles.size());
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    for (const VertexId v : model.triangles[TriangleId(t)]) block.vertices.push_back(v);
    block.group.push_back(GroupId(model.patch_of_triangle[TriangleId(t)].index()));
  }
  NamedGroups curves(mesh, 1), corner_names(mesh, 0);
  for (const Curve& curve : model.curves)
    for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i) {
      CellBlock& lines = mesh.block(CellType::line);
      lines.vertices.insert(lines.vertices.end(), {curve.vertices[i], curve.vertices[i + 1]});
      lines.group.push_back(curves(curve.name));
    }
  for (std::size_t i = 0; i < model.corners.size(); ++i) {
    CellBlock& corners = mesh.block(CellType::vertex);
    corners.vertices.push_back(model.corners[i]);
    corners.group.push_back(corner_names(model.corner_names[i]));
  }
  return mesh;
}

}  // namespace delfront
