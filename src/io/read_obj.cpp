// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: vertices, polygons, lines (l) and points (p); texture and normal indices are skipped. A face's patch
// is named by its group (g), object (o) or material (usemtl): the first of these that tells faces apart, else the first
// that is there; lines and points go by the same.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "mesh/named_groups.hpp"

namespace delfront {

namespace {

constexpr std::size_t kNumLabels = 3;  // g, o, usemtl
constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

/// From which face on which names hold.
struct Run {
  std::size_t first_face;
  std::array<std::string_view, kNumLabels> names;
};

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path, "#"), context_(context) {
    runs_.push_back({0, {}});
    offsets_.push_back(0);
  }

  Mesh read() {
    while (!cursor_.at_end()) take_line();
    if (max_index_ >= static_cast<std::int64_t>(mesh_.points.size()))
      cursor_.fail_at(max_index_at_, fmt::format("vertex {} is out of range: the file has {} vertices", max_index_ + 1,
                                                 mesh_.points.size()));
    if (offsets_.size() == 1 && embedded_.empty())
      throw InputError(fmt::format("{}: the OBJ file has no faces (f lines)", cursor_.path()));
    add_faces();
    add_embedded();
    check_finite(mesh_, cursor_.path());
    return std::move(mesh_);
  }

 private:
  void take_line() {
    const std::string_view word = cursor_.next();
    if (word == "v") {
      take_vertex();
    } else if (word == "f" || word == "fo") {
      take_face();
    } else if (word == "l" || word == "p") {
      take_line_or_points(word == "l");
    } else if (word == "g") {
      begin_run(0);
    } else if (word == "o") {
      begin_run(1);
    } else if (word == "usemtl") {
      begin_run(2);
    } else {
      cursor_.skip_line();  // vt, vn, s, mtllib and what programs add
    }
  }

  void take_vertex() {
    Point p;
    for (int k = 0; k < 3; ++k) {
      if (cursor_.at_line_end()) cursor_.fail("a vertex needs three coordinates");
      p[k] = cursor_.number("coordinate of a vertex");
    }
    cursor_.skip_line();  // weight or colour
    mesh_.points.push_back(p);
  }

  /// Next token of the face, over line ends that a backslash hides.
  std::string_view next_corner() {
    std::string_view token = cursor_.next_on_line();
    while (token == "\\") {
      cursor_.skip_line();
      token = cursor_.next_on_line();
    }
    return token;
  }

  void take_face() {
    const std::size_t begin = cursor_.position();
    const std::size_t num_before = corners_.size();
    if (offsets_.size() % kCheckEvery == 0) context_.check_limits();
    for (std::string_view token = next_corner(); !token.empty(); token = next_corner())
      corners_.push_back(corner(token));
    if (corners_.size() - num_before < 3)
      cursor_.fail_at(begin,
                      fmt::format("a face needs three corners or more, this has {}", corners_.size() - num_before));
    offsets_.push_back(corners_.size());
  }

  void take_line_or_points(bool is_line) {
    const std::size_t begin = cursor_.position();
    std::vector<VertexId> vertices;
    for (std::string_view token = next_corner(); !token.empty(); token = next_corner())
      vertices.push_back(corner(token));
    if (is_line && vertices.size() < 2)
      cursor_.fail_at(begin, fmt::format("a line needs two vertices or more, this has {}", vertices.size()));
    embedded_.push_back({is_line, std::move(vertices), runs_.back().names});
  }

  VertexId corner(std::string_view token) {
    const std::string_view digits = token.substr(0, token.find('/'));
    std::int64_t index = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (error != std::errc() || stop != digits.data() + digits.size())
      cursor_.fail(fmt::format("'{}' is no vertex index", token.substr(0, 40)));
    const auto num_points = static_cast<std::int64_t>(mesh_.points.size());
    if (index == 0 || index < -num_points || index > std::int64_t{Id<VertexTag>::kNone} - 1)
      cursor_.fail(fmt::format("vertex {} is out of range: {} vertices so far, counted from 1 (or back from -1)", index,
                               num_points));
    index = index > 0 ? index - 1 : num_points + index;
    if (index > max_index_) {  // checked at the end, since vertices may follow their faces
      max_index_ = index;
      max_index_at_ = cursor_.position();
    }
    return VertexId(static_cast<std::size_t>(index));
  }

  void begin_run(std::size_t label) {
    Run run = runs_.back();
    run.first_face = offsets_.size() - 1;
    run.names[label] = cursor_.rest_of_line(Cursor::Comments::keep);
    if (runs_.back().first_face == run.first_face) runs_.pop_back();
    runs_.push_back(run);
  }

  /// The label whose names tell the faces apart.
  std::size_t choose_label() const {
    std::size_t first_named = 0;
    for (std::size_t label = kNumLabels; label-- > 0;)
      if (distinct_names(label) == 1 && !first_name(label).empty()) first_named = label;
    for (std::size_t label = 0; label < kNumLabels; ++label)
      if (distinct_names(label) > 1) return label;
    return first_named;
  }

  bool has_faces(std::size_t run) const { return end_of(run) > runs_[run].first_face; }
  std::size_t end_of(std::size_t run) const {
    return run + 1 < runs_.size() ? runs_[run + 1].first_face : offsets_.size() - 1;
  }

  std::string_view first_name(std::size_t label) const {
    for (std::size_t i = 0; i < runs_.size(); ++i)
      if (has_faces(i)) return runs_[i].names[label];
    return {};
  }

  /// 1, or 2 where there are more.
  std::size_t distinct_names(std::size_t label) const {
    const std::string_view first = first_name(label);
    for (std::size_t i = 0; i < runs_.size(); ++i)
      if (has_faces(i) && runs_[i].names[label] != first) return 2;
    return 1;
  }

  void add_faces() {
    const std::size_t label = choose_label();
    NamedGroups patches(mesh_, 2);
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (!has_faces(i)) continue;
      const GroupId group = patches(runs_[i].names[label]);
      for (std::size_t face = runs_[i].first_face; face < end_of(i); ++face)
        add_face(mesh_, {corners_.data() + offsets_[face], offsets_[face + 1] - offsets_[face]}, group);
    }
  }

  void add_embedded() {
    const std::size_t label = choose_label();
    NamedGroups curves(mesh_, 1), points(mesh_, 0);
    for (const auto& [is_line, vertices, names] : embedded_) {
      const auto named = std::find_if(names.begin(), names.end(), [](std::string_view name) { return !name.empty(); });
      const std::string_view name = !names[label].empty() || named == names.end() ? names[label] : *named;
      GroupId group;
      if (!name.empty()) group = is_line ? curves(name) : points(name);
      for (std::size_t k = 0; k + (is_line ? 1 : 0) < vertices.size(); ++k)
        add_cell(mesh_, is_line ? CellType::line : CellType::vertex, {&vertices[k], is_line ? 2u : 1u}, group);
    }
  }

  /// Lines or points of one statement.
  struct Embedded {
    bool is_line;
    std::vector<VertexId> vertices;
    std::array<std::string_view, kNumLabels> names;
  };

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  std::vector<Embedded> embedded_;
  std::vector<Run> runs_;
  std::vector<VertexId> corners_;
  std::vector<std::size_t> offsets_;
  std::int64_t max_index_ = -1;
  std::size_t max_index_at_ = 0;
};

}  // namespace

Mesh read_obj(std::string_view bytes, const std::string& path, Context& context) {
  return ObjReader(bytes, path, context).read();
}

}  // namespace delfront
