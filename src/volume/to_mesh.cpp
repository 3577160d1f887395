// SPDX-License-Identifier: Apache-2.0
// The complex becomes a Mesh. Both are large, so each array of the complex goes as soon as nothing needs it any more:
// first the boundary's faces are found, which take the neighbours; then the points are ordered; then the tets, whose
// nodes are renumbered in place before.
#include "volume/to_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <numeric>

#include "base/hilbert.hpp"
#include "base/parallel.hpp"
#include "mesh/bins.hpp"
#include "mesh/named_groups.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 16;  ///< slots a task

using Face = std::array<VertexIndex, 3>;

Face sorted(Face f) {
  std::sort(f.begin(), f.end());
  return f;
}

/// The model's triangle that a boundary face is, or is a part of.
class TriangleOfFace {
 public:
  TriangleOfFace(const Model& model, const std::vector<SplitTriangle>& split) : model_(model), split_(split) {
    first_.assign(model.points.size() + 1, 0);
    for (std::size_t t = 0; t < model.triangles.size(); ++t) ++first_[corners(t)[0]];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    triangles_.resize(model.triangles.size());
    for (std::size_t t = model.triangles.size(); t-- > 0;)
      triangles_[--first_[corners(t)[0]]] = static_cast<std::uint32_t>(t);
  }

  TriangleId find(const Face& face) const {
    const Face key = sorted(face);
    if (key[0] + std::size_t{1} < first_.size())
      for (std::uint32_t i = first_[key[0]]; i < first_[key[0] + 1]; ++i)
        if (corners(triangles_[i]) == key) return TriangleId(triangles_[i]);
    for (const SplitTriangle& s : split_)
      if (std::all_of(face.begin(), face.end(), [&](VertexIndex v) {
            return std::find(s.outline.begin(), s.outline.end(), v) != s.outline.end();
          }))
        return s.triangle;
    DELFRONT_CHECK(false && "every boundary face lies in a triangle of the model");
    return {};
  }

 private:
  Face corners(std::size_t t) const {
    const auto& c = model_.triangles[TriangleId(t)];
    return sorted({c[0].value, c[1].value, c[2].value});
  }

  const Model& model_;
  const std::vector<SplitTriangle>& split_;
  std::vector<std::uint32_t> first_, triangles_;  ///< triangles by their smallest vertex
};

class Conversion {
 public:
  Conversion(BoundaryGrid grid, const Model& model, int threads)
      : grid_(std::move(grid)), c_(grid_.complex), model_(model), threads_(threads), num_slots_(c_.num_slots()) {}

  Mesh run() {
    add_groups();
    find_faces();
    c_.neigh.release();
    c_.flag.release();
    add_points();
    c_.vertex.release();
    c_.vertex_tet.release();
    renumber_nodes();
    add_tets();
    c_ = TetComplex();
    add_faces();
    add_curves();
    add_corners();
    return std::move(mesh_);
  }

 private:
  struct BoundaryFace {
    TriangleId triangle;
    Face node;
    bool two_sided;
  };

  void add_groups() {
    NamedGroups regions(mesh_, 3);
    for (const std::string& name : grid_.regions) region_group_.push_back(regions(name));
    patch_group_.resize(model_.patches.size());
  }

  /// Neither dead nor a ghost: both have nothing for their last node.
  bool is_cell(std::size_t t) const { return c_.node[4 * t + 3] != kNoIndex; }

