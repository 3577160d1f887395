// SPDX-License-Identifier: Apache-2.0
// Curvature of triangles. Normals at corners are means over the triangles that meet there without a crease, weighted by
// their angles. A tensor S with S e = (difference of the normals) for the three sides e is fitted to each triangle, and
// another to all triangles round each corner, laid into its tangent plane by turning them. Inscribed in a sphere or a
// cylinder and with true normals both fits are exact for triangles of any size. What one triangle says alone is noise
// where it is a needle; what its corners say alone reaches into flat faces beside fillets: the smaller of both is
// taken.
#include <algorithm>
#include <cmath>

#include "Eigen/Cholesky"
#include "Eigen/Core"
#include "delfront/errors.hpp"
#include "fmt/format.h"
#include "geometry/angles.hpp"
#include "sizing/geometry_facets.hpp"
#include "sizing/geometry_plane.hpp"

namespace delfront {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Least squares for the tensor; sides are scaled by `unit`, a length of the triangle's order.
struct TensorFit {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();

  void add(double ex, double ey, double nx, double ny, double weight) {
    const Eigen::Vector3d first{ex, ey, 0}, second{0, ex, ey};
    matrix += weight * (first * first.transpose() + second * second.transpose());
    right += weight * (nx * first + ny * second);
  }
  PlaneTensor solve() const {
    const double size = matrix.trace();
    if (!(size > 0)) return {};
    constexpr double kDamping = 1e-9;  // directions that no side shows count as flat
    const Eigen::Vector3d s = (matrix + kDamping * size * Eigen::Matrix3d::Identity()).ldlt().solve(right);
    return {s[0], s[1], s[2]};
  }
};

/// `v` by the smallest turn that takes the unit vector `from` to `to`.
Point turned(Point v, Point from, Point to) {
  const Point axis = cross(from, to);
  const double c = dot(from, to);
  if (c <= -1 + 1e-12) return v;
  return c * v + cross(axis, v) + dot(axis, v) / (1 + c) * axis;
}

/// Corners of triangles at one vertex that no crease parts share a number.
std::vector<std::uint32_t> number_sectors(const Facets& facets, std::uint32_t& num_sectors) {
  DisjointSets sets(3 * facets.num_triangles());
  for (std::size_t e = 0; e < facets.edges.size(); ++e) {
    if (facets.is_crease[e]) continue;
    const auto half = facets.edges.half_edges(e);
    const auto next = [](std::uint32_t h) { return h / 3 * 3 + (h + 1) % 3; };
    sets.join(half[0], next(half[1]));
    sets.join(next(half[0]), half[1]);
  }
  return sets.number(num_sectors);
}

double corner_angle(const std::array<Point, 3>& p, std::size_t k) {
  const Point a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
  return angle_between(a, b);
}

std::vector<Point> sector_normals(const Facets& facets, const std::vector<std::uint32_t>& sector, std::size_t count) {
  std::vector<Point> normals(count);
  for (std::size_t t = 0; t < facets.num_triangles(); ++t) {
    if (!facets.is_used[t]) continue;
    const auto p = facets.corners(t);
    for (std::size_t k = 0; k < 3; ++k)
      normals[sector[3 * t + k]] = normals[sector[3 * t + k]] + corner_angle(p, k) * facets.normal[t];
  }
  for (Point& n : normals)
    if (const double size = length(n); size > 0) n = n / size;
  return normals;
}

void check_wish(const CurvatureSizes& wish) {
  check_bounds("curvature", wish.hmin, wish.hmax);
  if (wish.cells_per_turn && !(*wish.cells_per_turn >= 1 && std::isfinite(*wish.cells_per_turn)))
    throw UsageError(
        fmt::format("curvature = {}: cells per 2 pi, at least 1; usual are 8 to 40", *wish.cells_per_turn));
  if (wish.angle_deg && !(*wish.angle_deg > 0 && *wish.angle_deg < 180))
    throw UsageError(fmt::format("angle = {}: degrees between adjacent faces, above 0 and below 180; usual are 5 to 30",
                                 *wish.angle_deg));
  if (wish.deviation && !(*wish.deviation > 0 && std::isfinite(*wish.deviation)))
    throw UsageError(fmt::format("deviation = {}: a length above 0", *wish.deviation));
}

/// Feature lines: half of the turn at both ends over the length, exact for points evenly round a circle.
void add_line_sizes(const Facets& facets, const CurvatureSizes& wish, double largest, GeometrySources& found) {
  const Model& model = facets.model;
  struct Joint {
    std::array<std::uint32_t, 2> edge;
    int count = 0;
  };
  std::vector<Joint> joints(model.points.size());
  for (std::uint32_t e = 0; e < facets.edges.size(); ++e) {
    if (!facets.is_crease[e]) continue;
    for (const VertexId v : facets.edges.ends(e)) {
      Joint& joint = joints[v.index()];
      if (joint.count < 2) joint.edge[std::size_t(joint.count)] = e;
      ++joint.count;
    }
  }
  const double cos_corner = std::cos(model.feature_angle * kPi / 180);
  const auto other_end = [&](std::uint32_t e, VertexId v) {
    const auto [a, b] = facets.edges.ends(e);
    return model.points[a == v ? b : a];
  };
  // sine of half the turn; negative where the line ends or has a corner
  const auto half_turn_at = [&](VertexId v) {
    const Joint& joint = joints[v.index()];
    if (joint.count != 2) return -1.0;
    const Point p = model.points[v], a = other_end(joint.edge[0], v), b = other_end(joint.edge[1], v);
    const Point from = (p - a) / distance(a, p), to = (b - p) / distance(p, b);
    return dot(from, to) < cos_corner ? -1.0 : 0.5 * distance(from, to);
  };
  for (std::uint32_t e = 0; e < facets.edges.size(); ++e) {
    if (!facets.is_crease[e]) continue;
    const auto [a, b] = facets.edges.ends(e);
    const double first = half_turn_at(a), second = half_turn_at(b);
    const double sum = first < 0 ? 2 * second : second < 0 ? 2 * first : first + second;
    const double curvature = sum / distance(model.points[a], model.points[b]);
    if (!(curvature > 0)) continue;
    const double h = size_on_radius(1 / curvature, wish);
    if (h < largest) add_source(found, simplex(model.points[a], model.points[b]), h, wish.hmin, "curvature");
  }
}

}  // namespace

