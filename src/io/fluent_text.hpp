// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string_view>
#include <vector>

#include "io/cursor.hpp"

namespace delfront {

/// @brief One section of a Fluent file: "(index (numbers) (body))".
struct FluentSection {
  int index = 0;                             ///< without the thousands that say how its body is written
  int form = 0;                              ///< 0 text, 2 binary single, 3 binary double
  std::vector<std::int64_t> numbers;         ///< of the head, hexadecimal there
  std::vector<std::string_view> words;       ///< of the head as they stand
  std::string_view text;                     ///< of a comment, without its quotes
  std::size_t begin = 0, body = 0, end = 0;  ///< places; body 0: it has none; end: behind a text's body
};

/// @brief Walks a Fluent file section by section; bodies are taken from `cursor()` by the reader.
class FluentText {
 public:
  FluentText(std::string_view bytes, const std::string& path) : cursor_(bytes, path) {}

  /// @brief The next section, with the cursor at its body; false at the end of the file.
  bool next(FluentSection& section);
  /// @brief To the end of a section whose body was not taken.
  void skip(const FluentSection& section);
  /// @brief The next hexadecimal number of a text's body.
  std::int64_t hexadecimal(const char* what);
  Cursor& cursor() { return cursor_; }

 private:
  void read_head(FluentSection& section);
  std::size_t end_of_parenthesis(std::size_t from, int depth) const;

  Cursor cursor_;
};

}  // namespace delfront
