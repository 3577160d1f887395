// SPDX-License-Identifier: Apache-2.0
// Ansys Fluent mesh and case files, text and binary sections: points (10), cells (12), faces with their two cells (13),
// names of zones (39, 45). Cells are put together from their faces as those of OpenFOAM are. Zones of faces inside are
// patches only where they are more than "interior". Where files turn faces the other way than Fluent's manual says, the
// volume of the first cell shows it.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/fluent.hpp"
#include "io/fluent_text.hpp"
#include "io/foam_cells.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;
constexpr std::uint32_t kNone = 0xffffffffu;
constexpr std::int64_t kMostNumbers = 0xfffffffe;

struct RawFace {
  std::size_t first_corner;
  std::uint32_t num_corners, right, left;  // cells from 0, kNone outside
  std::int64_t zone;
};
struct CellZone {
  std::int64_t zone, first, last;
};

class FluentReader {
 public:
  FluentReader(std::string_view bytes, const std::string& path, Context& context)
      : text_(bytes, path), context_(context) {}

  Mesh read() {
    FluentSection section;
    while (text_.next(section)) {
      context_.check_limits();
      take(section);
    }
    if (faces_.empty()) throw InputError(fmt::format("{}: the Fluent file has no faces (section 13)", path()));
    check_finite(mesh_, path());
    find_cells();
    mesh_.dimension == 2 ? add_plane_cells() : add_volume_cells();
    add_patches();
    name_groups();
    if (own_.empty()) mark_inner_groups(mesh_);
    return std::move(mesh_);
  }

 private:
  const std::string& path() { return text_.cursor().path(); }
  [[noreturn]] void fail(const FluentSection& section, const std::string& message) {
    text_.cursor().fail_at(section.begin, fmt::format("section {}: {}", section.index, message));
  }

  void take(const FluentSection& section) {
    switch (section.index) {
      case 0:
        take_comment(section.text);
        break;
      case 2:
        mesh_.dimension = static_cast<int>(text_.hexadecimal("dimension"));
        if (mesh_.dimension != 2 && mesh_.dimension != 3) fail(section, "the dimension is neither 2 nor 3");
        break;
      case 10:
        if (has_body(section)) return take_points(section);
        break;
      case 12:
        return take_cells(section);
      case 13:
        if (has_body(section)) return take_faces(section);
        break;
      case 39:
      case 45:
        take_name(section);
        break;
      case 58:
      case 59:
        fail(section, "grids with hanging nodes are not supported; export a conforming grid");
      default:
        break;
    }
    text_.skip(section);
  }

  /// Heads with zone 0 declare the totals.
  bool has_body(const FluentSection& section) const {
    return section.body != 0 && section.numbers.size() >= 3 && section.numbers[0] > 0;
  }

  void take_comment(std::string_view comment) {
    constexpr std::string_view kMark = "#delfront ";
    NamedNumber named;
    if (comment.starts_with(kMark) && parse_name_line(comment.substr(kMark.size()), named)) own_[named.number] = named;
  }

  void take_name(const FluentSection& section) {
    if (section.words.size() < 3) return;
    std::int64_t zone = 0;  // decimal here, unlike elsewhere
    double value = 0;
    if (parse_number(section.words[0], value) && value > 0 && value < 1e9) zone = static_cast<std::int64_t>(value);
    types_[zone] = section.words[1];
    names_[zone] = section.words[2];
  }

  void end_body(const FluentSection& section) {
    if (section.form != 0) return text_.skip(section);
    if (text_.cursor().at_end() || text_.cursor().bytes()[text_.cursor().position()] != ')')
      fail(section, "it holds more than its head says");
    text_.cursor().move_to(text_.cursor().position() + 1);
    if (!text_.cursor().at_end() && text_.cursor().bytes()[text_.cursor().position()] == ')')
      text_.cursor().move_to(text_.cursor().position() + 1);
    else
      fail(section, "it is not closed");
  }

  std::size_t count_of(const FluentSection& section, const char* what, std::size_t bytes_each) {
    const std::int64_t first = section.numbers[1], last = section.numbers[2];
    if (first < 1 || last < first - 1 || last > kMostNumbers)
      fail(section, fmt::format("numbers {} to {}", first, last));
    const auto n = static_cast<std::uint64_t>(last - first + 1);
    if (n > text_.cursor().left() / bytes_each + 1)
      fail(section, fmt::format("{} {}: only {} bytes follow; the file is truncated or damaged", what, n,
                                text_.cursor().left()));
    return static_cast<std::size_t>(n);
  }

