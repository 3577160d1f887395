// SPDX-License-Identifier: Apache-2.0
// PLY (ASCII, binary of both byte orders): x, y, z of "vertex", the list of "face"; other elements and properties are
// skipped. Patches: an integer face property `patch_id` and comments "patch_name <id> <name>", as write_ply makes them.
#include <fmt/format.h>

#include <bit>
#include <charconv>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Scalar type = Scalar::float32;
  bool is_list = false;
  Scalar count_type = Scalar::uint8;
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::int8:
    case Scalar::uint8:
      return 1;
    case Scalar::int16:
    case Scalar::uint16:
      return 2;
    case Scalar::float64:
      return 8;
    default:
      return 4;
  }
}

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path), context_(context) {}

  Mesh read() {
    read_header();
    mesh_.groups.push_back({"", 2, "", false});
    for (const Element& element : elements_) read_element(element);
    if (corners_.empty()) throw InputError(fmt::format("{}: the PLY file has no faces", cursor_.path()));
    check_indices();
    add_faces();
    check_finite(mesh_, cursor_.path());
    return std::move(mesh_);
  }

 private:
  void read_header() {
    if (cursor_.next() != "ply") cursor_.fail("a PLY file begins with 'ply'");
    for (std::string_view word = cursor_.next(); word != "end_header"; word = cursor_.next()) {
      if (word.empty()) cursor_.fail("the file ends inside the header (no 'end_header'); it is truncated");
      if (word == "format") {
        take_format(cursor_.next());
      } else if (word == "comment" || word == "obj_info") {
        take_comment(cursor_.rest_of_line());
        continue;
      } else if (word == "element") {
        Element element;
        element.name = cursor_.next();
        element.count = cursor_.integer("number of elements");
        elements_.push_back(std::move(element));
      } else if (word == "property") {
        take_property();
      } else {
        cursor_.fail(fmt::format("'{}' is no word of a PLY header", word.substr(0, 40)));
      }
      cursor_.skip_line();
    }
    cursor_.skip_line();
  }

  void take_format(std::string_view format) {
    if (format == "ascii") {
      is_text_ = true;
    } else if (format == "binary_little_endian" || format == "binary_big_endian") {
      is_text_ = false;
      const bool is_little = format == "binary_little_endian";
      cursor_.swap_bytes = is_little != (std::endian::native == std::endian::little);
    } else {
      cursor_.fail(fmt::format("'{}' is no PLY format; ascii, binary_little_endian and binary_big_endian are",
                               format.substr(0, 40)));
    }
  }

  void take_comment(std::string_view text) {
    constexpr std::string_view kMark = "patch_name ";
    if (!text.starts_with(kMark)) return;
    text.remove_prefix(kMark.size());
    std::int64_t id = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc()) return;
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    patch_names_.emplace_back(id, std::string(trimmed(text)));
  }

  Scalar scalar(std::string_view word) {
    struct Name {
      std::string_view name;
      Scalar type;
    };
    static constexpr Name kNames[] = {
        {"char", Scalar::int8},      {"int8", Scalar::int8},       {"uchar", Scalar::uint8},
        {"uint8", Scalar::uint8},    {"short", Scalar::int16},     {"int16", Scalar::int16},
        {"ushort", Scalar::uint16},  {"uint16", Scalar::uint16},   {"int", Scalar::int32},
        {"int32", Scalar::int32},    {"uint", Scalar::uint32},     {"uint32", Scalar::uint32},
        {"float", Scalar::float32},  {"float32", Scalar::float32}, {"double", Scalar::float64},
        {"float64", Scalar::float64}};
    for (const Name& known : kNames)
      if (known.name == word) return known.type;
    cursor_.fail(fmt::format("'{}' is no PLY type", word.substr(0, 40)));
  }

  void take_property() {
    if (elements_.empty()) cursor_.fail("a property before the first element");
    Property property;
    std::string_view type = cursor_.next();
    if (type == "list") {
      property.is_list = true;
      property.count_type = scalar(cursor_.next());
      type = cursor_.next();
    }
    property.type = scalar(type);
    property.name = cursor_.next();
    elements_.back().properties.push_back(std::move(property));
  }

  double value(Scalar type) {
    if (is_text_) return cursor_.number("a property's value");
    switch (type) {
      case Scalar::int8:
        return cursor_.binary<std::int8_t>("the elements");
      case Scalar::uint8:
        return cursor_.binary<std::uint8_t>("the elements");
      case Scalar::int16:
        return cursor_.binary<std::int16_t>("the elements");
      case Scalar::uint16:
        return cursor_.binary<std::uint16_t>("the elements");
      case Scalar::int32:
        return cursor_.binary<std::int32_t>("the elements");
      case Scalar::uint32:
        return cursor_.binary<std::uint32_t>("the elements");
      case Scalar::float32:
        return cursor_.binary<float>("the elements");
      case Scalar::float64:
        return cursor_.binary<double>("the elements");
    }
    return 0;
  }

  /// Bytes that one element takes at least: what bounds its count by the size of the file.
  std::size_t least_size(const Element& element) const {
    std::size_t size = 0;
    for (const Property& property : element.properties)
      size += is_text_ ? 2 : size_of(property.is_list ? property.count_type : property.type);
    return size;
  }

  void read_element(const Element& element) {
    if (element.properties.empty()) return;
    const std::size_t n = cursor_.checked_count(element.count, ("number of '" + element.name + "' elements").c_str(),
                                                least_size(element));
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    if (is_vertex) {
      int found = 0;
      for (const Property& p : element.properties)
        found += !p.is_list && (p.name == "x" || p.name == "y" || p.name == "z");
      if (found != 3) cursor_.fail_in_binary("the 'vertex' element needs the properties x, y and z");
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      if (is_vertex) {
        read_vertex(element);
      } else if (is_face) {
        read_face(element, i);
      } else {
        for (const Property& property : element.properties) skip(property);
      }
    }
  }

  void skip(const Property& property) {
    const std::size_t n = property.is_list ? list_size(property) : 1;
    for (std::size_t k = 0; k < n; ++k) value(property.type);
  }

  std::size_t list_size(const Property& property) {
    const double n = value(property.count_type);
    if (!(n >= 0 && n < 4e9)) cursor_.fail_in_binary(fmt::format("a list of {:g} entries", n));
    return cursor_.checked_count(static_cast<std::int64_t>(n), "length of a list",
                                 is_text_ ? 2 : size_of(property.type));
  }

  void read_vertex(const Element& element) {
    Point p;
    for (const Property& property : element.properties) {
      if (property.is_list || property.name.size() != 1 || property.name[0] < 'x' || property.name[0] > 'z')
        skip(property);
      else
        p[property.name[0] - 'x'] = value(property.type);
    }
    mesh_.points.push_back(p);
  }

  void read_face(const Element& element, std::size_t face) {
    std::size_t corners = 0;
    std::int64_t patch = -1;
    for (const Property& property : element.properties) {
      if (property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index")) {
        corners = read_corners(property, face);
      } else if (!property.is_list && property.name == "patch_id") {
        const double id = value(property.type);
        patch = id >= 0 && id < 2e9 ? static_cast<std::int64_t>(id) : -1;
      } else {
        skip(property);
      }
    }
    if (corners < 3)
      cursor_.fail_in_binary(fmt::format("face {} has {} corners; three or more are needed", face, corners));
    if (offsets_.empty()) offsets_.push_back(0);
    offsets_.push_back(corners_.size());
    patches_.push_back(patch);
  }

  std::size_t read_corners(const Property& property, std::size_t face) {
    const std::size_t n = list_size(property);
    for (std::size_t k = 0; k < n; ++k) {
      const double index = value(property.type);
      if (!(index >= 0 && index < 4294967295.0))
        cursor_.fail_in_binary(fmt::format("face {} has the vertex {:g}, out of range", face, index));
      corners_.push_back(VertexId(static_cast<std::size_t>(index)));
    }
    return n;
  }

  void check_indices() const {
    for (std::size_t face = 0; face + 1 < offsets_.size(); ++face)
      for (std::size_t k = offsets_[face]; k < offsets_[face + 1]; ++k)
        if (corners_[k].index() >= mesh_.points.size())
          throw InputError(fmt::format("{}: face {} has the vertex {}, but the file has {} vertices (counted from 0)",
                                       cursor_.path(), face, corners_[k].index(), mesh_.points.size()));
  }

  void add_faces() {
    const bool has_patches = std::any_of(patches_.begin(), patches_.end(), [](std::int64_t id) { return id >= 0; });
    if (has_patches || !patch_names_.empty()) mesh_.groups.clear();
    TagGroups groups(mesh_);
    for (const auto& [id, name] : patch_names_) groups.name(2, id, name);
    for (std::size_t face = 0; face + 1 < offsets_.size(); ++face) {
      const GroupId group = patches_[face] >= 0 ? groups(2, patches_[face]) : has_patches ? GroupId() : GroupId(0);
      add_face(mesh_, {corners_.data() + offsets_[face], offsets_[face + 1] - offsets_[face]}, group);
    }
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  bool is_text_ = true;
  std::vector<Element> elements_;
  std::vector<std::pair<std::int64_t, std::string>> patch_names_;
  std::vector<VertexId> corners_;
  std::vector<std::size_t> offsets_;
  std::vector<std::int64_t> patches_;
};

}  // namespace

Mesh read_ply(std::string_view bytes, const std::string& path, Context& context) {
  return PlyReader(bytes, path, context).read();
}

}  // namespace delfront