Curvature compute_curvature(const Facets& facets) {
  std::uint32_t num_sectors = 0;
  const std::vector<std::uint32_t> sector = number_sectors(facets, num_sectors);
  const std::vector<Point> normals = sector_normals(facets, sector, num_sectors);
  const std::size_t n = facets.num_triangles();
  Curvature result;
  result.largest.assign(n, 0);
  result.tensor.assign(n, {});
  std::vector<TensorFit> fits(num_sectors);
  const double unit = facets.diagonal();
  for (std::size_t t = 0; t < n; ++t) {
    if (!facets.is_used[t]) continue;
    const auto p = facets.corners(t);
    const Point normal = facets.normal[t];
    const double longest = std::max({distance(p[0], p[1]), distance(p[1], p[2]), distance(p[2], p[0])});
    const double weight = facets.area[t] / (longest * longest) / ((longest / unit) * (longest / unit));
    const auto fit = [&](TensorFit& to, Point u, Point v, double w, double scale) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Point side = (p[(k + 1) % 3] - p[k]) / scale;
        const Point change = normals[sector[3 * t + (k + 1) % 3]] - normals[sector[3 * t + k]];
        to.add(dot(side, u), dot(side, v), dot(change, u), dot(change, v), w);
      }
    };
    TensorFit own;
    const auto [u, v] = plane_frame(normal);
    fit(own, u, v, 1, longest);
    const PlaneTensor scaled = own.solve();
    result.tensor[t] = {scaled.xx / longest, scaled.xy / longest, scaled.yy / longest};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t s = sector[3 * t + k];
      if (!(squared_length(normals[s]) > 0)) continue;
      const auto [su, sv] = plane_frame(normals[s]);
      fit(fits[s], turned(su, normals[s], normal), turned(sv, normals[s], normal), weight, unit);
    }
  }
  std::vector<double> at_sector(num_sectors);
  for (std::size_t s = 0; s < num_sectors; ++s) at_sector[s] = fits[s].solve().largest() / unit;
  for (std::size_t t = 0; t < n; ++t) {
    double around = 0;
    for (std::size_t k = 0; k < 3; ++k) around = std::max(around, at_sector[sector[3 * t + k]]);
    result.largest[t] = std::min(around, result.tensor[t].largest());
  }
  return result;
}

