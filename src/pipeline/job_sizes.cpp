// SPDX-License-Identifier: Apache-2.0
// Every way of the job file to ask for sizes, put together as one field.
#include "pipeline/job_sizes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delfront/adaptive_background.hpp"
#include "delfront/background.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "delfront/size_expression.hpp"
#include "delfront/solution_metric.hpp"
#include "pipeline/kept_domain.hpp"
#include "pipeline/option_table.hpp"
#include "sizing/asked_sizes.hpp"
#include "sizing/sampled_bounds.hpp"
#include "sizing/size_octree.hpp"
#include "sizing/within_domain.hpp"

namespace delfront {

namespace {

using FieldPointer = std::shared_ptr<const SizeField>;

constexpr double kMuchOutside = 0.1;
constexpr double kPlacesOnBoundary = 5000;

double hmin_of(const Options& options) { return options.size.hmin ? options.size.hmin->value : 0; }
double hmax_of(const Options& options) {
  return options.size.hmax ? options.size.hmax->value : std::numeric_limits<double>::infinity();
}

FieldPointer build_source_part(const Options& options, const Model& model, double growth,
                               const std::function<bool(Point)>& is_kept, Context& context) {
  std::vector<SizeSource> sources = job_sources(options, context);
  std::vector<SizeSource> of_geometry = geometry_sources(options, model, is_kept, context);
  sources.insert(sources.end(), std::make_move_iterator(of_geometry.begin()),
                 std::make_move_iterator(of_geometry.end()));
  if (sources.empty()) return nullptr;
  return build_source_size_field(std::move(sources), {.growth = growth, .time = options.size.time}, context);
}

/// What is wrong with one of the texts is said with its key and place.
FieldPointer build_expression_part(const Options& options, const Model& model, const Box& domain, double growth,
                                   Context& context) {
  const ExpressionOptions& asked = options.size.expression;
  if (asked.delta.empty()) return nullptr;
  const auto optional_text = [](const std::string& text) {
    return text.empty() ? std::nullopt : std::optional<std::string>(text);
  };
  const auto optional_texts = [](const std::array<std::string, 3>& texts) {
    return texts[0].empty() ? std::nullopt : std::optional<std::array<std::string, 3>>(texts);
  };
  ExpressionSizes sizes;
  const auto check = [&](const char* part, const std::string& text) {
    if (text.empty()) return;
    try {
      for (const std::string& name : distances_in(text))
        sizes.names.distances[name] = build_distance_field(named_part(model, name));
      Expression(text, sizes.names);
    } catch (const UsageError& e) {
      throw usage_error(options, fmt::format("size.expression.{}", part), e.what());
    } catch (const InputError& e) {  // the formula is at fault, not the input
      throw usage_error(options, fmt::format("size.expression.{}", part), e.what());
    }
  };
  check("delta", asked.delta);
  check("s1", asked.s1);
  check("s2", asked.s2);
  for (const std::string& text : asked.first) check("first", text);
  for (const std::string& text : asked.second) check("second", text);
  try {
    sizes.delta = asked.delta;
    sizes.s1 = optional_text(asked.s1);
    sizes.s2 = optional_text(asked.s2);
    sizes.first = optional_texts(asked.first);
    sizes.second = optional_texts(asked.second);
    sizes.domain = domain;
    // Clamped first: where a formula falls towards 0, growth need not be seen to below hmin.
    FieldPointer clamped = combine_size_fields({ask_within(build_expression_size_field(sizes, context), domain)},
                                               hmin_of(options), hmax_of(options));
    return limit_growth(std::move(clamped), domain, growth, context);
  } catch (const ExpressionError& e) {
    throw usage_error(options, "size.expression." + e.part, e.what());
  } catch (const UsageError& e) {  // s2 along what?
    throw usage_error(options, "size.expression.second", e.what());
  } catch (const InputError& e) {
    throw usage_error(options, "size.expression.delta", e.what());
  }
}

/// Places spread evenly over the triangles of the model, or, in the plane, over its lines.
std::vector<Point> places_on_boundary(const Model& model) {
  std::vector<std::array<Point, 3>> pieces;
  for (const auto& t : model.triangles) pieces.push_back({model.points[t[0]], model.points[t[1]], model.points[t[2]]});
  const bool is_planar = pieces.empty();
  if (is_planar)
    for (const Curve& curve : model.curves)
      for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i) {
        const Point b = model.points[curve.vertices[i + 1]];
        pieces.push_back({model.points[curve.vertices[i]], b, b});
      }
  const auto measure = [&](const std::array<Point, 3>& p) {
    return is_planar ? distance(p[0], p[1]) : length(cross(p[1] - p[0], p[2] - p[0]));
  };
  double whole = 0, waiting = 0;
  for (const auto& piece : pieces) whole += measure(piece);
  std::vector<Point> places;
  for (const auto& [a, b, c] : pieces) {
    waiting += kPlacesOnBoundary * measure({a, b, c}) / whole;
    for (; waiting > 0; --waiting) {  // fractions of two golden ratios fill the piece evenly
      const auto n = static_cast<double>(places.size());
      double u = std::fmod(n * 0.7548776662466927, 1.0), v = is_planar ? 0 : std::fmod(n * 0.5698402909980532, 1.0);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      places.push_back(a + u * (b - a) + v * (c - a));
    }
  }
  return places;
}

/// Most of the domain should lie in the grid: outside, sizes are those of its nearest border, which not everyone means.
void warn_of_share_outside(const BackgroundField& field, const std::string& file, const Model& model,
                           Context& context) {
  const double share = field.share_outside(places_on_boundary(model));
  if (share > kMuchOutside)
    context.warn(
        fmt::format("about {:.0f} % of the boundary lies outside of {}: sizes there are those of its nearest border",
                    100 * share, file));
}

bool has_node_field(const Mesh& mesh, const std::string& name) {
  return std::any_of(mesh.fields.begin(), mesh.fields.end(),
                     [&](const Field& field) { return field.on == Field::On::vertices && field.name == name; });
}

FieldPointer build_background_part(const Options& options, const Model& model, const Box& domain, double growth,
                                   Context& context) {
  const BackgroundFileOptions& asked = options.size.background;
  if (asked.file.empty()) return nullptr;
  return with_place(options, "size.background.file", [&]() -> FieldPointer {
    BackgroundGrid grid;
    grid.mesh = read_mesh(asked.file, context);
    grid.name = asked.file;
    grid.metric = asked.metric;
    if (asked.metric.empty()) grid.size = asked.size;
    if (grid.metric.empty() && grid.size.empty() && has_node_field(grid.mesh, "h")) grid.size = "h";
    std::shared_ptr<const BackgroundField> field =
        build_background_size_field(grid, {.factor = asked.factor, .growth = growth}, context);
    field->require_overlap(domain);
    warn_of_share_outside(*field, asked.file, model, context);
    return field;
  });
}

FieldPointer build_solution_part(const Options& options, const Box& domain, Context& context) {
  const SolutionFileOptions& asked = options.size.solution;
  if (asked.file.empty()) return nullptr;
  SolutionOptions wish;
  wish.sensors = asked.sensor;
  wish.indicator = asked.indicator == "error" ? Indicator::error : Indicator::hessian;
  wish.norm = asked.norm;
  wish.complexity = asked.complexity;
  wish.wanted_error = asked.error;
  wish.is_stretched = asked.stretched;
  wish.hmin = hmin_of(options);
  wish.hmax = hmax_of(options);
  if (asked.stretched) wish.hgrad = asked.hgrad;
  const double growth = std::min(asked.hgrad, options.size.growth.value_or(asked.hgrad));
  return with_place(options, "size.solution.file", [&]() -> FieldPointer {
    const BackgroundGrid grid = background_from_solution(read_mesh(asked.file, context), asked.file, wish, context);
    std::shared_ptr<const BackgroundField> field = build_background_size_field(grid, {.growth = growth}, context);
    field->require_overlap(domain);
    return field;
  });
}

/// Fields of the program that calls: nothing is known of them but what they answer.
void add_parts_of_caller(const Options& options, const Model& model, const Box& domain, double growth,
                         std::vector<FieldPointer>& parts, Context& context) {
  for (const FieldPointer& field : options.size.fields) {
    FieldPointer clamped = combine_size_fields({ask_within(field, domain)}, hmin_of(options), hmax_of(options));
    clamped = sample_bounds(std::move(clamped), domain, model.points, context);
    parts.push_back(limit_growth(std::move(clamped), domain, growth, context));
  }
}

/// The field at the nodes of a grid that is refined to it (S8): points are those of an octree as fine as cells would
/// be.
FieldPointer keep_on_grid(const Options& options, const SizeField& field, const Box& domain, double growth,
                          Context& context) {
  SizeOctreeOptions how;
  how.sizes_per_leaf = 1;
  const SizeOctree octree(field, domain, how, context);
  std::vector<Point> points;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < octree.corners().size(); ++i) {
    if (!std::isfinite(octree.corner_sizes()[i])) continue;
    points.push_back(octree.corners()[i]);
    sizes.push_back(octree.corner_sizes()[i]);
  }
  const double largest = std::min(domain.diagonal(), field.largest());
  AdaptiveBackground grid(domain, options.size.adaptive.cells, largest, context);
  const AdaptReport report =
      grid.adapt(points, sizes, {.growth = growth, .refine_above = options.size.adaptive.refine_above}, context);
  if (!report.is_converged) context.warn("size.adaptive: the grid of sizes has as many cells as it may have");
  BackgroundGrid made = grid.grid(context);
  if (options.size.adaptive.smooth)
    for (Field& sizes_of : made.mesh.fields)
      if (sizes_of.name == made.size) sizes_of.values = smooth_sizes(made.mesh, field, growth, context);
  return build_background_size_field(made, {.growth = growth}, context);
}

}  // namespace

