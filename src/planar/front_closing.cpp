// SPDX-License-Identifier: Apache-2.0
// What a front leaves is a valid set of segments, so it has a constrained Delaunay triangulation: made on its own, and
// its triangles on the left of the sides are put into the complex.
#include <algorithm>

#include "planar/front.hpp"
#include "planar/kernel.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

class Closing {
 public:
  Closing(TriComplex& complex, std::span<const LeftSide> sides) : c_(complex), sides_(sides) {}

  void run(std::span<const VertexIndex> loose, FrontReport& report, Context& context) {
    triangulate(loose, context);
    find_sides();
    made_.assign(local().tri.size(), kNoTri);
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const TriIndex t = edge_of_side_[s] >> 2;
      if (made_[t] != kNoTri) continue;
      ++report.cavities;
      fill_part(t, sides_[s].region);
    }
    for (TriIndex t = 0; t < made_.size(); ++t) {
      if (made_[t] == kNoTri) continue;
      ++report.closed_by_delaunay;
      for (unsigned e = 0; e < 3; ++e) bond(t, e);
    }
  }

 private:
  const TriComplex& local() const { return grid_.complex; }

  void triangulate(std::span<const VertexIndex> loose, Context& context) {
    for (const LeftSide& s : sides_) vertex_.push_back(s.from);
    vertex_.insert(vertex_.end(), loose.begin(), loose.end());
    std::sort(vertex_.begin(), vertex_.end());
    vertex_.erase(std::unique(vertex_.begin(), vertex_.end()), vertex_.end());
    for (const VertexIndex v : vertex_) grid_.complex.point.push_back(c_.point[v]);
    PlanarKernel kernel(grid_.complex);
    build_delaunay(grid_.complex, kernel, context);
    PlanarDomain domain;
    std::vector<VertexIndex> same_as(vertex_.size());
    for (VertexIndex v = 0; v < same_as.size(); ++v) same_as[v] = v;
    for (const LeftSide& s : sides_) {
      domain.segments.push_back({VertexId(local_of(s.from)), VertexId(local_of(s.to))});
      domain.curve_of_segment.push_back(CurveId(0));
    }
    insert_segments(domain, same_as, grid_, context);
  }

  VertexIndex local_of(VertexIndex v) const {
    return static_cast<VertexIndex>(std::lower_bound(vertex_.begin(), vertex_.end(), v) - vertex_.begin());
  }

  void find_sides() {
    side_of_edge_.assign(4 * local().tri.size(), kNone);
    for (std::uint32_t s = 0; s < sides_.size(); ++s) {
      const EdgeRef ref = local().find_edge(local_of(sides_[s].from), local_of(sides_[s].to));
      DELFRONT_CHECK(ref != kNoTri && !local().is_ghost(ref >> 2));
      edge_of_side_.push_back(ref);
      side_of_edge_[ref] = s;
    }
  }

  /// Slots for all triangles that one reaches without crossing a segment.
  void fill_part(TriIndex first, std::uint32_t region) {
    stack_.assign(1, first);
    made_[first] = new_triangle(first, region);
    while (!stack_.empty()) {
      const TriIndex t = stack_.back();
      stack_.pop_back();
      for (unsigned e = 0; e < 3; ++e) {
        const TriIndex next = local().tri[t].neigh[e] >> 2;
        if (local().is_constrained(4 * t + e) || made_[next] != kNoTri) continue;
        DELFRONT_CHECK(!local().is_ghost(next));
        made_[next] = new_triangle(next, region);
        stack_.push_back(next);
      }
    }
  }

  TriIndex new_triangle(TriIndex t, std::uint32_t region) {
    const TriIndex made = c_.new_slot();
    const VertexIndex* n = local().tri[t].node;
    c_.tri[made] = {{vertex_[n[0]], vertex_[n[1]], vertex_[n[2]]}, {kNoTri, kNoTri, kNoTri}, region, 0};
    return made;
  }

  void bond(TriIndex t, unsigned e) {
    const EdgeRef ref = 4 * made_[t] + e;
    const std::uint32_t s = side_of_edge_[4 * t + e];
    if (s != kNone && sides_[s].is_constrained) c_.tri[made_[t]].flags |= 1u << e;
    if (s != kNone && sides_[s].behind != kNoTri) {
      c_.bond(ref, sides_[s].behind);
      return;
    }
    const EdgeRef other = local().across(4 * t + e);
    DELFRONT_CHECK(made_[other >> 2] != kNoTri);
    c_.tri[ref >> 2].neigh[e] = 4 * made_[other >> 2] + (other & 3);
  }

  TriComplex& c_;
  std::span<const LeftSide> sides_;
  PlanarGrid grid_;                  ///< of what is left alone
  std::vector<VertexIndex> vertex_;  ///< by local vertex
  std::vector<EdgeRef> edge_of_side_;
  std::vector<std::uint32_t> side_of_edge_;
  std::vector<TriIndex> made_;  ///< by local triangle: its slot in the complex
  std::vector<TriIndex> stack_;
};

}  // namespace

void close_by_delaunay(TriComplex& complex, std::span<const LeftSide> sides, std::span<const VertexIndex> loose,
                       FrontReport& report, Context& context) {
  Closing(complex, sides).run(loose, report, context);
}

}  // namespace delfront
