// SPDX-License-Identifier: Apache-2.0
#include "volume/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace delfront {

namespace {
constexpr std::size_t kBrickCorners = 8;
constexpr std::size_t kMaxPointsPerEdge = 40;  ///< on average; a model that needs more has parts too close to hold
}  // namespace

void Segments::vertices_along(std::uint32_t edge, bool backwards, std::vector<VertexIndex>& out) const {
  out.clear();
  out.push_back(ends[edge][0]);
  for (const Steiner& s : chain[edge]) out.push_back(s.vertex);
  out.push_back(ends[edge][1]);
  if (backwards) std::reverse(out.begin(), out.end());
}

void Segments::neighbours(VertexIndex v, std::vector<VertexIndex>& out) const {
  out.clear();
  if (v < num_model_vertices) {
    for (std::uint32_t i = vertex_offset[v]; i < vertex_offset[v + 1]; ++i) {
      const std::uint32_t e = vertex_edge[i];
      const bool is_first = ends[e][0] == v;
      if (chain[e].empty())
        out.push_back(ends[e][is_first ? 1 : 0]);
      else
        out.push_back(is_first ? chain[e].front().vertex : chain[e].back().vertex);
    }
    return;
  }
  if (v < first_steiner) return;
  const std::uint32_t e = steiner_edge[v - first_steiner];
  const auto& points = chain[e];
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].vertex != v) continue;
    out.push_back(i > 0 ? points[i - 1].vertex : ends[e][0]);
    out.push_back(i + 1 < points.size() ? points[i + 1].vertex : ends[e][1]);
  }
}

namespace {

/// Appends the edges of curves that no triangle has, in the order of the curves.
void add_curves(const Model& model, Segments& s) {
  s.num_surface_edges = s.ends.size();
  std::map<std::array<VertexIndex, 2>, std::uint32_t> added;
  for (const Curve& curve : model.curves) {
    std::vector<std::uint32_t>& steps = s.of_curve.emplace_back();
    for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i) {
      const auto [low, high] = std::minmax(curve.vertices[i].value, curve.vertices[i + 1].value);
      const std::array<VertexIndex, 2> edge{low, high};
      const auto end = s.ends.begin() + static_cast<std::ptrdiff_t>(s.num_surface_edges);
      const auto found = std::lower_bound(s.ends.begin(), end, edge);
      if (found != end && *found == edge) {
        steps.push_back(static_cast<std::uint32_t>(found - s.ends.begin()));
        continue;
      }
      const auto [at, is_new] = added.try_emplace(edge, static_cast<std::uint32_t>(s.ends.size()));
      if (is_new) s.ends.push_back(edge);
      steps.push_back(at->second);
    }
  }
}

}  // namespace

Segments build_segments(const Model& model) {
  Segments s;
  s.num_model_vertices = model.points.size();
  s.first_steiner = s.num_model_vertices + kBrickCorners;
  struct Side {
    std::uint64_t key;
    std::uint32_t triangle, corner;
  };
  std::vector<Side> sides;
  sides.reserve(3 * model.triangles.size());
  for (std::size_t t = 0; t < model.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto& corner = model.triangles[TriangleId(t)];
      const std::uint64_t a = corner[k].value, b = corner[(k + 1) % 3].value;
      sides.push_back({std::min(a, b) << 32 | std::max(a, b), static_cast<std::uint32_t>(t), k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.key != b.key ? a.key < b.key : a.triangle != b.triangle ? a.triangle < b.triangle : a.corner < b.corner;
  });
  s.of_triangle.resize(model.triangles.size());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].key != sides[i - 1].key)
      s.ends.push_back(
          {static_cast<VertexIndex>(sides[i].key >> 32), static_cast<VertexIndex>(sides[i].key & 0xffffffffu)});
    s.of_triangle[sides[i].triangle][sides[i].corner] = static_cast<std::uint32_t>(s.ends.size() - 1);
  }
  add_curves(model, s);
  s.chain.resize(s.ends.size());
  s.most_steiner = kMaxPointsPerEdge * s.ends.size() + 10000;
  s.vertex_offset.assign(s.num_model_vertices + 2, 0);
  for (const auto& e : s.ends)
    for (const VertexIndex v : e) ++s.vertex_offset[v + 2];
  for (std::size_t v = 2; v < s.vertex_offset.size(); ++v) s.vertex_offset[v] += s.vertex_offset[v - 1];
  s.vertex_edge.resize(2 * s.ends.size());
  for (std::uint32_t e = 0; e < s.ends.size(); ++e)
    for (const VertexIndex v : s.ends[e]) s.vertex_edge[s.vertex_offset[v + 1]++] = e;
  s.vertex_offset.pop_back();
  return s;
}

