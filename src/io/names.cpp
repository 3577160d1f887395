// SPDX-License-Identifier: Apache-2.0
#include "io/names.hpp"

#include <fmt/format.h>

#include <set>
#include <string_view>
#include <utility>

#include "io/cells.hpp"
#include "io/cursor.hpp"

namespace delfront {

namespace {

constexpr std::size_t kLongestCgns = 32;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_word(NameRule rule) { return rule == NameRule::foam_word || rule == NameRule::any_case; }

char fit_character(char c, NameRule rule) {
  const auto code = static_cast<unsigned char>(c);
  if (code < 32 || code == 127) return is_word(rule) || rule == NameRule::word ? '_' : ' ';
  switch (rule) {
    case NameRule::line:
      return c;
    case NameRule::quoted:
      return c == '"' ? '\'' : c;
    case NameRule::hdf5:
    case NameRule::cgns:
      return c == '/' ? '_' : c;
    case NameRule::word:
      return std::string_view(" !%=,;()\"'{}").find(c) == std::string_view::npos ? c : '_';
    case NameRule::foam_word:
    case NameRule::any_case:
      return is_letter(c) || is_digit(c) || c == '_' || c == '-' || c == '.' ? c : '_';
  }
  return c;
}

std::string fit_name(const std::string& name, NameRule rule, const char* role) {
  std::string fitted(trimmed(name));
  for (char& c : fitted) c = fit_character(c, rule);
  if (rule == NameRule::cgns && fitted.size() > kLongestCgns) fitted.resize(kLongestCgns);
  fitted = std::string(trimmed(fitted));
  if (fitted.empty()) return role;
  if ((rule == NameRule::hdf5 || rule == NameRule::cgns) && (fitted == "." || fitted == ".."))
    return std::string(fitted.size(), '_');  // paths there
  if (is_word(rule) && !is_letter(fitted[0]) && fitted[0] != '_') fitted = fmt::format("{}_{}", role, fitted);
  return fitted;
}

/// What must not be there twice.
std::string key_of(std::string name, NameRule rule) {
  if (rule == NameRule::any_case)
    for (char& c : name)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return name;
}

}  // namespace

std::vector<std::string> fit_names(const Mesh& mesh, NameRule rule, const char* format, std::vector<std::string>& notes,
                                   std::array<int, 2> written) {
  std::vector<std::string> fitted(mesh.groups.size());
  std::vector<bool> is_settled(mesh.groups.size(), false);
  std::set<std::pair<int, std::string>> taken;
  // Names that fit as they are keep it, whatever comes before them.
  for (std::size_t i = 0; i < mesh.groups.size(); ++i) {
    const Group& group = mesh.groups[GroupId(i)];
    fitted[i] = fit_name(group.name, rule, role_name(mesh, group.dimension));
    if (fitted[i] == group.name) is_settled[i] = taken.insert({group.dimension, key_of(fitted[i], rule)}).second;
  }
  for (std::size_t i = 0; i < mesh.groups.size(); ++i) {
    if (is_settled[i]) continue;
    const Group& group = mesh.groups[GroupId(i)];
    const std::string base = fitted[i];
    for (int number = 2; !taken.insert({group.dimension, key_of(fitted[i], rule)}).second; ++number) {
      const std::string end = fmt::format("_{}", number);
      fitted[i] = (rule == NameRule::cgns ? base.substr(0, kLongestCgns - end.size()) : base) + end;
    }
    if (group.dimension < written[0] || group.dimension > written[1]) continue;
    const char* role = role_name(mesh, group.dimension);
    notes.push_back(group.name.empty()
                        ? fmt::format("{}: an unnamed {} is written as \"{}\"", format, role, fitted[i])
                        : fmt::format("{}: {} \"{}\" is written as \"{}\"", format, role, group.name, fitted[i]));
  }
  return fitted;
}

}  // namespace delfront
