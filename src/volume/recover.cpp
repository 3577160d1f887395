// SPDX-License-Identifier: Apache-2.0
// Delaunay of the surface's vertices; edges by Steiner points; facets by filling what they cut again; regions; what is
// not gridded goes away; Steiner points off the surface.
#include "volume/recover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "delaunay/delaunay.hpp"
#include "volume/curve_points.hpp"
#include "volume/edge_flips.hpp"
#include "volume/facets.hpp"
#include "volume/partial.hpp"
#include "volume/regions.hpp"
#include "volume/segments.hpp"
#include "volume/thin_out.hpp"
#include "volume/unsplit.hpp"

namespace delfront {

namespace {

constexpr int kMaxRestartsWithFlips = 40;  ///< then every edge is made Delaunay, which always ends
constexpr int kMaxRestarts = 80;
constexpr std::size_t kFewPoints = 500;  ///< on edges: worth any time

/// The mean length of the edges at each of the model's vertices.
void set_model_sizes(TetComplex& complex, const Model& model, const Segments& segments) {
  const std::size_t n = model.points.size();
  std::vector<double> sum(n, 0), count(n, 0);
  for (const auto& [a, b] : segments.ends) {
    const double l = distance(model.points[VertexId(a)], model.points[VertexId(b)]);
    for (const VertexIndex v : {a, b}) sum[v] += l, count[v] += 1;
  }
  for (std::size_t v = 0; v < n; ++v) complex.vertex[v].h = count[v] > 0 ? sum[v] / count[v] : 0;
}

TetComplex complex_of_vertices(const Model& model, const Segments& segments) {
  TetComplex complex;
  for (const Point p : model.points) complex.on_boundary[complex.add_vertex(p, 0)] = 1;
  set_model_sizes(complex, model, segments);
  const Box box = model.bounding_box();  // a brick keeps the hull, and its ghosts, away from the model
  const double away = std::exp2(std::ceil(std::log2(box.diagonal())));
  for (int corner = 0; corner < 8; ++corner) {
    Point p = box.centre();
    for (int axis = 0; axis < 3; ++axis) p[axis] += (corner >> axis & 1 ? 2 : -2) * away;
    complex.add_vertex(p, 0);
  }
  return complex;
}

[[noreturn]] void fail_at_facets(const Model& model, const std::vector<TriangleId>& failed) {
  std::vector<Place> places;
  for (const TriangleId t : failed) {
    const auto& c = model.triangles[t];
    places.push_back({(model.points[c[0]] + model.points[c[1]] + model.points[c[2]]) / 3, {t.value}});
  }
  const Point at = places[0].at;
  throw MeshingError(
      fmt::format("boundary recovery: {} triangles could not be recovered, the first near ({:g}, {:g}, {:g})",
                  failed.size(), at.x, at.y, at.z),
      places);
}

[[noreturn]] void fail_at_edges(const Model& model, const Segments& segments, const std::vector<Piece>& hard) {
  std::vector<Place> places;
  for (const Piece& piece : hard) {
    const auto& [a, b] = segments.ends[piece.edge];
    places.push_back({0.5 * (model.points[VertexId(a)] + model.points[VertexId(b)]), {a, b}});
  }
  const Point at = places[0].at;
  throw MeshingError(fmt::format("boundary recovery: {} edges are still missing with {} points put on edges, the first "
                                 "near ({:g}, {:g}, {:g}): "
                                 "most often facets there are long and narrow and lie close to others; ask for smaller "
                                 "sizes there, or keep the "
                                 "given triangles (--surface-method keep)",
                                 hard.size(), segments.steiner_edge.size(), at.x, at.y, at.z),
                     places);
}

[[noreturn]] void fail_at_curves(const Model& model) {
  const Point at = model.points[model.curves[CurveId(0)].vertices[0]];
  throw MeshingError(
      fmt::format("boundary recovery: the embedded curves could not be recovered between the facets, the "
                  "first of them from ({:g}, {:g}, {:g}); give the edges more points where they come "
                  "close to others",
                  at.x, at.y, at.z),
      {{at, {}}});
}

/// Triangles that lie (nearly) in one plane and hang together; only a guide for the order of trials, so a tolerance
/// will do.
class FlatParts {
 public:
  FlatParts(const Model& model, const Segments& segments) : segments_(segments), part_(model.triangles.size()) {
    std::iota(part_.begin(), part_.end(), 0u);
    first_.assign(segments.ends.size(), kNoIndex);
    for (std::uint32_t t = 0; t < part_.size(); ++t)
      for (const std::uint32_t e : segments.of_triangle[t]) {
        if (first_[e] == kNoIndex)
          first_[e] = t;
        else if (dot(normal(model, t), normal(model, first_[e])) > kCosFlat)
          part_[find(t)] = find(first_[e]);
      }
    for (std::uint32_t t = 0; t < part_.size(); ++t) part_[t] = find(t);
    members_.resize(part_.size());
    for (std::uint32_t t = 0; t < part_.size(); ++t) members_[part_[t]].push_back(t);
    for (const auto& c : model.triangles) corners_.push_back({c[0].value, c[1].value, c[2].value});
  }

