// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {

/// @brief Reads an HDF5 file that may hold anything: every size is compared with what the file stores before memory is
/// taken, and nothing outside the file is opened (external links and storage, virtual datasets, unknown filters).
///
/// Objects are named by their path, "/VTKHDF/Points". All errors are InputError with the file and that path. Hold a
/// Hdf5Turn as long as one of these is there.
class Hdf5Reader {
 public:
  /// @throws InputError  missing, no regular file, not HDF5, damaged
  explicit Hdf5Reader(const std::string& path);

  enum class Holds : std::uint8_t { integers, reals, text };
  struct Array {
    Holds holds = Holds::reals;
    std::vector<std::uint64_t> shape;  ///< empty: a single value
    std::uint64_t count = 1;           ///< values, the product of `shape`
    std::size_t value_size = 8;        ///< bytes
    std::string path;
    Hdf5Handle id;
  };

  bool has(const std::string& path) const;
  bool has_group(const std::string& path) const;
  /// @return nothing where there is no such dataset; one of a kind that cannot be read throws
  std::optional<Array> find_array(const std::string& path) const;
  Array array(const std::string& path) const;
  /// @brief Extents of an array whatever it holds; empty where there is none.
  std::vector<std::uint64_t> shape(const std::string& path) const;

  /// @brief All values, row-major. @throws InputError  text, damaged, more than the file holds
  std::vector<double> reals(const Array& array) const;
  /// @brief Whole numbers, stored as reals or not. @throws InputError  as reals(), or a value is none of 63 bits
  std::vector<std::int64_t> integers(const Array& array) const;
  /// @brief Texts of fixed length, one after the other, `value_size` characters each.
  std::string text(const Array& array) const;
  std::vector<double> reals(const std::string& path) const { return reals(array(path)); }
  std::vector<std::int64_t> integers(const std::string& path) const { return integers(array(path)); }

  /// @return "" where the object has no such attribute, or none of text
  std::string text_attribute(const std::string& path, const std::string& name) const;
  /// @return empty where the object has no such attribute, or none of up to a thousand whole numbers
  std::vector<std::int64_t> integer_attribute(const std::string& path, const std::string& name) const;

  /// @brief Names in a group: in the order of making where the file keeps that, else sorted. None where it is not
  /// there.
  /// @throws InputError  it stands in another file, or is no group
  std::vector<std::string> names(const std::string& path) const;

  [[noreturn]] void fail(const std::string& where, const std::string& message) const;

 private:
  Hdf5Handle open(const std::string& path) const;
  std::vector<std::uint64_t> extents_of(hid_t dataset, const std::string& path) const;
  void check_storage(const Array& array) const;
  void check_chunks(const Array& array, hid_t creation) const;
  void read(const Array& array, hid_t type, void* values) const;

  std::string path_;
  std::uint64_t file_size_ = 0;
  Hdf5Handle access_, file_;
};

}  // namespace delfront
