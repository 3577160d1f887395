// SPDX-License-Identifier: Apache-2.0
// Layout of the data (VTK file formats, "XML file formats"): plain data is [bytes][data]; compressed data is
// [blocks][block size][size of the last partial block, 0: full][compressed size of each] then the blocks. In base64
// the compressed form encodes header and data apart; the plain form encodes them together (VTK) or apart (others).
#include "io/vtk_arrays.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <type_traits>

#include "io/cursor.hpp"
#include "io/whole_numbers.hpp"

namespace delfront {

namespace {

constexpr std::uint64_t kMaxInflation = 1032;  // zlib cannot do better

constexpr std::size_t base64_length(std::size_t bytes) { return (bytes + 2) / 3 * 4; }

template <class Stored, class T>
void convert(std::string_view raw, bool swap_bytes, std::vector<T>& out) {
  const std::size_t n = raw.size() / sizeof(Stored);
  out.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Stored value;
    std::memcpy(&value, raw.data() + i * sizeof(Stored), sizeof(Stored));
    if (swap_bytes) value = Cursor::swapped(value);
    out[i] = static_cast<T>(value);
  }
}

}  // namespace

std::string decode_base64(std::string_view text, std::size_t max_bytes) {
  static const auto kTable = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kDigits.size(); ++i)
      table[static_cast<unsigned char>(kDigits[i])] = static_cast<std::int8_t>(i);
    return table;
  }();
  std::string out;
  out.reserve(std::min(max_bytes, text.size() / 4 * 3 + 3));
  std::uint32_t bits = 0;
  int num_bits = 0;
  for (char c : text) {
    const int digit = kTable[static_cast<unsigned char>(c)];
    if (digit < 0) break;
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    if (out.size() == max_bytes) break;
    out += static_cast<char>((bits >> num_bits) & 0xff);
  }
  return out;
}

VtkArrays::VtkArrays(const XmlElement& file, std::string_view bytes, std::string path)
    : bytes_(bytes), path_(std::move(path)) {
  const std::string compressor = file.get("compressor");
  if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
    fail(file, fmt::format("compressor {} is not supported; write it with zlib or without compression", compressor));
  is_compressed_ = !compressor.empty();
  const std::string header = file.get("header_type");
  if (!header.empty() && header != "UInt32" && header != "UInt64")
    fail(file, fmt::format("header_type {} is neither UInt32 nor UInt64", header));
  header_size_ = header == "UInt64" ? 8 : 4;
  const std::string order = file.get("byte_order");
  const bool is_little = order != "BigEndian";
  swap_bytes_ = is_little != (std::endian::native == std::endian::little);
  if (const XmlElement* appended = file.child("AppendedData")) {
    appended_ = appended->text;
    appended_is_base64_ = appended->get("encoding") == "base64";
  }
}

void VtkArrays::fail(const XmlElement& where, const std::string& message) const {
  const std::size_t at = where.name.empty() ? 0 : static_cast<std::size_t>(where.name.data() - bytes_.data());
  const std::string name = where.get("Name");
  Cursor(bytes_, path_)
      .fail_at(at, name.empty() ? fmt::format("<{}>: {}", where.name.substr(0, 40), message)
                                : fmt::format("array '{}': {}", name.substr(0, 80), message));
}

std::uint64_t VtkArrays::header_word(std::string_view raw, std::size_t index) const {
  if (header_size_ == 8) {
    std::uint64_t word;
    std::memcpy(&word, raw.data() + 8 * index, 8);
    return swap_bytes_ ? Cursor::swapped(word) : word;
  }
  std::uint32_t word;
  std::memcpy(&word, raw.data() + 4 * index, 4);
  return swap_bytes_ ? Cursor::swapped(word) : word;
}

std::string VtkArrays::decode_plain(const XmlElement& array, std::string_view data, bool is_base64) const {
  if (!is_base64) {
    if (data.size() < header_size_) fail(array, "the file ends before its data; it is truncated");
    const std::uint64_t size = header_word(data, 0);
    if (size > data.size() - header_size_)
      fail(array, fmt::format("{} bytes are announced, {} are there; the file is truncated", size,
                              data.size() - header_size_));
    return std::string(data.substr(header_size_, size));
  }
  const std::string header = decode_base64(data.substr(0, base64_length(header_size_)), header_size_);
  if (header.size() < header_size_) fail(array, "the file ends before its data; it is truncated");
  const std::uint64_t size = header_word(header, 0);
  if (size > data.size())
    fail(array, fmt::format("{} bytes are announced, fewer are there; the file is truncated", size));
  std::string whole = decode_base64(data, header_size_ + size);
  if (whole.size() == header_size_ && size > 0) {  // header and data were encoded apart
    whole = decode_base64(data.substr(std::min(base64_length(header_size_), data.size())), size);
    if (whole.size() < size)
      fail(array, fmt::format("{} bytes are announced, {} are there; the file is truncated", size, whole.size()));
    return whole;
  }
  if (whole.size() < header_size_ + size)
    fail(array,
         fmt::format("{} bytes are announced, {} are there; the file is truncated", size, whole.size() - header_size_));
  return whole.substr(header_size_);
}

