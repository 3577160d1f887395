// SPDX-License-Identifier: Apache-2.0
#include "delfront/facet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planar/constrain.hpp"
#include "planar/kernel.hpp"

namespace delfront {

namespace {

class FacetTriangulation {
 public:
  FacetTriangulation(const FacetOutline& facet, Context& context)
      : facet_(facet), context_(context), c_(grid_.complex), kernel_(c_) {
    const Point size{std::abs(facet.normal.x), std::abs(facet.normal.y), std::abs(facet.normal.z)};
    const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    first_axis_ = (drop + 1) % 3;
    second_axis_ = (drop + 2) % 3;
    if (facet.normal[drop] < 0) std::swap(first_axis_, second_axis_);
  }

  FacetTriangles run() {
    connect();
    flood();
    FacetTriangles result;
    for (TriIndex t = 0; t < c_.tri.size(); ++t)
      if (!c_.is_dead(t) && !is_outside_[t]) result.triangles.push_back(std::to_array(c_.tri[t].node));
    if (result.triangles.empty()) throw InputError("its edges enclose nothing");
    check_all_used();
    for (const PlanarPiece& piece : grid_.pieces) result.pieces.push_back({piece.a, piece.b, piece.curve});
    return result;
  }

 private:
  Point2 seen(const Point& p) const { return {p[first_axis_], p[second_axis_]}; }

  void connect() {
    for (const Point& p : facet_.points) c_.point.push_back(seen(p));
    const auto equal = build_delaunay(c_, kernel_, context_);
    if (!equal.empty())
      throw InputError(
          fmt::format("points {} and {} of it are at one place seen from it", equal[0].first, equal[0].second));
    PlanarDomain edges;
    std::vector<VertexIndex> same_as(facet_.points.size());
    for (VertexIndex v = 0; v < same_as.size(); ++v) same_as[v] = v;
    for (const auto& [a, b] : facet_.edges) {
      edges.curve_of_segment.emplace_back(edges.segments.size());  // as what it is found again
      edges.segments.push_back({VertexId(a), VertexId(b)});
    }
    insert_segments(edges, same_as, grid_, context_);
  }

  /// What ghosts and seeds of holes reach over unconstrained edges.
  void flood() {
    is_outside_.assign(c_.tri.size(), false);
    std::vector<TriIndex> stack;
    const auto add = [&](TriIndex t) {
      if (is_outside_[t]) return;
      is_outside_[t] = true;
      stack.push_back(t);
    };
    TriIndex real = kNoTri;
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (c_.is_dead(t)) continue;
      if (c_.is_ghost(t))
        add(t);
      else
        real = t;
    }
    for (const Point& hole : facet_.holes) add(kernel_.locate(seen(hole), real));
    while (!stack.empty()) {
      const TriIndex t = stack.back();
      stack.pop_back();
      for (unsigned e = 0; e < 3; ++e)
        if (!c_.is_constrained(4 * t + e)) add(c_.tri[t].neigh[e] >> 2);
    }
  }

  void check_all_used() {
    std::vector<bool> is_used(facet_.points.size(), false);
    for (TriIndex t = 0; t < c_.tri.size(); ++t)
      if (!c_.is_dead(t) && !is_outside_[t])
        for (const VertexIndex v : c_.tri[t].node) is_used[v] = true;
    if (const auto at = std::find(is_used.begin(), is_used.end(), false); at != is_used.end())
      throw InputError(fmt::format("its point {} lies outside of it", at - is_used.begin()));
    for (const PlanarPiece& piece : grid_.pieces) {
      const EdgeRef ref = c_.find_edge(piece.a, piece.b);
      if (is_outside_[ref >> 2] && is_outside_[c_.across(ref) >> 2])
        throw InputError(fmt::format("its edge {} {} lies outside of it", piece.a, piece.b));
    }
  }

  const FacetOutline& facet_;
  Context& context_;
  PlanarGrid grid_;
  TriComplex& c_;
  PlanarKernel kernel_;
  int first_axis_ = 0, second_axis_ = 1;
  std::vector<bool> is_outside_;
};

}  // namespace

FacetTriangles triangulate_facet(const FacetOutline& facet, Context& context) {
  return FacetTriangulation(facet, context).run();
}

}  // namespace delfront
