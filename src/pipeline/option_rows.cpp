// SPDX-License-Identifier: Apache-2.0
#include "pipeline/option_rows.hpp"

#include <cmath>

#include "delfront/errors.hpp"
#include "pipeline/quantities.hpp"

namespace delfront {

const char* const kLengthAllowed =
    "a length: a number in model units, or a text such as \"5%\" (of the bounding box's diagonal), \"20c\" (longest "
    "sides), \"2 mm\"";

std::string as_text(const JobValue& value) {
  if (!value.is(JobValue::Kind::text)) throw BadValue("got " + describe(value));
  return value.text;
}

double as_number(const JobValue& value) {
  if (!value.is_number() || !std::isfinite(value.number)) throw BadValue("got " + describe(value));
  return value.number;
}

double as_number_between(const JobValue& value, double low, double high) {
  const double number = as_number(value);
  if (number < low || number > high) throw BadValue("got " + describe(value));
  return number;
}

std::uint64_t as_count(const JobValue& value) {
  const double number = as_number_between(value, 0, 1e18);
  if (number != std::floor(number)) throw BadValue("got " + describe(value));
  return value.is(JobValue::Kind::integer) ? static_cast<std::uint64_t>(value.integer)
                                           : static_cast<std::uint64_t>(number);
}

Length as_length(const JobValue& value, bool least_is_zero) {
  const Length length = value.is_number() ? Length{as_number(value), ""} : parse_length(as_text(value));
  if (length.value < 0 || (length.value == 0 && !least_is_zero))
    throw BadValue(fmt::format("got {}, which is {}", describe(value), least_is_zero ? "negative" : "not positive"));
  return length;
}

JobValue length_value(const Length& length) {
  return length.unit.empty() ? JobValue::of(length.value) : JobValue::of(to_text(length));
}

/// Numbers of a list, or of "1,2,3".
std::vector<double> as_numbers(const JobValue& value) {
  std::vector<double> result;
  if (value.is(JobValue::Kind::list)) {
    for (const JobValue& item : value.items) result.push_back(as_number(item));
    return result;
  }
  const std::string text = as_text(value);
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    result.push_back(parse_number(text.substr(begin, end - begin), "number"));
    begin = end + 1;
  }
  return result;
}

Point as_point(const JobValue& value, bool may_be_planar) {
  const std::vector<double> x = as_numbers(value);
  if (x.size() != 3 && !(may_be_planar && x.size() == 2))
    throw BadValue(
        fmt::format("a point has three coordinates{}, got {}", may_be_planar ? " (two in the plane)" : "", x.size()));
  return {x[0], x[1], x.size() == 3 ? x[2] : 0};
}

std::string as_choice(const JobValue& value, const std::vector<std::string>& choices) {
  std::string text = as_text(value);
  if (std::find(choices.begin(), choices.end(), text) == choices.end())
    throw BadValue("got " + describe(value) + did_you_mean(text, choices));
  return text;
}

std::vector<std::string> as_texts(const JobValue& value) {
  std::vector<std::string> texts;
  if (value.is(JobValue::Kind::text)) {
    texts.push_back(value.text);
  } else {
    if (!value.is(JobValue::Kind::list)) throw BadValue("got " + describe(value));
    for (const JobValue& item : value.items) texts.push_back(as_text(item));
  }
  for (const std::string& text : texts)
    if (text.empty()) throw BadValue("got an empty text");
  return texts;
}

std::vector<Point> as_points(const JobValue& value) {
  const bool is_one = value.is(JobValue::Kind::text) ||
                      (value.is(JobValue::Kind::list) && !value.items.empty() && value.items[0].is_number());
  if (is_one) return {as_point(value, true)};
  if (!value.is(JobValue::Kind::list)) throw BadValue("got " + describe(value));
  std::vector<Point> points;
  for (const JobValue& item : value.items) points.push_back(as_point(item, true));
  return points;
}

void need_members(const JobValue& value, const std::vector<std::string>& names) {
  if (!value.is(JobValue::Kind::table)) throw BadValue("got " + describe(value));
  for (const std::string& name : value.names)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw BadValue(fmt::format("unknown key '{}'{}", name, did_you_mean(name, names)));
}

JobValue text_value(const std::string& text) { return text.empty() ? JobValue() : JobValue::of(text); }

JobValue numbers_value(const std::vector<double>& numbers) {
  JobValue list = JobValue::list();
  for (const double x : numbers) list.items.push_back(JobValue::of(x));
  return list;
}

JobValue point_value(Point p) { return numbers_value({p.x, p.y, p.z}); }

}  // namespace delfront
