// SPDX-License-Identifier: Apache-2.0
#include "io/foam_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "delfront/errors.hpp"
#include "io/cursor.hpp"

namespace delfront {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }
bool is_punctuation(char c) { return std::string_view("(){}[];").find(c) != std::string_view::npos; }

}  // namespace

void FoamText::fail(const std::string& message) const {
  const auto before = bytes_.substr(0, std::min(last_, bytes_.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  throw InputError(fmt::format("{}: line {}: {}", name_, line, message));
}

void FoamText::skip_blanks() {
  while (position_ < bytes_.size()) {
    const std::string_view rest = bytes_.substr(position_);
    if (is_blank(rest[0]))
      ++position_;
    else if (rest.starts_with("//"))
      position_ = std::min(bytes_.find('\n', position_), bytes_.size());
    else if (rest.starts_with("/*"))
      position_ = std::min(bytes_.find("*/", position_ + 2), bytes_.size() - 2) + 2;
    else
      return;
  }
}

std::string_view FoamText::next() {
  skip_blanks();
  last_ = position_;
  if (position_ >= bytes_.size()) return {};
  if (is_punctuation(bytes_[position_])) return bytes_.substr(position_++, 1);
  if (bytes_[position_] == '"') {
    const std::size_t end = std::min(bytes_.find('"', position_ + 1), bytes_.size());
    position_ = std::min(end + 1, bytes_.size());
    return bytes_.substr(last_ + 1, end - last_ - 1);
  }
  while (position_ < bytes_.size() && !is_blank(bytes_[position_]) && !is_punctuation(bytes_[position_])) ++position_;
  return bytes_.substr(last_, position_ - last_);
}

std::string_view FoamText::peek() {
  const std::size_t position = position_, last = last_;
  const std::string_view token = next();
  position_ = position;
  last_ = last;
  return token;
}

void FoamText::expect(std::string_view token) {
  const std::string_view found = next();
  if (found != token) fail(fmt::format("expected '{}', found '{}'", token, found.substr(0, 40)));
}

std::int64_t FoamText::integer(const char* what, std::int64_t low, std::int64_t high) {
  const std::string_view token = next();
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || end != token.data() + token.size())
    fail(fmt::format("{}: '{}' is not a whole number", what, token.substr(0, 40)));
  if (value < low || value > high) fail(fmt::format("{} {} is not between {} and {}", what, value, low, high));
  return value;
}

double FoamText::number(const char* what) {
  const std::string_view token = next();
  double value = 0;
  if (!parse_number(token, value)) fail(fmt::format("{}: '{}' is not a number", what, token.substr(0, 40)));
  return value;
}

std::size_t FoamText::count(const char* what, std::size_t bytes_each) {
  const auto most = static_cast<std::int64_t>((bytes_.size() - position_) / bytes_each);
  const std::int64_t claimed = integer(what, 0, INT64_MAX);
  if (claimed > most) fail(fmt::format("{} {}: the file has room for {}; it is truncated", what, claimed, most));
  return static_cast<std::size_t>(claimed);
}

void FoamText::header(std::string_view wanted) {
  expect("FoamFile");
  expect("{");
  std::string_view kind;
  for (std::string_view key = next(); key != "}"; key = next()) {
    if (key.empty()) fail("the header has no end; the file is truncated");
    if (key == "class") kind = peek();
    if (key == "format" && peek() != "ascii")
      fail(fmt::format("the format is {}; only ascii is read: convert the case with foamFormatConvert", peek()));
    skip_entry();
  }
  if (!wanted.empty() && kind != wanted)
    fail(fmt::format("the class is {}; only {} is read: write the case again in ascii", kind, wanted));
}

void FoamText::skip_entry() {
  for (int depth = 0;;) {
    const std::string_view token = next();
    if (token.empty()) fail("an entry has no end; the file is truncated");
    if (token == "{" || token == "(") ++depth;
    if (token == "}" || token == ")") --depth;
    if (depth <= 0 && (token == ";" || token == "}")) return;
  }
}

}  // namespace delfront
