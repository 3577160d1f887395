// SPDX-License-Identifier: Apache-2.0
// STL in both encodings. The size of the file decides which it is, since binary headers often begin with "solid";
// solids of one name are one group; every facet gets three points of its own, as the file has them.
#include <fmt/format.h>

#include <cstring>

#include "delfront/errors.hpp"
#include "delfront/findings.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "mesh/named_groups.hpp"

namespace delfront {

namespace {

constexpr std::size_t kHeaderSize = 80;
constexpr std::size_t kPreamble = 84;
constexpr std::size_t kFacetSize = 50;
constexpr std::string_view kNameMark = "delfront patch: ";
constexpr std::size_t kCheckEvery = std::size_t{1} << 16;  // facets between two looks at the limits

std::uint64_t claimed_facets(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeaderSize, sizeof(count));
  return count;
}

bool is_text(std::string_view bytes) {
  if (bytes.size() >= kPreamble && kPreamble + kFacetSize * claimed_facets(bytes) == bytes.size()) return false;
  const std::string_view start = trimmed(bytes.substr(0, 1024));
  if (start.find('\0') != std::string_view::npos) return false;
  return starts_with_ignoring_case(start, "solid") || starts_with_ignoring_case(start, "facet");
}

/// Facets with a coordinate that is not finite, gathered to be named together.
class BadFacets {
 public:
  bool is_listing() const { return count_ < kMaxListed; }  // finding a line takes time
  void add(std::size_t facet, std::size_t line, const std::array<Point, 3>& corners) {
    if (++count_ <= kMaxListed) {
      list_ += fmt::format("{}{}", count_ > 1 ? ", " : "", facet);
      if (line > 0) list_ += fmt::format(" (line {})", line);
    }
    if (places_.size() >= kMaxPlaces) return;
    Place place{{0, 0, 0}, {static_cast<std::uint32_t>(facet)}};
    for (const Point& corner : corners)
      if (is_finite(corner)) place.at = corner;
    places_.push_back(std::move(place));
  }
  void throw_if_any(const std::string& path, std::size_t num_facets) {
    if (count_ == 0) return;
    throw InputError(
        fmt::format("{}: {} of {} facets have a coordinate that is not a finite number: facet {}{} (counted from 0); "
                    "remove them or export again",
                    path, count_, num_facets, list_, count_ > kMaxListed ? ", …" : ""),
        std::move(places_));
  }

 private:
  static constexpr std::size_t kMaxListed = 5;
  std::size_t count_ = 0;
  std::string list_;
  std::vector<Place> places_;
};

void append_facet(Mesh& mesh, CellBlock& triangles, const std::array<Point, 3>& corners, GroupId group) {
  for (const Point& corner : corners) {
    triangles.vertices.push_back(mesh.points.next_id());
    mesh.points.push_back(corner);
  }
  triangles.group.push_back(group);
}

GroupId add_unnamed(Mesh& mesh) {  // unnamed solids stay apart
  mesh.groups.push_back({"", 2, "", false});
  return GroupId(mesh.groups.size() - 1);
}

/// How many facets to read: the header's word checked against the size of the file.
std::size_t facets_to_read(std::string_view bytes, const std::string& path, Context& context) {
  if (bytes.size() < kPreamble)
    throw InputError(
        fmt::format("{}: neither ASCII STL (does not begin with 'solid') nor binary STL (at least {} "
                    "bytes, the file has {})",
                    path, kPreamble, bytes.size()));
  const std::uint64_t claimed = claimed_facets(bytes);
  const std::size_t present = (bytes.size() - kPreamble) / kFacetSize;
  if (claimed > present)
    throw InputError(
        fmt::format("{}: the binary STL header says {} facets ({} bytes), but the file has {} bytes, "
                    "room for {}; it is truncated or damaged, export it again",
                    path, claimed, kPreamble + kFacetSize * claimed, bytes.size(), present));
  if (claimed == 0 && present > 0) {
    context.warn(
        fmt::format("{}: the binary STL header says 0 facets; {} were read by the size of the file", path, present));
    return present;
  }
  if (kPreamble + kFacetSize * claimed < bytes.size())
    context.warn(fmt::format("{}: {} bytes after the {} facets of the header were ignored", path,
                             bytes.size() - kPreamble - kFacetSize * claimed, claimed));
  return claimed;
}

Mesh read_binary(std::string_view bytes, const std::string& path, Context& context) {
  const std::size_t num_facets = facets_to_read(bytes, path, context);
  if (num_facets >= Id<VertexTag>::kNone / 3)
    throw InputError(fmt::format("{}: {} facets are more than 2^32 / 3", path, num_facets));
  std::string_view name = bytes.substr(0, kHeaderSize);
  name = name.starts_with(kNameMark) ? trimmed(name.substr(kNameMark.size())) : std::string_view();
  Mesh mesh;
  CellBlock& triangles = mesh.block(CellType::triangle);
  mesh.points.reserve(3 * num_facets);
  triangles.vertices.reserve(3 * num_facets);
  triangles.group.reserve(num_facets);
  name = name.substr(0, name.find('\0'));
  const GroupId group = name.empty() ? add_unnamed(mesh) : mesh.add_group(2, std::string(name));
  BadFacets bad;
  for (std::size_t facet = 0; facet < num_facets; ++facet) {
    if (facet % kCheckEvery == 0) context.check_limits();
    float raw[9];
    std::memcpy(raw, bytes.data() + kPreamble + facet * kFacetSize + 12, sizeof(raw));
    std::array<Point, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = {raw[3 * k], raw[3 * k + 1], raw[3 * k + 2]};
    if (!is_finite(corners[0]) || !is_finite(corners[1]) || !is_finite(corners[2])) bad.add(facet, 0, corners);
    append_facet(mesh, triangles, corners, group);
  }
  bad.throw_if_any(path, num_facets);
  return mesh;
}

/// The ASCII grammar as one state: which solid, which facet, how many of its corners.
class TextReader {
 public:
  TextReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path), context_(context), patches_(mesh_, 2) {}