  void find_faces() {
    const TriangleOfFace triangle_of(model_, grid_.split);
    std::vector<std::vector<BoundaryFace>> found((num_slots_ + kGrain - 1) / kGrain);
    parallel_ranges(threads_, num_slots_, kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t t = first; t < last; ++t)
        if (is_cell(t)) find_faces(static_cast<TetIndex>(t), triangle_of, found[first / kGrain]);
    });
    for (const std::vector<BoundaryFace>& faces : found) faces_.insert(faces_.end(), faces.begin(), faces.end());
    std::sort(faces_.begin(), faces_.end(), [](const BoundaryFace& a, const BoundaryFace& b) {
      return a.triangle != b.triangle ? a.triangle < b.triangle : sorted(a.node) < sorted(b.node);
    });
  }

  void find_faces(TetIndex t, const TriangleOfFace& triangle_of, std::vector<BoundaryFace>& faces) const {
    for (unsigned f = 0; f < 4; ++f) {
      const FaceRef ref = 4 * t + f;
      if (!c_.is_constrained(ref)) continue;
      const FaceRef other = c_.neigh[ref];
      const bool two_sided = !c_.is_ghost(other >> 2);
      if (two_sided && std::pair(c_.region[t], ref) > std::pair(c_.region[other >> 2], other)) continue;
      const auto [a, b, c] = c_.face_nodes(ref);  // normal into the tet: outwards is the other way round
      faces.push_back({triangle_of.find({a, b, c}), {a, c, b}, two_sided});
    }
  }

  /// The model's points first, as they came; the others along the Hilbert curve, for the caches of all who read it.
  void add_points() {
    const auto num_given = static_cast<VertexIndex>(std::min(model_.points.size(), c_.num_vertices()));
    std::vector<VertexIndex> order;
    for (VertexIndex v = 0; v < num_given; ++v)
      if (c_.vertex_tet[v] != kNoIndex) order.push_back(v);
    append_added(num_given, order);
    new_id_.assign(c_.num_vertices(), kNoIndex);
    mesh_.points.resize(order.size());
    mesh_.vertex_entity.resize(order.size());
    parallel_ranges(threads_, order.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        new_id_[order[i]] = static_cast<VertexIndex>(i);
        mesh_.points[VertexId(i)] = c_.point(order[i]);
      }
    });
  }

  void append_added(VertexIndex num_given, std::vector<VertexIndex>& order) const {
    std::vector<VertexIndex> added;
    std::vector<Point> places;
    for (VertexIndex v = num_given; v < c_.num_vertices(); ++v) {
      if (c_.vertex_tet[v] == kNoIndex) continue;
      added.push_back(v);
      places.push_back(c_.point(v));
    }
    order.reserve(order.size() + added.size());
    for (const std::uint32_t i : hilbert_order(places, threads_)) order.push_back(added[i]);
  }

  void renumber_nodes() {
    parallel_ranges(threads_, num_slots_, kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t t = first; t < last; ++t)
        if (is_cell(t))
          for (std::size_t k = 4 * t; k < 4 * t + 4; ++k) c_.node[k] = new_id_[c_.node[k]];
    });
  }

  VertexIndex last_vertex(std::size_t t) const {
    const std::uint32_t* n = &c_.node[4 * t];
    return std::max(std::max(n[0], n[1]), std::max(n[2], n[3]));
  }

  /// The tets by their last vertex, which stands on the curve where there is one inside: sorted into bins of vertices,
  /// then within each.
  void add_tets() {
    const BinWidth width(mesh_.points.size());
    const Bins bins =
        sort_into_bins(num_slots_, width.num_bins, threads_, [&](std::size_t first, std::size_t last, auto&& visit) {
          for (std::size_t t = first; t < last; ++t)
            if (is_cell(t)) visit(t, width.bin_of(last_vertex(t)));
        });
    CellBlock& tets = mesh_.block(CellType::tetrahedron);
    tets.vertices.resize(4 * bins.items.size());
    tets.group.resize(bins.items.size());
    parallel_for(threads_, bins.size(), [&](std::size_t bin) {
      const std::size_t first_vertex = width.begin_of(bin);
      std::vector<std::size_t> next(width.width() + 1, 0);
      for (const TetIndex t : bins[bin]) ++next[last_vertex(t) - first_vertex + 1];
      next[0] = bins.offsets[bin];
      std::partial_sum(next.begin(), next.end(), next.begin());
      for (const TetIndex t : bins[bin]) put_tet(t, next[last_vertex(t) - first_vertex]++, tets);
    });
  }

  void put_tet(TetIndex t, std::size_t cell, CellBlock& tets) {
    for (std::size_t k = 0; k < 4; ++k) {
      const VertexIndex v = c_.node[4 * t + k];
      tets.vertices[4 * cell + k].value = v;
      // All tets of a vertex are in one region, but for vertices of the boundary: put_on_patch() overwrites those.
      std::atomic_ref(mesh_.vertex_entity[v].id).store(c_.region[t], std::memory_order_relaxed);
    }
    tets.group[cell] = region_group_[c_.region[t]];
  }

  void add_faces() {
    CellBlock& triangles = mesh_.block(CellType::triangle);
    triangles.vertices.reserve(3 * faces_.size());
    triangles.group.reserve(faces_.size());
    for (BoundaryFace& face : faces_) {
      std::rotate(face.node.begin(), std::min_element(face.node.begin(), face.node.end()), face.node.end());
      const PatchId patch = model_.patch_of_triangle[face.triangle];
      triangles.group.push_back(group_of(patch, face.two_sided));
      for (const VertexIndex v : face.node) {
        triangles.vertices.emplace_back(new_id_[v]);
        put_on_patch(mesh_.vertex_entity[new_id_[v]], patch);
      }
    }
  }

  void add_curves() {
    NamedGroups curves(mesh_, 1);
    for (std::size_t i = 0; i < grid_.curve_pieces.size(); ++i) {
      if (grid_.curve_pieces[i].empty()) continue;
      const GroupId group = curves(model_.curves[CurveId(i)].name);
      CellBlock& lines = mesh_.block(CellType::line);
      for (const auto& [a, b] : grid_.curve_pieces[i]) {
        lines.group.push_back(group);
        for (const VertexIndex v : {a, b}) {
          lines.vertices.emplace_back(new_id_[v]);
          put_on_curve(mesh_.vertex_entity[new_id_[v]], static_cast<std::uint32_t>(i));
        }
      }
    }
  }

  void add_corners() {
    NamedGroups names(mesh_, 0);
    for (std::size_t i = 0; i < model_.corners.size(); ++i) {
      const VertexIndex v = new_id_[model_.corners[i].index()];
      if (v == kNoIndex) continue;
      CellBlock& corners = mesh_.block(CellType::vertex);
      corners.group.push_back(names(model_.corner_names[i]));
      corners.vertices.emplace_back(v);
      mesh_.vertex_entity[v] = {0, static_cast<std::uint32_t>(i), 0, 0};
    }
  }

  static void put_on_curve(VertexEntity& entity, std::uint32_t curve) {
    if (entity.dimension > 1 || (entity.dimension == 1 && entity.id == kNoIndex))
      entity = {1, curve, 0, 0};
    else if (entity.dimension == 1 && entity.id != curve)
      entity = {0, kNoIndex, 0, 0};  // between curves
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

  BoundaryGrid grid_;
  TetComplex& c_;
  const Model& model_;
  int threads_;
  std::size_t num_slots_;
  Mesh mesh_;
  std::vector<GroupId> region_group_;
  std::vector<std::array<GroupId, 2>> patch_group_;
  std::vector<BoundaryFace> faces_;
  std::vector<VertexIndex> new_id_;  ///< the mesh's number of a vertex of the complex, or kNoIndex
};

}  // namespace

Mesh to_mesh(BoundaryGrid grid, const Model& model, int threads) {
  return Conversion(std::move(grid), model, threads).run();
}

}  // namespace delfront
