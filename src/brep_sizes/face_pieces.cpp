// SPDX-License-Identifier: Apache-2.0
#include "brep_sizes/face_pieces.hpp"

#include <algorithm>
#include <cmath>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr double kAtSide = 1e-9;  ///< of the box: parameters on a degenerate side

std::uint8_t pole_at(const SmoothSurface& surface, Point2 uv) {
  const DegenerateSides is = surface.degenerate_sides();
  if (!(is.u_low || is.u_high || is.v_low || is.v_high)) return 0;
  const ParameterBox box = surface.box();
  const auto is_at = [](double value, double side, double width) { return std::abs(value - side) <= kAtSide * width; };
  const double width_u = box.high.x - box.low.x, width_v = box.high.y - box.low.y;
  // an infinite width has its finite side at a length of 1
  const double u = std::isfinite(width_u) ? width_u : 1, v = std::isfinite(width_v) ? width_v : 1;
  if ((is.u_low && is_at(uv.x, box.low.x, u)) || (is.u_high && is_at(uv.x, box.high.x, u))) return 2;
  if ((is.v_low && is_at(uv.y, box.low.y, v)) || (is.v_high && is_at(uv.y, box.high.y, v))) return 1;
  return 0;
}

/// The same place, as many periods on as brings it nearest to another.
Point2 unwrapped(Point2 uv, Point2 near, const std::array<double, 2>& period) {
  if (period[0] > 0) uv.x += period[0] * std::round((near.x - uv.x) / period[0]);
  if (period[1] > 0) uv.y += period[1] * std::round((near.y - uv.y) / period[1]);
  return uv;
}

/// Mean of a parameter over the corners that know it.
double mean(const FacePiece& p, std::uint8_t unknown, double Point2::*parameter) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (p.pole[k] != unknown) sum += p.uv[k].*parameter, ++count;
  return count ? sum / count : p.uv[0].*parameter;
}

double between(double a, double b, bool knows_a, bool knows_b) {
  return knows_a == knows_b ? 0.5 * (a + b) : knows_a ? a : b;
}

}  // namespace

Point2 FacePiece::middle() const { return {mean(*this, 1, &Point2::x), mean(*this, 2, &Point2::y)}; }

Point2 FacePiece::middle_of_side(std::size_t k) const {
  const std::size_t j = (k + 1) % 3;
  return {between(uv[k].x, uv[j].x, pole[k] != 1, pole[j] != 1), between(uv[k].y, uv[j].y, pole[k] != 2, pole[j] != 2)};
}

double FacePiece::longest_side() const {
  return std::max({distance(at[0], at[1]), distance(at[1], at[2]), distance(at[2], at[0])});
}

std::array<FacePiece, 4> FacePiece::quarters() const {
  std::array<FacePiece, 4> parts;
  parts.fill(*this);
  std::array<Point2, 3> side;
  std::array<Point, 3> place;
  for (std::size_t k = 0; k < 3; ++k) {
    side[k] = middle_of_side(k);
    place[k] = surface->at(side[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {  // corner k stays, the others go to the middles of its sides
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    parts[k].uv[next] = side[k];
    parts[k].at[next] = place[k];
    parts[k].uv[last] = side[last];
    parts[k].at[last] = place[last];
    parts[k].pole[next] = parts[k].pole[last] = 0;
  }
  parts[3].uv = side;
  parts[3].at = place;
  parts[3].pole = {0, 0, 0};
  return parts;
}

Point FacePiece::normal(Point2 where) const {
  constexpr double kWellMapped = 1e-4;  // sine between tangents
  const SurfaceTangents s = surface->tangents(where);
  Point n = cross(s.u, s.v);
  const double size = length(n);
  n = size > kWellMapped * length(s.u) * length(s.v) ? n / size : surface->normal(where);
  return is_reversed ? -1.0 * n : n;
}

std::vector<FacePiece> pieces_of(const Brep& brep, const Model& grid, const BrepGridReport& report) {
  DELFRONT_CHECK(report.corner_uv.size() == grid.triangles.size());
  std::vector<FacePiece> pieces(grid.triangles.size());
  for (std::size_t t = 0; t < pieces.size(); ++t) {
    FacePiece& p = pieces[t];
    p.face = grid.input_face[TriangleId(t)];
    const BrepFace& face = brep.faces[FaceId(std::size_t(p.face))];
    p.surface = face.surface.get();
    p.is_reversed = face.is_reversed;
    p.uv = report.corner_uv[t];
    for (std::size_t k = 0; k < 3; ++k) {
      p.at[k] = grid.points[grid.triangles[TriangleId(t)][k]];
      p.pole[k] = pole_at(*p.surface, p.uv[k]);
    }
    std::size_t known = 0;
    while (known < 2 && p.pole[known] != 0) ++known;
    for (std::size_t k = 0; k < 3; ++k) p.uv[k] = unwrapped(p.uv[k], p.uv[known], p.surface->period());
  }
  return pieces;
}

}  // namespace delfront
