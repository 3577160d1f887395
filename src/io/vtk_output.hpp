// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "delfront/io.hpp"
#include "io/output.hpp"

namespace delfront {

/// @brief Writes a VTK XML file: tags as they come, arrays appended raw at the end (or inline as text).
///
/// begin() … open/close/array … finish(). Array data must live until finish(), except what own() keeps.
///
/// The last array stands first in the appended data. meshio (5.3) looks an array up by its offset, first match in the
/// order of the tags, and overwrites the offsets of those it has read; only in this order can it never meet one of
/// these by chance.
class VtkOutput {
 public:
  VtkOutput(Output& out, const WriteOptions& options, const std::string& type);

  void open(const std::string& tag);  ///< e.g. `Piece NumberOfPoints="8"`
  void close(const std::string& tag);
  void line(const std::string& text);

  /// @brief An array in several pieces one after the other, all of T: double, int32, uint32 (below 2^31), int64, uint8.
  template <class T>
  void array(const std::string& name, int components, std::vector<std::span<const T>> pieces) {
    std::vector<std::string_view> raw;
    for (std::span<const T> piece : pieces)
      raw.emplace_back(reinterpret_cast<const char*>(piece.data()), piece.size_bytes());
    add(type_name(T{}), sizeof(T), name, components, std::move(raw));
  }
  template <class T>
  void own(const std::string& name, int components, const std::vector<T>& values) {
    const std::string& kept =
        kept_.emplace_back(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    add(type_name(T{}), sizeof(T), name, components, {kept});
  }
  /// @brief The appended data and the end of the file.
  void finish();

 private:
  struct Pending {
    std::vector<std::string_view> pieces;
    std::uint64_t bytes;
    std::string text_after;  ///< from behind the offset to the next array's
  };
  std::uint64_t size_in_file(const Pending& p) const { return p.bytes + (compress_ ? 0 : sizeof(p.bytes)); }
  void put(const std::string& text);
  static const char* type_name(double) { return "Float64"; }
  static const char* type_name(std::int32_t) { return "Int32"; }
  static const char* type_name(std::uint32_t) { return "Int32"; }
  static const char* type_name(std::int64_t) { return "Int64"; }
  static const char* type_name(std::uint8_t) { return "UInt8"; }
  void add(const char* type, std::size_t size, const std::string& name, int components,
           std::vector<std::string_view> pieces);
  void write_text(const std::string& type, std::size_t size, const std::vector<std::string_view>& pieces);
  static std::string compress(const std::vector<std::string_view>& pieces);

  Output& out_;
  bool is_text_, compress_;
  int depth_ = 1;
  std::deque<std::string> kept_;
  std::vector<Pending> pending_;
};

}  // namespace delfront
