// SPDX-License-Identifier: Apache-2.0
// The layout stands in netcdf_writer.cpp. A variable is read only where all of it lies within the file; of records
// those that the file announces.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "delfront/errors.hpp"
#include "io/cursor.hpp"
#include "io/exodus/netcdf.hpp"
#include "io/whole_numbers.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kDimensions = 10, kVariables = 11, kAttributes = 12;
constexpr std::uint32_t kText = 2, kSingleReal = 5, kReal = 6;
constexpr std::size_t kSizes[12] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};  // bytes by number of type
constexpr std::uint64_t kMost = std::uint64_t{1} << 48;

struct Variable {
  std::uint32_t type = 0;
  std::vector<std::uint64_t> shape;
  std::uint64_t count = 1;  ///< values of all records
  std::uint64_t begin = 0;
  bool is_of_records = false;
  std::map<std::string, std::string> texts;
};

class Classic : public NetcdfSource {
 public:
  Classic(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {
    const int version = bytes.size() > 4 ? bytes[3] : 0;
    if (!bytes.starts_with("CDF") || (version != 1 && version != 2 && version != 5))
      fail("this is no netCDF file of versions 1, 2, 5");
    count_size_ = version == 5 ? 8 : 4;
    offset_size_ = version == 1 ? 4 : 8;
    at_ = 4;
    num_records_ = count();
    if (num_records_ == (count_size_ == 4 ? 0xffffffffu : std::numeric_limits<std::uint64_t>::max()))
      fail("its number of records is not known; copy it with nccopy");
    read_dimensions();
    read_attributes(texts_);
    read_variables();
  }

  std::uint64_t dimension(const std::string& name) const override {
    for (std::size_t d = 0; d < lengths_.size(); ++d)
      if (names_[d] == name) return lengths_[d] > 0 ? lengths_[d] : num_records_;
    return 0;
  }
  bool has(const std::string& variable) const override { return variables_.contains(variable); }
  std::vector<std::uint64_t> shape(const std::string& variable) const override { return find(variable).shape; }

  std::vector<double> reals(const std::string& name) const override { return values<double>(name); }
  std::vector<std::int64_t> integers(const std::string& name) const override {
    const std::uint32_t type = find(name).type;
    if (type != kSingleReal && type != kReal) return values<std::int64_t>(name);
    return to_whole(values<double>(name),
                    [&](const std::string& message) { fail(fmt::format("variable {}: {}", name, message)); });
  }

  std::string text(const std::string& name) const override {
    const Variable& variable = find(name);
    if (variable.type != kText) fail(fmt::format("variable {} holds no text", name));
    std::string all;
    for_each_piece(name, variable, [&](std::string_view piece) { all += piece; });
    return all;
  }

  std::string attribute(const std::string& variable, const std::string& name) const override {
    const auto found = variable.empty() ? variables_.end() : variables_.find(variable);
    if (!variable.empty() && found == variables_.end()) return "";
    const auto& texts = variable.empty() ? texts_ : found->second.texts;
    const auto text = texts.find(name);
    return text == texts.end() ? "" : text->second;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}: byte {}: {}", path_, at_, message));
  }

