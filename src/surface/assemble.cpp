// SPDX-License-Identifier: Apache-2.0
#include "surface/assemble.hpp"

#include <algorithm>

namespace delfront {
namespace {

class Assembler {
 public:
  Assembler(const SurfaceParts& parts, const LinePoints& lines) : parts_(parts), lines_(lines) {}

  void add_points() {
    Model& m = result_.model;
    m.patches = parts_.model.patches;
    m.regions = parts_.model.regions;
    m.feature_angle = parts_.model.feature_angle;
    m.points.assign(lines_.points.begin(), lines_.points.end());
    new_point_.resize(parts_.model.points.size());
    for (std::size_t i = 0; i < lines_.points.size(); ++i)
      if (lines_.given[i].is_valid()) new_point_[lines_.given[i].index()] = VertexId(i);
  }

  void add_region(const SurfaceRegion& region, const RegionBorder& border, const RegionGrid& grid,
                  std::uint32_t number) {
    Model& m = result_.model;
    const std::size_t first = m.points.size();
    const bool is_sided = !region.triangles.empty() && region.triangles[0] < parts_.model.sides.size();
    if (is_sided) m.sides.resize(m.triangles.size());
    for (std::size_t i = grid.num_border; i < grid.points.size(); ++i) m.points.push_back(grid.points[i]);
    const auto to_model = [&](std::uint32_t p) {
      return p < grid.num_border ? VertexId(border.point[p]) : VertexId(first + p - grid.num_border);
    };
    for (const auto& [a, b, c] : grid.triangles) {
      m.input_face.push_back(static_cast<std::uint32_t>(m.triangles.size()));
      m.triangles.push_back({to_model(a), to_model(b), to_model(c)});
      m.patch_of_triangle.push_back(region.patch);
      if (is_sided) m.sides.push_back(parts_.model.sides[TriangleId(std::size_t(region.triangles[0]))]);
      result_.region_of_triangle.push_back(number);
    }
  }

  /// Curves take the new points of the lines that they run along; what runs through the volume stays.
  void add_curves() {
    for (const Curve& curve : parts_.model.curves) {
      const auto& v = curve.vertices;
      Curve made{curve.name, {point_of(v[start_of(curve)])}};
      const std::size_t n = v.size() - 1, offset = start_of(curve);
      for (std::size_t k = 0; k < n;) {
        const VertexId from = v[(offset + k) % n], to = v[(offset + k) % n + 1];
        const std::uint32_t edge = parts_.edge_between(from, to);
        if (edge == kNoTriangle) {
          made.vertices.push_back(point_of(to));
          ++k;
          continue;
        }
        const std::uint32_t l = parts_.line_of_edge[edge];
        const SurfaceLine& line = parts_.lines[l];
        std::vector<std::uint32_t> chain = lines_.chain[l];
        const auto at = std::size_t(std::find(line.edges.begin(), line.edges.end(), edge) - line.edges.begin());
        if (line.vertices[at] != from) std::reverse(chain.begin(), chain.end());
        for (std::size_t i = 1; i < chain.size(); ++i) made.vertices.push_back(VertexId(std::size_t(chain[i])));
        k += line.edges.size();
      }
      result_.model.curves.push_back(std::move(made));
    }
  }

  void add_corners() {
    for (std::size_t i = 0; i < parts_.model.corners.size(); ++i) {
      result_.model.corners.push_back(point_of(parts_.model.corners[i]));
      result_.model.corner_names.push_back(parts_.model.corner_names[i]);
    }
  }

  AssembledSurface take() { return std::move(result_); }

 private:
  /// A closed curve begins where a line does.
  std::size_t start_of(const Curve& curve) const {
    const auto& v = curve.vertices;
    if (v.front() != v.back()) return 0;
    for (std::size_t i = 0; i + 1 < v.size(); ++i)
      if (parts_.is_corner[v[i].index()]) return i;
    const std::uint32_t edge = parts_.edge_between(v[0], v[1]);
    if (edge == kNoTriangle) return 0;
    const VertexId begin = parts_.lines[parts_.line_of_edge[edge]].vertices.front();
    return std::size_t(std::find(v.begin(), v.end(), begin) - v.begin());
  }

  VertexId point_of(VertexId given) {
    VertexId& made = new_point_[given.index()];
    if (!made.is_valid()) {
      made = result_.model.points.next_id();
      result_.model.points.push_back(parts_.model.points[given]);
    }
    return made;
  }

  const SurfaceParts& parts_;
  const LinePoints& lines_;
  std::vector<VertexId> new_point_;
  AssembledSurface result_;
};

}  // namespace

AssembledSurface assemble(const SurfaceParts& parts, const LinePoints& lines, const std::vector<RegionBorder>& borders,
                          const std::vector<RegionGrid>& grids) {
  Assembler assembler(parts, lines);
  assembler.add_points();
  for (std::uint32_t r = 0; r < grids.size(); ++r) assembler.add_region(parts.regions[r], borders[r], grids[r], r);
  assembler.add_curves();
  assembler.add_corners();
  return assembler.take();
}

}  // namespace delfront
