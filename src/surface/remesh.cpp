// SPDX-License-Identifier: Apache-2.0
#include "surface/remesh.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "surface/region_fit.hpp"
#include "surface/region_mesh.hpp"

namespace delfront {
namespace {

constexpr double kLong = 4.0 / 3, kShort = 4.0 / 5;  ///< of the wanted side
constexpr int kPasses = 12;

class Remesher {
 public:
  Remesher(const SurfaceParts& parts, const SurfaceRegion& region, const SurfaceSupport& support,
           const RegionBorder& border, const LinePoints& lines, const LineDivision& division, const SizeField& size)
      : parts_(parts),
        region_(region),
        support_(support),
        border_(border),
        lines_(lines),
        division_(division),
        size_(size) {}

  RegionGrid run() {
    if (has_line_within()) return fail("a line runs through it");
    RegionMesh mesh(support_, begin());
    put_border_points(mesh);
    for (int pass = 0; pass < kPasses; ++pass) {
      const std::size_t changed = drop_old_points(mesh) + fit_lengths(mesh, support_, size_, kShort, kLong);
      mesh.flip_to_delaunay(4);
      mesh.smooth(1);
      if (changed == 0 && pass > 2) break;
    }
    drop_old_points(mesh);
    for (const std::uint32_t p : old_)
      if (mesh.along_border(p)[0] != p) return fail("a point of the given border cannot be taken away", mesh.place(p));
    mesh.flip_to_delaunay(20);
    RegionGrid grid = mesh.take();
    grid.border_sides.clear();
    for (const auto& [a, b] : border_.side)
      grid.border_sides.push_back(std::uint64_t(std::min(a, b)) << 32 | std::max(a, b));
    std::sort(grid.border_sides.begin(), grid.border_sides.end());
    return grid;
  }

 private:
  RegionGrid fail(const char* why, Point at = {}) const {
    RegionGrid grid;
    grid.gave_up = why;
    grid.gave_up_at = at;
    return grid;
  }

  bool has_line_within() const {
    std::vector<std::uint32_t> seen;
    for (const RegionSide& side : region_.sides) seen.push_back(side.line);
    std::sort(seen.begin(), seen.end());
    return std::adjacent_find(seen.begin(), seen.end()) != seen.end();
  }

  /// The given triangles; the border's new points come first, those that are given points take their places.
  RegionGrid begin() {
    RegionGrid grid;
    grid.num_border = border_.point.size();
    for (std::uint32_t i = 0; i < border_.point.size(); ++i) {
      grid.points.push_back(border_.at[i]);
      const VertexId given = lines_.given[border_.point[i]];
      if (given.is_valid()) local_.emplace(given.value, i);
    }
    grid.triangle_of_point.assign(grid.points.size(), kNoTriangle);
    for (std::uint32_t t = 0; t < region_.triangles.size(); ++t) {
      std::array<std::uint32_t, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId v = parts_.model.triangles[TriangleId(std::size_t(region_.triangles[t]))][k];
        const auto [it, is_new] = local_.try_emplace(v.value, static_cast<std::uint32_t>(grid.points.size()));
        if (is_new) {
          grid.points.push_back(parts_.model.points[v]);
          grid.triangle_of_point.push_back(t);
        }
        corners[k] = it->second;
      }
      grid.triangles.push_back(corners);
    }
    return grid;
  }

  /// New points divide the given sides of the border that they lie on; given points on lines are old from then on.
  void put_border_points(RegionMesh& mesh) {
    for (std::uint32_t s = 0; s < mesh.num_sides(); ++s) note_border(mesh, s);
    std::unordered_map<std::uint32_t, std::uint32_t> border_number;
    for (std::uint32_t i = 0; i < border_.point.size(); ++i) border_number.emplace(border_.point[i], i);
    for (const RegionSide& side : region_.sides) {
      const SurfaceLine& line = parts_.lines[side.line];
      const auto& chain = lines_.chain[side.line];
      const auto& place = division_[side.line];
      for (const VertexId v : line.vertices)
        if (local_.at(v.value) >= border_.point.size()) old_.push_back(local_.at(v.value));
      for (std::size_t i = chain.size(); i-- > 0;) {  // from the end of each edge to its beginning
        if (place[i].t <= 0 || place[i].t >= 1) continue;
        std::uint32_t a = local_.at(line.vertices[place[i].edge].value);
        const bool is_next_inside = i + 1 < chain.size() && place[i + 1].edge == place[i].edge && place[i + 1].t < 1;
        std::uint32_t b =
            is_next_inside ? border_number.at(chain[i + 1]) : local_.at(line.vertices[place[i].edge + 1].value);
        const std::uint32_t p = border_number.at(chain[i]);
        if (side.is_backward) std::swap(a, b);
        split_border(mesh, a, b, p);
      }
    }
    std::sort(old_.begin(), old_.end());
    old_.erase(std::unique(old_.begin(), old_.end()), old_.end());
  }

  void note_border(const RegionMesh& mesh, std::uint32_t s) {
    if (!mesh.is_border(s)) return;
    const auto [a, b] = mesh.ends(s);
    side_between_[{a, b}] = s;
  }

  void split_border(RegionMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t p) {
    const std::uint32_t s = side_between_.at({a, b});
    mesh.split(s, p);
    for (std::uint32_t k = 0; k < 3; ++k) {  // sides of both halves have new numbers
      note_border(mesh, s - s % 3 + k);
      note_border(mesh, static_cast<std::uint32_t>(mesh.num_sides()) - 3 + k);
    }
  }

  std::size_t drop_old_points(RegionMesh& mesh) {
    std::size_t count = 0;
    for (const std::uint32_t p : old_) {
      const auto [first, last] = mesh.along_border(p);
      if (first == p) continue;
      const bool is_first_nearer =
          distance(mesh.place(first), mesh.place(p)) <= distance(mesh.place(last), mesh.place(p));
      count += mesh.collapse(p, is_first_nearer ? first : last) || mesh.collapse(p, is_first_nearer ? last : first);
    }
    return count;
  }

  const SurfaceParts& parts_;
  const SurfaceRegion& region_;
  const SurfaceSupport& support_;
  const RegionBorder& border_;
  const LinePoints& lines_;
  const LineDivision& division_;
  const SizeField& size_;
  std::unordered_map<std::uint32_t, std::uint32_t> local_;                         ///< by given vertex
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> side_between_;  ///< of the border, by its ends
  std::vector<std::uint32_t> old_;  ///< given points of the border that have to go
};

}  // namespace

RegionGrid remesh_region(const SurfaceParts& parts, const SurfaceRegion& region, const SurfaceSupport& support,
                         const RegionBorder& border, const LinePoints& lines, const LineDivision& division,
                         const SizeField& size) {
  return Remesher(parts, region, support, border, lines, division, size).run();
}

}  // namespace delfront
