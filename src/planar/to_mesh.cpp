// SPDX-License-Identifier: Apache-2.0
#include "planar/to_mesh.hpp"

#include <algorithm>
#include <numeric>

#include "base/hilbert.hpp"
#include "planar/kernel.hpp"

namespace delfront {

namespace {

constexpr std::int8_t kInRegion = 2, kOnCurve = 1, kCorner = 0;

class Conversion {
 public:
  Conversion(const PlanarGrid& grid, const PlanarDomain& domain)
      : c_(grid.complex), grid_(grid), domain_(domain), curve_group_(domain.curves.size()) {}

  Mesh run() {
    mesh_.dimension = 2;
    for (const std::string& name : grid_.region_names) region_group_.push_back(mesh_.add_group(2, name));
    add_points();
    add_triangles();
    add_lines();
    return std::move(mesh_);
  }

 private:
  bool is_kept(TriIndex t) const { return !c_.is_dead(t) && c_.tri[t].region != kOutside; }

  void add_points() {
    std::vector<bool> is_used(c_.point.size(), false);
    for (TriIndex t = 0; t < c_.tri.size(); ++t)
      if (is_kept(t))
        for (const VertexIndex v : c_.tri[t].node) is_used[v] = true;
    const auto num_given = static_cast<VertexIndex>(domain_.points.size());
    new_id_.resize(c_.point.size());
    mesh_.points.reserve(c_.point.size());
    const auto add = [&](VertexIndex v) {
      new_id_[v] = mesh_.points.next_id();
      mesh_.points.push_back({c_.point[v].x, c_.point[v].y, 0});
    };
    const HilbertCurve2 curve(c_.point);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> added;
    for (VertexIndex v = 0; v < c_.point.size(); ++v) {
      if (!is_used[v]) continue;
      if (v < num_given)
        add(v);
      else
        added.push_back({curve.key(c_.point[v]), v});
    }
    radix_sort(added);
    for (const auto& [key, v] : added) add(v);
    mesh_.vertex_entity.assign(mesh_.points.size(), VertexEntity{kInRegion, 0, 0, 0});
  }

  /// By their last vertex, which stands on the curve where there is one inside: a counting sort.
  void add_triangles() {
    std::vector<std::uint32_t> next(mesh_.points.size() + 1, 0);
    const auto last_vertex = [&](TriIndex t) {
      const VertexIndex* n = c_.tri[t].node;
      return std::max({new_id_[n[0]].value, new_id_[n[1]].value, new_id_[n[2]].value});
    };
    for (TriIndex t = 0; t < c_.tri.size(); ++t)
      if (is_kept(t)) ++next[last_vertex(t) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    CellBlock& block = mesh_.block(CellType::triangle);
    block.vertices.resize(3 * std::size_t(next.back()));
    block.group.resize(next.back());
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (!is_kept(t)) continue;
      const std::size_t place = next[last_vertex(t)]++;
      for (unsigned k = 0; k < 3; ++k) {
        const VertexId v = new_id_[c_.tri[t].node[k]];
        block.vertices[3 * place + k] = v;
        mesh_.vertex_entity[v.index()].id = c_.tri[t].region;
      }
      block.group[place] = region_group_[c_.tri[t].region];
    }
  }

  void add_lines() {
    CellBlock& lines = mesh_.block(CellType::line);
    for (const PlanarPiece& piece : grid_.pieces) {
      const EdgeRef ref = c_.find_edge(piece.a, piece.b);
      DELFRONT_CHECK(ref != kNoTri);
      const std::uint32_t left = c_.tri[ref >> 2].region, right = c_.tri[c_.across(ref) >> 2].region;
      if (left == kOutside && right == kOutside) continue;
      const bool is_turned = right < left;  // kOutside is the largest colour of all
      lines.vertices.push_back(new_id_[is_turned ? piece.b : piece.a]);
      lines.vertices.push_back(new_id_[is_turned ? piece.a : piece.b]);
      lines.group.push_back(group_of(piece.curve, left != kOutside && right != kOutside));
      put_on_curve(piece.a, piece.curve);
      put_on_curve(piece.b, piece.curve);
    }
  }

  GroupId group_of(std::uint32_t curve, bool two_sided) {
    GroupId& group = curve_group_[curve][two_sided];
    if (group.is_valid()) return group;
    const PlanarCurve& c = domain_.curves[CurveId(curve)];
    const bool other_exists = curve_group_[curve][!two_sided].is_valid();
    group = mesh_.add_group(1, other_exists ? c.name + (two_sided ? "_inner" : "_outer") : c.name, c.kind);
    mesh_.groups[group].two_sided = two_sided;
    return group;
  }

  void put_on_curve(VertexIndex v, std::uint32_t curve) {
    VertexEntity& entity = mesh_.vertex_entity[new_id_[v].index()];
    if (entity.dimension == kInRegion)
      entity = {kOnCurve, curve, 0, 0};
    else if (entity.dimension == kOnCurve && entity.id != curve)
      entity = {kCorner, v, 0, 0};  // between curves
  }

  const TriComplex& c_;
  const PlanarGrid& grid_;
  const PlanarDomain& domain_;
  Mesh mesh_;
  std::vector<GroupId> region_group_;
  std::vector<std::array<GroupId, 2>> curve_group_;
  std::vector<VertexId> new_id_;
};

}  // namespace

Mesh to_mesh(const PlanarGrid& grid, const PlanarDomain& domain) { return Conversion(grid, domain).run(); }

}  // namespace delfront
