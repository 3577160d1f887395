// SPDX-License-Identifier: Apache-2.0
#include "brep/assemble_brep.hpp"

#include <fmt/format.h>

#include <map>

namespace delfront {
namespace {

class Assembly {
 public:
  Assembly(const Brep& brep, const Array<EdgeId, EdgePoints>& edges, std::size_t num_vertices,
           std::vector<VertexEntity>& entity, std::vector<std::array<Point2, 3>>* corner_uv)
      : brep_(brep), edges_(edges), entity_(entity), corner_uv_(corner_uv), number_(num_vertices) {}

  Model run(const Array<FaceId, FaceGrid>& grids) {
    entity_.clear();
    if (corner_uv_) corner_uv_->clear();
    find_seams();
    add_vertices(grids);
    for (std::size_t f = 0; f < grids.size(); ++f) add_face(FaceId(f), grids[FaceId(f)]);
    add_curves_and_corners();
    return std::move(model_);
  }

 private:
  /// Edges that a face has on both sides are no borders of anything.
  void find_seams() {
    is_seam_.assign(edges_.size(), false);
    std::vector<FaceId> last(edges_.size());
    for (std::size_t f = 0; f < brep_.faces.size(); ++f)
      for (const auto& loop : brep_.faces[FaceId(f)].loops)
        for (const BrepUse& use : loop) {
          if (last[use.edge.index()] == FaceId(f)) is_seam_[use.edge.index()] = true;
          last[use.edge.index()] = FaceId(f);
        }
  }

  void add_point(Point at, VertexEntity entity) {
    model_.points.push_back(at);
    entity_.push_back(entity);
  }

  void number_vertex(std::uint32_t vertex, Point at, VertexEntity entity) {
    if (number_[vertex].is_valid()) return;
    number_[vertex] = model_.points.next_id();
    add_point(at, entity);
  }

  /// Corners, then points within edges, of what edges and named corners there are.
  void add_vertices(const Array<FaceId, FaceGrid>& grids) {
    std::vector<bool> is_used(number_.size(), false);
    for (std::size_t e = 0; e < edges_.size(); ++e)
      for (const std::uint32_t v : edges_[EdgeId(e)].vertex) is_used[v] = true;
    for (const FaceGrid& grid : grids)
      for (const FacePoint& p : grid.points)
        if (p.vertex != kNoVertex) is_used[p.vertex] = true;
    for (std::uint32_t c = 0; c < brep_.corners.size(); ++c)
      if (is_used[c] || !brep_.corners[CornerId(std::size_t(c))].name.empty())
        number_vertex(c, brep_.corners[CornerId(std::size_t(c))].at, {0, c, 0, 0});
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const EdgePoints& points = edges_[EdgeId(std::size_t(e))];
      for (std::size_t i = 0; i < points.t.size(); ++i)
        number_vertex(points.vertex[i], points.at[i], {1, e, points.t[i], 0});
    }
  }

  void add_face(FaceId f, const FaceGrid& grid) {
    const BrepFace& face = brep_.faces[f];
    std::vector<VertexId> local(grid.points.size());
    for (std::size_t i = 0; i < local.size(); ++i) {
      const FacePoint& p = grid.points[i];
      if (p.vertex != kNoVertex) {
        local[i] = number_[p.vertex];
        continue;
      }
      local[i] = model_.points.next_id();
      add_point(p.at, {2, f.value, p.uv.x, p.uv.y});
    }
    const PatchId patch = patch_of(face);
    for (const auto& t : grid.triangles) {
      const std::size_t second = face.is_reversed ? 2 : 1;
      model_.triangles.push_back({local[t[0]], local[t[second]], local[t[3 - second]]});
      model_.patch_of_triangle.push_back(patch);
      model_.input_face.push_back(f.value);
      if (corner_uv_)
        corner_uv_->push_back({grid.points[t[0]].uv, grid.points[t[second]].uv, grid.points[t[3 - second]].uv});
    }
  }

  PatchId patch_of(const BrepFace& face) {
    const std::string name = face.name.empty() ? "surface" : face.name;
    const auto [it, is_new] = patches_.try_emplace(name, model_.patches.next_id());
    if (is_new) model_.patches.push_back({name, face.kind});
    return it->second;
  }

  void add_curves_and_corners() {
    std::vector<bool> is_end(brep_.corners.size(), false);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const BrepEdge& edge = brep_.edges[EdgeId(e)];
      if (edge.is_degenerate() || is_seam_[e]) continue;
      Curve curve;
      curve.name = edge.name.empty() ? fmt::format("curve_{}", e + 1) : edge.name;
      for (const std::uint32_t v : edges_[EdgeId(e)].vertex) curve.vertices.push_back(number_[v]);
      model_.curves.push_back(std::move(curve));
      if (edge.corners[0] == edge.corners[1]) continue;
      for (const CornerId c : edge.corners) is_end[c.index()] = true;
    }
    for (std::size_t c = 0; c < is_end.size(); ++c) {
      const std::string& name = brep_.corners[CornerId(c)].name;
      if (!is_end[c] && name.empty()) continue;
      model_.corners.push_back(number_[c]);
      model_.corner_names.push_back(name.empty() ? fmt::format("corner_{}", c + 1) : name);
    }
  }

  const Brep& brep_;
  const Array<EdgeId, EdgePoints>& edges_;
  std::vector<VertexEntity>& entity_;
  std::vector<std::array<Point2, 3>>* corner_uv_;  ///< null: not wanted
  Model model_;
  std::vector<VertexId> number_;  ///< by vertex of the Brep's edges
  std::vector<bool> is_seam_;
  std::map<std::string, PatchId> patches_;
};

}  // namespace

Model assemble_brep(const Brep& brep, const Array<EdgeId, EdgePoints>& edges, const Array<FaceId, FaceGrid>& grids,
                    std::size_t num_vertices, std::vector<VertexEntity>& entity,
                    std::vector<std::array<Point2, 3>>* corner_uv) {
  return Assembly(brep, edges, num_vertices, entity, corner_uv).run(grids);
}

}  // namespace delfront