  Mesh read() {
    for (std::string_view word = cursor_.next(); !word.empty(); word = cursor_.next()) take(word);
    if (in_facet_) fail_truncated();
    if (in_solid_ && num_facets_ > 0)
      context_.warn(fmt::format("{}: the last 'endsolid' is missing; the file may be truncated", cursor_.path()));
    bad_.throw_if_any(cursor_.path(), num_facets_);
    return std::move(mesh_);
  }

 private:
  void take(std::string_view word) {
    if (equal_ignoring_case(word, "vertex")) {
      take_vertex();
    } else if (equal_ignoring_case(word, "facet")) {
      begin_facet();
    } else if (equal_ignoring_case(word, "endloop")) {
      if (!in_facet_ || num_corners_ != 3)
        cursor_.fail(fmt::format("facet {} has {} vertices, not 3", num_facets_, num_corners_));
    } else if (equal_ignoring_case(word, "endfacet")) {
      end_facet();
    } else if (equal_ignoring_case(word, "solid")) {
      if (in_facet_) cursor_.fail(fmt::format("'solid' in the middle of facet {}", num_facets_));
      const std::string_view name = cursor_.rest_of_line();
      group_ = name.empty() ? add_unnamed(mesh_) : patches_(name);
      in_solid_ = true;
    } else if (equal_ignoring_case(word, "endsolid")) {
      if (in_facet_) cursor_.fail(fmt::format("'endsolid' in the middle of facet {}", num_facets_));
      cursor_.rest_of_line();
      in_solid_ = false;
    } else if (equal_ignoring_case(word, "color")) {
      cursor_.skip_line();
    } else if (!equal_ignoring_case(word, "outer") && !equal_ignoring_case(word, "loop")) {
      cursor_.fail(
          fmt::format("'{}' is no word of an STL file; the file is damaged or of another format", word.substr(0, 40)));
    }
  }

  [[noreturn]] void fail_truncated() const {
    cursor_.fail(
        fmt::format("the file ends in the middle of a facet, after {} whole ones; it is truncated, export it "
                    "again",
                    num_facets_));
  }

  void begin_facet() {
    if (in_facet_) cursor_.fail(fmt::format("'facet' in the middle of facet {}: 'endfacet' is missing", num_facets_));
    if (!group_.is_valid()) group_ = add_unnamed(mesh_);
    if (num_facets_ % kCheckEvery == 0) context_.check_limits();
    in_facet_ = true;
    num_corners_ = 0;
    begin_ = cursor_.position();
    cursor_.skip_line();  // the normal is not used: the corners' order says it, and many files hold nonsense here
  }

  void take_vertex() {
    if (!in_facet_) cursor_.fail("'vertex' outside a facet");
    Point p;
    for (int k = 0; k < 3; ++k) {
      if (cursor_.at_end()) fail_truncated();
      p[k] = cursor_.number("coordinate of a vertex");
    }
    if (num_corners_ < 3) corners_[num_corners_] = p;
    ++num_corners_;
  }

  void end_facet() {
    if (!in_facet_ || num_corners_ != 3)
      cursor_.fail(fmt::format("facet {} has {} vertices, not 3", num_facets_, in_facet_ ? num_corners_ : 0));
    if (!is_finite(corners_[0]) || !is_finite(corners_[1]) || !is_finite(corners_[2]))
      bad_.add(num_facets_, bad_.is_listing() ? cursor_.line_of(begin_) : 0, corners_);
    append_facet(mesh_, mesh_.block(CellType::triangle), corners_, group_);
    ++num_facets_;
    in_facet_ = false;
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  NamedGroups patches_;
  GroupId group_;
  BadFacets bad_;
  std::array<Point, 3> corners_;
  std::size_t num_corners_ = 0, num_facets_ = 0, begin_ = 0;
  bool in_facet_ = false, in_solid_ = false;
};

}  // namespace

Mesh read_stl(std::string_view bytes, const std::string& path, Context& context) {
  Mesh mesh = is_text(bytes) ? TextReader(bytes, path, context).read() : read_binary(bytes, path, context);
  if (mesh.num_cells(CellType::triangle) == 0)
    throw InputError(fmt::format("{}: the STL file has no facets; export it again", path));
  return mesh;
}

}  // namespace delfront
