// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_output.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "delfront/errors.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

constexpr std::size_t kBlockSize = std::size_t{1} << 20;
constexpr int kLevel = 1;  // fast: grids are read and written often, and higher levels gain little

void append_word(std::string& out, std::uint64_t word) {
  out.append(reinterpret_cast<const char*>(&word), sizeof(word));
}

template <class T>
T at(std::string_view piece, std::size_t i) {
  T value;
  std::memcpy(&value, piece.data() + i * sizeof(T), sizeof(T));
  return value;
}

}  // namespace

VtkOutput::VtkOutput(Output& out, const WriteOptions& options, const std::string& type)
    : out_(out), is_text_(!options.binary), compress_(options.binary && options.compress) {
  out_.text("<?xml version=\"1.0\"?>\n");
  out_.text(fmt::format("<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{}>\n",
                        type, compress_ ? " compressor=\"vtkZLibDataCompressor\"" : ""));
}

void VtkOutput::open(const std::string& tag) { put(fmt::format("{:{}}<{}>\n", "", depth_++, tag)); }

void VtkOutput::close(const std::string& tag) { put(fmt::format("{:{}}</{}>\n", "", --depth_, tag)); }

void VtkOutput::line(const std::string& text) { put(fmt::format("{:{}}{}\n", "", depth_, text)); }

void VtkOutput::put(const std::string& text) {
  if (pending_.empty())
    out_.text(text);
  else
    pending_.back().text_after += text;
}

void VtkOutput::add(const char* type, std::size_t size, const std::string& name, int components,
                    std::vector<std::string_view> pieces) {
  const std::string head =
      fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"", type, escape_xml(name), components);
  if (is_text_) {
    line(head + " format=\"ascii\">");
    write_text(type, size, pieces);
    line("</DataArray>");
    return;
  }
  put(fmt::format("{:{}}{} format=\"appended\" offset=\"", "", depth_, head));
  if (compress_) {
    const std::string& packed = kept_.emplace_back(compress(pieces));
    pending_.push_back({{packed}, packed.size(), "\"/>\n"});
    return;
  }
  std::uint64_t bytes = 0;
  for (std::string_view piece : pieces) bytes += piece.size();
  pending_.push_back({std::move(pieces), bytes, "\"/>\n"});
}

void VtkOutput::write_text(const std::string& type, std::size_t size, const std::vector<std::string_view>& pieces) {
  for (std::string_view piece : pieces) {
    for (std::size_t i = 0; i < piece.size() / size; ++i) {
      if (type == "Float64") {
        out_.real(at<double>(piece, i));
      } else {
        out_.integer(size == 8   ? at<std::int64_t>(piece, i)
                     : size == 4 ? at<std::int32_t>(piece, i)
                                 : at<std::uint8_t>(piece, i));
      }
      out_.character(i % 12 == 11 ? '\n' : ' ');
    }
    out_.character('\n');
  }
}

std::string VtkOutput::compress(const std::vector<std::string_view>& pieces) {
  std::string whole;
  for (std::string_view piece : pieces) whole += piece;
  const std::size_t num_blocks = (whole.size() + kBlockSize - 1) / kBlockSize;
  std::string head, body, packed;
  append_word(head, num_blocks);
  append_word(head, kBlockSize);
  append_word(head, whole.size() % kBlockSize);
  for (std::size_t block = 0; block < num_blocks; ++block) {
    const std::size_t begin = block * kBlockSize, size = std::min(kBlockSize, whole.size() - begin);
    uLongf packed_size = compressBound(size);
    packed.resize(packed_size);
    const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &packed_size,
                                 reinterpret_cast<const Bytef*>(whole.data() + begin), size, kLevel);
    DELFRONT_CHECK(status == Z_OK);
    append_word(head, packed_size);
    body.append(packed.data(), packed_size);
  }
  return head + body;
}

void VtkOutput::finish() {
  std::uint64_t offset = 0;
  for (const Pending& pending : pending_) offset += size_in_file(pending);
  for (const Pending& pending : pending_) {
    offset -= size_in_file(pending);
    out_.text(std::to_string(offset));
    out_.text(pending.text_after);
  }
  if (!is_text_) {
    out_.text(" <AppendedData encoding=\"raw\">\n_");
    for (auto pending = pending_.rbegin(); pending != pending_.rend(); ++pending) {
      if (!compress_) out_.binary(pending->bytes);
      for (std::string_view piece : pending->pieces) out_.text(piece);
    }
    out_.text("\n </AppendedData>\n");
  }
  out_.text("</VTKFile>\n");
}

}  // namespace delfront
