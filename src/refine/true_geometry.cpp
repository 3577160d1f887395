// SPDX-License-Identifier: Apache-2.0
#include "refine/true_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/surface.hpp"

namespace delfront {

namespace {

constexpr double kCosAlike = 0.5;  ///< 60 degrees
constexpr std::uint32_t kNoCurve = Id<struct CurveTag>::kNone;

Point unit(Point v) {
  const double l = length(v);
  return l > 0 ? v / l : Point{};
}

/// A patch with faces of both kinds becomes two groups in grids of ours.
bool is_called(const std::string& group, const std::string& patch) {
  return group == patch || group == patch + "_inner" || group == patch + "_outer";
}

bool is_outer_kind(const std::string& kind) {
  return kind == "farfield" || kind == "symmetry" || kind == "empty" || kind == "wedge" || kind == "inlet" ||
         kind == "outlet" || kind == "cyclic";
}

}  // namespace

TrueGeometry::TrueGeometry(const Model& model, const Array<GroupId, Group>& groups, double feature_angle_deg)
    : model_(model), cos_feature_angle_(std::cos(feature_angle_deg * std::numbers::pi / 180)) {
  is_plane_ = model.triangles.empty();
  match_groups(groups);
  add_triangles();
  add_features();
}

void TrueGeometry::match_groups(const Array<GroupId, Group>& groups) {
  const std::size_t num_names = is_plane_ ? model_.curves.size() : model_.patches.size();
  const auto name = [&](std::size_t i) -> const std::string& {
    return is_plane_ ? model_.curves[CurveId(i)].name : model_.patches[PatchId(i)].name;
  };
  named_.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Group& group = groups[GroupId(g)];
    is_outer_.push_back(is_outer_kind(group.kind));
    const bool is_boundary = group.dimension == (is_plane_ ? 1 : 2);
    std::vector<bool> named(is_boundary ? num_names : 0);
    for (std::size_t i = 0; i < named.size(); ++i) named[i] = is_called(group.name, name(i));
    if (std::find(named.begin(), named.end(), true) == named.end()) continue;
    named_[g] = std::move(named);
    has_names_ = true;
  }
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (groups[GroupId(g)].dimension == (is_plane_ ? 1 : 2) && !is_known(GroupId(g)))
      unknown_groups_.push_back(groups[GroupId(g)].name);
}

bool TrueGeometry::is_known(GroupId group) const {
  if (!group.is_valid() || group.index() >= named_.size()) return !has_names_;
  return has_names_ ? !named_[group.index()].empty() : !is_outer_[group.index()];
}

void TrueGeometry::add_triangles() {
  std::vector<std::array<Point, 3>> corners;
  corners.reserve(model_.triangles.size());
  for (const auto& [a, b, c] : model_.triangles) {
    corners.push_back({model_.points[a], model_.points[b], model_.points[c]});
    normals_.push_back(unit(cross(corners.back()[1] - corners.back()[0], corners.back()[2] - corners.back()[0])));
  }
  triangles_ = TriangleTree(std::move(corners));
}

/// Edges that turn, between patches, or of other than two triangles; and the curves.
void TrueGeometry::add_features() {
  std::vector<std::array<Point, 3>> corners;
  const auto add = [&](VertexId a, VertexId b, std::uint32_t curve) {
    const Point p = model_.points[a], q = model_.points[b];
    corners.push_back({p, q, q});
    directions_.push_back(unit(q - p));
    curve_of_feature_.push_back(curve);
  };
  std::vector<bool> is_used(model_.triangles.size());
  for (std::size_t t = 0; t < is_used.size(); ++t) {
    const auto& [a, b, c] = model_.triangles[TriangleId(t)];
    is_used[t] = a != b && b != c && c != a;
  }
  const SurfaceEdges edges(model_.triangles, is_used);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto halves = edges.half_edges(e);
    bool is_feature = halves.size() != 2;
    if (!is_feature) {
      const std::uint32_t s = halves[0] / 3, t = halves[1] / 3;
      const auto start = [&](std::uint32_t h) { return model_.triangles[TriangleId(h / 3)][h % 3]; };
      const double sign = start(halves[0]) == start(halves[1]) ? -1 : 1;  // one of them is turned round
      is_feature = model_.patch_of_triangle[TriangleId(s)] != model_.patch_of_triangle[TriangleId(t)] ||
                   sign * dot(normals_[s], normals_[t]) < cos_feature_angle_;
    }
    if (is_feature) add(edges.ends(e)[0], edges.ends(e)[1], kNoCurve);
  }
  for (std::size_t c = 0; c < model_.curves.size(); ++c) {
    const std::vector<VertexId>& vertices = model_.curves[CurveId(c)].vertices;
    for (std::size_t i = 1; i < vertices.size(); ++i) add(vertices[i - 1], vertices[i], static_cast<std::uint32_t>(c));
  }
  features_ = TriangleTree(std::move(corners));
}

TrueGeometry::Hit TrueGeometry::nearest_on_surface(Point p, Point normal, std::span<const GroupId> groups,
                                                   double reach) const {
  const auto is_meant = [&](std::uint32_t t) {
    const std::size_t patch = model_.patch_of_triangle[TriangleId(t)].index();
    for (const GroupId group : groups)
      if (group.is_valid() && !named_[group.index()].empty() && named_[group.index()][patch]) return true;
    return false;
  };
  return triangles_.nearest_if(
      p,
      [&](std::uint32_t t) { return std::abs(dot(normal, normals_[t])) >= kCosAlike && (!has_names_ || is_meant(t)); },
      reach);
}

TrueGeometry::Hit TrueGeometry::nearest_on_features(Point p, Point direction, GroupId curve, double reach) const {
  const bool is_named = is_plane_ && curve.is_valid() && !named_[curve.index()].empty();
  return features_.nearest_if(
      p,
      [&](std::uint32_t f) {
        if (is_named && !named_[curve.index()][curve_of_feature_[f]]) return false;
        return std::abs(dot(direction, directions_[f])) >= kCosAlike;
      },
      reach);
}

TrueGeometry::Hit TrueGeometry::nearest(Point p, double reach) const {
  return (is_plane_ ? features_ : triangles_)
      .nearest_if(
          p, [](std::uint32_t) { return true; }, reach);
}

bool TrueGeometry::is_on_feature(Point p, double tolerance) const {
  return features_
      .nearest_if(
          p, [](std::uint32_t) { return true; }, tolerance)
      .found();
}

}  // namespace delfront
