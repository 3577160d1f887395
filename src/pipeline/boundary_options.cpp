// SPDX-License-Identifier: Apache-2.0
// The keys of [boundaries.NAME]; `select` has a small table of its own: which word, what it takes, how it is said
// again.
#include "pipeline/boundary_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>

#include "geometry/boundary_kinds.hpp"
#include "pipeline/option_rows.hpp"

namespace delfront {
namespace {

/// Numbers of faces; one will do without a list.
std::vector<std::uint32_t> as_faces(const JobValue& v) {
  const std::vector<JobValue> numbers = v.is(JobValue::Kind::list) ? v.items : std::vector{v};
  std::vector<std::uint32_t> faces;
  for (const JobValue& number : numbers) {
    const std::uint64_t face = as_count(number);
    if (face == 0 || face > 0xffffffffu) throw BadValue("faces are counted from 1; got " + describe(number));
    faces.push_back(static_cast<std::uint32_t>(face));
  }
  if (faces.empty()) throw BadValue("an empty list selects no face");
  return faces;
}

/// "#ff8000", "FF8000", "colour_FF8000" (as patches are called) as FF8000.
std::string as_colour(const JobValue& v) {
  std::string text = as_text(v);
  for (const char* prefix : {"#", "colour_"})
    if (text.starts_with(prefix)) text.erase(0, std::string(prefix).size());
  bool is_hex = text.size() == 6;
  for (char& c : text) {
    is_hex &= std::isxdigit(static_cast<unsigned char>(c)) != 0;
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  if (!is_hex) throw BadValue("a colour is red, green and blue in six digits such as \"FF8000\"; got " + describe(v));
  return text;
}

std::vector<std::string> as_colours(const JobValue& v) {
  std::vector<std::string> colours;
  for (const JobValue& colour : v.is(JobValue::Kind::list) ? v.items : std::vector{v})
    colours.push_back(as_colour(colour));
  if (colours.empty()) throw BadValue("an empty list selects no face");
  return colours;
}

Point as_normal(const JobValue& v) {
  if (v.is(JobValue::Kind::list) && !v.items.empty() && v.items[0].is(JobValue::Kind::list))
    throw BadValue("a normal is one direction; several are for { expression = \"…\" }, or boundaries of one kind each");
  const Point normal = as_point(v);
  if (!(length(normal) > 0)) throw BadValue("a normal of no length looks nowhere");
  return normal;
}

Box as_box(const JobValue& v) {
  need_members(v, {"min", "max"});
  const JobValue *low = v.find("min"), *high = v.find("max");
  if (low == nullptr || high == nullptr) throw BadValue("a box has two corners, { min = [0, 0, 0], max = [1, 1, 1] }");
  const Box box{as_point(*low), as_point(*high)};
  for (int k = 0; k < 3; ++k)
    if (!(box.low[k] <= box.high[k]))
      throw BadValue(fmt::format("a box from {} to {} along {}", box.low[k], box.high[k], "xyz"[k]));
  return box;
}

std::vector<Point> as_places(const JobValue& v) {
  const bool is_one = !v.is(JobValue::Kind::list) || (!v.items.empty() && v.items[0].is_number());
  std::vector<Point> places;
  for (const JobValue& place : is_one ? std::vector{v} : v.items) places.push_back(as_point(place));
  if (places.empty()) throw BadValue("an empty list selects no face");
  return places;
}

std::string as_expression(const JobValue& v) {
  if (as_text(v).empty()) throw BadValue("an empty text is true nowhere");
  return v.text;
}

std::vector<std::string> as_names(const JobValue& v) {
  if (!v.is(JobValue::Kind::list)) return {as_text(v)};
  std::vector<std::string> names;
  for (const JobValue& name : v.items) names.push_back(as_text(name));
  if (names.empty()) throw BadValue("an empty list selects no patch");
  return names;
}

/// A way to select: its word, and what follows it. `get` gives none where the boundary does not select that way.
struct Selector {
  const char* word;
  void (*set)(BoundaryOptions&, const JobValue&);
  JobValue (*get)(const BoundaryOptions&);
};

template <class Items, class Value>
JobValue list_value(const Items& items, Value value) {
  JobValue list = JobValue::list();
  for (const auto& item : items) list.items.push_back(value(item));
  return items.empty() ? JobValue() : list;
}

JobValue names_value(const std::vector<std::string>& names) {
  return names.size() == 1 ? JobValue::of(names[0]) : list_value(names, [](const auto& n) { return JobValue::of(n); });
}

JobValue box_value(const Box& box) {
  JobValue value = JobValue::table();
  value.add("min", point_value(box.low));
  value.add("max", point_value(box.high));
  return value;
}

const std::vector<Selector>& selectors() {
  using B = BoundaryOptions;
  static const std::vector<Selector> all = {
      {"name", [](B& b, const JobValue& v) { b.select = as_names(v); },
       [](const B& b) { return names_value(b.select); }},
      {"id", [](B& b, const JobValue& v) { b.faces = as_faces(v); },
       [](const B& b) { return list_value(b.faces, [](auto f) { return JobValue::of(std::int64_t(f)); }); }},
      {"normal", [](B& b, const JobValue& v) { b.normal = as_normal(v); },
       [](const B& b) { return b.normal ? point_value(*b.normal) : JobValue(); }},
      {"colour", [](B& b, const JobValue& v) { b.colours = as_colours(v); },
       [](const B& b) { return list_value(b.colours, [](const auto& c) { return JobValue::of(c); }); }},
      {"box", [](B& b, const JobValue& v) { b.box = as_box(v); },
       [](const B& b) { return b.box ? box_value(*b.box) : JobValue(); }},
      {"near", [](B& b, const JobValue& v) { b.near = as_places(v); },
       [](const B& b) { return list_value(b.near, [](Point p) { return point_value(p); }); }},
      {"expression", [](B& b, const JobValue& v) { b.expression = as_expression(v); },
       [](const B& b) { return text_value(b.expression); }},
  };
  return all;
}

void set_selector(BoundaryOptions& boundary, const JobValue& v) {
  BoundaryOptions b{boundary.name, {}, boundary.kind, boundary.set_at};  // forgets what was selected before
  if (!v.is(JobValue::Kind::table)) {
    b.select = as_names(v);
    boundary = std::move(b);
    return;
  }
  if (v.items.size() != 1) throw BadValue("got " + describe(v));
  std::vector<std::string> words;
  for (const Selector& selector : selectors()) {
    words.emplace_back(selector.word);
    if (v.names[0] != selector.word) continue;
    selector.set(b, v.items[0]);
    boundary = std::move(b);
    return;
  }
  const std::string planned = planned_note("boundaries.*.select." + v.names[0]);
  if (!planned.empty()) throw BadValue(fmt::format("selecting by '{}' is{}", v.names[0], planned.substr(1)));
  throw BadValue(fmt::format("nothing is selected by '{}'{}, but by {}", v.names[0], did_you_mean(v.names[0], words),
                             fmt::join(words, ", ")));
}

JobValue get_selector(const BoundaryOptions& b) {
  for (const Selector& selector : selectors()) {
    const JobValue said = selector.get(b);
    if (said.is(JobValue::Kind::none)) continue;
    JobValue value = JobValue::table();
    value.add(selector.word, said);
    return value;
  }
  return {};
}

}  // namespace

EntryTable boundary_table() {
  const auto boundaries = [](auto& o) -> auto& { return o.boundaries; };
  EntryTable table = named_table<BoundaryOptions>("boundaries", boundaries);
  table.note = [](Options& o, std::size_t i, const std::string& name, const std::string& place) {
    BoundaryOptions& boundary = o.boundaries[i];
    if (name == "select" || boundary.set_at.empty()) boundary.set_at = place;
  };
  add_entry<BoundaryOptions>(
      table, boundaries,
      {"select", Takes::select,
       "which patches it is made of, by name with * and ?; by default the one of its own name; of smooth geometry also "
       "faces by number (as info counts them), those that look one way, have a colour, lie in a box, are nearest to a "
       "place, or where a formula is true",
       "a name, { name = \"wing*\" }, a list of names, { id = 3 }, { id = [3, 4] }, { normal = [0, -1, 0] }, { colour "
       "= \"FF0000\" }, "
       "{ box = { min = [0, 0, 0], max = [1, 1, 1] } }, { near = [1, 0, 0] } or { expression = \"z < 0.1\" }"},
      set_selector, get_selector);
  add_entry<BoundaryOptions>(
      table, boundaries,
      {"kind", Takes::text, "what kind of boundary it is", fmt::format("one of {}", fmt::join(boundary_kinds(), ", "))},
      [](BoundaryOptions& b, const JobValue& v) { b.kind = as_choice(v, boundary_kinds()); },
      [](const BoundaryOptions& b) { return text_value(b.kind); });
  return table;
}

}  // namespace delfront
