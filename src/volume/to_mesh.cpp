// SPDX-License-Identifier: Apache-2.0
#include "volume/to_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "base/hilbert.hpp"

namespace delfront {

namespace {

using Face = std::array<VertexIndex, 3>;

struct FaceHash {
  std::size_t operator()(const Face& k) const {
    std::uint64_t h = k[0] * 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 29) ^ k[1]) * 0xbf58476d1ce4e5b9ull;
    return (h ^ (h >> 31) ^ k[2]) * 0x94d049bb133111ebull;
  }
};

Face sorted(Face f) {
  std::sort(f.begin(), f.end());
  return f;
}

/// The model's triangle that a boundary face is, or is a part of.
class TriangleOfFace {
 public:
  TriangleOfFace(const Model& model, const std::vector<SplitTriangle>& split) : split_(split) {
    whole_.reserve(model.triangles.size());
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
      const auto& c = model.triangles[TriangleId(t)];
      whole_.emplace(sorted({c[0].value, c[1].value, c[2].value}), TriangleId(t));
    }
  }
  TriangleId find(const Face& face) const {
    if (const auto found = whole_.find(sorted(face)); found != whole_.end()) return found->second;
    for (const SplitTriangle& s : split_)
      if (std::all_of(face.begin(), face.end(), [&](VertexIndex v) {
            return std::find(s.outline.begin(), s.outline.end(), v) != s.outline.end();
          }))
        return s.triangle;
    DELFRONT_CHECK(false && "every boundary face lies in a triangle of the model");
    return {};
  }

 private:
  std::unordered_map<Face, TriangleId, FaceHash> whole_;
  const std::vector<SplitTriangle>& split_;
};

class Conversion {
 public:
  Conversion(const BoundaryGrid& grid, const Model& model) : c_(grid.complex), grid_(grid), model_(model) {}

  Mesh run() {
    add_groups();
    add_points();
    add_tets();
    add_faces();
    return std::move(mesh_);
  }

 private:
  void add_groups() {
    for (std::size_t i = 0; i < grid_.num_regions; ++i) {
      const bool is_named = i < model_.regions.size() && !model_.regions[RegionId(i)].name.empty();
      const std::string by_number = i == 0 ? "fluid" : fmt::format("region_{}", i + 1);
      region_group_.push_back(mesh_.add_group(3, is_named ? model_.regions[RegionId(i)].name : by_number));
    }
    patch_group_.resize(model_.patches.size());
  }

  /// The model's points first, as they came; the others along the Hilbert curve, for the caches of all who read it.
  void add_points() {
    const auto num_given = static_cast<VertexIndex>(std::min(model_.points.size(), c_.num_vertices()));
    std::vector<VertexIndex> added;
    std::vector<Point> places;
    for (VertexIndex v = num_given; v < c_.num_vertices(); ++v) {
      if (c_.vertex_tet[v] == kNoIndex) continue;
      added.push_back(v);
      places.push_back(c_.point(v));
    }
    new_id_.resize(c_.num_vertices());
    mesh_.points.reserve(num_given + added.size());
    auto add = [&](VertexIndex v) {
      new_id_[v] = mesh_.points.next_id();
      mesh_.points.push_back(c_.point(v));
    };
    for (VertexIndex v = 0; v < num_given; ++v)
      if (c_.vertex_tet[v] != kNoIndex) add(v);
    for (const std::uint32_t i : hilbert_order(places)) add(added[i]);
    mesh_.vertex_entity.resize(mesh_.points.size());
  }

  /// The live tets by their last vertex, which stands on the curve where there is one inside: a counting sort.
  std::vector<TetIndex> order_tets() const {
    std::vector<std::uint32_t> next(mesh_.points.size() + 1, 0);
    auto last_vertex = [&](TetIndex t) {
      const std::uint32_t* n = &c_.node[4 * t];
      return std::max({new_id_[n[0]].value, new_id_[n[1]].value, new_id_[n[2]].value, new_id_[n[3]].value});
    };
    auto for_each_tet = [&](auto&& visit) {
      for (TetIndex t = 0; t < c_.num_slots(); ++t)
        if (!c_.is_dead(t) && !c_.is_ghost(t)) visit(t);
    };
    for_each_tet([&](TetIndex t) { ++next[last_vertex(t) + 1]; });
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<TetIndex> order(next.back());
    for_each_tet([&](TetIndex t) { order[next[last_vertex(t)]++] = t; });
    return order;
  }