EdgeSet pieces_of_edges(const Segments& segments, bool of_triangles_only) {
  EdgeSet pieces;
  pieces.reserve(segments.ends.size() + segments.steiner_edge.size());
  const std::size_t end = of_triangles_only ? segments.num_surface_edges : segments.ends.size();
  std::vector<VertexIndex> along;
  for (std::uint32_t e = 0; e < end; ++e) {
    segments.vertices_along(e, false, along);
    for (std::size_t i = 0; i + 1 < along.size(); ++i) pieces.insert(along[i], along[i + 1]);
  }
  return pieces;
}

namespace {

/// The power of two nearest to a length, in ratio.
double shell(double length) { return std::exp2(std::round(std::log2(length))); }

ExactPoint point_on_edge(const Model& model, const Segments& segments, std::uint32_t edge, double t) {
  return ExactPoint::on_segment(model.points[VertexId(segments.ends[edge][0])],
                                model.points[VertexId(segments.ends[edge][1])], t);
}

VertexIndex add_steiner_vertex(TetComplex& complex, const Model& model, const Segments& segments, std::uint32_t edge,
                               double t) {
  const ExactPoint p = point_on_edge(model, segments, edge, t);
  const double h = (1 - t) * complex.vertex[segments.ends[edge][0]].h + t * complex.vertex[segments.ends[edge][1]].h;
  const VertexIndex v = complex.add_vertex(p.approx, h);
  complex.segment_points.emplace(v, p);
  return v;
}

[[noreturn]] void fail_at(Point at, VertexIndex v, const char* what) {
  throw MeshingError(fmt::format("boundary recovery: {} near ({:g}, {:g}, {:g}); the surface has parts closer together "
                                 "than numbers can tell apart: separate or merge them",
                                 what, at.x, at.y, at.z),
                     {{at, {v}}});
}

void insert_or_fail(TetComplex& complex, DelaunayKernel& kernel, VertexIndex v, VertexIndex near) {
  if (kernel.insert(v, complex.vertex_tet[near]) != DelaunayKernel::Insert::done)
    fail_at(complex.point(v), v, "a point on an edge falls on another vertex");
}

/// Where to split the piece between chain positions i - 1 and i (the ends count as -1 and chain.size()).
double split_parameter(const Model& model, const Segments& segments, std::uint32_t edge, std::size_t i) {
  const auto& chain = segments.chain[edge];
  const double low = i == 0 ? 0 : chain[i - 1].t, high = i == chain.size() ? 1 : chain[i].t;
  const double whole =
      distance(model.points[VertexId(segments.ends[edge][0])], model.points[VertexId(segments.ends[edge][1])]);
  const double half = (high - low) / 2;
  double t = low + half;
  if (i == 0)
    t = shell(half * whole) / whole;
  else if (i == chain.size())
    t = 1 - shell(half * whole) / whole;
  return t > low && t < high ? t : low + half;
}

/// Puts a point into the chain before position i; its vertex is the next Steiner vertex.
VertexIndex extend_chain(const Model& model, Segments& segments, std::uint32_t edge, std::size_t i) {
  auto& chain = segments.chain[edge];
  const double low = i == 0 ? 0 : chain[i - 1].t, high = i == chain.size() ? 1 : chain[i].t;
  const double t = split_parameter(model, segments, edge, i);
  if (!(t > low && t < high) || high - low < 1e-12) {
    const VertexIndex near = segments.ends[edge][0];
    fail_at(model.points[VertexId(near)], near, "an edge cannot be split again");
  }
  if (segments.steiner_edge.size() >= segments.most_steiner) {
    const VertexIndex near = segments.ends[edge][0];
    fail_at(model.points[VertexId(near)], near, "too many points on edges");
  }
  const auto v = static_cast<VertexIndex>(segments.first_steiner + segments.steiner_edge.size());
  segments.steiner_edge.push_back(edge);
  chain.insert(chain.begin() + static_cast<std::ptrdiff_t>(i), {t, v});
  return v;
}

void split_piece(TetComplex& complex, DelaunayKernel& kernel, const Model& model, Segments& segments,
                 std::uint32_t edge, std::size_t i) {
  const VertexIndex near = i == 0 ? segments.ends[edge][0] : segments.chain[edge][i - 1].vertex;
  const VertexIndex v = extend_chain(model, segments, edge, i);
  DELFRONT_CHECK(add_steiner_vertex(complex, model, segments, edge, segments.chain[edge][i].t) == v);
  insert_or_fail(complex, kernel, v, near);
}

/// Marks the vertices of v's star.
class StarVertices {
 public:
  void build(const TetComplex& complex, VertexIndex v) {
    complex.star(v, tets_);
    ++stamp_;
    mark_.resize(complex.num_vertices(), 0);
    for (const TetIndex t : tets_)
      for (unsigned k = 0; k < 4; ++k)
        if (const VertexIndex w = complex.node[4 * t + k]; w != kGhost) mark_[w] = stamp_;
  }
  bool has(VertexIndex w) const { return mark_[w] == stamp_; }

