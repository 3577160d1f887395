// SPDX-License-Identifier: Apache-2.0
#include "io/cursor.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace delfront {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
bool is_separator(char c) { return is_blank(c) || c == '\n'; }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Tokens go into messages: cut to a length that a terminal shows, without control characters.
std::string shown(std::string_view token) {
  std::string text(token.substr(0, 40));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return token.size() > 40 ? text + "…" : text;
}

/// The numbers that from_chars leaves: out of range, 'D' exponents, what old Windows runtimes print for nan and inf.
bool parse_odd_number(std::string_view token, double& value) {
  if (token.size() > 400) return false;
  std::string text(token);
  const bool negative = text.starts_with('-');
  if (text.find("#INF") != std::string::npos) {
    value = negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    return true;
  }
  if (text.find("#QNAN") != std::string::npos || text.find("#IND") != std::string::npos ||
      text.find("#SNAN") != std::string::npos) {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  if (text.find_first_not_of("0123456789+-.eEdD") != std::string::npos) return false;
  for (char& c : text)
    if (c == 'D' || c == 'd') c = 'e';
  const char* begin = text.c_str();
  const char* end = begin + text.size();
  double parsed = 0;
  const auto [stop, error] = std::from_chars(begin, end, parsed);
  if (stop != end || error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) {
    // Too small is 0, too large is infinity. The exponent's sign decides, or, without an exponent, the length.
    const std::size_t e = text.find_first_of("eE");
    const bool tiny = e == std::string::npos ? text.find_first_of("123456789") > 300 : text[e + 1] == '-';
    parsed = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    if (negative) parsed = -parsed;
  }
  value = parsed;
  return true;
}

}  // namespace

bool parse_number(std::string_view token, double& value) {
  if (token.starts_with('+')) {
    token.remove_prefix(1);
    if (token.starts_with('-') || token.starts_with('+')) return false;
  }
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (error == std::errc() && stop == end) return true;
  return parse_odd_number(token, value);
}

bool has_decimal_comma(std::string_view token) {
  const std::size_t comma = token.find(',');
  if (comma == std::string_view::npos || token.find(',', comma + 1) != std::string_view::npos) return false;
  std::string text(token);
  text[comma] = '.';
  double ignored = 0;
  return parse_number(text, ignored);
}

void Cursor::skip_blanks_on_line() {
  while (position_ < bytes_.size() && is_blank(bytes_[position_])) ++position_;
  if (position_ < bytes_.size() && is_comment(bytes_[position_])) {
    const std::size_t end = bytes_.find('\n', position_);
    position_ = end == std::string_view::npos ? bytes_.size() : end;
  }
}

void Cursor::skip_blanks() {
  skip_blanks_on_line();
  while (position_ < bytes_.size() && bytes_[position_] == '\n') {
    ++position_;
    skip_blanks_on_line();
  }
}

std::string_view Cursor::next_on_line() {
  skip_blanks_on_line();
  last_ = position_;
  std::size_t end = position_;
  while (end < bytes_.size() && !is_separator(bytes_[end])) ++end;
  const std::string_view token = bytes_.substr(position_, end - position_);
  position_ = end;
  return token;
}

std::string_view Cursor::next() {
  skip_blanks();
  return next_on_line();
}

std::string_view Cursor::peek() {
  const std::size_t before = position_;
  const std::string_view token = next();
  position_ = before;
  return token;
}

std::string_view Cursor::rest_of_line(Comments comments) {
  last_ = position_;
  const std::size_t newline = bytes_.find('\n', position_);
  const std::size_t end = newline == std::string_view::npos ? bytes_.size() : newline;
  std::string_view text = bytes_.substr(position_, end - position_);
  position_ = newline == std::string_view::npos ? end : end + 1;
  for (std::size_t i = 0; comments == Comments::drop && i < text.size(); ++i)
    if (is_comment(text[i])) text = text.substr(0, i);
  return trimmed(text);
}

void Cursor::skip_line() {
  const std::size_t newline = bytes_.find('\n', position_);
  position_ = newline == std::string_view::npos ? bytes_.size() : newline + 1;
}

