// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/xml.hpp"

namespace delfront {

/// @brief Decodes the DataArray elements of one VTK XML file: ascii, base64 ("binary"), appended raw or base64, each
/// plain or zlib-compressed, UInt32 or UInt64 headers, both byte orders.
class VtkArrays {
 public:
  /// @throws InputError  a compressor, header type or encoding that is not supported (named)
  VtkArrays(const XmlElement& file, std::string_view bytes, std::string path);

  /// @brief All values of an array, converted. @throws InputError  damaged, truncated, too large, not of this kind
  std::vector<double> reals(const XmlElement& array) const;
  std::vector<std::int64_t> integers(const XmlElement& array) const;
  [[noreturn]] void fail(const XmlElement& where, const std::string& message) const;

 private:
  template <class T>
  std::vector<T> values(const XmlElement& array) const;
  /// The array's raw bytes in the file's byte order.
  std::string decode(const XmlElement& array) const;
  std::string decode_plain(const XmlElement& array, std::string_view data, bool is_base64) const;
  std::string decode_compressed(const XmlElement& array, std::string_view data, bool is_base64) const;
  std::uint64_t header_word(std::string_view raw, std::size_t index) const;

  std::string_view bytes_, appended_;
  std::string path_;
  bool is_compressed_ = false, swap_bytes_ = false, appended_is_base64_ = false;
  std::size_t header_size_ = 4;
};

/// @brief Base64 up to the padding, the first character that is not base64, or `max_bytes` decoded bytes.
std::string decode_base64(std::string_view text, std::size_t max_bytes = std::string::npos);

}  // namespace delfront
