// SPDX-License-Identifier: Apache-2.0
// Entries of [[size.source]] and [[size.box]] become sources; what is wrong with one is said with its place.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/name_pattern.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "delfront/model.hpp"
#include "pipeline/job_sizes.hpp"
#include "pipeline/option_table.hpp"

namespace delfront {

namespace {

SizeLaw law_of(const SourceOptions& source) {
  SizeLaw law;
  law.kind = source.law == "exponential"  ? SizeLaw::Kind::exponential
             : source.law == "polynomial" ? SizeLaw::Kind::polynomial
                                          : SizeLaw::Kind::power;
  const bool has_law = source.r1 || !source.law.empty();
  if (!has_law) law.kind = SizeLaw::Kind::step;
  if (has_law && !source.r1) throw UsageError("r1 is missing, the scaling length of the law");
  if (!source.delta0) throw UsageError("delta0 is missing, the size on the source");
  law.delta0 = source.delta0->value;
  law.r0 = source.r0.value;
  law.r1 = source.r1.value_or(Length{1, ""}).value;
  law.gamma = source.gamma;
  law.polynomial = source.coefficients;
  if (source.law == "polynomial" && source.coefficients.empty())
    throw UsageError("law: a polynomial needs coefficients, e.g. { type = \"polynomial\", coefficients = [0, 1] }");
  return law;
}

std::vector<std::array<Point, 3>> read_facets(const std::string& path, Context& context) {
  if (path.empty()) throw UsageError("file is missing, the facets of the surface");
  const Model model = build_model({{read_mesh(path, context), "surface"}}, context);
  std::vector<std::array<Point, 3>> facets;
  for (const auto& t : model.triangles) facets.push_back({model.points[t[0]], model.points[t[1]], model.points[t[2]]});
  return facets;
}

void need_points(const SourceOptions& source, std::size_t least, std::size_t most) {
  const std::size_t n = source.at.size();
  if (n >= least && n <= most) return;
  throw UsageError(
      fmt::format("at: a {} has {}{} points, got {}", source.type, least == most ? "" : "at least ", least, n));
}

std::vector<SourceShape> shapes_of(const SourceOptions& source, Context& context) {
  if (source.type != "surface" && !source.file.empty()) throw UsageError("file is of sources of type surface");
  if (source.type == "surface" && !source.at.empty()) throw UsageError("at: a surface has its places in its file");
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  const std::vector<Point>& at = source.at;
  std::vector<SourceShape> shapes;
  if (source.type == "point") {
    need_points(source, 1, kAny);
    for (const Point& p : at) shapes.push_back(Simplex{{p, p, p}, 1});
  } else if (source.type == "line" || source.type == "polyline") {
    need_points(source, 2, source.type == "line" ? 2 : kAny);
    for (std::size_t i = 0; i + 1 < at.size(); ++i) shapes.push_back(Simplex{{at[i], at[i + 1], at[i + 1]}, 2});
  } else if (source.type == "triangle") {
    need_points(source, 3, 3);
    shapes.push_back(Simplex{{at[0], at[1], at[2]}, 3});
  } else if (source.type == "surface") {
    for (const std::array<Point, 3>& facet : read_facets(source.file, context)) shapes.push_back(Simplex{facet, 3});
  } else {
    throw UsageError("type is missing: point, line, polyline, triangle or surface");
  }
  return shapes;
}

void add_source(const SourceOptions& source, std::vector<SizeSource>& sources, Context& context) {
  SizeSource made;
  made.law = law_of(source);
  check_law(made.law);
  if (source.stretch)
    made.stretching = {source.stretch->s1, source.stretch->s2, source.stretch->first, source.stretch->second};
  if (made.stretching) stretched_metric(made.law.delta0, *made.stretching);  // refuses what is none
  if (source.motion && source.motion->rate != 0 && source.motion->axis == Point{})
    throw UsageError(fmt::format("motion: rate = {} but no axis; give the axis to turn about, e.g. axis = [0, 0, 1]",
                                 source.motion->rate));
  if (source.motion)
    made.motion = {source.motion->velocity, source.motion->centre, source.motion->axis, source.motion->rate};
  made.group = source.group;
  for (SourceShape& shape : shapes_of(source, context)) {
    check_shape(shape);
    made.shape = std::move(shape);
    sources.push_back(made);
  }
}

template <class T>
const T& need(const std::optional<T>& value, const char* name, const SizeBoxOptions& box) {
  if (!value) throw UsageError(fmt::format("{} is missing, which a {} has", name, box.shape));
  return *value;
}

/// What other shapes have is a slip, most likely a forgotten `shape`.
void refuse_other_keys(const SizeBoxOptions& box) {
  const std::string& shape = box.shape;
  const bool is_round = shape == "cylinder" || shape == "cone";
  const auto refuse = [&](bool is_set, bool is_right, const char* key, const char* of) {
    if (is_set && !is_right) throw UsageError(fmt::format("{} is of {}, and shape is \"{}\"", key, of, shape));
  };
  refuse(box.min.has_value(), shape == "box", "min", "boxes");
  refuse(box.max.has_value(), shape == "box", "max", "boxes");
  refuse(box.centre.has_value(), shape == "sphere", "centre", "spheres");
  refuse(box.radius.has_value(), shape == "sphere" || is_round, "radius", "spheres, cylinders and cones");
  refuse(box.from.has_value(), is_round, "from", "cylinders and cones");
  refuse(box.to.has_value(), is_round, "to", "cylinders and cones");
  refuse(box.radius_to.value > 0, shape == "cone", "radius_to", "cones");
  refuse(!box.file.empty(), shape == "surface", "file", "surfaces");
}

SourceShape shape_of(const SizeBoxOptions& box, Context& context) {
  refuse_other_keys(box);
  if (box.shape == "sphere") return SolidSphere{need(box.centre, "centre", box), need(box.radius, "radius", box).value};
  if (box.shape == "cylinder" || box.shape == "cone") {
    const double radius = need(box.radius, "radius", box).value;
    return Frustum{need(box.from, "from", box), need(box.to, "to", box), radius,
                   box.shape == "cone" ? box.radius_to.value : radius};
  }
  if (box.shape == "surface") return FacetShape{build_facet_surface(read_facets(box.file, context), true)};
  const Point low = need(box.min, "min", box), high = need(box.max, "max", box);
  for (int k = 0; k < 3; ++k)
    if (low[k] > high[k])
      throw UsageError(fmt::format("min is above max along {}: {:g} and {:g}", "xyz"[k], low[k], high[k]));
  return AlignedBox{{low, high}};
}

SizeSource source_of(const SizeBoxOptions& box, Context& context) {
  SizeSource made;
  made.law.kind = SizeLaw::Kind::step;
  made.law.delta0 = need(box.h, "h", box).value;
  made.shape = shape_of(box, context);
  check_shape(made.shape);
  return made;
}

bool is_left_out(const SizeOptions& options, const std::string& group) {
  return std::any_of(options.without.begin(), options.without.end(),
                     [&](const std::string& pattern) { return matches_pattern(group, pattern); });
}

void check_groups(const Options& options) {
  std::vector<std::string> groups;
  for (const SourceOptions& source : options.size.sources)
    if (!source.group.empty()) groups.push_back(source.group);
  for (const std::string& pattern : options.size.without)
    if (std::none_of(groups.begin(), groups.end(), [&](const auto& group) { return matches_pattern(group, pattern); }))
      throw usage_error(
          options, "size.without",
          fmt::format("no group of sources is called '{}'{}; there are: {}", pattern, did_you_mean(pattern, groups),
                      groups.empty() ? "none" : fmt::format("{}", fmt::join(groups, ", "))));
}

}  // namespace

std::vector<SizeSource> job_sources(const Options& options, Context& context) {
  check_groups(options);
  std::vector<SizeSource> sources;
  for (std::size_t i = 0; i < options.size.sources.size(); ++i) {
    const SourceOptions& source = options.size.sources[i];
    if (is_left_out(options.size, source.group)) continue;
    with_place(options, fmt::format("size.source[{}]", i), [&] { add_source(source, sources, context); });
  }
  for (std::size_t i = 0; i < options.size.boxes.size(); ++i)
    with_place(options, fmt::format("size.box[{}]", i),
               [&] { sources.push_back(source_of(options.size.boxes[i], context)); });
  return sources;
}

}  // namespace delfront
