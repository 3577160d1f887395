// SPDX-License-Identifier: Apache-2.0
// A piece is cut in four until curvature asks for about one size on it, or it is no longer than half of that.
#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "brep_sizes/size_parts.hpp"
#include "sizing/geometry_facets.hpp"

namespace delfront {
namespace {

constexpr int kMostCuts = 6;       ///< of a piece, in four
constexpr int kMostHalvings = 12;  ///< of a part of an edge
constexpr int kPartsOfEdge = 16;
constexpr double kShortPiece = 1;  ///< of the size: no use in cutting further
constexpr std::size_t kGrain = 128;

class CurvatureFinder {
 public:
  explicit CurvatureFinder(const BrepSizes& wish) : wish_(wish) {}

  void look_at_piece(const FacePiece& piece, int cuts, GeometrySources& found) const {
    double least = wish_.hmax, most = 0;
    const auto take = [&](Point2 uv) {
      const double h = size_at(piece.surface->derivatives(uv));
      least = std::min(least, h);
      most = std::max(most, h);
    };
    take(piece.middle());
    for (std::size_t k = 0; k < 3; ++k)
      if (piece.pole[k] == 0) take(piece.uv[k]);
    if (most > kEvenSizes * least && cuts < kMostCuts && piece.longest_side() > kShortPiece * least) {
      for (const FacePiece& part : piece.quarters()) look_at_piece(part, cuts + 1, found);
      return;
    }
    if (least < wish_.hmax) add_source(found, simplex(piece.at), least, wish_.hmin, "curvature");
  }

  void look_at_edge(const BrepEdge& edge, GeometrySources& found) const {
    if (edge.is_degenerate()) return;
    const double step = (edge.range[1] - edge.range[0]) / kPartsOfEdge;
    for (int i = 0; i < kPartsOfEdge; ++i)
      look_at_part(edge, edge.range[0] + i * step, edge.range[0] + (i + 1) * step, 0, found);
  }

 private:
  double bounded(double curvature) const {
    if (!(curvature > 0)) return wish_.hmax;
    return std::clamp(size_on_radius(1 / curvature, wish_.curvature), wish_.hmin, wish_.hmax);
  }
  double size_at(const SurfaceDerivatives& s) const { return bounded(largest_curvature(s)); }
  double size_at(const CurveDerivatives& c) const {
    const double speed = length(c.first);
    return speed > 0 ? bounded(length(cross(c.first, c.second)) / (speed * speed * speed)) : wish_.hmax;
  }

  void look_at_part(const BrepEdge& edge, double from, double to, int halvings, GeometrySources& found) const {
    const double middle = 0.5 * (from + to);
    const CurveDerivatives c[3] = {edge.curve->derivatives(from), edge.curve->derivatives(middle),
                                   edge.curve->derivatives(to)};
    double h[3];
    for (int k = 0; k < 3; ++k) h[k] = size_at(c[k]);
    const auto [least, most] = std::minmax_element(h, h + 3);
    const double length = distance(c[0].at, c[1].at) + distance(c[1].at, c[2].at);
    if (!(*least < wish_.hmax)) return;
    // a piece that is cut lies nearer to its curve, too
    if ((*most > kEvenSizes * *least || length > *least) && halvings < kMostHalvings && length > kShortPiece * *least) {
      look_at_part(edge, from, middle, halvings + 1, found);
      look_at_part(edge, middle, to, halvings + 1, found);
      return;
    }
    add_source(found, simplex(c[0].at, c[2].at), *least, wish_.hmin, "curvature");
  }

  const BrepSizes& wish_;
};

}  // namespace

GeometrySources find_curvature(const Brep& brep, std::span<const FacePiece> pieces, const BrepSizes& wish,
                               Context& context) {
  GeometrySources found;
  const CurvatureSizes& c = wish.curvature;
  if (!c.cells_per_turn && !c.angle_deg && !c.deviation) return found;
  const CurvatureFinder finder(wish);
  std::vector<GeometrySources> blocks((pieces.size() + kGrain - 1) / kGrain);
  parallel_ranges(context.threads, pieces.size(), kGrain, [&](std::size_t first, std::size_t last) {
    context.check_limits();
    for (std::size_t i = first; i < last; ++i) finder.look_at_piece(pieces[i], 0, blocks[first / kGrain]);
  });
  for (GeometrySources& block : blocks) found.append(std::move(block));
  for (const BrepEdge& edge : brep.edges) finder.look_at_edge(edge, found);
  return found;
}

}  // namespace delfront
