// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace delfront {

/// @brief All bytes of a file. Copied, not mapped: a file that shrinks while we read it must not crash us.
class FileBytes {
 public:
  /// @throws InputError  missing, a folder, unreadable or empty
  explicit FileBytes(const std::string& path);
  std::string_view view() const { return {data_.get(), size_}; }

 private:
  std::unique_ptr<char[]> data_;
  std::size_t size_ = 0;
};

}  // namespace delfront
