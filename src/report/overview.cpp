// SPDX-License-Identifier: Apache-2.0
#include "report/overview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

#include "mesh/cell_shape.hpp"
#include "report/canvas.hpp"

namespace delfront {
namespace {

constexpr Colour kPalette[] = {{.36f, .55f, .85f}, {.93f, .60f, .27f}, {.42f, .69f, .42f}, {.83f, .42f, .42f},
                               {.60f, .50f, .78f}, {.62f, .47f, .40f}, {.88f, .56f, .75f}, {.78f, .74f, .33f},
                               {.35f, .73f, .77f}, {.58f, .62f, .67f}};
constexpr Colour kNoGroup = {.70f, .72f, .76f}, kCurve = {.13f, .16f, .20f}, kPale = {.93f, .94f, .96f};
constexpr const char* kFarKinds[] = {"farfield", "inlet", "outlet", "symmetry", "empty", "wedge", "cyclic"};
constexpr double kSmallBody =
    0.5;  ///< of the whole's diagonal: what is smaller is looked at alone, where far boundaries are known
constexpr double kTinyBody = 0.05;                ///< the same where they are not: a hole in a plate is no body
constexpr double kFlat = 1e-6;                    ///< of a diagonal: the thickness of floors and walls of tunnels
constexpr double kFull = 0.92;                    ///< of the paper, for what is looked at
constexpr double kAround = 0.68;                  ///< the same where something lies round it
constexpr double kLeastSide = 4, kFullSide = 14;  ///< in dots: sides of facets that have no lines, that have full ones
constexpr double kCurveLift = 2e-3;               ///< of the paper's width: curves are that much before facets
constexpr float kDark = 0.55f;                    ///< of a facet's colour, for its lines

Colour mixed(Colour a, Colour b, float share) {
  Colour c;
  for (std::size_t k = 0; k < 3; ++k) c[k] = (1 - share) * a[k] + share * b[k];
  return c;
}

Colour scaled(Colour a, float factor) { return mixed({}, a, factor); }

std::string hex(Colour c) {
  const auto byte = [](float part) { return static_cast<int>(std::lround(255 * part)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c[0]), byte(c[1]), byte(c[2]));
}

bool is_far(const Group& group) {
  return std::find(std::begin(kFarKinds), std::end(kFarKinds), std::string_view(group.kind)) != std::end(kFarKinds);
}

class Artist {
 public:
  Artist(const Mesh& mesh, int width, int height)
      : mesh_(mesh), sides_(mesh.dimension == 2 ? 1 : 2), canvas_(width, height) {}
  Overview draw();

 private:
  /// What the picture has to know of a boundary.
  struct Boundary {
    Box box;
    Point area;             ///< sum over its facets; in the plane nothing
    bool is_on_box = true;  ///< each facet lies in a side of the box of all, as those of a wind tunnel do
    bool is_body = true;
  };
  template <class Work>
  void for_each_cell(int of_dimension, const Work& work) const;
  void look_at_boundaries();
  void find_sides_of_the_box();
  void find_body();
  void choose_view();
  void place_on_paper();
  Canvas::Corner on_paper(Point p) const;
  bool hides_the_body(std::size_t boundary, Point area) const;
  void choose_colours();
  Colour colour_of(std::size_t group) const;
  void draw_facets();
  void draw_facet(std::span<const VertexId> cell, std::size_t group);
  void draw_lines();
  std::vector<Overview::Name> names() const;

