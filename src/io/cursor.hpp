// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "delfront/errors.hpp"

namespace delfront {

/// @brief Parse a whole token as a number, as files in the wild write them: leading '+', 'D' exponents, three-digit
/// exponents, values below the smallest double (0), "nan", "inf", "1.#QNAN", "-1.#INF".
/// @return false where the token is no number
bool parse_number(std::string_view token, double& value);

/// @brief True for "0,5626": a number written with a decimal comma.
bool has_decimal_comma(std::string_view token);

/// @brief Walks the bytes of a file, text and binary parts alike; every error names the file and the line or byte.
///
/// Nothing is read past the end, and no memory is taken on the word of the file alone: see count().
class Cursor {
 public:
  /// @param comments  characters that begin a comment up to the end of the line; may be empty
  Cursor(std::string_view bytes, std::string path, std::string comments = "")
      : bytes_(bytes), path_(std::move(path)), comments_(std::move(comments)) {}

  /// @brief Next token, also on a later line; empty at the end of the file. Comments are skipped.
  std::string_view next();
  std::string_view peek();
  /// @brief Next token of this line; empty at its end.
  std::string_view next_on_line();
  /// @brief What is left of this line without blanks at its ends; moves to the next line.
  enum class Comments { drop, keep };
  std::string_view rest_of_line(Comments comments = Comments::drop);
  void skip_line();
  bool at_end();       ///< only blanks and comments are left
  bool at_line_end();  ///< only blanks and comments are left on this line

  /// @brief Next token as a number. @throws InputError  not a number, decimal comma, end of file
  double number(const char* what);
  std::int64_t integer(const char* what);
  /// @brief An integer that announces how many things follow, each at least `bytes_each` long in the file.
  /// @throws InputError  negative, or more than the rest of the file can hold
  std::size_t count(const char* what, std::size_t bytes_each);
  std::size_t checked_count(std::int64_t claimed, const char* what, std::size_t bytes_each) const;
  /// @brief An integer in [low, high].
  std::int64_t integer_in(const char* what, std::int64_t low, std::int64_t high);

  /// @brief The next bytes as a T, in the file's byte order.
  template <class T>
  T binary(const char* what) {
    if (left() < sizeof(T)) fail_short(what);
    T value;
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return swap_bytes ? swapped(value) : value;
  }
  template <class T>
  static T swapped(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    std::reverse(raw, raw + sizeof(T));
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  std::string_view take_bytes(std::size_t n, const char* what);

  std::size_t left() const { return bytes_.size() - position_; }
  std::size_t position() const { return position_; }
  void move_to(std::size_t position) { position_ = std::min(position, bytes_.size()); }
  std::string_view bytes() const { return bytes_; }
  const std::string& path() const { return path_; }
  std::size_t line_of(std::size_t position) const;

  [[noreturn]] void fail(const std::string& message) const { fail_at(last_, message); }
  [[noreturn]] void fail_at(std::size_t position, const std::string& message) const;
  [[noreturn]] void fail_in_binary(const std::string& message) const;
  [[noreturn]] void fail_short(const char* what) const;

  bool swap_bytes = false;

 private:
  void skip_blanks_on_line();
  void skip_blanks();
  bool is_comment(char c) const { return !comments_.empty() && comments_.find(c) != std::string::npos; }

  std::string_view bytes_;
  std::string path_, comments_;
  std::size_t position_ = 0;
  std::size_t last_ = 0;  // where the token read last begins, for messages
};

/// @brief True where `text` equals `word`, letters of either case.
bool equal_ignoring_case(std::string_view text, std::string_view word);
bool starts_with_ignoring_case(std::string_view text, std::string_view word);
std::string_view trimmed(std::string_view text);

}  // namespace delfront
