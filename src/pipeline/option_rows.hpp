// SPDX-License-Identifier: Apache-2.0
// Rows of the common types, and what turns values of a job file into ours. Conversions throw BadValue with the reason.
#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pipeline/option_table.hpp"

namespace delfront {

extern const char* const kLengthAllowed;

std::string as_text(const JobValue& value);
/// @return the text, one of `choices`
std::string as_choice(const JobValue& value, const std::vector<std::string>& choices);
std::vector<std::string> as_texts(const JobValue& value);
double as_number(const JobValue& value);
double as_number_between(const JobValue& value, double low, double high);
std::uint64_t as_count(const JobValue& value);
/// @param least_is_zero  whether 0 is a length; else lengths are positive
Length as_length(const JobValue& value, bool least_is_zero = false);
/// @return numbers of a list, or of "1,2,3"
std::vector<double> as_numbers(const JobValue& value);
/// @param may_be_planar  whether two coordinates will do, z = 0
Point as_point(const JobValue& value, bool may_be_planar = false);
/// @return a list of points, or the one; of two coordinates or three
std::vector<Point> as_points(const JobValue& value);
/// @throws BadValue  no table, or a member that is not one of `names`
void need_members(const JobValue& value, const std::vector<std::string>& names);

JobValue length_value(const Length& length);
JobValue text_value(const std::string& text);  ///< none where it is empty
JobValue point_value(Point p);
JobValue numbers_value(const std::vector<double>& numbers);

// `at` gives the field of (const or not) Options.

template <class At>
OptionRow text_row(const char* key, const char* flags, const char* metavar, const char* help, At at,
                   std::vector<std::string> choices = {}) {
  OptionRow row{key, Takes::text, flags, metavar, help, "a text", {}, {}};
  if (!choices.empty()) row.allowed = fmt::format("one of {}", fmt::join(choices, ", "));
  row.set = [at, choices](Options& o, const JobValue& v) {
    at(o) = choices.empty() ? as_text(v) : as_choice(v, choices);
  };
  row.get = [at](const Options& o) { return at(o).empty() ? JobValue() : JobValue::of(at(o)); };
  return row;
}

template <class At>
OptionRow texts_row(const char* key, const char* flags, const char* metavar, const char* help, At at) {
  OptionRow row{key, Takes::texts, flags, metavar, help, "a list of texts", {}, {}};
  row.set = [at](Options& o, const JobValue& v) { at(o) = as_texts(v); };
  row.get = [at](const Options& o) {
    JobValue list = JobValue::list();
    for (const std::string& text : at(o)) list.items.push_back(JobValue::of(text));
    return list;
  };
  return row;
}

template <class At>
OptionRow length_row(const char* key, const char* flags, const char* help, At at) {
  OptionRow row{key, Takes::length, flags, "LENGTH", help, kLengthAllowed, {}, {}};
  row.set = [at](Options& o, const JobValue& v) { at(o) = as_length(v); };
  row.get = [at](const Options& o) {
    const std::optional<Length> length = at(o);
    return length ? length_value(*length) : JobValue();
  };
  return row;
}

template <class At>
OptionRow number_row(const char* key, const char* flags, const char* metavar, const char* help, const char* allowed,
                     double low, double high, At at) {
  OptionRow row{key, Takes::number, flags, metavar, help, allowed, {}, {}};
  row.set = [=](Options& o, const JobValue& v) { at(o) = as_number_between(v, low, high); };
  row.get = [at](const Options& o) {
    const std::optional<double> number = at(o);
    return number ? JobValue::of(*number) : JobValue();
  };
  return row;
}

template <class At>
OptionRow boolean_row(const char* key, const char* help, At at) {
  OptionRow row{key, Takes::boolean, "", "", help, "true or false", {}, {}};
  row.set = [at](Options& o, const JobValue& v) {
    if (!v.is(JobValue::Kind::boolean)) throw BadValue("got " + describe(v));
    at(o) = v.boolean;
  };
  row.get = [at](const Options& o) { return JobValue::of(bool(at(o))); };
  return row;
}

template <class At>
OptionRow count_row(const char* key, const char* flags, const char* help, const char* allowed, At at) {
  OptionRow row{key, Takes::count, flags, "N", help, allowed, {}, {}};
  row.set = [at](Options& o, const JobValue& v) {
    using Value = std::remove_reference_t<decltype(at(o))>;
    const std::uint64_t count = as_count(v);
    if (count > static_cast<std::uint64_t>(std::numeric_limits<Value>::max())) throw BadValue("got " + describe(v));
    at(o) = static_cast<Value>(count);
  };
  row.get = [at](const Options& o) { return JobValue::of(static_cast<std::int64_t>(at(o))); };
  return row;
}

// --- tables that repeat, or that the user names: `all` gives their vector in (const or not) Options -----------------

template <class T, class All>
EntryTable list_table(const char* key, All all) {
  EntryTable table;
  table.key = key;
  table.is_list = true;
  table.count = [all](const Options& o) { return all(o).size(); };
  table.clear = [all](Options& o) { all(o).clear(); };
  table.entry_of = [all](Options& o, const std::string&) {
    all(o).emplace_back();
    return all(o).size() - 1;
  };
  table.name_of = [](const Options&, std::size_t) { return std::string(); };
  return table;
}

template <class T, class All>
EntryTable named_table(const char* key, All all) {
  EntryTable table = list_table<T>(key, all);
  table.is_list = false;
  table.entry_of = [all](Options& o, const std::string& name) {
    std::vector<T>& entries = all(o);
    const auto it = std::find_if(entries.begin(), entries.end(), [&](const T& entry) { return entry.name == name; });
    if (it != entries.end()) return static_cast<std::size_t>(it - entries.begin());
    entries.emplace_back();
    entries.back().name = name;
    return entries.size() - 1;
  };
  table.name_of = [all](const Options& o, std::size_t i) { return all(o)[i].name; };
  return table;
}

struct EntryWords {
  std::string name;
  Takes takes = Takes::text;
  std::string help, allowed;
};

/// Add a key; `set(T&, value)` and `get(const T&)` act on one entry.
template <class T, class All, class Set, class Get>
void add_entry(EntryTable& table, All all, EntryWords words, Set set, Get get) {
  EntryRow row;
  row.name = std::move(words.name);
  row.takes = words.takes;
  row.help = std::move(words.help);
  row.allowed = std::move(words.allowed);
  row.set = [all, set](Options& o, std::size_t i, const JobValue& v) { set(all(o)[i], v); };
  row.get = [all, get](const Options& o, std::size_t i) { return get(all(o)[i]); };
  table.rows.push_back(std::move(row));
}

}  // namespace delfront
