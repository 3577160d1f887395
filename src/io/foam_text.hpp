// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace delfront {

/// @brief Walks an ASCII file of OpenFOAM: words, numbers, quoted texts and each of ( ) { } [ ] ; as a token of its
/// own.
///
/// Comments of both kinds are skipped. Errors name the file and the line. Nothing is read past the end.
class FoamText {
 public:
  FoamText(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  /// @brief Next token without its quotes; empty at the end.
  std::string_view next();
  std::string_view peek();
  /// @throws InputError  another token, or the end
  void expect(std::string_view token);
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);
  double number(const char* what);
  /// @brief A number of things that follow, each at least `bytes_each` long: bounded by the rest of the file.
  std::size_t count(const char* what, std::size_t bytes_each);
  /// @brief The FoamFile dictionary. @throws InputError  missing, binary, or a class that is not `wanted` (if any)
  void header(std::string_view wanted);
  /// @brief What is left of a dictionary entry, up to its ';' or its own block.
  void skip_entry();

  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_blanks();

  std::string_view bytes_;
  std::string name_;
  std::size_t position_ = 0;
  std::size_t last_ = 0;  // where the token read last begins, for messages
};

}  // namespace delfront
