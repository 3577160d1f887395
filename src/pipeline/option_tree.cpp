// SPDX-License-Identifier: Apache-2.0
// What is done with the option table: a tree of values is checked against it and put into Options, and back.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "base/nearest_name.hpp"
#include "delfront/errors.hpp"
#include "delfront/job.hpp"
#include "pipeline/option_table.hpp"

namespace delfront {

namespace {

using Where = std::function<std::string(int line)>;

const OptionRow* find_row(const std::string& key) {
  for (const OptionRow& row : option_table())
    if (row.key == key) return &row;
  return nullptr;
}

/// Names that may stand in the table `path`, in order, without repetition.
std::vector<std::string> names_in(const std::string& path) {
  std::vector<std::string> names;
  const std::string prefix = path.empty() ? "" : path + ".";
  const auto add = [&names](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const OptionRow& row : option_table())
    if (row.key.starts_with(prefix)) {
      const std::string rest = row.key.substr(prefix.size());
      add(rest.substr(0, rest.find('.')));
    }
  if (path.empty()) add("boundaries");
  return names;
}

std::string full_key(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

[[noreturn]] void fail_unknown(const std::string& path, const std::string& prefix) {
  const std::string planned = planned_note(path);
  if (!planned.empty())
    throw UsageError(fmt::format("{}key '{}'{}; --print-config lists what is", prefix, path, planned));
  const std::size_t dot = path.find_last_of('.');
  const std::string table = dot == std::string::npos ? "" : path.substr(0, dot);
  const std::string name = dot == std::string::npos ? path : path.substr(dot + 1);
  std::vector<std::string> siblings = names_in(table);
  std::string guess = nearest_name(name, siblings);
  if (!guess.empty()) guess = full_key(table, guess);
  if (guess.empty()) {  // right name, wrong table: hmax instead of size.hmax
    for (const OptionRow& row : option_table())
      if (row.key.ends_with("." + name)) guess = row.key;
  }
  if (siblings.empty()) siblings = names_in("");
  throw UsageError(fmt::format("{}unknown key '{}'{}; allowed in {}: {}", prefix, path,
                               guess.empty() ? "" : fmt::format(" (did you mean '{}'?)", guess),
                               table.empty() || names_in(table).empty() ? "the job file" : "[" + table + "]",
                               fmt::join(siblings, ", ")));
}

/// Run a setter; its reason becomes a message with place, key and what is allowed.
template <class Set>
void set_checked(const std::string& key, const std::string& allowed, const std::string& prefix, const Set& set) {
  try {
    set();
  } catch (const BadValue& e) {
    throw UsageError(fmt::format("{}{}: expected {}; {}", prefix, key, allowed, e.what()));
  } catch (const UsageError& e) {
    throw UsageError(fmt::format("{}{}: expected {}; {}", prefix, key, allowed, e.what()));
  }
}

/// What `where` says, without the colon and blank that part it from a message.
std::string place_of(const std::string& prefix) { return prefix.substr(0, prefix.find_last_not_of(": ") + 1); }

/// Remember where a key was set, and each entry of a list.
void note_place(Options& options, const std::string& key, const JobValue& value, const Where& where) {
  options.set_at[key] = place_of(where(value.line));
  for (std::size_t i = 0; value.is(JobValue::Kind::list) && i < value.items.size(); ++i)
    options.set_at[fmt::format("{}[{}]", key, i)] = place_of(where(value.items[i].line));
}

BoundaryOptions& boundary_of(Options& options, const std::string& name) {
  for (BoundaryOptions& boundary : options.boundaries)
    if (boundary.name == name) return boundary;
  options.boundaries.push_back({.name = name, .select = "", .kind = ""});
  return options.boundaries.back();
}

void apply_boundary_entry(Options& options, const std::string& name, const std::string& entry, const JobValue& value,
                          const Where& where) {
  const std::string key = fmt::format("boundaries.{}.{}", toml_key(name), entry);
  std::vector<std::string> names;
  for (const BoundaryRow& row : boundary_table()) {
    names.push_back(row.name);
    if (row.name != entry) continue;
    set_checked(key, row.allowed, where(value.line), [&] { row.set(boundary_of(options, name), value); });
    BoundaryOptions& boundary = boundary_of(options, name);
    if (entry == "select" || boundary.set_at.empty()) boundary.set_at = place_of(where(value.line));
    return;
  }
  throw UsageError(fmt::format("{}unknown key '{}'{}; allowed in [boundaries.{}]: {}", where(value.line), key,
                               did_you_mean(entry, names), toml_key(name), fmt::join(names, ", ")));
}

void need_table(const std::string& path, const JobValue& value, const Where& where) {
  if (value.is(JobValue::Kind::table)) return;
  const std::vector<std::string> names =
      path.starts_with("boundaries") ? std::vector<std::string>{"select", "kind"} : names_in(path);
  throw UsageError(fmt::format("{}{}: expected a table with {}; got {}", where(value.line), path,
                               fmt::join(names, ", "), describe(value)));
}

/// path: "boundaries", "boundaries.NAME" or "boundaries.NAME.entry"; a name may hold dots where the tree is a table.
void apply_boundaries_value(Options& options, const std::string& path, const JobValue& value, const Where& where) {
  const std::string rest = path.size() > 11 ? path.substr(11) : "";
  const std::size_t dot = rest.find_last_of('.');
  if (dot != std::string::npos && !value.is(JobValue::Kind::table))
    return apply_boundary_entry(options, rest.substr(0, dot), rest.substr(dot + 1), value, where);
  if (dot != std::string::npos && rest.substr(dot + 1) == "select")
    return apply_boundary_entry(options, rest.substr(0, dot), "select", value, where);
  need_table(path, value, where);
  if (!rest.empty()) {
    boundary_of(options, rest);
    for (std::size_t i = 0; i < value.items.size(); ++i)
      apply_boundary_entry(options, rest, value.names[i], value.items[i], where);
    return;
  }
  for (std::size_t i = 0; i < value.items.size(); ++i) {
    need_table("boundaries." + value.names[i], value.items[i], where);
    boundary_of(options, value.names[i]);
    for (std::size_t k = 0; k < value.items[i].items.size(); ++k)
      apply_boundary_entry(options, value.names[i], value.items[i].names[k], value.items[i].items[k], where);
  }
}

/// Put a value into a tree at "a.b.c", making the tables on the way.
void insert(JobValue& tree, const std::string& path, JobValue value) {
  const std::size_t dot = path.find('.');
  if (dot == std::string::npos) return tree.add(path, std::move(value));
  const std::string head = path.substr(0, dot);
  const auto it = std::find(tree.names.begin(), tree.names.end(), head);
  const auto index = static_cast<std::size_t>(it - tree.names.begin());
  if (it == tree.names.end()) tree.add(head, JobValue::table());
  insert(tree.items[index], path.substr(dot + 1), std::move(value));
}

}  // namespace

void apply_value(Options& options, const std::string& path, const JobValue& value, const Where& where) {
  if (path == "boundaries" || path.starts_with("boundaries."))
    return apply_boundaries_value(options, path, value, where);
  if (const OptionRow* row = find_row(path)) {
    set_checked(path, row->allowed, where(value.line), [&] { row->set(options, value); });
    return note_place(options, path, value, where);
  }
  if (!path.empty() && names_in(path).empty()) fail_unknown(path, where(value.line));
  need_table(path, value, where);
  for (std::size_t i = 0; i < value.items.size(); ++i)
    apply_value(options, full_key(path, value.names[i]), value.items[i], where);
}

std::string place_of_key(const Options& options, const std::string& key) {
  const auto it = options.set_at.find(key);
  return it == options.set_at.end() || it->second.empty() ? "" : it->second + ": ";
}

UsageError usage_error(const Options& options, const std::string& key, const std::string& message) {
  const std::string place = place_of_key(options, key);
  if (place.starts_with('-')) return UsageError(place + message);  // a flag says more than its key to who typed it
  return UsageError(fmt::format("{}{}: {}", place, key, message));
}

void set_option(Options& options, const std::string& key, const std::string& value) {
  Takes takes = Takes::number;  // of what is no single option: tables, lists
  if (const OptionRow* row = find_row(key)) takes = row->takes;
  if (key.starts_with("boundaries.")) takes = Takes::text;
  apply_value(options, key, value_from_text(takes, value), [](int) { return std::string(); });
}

JobValue option_tree(const Options& options) {
  JobValue tree = JobValue::table();
  for (const OptionRow& row : option_table()) {
    JobValue value = row.get(options);
    if (!value.is(JobValue::Kind::none)) insert(tree, row.key, std::move(value));
  }
  if (options.boundaries.empty()) return tree;
  JobValue boundaries = JobValue::table();
  for (const BoundaryOptions& boundary : options.boundaries) {
    JobValue entry = JobValue::table();
    for (const BoundaryRow& row : boundary_table()) {
      JobValue value = row.get(boundary);
      if (!value.is(JobValue::Kind::none)) entry.add(row.name, std::move(value));
    }
    boundaries.add(boundary.name, std::move(entry));
  }
  tree.add("boundaries", std::move(boundaries));
  return tree;
}

std::string print_config(const Options& options) {
  std::string result = "# Effective configuration; a line without '#' in front is set, the others show what may be.\n";
  std::string table;
  for (const OptionRow& row : option_table()) {
    const std::size_t dot = row.key.find_last_of('.');
    const std::string row_table = dot == std::string::npos ? "" : row.key.substr(0, dot);
    if (row_table != table) {
      table = row_table;
      result += fmt::format("\n[{}]\n", table);
    }
    const std::string name = dot == std::string::npos ? row.key : row.key.substr(dot + 1);
    const JobValue value = row.get(options);
    result += value.is(JobValue::Kind::none) ? fmt::format("# {} =  # {}\n", name, row.help)
                                             : fmt::format("{} = {}  # {}\n", name, to_toml(value), row.help);
  }
  for (const BoundaryOptions& boundary : options.boundaries) {
    result += fmt::format("\n[boundaries.{}]\n", toml_key(boundary.name));
    for (const BoundaryRow& row : boundary_table()) {
      const JobValue value = row.get(boundary);
      if (!value.is(JobValue::Kind::none)) result += fmt::format("{} = {}\n", row.name, to_toml(value));
    }
  }
  return result;
}

std::string did_you_mean(const std::string& typed, const std::vector<std::string>& names) {
  const std::string name = nearest_name(typed, names);
  return name.empty() ? "" : fmt::format(" (did you mean '{}'?)", name);
}

std::string planned_note(const std::string& key_or_flag) {
  // Words of the documented interface whose parts are not built yet: said plainly instead of "unknown".
  static const std::set<std::string> planned = {
      "input.heal",
      "domain.keep.seeds",
      "boundaries.*.select.id",
      "size.curvature",
      "size.angle",
      "size.deviation",
      "size.gap",
      "size.expression",
      "size.background",
      "size.source",
      "size.box",
      "size.on",
      "layers",
      "surface",
      "volume.elements",
      "--heal",
      "--curvature",
      "--gap",
      "--hausd",
      "--layers",
      "estimate",
      "refine",
      "adapt",
      "partition",
      "view",
  };
  for (const std::string& known : planned)
    if (key_or_flag == known || key_or_flag.starts_with(known + ".")) return ": not in this version of delfront";
  return "";
}

}  // namespace delfront