 private:
  std::vector<TetIndex> tets_;
  std::vector<std::uint32_t> mark_;
  std::uint32_t stamp_ = 0;
};

/// The edge piece between two neighbours along an edge.
Piece find_piece(const Segments& segments, VertexIndex v, VertexIndex w) {
  const bool w_is_steiner = w >= segments.first_steiner, v_is_steiner = v >= segments.first_steiner;
  if (v_is_steiner || w_is_steiner) {
    const std::uint32_t e = segments.steiner_edge[(v_is_steiner ? v : w) - segments.first_steiner];
    return {e, v, w};
  }
  for (std::uint32_t i = segments.vertex_offset[v]; i < segments.vertex_offset[v + 1]; ++i) {
    const auto& e = segments.ends[segments.vertex_edge[i]];
    if (e[0] == w || e[1] == w) return {segments.vertex_edge[i], v, w};
  }
  DELFRONT_CHECK(false && "neighbours share an edge");
  return {};
}

/// The chain position before which a split goes, or kNoIndex where the two are no longer neighbours.
std::size_t position_of(const Segments& segments, const Piece& piece) {
  const auto& chain = segments.chain[piece.edge];
  for (std::size_t i = 0; i <= chain.size(); ++i) {
    const VertexIndex a = i == 0 ? segments.ends[piece.edge][0] : chain[i - 1].vertex;
    const VertexIndex b = i == chain.size() ? segments.ends[piece.edge][1] : chain[i].vertex;
    if ((a == piece.low && b == piece.high) || (a == piece.high && b == piece.low)) return i;
  }
  return kNoIndex;
}

}  // namespace

void insert_chains(TetComplex& complex, DelaunayKernel& kernel, const Model& model, Segments& segments) {
  std::vector<std::uint32_t> edges = segments.steiner_edge;
  std::vector<double> parameter(edges.size());
  for (std::uint32_t e = 0; e < segments.chain.size(); ++e)
    for (const Segments::Steiner& s : segments.chain[e]) parameter[s.vertex - segments.first_steiner] = s.t;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const VertexIndex v = add_steiner_vertex(complex, model, segments, edges[i], parameter[i]);
    insert_or_fail(complex, kernel, v, segments.ends[edges[i]][0]);
  }
}

std::vector<Piece> find_missing_pieces(const TetComplex& complex, const Segments& segments,
                                       const std::vector<VertexIndex>* at, Context& context) {
  std::vector<Piece> missing;
  std::vector<VertexIndex> neighbours;
  StarVertices star;
  const std::size_t n = at ? at->size() : complex.num_vertices();
  for (std::size_t i = 0; i < n; ++i) {
    const VertexIndex v = at ? (*at)[i] : static_cast<VertexIndex>(i);
    segments.neighbours(v, neighbours);
    if (neighbours.empty() || complex.vertex_tet[v] == kNoIndex) continue;
    star.build(complex, v);
    for (const VertexIndex w : neighbours)
      if (!star.has(w) && (at || v < w)) missing.push_back(find_piece(segments, std::min(v, w), std::max(v, w)));
    if (i % 1024 == 0) context.check_limits();
  }
  return missing;
}

void recover_segments(TetComplex& complex, DelaunayKernel& kernel, const Model& model, Segments& segments,
                      Context& context) {
  std::vector<VertexIndex> touched;
  std::vector<TetIndex> scratch;
  for (bool is_first_pass = true;; is_first_pass = false) {
    const std::vector<Piece> missing =
        find_missing_pieces(complex, segments, is_first_pass ? nullptr : &touched, context);
    if (missing.empty()) return;
    touched.clear();
    for (const Piece& piece : missing) {
      const std::size_t i = position_of(segments, piece);
      if (i == kNoIndex || complex.find_edge(piece.low, piece.high, scratch) != kNoIndex) continue;
      split_piece(complex, kernel, model, segments, piece.edge, i);
      for (const TetIndex t : kernel.made())
        for (unsigned k = 0; k < 4; ++k)
          if (const VertexIndex w = complex.node[4 * t + k]; w != kGhost) touched.push_back(w);
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    context.progress("recover", segments.steiner_edge.size(), 0, "points on edges");
  }
}

void plan_split(const Model& model, Segments& segments, const Piece& piece) {
  if (const std::size_t i = position_of(segments, piece); i != kNoIndex) extend_chain(model, segments, piece.edge, i);
}

void plan_split_of_longest(const Model& model, Segments& segments, std::uint32_t edge) {
  const auto& chain = segments.chain[edge];
  std::size_t best = 0;
  double longest = -1;
  for (std::size_t i = 0; i <= chain.size(); ++i) {
    const double piece = (i == chain.size() ? 1 : chain[i].t) - (i == 0 ? 0 : chain[i - 1].t);
    if (piece > longest) longest = piece, best = i;
  }
  extend_chain(model, segments, edge, best);
}

}  // namespace delfront
