// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {

/// @brief Writes an HDF5 file whose bytes depend on what is written alone: no times, the order of making kept.
///
/// Objects are named by their path; groups above them must be there. Hold a Hdf5Turn as long as one of these is there.
class Hdf5Writer {
 public:
  /// @param compress  arrays of 8 KiB or more in chunks, shuffled and deflated
  /// @throws IoError  cannot be created, naming `shown_path`
  Hdf5Writer(const std::string& path, std::string shown_path, bool compress);
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  void add_group(const std::string& path);
  /// @param columns  0: a list; else rows of so many
  template <class T>
  void add(const std::string& path, std::span<const T> values, std::size_t columns = 0) {
    const std::span<const T> one[] = {values};
    add_pieces<T>(path, one, hdf5_type(T()), columns);
  }
  /// @brief One list of 64-bit integers made of several.
  void add_integers(const std::string& path, std::span<const std::span<const std::uint32_t>> pieces);
  void add_attribute(const std::string& path, const std::string& name, std::span<const std::int64_t> values);
  void add_attribute(const std::string& path, const std::string& name, const std::string& text);
  /// @brief Flush and close. @throws IoError
  void close();

 private:
  static hid_t hdf5_type(double) { return H5T_NATIVE_DOUBLE; }
  static hid_t hdf5_type(std::uint8_t) { return H5T_NATIVE_UINT8; }
  static hid_t hdf5_type(std::int32_t) { return H5T_NATIVE_INT32; }
  static hid_t hdf5_type(std::uint32_t) { return H5T_NATIVE_UINT32; }
  static hid_t hdf5_type(std::int64_t) { return H5T_NATIVE_INT64; }

  template <class T>
  void add_pieces(const std::string& path, std::span<const std::span<const T>> pieces, hid_t stored_type,
                  std::size_t columns) {
    std::size_t total = 0;
    for (const auto& piece : pieces) total += piece.size();
    const Hdf5Handle array = make_array(path, stored_type, total, columns);
    std::size_t first = 0;
    for (const auto& piece : pieces) {
      write_piece(array, hdf5_type(T()), piece.data(), first, piece.size(), columns);
      first += piece.size();
    }
  }
  Hdf5Handle make_array(const std::string& path, hid_t type, std::size_t total, std::size_t columns);
  void write_piece(hid_t array, hid_t type, const void* values, std::size_t first, std::size_t count,
                   std::size_t columns);
  Hdf5Handle checked(hid_t id, herr_t (*closer)(hid_t)) const;
  void check(herr_t status) const;

  std::string shown_path_;
  bool compress_;
  Hdf5Handle file_;
};

}  // namespace delfront