  const Mesh& mesh_;
  int sides_;  ///< dimension of the boundary's cells
  Canvas canvas_;
  std::vector<Boundary> boundaries_;  ///< by group, the last for cells without one
  std::vector<Colour> colours_;       ///< by group, the last for cells without one
  Box box_;
  bool is_cut_open_ = false;
  Point right_{1, 0, 0}, up_{0, 1, 0}, ahead_{0, 0, 1}, centre_;
  double scale_ = 1;
};

/// Cells with all corners at a place, and the number of their group.
template <class Work>
void Artist::for_each_cell(int of_dimension, const Work& work) const {
  for (const CellBlock& block : mesh_.blocks) {
    if (dimension(block.type) != of_dimension) continue;
    for (std::size_t i = 0; i < block.size(); ++i) {
      const auto cell = block[i];
      if (!std::all_of(cell.begin(), cell.end(), [&](VertexId v) { return is_finite(mesh_.points[v]); })) continue;
      const GroupId group = block.group.empty() ? GroupId() : block.group[i];
      work(cell, group.is_valid() ? group.index() : mesh_.groups.size());
    }
  }
}

void Artist::look_at_boundaries() {
  boundaries_.resize(mesh_.groups.size() + 1);
  for_each_cell(sides_, [&](std::span<const VertexId> cell, std::size_t group) {
    Boundary& boundary = boundaries_[group];
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const Point p = mesh_.points[cell[k]] - mesh_.points[cell[0]];
      boundary.box.add(mesh_.points[cell[k]]);
      if (k > 1) boundary.area = boundary.area + 0.5 * cross(mesh_.points[cell[k - 1]] - mesh_.points[cell[0]], p);
    }
  });
  for (const Boundary& boundary : boundaries_)
    if (!boundary.box.is_empty()) {
      box_.add(boundary.box.low);
      box_.add(boundary.box.high);
    }
}

void Artist::find_sides_of_the_box() {
  const double reach = kFlat * box_.diagonal();
  for_each_cell(sides_, [&](std::span<const VertexId> cell, std::size_t group) {
    const auto lies_in = [&](double side, int k) {
      return std::all_of(cell.begin(), cell.end(),
                         [&](VertexId v) { return std::abs(mesh_.points[v][k] - side) <= reach; });
    };
    bool is_on_box = false;
    for (int k = 0; k < mesh_.dimension; ++k) is_on_box |= lies_in(box_.low[k], k) || lies_in(box_.high[k], k);
    boundaries_[group].is_on_box &= is_on_box;
  });
}

/// With far boundaries: what is small, where all else lies in the sides of the box of all. Without: what does not touch
/// those sides.
void Artist::find_body() {
  const bool has_far = std::any_of(mesh_.groups.begin(), mesh_.groups.end(), is_far);
  const double small = (has_far ? kSmallBody : kTinyBody) * box_.diagonal();
  std::vector<bool> is_body(boundaries_.size(), false);
  Box body;
  bool has_all = true;  // that could be told apart
  for (std::size_t g = 0; g < boundaries_.size(); ++g) {
    const Box& box = boundaries_[g].box;
    if (box.is_empty() || (g < mesh_.groups.size() && is_far(mesh_.groups[GroupId(g)]))) continue;
    const bool is_small = box.diagonal() < small;
    bool is_inside = true;
    for (int k = 0; k < mesh_.dimension; ++k) is_inside &= box.low[k] > box_.low[k] && box.high[k] < box_.high[k];
    is_body[g] = is_small && (has_far || is_inside);
    if (is_body[g]) {
      body.add(box.low);
      body.add(box.high);
    } else if (has_far) {
      has_all &= boundaries_[g].is_on_box;
    }
  }
  if (body.is_empty() || !has_all || body.diagonal() >= small) return;
  is_cut_open_ = true;
  for (std::size_t g = 0; g < boundaries_.size(); ++g) boundaries_[g].is_body = is_body[g];
}

/// Symmetry planes and floors lie behind the body.
void Artist::choose_view() {
  if (mesh_.dimension == 2) return;
  Point ahead{-0.9, -1.1, 0.75};
  for (std::size_t g = 0; is_cut_open_ && g < mesh_.groups.size(); ++g) {
    const Point area = boundaries_[g].area;
    if (mesh_.groups[GroupId(g)].kind != "symmetry") continue;
    for (int k = 0; k < 3; ++k)
      if (std::abs(area[k]) > 0.9 * length(area)) ahead[k] = std::copysign(ahead[k], -area[k]);
  }
  ahead_ = ahead / length(ahead);
  const Point rest = Point{0, 0, 1} - ahead_.z * ahead_;
  up_ = rest / length(rest);
  right_ = cross(up_, ahead_);
}

void Artist::place_on_paper() {
  Box seen;  // right, up
  for_each_cell(sides_, [&](std::span<const VertexId> cell, std::size_t group) {
    if (!boundaries_[group].is_body) return;
    for (const VertexId v : cell) seen.add(Point{dot(mesh_.points[v], right_), dot(mesh_.points[v], up_), 0});
  });
  const Point size = seen.high - seen.low, middle = 0.5 * (seen.low + seen.high);
  centre_ = middle.x * right_ + middle.y * up_ + dot(0.5 * (box_.low + box_.high), ahead_) * ahead_;
  scale_ = (is_cut_open_ ? kAround : kFull) * std::min(canvas_.width() / std::max(size.x, kFlat * size.y),
                                                       canvas_.height() / std::max(size.y, kFlat * size.x));
}

Canvas::Corner Artist::on_paper(Point p) const {
  const Point d = scale_ * (p - centre_);
  return {0.5 * canvas_.width() + dot(d, right_), 0.5 * canvas_.height() - dot(d, up_), dot(d, ahead_)};
}

/// Far boundaries are seen from inside only.
bool Artist::hides_the_body(std::size_t boundary, Point area) const {
  return mesh_.dimension == 3 && is_cut_open_ && !boundaries_[boundary].is_body && dot(area, ahead_) > 0;
}

Colour Artist::colour_of(std::size_t group) const { return colours_[group]; }

/// By turns, among boundaries and among regions.
void Artist::choose_colours() {
  std::array<std::size_t, 4> count{};
  for (const Group& group : mesh_.groups) {
    std::size_t& number = count[static_cast<std::size_t>(std::clamp(group.dimension, 0, 3))];
    colours_.push_back(kPalette[number++ % std::size(kPalette)]);
  }
  colours_.push_back(kNoGroup);
}

void Artist::draw_facet(std::span<const VertexId> cell, std::size_t group) {
  const Point first = mesh_.points[cell[0]];
  Point area;
  for (std::size_t k = 2; k < cell.size(); ++k)
    area = area + cross(mesh_.points[cell[k - 1]] - first, mesh_.points[cell[k]] - first);
  if (hides_the_body(group, area)) return;
  const double size = length(area);
  const Point light = ahead_ + 0.5 * up_ - 0.35 * right_;
  const double shine = size > 0 ? std::abs(dot(area, light)) / (size * length(light)) : 1;
  Colour colour = scaled(colour_of(group), mesh_.dimension == 2 ? 1.f : static_cast<float>(0.62 + 0.48 * shine));
  const bool is_behind = mesh_.dimension == 2 || !boundaries_[group].is_body;
  if (is_behind) colour = mixed(colour, kPale, 0.7f);
  std::vector<Canvas::Corner> corners;
  double around = 0;
  for (const VertexId v : cell) corners.push_back(on_paper(mesh_.points[v]));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Canvas::Corner &a = corners[k], &b = corners[(k + 1) % corners.size()];
    around += std::hypot(b.x - a.x, b.y - a.y) / double(corners.size());
  }
  const bool has_lines = around > kLeastSide;
  const auto strength = static_cast<float>(std::min(1.0, (around - kLeastSide) / (kFullSide - kLeastSide)));
  const Colour line = scaled(colour, 1 - strength * (is_behind ? 0.2f : kDark));
  for (std::size_t k = 2; k < corners.size(); ++k)
    canvas_.fill({corners[0], corners[k - 1], corners[k]}, {colour, std::uint32_t(group)}, line,
                 {has_lines && k == 2, has_lines, has_lines && k + 1 == corners.size()});
}

