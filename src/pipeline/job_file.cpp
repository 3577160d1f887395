// SPDX-License-Identifier: Apache-2.0
#include "pipeline/job_file.hpp"

#define TOML_ENABLE_FORMATTERS 0
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/toml_letters.hpp"
#include "delfront/errors.hpp"
#include "delfront/job.hpp"
#include "pipeline/option_table.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

JobValue from_toml(const toml::node& node) {
  JobValue value;
  if (const auto* table = node.as_table()) {
    // toml++ sorts by name; the order of the file is what a person meant
    std::vector<std::pair<const toml::key*, const toml::node*>> members;
    for (const auto& [key, item] : *table) members.emplace_back(&key, &item);
    std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) {
      const toml::source_position p = a.first->source().begin, q = b.first->source().begin;
      return std::pair(p.line, p.column) < std::pair(q.line, q.column);
    });
    value = JobValue::table();
    for (const auto& [key, item] : members) value.add(std::string(key->str()), from_toml(*item));
  } else if (const auto* array = node.as_array()) {
    value = JobValue::list();
    for (const auto& item : *array) value.items.push_back(from_toml(item));
  } else if (const auto* text = node.as_string()) {
    value = JobValue::of(text->get());
  } else if (const auto* integer = node.as_integer()) {
    value = JobValue::of(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    value = JobValue::of(number->get());
  } else if (const auto* boolean = node.as_boolean()) {
    value = JobValue::of(boolean->get());
  } else {
    std::ostringstream date;
    node.visit([&date](const auto& n) {
      if constexpr (toml::is_date<decltype(n)> || toml::is_time<decltype(n)> || toml::is_date_time<decltype(n)>)
        date << n.get();
    });
    value = JobValue::of(date.str());
  }
  value.line = static_cast<int>(node.source().begin.line);
  return value;
}

/// Reads a text and counts its lines, so that the parser's callbacks can ask where they are.
class LineCounter {
 public:
  using difference_type = std::ptrdiff_t;
  using value_type = char;
  using pointer = const char*;
  using reference = const char&;
  using iterator_category = std::input_iterator_tag;

  LineCounter(const char* at, int* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  LineCounter& operator++() {
    if (*at_++ == '\n') ++*line_;
    return *this;
  }
  LineCounter operator++(int) {
    LineCounter before = *this;
    ++*this;
    return before;
  }
  bool operator==(const LineCounter& other) const { return at_ == other.at_; }
  bool operator!=(const LineCounter& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  int* line_;
};

/// Builds JobValues out of nlohmann's events.
class JsonBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  JsonBuilder(std::string file, const int* line) : file_(std::move(file)), line_(line) {}

  bool null() override { return add({}); }
  bool boolean(bool value) override { return add(JobValue::of(value)); }
  bool number_integer(number_integer_t value) override { return add(JobValue::of(std::int64_t{value})); }
  bool number_unsigned(number_unsigned_t value) override {
    const bool fits = value <= static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max());
    return add(fits ? JobValue::of(static_cast<std::int64_t>(value)) : JobValue::of(static_cast<double>(value)));
  }
  bool number_float(number_float_t value, const string_t&) override { return add(JobValue::of(value)); }
  bool string(string_t& value) override { return add(JobValue::of(value)); }
  bool binary(binary_t&) override { return add({}); }
  bool start_object(std::size_t) override { return open(JobValue::table()); }
  bool start_array(std::size_t) override { return open(JobValue::list()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (open_.back().find(name)) throw UsageError(fmt::format("{}:{}: key '{}' is given twice", file_, *line_, name));
    open_.back().names.push_back(name);
    key_lines_.push_back(*line_);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
    throw UsageError(fmt::format("{}:{}: not valid JSON: {}", file_, *line_, e.what()));
  }

  JobValue result;

 private:
  bool add(JobValue value) {
    if (!open_.empty() && open_.back().is(JobValue::Kind::table)) {
      value.line = key_lines_.back();
      key_lines_.pop_back();
    } else if (value.line == 0) {
      value.line = *line_;
    }
    if (open_.empty())
      result = std::move(value);
    else
      open_.back().items.push_back(std::move(value));
    return true;
  }
  bool open(JobValue value) {
    if (open_.size() > 100) throw UsageError(fmt::format("{}:{}: nested too deeply", file_, *line_));
    value.line = *line_;
    open_.push_back(std::move(value));
    return true;
  }
  bool close() {
    JobValue value = std::move(open_.back());
    open_.pop_back();
    return add(std::move(value));
  }

  std::string file_;
  const int* line_;
  std::vector<JobValue> open_;  ///< tables and lists that are not closed yet
  std::vector<int> key_lines_;  ///< of the keys whose values are not complete yet
};

/// Keys whose texts are paths; entries of a list of tables are taken by the names of the tables.
bool is_path(const std::string& key) {
  static const std::set<std::string> paths = {
      "input.files",          "output.files",       "output.report",    "output.defects", "size.background",
      "size.background.file", "size.solution.file", "size.source.file", "size.box.file",  "refine.geometry"};
  return paths.count(key) > 0;
}

/// Paths in a job file are relative to its folder; make them relative to where we are.
void resolve_paths(JobValue& value, const std::string& key, const fs::path& folder) {
  if (value.is(JobValue::Kind::text) && is_path(key) && !value.text.empty() && fs::path(value.text).is_relative())
    value.text = (folder / value.text).lexically_normal().string();
  for (std::size_t i = 0; i < value.items.size(); ++i)
    resolve_paths(value.items[i],
                  !value.is(JobValue::Kind::table) ? key
                  : key.empty()                    ? value.names[i]
                                                   : key + "." + value.names[i],
                  folder);
}

}  // namespace

