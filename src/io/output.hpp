// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace delfront {

/// @brief A file being written through a large buffer; every write and the close are checked.
///
/// Errors name `shown_path` (what the user asked for) and the operating system's reason.
class Output {
 public:
  /// @throws IoError  cannot be created
  Output(const std::string& path, std::string shown_path);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void bytes(const void* data, std::size_t size);
  void text(std::string_view piece) { bytes(piece.data(), piece.size()); }
  void character(char c) { bytes(&c, 1); }
  void integer(std::int64_t value);
  /// @brief The shortest text that reads back as exactly this value.
  void real(double value);
  template <class T>
  void binary(T value) {
    bytes(&value, sizeof(T));
  }
  template <class T>
  void binary_all(std::span<const T> values) {
    bytes(values.data(), values.size_bytes());
  }
  /// @brief Flush and close. @throws IoError
  void close();
  const std::string& shown_path() const { return shown_path_; }

 private:
  void flush();
  void write_out(const char* data, std::size_t size);
  [[noreturn]] void fail(const char* doing, int error) const;
  char* reserve(std::size_t size);

  int file_ = -1;
  std::string shown_path_;
  std::unique_ptr<char[]> buffer_;
  std::size_t used_ = 0;
};

/// @brief A temporary file (or folder) beside `path` that takes its place on commit(), and is removed otherwise.
///
/// A link is followed; a device or a pipe is written straight through, since it must not be replaced by a file.
class Replacement {
 public:
  enum class Of { file, folder };
  /// @throws IoError  `path` cannot be written: what is wrong with it or with its folder
  explicit Replacement(const std::string& path, Of what = Of::file);
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  /// @brief Where to write.
  const std::string& temporary() const { return temporary_; }
  /// @brief Put it in place. @throws IoError
  void commit();

 private:
  void make_file();
  void make_folder();

  std::string shown_path_, target_, temporary_;
  Of what_;
  bool is_pending_ = false;
};

/// @brief Throws IoError where no file called `path` can be made: folder missing, below a regular file, read-only, …
void check_file_place(const std::string& path);
/// @brief The same for an OpenFOAM case folder (its parent must exist; the case itself is made when written).
void check_folder_place(const std::string& path);

}  // namespace delfront
