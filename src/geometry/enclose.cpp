// SPDX-License-Identifier: Apache-2.0
#include "geometry/enclose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "geometry/patches.hpp"

namespace delfront {
namespace {

constexpr double kDefaultFraction = 0.2;  ///< of the radius or shortest half side: about what growth 1.2 reaches there
constexpr double kMaxTriangles = 5e7;
constexpr std::uint32_t kNoInputFace = 0xffffffffu;

void append_triangle(Model& model, PatchId patch, VertexId a, VertexId b, VertexId c) {
  model.triangles.push_back({a, b, c});
  model.patch_of_triangle.push_back(patch);
  model.input_face.push_back(kNoInputFace);
}

int pieces(double length_of_side, double h) { return std::max(1, static_cast<int>(std::lround(length_of_side / h))); }

/// A point on the lattice of the box's surface, made once.
class BoxLattice {
 public:
  BoxLattice(Model& model, const Box& box, const std::array<int, 3>& counts)
      : model_(model), box_(box), counts_(counts) {}

  VertexId vertex(const std::array<int, 3>& index) {
    const auto [it, is_new] = made_.try_emplace(index, model_.points.next_id());
    if (is_new) {
      Point p;
      for (int k = 0; k < 3; ++k) {
        const int i = index[std::size_t(k)], n = counts_[std::size_t(k)];
        // The last plane gets the box's coordinate itself, so that sides are exactly flat.
        p[k] = i == n ? box_.high[k] : box_.low[k] + (box_.high[k] - box_.low[k]) * i / n;
      }
      model_.points.push_back(p);
    }
    return it->second;
  }

 private:
  Model& model_;
  const Box& box_;
  std::array<int, 3> counts_;
  std::map<std::array<int, 3>, VertexId> made_;
};

Box box_from(const EncloseOptions& options, Point centre, double size) {
  if (!options.corners) return {centre - Point{size, size, size}, centre + Point{size, size, size}};
  const auto& c = *options.corners;
  for (std::size_t k = 0; k < 3; ++k)
    if (!(c[k] < c[k + 3]))
      throw UsageError(
          fmt::format("enclose: the box's low corner ({:g}, {:g}, {:g}) must be below its high corner "
                      "({:g}, {:g}, {:g}) along every axis",
                      c[0], c[1], c[2], c[3], c[4], c[5]));
  return {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
}

void require_positive(double value, const char* what) {
  if (!(value > 0) || !std::isfinite(value))
    throw UsageError(fmt::format("enclose: the {} is {:g}; it must be positive and finite", what, value));
}

void require_affordable(double triangles, double h) {
  if (triangles > kMaxTriangles)
    throw UsageError(
        fmt::format("enclose: triangles of side {:g} would be about {:.2g} of them; ask for a larger h", h, triangles));
}

[[noreturn]] void refuse(const char* shape, Point worst, double by) {
  throw InputError(
      fmt::format("the far-field {} does not enclose the surface: ({:.6g}, {:.6g}, {:.6g}) is on it or "
                  "outside by {:.4g}; make it larger (where the body meets a symmetry plane, that plane and "
                  "the outer boundary are part of the geometry, with no far field asked for: "
                  "docs/geometry.md)",
                  shape, worst.x, worst.y, worst.z, by),
      {{worst, {}}});
}

void check_box_encloses(const Model& model, const Box& box) {
  double worst = -std::numeric_limits<double>::infinity();
  Point place;
  bool is_strict = true;
  for (const Point& p : model.points) {
    for (int k = 0; k < 3; ++k) {
      is_strict = is_strict && box.low[k] < p[k] && p[k] < box.high[k];
      const double out = std::max(box.low[k] - p[k], p[k] - box.high[k]);
      if (out <= worst) continue;
      worst = out;
      place = p;
    }
  }
  if (!is_strict) refuse("box", place, std::max(worst, 0.0));
}

/// Enough: every point within the largest sphere that fits into the facets.
void check_facets_enclose(const Model& facets, Point centre, const Model& model) {
  double inner = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : facets.triangles) {
    const Point p = facets.points[a];
    const Point normal = cross(facets.points[b] - p, facets.points[c] - p);
    inner = std::min(inner, dot(p - centre, normal) / length(normal));
  }
  constexpr double kRounding = 1e-12;
  double worst = 0;
  Point place;
  for (const Point& p : model.points) {
    if (distance(p, centre) <= worst) continue;
    worst = distance(p, centre);
    place = p;
  }
  if (!(worst < inner * (1 - kRounding))) refuse("sphere", place, std::max(worst - inner, 0.0));
}

void append_model(Model& model, const Model& more) {
  const std::size_t shift = model.points.size();
  model.points.insert(model.points.end(), more.points.begin(), more.points.end());
  for (std::size_t t = 0; t < more.triangles.size(); ++t) {
    const auto& [a, b, c] = more.triangles[TriangleId(t)];
    append_triangle(model, more.patch_of_triangle[TriangleId(t)], VertexId(a.index() + shift),
                    VertexId(b.index() + shift), VertexId(c.index() + shift));
  }
}

}  // namespace

double to_model_units(const Length& length, const LengthScale& scale) {
  if (length.unit.empty()) return length.value;
  if (length.unit == "%") return length.value / 100 * scale.diagonal;
  if (length.unit == "c") return length.value * scale.longest_side;
  throw UsageError(
      fmt::format("enclose: a length in {} must be turned into model units first (resolve_length)", length.unit));
}

void append_box(Model& model, const Box& box, double h, PatchId patch) {
  const Point side = box.high - box.low;
  const std::array<int, 3> n = {pieces(side.x, h), pieces(side.y, h), pieces(side.z, h)};
  BoxLattice lattice(model, box, n);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool is_high : {false, true}) {
      for (int i = 0; i < n[u]; ++i) {
        for (int j = 0; j < n[v]; ++j) {
          auto at = [&](int di, int dj) {
            std::array<int, 3> index{};
            index[axis] = is_high ? n[axis] : 0;
            index[u] = i + di;
            index[v] = j + dj;
            return lattice.vertex(index);
          };
          // u x v is the axis: anticlockwise in (u, v) faces outwards on the high side.
          const VertexId a = at(0, 0), b = is_high ? at(1, 0) : at(0, 1), c = at(1, 1),
                         d = is_high ? at(0, 1) : at(1, 0);
          if ((i + j) % 2 == 0) {
            append_triangle(model, patch, a, b, c);
            append_triangle(model, patch, a, c, d);
          } else {
            append_triangle(model, patch, a, b, d);
            append_triangle(model, patch, b, c, d);
          }
        }
      }
    }
  }
}

