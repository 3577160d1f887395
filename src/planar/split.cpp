// SPDX-License-Identifier: Apache-2.0
#include "planar/split.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "planar/edit.hpp"
#include "planar/pieces.hpp"

namespace delfront {

namespace {

constexpr std::size_t kSamples = 33;              ///< of the size along a piece, odd
constexpr double kLongest = std::numbers::sqrt2;  ///< of the size
constexpr double kShortest = 0.1;     ///< of the size: no piece is halved below that, whoever stands in its circle
constexpr double kAcuteCosine = 0.5;  ///< 60 degrees
constexpr std::size_t kPiecesPerCancelCheck = 256;

class Splitting {
 public:
  Splitting(PlanarGrid& grid, const SizeField& size, bool in_metric, Context& context)
      : grid_(grid), c_(grid.complex), size_(size), in_metric_(in_metric), context_(context) {}

  std::size_t run(bool by_circles) {
    split_by_size();
    if (!by_circles) return count_;
    find_acute_corners();
    split_encroached();
    return count_;
  }

 private:
  Point2 at(VertexIndex v) const { return c_.point[v]; }

  bool is_in_use(const PlanarPiece& piece) const {
    const EdgeRef ref = c_.find_edge(piece.a, piece.b);
    return c_.tri[ref >> 2].region != kOutside || c_.tri[c_.across(ref) >> 2].region != kOutside;
  }

  /// Where to divide the line a + t along, 0 < t < 1, so that each part is about as long as the size there: equal parts
  /// of the integral of 1/h.
  std::vector<double> places_by_size(Point2 a, Point2 along) const {
    std::array<Point, kSamples> places;
    std::array<double, kSamples> sizes, sum;
    for (std::size_t k = 0; k < kSamples; ++k) {
      const Point2 p = a + (static_cast<double>(k) / (kSamples - 1)) * along;
      places[k] = {p.x, p.y, 0};
    }
    if (in_metric_)
      sizes_along(along, places, sizes);
    else
      size_.sizes(places, sizes);
    const double step = std::sqrt(squared_length(along)) / (kSamples - 1);
    sum[0] = 0;
    for (std::size_t k = 1; k < kSamples; ++k) sum[k] = sum[k - 1] + 0.5 * step * (1 / sizes[k - 1] + 1 / sizes[k]);
    std::size_t parts = number_of_pieces(sum.back(), context_);
    if (sum.back() > kLongest * static_cast<double>(parts)) ++parts;
    std::vector<double> result;
    for (std::size_t part = 1, k = 1; part < parts; ++part) {
      if (part % kPiecesPerLimitCheck == 0) context_.check_limits();
      const double wanted = sum.back() * static_cast<double>(part) / static_cast<double>(parts);
      while (sum[k] < wanted) ++k;
      const double share = (wanted - sum[k - 1]) / (sum[k] - sum[k - 1]);
      result.push_back((static_cast<double>(k - 1) + share) / (kSamples - 1));
    }
    return result;
  }

  /// Wanted lengths in one direction.
  void sizes_along(Point2 along, const std::array<Point, kSamples>& places, std::array<double, kSamples>& sizes) const {
    std::array<Metric, kSamples> metrics;
    size_.metrics(places, metrics);
    const double length = std::sqrt(squared_length(along));
    for (std::size_t k = 0; k < kSamples; ++k) sizes[k] = length / length_in(metrics[k], {along.x, along.y, 0});
  }

  void split_by_size() {
    const std::size_t num_given = grid_.pieces.size();
    for (std::size_t i = 0; i < num_given; ++i) {
      if (i % kPiecesPerCancelCheck == 0) context_.progress("split", i, num_given, "segments");
      const PlanarPiece piece = grid_.pieces[i];
      if (!is_in_use(piece)) continue;
      const Point2 a = at(piece.a), along = at(piece.b) - a;
      std::size_t current = i;
      for (const double t : places_by_size(a, along))
        if (const std::size_t after = split(current, a + t * along); after != kNone) current = after;
    }
  }

