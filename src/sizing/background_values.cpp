// SPDX-License-Identifier: Apache-2.0
#include "sizing/background_values.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/nearest_name.hpp"
#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr double kRightAngle = 1e-3;  // how far the directions of stretchings may be from it, as a cosine

std::vector<std::string> node_field_names(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const Field& field : mesh.fields)
    if (field.on == Field::On::vertices) names.push_back(field.name);
  return names;
}

std::string listed(const Mesh& mesh) {
  std::vector<std::string> all;
  for (const Field& field : mesh.fields)
    if (field.on == Field::On::vertices) all.push_back(fmt::format("'{}' ({})", field.name, field.components));
  return all.empty() ? "it has no node fields"
                     : fmt::format("its node fields (components) are {}", fmt::join(all, ", "));
}

/// Reads one value of a node after the other; errors name the grid, the field, the node and the place.
class NodeReader {
 public:
  NodeReader(const BackgroundGrid& grid, const SimplexGrid& cells) : grid_(grid), cells_(cells) {}

  const Field* find(const std::string& name, const char* what, std::initializer_list<int> components) const {
    if (name.empty()) return nullptr;
    const Field& field = find_node_field(grid_.mesh, grid_.name, name, what);
    if (std::find(components.begin(), components.end(), field.components) == components.end())
      throw InputError(fmt::format("{}: the field '{}' has {} components; {} takes {}", grid_.name, name,
                                   field.components, what, fmt::join(components, " or ")));
    if (field.values.size() != cells_.points.size() * static_cast<std::size_t>(field.components))
      throw InputError(fmt::format("{}: the field '{}' has {} numbers for {} nodes of {} components", grid_.name, name,
                                   field.values.size(), cells_.points.size(), field.components));
    return &field;
  }

  double positive(const Field& field, std::size_t node, const char* what) const {
    const double value = field.values[node];
    if (!(value > 0 && std::isfinite(value)))
      fail(field, node, fmt::format("{} {}; it must be a positive number", what, value));
    return value;
  }

  Metric metric(const Field& field, std::size_t node) const {
    const double* v = field.values.data() + node * static_cast<std::size_t>(field.components);
    Metric m;
    if (field.components == 6) m = {v[0], v[3], v[5], v[1], v[4], v[2]};
    if (field.components == 9) m = {v[0], 0.5 * (v[1] + v[3]), 0.5 * (v[2] + v[6]), v[4], 0.5 * (v[5] + v[7]), v[8]};
    if (field.components == 3) m = {v[0], v[1], 0, v[2], 0, 1};
    if (field.components == 4) m = {v[0], 0.5 * (v[1] + v[2]), 0, v[3], 0, 1};
    if (cells_.dimension == 2) m = plane_metric(m);
    if (!is_positive_definite(m))
      fail(field, node,
           fmt::format("metric xx {:g} xy {:g} xz {:g} yy {:g} yz {:g} zz {:g}, which is not positive definite; all "
                       "its eigenvalues (size^-2) must be positive numbers",
                       m.xx, m.xy, m.xz, m.yy, m.yz, m.zz));
    return m;
  }

  Point direction(const Field& field, std::size_t node) const {
    const double* v = field.values.data() + 3 * node;
    const Point d{v[0], v[1], v[2]};
    const double l = length(d);
    if (!(l > 0 && std::isfinite(l)))
      fail(field, node, fmt::format("direction ({:g} {:g} {:g}); it must have a length", d.x, d.y, d.z));
    return d / l;
  }

  [[noreturn]] void fail(const Field& field, std::size_t node, const std::string& message) const {
    const Point p = cells_.points[node];
    throw InputError(fmt::format("{}: node {} at ({:g}, {:g}, {:g}): the field '{}' has {}", grid_.name, node, p.x, p.y,
                                 p.z, field.name, message),
                     {{p, {static_cast<std::uint32_t>(node)}}});
  }

 private:
  const BackgroundGrid& grid_;
  const SimplexGrid& cells_;
};

/// Some direction at right angles to d.
Point across(Point d) {
  const Point axis = std::abs(d.x) <= std::abs(d.y) && std::abs(d.x) <= std::abs(d.z) ? Point{1, 0, 0}
                     : std::abs(d.y) <= std::abs(d.z)                                 ? Point{0, 1, 0}
                                                                                      : Point{0, 0, 1};
  const Point c = cross(d, axis);
  return c / length(c);
}

struct StretchingFields {
  const Field *s1 = nullptr, *s2 = nullptr, *direction1 = nullptr, *direction2 = nullptr;
};

Stretching stretching_at(const NodeReader& reader, const StretchingFields& fields, bool is_plane, std::size_t node) {
  Stretching s;
  s.s1 = reader.positive(*fields.s1, node, "stretching");
  s.first = reader.direction(*fields.direction1, node);
  if (is_plane && std::abs(s.first.z) > kRightAngle)
    reader.fail(*fields.direction1, node, "a direction out of the plane z = 0");
  if (!fields.direction2) {
    // Along the second direction the size is delta S2 = delta, as along the third: any will do.
    s.second = is_plane ? Point{-s.first.y, s.first.x, 0} : across(s.first);
    if (fields.s2) s.s2 = reader.positive(*fields.s2, node, "stretching");
    return s;
  }
  s.s2 = reader.positive(*fields.s2, node, "stretching");
  const Point second = reader.direction(*fields.direction2, node);
  if (std::abs(dot(second, s.first)) > kRightAngle)
    reader.fail(*fields.direction2, node, "a direction that is not at right angles to the first");
  const Point straight = second - dot(second, s.first) * s.first;
  s.second = straight / length(straight);
  return s;
}