  /// @return by vertex: in the part of one of the edge's triangles; Steiner points on its edges too
  const std::vector<bool>& mark(std::uint32_t edge) {
    if (first_[edge] == kNoIndex) return nothing_;  // of a curve
    const std::uint32_t part = part_[first_[edge]];
    if (part == marked_part_) return is_flat_;
    is_flat_.resize(segments_.first_steiner + segments_.steiner_edge.size(), false);
    for (const VertexIndex v : marked_) is_flat_[v] = false;  // not all of them: that would be quadratic
    marked_.clear();
    marked_part_ = part;
    auto add = [&](VertexIndex v) {
      if (is_flat_[v]) return;
      is_flat_[v] = true;
      marked_.push_back(v);
    };
    for (const std::uint32_t t : members_[part])
      for (std::size_t k = 0; k < 3; ++k) {
        add(corners_[t][k]);
        for (const auto& s : segments_.chain[segments_.of_triangle[t][k]]) add(s.vertex);
      }
    return is_flat_;
  }

 private:
  static constexpr double kCosFlat = 0.999999;  ///< 0.08 degrees

  static Point normal(const Model& model, std::uint32_t t) {
    const auto& c = model.triangles[TriangleId(t)];
    const Point n = cross(model.points[c[1]] - model.points[c[0]], model.points[c[2]] - model.points[c[0]]);
    const double l = length(n);
    return l > 0 ? n / l : n;
  }
  std::uint32_t find(std::uint32_t t) {
    while (part_[t] != t) t = part_[t] = part_[part_[t]];
    return t;
  }