double size_on_radius(double r, const CurvatureSizes& wish) {
  double h = std::numeric_limits<double>::infinity();
  if (wish.cells_per_turn) h = std::min(h, 2 * kPi * r / *wish.cells_per_turn);
  if (wish.angle_deg) {
    const double half = 0.5 * *wish.angle_deg * kPi / 180;
    h = std::min(h, 2 * r * (wish.form == CurvatureSizes::Form::sine ? std::sin(half) : std::tan(half)));
  }
  if (wish.deviation && std::isfinite(r)) {
    const double d = std::min(*wish.deviation, r);
    h = std::min(h, 2 * std::sqrt(d * (2 * r - d)));
  }
  return h;
}

GeometrySources find_curvature_sizes(const Model& model, const CurvatureSizes& wish, Context& context) {
  check_wish(wish);
  GeometrySources found;
  if (!wish.cells_per_turn && !wish.angle_deg && !wish.deviation) return found;
  if (is_in_the_plane(model)) return find_plane_curvature_sizes(model, wish, context);
  const Facets facets(model);
  const Curvature curvature = compute_curvature(facets);
  // flat to rounding, or so little curved that the model is smaller than the size
  const double largest = std::min(wish.hmax, 2 * facets.diagonal());
  for (std::size_t t = 0; t < facets.num_triangles(); ++t) {
    if (t % 4096 == 0) context.check_limits();
    if (!(curvature.largest[t] > 0)) continue;
    const double h = size_on_radius(1 / curvature.largest[t], wish);
    if (h < largest) add_source(found, simplex(facets.corners(t)), h, wish.hmin, "curvature");
  }
  add_line_sizes(facets, wish, largest, found);
  return found;
}

GeometrySources find_face_angle_sizes(const Model& grid, const FaceAngleSizes& wish, Context& context) {
  if (!(wish.angle_deg > 0 && wish.angle_deg < 180))
    throw UsageError(fmt::format("angle = {}: degrees between adjacent faces, above 0 and below 180", wish.angle_deg));
  if (!(wish.least_ratio > 0 && wish.least_ratio < 1))
    throw UsageError(fmt::format("least ratio {} of a pass: above 0 and below 1", wish.least_ratio));
  check_bounds("angle", wish.hmin, std::numeric_limits<double>::infinity());
  const Facets facets(grid);
  const double wanted = wish.angle_deg * kPi / 180;
  const auto form = [&](double angle) {
    return wish.form == CurvatureSizes::Form::sine ? std::sin(0.5 * angle) : std::tan(0.5 * angle);
  };
  GeometrySources found;
  for (std::size_t e = 0; e < facets.edges.size(); ++e) {
    if (e % 4096 == 0) context.check_limits();
    if (facets.is_crease[e] || facets.turn[e] <= wanted) continue;
    const auto half = facets.edges.half_edges(e);
    const auto [a, b] = facets.ends(e);
    const double height = (facets.area[half[0] / 3] + facets.area[half[1] / 3]) / distance(a, b);
    const double ratio = std::max(wish.least_ratio, form(wanted) / form(facets.turn[e]));
    add_source(found, simplex(a, b), height * ratio, wish.hmin, "angle");
  }
  return found;
}

}  // namespace delfront
