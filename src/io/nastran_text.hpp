// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "io/cursor.hpp"

namespace delfront {

/// @brief One entry of bulk data: its name without '*', upper case, and the fields behind it, continuations joined.
struct NastranEntry {
  std::string name;
  std::vector<std::string_view> fields;
  std::size_t position = 0;  ///< where it begins, for messages
};

/// @brief Walks bulk data entry by entry: free field, small and large fixed fields, tabs.
class NastranText {
 public:
  NastranText(std::string_view bytes, const std::string& path);

  /// @brief The next entry; false at ENDDATA or the end. Comments before it go to `comments`.
  bool next(NastranEntry& entry, std::vector<std::string_view>& comments);
  [[noreturn]] void fail(const NastranEntry& entry, const std::string& message) const;
  /// @brief Field `i` as a number. @throws InputError
  std::int64_t integer(const NastranEntry& entry, std::size_t i, const char* what) const;
  /// @param blank  what an empty field means
  double real(const NastranEntry& entry, std::size_t i, const char* what, double blank = 0) const;
  const std::string& path() const { return cursor_.path(); }

 private:
  std::string_view take_line();
  void add_fields(std::string_view line, NastranEntry& entry);

  Cursor cursor_;
};

/// @brief A number in at most 16 characters with a point, as exact as they allow: "1.2345678901234-5".
std::string nastran_real(double value);

}  // namespace delfront
