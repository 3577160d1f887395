// SPDX-License-Identifier: Apache-2.0
// What is done with the option table: a tree of values is checked against it and put into Options, and back.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <string_view>

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
  for (const EntryTable& table : entry_tables())
    if (table.key.starts_with(prefix)) {
      const std::string rest = table.key.substr(prefix.size());
      add(rest.substr(0, rest.find('.')));
    }
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

/// Whether a path goes into a list: "size.source[2]", "size.source[2].h".
bool is_listed(const EntryTable& table, const std::string& path) {
  return table.is_list && path.starts_with(table.key + "[");
}

const EntryTable* find_entry_table(const std::string& path) {
  for (const EntryTable& table : entry_tables())
    if (path == table.key || path.starts_with(table.key + ".") || is_listed(table, path)) return &table;
  return nullptr;
}

std::vector<std::string> names_in(const EntryTable& table) {
  std::vector<std::string> names;
  for (const EntryRow& row : table.rows) names.push_back(row.name);
  return names;
}

/// "size.source[2]", "boundaries.wing"
std::string key_of_entry(const EntryTable& table, const Options& options, std::size_t entry) {
  return table.is_list ? fmt::format("{}[{}]", table.key, entry)
                       : fmt::format("{}.{}", table.key, toml_key(table.name_of(options, entry)));
}

void apply_to_entry(const EntryTable& table, Options& options, std::size_t entry, const std::string& name,
                    const JobValue& value, const Where& where) {
  const std::string of_entry = key_of_entry(table, options, entry), key = of_entry + "." + name;
  for (const EntryRow& row : table.rows) {
    if (row.name != name) continue;
    set_checked(key, row.allowed, where(value.line), [&] { row.set(options, entry, value); });
    note_place(options, key, value, where);
    if (table.note) table.note(options, entry, name, place_of(where(value.line)));
    options.set_at.try_emplace(of_entry, place_of(where(value.line)));
    return;
  }
  throw UsageError(fmt::format("{}unknown key '{}'{}; allowed in [{}]: {}", where(value.line), key,
                               did_you_mean(name, names_in(table)), of_entry, fmt::join(names_in(table), ", ")));
}

void need_table(const std::string& path, const JobValue& value, const std::vector<std::string>& names,
                const Where& where) {
  if (value.is(JobValue::Kind::table)) return;
  throw UsageError(fmt::format("{}{}: expected a table with {}; got {}", where(value.line), path,
                               fmt::join(names, ", "), describe(value)));
}

void apply_entry(const EntryTable& table, Options& options, const std::string& name, const JobValue& value,
                 const Where& where) {
  need_table(table.is_list ? table.key : table.key + "." + name, value, names_in(table), where);
  const std::size_t entry = table.entry_of(options, name);
  options.set_at.try_emplace(key_of_entry(table, options, entry), place_of(where(value.line)));
  for (std::size_t i = 0; i < value.items.size(); ++i)
    apply_to_entry(table, options, entry, value.names[i], value.items[i], where);
}

struct ListedKey {
  std::size_t entry;
  std::string name;  ///< empty: the entry itself
};

/// "size.source[2].h" taken apart; entries are those that there are.
ListedKey listed_key(const EntryTable& table, const Options& options, const std::string& path,
                     const std::string& prefix) {
  const std::string_view rest = std::string_view(path).substr(table.key.size() + 1);
  std::size_t entry = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), entry);
  const std::string_view after = rest.substr(static_cast<std::size_t>(end - rest.data()));
  if (error != std::errc() || !(after == "]" || (after.starts_with("].") && after.size() > 2)))
    throw UsageError(
        fmt::format("{}{}: expected {}[0].KEY, a key of an entry, the first of which is 0", prefix, path, table.key));
  const std::size_t count = table.count(options);
  if (entry >= count)
    throw UsageError(fmt::format("{}{}: {}", prefix, path,
                                 count == 0 ? fmt::format("there are no entries of {} yet", table.key)
                                            : fmt::format("the last entry is {}[{}]", table.key, count - 1)));
  return {entry, std::string(after.substr(std::min<std::size_t>(2, after.size())))};
}

/// Keys of one entry of a list, the others stay.
void apply_listed(const EntryTable& table, Options& options, const std::string& path, const JobValue& value,
                  const Where& where) {
  const ListedKey key = listed_key(table, options, path, where(value.line));
  if (!key.name.empty()) return apply_to_entry(table, options, key.entry, key.name, value, where);
  need_table(path, value, names_in(table), where);
  for (std::size_t i = 0; i < value.items.size(); ++i)
    apply_to_entry(table, options, key.entry, value.names[i], value.items[i], where);
}

/// A list of tables, which replaces what was there; one table is a list of one.
void apply_list(const EntryTable& table, Options& options, const std::string& path, const JobValue& value,
                const Where& where) {
  if (is_listed(table, path)) return apply_listed(table, options, path, value, where);
  const bool is_list = value.is(JobValue::Kind::list);
  if (path != table.key || (!is_list && !value.is(JobValue::Kind::table)))
    throw UsageError(fmt::format("{}{}: expected a list of tables with {}, [[{}]] in a job file; got {}",
                                 where(value.line), path, fmt::join(names_in(table), ", "), table.key,
                                 describe(value)));
  table.clear(options);
  std::erase_if(options.set_at, [&](const auto& set) { return is_listed(table, set.first); });
  if (!is_list) return apply_entry(table, options, "", value, where);
  for (const JobValue& item : value.items) apply_entry(table, options, "", item, where);
}