void append_sphere(Model& model, Point centre, double radius, double h, PatchId patch) {
  const double phi = (1 + std::sqrt(5.0)) / 2;
  const Point corners[12] = {{-1, phi, 0},  {1, phi, 0},  {-1, -phi, 0}, {1, -phi, 0}, {0, -1, phi},  {0, 1, phi},
                             {0, -1, -phi}, {0, 1, -phi}, {phi, 0, -1},  {phi, 0, 1},  {-phi, 0, -1}, {-phi, 0, 1}};
  constexpr int kFaces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  const double icosahedron_edge = 4 * radius / std::sqrt(10 + 2 * std::sqrt(5.0));
  // Pushing out to the sphere stretches edges by 1.13 on average.
  const int n = pieces(1.13 * icosahedron_edge, h);
  std::map<std::array<int, 4>, VertexId> on_edge;  // corner, corner, steps from the first, with corners in order
  for (const auto& face : kFaces) {
    auto vertex = [&](int i, int j) {  // i steps towards face[1], j towards face[2]
      const std::array<int, 3> weight = {n - i - j, i, j};
      std::vector<std::pair<int, int>> used;
      for (std::size_t k = 0; k < 3; ++k)
        if (weight[k] > 0) used.push_back({face[k], weight[k]});
      std::sort(used.begin(), used.end());
      Point p;
      for (const auto& [corner, w] : used) p = p + double(w) * corners[corner];
      const VertexId fresh = model.points.next_id();
      if (used.size() < 3) {
        const auto [it, is_new] =
            on_edge.try_emplace({used[0].first, used.back().first, used[0].second, used.back().second}, fresh);
        if (!is_new) return it->second;
      }
      model.points.push_back(centre + radius / length(p) * p);
      return fresh;
    };
    std::vector<std::vector<VertexId>> row(std::size_t(n) + 1);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n - i; ++j) row[std::size_t(i)].push_back(vertex(i, j));
    for (std::size_t i = 0; i < std::size_t(n); ++i) {
      for (std::size_t j = 0; j + i < std::size_t(n); ++j) {
        append_triangle(model, patch, row[i][j], row[i + 1][j], row[i][j + 1]);
        if (i + j + 1 < std::size_t(n)) append_triangle(model, patch, row[i + 1][j], row[i + 1][j + 1], row[i][j + 1]);
      }
    }
  }
}

double default_far_field_side(const EncloseOptions& options) {
  if (options.shape == "sphere" || !options.corners) return kDefaultFraction * options.size.value;
  const auto& c = *options.corners;
  return kDefaultFraction * 0.5 * std::min({c[3] - c[0], c[4] - c[1], c[5] - c[2]});
}

double far_field_volume(const EncloseOptions& options) {
  const double size = options.size.value;
  if (options.shape == "sphere") return 4.0 / 3 * std::numbers::pi * size * size * size;
  return options.corners ? box_from(options, {}, 0).volume() : 8 * size * size * size;
}

PatchId add_far_field(Model& model, const EncloseOptions& options, const LengthScale& scale, Context& context) {
  if (options.shape == "none") return {};
  if (options.shape != "box" && options.shape != "sphere")
    throw UsageError(fmt::format("enclose: unknown shape '{}'; allowed: none, box, sphere", options.shape));
  context.check_limits();
  const bool is_sphere = options.shape == "sphere";
  const Point centre = model.surface_box().centre();
  const bool has_size = is_sphere || !options.corners;
  const double size = has_size ? to_model_units(options.size, scale) : 0;
  if (has_size) require_positive(size, is_sphere ? "radius" : "half side");
  const Box box = is_sphere ? Box{} : box_from(options, centre, size);
  const Point side = box.high - box.low;
  EncloseOptions resolved = options;
  resolved.size = {size, ""};
  const double h = options.h ? to_model_units(*options.h, scale) : default_far_field_side(resolved);
  require_positive(h, "side of the triangles");
  const double area = is_sphere ? 12.57 * size * size : 2 * (side.x * side.y + side.y * side.z + side.z * side.x);
  require_affordable(2 * area / h / h, h);

  const PatchId patch = model.patches.next_id();
  Model boundary;
  if (is_sphere) {
    append_sphere(boundary, centre, size, h, patch);
    check_facets_enclose(boundary, centre, model);
  } else {
    check_box_encloses(model, box);
    append_box(boundary, box, h, patch);
  }
  const std::string name = unused_patch_name(model, options.name);
  if (name != options.name)
    context.warn(fmt::format("the far field is called '{}', as the name '{}' is taken", name, options.name));
  model.patches.push_back({name, "farfield"});
  append_model(model, boundary);
  return patch;
}

}  // namespace delfront
