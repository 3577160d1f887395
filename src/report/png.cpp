// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <new>

#include "report/canvas.hpp"

namespace delfront {
namespace {

std::string big_endian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 255);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(static_cast<std::uint32_t>(sum));
}

}  // namespace

std::string to_png(int width, int height, const std::vector<std::uint8_t>& bytes) {
  const std::size_t row = 4 * std::size_t(width);
  std::string rows;
  for (std::size_t y = 0; y < std::size_t(height); ++y) {
    rows += '\2';  // filter "up": differences from the row above, which are mostly 0
    for (std::size_t i = 0; i < row; ++i)
      rows += static_cast<char>(bytes[y * row + i] - (y > 0 ? bytes[(y - 1) * row + i] : 0));
  }
  std::string packed(compressBound(rows.size()), '\0');
  uLongf size = packed.size();
  const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(rows.data()), rows.size(), Z_BEST_COMPRESSION);
  if (status != Z_OK) throw std::bad_alloc();
  packed.resize(size);
  const std::string header = big_endian(std::uint32_t(width)) + big_endian(std::uint32_t(height)) +
                             std::string("\x08\x06\0\0\0", 5);  // 8 bits, colours and alpha
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", packed) + chunk("IEND", "");
}

}  // namespace delfront