  /// Put p on a piece, which keeps its first part. @return the new piece, its second part
  std::size_t split(std::size_t i, Point2 p) {
    const PlanarPiece piece = grid_.pieces[i];
    const auto m = static_cast<VertexIndex>(c_.point.size());
    c_.point.push_back(p);
    c_.vertex_tri.push_back(kNoTri);
    const EdgeRef made = split_edge(c_, c_.find_edge(piece.a, piece.b), m);
    if (made == kNoTri) {
      c_.point.pop_back();
      c_.vertex_tri.pop_back();
      return kNone;
    }
    ++count_;
    grid_.pieces[i].b = m;
    grid_.pieces.push_back({m, piece.b, piece.curve});
    edges_.clear();
    const EdgeRef first = c_.first_edge(m);
    EdgeRef ref = first;
    do {
      for (unsigned e = 0; e < 3; ++e) edges_.push_back((ref & ~3u) + e);
      ref = c_.turn_left(ref);
    } while (ref != first);
    make_delaunay(c_, edges_);
    if (count_ % kPiecesPerCancelCheck == 0) {
      context_.check_limits();
      context_.check_cells(grid_.pieces.size());
    }
    return grid_.pieces.size() - 1;
  }

  void find_acute_corners() {
    is_acute_.assign(c_.point.size(), false);
    std::vector<std::vector<Point2>> directions(c_.point.size());
    const auto add = [&](VertexIndex v, Point2 d) {
      for (const Point2 other : directions[v]) is_acute_[v] = is_acute_[v] || dot(d, other) > kAcuteCosine;
      directions[v].push_back(d);
    };
    for (const PlanarPiece& piece : grid_.pieces) {
      const Point2 along = at(piece.b) - at(piece.a);
      const Point2 d = (1 / std::sqrt(squared_length(along))) * along;
      add(piece.a, d);
      add(piece.b, -1 * d);
    }
  }

  bool is_acute(VertexIndex v) const { return v < is_acute_.size() && is_acute_[v]; }

  /// Whether the corner opposite a piece, on a side that is gridded, lies in the circle over it.
  bool is_encroached(const PlanarPiece& piece) const {
    const EdgeRef ref = c_.find_edge(piece.a, piece.b);
    for (const EdgeRef side : {ref, c_.across(ref)}) {
      const VertexIndex apex = c_.apex(side);
      if (c_.tri[side >> 2].region == kOutside || apex == kInfinity) continue;
      if (dot(at(piece.a) - at(apex), at(piece.b) - at(apex)) < 0) return true;
    }
    return false;
  }

  /// The middle; from an acute corner a power of two, so that pieces that meet there end on common circles and do not
  /// encroach upon each other for ever.
  Point2 place_in(const PlanarPiece& piece) const {
    const Point2 a = at(piece.a), b = at(piece.b);
    if (is_acute(piece.a) == is_acute(piece.b)) return 0.5 * (a + b);
    const bool from_b = is_acute(piece.b);
    const Point2 corner = from_b ? b : a, along = from_b ? a - b : b - a;
    const double length = std::sqrt(squared_length(along));
    double shell = std::exp2(std::round(std::log2(length / 2)));
    if (shell > 2 * length / 3) shell /= 2;
    return corner + (shell / length) * along;
  }

  /// Halves a piece that has a corner in its circle. @return whether it did
  bool split_if_encroached(std::size_t i) {
    const PlanarPiece piece = grid_.pieces[i];
    if (!is_encroached(piece)) return false;
    const Point2 p = place_in(piece);
    const double shortest = kShortest * size_.size({p.x, p.y, 0});
    if (squared_length(at(piece.b) - at(piece.a)) < 4 * shortest * shortest) return false;
    return split(i, p) != kNone;
  }

  /// Sweeps over all pieces until one changes nothing: new points may stand in the circles of others, and a sweep costs
  /// no more than the search for those would.
  void split_encroached() {
    for (bool is_done = false; !is_done;) {
      is_done = true;
      const std::size_t num_pieces = grid_.pieces.size();
      for (std::size_t i = 0; i < num_pieces; ++i) {
        if (i % kPiecesPerCancelCheck == 0) context_.check_limits();
        if (split_if_encroached(i)) is_done = false;
      }
    }
  }

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  PlanarGrid& grid_;
  TriComplex& c_;
  const SizeField& size_;
  bool in_metric_;
  Context& context_;
  std::vector<bool> is_acute_;
  std::vector<EdgeRef> edges_;
  std::size_t count_ = 0;
};

}  // namespace

std::size_t split_segments(PlanarGrid& grid, const SizeField& size, bool in_metric, bool by_circles, Context& context) {
  const StageTimer timer(context, "split");
  return Splitting(grid, size, in_metric, context).run(by_circles);
}

}  // namespace delfront
