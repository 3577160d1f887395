// SPDX-License-Identifier: Apache-2.0
// Layout (netCDF classic format specification): "CDF" and the version; number of records; dimensions, attributes and
// variables, each a tag and a count, (0, 0) where there are none; then the values of each variable, padded to four
// bytes. Counts take 4 bytes, in CDF-5 8; offsets take 8.
#include <bit>
#include <cstring>

#include "io/cursor.hpp"
#include "io/exodus/netcdf.hpp"

namespace delfront {

namespace {

constexpr std::uint64_t kMostOfNarrow = 0xfffffffcu;  // bytes of a variable
constexpr std::uint32_t kDimensions = 10, kVariables = 11, kAttributes = 12;

std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }

template <class T>
T big_endian(T value) {
  return std::endian::native == std::endian::big ? value : Cursor::swapped(value);
}

template <class T>
void append(std::string& to, T value) {
  const T turned = big_endian(value);
  char raw[sizeof(T)];
  std::memcpy(raw, &turned, sizeof(T));
  to.append(raw, sizeof(T));
}

std::uint64_t size_of(NetcdfWriter::Type type) {
  return type == NetcdfWriter::Type::text ? 1 : type == NetcdfWriter::Type::real ? 8 : 4;
}

}  // namespace

std::size_t NetcdfWriter::add_dimension(const std::string& name, std::uint64_t length) {
  dimensions_.push_back({name, length});
  return dimensions_.size() - 1;
}

void NetcdfWriter::add_attribute(const std::string& name, const std::string& text) {
  attributes_.push_back({name, Type::text, text.size(), text});
}

void NetcdfWriter::add_attribute(const std::string& name, std::int32_t value) {
  attributes_.push_back({name, Type::integer, 1, ""});
  append(attributes_.back().bytes, value);
}

void NetcdfWriter::add_attribute(const std::string& name, float value) {
  attributes_.push_back({name, Type::single_real, 1, ""});
  append(attributes_.back().bytes, value);
}

void NetcdfWriter::add_variable(const std::string& name, Type type, std::vector<std::size_t> dimensions, Put put,
                                std::pair<std::string, std::string> attribute) {
  Variable variable{name, type, std::move(dimensions), std::move(put), {}};
  if (!attribute.first.empty())
    variable.attributes.push_back({attribute.first, Type::text, attribute.second.size(), attribute.second});
  variable.size = size_of(type);
  for (const std::size_t d : variable.dimensions) {
    variable.is_of_records = variable.is_of_records || dimensions_[d].length == 0;
    if (dimensions_[d].length > 0) variable.size *= dimensions_[d].length;
  }
  is_wide_ = is_wide_ || variable.size > kMostOfNarrow;
  variables_.push_back(std::move(variable));
}

void NetcdfWriter::append_count(std::string& to, std::uint64_t count) const {
  is_wide_ ? append(to, count) : append(to, static_cast<std::uint32_t>(count));
}

void NetcdfWriter::append_name(std::string& to, const std::string& name) const {
  append_count(to, name.size());
  to += name;
  to.append(padded(name.size()) - name.size(), '\0');
}

void NetcdfWriter::append_attributes(std::string& to, const std::vector<Attribute>& attributes) const {
  append(to, attributes.empty() ? 0 : kAttributes);
  append_count(to, attributes.size());
  for (const Attribute& attribute : attributes) {
    append_name(to, attribute.name);
    append(to, static_cast<std::uint32_t>(attribute.type));
    append_count(to, attribute.count);
    to += attribute.bytes;
    to.append(padded(attribute.bytes.size()) - attribute.bytes.size(), '\0');
  }
}

std::string NetcdfWriter::header(std::uint64_t first_offset) const {
  std::string head = "CDF";
  head += is_wide_ ? '\5' : '\2';
  append_count(head, 0);
  append(head, kDimensions);
  append_count(head, dimensions_.size());
  for (const Dimension& dimension : dimensions_) {
    append_name(head, dimension.name);
    append_count(head, dimension.length);
  }
  append_attributes(head, attributes_);
  append(head, kVariables);
  append_count(head, variables_.size());
  std::uint64_t end = first_offset;
  for (const Variable& variable : variables_)
    if (!variable.is_of_records) end += padded(variable.size);
  std::uint64_t offset = first_offset;
  for (const Variable& variable : variables_) {
    append_name(head, variable.name);
    append_count(head, variable.dimensions.size());
    for (const std::size_t d : variable.dimensions) append_count(head, d);
    append_attributes(head, variable.attributes);
    append(head, static_cast<std::uint32_t>(variable.type));
    append_count(head, padded(variable.size));
    append(head, variable.is_of_records ? end : offset);
    (variable.is_of_records ? end : offset) += padded(variable.size);
  }
  return head;
}

void NetcdfWriter::write() {
  out_.text(header(header(0).size()));
  for (const Variable& variable : variables_) {
    if (variable.is_of_records) continue;
    variable.put(*this);
    constexpr std::string_view kZeros("\0\0\0\0", 4);
    out_.text(kZeros.substr(0, padded(variable.size) - variable.size));
  }
}

void NetcdfWriter::put(double value) { out_.binary(big_endian(value)); }
void NetcdfWriter::put(std::int32_t value) { out_.binary(big_endian(value)); }

void NetcdfWriter::put_text(std::string_view text, std::size_t width) {
  text = text.substr(0, width);
  out_.text(text);
  for (std::size_t i = text.size(); i < width; ++i) out_.character('\0');
}

}  // namespace delfront