std::string VtkArrays::decode_compressed(const XmlElement& array, std::string_view data, bool is_base64) const {
  const auto fail_short = [&] { fail(array, "the file ends inside its compressed data; it is truncated"); };
  std::string first = is_base64 ? decode_base64(data.substr(0, base64_length(header_size_)), header_size_)
                                : std::string(data.substr(0, header_size_));
  if (first.size() < header_size_) fail_short();
  const std::uint64_t num_blocks = header_word(first, 0);
  if (num_blocks == 0) return {};
  if (num_blocks > data.size() / header_size_) fail_short();
  const std::size_t head_size = header_size_ * (3 + num_blocks);
  const std::size_t head_length = is_base64 ? base64_length(head_size) : head_size;
  if (head_length > data.size()) fail_short();
  const std::string head =
      is_base64 ? decode_base64(data.substr(0, head_length), head_size) : std::string(data.substr(0, head_length));
  if (head.size() < head_size) fail_short();
  const std::string decoded = is_base64 ? decode_base64(data.substr(head_length)) : std::string();
  std::string_view packed = is_base64 ? std::string_view(decoded) : data.substr(head_length);
  const std::uint64_t block_size = header_word(head, 1), last_size = header_word(head, 2);
  std::string out;
  for (std::uint64_t block = 0; block < num_blocks; ++block) {
    const std::uint64_t packed_size = header_word(head, 3 + block);
    if (packed_size > packed.size()) fail_short();
    const bool is_last = block + 1 == num_blocks;
    const std::uint64_t size = is_last && last_size > 0 ? last_size : block_size;
    if (size > (packed_size + 1) * kMaxInflation) fail(array, fmt::format("a compressed block claims {} bytes", size));
    const std::size_t before = out.size();
    out.resize(before + size);
    uLongf got = size;
    const int status = uncompress(reinterpret_cast<Bytef*>(out.data() + before), &got,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed_size);
    if (status != Z_OK || got != size) fail(array, fmt::format("compressed block {} is damaged", block));
    packed.remove_prefix(packed_size);
  }
  return out;
}

std::string VtkArrays::decode(const XmlElement& array) const {
  const std::string format = array.get("format");
  std::string_view data;
  bool is_base64 = true;
  if (format == "appended") {
    const std::string offset_text = array.get("offset");
    std::uint64_t offset = 0;
    const auto [stop, error] = std::from_chars(offset_text.data(), offset_text.data() + offset_text.size(), offset);
    if (error != std::errc() || offset > appended_.size())
      fail(array, fmt::format("offset '{}' lies outside the appended data", offset_text.substr(0, 40)));
    data = appended_.substr(offset);
    is_base64 = appended_is_base64_;
  } else if (format == "binary") {
    data = trimmed(array.text);
  } else {
    fail(array, fmt::format("format '{}' is none of ascii, binary, appended", format.substr(0, 40)));
  }
  return is_compressed_ ? decode_compressed(array, data, is_base64) : decode_plain(array, data, is_base64);
}

template <class T>
std::vector<T> VtkArrays::values(const XmlElement& array) const {
  std::vector<T> out;
  const std::string format = array.get("format");
  if (format == "ascii" || format.empty()) {
    Cursor text(array.text, path_);
    for (std::string_view token = text.next(); !token.empty(); token = text.next()) {
      double value = 0;
      if constexpr (std::is_integral_v<T>) {
        std::int64_t whole = 0;
        const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), whole);
        if (error == std::errc() && stop == token.data() + token.size()) {
          out.push_back(whole);
          continue;
        }
      }
      if (!parse_number(token, value)) fail(array, fmt::format("'{}' is no number", token.substr(0, 40)));
      if (std::is_integral_v<T> && !is_whole(value))
        fail(array, fmt::format("'{}' is no whole number", token.substr(0, 40)));
      out.push_back(static_cast<T>(value));
    }
    return out;
  }
  const std::string raw = decode(array);
  const std::string type = array.get("type");
  if (type == "Float64") {
    convert<double>(raw, swap_bytes_, out);
  } else if (type == "Float32") {
    convert<float>(raw, swap_bytes_, out);
  } else if (type == "Int64") {
    convert<std::int64_t>(raw, swap_bytes_, out);
  } else if (type == "UInt64") {
    convert<std::uint64_t>(raw, swap_bytes_, out);
  } else if (type == "Int32") {
    convert<std::int32_t>(raw, swap_bytes_, out);
  } else if (type == "UInt32") {
    convert<std::uint32_t>(raw, swap_bytes_, out);
  } else if (type == "Int16") {
    convert<std::int16_t>(raw, swap_bytes_, out);
  } else if (type == "UInt16") {
    convert<std::uint16_t>(raw, swap_bytes_, out);
  } else if (type == "Int8") {
    convert<std::int8_t>(raw, swap_bytes_, out);
  } else if (type == "UInt8") {
    convert<std::uint8_t>(raw, swap_bytes_, out);
  } else {
    fail(array, fmt::format("type '{}' is not supported", type.substr(0, 40)));
  }
  return out;
}

std::vector<double> VtkArrays::reals(const XmlElement& array) const { return values<double>(array); }
std::vector<std::int64_t> VtkArrays::integers(const XmlElement& array) const {
  const std::string format = array.get("format");
  if (array.get("type").starts_with("Float") && format != "ascii" && !format.empty())
    return to_whole(reals(array), [&](const std::string& message) { fail(array, message); });
  return values<std::int64_t>(array);
}

}  // namespace delfront