FieldPointer build_job_size_field(const Options& options, const Model& model, const Box& domain, Context& context,
                                  const std::function<bool(Point)>& is_kept) {
  const double growth = growth_asked(options.size);
  const StageTimer timer(context, "sizes");
  std::vector<FieldPointer> parts;
  parts.push_back(build_background_part(options, model, domain, growth, context));
  if (options.size.background.combine != "alone" || !parts[0]) {
    parts.push_back(build_source_part(options, model, growth, is_kept, context));
    parts.push_back(build_expression_part(options, model, domain, growth, context));
    parts.push_back(build_solution_part(options, domain, context));
    add_parts_of_caller(options, model, domain, growth, parts, context);
  }
  std::erase(parts, nullptr);
  if (parts.empty()) return nullptr;
  FieldPointer field = combine_size_fields(std::move(parts), 0, std::numeric_limits<double>::infinity());
  const bool is_front = model.triangles.empty() ? options.planar.method == "front" : options.volume.method == "front";
  if (!field->is_isotropic() && !is_front)
    context.warn(
        "stretched cells are asked for: only the front makes them (volume.method, planar.method = \"front\"), with "
        "other methods cells get the least of the sizes in all directions");
  return options.size.adaptive.cells > 0 ? keep_on_grid(options, *field, domain, growth, context) : field;
}

Model model_of(const PlanarDomain& domain) {
  Model model;
  for (const Point2 p : domain.points) model.points.push_back({p.x, p.y, 0});
  for (std::size_t i = 0; i < domain.segments.size(); ++i) {  // those that follow each other are one chain
    const auto [a, b] = domain.segments[i];
    const bool goes_on = i > 0 && domain.curve_of_segment[i] == domain.curve_of_segment[i - 1] &&
                         model.curves.back().vertices.back() == a;
    if (goes_on)
      model.curves.back().vertices.push_back(b);
    else
      model.curves.push_back({domain.curves[domain.curve_of_segment[i]].name, {a, b}});
  }
  return model;
}

std::function<bool(Point)> kept_part(PlanarDomain domain, CurveId far_field, const Options& options, Context& context) {
  if (far_field.is_valid()) domain.curves[far_field].kind = "farfield";
  Options coarse;  // the lines as they are tell
  coarse.domain = options.domain;
  coarse.planar.boundary = "keep";
  const auto kept = std::make_shared<const KeptDomain>(prepare_planar(domain, coarse, nullptr, context));
  return [kept](Point at) { return kept->is_inside(at); };
}

}  // namespace delfront