void check_names(const BackgroundGrid& grid, bool is_plane) {
  if (!grid.has_stretchings()) return;
  if (grid.size.empty() || grid.s1.empty() || grid.direction1.empty())
    throw UsageError(fmt::format(
        "{}: stretchings need the fields size, s1 and direction1 (and, for a second one, s2 and direction2)",
        grid.name));
  if (!is_plane && grid.s2.empty() != grid.direction2.empty())
    throw UsageError(fmt::format("{}: s2 and direction2 go together: name both or none", grid.name));
}

/// Without any name: the only node field.
BackgroundGrid with_names(const BackgroundGrid& grid) {
  BackgroundGrid named{{}, grid.name, grid.size, grid.metric, grid.s1, grid.s2, grid.direction1, grid.direction2};
  if (!grid.size.empty() || !grid.metric.empty() || grid.has_stretchings()) return named;
  const Field* only = nullptr;
  for (const Field& field : grid.mesh.fields) {
    if (field.on != Field::On::vertices) continue;
    if (only)
      throw UsageError(
          fmt::format("{}: which field holds the sizes? {}; name it as size or metric", grid.name, listed(grid.mesh)));
    only = &field;
  }
  if (!only) throw InputError(fmt::format("{}: it has no node fields to take sizes from", grid.name));
  (only->components == 1 ? named.size : named.metric) = only->name;
  return named;
}

void check_options(const BackgroundOptions& options) {
  if (!(options.factor > 0 && std::isfinite(options.factor)))
    throw UsageError(fmt::format("factor is {}; it must be a positive number", options.factor));
  if (!(options.hmin >= 0 && options.hmax > 0 && options.hmin <= options.hmax))
    throw UsageError(
        fmt::format("hmin = {} and hmax = {}: need 0 <= hmin <= hmax and hmax > 0", options.hmin, options.hmax));
  if (!(options.growth > 1))
    throw UsageError(fmt::format("growth is {}; it must be a number greater than 1, e.g. 1.2", options.growth));
}

Metric scaled(const Metric& m, double weight) {
  return {weight * m.xx, weight * m.xy, weight * m.xz, weight * m.yy, weight * m.yz, weight * m.zz};
}

}  // namespace

const Field& find_node_field(const Mesh& mesh, const std::string& grid_name, const std::string& name,
                             const char* what) {
  const Field* on_cells = nullptr;
  for (const Field& field : mesh.fields) {
    if (field.name != name) continue;
    if (field.on == Field::On::vertices) return field;
    on_cells = &field;
  }
  if (on_cells)
    throw UsageError(fmt::format("{}: the field '{}' ({}) has its values on cells; they are needed on nodes ({})",
                                 grid_name, name, what, listed(mesh)));
  const std::string nearest = nearest_name(name, node_field_names(mesh));
  throw UsageError(fmt::format("{}: no node field '{}' ({}); {}{}", grid_name, name, what,
                               nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest), listed(mesh)));
}

std::vector<char> used_vertices(const SimplexGrid& grid) {
  std::vector<char> used(grid.points.size(), 0);
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell)
    for (std::uint32_t v : grid.corners(cell)) used[v] = 1;
  return used;
}

Metric plane_metric(const Metric& m) {
  const double mean = 0.5 * (m.xx + m.yy), half = 0.5 * (m.xx - m.yy);
  return {m.xx, m.xy, 0, m.yy, 0, m.xy == 0 ? std::max(m.xx, m.yy) : mean + std::hypot(half, m.xy)};
}

bool is_positive_definite(const Metric& m) {
  for (double value : {m.xx, m.xy, m.xz, m.yy, m.yz, m.zz})
    if (!std::isfinite(value)) return false;
  return metric_axes(m).value[0] > 0;
}

NodeSizes read_node_sizes(const BackgroundGrid& given, const SimplexGrid& cells, const BackgroundOptions& options) {
  check_options(options);
  const bool is_plane = cells.dimension == 2;
  check_names(given, is_plane);
  const BackgroundGrid names = with_names(given);
  const NodeReader reader(given, cells);
  const Field* size = reader.find(names.size, "size", {1});
  const Field* metric =
      is_plane ? reader.find(names.metric, "metric", {3, 4, 6, 9}) : reader.find(names.metric, "metric", {6, 9});
  const StretchingFields stretching = {reader.find(names.s1, "s1", {1}), reader.find(names.s2, "s2", {1}),
                                       reader.find(names.direction1, "direction1", {3}),
                                       reader.find(names.direction2, "direction2", {3})};
  const std::vector<char> used = used_vertices(cells);
  const auto limited = [&](double h) { return std::clamp(options.factor * h, options.hmin, options.hmax); };
  const double weight = 1 / (options.factor * options.factor);
  NodeSizes result;
  const std::size_t n = cells.points.size();
  const bool is_isotropic = !metric && !stretching.s1;
  if (is_isotropic)
    result.size.assign(n, 1);
  else
    result.metric.assign(n, Metric{});
  for (std::size_t node = 0; node < n; ++node) {
    if (!used[node]) continue;
    const double delta = size ? reader.positive(*size, node, "size") : 0;
    if (is_isotropic) {
      result.size[node] = limited(delta);
      continue;
    }
    Metric m = size ? isotropic_metric(delta) : Metric{};
    if (stretching.s1) m = stretched_metric(delta, stretching_at(reader, stretching, is_plane, node));
    if (metric) m = size ? intersection(m, reader.metric(*metric, node)) : reader.metric(*metric, node);
    if (is_plane) m = plane_metric(m);
    result.metric[node] = scaled(m, weight);
    if (options.hmin > 0 || options.hmax < std::numeric_limits<double>::infinity())
      result.metric[node] = clamped(result.metric[node], options.hmin, options.hmax);
  }
  return result;
}

}  // namespace delfront
