// SPDX-License-Identifier: Apache-2.0
// A domain from lines in the plane: points welded by exact equality as surfaces' are, groups as curves, seeds from
// groups of points.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "delfront/planar.hpp"

namespace delfront {

namespace {

constexpr std::size_t kLinesPerLimitCheck = std::size_t{1} << 16;

class DomainBuilder {
 public:
  PlanarDomain run(const std::vector<NamedMesh>& inputs, Context& context) {
    for (const NamedMesh& input : inputs) {
      context.check_limits();
      check_places(input);
      curve_of_group_.assign(input.mesh.groups.size() + 1, CurveId());
      vertex_.assign(input.mesh.points.size(), VertexId());
      add_seeds(input.mesh);
      add_lines(input, context);
      add_free_points(input.mesh);
    }
    if (domain_.segments.empty()) throw InputError("no lines in the input: nothing bounds a part of the plane");
    return std::move(domain_);
  }

 private:
  static void check_places(const NamedMesh& input) {
    for (std::size_t i = 0; i < input.mesh.points.size(); ++i) {
      const Point p = input.mesh.points[VertexId(i)];
      if (is_finite(p) && p.z == 0) continue;
      throw InputError(
          fmt::format("{}: point {} at ({:g}, {:g}, {:g}) is not in the plane z = 0", input.stem, i, p.x, p.y, p.z),
          {{p, {static_cast<std::uint32_t>(i)}}});
    }
  }

  static std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x + 0.0); }  // -0 is 0

  VertexId add_point(const Mesh& mesh, VertexId v) {
    VertexId& welded = vertex_[v.index()];
    if (welded.is_valid()) return welded;
    const Point p = mesh.points[v];
    const std::uint64_t key = (bits(p.x) * 0x9e3779b97f4a7c15ull ^ std::rotl(bits(p.y), 29)) * 0xbf58476d1ce4e5b9ull;
    const auto [begin, end] = at_.equal_range(key);
    for (auto it = begin; it != end; ++it)
      if (domain_.points[it->second] == Point2{p.x, p.y}) return welded = it->second;
    welded = domain_.points.next_id();
    domain_.points.push_back({p.x, p.y});
    at_.emplace(key, welded);
    return welded;
  }

  /// Points of groups "hole" and "region" say what lies around them, and are not gridded.
  void add_seeds(const Mesh& mesh) {
    is_seed_.assign(mesh.points.size(), false);
    for (const Group& group : mesh.groups)
      if (group.dimension == 0 && group.kind == "hole") domain_.inner_loops = InnerLoops::are_regions;
    const CellBlock* vertices = mesh.find_block(CellType::vertex);
    const std::vector<double>* h = nullptr;
    for (const Field& field : mesh.fields)
      if (field.name == "h" && field.on == Field::On::vertices && field.components == 1) h = &field.values;
    for (std::size_t i = 0; vertices && i < vertices->size(); ++i) {
      const GroupId group = vertices->group[i];
      if (!group.is_valid()) continue;
      const VertexId v = (*vertices)[i][0];
      const Point2 at{mesh.points[v].x, mesh.points[v].y};
      const std::string& kind = mesh.groups[group].kind;
      if (kind == "hole") {
        domain_.holes.push_back(at);
      } else if (kind == "region") {
        PlanarSeed seed{at, mesh.groups[group].name, {}};
        if (h && v.index() < h->size() && (*h)[v.index()] < 1e300) seed.h = (*h)[v.index()];
        domain_.regions.push_back(seed);
      } else {
        continue;
      }
      is_seed_[v.index()] = true;
    }
  }

  void add_lines(const NamedMesh& input, const Context& context) {
    const CellBlock* lines = input.mesh.find_block(CellType::line);
    for (std::size_t i = 0; lines && i < lines->size(); ++i) {
      if (i % kLinesPerLimitCheck == 0) context.check_limits();
      const GroupId group = lines->group.empty() ? GroupId() : lines->group[i];
      domain_.segments.push_back({add_point(input.mesh, (*lines)[i][0]), add_point(input.mesh, (*lines)[i][1])});
      domain_.curve_of_segment.push_back(curve_of(input, group));
    }
  }

  CurveId curve_of(const NamedMesh& input, GroupId group) {
    CurveId& curve = curve_of_group_[group.is_valid() ? group.index() : input.mesh.groups.size()];
    if (curve.is_valid()) return curve;
    const bool is_named = group.is_valid() && !input.mesh.groups[group].name.empty();
    const std::string wanted = is_named ? input.mesh.groups[group].name : input.stem;
    std::string name = wanted;
    for (int k = 2; !names_.insert(name).second; ++k) name = fmt::format("{}_{}", wanted, k);
    curve = domain_.curves.next_id();
    domain_.curves.push_back({name, group.is_valid() ? input.mesh.groups[group].kind : ""});
    return curve;
  }

  /// Points that no line uses stand free, but where they belong to cells, which are not used.
  void add_free_points(const Mesh& mesh) {
    if (mesh.top_dimension() > 1) return;
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
      if (!is_seed_[i]) add_point(mesh, VertexId(i));
  }

  PlanarDomain domain_;
  std::vector<CurveId> curve_of_group_;  ///< of the input's groups; last: of lines without one
  std::vector<VertexId> vertex_;         ///< of the input's points
  std::vector<bool> is_seed_;
  std::unordered_multimap<std::uint64_t, VertexId> at_;
  std::set<std::string> names_;
};

}  // namespace

PlanarDomain build_planar_domain(const std::vector<NamedMesh>& inputs, Context& context) {
  return DomainBuilder().run(inputs, context);
}

}  // namespace delfront
