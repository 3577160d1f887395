// SPDX-License-Identifier: Apache-2.0
#include "volume/thin_out.hpp"

#include <algorithm>
#include <limits>

#include "tetra/quality.hpp"
#include "volume/link.hpp"

namespace delfront {

namespace {

constexpr std::size_t kMaxStar = 150;  ///< tets around a vertex that may be taken away for the sake of quality alone

bool is_free(const TetComplex& c, VertexIndex v) {
  return !c.on_boundary[v] && c.vertex_tet[v] != kNoIndex && !c.segment_points.contains(v);
}

}  // namespace

bool contract_free_vertex(TetComplex& c, VertexIndex v, bool to_better) {
  std::vector<TetIndex> star, new_tets;
  std::vector<LinkFace> link;
  if (!is_free(c, v) || !find_link(c, v, star, link) || (to_better && star.size() > kMaxStar)) return false;
  std::vector<VertexIndex> candidates;
  for (const auto& f : link) candidates.insert(candidates.end(), f.begin(), f.end());
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  double best = -std::numeric_limits<double>::infinity();
  if (to_better) {
    best = 1;
    for (const auto& f : link)
      best = std::min(best, measure_quality(c.point(f[0]), c.point(f[1]), c.point(f[2]), c.point(v)));
  }
  VertexIndex target = kNoIndex;
  for (const VertexIndex u : candidates) {
    double worst = std::numeric_limits<double>::infinity();
    for (auto f = link.begin(); f != link.end() && worst >= best; ++f)
      if (!has(*f, u))
        worst = std::min(worst, measure_quality(c.point((*f)[0]), c.point((*f)[1]), c.point((*f)[2]), c.point(u)));
    if (worst < best || (worst == best && target != kNoIndex)) continue;
    if (std::any_of(link.begin(), link.end(),
                    [&](const auto& f) { return !has(f, u) && c.orient(f[0], f[1], f[2], u) <= 0; }))
      continue;
    best = worst;
    target = u;
  }
  if (target == kNoIndex) return false;
  std::vector<std::array<VertexIndex, 4>> made;
  for (const auto& f : link)
    if (!has(f, target)) made.push_back({f[0], f[1], f[2], target});
  c.replace(star, made, new_tets);
  return true;
}

std::size_t thin_out(TetComplex& complex, Context& context) {
  constexpr int kMaxPasses = 4;
  std::size_t taken = 0;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const std::size_t before = taken;
    for (VertexIndex v = 0; v < complex.num_vertices(); ++v) {
      if (v % 256 == 0) context.check_limits();
      if (!complex.on_boundary[v] && contract_free_vertex(complex, v, true)) ++taken;
    }
    if (taken == before) break;
  }
  return taken;
}

}  // namespace delfront