JobValue parse_toml(const std::string& text, const std::string& name) {
  if (const int line = find_stray_letter(text); line > 0)
    throw UsageError(fmt::format("{}:{}: not valid TOML: a letter outside of ASCII; put quotes round it", name, line));
  try {
    const toml::table table = toml::parse(text);
    return from_toml(table);
  } catch (const toml::parse_error& e) {
    throw UsageError(
        fmt::format("{}:{}: not valid TOML: {}", name, e.source().begin.line, std::string(e.description())));
  }
}

JobValue parse_json(const std::string& text, const std::string& name) {
  int line = 1;
  JsonBuilder builder(name, &line);
  nlohmann::json::sax_parse(LineCounter(text.data(), &line), LineCounter(text.data() + text.size(), &line), &builder);
  return builder.result;
}

std::string read_text_file(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw InputError(fmt::format("{} is a folder, not a file", path));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
  std::ostringstream text;
  text << file.rdbuf();
  if (file.bad()) throw InputError(fmt::format("cannot read {}", path));
  return text.str();
}

void read_job_file(const std::string& path, Options& options) {
  std::string text;
  try {
    text = read_text_file(path);
  } catch (const InputError& e) {  // the job file is part of the command, not the surface to grid
    throw UsageError(e.what());
  }
  const bool is_json = fs::path(path).extension() == ".json";
  JobValue tree = is_json ? parse_json(text, path) : parse_toml(text, path);
  if (!tree.is(JobValue::Kind::table)) throw UsageError(fmt::format("{}: expected a table of options", path));
  resolve_paths(tree, "", fs::path(path).parent_path());
  apply_value(options, "", tree,
              [&path](int line) { return line > 0 ? fmt::format("{}:{}: ", path, line) : fmt::format("{}: ", path); });
}

JobValue value_from_text(Takes takes, const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  const char begin = first == std::string::npos ? ' ' : text[first];
  const bool is_structured = begin == '[' || begin == '{' || begin == '"' || begin == '\'';
  const bool is_word = takes != Takes::number && takes != Takes::count && takes != Takes::boolean;
  if (is_word && !is_structured) return JobValue::of(text);
  try {
    JobValue value = parse_toml("v = " + text, "");
    if (value.items.size() != 1) return JobValue::of(text);
    value.items[0].line = 0;
    return value.items[0];
  } catch (const UsageError&) {
    if (is_structured && !is_word) throw UsageError(fmt::format("'{}' is not a TOML value", text));
    return JobValue::of(text);  // the row says what it wants instead
  }
}

}  // namespace delfront