/// path: "boundaries", "boundaries.NAME" or "boundaries.NAME.entry"; a name may hold dots where the tree is a table.
void apply_named(const EntryTable& table, Options& options, const std::string& path, const JobValue& value,
                 const Where& where) {
  const std::string rest = path == table.key ? "" : path.substr(table.key.size() + 1);
  const std::size_t dot = rest.find_last_of('.');
  const std::vector<std::string> names = names_in(table);
  const bool is_entry =
      dot != std::string::npos &&
      (!value.is(JobValue::Kind::table) || std::find(names.begin(), names.end(), rest.substr(dot + 1)) != names.end());
  if (is_entry)
    return apply_to_entry(table, options, table.entry_of(options, rest.substr(0, dot)), rest.substr(dot + 1), value,
                          where);
  if (!rest.empty()) return apply_entry(table, options, rest, value, where);
  need_table(path, value, names, where);
  for (std::size_t i = 0; i < value.items.size(); ++i)
    apply_entry(table, options, value.names[i], value.items[i], where);
}

/// A table that may be given by its main entry alone: gap = 3 for gap = { cells = 3 }.
std::string main_entry(const std::string& path) {
  static const std::map<std::string, std::string> entries = {
      {"size.expression", "delta"}, {"size.gap", "cells"},  {"size.proximity", "cells"},
      {"size.background", "file"},  {"surface", "method"},  {"volume", "method"},
      {"planar", "method"},         {"improve", "enabled"}, {"refine", "levels"}};
  const auto it = entries.find(path);
  return it == entries.end() ? "" : it->second;
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
  if (const EntryTable* table = find_entry_table(path))
    return (table->is_list ? apply_list : apply_named)(*table, options, path, value, where);
  if (const OptionRow* row = find_row(path)) {
    set_checked(path, row->allowed, where(value.line), [&] { row->set(options, value); });
    return note_place(options, path, value, where);
  }
  if (!path.empty() && names_in(path).empty()) fail_unknown(path, where(value.line));
  if (const std::string entry = main_entry(path); !entry.empty() && !value.is(JobValue::Kind::table))
    return apply_value(options, full_key(path, entry), value, where);
  need_table(path, value, names_in(path), where);
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

/// What the last word of a path takes, as a key of an entry.
static Takes takes_in(const EntryTable& table, const std::string& path) {
  for (const EntryRow& row : table.rows)
    if (path.ends_with("." + row.name)) return row.takes;
  return Takes::text;
}

void set_option(Options& options, const std::string& key, const std::string& value) {
  Takes takes = Takes::number;  // of what is no single option: tables, lists
  const std::string entry = main_entry(key);
  if (const OptionRow* row = find_row(entry.empty() ? key : full_key(key, entry))) takes = row->takes;
  if (const EntryTable* table = find_entry_table(key)) takes = takes_in(*table, key);
  apply_value(options, key, value_from_text(takes, value), [](int) { return std::string(); });
}

/// What is set of one entry.
static JobValue entry_tree(const EntryTable& table, const Options& options, std::size_t entry) {
  JobValue tree = JobValue::table();
  for (const EntryRow& row : table.rows) {
    JobValue value = row.get(options, entry);
    if (!value.is(JobValue::Kind::none)) tree.add(row.name, std::move(value));
  }
  return tree;
}

JobValue option_tree(const Options& options) {
  JobValue tree = JobValue::table();
  for (const OptionRow& row : option_table()) {
    JobValue value = row.get(options);
    if (!value.is(JobValue::Kind::none)) insert(tree, row.key, std::move(value));
  }
  for (const EntryTable& table : entry_tables()) {
    const std::size_t count = table.count(options);
    if (count == 0) continue;
    JobValue all = table.is_list ? JobValue::list() : JobValue::table();
    for (std::size_t i = 0; i < count; ++i) {
      JobValue entry = entry_tree(table, options, i);
      table.is_list ? all.items.push_back(std::move(entry)) : all.add(table.name_of(options, i), std::move(entry));
    }
    insert(tree, table.key, std::move(all));
  }
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
    const std::string choices = row.allowed.starts_with("one of ") ? fmt::format(" ({})", row.allowed) : "";
    result += value.is(JobValue::Kind::none)
                  ? fmt::format("# {} =  # {}{}\n", name, row.help, choices)
                  : fmt::format("{} = {}  # {}{}\n", name, to_toml(value), row.help, choices);
  }
  for (const EntryTable& of_entries : entry_tables()) {
    if (of_entries.count(options) == 0) {  // what may be
      result += of_entries.is_list ? fmt::format("\n# [[{}]]\n", of_entries.key)
                                   : fmt::format("\n# [{}.NAME]\n", of_entries.key);
      for (const EntryRow& row : of_entries.rows) result += fmt::format("# {} =  # {}\n", row.name, row.help);
    }
    for (std::size_t i = 0; i < of_entries.count(options); ++i) {
      result += of_entries.is_list ? fmt::format("\n[[{}]]\n", of_entries.key)
                                   : fmt::format("\n[{}]\n", key_of_entry(of_entries, options, i));
      const JobValue entry = entry_tree(of_entries, options, i);
      for (std::size_t k = 0; k < entry.items.size(); ++k)
        result += fmt::format("{} = {}\n", entry.names[k], to_toml(entry.items[k]));
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
      "boundaries.*.select.stl_solid",
      "layers",
      "surface.elements",
      "volume.elements",
      "--heal",
      "--layers",
      "adapt",
      "partition",
      "view",
  };
  for (const std::string& known : planned)
    if (key_or_flag == known || key_or_flag.starts_with(known + ".")) return ": not in this version of delfront";
  return "";
}

}  // namespace delfront