bool Cursor::at_end() {
  skip_blanks();
  return position_ == bytes_.size();
}

bool Cursor::at_line_end() {
  skip_blanks_on_line();
  return position_ == bytes_.size() || bytes_[position_] == '\n';
}

double Cursor::number(const char* what) {
  skip_blanks();
  last_ = position_;
  const char* begin = bytes_.data() + position_;
  const char* end = bytes_.data() + bytes_.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error == std::errc() && (stop == end || is_separator(*stop))) {
    position_ += static_cast<std::size_t>(stop - begin);
    return value;
  }
  const std::string_view token = next_on_line();
  if (token.empty()) fail(fmt::format("the file ends where {} should stand; it is truncated", what));
  if (parse_number(token, value)) return value;
  if (has_decimal_comma(token))
    fail(fmt::format("'{}' ({}) is written with a decimal comma; export with decimal points", shown(token), what));
  fail(fmt::format("'{}' should be a number ({})", shown(token), what));
}

std::int64_t Cursor::integer(const char* what) {
  std::string_view token = next();
  if (token.empty()) fail(fmt::format("the file ends where {} should stand; it is truncated", what));
  const std::string_view whole = token;
  if (token.starts_with('+')) token.remove_prefix(1);
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || stop != token.data() + token.size())
    fail(fmt::format("'{}' should be a whole number ({})", shown(whole), what));
  return value;
}

std::int64_t Cursor::integer_in(const char* what, std::int64_t low, std::int64_t high) {
  const std::int64_t value = integer(what);
  if (value < low || value > high)
    fail(high < low ? fmt::format("{} {} refers to something that the file does not hold", what, value)
                    : fmt::format("{} {} is outside {} … {}", what, value, low, high));
  return value;
}

std::size_t Cursor::checked_count(std::int64_t claimed, const char* what, std::size_t bytes_each) const {
  if (claimed < 0) fail(fmt::format("{} {} is negative", what, claimed));
  const auto wanted = static_cast<std::uint64_t>(claimed);
  if (wanted > left() / bytes_each + 1)  // the last one may lack its line end
    fail(fmt::format("{} {}: only {} bytes follow, room for {} at most; the file is truncated or damaged", what, wanted,
                     left(), left() / bytes_each + 1));
  if (wanted >= 0xffffffffu) fail(fmt::format("{} {}: more than 2^32 - 1 are not supported", what, wanted));
  return static_cast<std::size_t>(wanted);
}

std::size_t Cursor::count(const char* what, std::size_t bytes_each) {
  const std::int64_t claimed = integer(what);
  return checked_count(claimed, what, bytes_each);
}

std::string_view Cursor::take_bytes(std::size_t n, const char* what) {
  if (left() < n) fail_short(what);
  const std::string_view taken = bytes_.substr(position_, n);
  position_ += n;
  return taken;
}

std::size_t Cursor::line_of(std::size_t position) const {
  const auto begin = bytes_.begin();
  return 1 + static_cast<std::size_t>(
                 std::count(begin, begin + static_cast<std::ptrdiff_t>(std::min(position, bytes_.size())), '\n'));
}

void Cursor::fail_at(std::size_t position, const std::string& message) const {
  throw InputError(fmt::format("{}: line {}: {}", path_, line_of(position), message));
}

void Cursor::fail_in_binary(const std::string& message) const {
  throw InputError(fmt::format("{}: byte {}: {}", path_, position_, message));
}

void Cursor::fail_short(const char* what) const {
  fail_in_binary(fmt::format("the file ends ({} bytes) inside {}; it is truncated", bytes_.size(), what));
}

bool equal_ignoring_case(std::string_view text, std::string_view word) {
  return text.size() == word.size() && starts_with_ignoring_case(text, word);
}

bool starts_with_ignoring_case(std::string_view text, std::string_view word) {
  if (text.size() < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (lower(text[i]) != lower(word[i])) return false;
  return true;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_separator(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_separator(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace delfront