  std::uint64_t number(std::size_t size) {
    if (bytes_.size() - at_ < size) fail("the file ends within its header; it is truncated");
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(bytes_[at_ + i]);
    at_ += size;
    return value;
  }
  std::uint64_t count() { return number(count_size_); }

  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size() - at_) fail(fmt::format("{} bytes are announced and not there; it is truncated", size));
    const std::string_view taken = bytes_.substr(at_, size);
    at_ += static_cast<std::size_t>(std::min<std::uint64_t>((size + 3) / 4 * 4, bytes_.size() - at_));
    return taken;
  }
  std::string name() { return std::string(take(count())); }

  /// A tag and how many things follow, each four bytes at least.
  std::uint64_t list(std::uint32_t wanted) {
    const std::uint64_t tag = number(4), n = count();
    if ((tag != wanted || n == 0) && (tag != 0 || n != 0)) fail("a list of the header is damaged");
    if (n > (bytes_.size() - at_) / 4) fail(fmt::format("{} entries are announced and not there", n));
    return n;
  }

  void read_dimensions() {
    for (std::uint64_t n = list(kDimensions); n > 0; --n) {
      names_.push_back(name());
      lengths_.push_back(count());
    }
  }

  std::size_t size_of(std::uint64_t type) const {
    if (type < 1 || type >= std::size(kSizes)) fail(fmt::format("type {} is not known", type));
    return kSizes[type];
  }

  void read_attributes(std::map<std::string, std::string>& texts) {
    for (std::uint64_t n = list(kAttributes); n > 0; --n) {
      const std::string own = name();
      const std::uint64_t type = number(4), length = count();
      if (length > bytes_.size()) fail("an attribute is longer than the file");
      const std::string_view raw = take(length * size_of(type));
      if (type == kText) texts[own] = std::string(raw.substr(0, std::min(raw.find('\0'), raw.size())));
    }
  }

  void read_variables() {
    std::uint64_t num_of_records = 0, only_size = 0, total = 0;
    for (std::uint64_t n = list(kVariables); n > 0; --n) {
      const std::string own = name();
      Variable variable;
      const std::uint64_t rank = count();
      if (rank > (bytes_.size() - at_) / count_size_) fail("a variable has more dimensions than the file");
      std::uint64_t of_one_record = 1;
      for (std::uint64_t k = 0; k < rank; ++k) {
        const std::uint64_t d = count();
        if (d >= lengths_.size()) fail(fmt::format("variable {}: dimension {} is not there", own, d));
        if (lengths_[d] == 0 && k > 0) fail(fmt::format("variable {}: records are not its first dimension", own));
        variable.is_of_records = variable.is_of_records || lengths_[d] == 0;
        const std::uint64_t extent = lengths_[d] > 0 ? lengths_[d] : num_records_;
        variable.shape.push_back(extent);
        for (std::uint64_t* size : {&variable.count, lengths_[d] > 0 ? &of_one_record : nullptr}) {
          if (!size) continue;
          if (extent > kMost || *size > kMost / std::max<std::uint64_t>(extent, 1))
            fail(fmt::format("variable {}: its size cannot be", own));
          *size *= extent;
        }
      }
      read_attributes(variable.texts);
      variable.type = static_cast<std::uint32_t>(number(4));
      only_size = of_one_record * size_of(variable.type);
      count();  // its size, which the dimensions say too
      variable.begin = number(offset_size_);
      total += variable.count * size_of(variable.type);  // no two share bytes
      if (total > bytes_.size())
        fail(fmt::format("variable {} and those before it take {} bytes, the file has {}; it is truncated or damaged",
                         own, total, bytes_.size()));
      if (variable.is_of_records) {
        ++num_of_records;
        record_size_ += (only_size + 3) / 4 * 4;
        if (num_of_records == 1) size_if_only_ = only_size;
      }
      variables_[own] = std::move(variable);
    }
    if (num_of_records == 1) record_size_ = size_if_only_;  // records of one variable are not padded
  }

  const Variable& find(const std::string& name) const {
    const auto found = variables_.find(name);
    if (found == variables_.end()) fail(fmt::format("variable {} is not there", name));
    return found->second;
  }

  /// The bytes of a variable, by record. Records have a byte at least, so that the loop ends with the file.
  template <class Function>
  void for_each_piece(const std::string& name, const Variable& variable, Function&& take_piece) const {
    const std::uint64_t num = variable.is_of_records ? num_records_ : 1;
    if (variable.count == 0) return;
    const std::uint64_t size = variable.count / num * kSizes[variable.type];
    for (std::uint64_t i = 0; i < num; ++i) {
      const std::uint64_t begin = variable.begin + i * record_size_;
      if (begin > bytes_.size() || size > bytes_.size() - begin)
        fail(fmt::format("variable {} lies beyond the end of the file ({} bytes); it is truncated or damaged", name,
                         bytes_.size()));
      take_piece(bytes_.substr(begin, size));
    }
  }

  template <class Stored, class T>
  static void convert(std::string_view raw, std::vector<T>& to) {
    for (std::size_t i = 0; i + sizeof(Stored) <= raw.size(); i += sizeof(Stored)) {
      Stored value;
      std::memcpy(&value, raw.data() + i, sizeof(Stored));
      if (std::endian::native == std::endian::little) value = Cursor::swapped(value);
      to.push_back(static_cast<T>(value));
    }
  }

  template <class T>
  std::vector<T> values(const std::string& name) const {
    const Variable& variable = find(name);
    if (variable.type == kText) fail(fmt::format("variable {} holds text where numbers should stand", name));
    std::vector<T> all;
    for_each_piece(name, variable, [&](std::string_view raw) {
      switch (variable.type) {
        case 1:
          return convert<std::int8_t>(raw, all);
        case 3:
          return convert<std::int16_t>(raw, all);
        case 4:
          return convert<std::int32_t>(raw, all);
        case kSingleReal:
          return convert<float>(raw, all);
        case kReal:
          return convert<double>(raw, all);
        case 7:
          return convert<std::uint8_t>(raw, all);
        case 8:
          return convert<std::uint16_t>(raw, all);
        case 9:
          return convert<std::uint32_t>(raw, all);
        case 10:
          return convert<std::int64_t>(raw, all);
        default:
          return convert<std::uint64_t>(raw, all);
      }
    });
    return all;
  }

  std::string_view bytes_;
  std::string path_;
  std::size_t at_ = 0, count_size_ = 4, offset_size_ = 8;
  std::uint64_t num_records_ = 0, record_size_ = 0, size_if_only_ = 0;
  std::vector<std::string> names_;
  std::vector<std::uint64_t> lengths_;
  std::map<std::string, std::string> texts_;
  std::map<std::string, Variable> variables_;
};

}  // namespace

std::unique_ptr<NetcdfSource> open_netcdf_classic(std::string_view bytes, const std::string& path) {
  return std::make_unique<Classic>(bytes, path);
}

}  // namespace delfront
