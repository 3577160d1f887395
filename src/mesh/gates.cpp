// SPDX-License-Identifier: Apache-2.0
// Gates: "name op number" parted by commas. A bound from below is asked of the measure's smallest value, one from above
// of its largest: the worst value has to hold. A measure without values (the non-orthogonality of one cell) is met.
#include "mesh/gates.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/nearest_name.hpp"
#include "delfront/grid_check.hpp"
#include "fmt/format.h"
#include "mesh/measure.hpp"

namespace delfront {

namespace {

std::string_view trimmed(std::string_view text) {
  const char* blanks = " \t\n\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

[[noreturn]] void fail_gate(std::string_view text, const std::string& reason) {
  throw UsageError(fmt::format("gate '{}': {}; write a measure, one of > >= < <=, and a number, e.g. min_dihedral > 8",
                               text, reason));
}

Gate parse_gate(std::string_view text) {
  const std::size_t at = text.find_first_of("<>=");
  if (at == std::string_view::npos) fail_gate(text, "there is no comparison in it");
  const std::size_t length = at + 1 < text.size() && text[at + 1] == '=' ? 2 : 1;
  Gate gate{std::string(trimmed(text.substr(0, at))), std::string(text.substr(at, length)), 0};
  if (gate.name.empty()) fail_gate(text, "there is no measure before the comparison");
  if (gate.op[0] == '=') fail_gate(text, fmt::format("'{}' is not a comparison", gate.op));
  std::string_view number = trimmed(text.substr(at + length));
  if (number.starts_with('+')) number.remove_prefix(1);
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), gate.limit);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(gate.limit))
    fail_gate(text, fmt::format("'{}' is not a number", number));
  return gate;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> known_names(const QualityReport& report) {
  std::vector<std::string> names;
  for (const Measure& measure : report.measures) names.push_back(measure.name);
  for (const char* name : {"num_cells", "cells_below_5_deg", "cells_below_10_deg"}) names.emplace_back(name);
  return names;
}

const std::size_t* find_count(const QualityReport& report, const std::string& name) {
  if (name == "num_cells") return &report.num_cells;
  if (name == "cells_below_5_deg") return &report.cells_below_5_deg;
  if (name == "cells_below_10_deg") return &report.cells_below_10_deg;
  return nullptr;
}

[[noreturn]] void fail_unknown(const QualityReport& report, const std::string& name) {
  for (std::size_t i = 0; i < kNumMeasures; ++i)
    if (name == kind_of(static_cast<MeasureId>(i)).name)
      throw UsageError(fmt::format("gate '{}': this measure is not made for grids of this kind; there are {}", name,
                                   listed(known_names(report))));
  const std::vector<std::string> known = known_names(report);
  const std::string nearest = nearest_name(name, known);
  const std::string hint = nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest);
  throw UsageError(fmt::format("gate '{}': there is no such measure; {}there are {}", name, hint, listed(known)));
}

}  // namespace

std::vector<Gate> parse_gates(const std::string& text) {
  std::vector<Gate> gates;
  std::string_view rest = trimmed(text);
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    gates.push_back(parse_gate(trimmed(rest.substr(0, comma))));
    rest = trimmed(rest.substr(std::min(comma + 1, rest.size())));
  }
  return gates;
}

bool is_met(double value, const Gate& gate) {
  if (gate.op == ">") return value > gate.limit;
  if (gate.op == ">=") return value >= gate.limit;
  if (gate.op == "<") return value < gate.limit;
  return value <= gate.limit;
}

std::string judge(const QualityReport& report, const Gate& gate) {
  if (const std::size_t* count = find_count(report, gate.name)) {
    if (is_met(static_cast<double>(*count), gate)) return "";
    return fmt::format("{} is {}, wanted {} {}", gate.name, *count, gate.op, gate.limit);
  }
  const Measure* measure = report.find(gate.name);
  if (!measure) fail_unknown(report, gate.name);
  const bool is_from_below = gate.is_from_below();
  const double value = is_from_below ? measure->min : measure->max;
  const std::vector<std::size_t>& bins = measure->histogram;
  const bool is_empty = !bins.empty() && std::all_of(bins.begin(), bins.end(), [](std::size_t n) { return n == 0; });
  if (is_empty || is_met(value, gate)) return "";
  const std::string unit = measure->unit.empty() ? "" : " " + measure->unit;
  std::string sentence = fmt::format("{} is {:.6g}{}, wanted {} {:g}", gate.name, value, unit, gate.op, gate.limit);
  if (measure->worst_is_low == is_from_below && !measure->worst.empty()) {
    const Point at = measure->worst[0].at;
    sentence += fmt::format("; the worst is near ({:.6g}, {:.6g}, {:.6g})", at.x, at.y, at.z);
  }
  return sentence;
}

std::vector<std::string> failed_gates(const QualityReport& report, const std::string& gates) {
  std::vector<std::string> failed;
  for (const Gate& gate : parse_gates(gates))
    if (std::string sentence = judge(report, gate); !sentence.empty()) failed.push_back(std::move(sentence));
  return failed;
}

}  // namespace delfront
