// SPDX-License-Identifier: Apache-2.0
// Coordinates of airfoil sections, one "x y" a line, as loops of lines in the plane. A name may stand before them.
// Selig's order runs from the trailing edge over the upper side to the nose and back below; Lednicer's has two counts,
// then the upper and the lower side, each from the nose: it is turned into Selig's. A line of two numbers from 999 on
// begins the next element. A trailing edge that is open is closed by a line.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"

namespace delfront {

namespace {

constexpr double kNextElement = 999;
constexpr double kSharpTurn = -0.9;  ///< cosine: a turn of more than 154 degrees
constexpr std::size_t kMostWarnings = 3;
constexpr double kWideTrailingEdge = 0.05;  ///< of the section's length: an opening worth a word

struct Coordinate {
  double x, y;
  std::size_t position;  ///< in the file, for messages
};

class DatReader {
 public:
  DatReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path, "#%"), context_(context) {}

  Mesh read() {
    mesh_.dimension = 2;
    read_name();
    read_lines();
    finish_element();
    if (mesh_.points.empty()) throw InputError(fmt::format("{}: the file has no coordinates", cursor_.path()));
    return std::move(mesh_);
  }

 private:
  /// The first line, unless it is coordinates already.
  void read_name() {
    const std::size_t start = cursor_.position();
    double x, y;
    if (!(parse_number(number_at(cursor_.next()), x) && parse_number(number_at(cursor_.next_on_line()), y) &&
          cursor_.at_line_end())) {
      cursor_.move_to(start);
      cursor_.rest_of_line(Cursor::Comments::keep);
      return;
    }
    cursor_.move_to(start);
  }

  static std::string_view number_at(std::string_view token) {
    return token.ends_with(',') ? token.substr(0, token.size() - 1) : token;
  }

  double coordinate(std::string_view token, const char* what) {
    token = number_at(token);
    double value;
    if (!parse_number(token, value))
      cursor_.fail(token.empty() ? fmt::format("the {} is missing: a line of coordinates has two numbers", what)
                                 : fmt::format("the {} is not a number: '{}'", what, token));
    if (!std::isfinite(value)) cursor_.fail(fmt::format("the {} is not finite", what));
    return value;
  }

  void read_lines() {
    for (bool is_first = true; !cursor_.at_end(); is_first = false) {
      const std::string_view token = cursor_.next();
      const auto position = static_cast<std::size_t>(token.data() - cursor_.bytes().data());
      const double x = coordinate(token, "x"), y = coordinate(cursor_.next_on_line(), "y");
      if (!cursor_.at_line_end()) cursor_.fail("more than two numbers on a line of coordinates");
      if (points_.size() % 1024 == 0) context_.check_limits();
      if (is_first && is_count(x) && is_count(y)) {
        num_upper_ = static_cast<std::size_t>(x);
        num_lower_ = static_cast<std::size_t>(y);
      } else if (x >= kNextElement && y >= kNextElement) {
        finish_element();
      } else {
        points_.push_back({x, y, position});
      }
    }
  }

  static bool is_count(double value) { return value >= 2 && value < 1e6 && value == std::floor(value); }

  void finish_element() {
    if (num_upper_ > 0) turn_into_selig();
    drop_repeated();
    if (points_.empty()) return;
    if (points_.size() < 3) cursor_.fail_at(points_.front().position, "an element of fewer than three points");
    warn_of_turns();
    const std::size_t first = mesh_.points.size(), n = points_.size();
    mesh_.groups.push_back({"", 1, "", false});
    const GroupId group(mesh_.groups.size() - 1);
    for (const Coordinate& p : points_) mesh_.points.push_back({p.x, p.y, 0});
    for (std::size_t i = 0; i < n; ++i) {
      const VertexId ends[2] = {VertexId(first + i), VertexId(first + (i + 1) % n)};
      add_cell(mesh_, CellType::line, ends, group);
    }
    points_.clear();
  }

  void turn_into_selig() {
    if (points_.size() != num_upper_ + num_lower_)
      throw InputError(fmt::format("{}: line 2 announces {} + {} points, and there are {}", cursor_.path(), num_upper_,
                                   num_lower_, points_.size()));
    std::reverse(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(num_upper_));
    num_upper_ = num_lower_ = 0;
  }

  /// Equal points one after the other are one: where the sides meet at the nose, and where the outline closes.
  void drop_repeated() {
    const auto is_equal = [](const Coordinate& a, const Coordinate& b) { return a.x == b.x && a.y == b.y; };
    std::vector<Coordinate> kept;
    for (const Coordinate& p : points_)
      if (kept.empty() || !is_equal(kept.back(), p)) kept.push_back(p);
    const std::size_t repeated = points_.size() - kept.size();
    is_closed_ = kept.size() > 1 && is_equal(kept.front(), kept.back());
    if (is_closed_) kept.pop_back();
    if (repeated > 1)
      context_.warn(fmt::format("{}: {} points repeat the one before and are left out", cursor_.path(), repeated));
    points_.swap(kept);
  }

  bool turns_back(std::size_t i) const {
    if (i == 0 || i + 1 >= points_.size()) return false;
    const Coordinate &a = points_[i - 1], &b = points_[i], &c = points_[i + 1];
    const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - b.x, vy = c.y - b.y;
    return ux * vx + uy * vy < kSharpTurn * std::hypot(ux, uy) * std::hypot(vx, vy);
  }

  /// One sharp turn may be a nose; two in a row are points that are swapped. And a wide gap that the closing line
  /// spans.
  void warn_of_turns() const {
    double low = points_[0].x, high = points_[0].x;
    std::size_t turns = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Coordinate& p = points_[i];
      low = std::min(low, p.x);
      high = std::max(high, p.x);
      if (turns_back(i) && turns_back(i + 1) && ++turns <= kMostWarnings)
        context_.warn(fmt::format("{}: line {}: the outline turns back at ({:g}, {:g}); are points in the wrong order?",
                                  cursor_.path(), cursor_.line_of(p.position), p.x, p.y));
    }
    const double gap = std::hypot(points_.front().x - points_.back().x, points_.front().y - points_.back().y);
    if (!is_closed_ && gap > kWideTrailingEdge * (high - low))
      context_.warn(
          fmt::format("{}: the outline is open by {:g}; it is closed by a straight line", cursor_.path(), gap));
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  std::vector<Coordinate> points_;
  std::size_t num_upper_ = 0, num_lower_ = 0;  ///< 0: Selig's order
  bool is_closed_ = false;                     ///< the element's last point is its first again
};

}  // namespace

Mesh read_dat(std::string_view bytes, const std::string& path, Context& context) {
  return DatReader(bytes, path, context).read();
}

}  // namespace delfront
