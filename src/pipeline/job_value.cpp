// SPDX-License-Identifier: Apache-2.0
#include "pipeline/job_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace delfront {

JobValue JobValue::of(bool value) {
  JobValue result;
  result.kind = Kind::boolean;
  result.boolean = value;
  return result;
}

JobValue JobValue::of(std::int64_t value) {
  JobValue result;
  result.kind = Kind::integer;
  result.integer = value;
  result.number = static_cast<double>(value);
  return result;
}

JobValue JobValue::of(double value) {
  JobValue result;
  result.kind = Kind::number;
  result.number = value;
  return result;
}

JobValue JobValue::of(const std::string& value) {
  JobValue result;
  result.kind = Kind::text;
  result.text = value;
  return result;
}

JobValue JobValue::list(std::vector<JobValue> items) {
  JobValue result;
  result.kind = Kind::list;
  result.items = std::move(items);
  return result;
}

JobValue JobValue::table() {
  JobValue result;
  result.kind = Kind::table;
  return result;
}

void JobValue::add(const std::string& name, JobValue value) {
  names.push_back(name);
  items.push_back(std::move(value));
}

const JobValue* JobValue::find(const std::string& name) const {
  const auto it = std::find(names.begin(), names.end(), name);
  return it == names.end() ? nullptr : &items[static_cast<std::size_t>(it - names.begin())];
}

std::string describe(const JobValue& value) {
  switch (value.kind) {
    case JobValue::Kind::none:
      return "nothing";
    case JobValue::Kind::boolean:
      return value.boolean ? "the boolean true" : "the boolean false";
    case JobValue::Kind::integer:
    case JobValue::Kind::number:
      return "the number " + to_toml(value);
    case JobValue::Kind::text:
      return value.text.size() <= 40 ? fmt::format("the text \"{}\"", value.text) : "a long text";
    case JobValue::Kind::list:
      return fmt::format("a list of {}", value.items.size());
    case JobValue::Kind::table:
      return "a table";
  }
  return "something unknown";
}

static std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      result += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      result += c;
  }
  return result + "\"";
}

std::string toml_key(const std::string& name) {
  const bool is_bare = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c)) || c == '_' || c == '-';
  });
  return is_bare ? name : quoted(name);
}

std::string to_toml(const JobValue& value) {
  std::string result;
  switch (value.kind) {
    case JobValue::Kind::none:
      return "";
    case JobValue::Kind::boolean:
      return value.boolean ? "true" : "false";
    case JobValue::Kind::integer:
      return fmt::format("{}", value.integer);
    case JobValue::Kind::number:
      return fmt::format("{}", value.number);
    case JobValue::Kind::text:
      return quoted(value.text);
    case JobValue::Kind::list:
      for (const JobValue& item : value.items) result += (result.empty() ? "" : ", ") + to_toml(item);
      return "[" + result + "]";
    case JobValue::Kind::table:
      for (std::size_t i = 0; i < value.items.size(); ++i)
        result += (i ? ", " : "") + toml_key(value.names[i]) + " = " + to_toml(value.items[i]);
      return "{ " + result + " }";
  }
  return result;
}

}  // namespace delfront
