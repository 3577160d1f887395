// SPDX-License-Identifier: Apache-2.0
// Every way to ask for sizes, as keys of the job file.
#include "pipeline/size_options.hpp"

#include <cmath>

#include "pipeline/option_rows.hpp"

namespace delfront {

namespace {

constexpr double kMany = 1e6;
constexpr double kHuge = 1e300;

/// The option `growth` alone may be absent, so it is a row of its own kind.
OptionRow growth_row() {
  return number_row(
      "size.growth", "--growth", "RATIO",
      "ratio of neighbouring sizes; given: cells grow without other bound than hmax; absent: 1.2, and no "
      "cell larger than the largest boundary edge",
      "a number over 1, at most 10", 1 + 1e-9, 10, [](auto& o) -> auto& { return o.size.growth; });
}

template <class At>
OptionRow directions_row(const char* key, const char* help, At at) {
  OptionRow row{key, Takes::texts, "", "", help, "three formulas, e.g. [\"1\", \"0\", \"0\"]", {}, {}};
  row.set = [at](Options& o, const JobValue& v) {
    const std::vector<std::string> texts = as_texts(v);
    if (texts.size() != 3) throw BadValue(fmt::format("got {}", texts.size()));
    std::copy(texts.begin(), texts.end(), at(o).begin());
  };
  row.get = [at](const Options& o) {
    if (at(o)[0].empty()) return JobValue();
    JobValue list = JobValue::list();
    for (const std::string& text : at(o)) list.items.push_back(JobValue::of(text));
    return list;
  };
  return row;
}

/// A number that is not printed where it is 0: not asked for.
template <class At>
OptionRow wish_row(const char* key, const char* flags, const char* metavar, const char* help, const char* allowed,
                   double low, double high, At at) {
  OptionRow row = number_row(key, flags, metavar, help, allowed, low, high, at);
  row.get = [at](const Options& o) { return at(o) == 0 ? JobValue() : JobValue::of(double(at(o))); };
  return row;
}

void add_geometry_rows(std::vector<OptionRow>& t) {
  t.push_back(wish_row(
      "size.curvature", "--curvature", "N", "cells per full turn of curved surfaces", "a number of cells, 3 or more", 3,
      kMany, [](auto& o) -> auto& { return o.size.curvature; }));
  t.push_back(wish_row(
      "size.angle", "", "", "angle between neighbouring faces of curved surfaces", "degrees over 0, at most 120", 0.01,
      120, [](auto& o) -> auto& { return o.size.angle; }));
  t.push_back(text_row("size.angle_form", "", "", "sine: exact for inscribed faces; tangent: larger for large angles",
                       [](auto& o) -> auto& { return o.size.angle_form; }, {"sine", "tangent"}));
  t.push_back(
      text_row("size.accuracy", "--accuracy", "coarse|medium|fine",
               "numbers for curvature, gaps, lines, growth and bounds, where they are not given; smooth geometry "
               "has medium",
               [](auto& o) -> auto& { return o.size.accuracy; }, {"coarse", "medium", "fine"}));
  OptionRow automatic = boolean_row(
      "size.automatic",
      "curvature, gaps and lines with their defaults, where they are not given; smooth geometry and accuracy have it "
      "on",
      [](auto& o) -> auto& { return o.size.automatic; });
  automatic.get = [](const Options& o) { return o.size.automatic ? JobValue::of(*o.size.automatic) : JobValue(); };
  t.push_back(std::move(automatic));
  t.push_back(length_row(
      "size.deviation", "--hausd", "distance of edges from the curved surface that they stand for",
      [](auto& o) -> auto& { return o.size.deviation; }));
  t.push_back(wish_row(
      "size.gap.cells", "--gap", "N", "cells across gaps between faces", "a number of cells over 0", 1e-3, kMany,
      [](auto& o) -> auto& { return o.size.gap.cells; }));
  t.push_back(length_row(
      "size.gap.hmin", "", "no size in gaps below this", [](auto& o) -> auto& { return o.size.gap.hmin; }));
  t.push_back(wish_row(
      "size.proximity.cells", "", "N", "cells between lines of a patch that come close", "a number of cells over 0",
      1e-3, kMany, [](auto& o) -> auto& { return o.size.proximity.cells; }));
  t.push_back(length_row(
      "size.proximity.hmin", "", "no size between lines below this",
      [](auto& o) -> auto& { return o.size.proximity.hmin; }));
}

void add_expression_rows(std::vector<OptionRow>& t) {
  t.push_back(text_row(
      "size.expression.delta", "--size", "FORMULA",
      "size as a formula in x, y, z, pi, e and distance(\"NAME\"): \"0.01 + 0.1*abs(z)\"",
      [](auto& o) -> auto& { return o.size.expression.delta; }));
  t.push_back(text_row(
      "size.expression.s1", "", "", "stretching along the first direction, a formula",
      [](auto& o) -> auto& { return o.size.expression.s1; }));
  t.push_back(text_row(
      "size.expression.s2", "", "", "stretching along the second direction, a formula",
      [](auto& o) -> auto& { return o.size.expression.s2; }));
  t.push_back(directions_row(
      "size.expression.first", "first direction, three formulas",
      [](auto& o) -> auto& { return o.size.expression.first; }));
  t.push_back(directions_row(
      "size.expression.second", "second direction, three formulas",
      [](auto& o) -> auto& { return o.size.expression.second; }));
}

void add_grid_rows(std::vector<OptionRow>& t) {
  t.push_back(text_row(
      "size.background.file", "--background", "FILE", "grid whose nodes hold sizes: VTU, MSH, POS, medit mesh and sol",
      [](auto& o) -> auto& { return o.size.background.file; }));
  t.push_back(text_row(
      "size.background.size", "", "", "its field of sizes; by default h, or the only field there is",
      [](auto& o) -> auto& { return o.size.background.size; }));
  t.push_back(text_row(
      "size.background.metric", "", "", "its field of metrics, instead",
      [](auto& o) -> auto& { return o.size.background.metric; }));
  t.push_back(text_row("size.background.combine", "", "",
                       "min: with all else that asks for sizes; alone: with the boundary's own sizes only",
                       [](auto& o) -> auto& { return o.size.background.combine; }, {"min", "alone"}));
  t.push_back(number_row(
      "size.background.factor", "", "", "sizes are taken times this", "a number over 0", 1e-300, kHuge,
      [](auto& o) -> auto& { return o.size.background.factor; }));
  t.push_back(text_row(
      "size.solution.file", "", "", "grid with a solution, to adapt to",
      [](auto& o) -> auto& { return o.size.solution.file; }));
  t.push_back(texts_row(
      "size.solution.sensor", "", "", "its fields to resolve",
      [](auto& o) -> auto& { return o.size.solution.sensor; }));
  t.push_back(text_row("size.solution.indicator", "", "",
                       "hessian: metrics of the L^p norm; error: the local indicator",
                       [](auto& o) -> auto& { return o.size.solution.indicator; }, {"hessian", "error"}));
  t.push_back(number_row(
      "size.solution.norm", "", "", "p of the L^p norm of the error", "a number of 1 or more", 1, kHuge,
      [](auto& o) -> auto& { return o.size.solution.norm; }));
  t.push_back(wish_row(
      "size.solution.complexity", "", "N", "wanted complexity: a tenth of the number of tetrahedra, growth adds some",
      "a number of 1 or more", 1, 1e15, [](auto& o) -> auto& { return o.size.solution.complexity; }));
  t.push_back(number_row(
      "size.solution.error", "", "", "indicator = error: its wanted value", "a number over 0, at most 1", 1e-12, 1,
      [](auto& o) -> auto& { return o.size.solution.error; }));
  t.push_back(boolean_row(
      "size.solution.stretched", "metrics; methods without stretched cells take their least size",
      [](auto& o) -> auto& { return o.size.solution.stretched; }));
  t.push_back(number_row(
      "size.solution.hgrad", "", "", "growth of the metric", "a number over 1, at most 10", 1 + 1e-9, 10,
      [](auto& o) -> auto& { return o.size.solution.hgrad; }));
  t.push_back(count_row(
      "size.adaptive.cells", "", "keep sizes on a grid refined to them, at first with this many cells a side; 0: no",
      "a whole number", [](auto& o) -> auto& { return o.size.adaptive.cells; }));
  t.push_back(number_row(
      "size.adaptive.refine_above", "", "", "its cells are refined where sizes differ by this factor",
      "a number over 1, at most 10", 1.05, 10, [](auto& o) -> auto& { return o.size.adaptive.refine_above; }));
  t.push_back(boolean_row(
      "size.adaptive.smooth", "sizes on it are smoothed by diffusion, never above what is asked for",
      [](auto& o) -> auto& { return o.size.adaptive.smooth; }));
}

// --- entries of [[size.source]] ----------------------------------------------------------------------------------

const auto kSources = [](auto& o) -> auto& { return o.size.sources; };
const auto kBoxes = [](auto& o) -> auto& { return o.size.boxes; };
const auto kOn = [](auto& o) -> auto& { return o.size.on; };

template <class T, class All, class At>
void add_length(EntryTable& table, All all, const char* name, const char* help, At at, bool least_is_zero = false) {
  add_entry<T>(
      table, all, {name, Takes::length, help, kLengthAllowed},
      [at, least_is_zero](T& entry, const JobValue& v) { at(entry) = as_length(v, least_is_zero); },
      [at](const T& entry) {
        const std::optional<Length> length = at(entry);
        return length ? length_value(*length) : JobValue();
      });
}

template <class T, class All, class At>
void add_point(EntryTable& table, All all, const char* name, const char* help, At at) {
  add_entry<T>(
      table, all, {name, Takes::numbers, help, "a point [x, y, z]"},
      [at](T& entry, const JobValue& v) { at(entry) = as_point(v, true); },
      [at](const T& entry) { return at(entry) ? point_value(*at(entry)) : JobValue(); });
}

template <class T, class All, class At>
void add_text(EntryTable& table, All all, const char* name, const char* help, At at,
              const std::vector<std::string>& choices = {}) {
  add_entry<T>(
      table, all,
      {name, Takes::text, help, choices.empty() ? "a text" : fmt::format("one of {}", fmt::join(choices, ", "))},
      [at, choices](T& entry, const JobValue& v) { at(entry) = choices.empty() ? as_text(v) : as_choice(v, choices); },
      [at](const T& entry) { return text_value(at(entry)); });
}

double member_or(const JobValue& table, const char* name, double otherwise) {
  const JobValue* value = table.find(name);
  return value ? as_number(*value) : otherwise;
}

Point member_or(const JobValue& table, const char* name, Point otherwise) {
  const JobValue* value = table.find(name);
  return value ? as_point(*value, true) : otherwise;
}

void set_law(SourceOptions& source, const JobValue& value) {
  static const std::vector<std::string> laws = {"power", "exponential", "polynomial"};
  if (value.is(JobValue::Kind::text)) {
    source.law = as_choice(value, laws);
    return;
  }
  need_members(value, {"type", "gamma", "coefficients"});
  source.law = laws[0];
  if (const JobValue* type = value.find("type")) source.law = as_choice(*type, laws);
  source.gamma = member_or(value, "gamma", 1.0);
  if (const JobValue* a = value.find("coefficients")) source.coefficients = as_numbers(*a);
}

JobValue get_law(const SourceOptions& source) {
  if (source.law.empty() && source.gamma == 1) return {};
  JobValue value = JobValue::table();
  value.add("type", JobValue::of(source.law.empty() ? "power" : source.law));
  if (source.law == "polynomial")
    value.add("coefficients", numbers_value(source.coefficients));
  else
    value.add("gamma", JobValue::of(source.gamma));
  return value;
}

void set_stretch(SourceOptions& source, const JobValue& value) {
  need_members(value, {"s1", "s2", "first", "second"});
  const StretchOptions usual;
  source.stretch = {member_or(value, "s1", usual.s1), member_or(value, "s2", usual.s2),
                    member_or(value, "first", usual.first), member_or(value, "second", usual.second)};
}

JobValue get_stretch(const SourceOptions& source) {
  if (!source.stretch) return {};
  JobValue value = JobValue::table();
  value.add("s1", JobValue::of(source.stretch->s1));
  value.add("s2", JobValue::of(source.stretch->s2));
  value.add("first", point_value(source.stretch->first));
  value.add("second", point_value(source.stretch->second));
  return value;
}

void set_motion(SourceOptions& source, const JobValue& value) {
  need_members(value, {"velocity", "centre", "axis", "rate"});
  source.motion = {member_or(value, "velocity", Point()), member_or(value, "centre", Point()),
                   member_or(value, "axis", Point()), member_or(value, "rate", 0.0)};
}

JobValue get_motion(const SourceOptions& source) {
  if (!source.motion) return {};
  JobValue value = JobValue::table();
  value.add("velocity", point_value(source.motion->velocity));
  value.add("centre", point_value(source.motion->centre));
  value.add("axis", point_value(source.motion->axis));
  value.add("rate", JobValue::of(source.motion->rate));
  return value;
}

void add_source_shape(EntryTable& table) {
  using S = SourceOptions;
  add_text<S>(table, kSources, "type", "what it is", [](auto& s) -> auto& { return s.type; },
              {"point", "line", "polyline", "triangle", "surface"});
  add_entry<S>(
      table, kSources, {"at", Takes::numbers, "its points", "points [[x, y, z], ...]"},
      [](S& s, const JobValue& v) { s.at = as_points(v); },
      [](const S& s) {
        JobValue list = JobValue::list();
        for (const Point& p : s.at) list.items.push_back(point_value(p));
        return s.at.empty() ? JobValue() : list;
      });
  add_text<S>(
      table, kSources, "file", "surface: its facets", [](auto& s) -> auto& { return s.file; });
}

EntryTable source_table() {
  using S = SourceOptions;
  EntryTable table = list_table<S>("size.source", kSources);
  add_source_shape(table);
  add_length<S>(
      table, kSources, "delta0", "size on it", [](auto& s) -> auto& { return s.delta0; });
  add_length<S>(
      table, kSources, "r0", "size is delta0 up to this distance", [](auto& s) -> auto& { return s.r0; }, true);
  add_length<S>(
      table, kSources, "r1", "scaling length of the law; absent: as growth lets it",
      [](auto& s) -> auto& { return s.r1; });
  add_entry<S>(table, kSources,
               {"law", Takes::text, "how the size rises with the distance",
                "power, exponential, or { type = \"polynomial\", coefficients = [...] }"},
               set_law, get_law);
  add_entry<S>(table, kSources,
               {"stretch", Takes::text, "stretchings and their directions",
                "a table { s1 = 10, s2 = 1, first = [1, 0, 0], second = [0, 1, 0] }"},
               set_stretch, get_stretch);
  add_entry<S>(table, kSources,
               {"motion", Takes::text, "where it is at size.time",
                "a table { velocity = [x, y, z], centre = [x, y, z], axis = [x, y, z], rate = 90 }"},
               set_motion, get_motion);
  add_text<S>(
      table, kSources, "group", "name of its group", [](auto& s) -> auto& { return s.group; });
  return table;
}

EntryTable box_table() {
  using B = SizeBoxOptions;
  EntryTable table = list_table<B>("size.box", kBoxes);
  add_text<B>(table, kBoxes, "shape", "what it is", [](auto& b) -> auto& { return b.shape; },
              {"box", "sphere", "cylinder", "cone", "surface"});
  add_point<B>(
      table, kBoxes, "min", "box: its corner", [](auto& b) -> auto& { return b.min; });
  add_point<B>(
      table, kBoxes, "max", "box: the corner opposite", [](auto& b) -> auto& { return b.max; });
  add_point<B>(
      table, kBoxes, "centre", "sphere", [](auto& b) -> auto& { return b.centre; });
  add_point<B>(
      table, kBoxes, "from", "cylinder, cone: one end of the axis", [](auto& b) -> auto& { return b.from; });
  add_point<B>(
      table, kBoxes, "to", "cylinder, cone: the other end", [](auto& b) -> auto& { return b.to; });
  add_length<B>(
      table, kBoxes, "radius", "sphere, cylinder; cone: at `from`", [](auto& b) -> auto& { return b.radius; });
  add_length<B>(
      table, kBoxes, "radius_to", "cone: at `to`", [](auto& b) -> auto& { return b.radius_to; }, true);
  add_text<B>(
      table, kBoxes, "file", "surface: a closed one", [](auto& b) -> auto& { return b.file; });
  add_length<B>(
      table, kBoxes, "h", "size in it", [](auto& b) -> auto& { return b.h; });
  return table;
}

EntryTable on_table() {
  EntryTable table = named_table<SizeOnOptions>("size.on", kOn);
  add_length<SizeOnOptions>(
      table, kOn, "h", "size on patches, curves and corners of this name", [](auto& on) -> auto& { return on.h; });
  return table;
}

}  // namespace

void add_size_rows(std::vector<OptionRow>& t) {
  t.push_back(length_row(
      "size.hmin", "--hmin,--clmin", "no cell side asked for below this",
      [](auto& o) -> auto& { return o.size.hmin; }));
  t.push_back(length_row(
      "size.hmax", "--hmax,--clmax", "no cell side asked for above this",
      [](auto& o) -> auto& { return o.size.hmax; }));
  t.push_back(growth_row());
  t.push_back(texts_row(
      "size.without", "", "", "groups of sources that are left out, with * and ?",
      [](auto& o) -> auto& { return o.size.without; }));
  t.push_back(wish_row(
      "size.time", "", "", "time, for sources that move", "a number", -kHuge, kHuge,
      [](auto& o) -> auto& { return o.size.time; }));
  add_geometry_rows(t);
  add_expression_rows(t);
  add_grid_rows(t);
}

std::vector<EntryTable> size_entry_tables() { return {source_table(), box_table(), on_table()}; }

}  // namespace delfront