  void take_points(const FluentSection& section) {
    const int d = section.numbers.size() > 4 && (section.numbers[4] == 2 || section.numbers[4] == 3)
                      ? static_cast<int>(section.numbers[4])
                      : mesh_.dimension;
    const auto real_bytes = static_cast<std::size_t>(section.form == 0 ? 2 : section.form == 2 ? 4 : 8);
    const std::size_t n = count_of(section, "points", static_cast<std::size_t>(d) * real_bytes);
    if (static_cast<std::size_t>(section.numbers[1]) != mesh_.points.size() + 1)
      fail(section, fmt::format("points begin with {}, and {} were before; sections must follow in order",
                                section.numbers[1], mesh_.points.size()));
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      Point p;
      for (int k = 0; k < d; ++k) p[k] = real(section);
      mesh_.points.push_back(p);
    }
    end_body(section);
  }

  /// In text the last number may touch the parenthesis.
  double real(const FluentSection& section) {
    Cursor& cursor = text_.cursor();
    if (section.form == 2) return static_cast<double>(cursor.binary<float>("points"));
    if (section.form == 3) return cursor.binary<double>("points");
    if (cursor.at_end()) fail(section, "it ends within the points; the file is truncated");
    const std::size_t begin = cursor.position();
    const std::string_view rest = cursor.bytes().substr(begin, 100);
    const std::string_view word = rest.substr(0, std::min(rest.find_first_of(" \t\r\n)"), rest.size()));
    double value = 0;
    if (!parse_number(word, value))
      fail(section, fmt::format("'{}' should be a number (coordinate)", word.substr(0, 40)));
    cursor.move_to(begin + word.size());
    return value;
  }

  /// Only which numbers a zone has: what the cells are their faces say.
  void take_cells(const FluentSection& section) {
    if (section.numbers.size() >= 3 && section.numbers[0] > 0) {
      const std::int64_t first = section.numbers[1], last = section.numbers[2];
      if (first < 1 || last < first - 1 || last > kMostNumbers)
        fail(section, fmt::format("cells {} to {}", first, last));
      cell_zones_.push_back({section.numbers[0], first, last});
    }
    text_.skip(section);
  }

  /// Binary bodies hold numbers of 4 or of 8 bytes, which the sections' numbers do not always say: the end shows it.
  bool is_wide(const FluentSection& section, std::size_t n) {
    if (section.form == 2) return false;
    const std::size_t shape = section.numbers.size() > 4 ? static_cast<std::size_t>(section.numbers[4]) : 0;
    const std::size_t each = shape >= 2 && shape <= 4 ? shape + 2 : 5;
    const std::size_t end = text_.cursor().bytes().find("End of Binary Section", text_.cursor().position());
    if (end == std::string_view::npos) fail(section, "a binary section has no end; the file is truncated");
    return end - text_.cursor().position() >= 8 * each * n;
  }

  void take_faces(const FluentSection& section) {
    const std::size_t n = count_of(section, "faces", section.form == 0 ? 6 : 16);
    const bool wide = section.form != 0 && is_wide(section, n);
    const std::int64_t shape = section.numbers.size() > 4 ? section.numbers[4] : 0;
    const std::int64_t zone = section.numbers[0];
    if (section.numbers.size() > 3) zone_types_[zone] = section.numbers[3];
    const auto next = [&](const char* what) -> std::int64_t {
      if (section.form == 0) return text_.hexadecimal(what);
      return wide ? text_.cursor().binary<std::int64_t>(what) : text_.cursor().binary<std::int32_t>(what);
    };
    const auto cell = [&]() -> std::uint32_t {
      const std::int64_t c = next("cell of a face");
      if (c < 0 || c > kMostNumbers) fail(section, fmt::format("a face has the cell {}", c));
      return c == 0 ? kNone : static_cast<std::uint32_t>(c - 1);
    };
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      const std::int64_t corners = shape >= 2 && shape <= 4 ? shape : next("number of nodes of a face");
      if (corners < mesh_.dimension || (mesh_.dimension == 2 && corners != 2) || corners > 10000)
        fail(section, fmt::format("a face has {} nodes", corners));
      RawFace face{corners_.size(), static_cast<std::uint32_t>(corners), kNone, kNone, zone};
      for (std::int64_t k = 0; k < corners; ++k) {
        const std::int64_t v = next("node of a face");
        if (v < 1 || v > kMostNumbers) fail(section, fmt::format("a face has the node {}; they count from 1", v));
        corners_.push_back(VertexId(static_cast<std::size_t>(v - 1)));
      }
      face.right = cell();
      face.left = cell();
      faces_.push_back(face);
    }
    end_body(section);
  }

  std::span<const VertexId> ring(const RawFace& face) const {
    return {corners_.data() + face.first_corner, face.num_corners};
  }

  /// Checks all numbers, and gives every face its first cell on the right.
  void find_cells() {
    std::uint32_t last = 0;
    bool has_cells = false;
    for (RawFace& face : faces_) {
      for (const VertexId v : ring(face))
        if (v.index() >= mesh_.points.size())
          throw InputError(fmt::format("{}: a face has the node {}, but the file has {} points", path(), v.index() + 1,
                                       mesh_.points.size()));
      if (face.right == kNone && face.left != kNone) {
        std::swap(face.right, face.left);
        std::reverse(corners_.begin() + static_cast<std::ptrdiff_t>(face.first_corner),
                     corners_.begin() + static_cast<std::ptrdiff_t>(face.first_corner + face.num_corners));
      }
      if (face.right == face.left && face.right != kNone)
        throw InputError(fmt::format("{}: a face has the cell {} on both sides", path(), face.right + 1));
      for (const std::uint32_t cell : {face.right, face.left}) {
        if (cell == kNone) continue;
        has_cells = true;
        last = std::max(last, cell);
      }
    }
    if (has_cells && last >= 2 * faces_.size())
      throw InputError(fmt::format("{}: there are more cells than faces have sides", path()));
    num_cells_ = has_cells ? last + 1 : 0;
    std::vector<bool> has_face(num_cells_, false);
    for (const RawFace& face : faces_)
      for (const std::uint32_t cell : {face.right, face.left})
        if (cell != kNone) has_face[cell] = true;
    const auto bare = std::find(has_face.begin(), has_face.end(), false);
    if (bare != has_face.end())
      throw InputError(fmt::format("{}: cell {} has no face", path(), bare - has_face.begin() + 1));
  }

  std::vector<GroupId> regions() {
    std::vector<GroupId> region(num_cells_);
    for (const CellZone& zone : cell_zones_) {
      GroupId group;
      for (std::int64_t cell = zone.first; cell <= zone.last && cell <= static_cast<std::int64_t>(num_cells_); ++cell) {
        if (!group.is_valid()) group = group_of_zone(mesh_.dimension, zone.zone);
        region[static_cast<std::size_t>(cell - 1)] = group;
      }
    }
    return region;
  }

  GroupId group_of_zone(int d, std::int64_t zone) {
    if (!own_.empty() && !own_.contains(zone)) return GroupId();
    const auto [it, is_new] = groups_.try_emplace({d, zone});
    if (is_new) {
      it->second = mesh_.groups.next_id();
      mesh_.groups.push_back({fmt::format("{}_{}", role_name(mesh_, d), zone), d, "", false});
    }
    return it->second;
  }

  void add_volume_cells() {
    if (num_cells_ == 0) return;
    FoamFaceList list;
    const auto add = [&](const RawFace& face) {
      list.corners.insert(list.corners.end(), ring(face).begin(), ring(face).end());
      std::reverse(list.corners.begin() + static_cast<std::ptrdiff_t>(list.offsets.back()), list.corners.end());
      list.offsets.push_back(list.corners.size());
      list.owner.push_back(face.right);
    };
    for (const RawFace& face : faces_)
      if (face.left != kNone) {
        add(face);
        list.neighbour.push_back(face.left);
      }
    for (const RawFace& face : faces_)
      if (face.left == kNone && face.right != kNone) add(face);
    if (first_volume(list) < 0) {
      turns_ = true;
      for (std::size_t f = 0; f < list.size(); ++f)
        std::reverse(list.corners.begin() + static_cast<std::ptrdiff_t>(list.offsets[f]),
                     list.corners.begin() + static_cast<std::ptrdiff_t>(list.offsets[f + 1]));
    }
    add_foam_cells(list, regions(), path(), mesh_);
  }

  /// Six times the volume of cell 0 by its faces.
  double first_volume(const FoamFaceList& list) const {
    double volume = 0;
    Point origin;
    bool has_origin = false;
    for (std::size_t f = 0; f < list.size(); ++f) {
      const bool is_owner = list.owner[f] == 0, is_neighbour = f < list.neighbour.size() && list.neighbour[f] == 0;
      if (!is_owner && !is_neighbour) continue;
      const auto v = list[f];
      if (!has_origin) origin = mesh_.points[v[0]];
      has_origin = true;
      for (std::size_t k = 2; k < v.size(); ++k) {
        const double part =
            dot(mesh_.points[v[0]] - origin, cross(mesh_.points[v[k - 1]] - origin, mesh_.points[v[k]] - origin));
        volume += is_owner ? part : -part;
      }
    }
    return volume;
  }

  /// Sides of a cell make its ring: each runs with the cell on its left.
  void add_plane_cells() {
    std::vector<std::vector<std::array<VertexId, 2>>> sides(num_cells_);
    for (const RawFace& face : faces_) {
      const auto v = ring(face);
      if (face.right != kNone) sides[face.right].push_back({v[1], v[0]});
      if (face.left != kNone) sides[face.left].push_back({v[0], v[1]});
    }
    const std::vector<GroupId> region = regions();
    std::vector<std::vector<VertexId>> rings(num_cells_);
    for (std::size_t cell = 0; cell < num_cells_; ++cell) rings[cell] = join(sides[cell], cell);
    turns_ = !rings.empty() && area(rings[0]) < 0;
    for (std::size_t cell = 0; cell < num_cells_; ++cell) {
      if (turns_) std::reverse(rings[cell].begin() + 1, rings[cell].end());
      add_face(mesh_, rings[cell], region[cell]);
    }
  }

  std::vector<VertexId> join(const std::vector<std::array<VertexId, 2>>& sides, std::size_t cell) {
    std::vector<VertexId> joined = {sides[0][0]};
    VertexId at = sides[0][1];
    while (at != joined[0] && joined.size() < sides.size()) {
      joined.push_back(at);
      const auto next = std::find_if(sides.begin(), sides.end(), [&](const auto& side) { return side[0] == at; });
      if (next == sides.end()) break;
      at = (*next)[1];
    }
    if (at != joined[0] || joined.size() != sides.size() || joined.size() < 3)
      throw InputError(fmt::format(
          "{}: the sides of cell {} make no ring; one of them is turned, missing or there twice", path(), cell + 1));
    return joined;
  }

  double area(const std::vector<VertexId>& cell) const {
    double twice = 0;
    for (std::size_t k = 2; k < cell.size(); ++k)
      twice +=
          cross(mesh_.points[cell[k - 1]] - mesh_.points[cell[0]], mesh_.points[cell[k]] - mesh_.points[cell[0]]).z;
    return twice;
  }

  /// Outward, that is away from the cell on the right; sides in the plane with it on the left.
  void add_patches() {
    for (const RawFace& face : faces_) {
      const bool is_inside = face.left != kNone;
      const bool is_own = own_.contains(face.zone);
      const auto type = zone_types_.find(face.zone);
      const bool is_interior = type != zone_types_.end() && type->second == kFluentInterior;
      if (!own_.empty() ? !is_own && is_inside : is_inside && is_interior) continue;
      std::vector<VertexId> corners(ring(face).begin(), ring(face).end());
      if (!turns_) std::reverse(corners.begin(), corners.end());
      const GroupId group = group_of_zone(mesh_.dimension - 1, face.zone);
      if (corners.size() == 2)
        add_cell(mesh_, CellType::line, corners, group);
      else
        add_face(mesh_, corners, group);
    }
  }

  void name_groups() {
    for (const auto& [key, group] : groups_) {
      Group& known = mesh_.groups[group];
      if (const auto own = own_.find(key.second); own != own_.end()) {
        known = {own->second.name, known.dimension, own->second.kind, own->second.two_sided};
        continue;
      }
      if (const auto name = names_.find(key.second); name != names_.end()) known.name = name->second;
      if (key.first != mesh_.dimension) known.kind = kind_of(key.second);
    }
  }

  std::string kind_of(std::int64_t zone) const {
    const auto word = types_.find(zone);
    const auto number = zone_types_.find(zone);
    for (const FluentZone& known : kFluentZones)
      if (word != types_.end() ? word->second == known.type
                               : number != zone_types_.end() && number->second == known.number)
        return known.kind;
    return "";
  }

  FluentText text_;
  Context& context_;
  Mesh mesh_;
  std::vector<RawFace> faces_;
  std::vector<VertexId> corners_;
  std::vector<CellZone> cell_zones_;
  std::size_t num_cells_ = 0;
  bool turns_ = false;
  std::map<std::int64_t, std::string> names_, types_;
  std::map<std::int64_t, std::int64_t> zone_types_;
  std::map<std::int64_t, NamedNumber> own_;
  std::map<std::pair<int, std::int64_t>, GroupId> groups_;
};

}  // namespace

Mesh read_fluent(std::string_view bytes, const std::string& path, Context& context) {
  return FluentReader(bytes, path, context).read();
}

}  // namespace delfront