  void add_tets() {
    CellBlock& tets = mesh_.block(CellType::tetrahedron);
    const std::vector<TetIndex> order = order_tets();
    tets.vertices.reserve(4 * order.size());
    tets.group.reserve(order.size());
    for (const TetIndex t : order) {
      for (unsigned k = 0; k < 4; ++k) {
        const VertexId v = new_id_[c_.node[4 * t + k]];
        tets.vertices.push_back(v);
        mesh_.vertex_entity[v.index()].id = c_.region[t];
      }
      tets.group.push_back(region_group_[c_.region[t]]);
    }
  }

  struct BoundaryFace {
    TriangleId triangle;
    Face node;
    bool two_sided;
  };

  void add_faces() {
    const TriangleOfFace triangle_of(model_, grid_.split);
    std::vector<BoundaryFace> faces;
    for (TetIndex t = 0; t < c_.num_slots(); ++t) {
      if (c_.is_dead(t) || c_.is_ghost(t)) continue;
      for (unsigned f = 0; f < 4; ++f) {
        const FaceRef ref = 4 * t + f, other = c_.neigh[ref];
        if (!c_.is_constrained(ref)) continue;
        const bool two_sided = !c_.is_ghost(other >> 2);
        if (two_sided && std::pair(c_.region[t], ref) > std::pair(c_.region[other >> 2], other)) continue;
        const auto [a, b, c] = c_.face_nodes(ref);  // normal into the tet: outwards is the other way round
        faces.push_back({triangle_of.find({a, b, c}), {a, c, b}, two_sided});
      }
    }
    std::sort(faces.begin(), faces.end(), [](const BoundaryFace& a, const BoundaryFace& b) {
      return a.triangle != b.triangle ? a.triangle < b.triangle : sorted(a.node) < sorted(b.node);
    });
    CellBlock& triangles = mesh_.block(CellType::triangle);
    for (BoundaryFace& face : faces) {
      std::rotate(face.node.begin(), std::min_element(face.node.begin(), face.node.end()), face.node.end());
      const PatchId patch = model_.patch_of_triangle[face.triangle];
      triangles.group.push_back(group_of(patch, face.two_sided));
      for (const VertexIndex v : face.node) {
        triangles.vertices.push_back(new_id_[v]);
        put_on_patch(mesh_.vertex_entity[new_id_[v].index()], patch);
      }
    }
  }

  /// A patch with both one-sided and two-sided faces becomes two groups, since only one of them is a boundary.
  GroupId group_of(PatchId patch, bool two_sided) {
    GroupId& group = patch_group_[patch.index()][two_sided];
    if (group.is_valid()) return group;
    const Patch& p = model_.patches[patch];
    const bool other_exists = patch_group_[patch.index()][!two_sided].is_valid();
    group = mesh_.add_group(2, other_exists ? p.name + (two_sided ? "_inner" : "_outer") : p.name, p.kind);
    mesh_.groups[group].two_sided = two_sided;
    return group;
  }

  static void put_on_patch(VertexEntity& entity, PatchId patch) {
    if (entity.dimension == 3)
      entity = {2, patch.value, 0, 0};
    else if (entity.dimension == 2 && entity.id != patch.value)
      entity = {1, kNoIndex, 0, 0};  // between patches
  }

  const TetComplex& c_;
  const BoundaryGrid& grid_;
  const Model& model_;
  Mesh mesh_;
  std::vector<GroupId> region_group_;
  std::vector<std::array<GroupId, 2>> patch_group_;
  std::vector<VertexId> new_id_;
};

}  // namespace

Mesh to_mesh(const BoundaryGrid& grid, const Model& model) { return Conversion(grid, model).run(); }

}  // namespace delfront