void Artist::draw_facets() {
  for_each_cell(2, [&](std::span<const VertexId> cell, std::size_t group) { draw_facet(cell, group); });
}

/// Curves of the geometry, in the plane the boundary.
void Artist::draw_lines() {
  for_each_cell(1, [&](std::span<const VertexId> cell, std::size_t group) {
    canvas_.stroke(on_paper(mesh_.points[cell[0]]), on_paper(mesh_.points[cell[1]]),
                   {mesh_.dimension == 2 ? scaled(colour_of(group), 0.85f) : kCurve, std::uint32_t(group)},
                   kCurveLift * canvas_.width());
  });
}

std::vector<Overview::Name> Artist::names() const {
  std::vector<Overview::Name> names;
  for (const std::size_t g : canvas_.seen())
    if (g < mesh_.groups.size() && mesh_.groups[GroupId(g)].dimension == sides_)
      names.push_back({mesh_.groups[GroupId(g)].name, hex(scaled(colour_of(g), mesh_.dimension == 2 ? 0.85f : 1))});
  return names;
}

Overview Artist::draw() {
  look_at_boundaries();
  if (box_.is_empty() || !(box_.diagonal() > 0)) return {};
  choose_colours();
  find_sides_of_the_box();
  find_body();
  choose_view();
  place_on_paper();
  draw_facets();
  draw_lines();
  return {canvas_.to_png(), names(), is_cut_open_};
}

}  // namespace

Overview draw_overview(const Mesh& mesh, int width, int height) { return Artist(mesh, width, height).draw(); }

}  // namespace delfront