  const Segments& segments_;
  std::vector<std::uint32_t> part_, first_;
  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::array<VertexIndex, 3>> corners_;
  std::uint32_t marked_part_ = kNoIndex;  ///< which is_flat_ is of
  std::vector<VertexIndex> marked_;
  std::vector<bool> is_flat_;
  const std::vector<bool> nothing_;
};

/// Switches what lies in the way of missing edges; plans a split of those that stay missing.
/// @return those
std::vector<Piece> switch_to_edges(TetComplex& complex, const Model& model, Segments& segments, const EdgeSet& required,
                                   RecoveryReport& report, Context& context) {
  const std::vector<Piece> missing = find_missing_pieces(complex, segments, nullptr, context);
  if (segments.steiner_edge.empty()) report.missing_edges = missing.size();
  EdgeFlips flips(complex, required);
  std::vector<Piece> hard;
  FlatParts flat(model, segments);
  for (const Piece& piece : missing) {
    if (!flips.recover(piece.low, piece.high, flat.mark(piece.edge))) hard.push_back(piece);
    context.check_limits();
  }
  for (const Piece& piece : hard) plan_split(model, segments, piece);
  return hard;
}

/// Refilled cavities of facets take curves away; between the facets they come back by switches.
/// @return whether all of them are there; a split of those that stay missing is planned
bool switch_to_curves(TetComplex& complex, const Model& model, Segments& segments, const EdgeSet& required,
                      Context& context) {
  std::vector<Piece> missing;
  std::vector<VertexIndex> along;
  std::vector<TetIndex> scratch;
  for (auto e = static_cast<std::uint32_t>(segments.num_surface_edges); e < segments.ends.size(); ++e) {
    segments.vertices_along(e, false, along);
    for (std::size_t i = 0; i + 1 < along.size(); ++i)
      if (complex.find_edge(along[i], along[i + 1], scratch) == kNoIndex)
        missing.push_back({e, along[i], along[i + 1]});
  }
  EdgeFlips flips(complex, required);
  bool all_there = true;
  for (const Piece& piece : missing) {
    context.check_limits();
    if (flips.recover(piece.low, piece.high, {})) continue;
    plan_split(model, segments, piece);
    all_there = false;
  }
  return all_there;
}

/// The complex with all facets in it. Edges and facets that resist get points on their edges, and all starts over.
void recover_boundary(const Model& model, Segments& segments, TetComplex& complex, std::vector<Subface>& subfaces,
                      RecoveryReport& report, const RecoveryEffort& effort, Context& context) {
  std::vector<TriangleId> failed;
  std::vector<Piece> hard;
  const bool has_curves = segments.num_surface_edges < segments.ends.size();
  for (int restart = 0; restart < kMaxRestarts; ++restart) {
    complex = complex_of_vertices(model, segments);
    DelaunayKernel kernel(complex);
    build_delaunay(complex, context);
    insert_chains(complex, kernel, model, segments);
    if (restart >= kMaxRestartsWithFlips) recover_segments(complex, kernel, model, segments, context);
    const EdgeSet required = pieces_of_edges(segments);
    hard = switch_to_edges(complex, model, segments, required, report, context);
    context.progress("recover", segments.steiner_edge.size(), 0, "points on edges");
    const bool is_enough = effort.gives_up && segments.steiner_edge.size() > model.triangles.size() / 2 + kFewPoints;
    const bool is_last_with_flips = restart + 1 == kMaxRestartsWithFlips;  // Delaunay edges take many more points
    if (!hard.empty() && (is_enough || (effort.gives_up && is_last_with_flips))) break;
    if (!hard.empty()) continue;
    subfaces.clear();
    std::size_t num_missing = 0;
    failed = recover_facets(complex, model, segments, has_curves ? pieces_of_edges(segments, true) : required, subfaces,
                            num_missing, context);
    if (restart == 0 || report.missing_faces == 0) report.missing_faces = num_missing;
    if (failed.empty() && (!has_curves || switch_to_curves(complex, model, segments, required, context))) return;
    for (const TriangleId t : failed)
      for (const std::uint32_t e : segments.of_triangle[t.index()]) plan_split_of_longest(model, segments, e);
    if (is_enough) break;
  }
  if (!hard.empty()) fail_at_edges(model, segments, hard);
  if (failed.empty()) fail_at_curves(model);
  fail_at_facets(model, failed);
}

std::vector<SplitTriangle> find_split_triangles(const Segments& segments) {
  std::vector<SplitTriangle> split;
  std::vector<VertexIndex> along;
  for (std::size_t t = 0; t < segments.of_triangle.size(); ++t) {
    SplitTriangle found{TriangleId(t), {}};
    bool has_points = false;
    for (const std::uint32_t e : segments.of_triangle[t]) {
      segments.vertices_along(e, false, along);
      has_points = has_points || along.size() > 2;
      found.outline.insert(found.outline.end(), along.begin(), along.end());
    }
    if (has_points) split.push_back(std::move(found));
  }
  return split;
}

void warn_of_split(const BoundaryGrid& grid, const RecoveryReport& report, Context& context) {
  if (report.curve_edges_split > 0)
    context.warn(fmt::format("{} edges of curves are divided into collinear pieces: {} points stay on curves inside",
                             report.curve_edges_split, report.curve_points_left));
  if (report.steiner_left == 0) return;
  const Point at = report.left.empty() ? Point{} : report.left[0].at;
  context.log(LogLevel::warning,
              fmt::format("the surface is not kept as it was given: {} points stay on its edges, the first at "
                          "({:g}, {:g}, {:g}), and {} of its triangles are divided: {}",
                          report.steiner_left, at.x, at.y, at.z, grid.split.size(),
                          report.left_why.empty() ? "no place was found for them" : report.left_why[0]));
}

/// Powers of two that make the longest sides of a thin model's box alike; {1, 1, 1} where it is not thin.
std::array<double, 3> stretch_of(const Box& box) {
  constexpr double kThin = 16;
  std::array<double, 3> factor{1, 1, 1};
  const Point side = box.high - box.low;
  if (box.longest_side() < kThin * std::min({side.x, side.y, side.z})) return factor;
  for (int axis = 0; axis < 3; ++axis) factor[axis] = std::exp2(std::floor(std::log2(box.longest_side() / side[axis])));
  return factor;
}

Model stretched(Model model, const std::array<double, 3>& factor) {
  for (Point& p : model.points)
    for (int axis = 0; axis < 3; ++axis) p[axis] *= factor[axis];
  return model;
}

/// Puts the vertices where they are without the stretch: exactly, since the factors are powers of two.
void undo_stretch(TetComplex& complex, const Model& model, const Segments& segments,
                  const std::array<double, 3>& factor) {
  for (TetVertex& v : complex.vertex) {
    v.x /= factor[0];
    v.y /= factor[1];
    v.z /= factor[2];
  }
  set_model_sizes(complex, model, segments);
  for (std::uint32_t e = 0; e < segments.chain.size(); ++e)
    for (const auto& [t, v] : segments.chain[e]) {
      const auto& [a, b] = segments.ends[e];
      complex.segment_points.at(v) = ExactPoint::on_segment(model.points[VertexId(a)], model.points[VertexId(b)], t);
      complex.vertex[v].h = (1 - t) * complex.vertex[a].h + t * complex.vertex[b].h;
    }
}

/// All of recovery, with coordinates stretched by `factor` as long as edges and facets are recovered.
/// @param grid  holds what there is, also when this throws
void try_boundary(const Model& model, const std::array<double, 3>& factor, std::size_t most_steiner,
                  const DomainOptions& domain, const std::vector<bool>& is_far_field, const RecoveryEffort& effort,
                  BoundaryGrid& grid, RecoveryReport& report, Context& context) {
  const bool is_plain = factor == std::array<double, 3>{1, 1, 1};
  const Model stretched_model = is_plain ? Model() : stretched(model, factor);
  const Model& recovered = is_plain ? model : stretched_model;
  Segments segments = build_segments(recovered);
  segments.most_steiner = std::min(segments.most_steiner, most_steiner);
  std::vector<Subface> subfaces;
  grid = {};
  report = {};
  recover_boundary(recovered, segments, grid.complex, subfaces, report, effort, context);
  if (!is_plain) undo_stretch(grid.complex, model, segments, factor);
  const auto facts = colour_regions(grid.complex, subfaces, model, is_far_field, context);
  const std::vector<bool> keep = choose_regions(grid.complex, facts, domain);
  const std::vector<std::uint32_t> order = order_regions(facts, keep);
  grid.regions = name_regions(facts, order, model);
  strip_outside(grid.complex, order);
  keep_curve_edges(grid.complex, segments);
  unsplit_boundary(grid.complex, segments, report, context);
  const EdgeSet& kept = grid.complex.kept_edges;  // constrained faces hold all other edges that matter
  EdgeFlips(grid.complex, kept).restore_delaunay(context);
  if (thin_out(grid.complex, context) > 0) EdgeFlips(grid.complex, kept).restore_delaunay(context);
  grid.curve_pieces = find_curve_pieces(grid.complex, model, segments, report, context);
  if (report.steiner_left > 0) grid.split = find_split_triangles(segments);
  warn_of_split(grid, report, context);
}

}  // namespace

// Which tets fill a polyhedron does not depend on a stretch along an axis, but how many points its edges need to become
// Delaunay does: by orders of magnitude where the model is thin. So a thin model that needs many is stretched.
BoundaryGrid tetrahedralize_boundary(const Model& model, const DomainOptions& domain,
                                     const std::vector<bool>& is_far_field, RecoveryReport& report, Context& context,
                                     const RecoveryEffort& effort) {
  const StageTimer timer(context, "recover");
  const std::array<double, 3> plain{1, 1, 1}, factor = stretch_of(model.bounding_box());
  constexpr std::size_t kNoBound = std::numeric_limits<std::size_t>::max();
  const std::size_t few = model.triangles.size() + 100;
  BoundaryGrid grid;
  if (factor != plain)
    for (const auto& [how, most] : {std::pair{plain, few}, {factor, kNoBound}}) {
      try {
        try_boundary(model, how, most, domain, is_far_field, effort, grid, report, context);
        return grid;
      } catch (const MeshingError&) {
        // the next way may do
      }
    }
  try {
    try_boundary(model, plain, kNoBound, domain, is_far_field, effort, grid, report, context);
    return grid;
  } catch (const MeshingError& e) {
    throw MeshingError(e.what(), e.places, std::make_shared<const Mesh>(mesh_unfinished(grid.complex, model)));
  }
}

}  // namespace delfront
