// SPDX-License-Identifier: Apache-2.0
// Each face is cut as a polygon (Sutherland & Hodgman 1974). The kept faces of a closed cell have a boundary that is a
// set of closed loops in the plane, since all edges off the plane still have two faces: these loops, turned round, are
// the new faces. Edges in the plane that two kept faces share cancel.
#include "delaunay/cut_cells.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

class Cutter {
 public:
  Cutter(CellFaces& faces, std::uint32_t num_closed, int axis, int direction, double value, double tolerance)
      : faces_(faces), num_closed_(num_closed), axis_(axis), value_(value) {
    sides_.reserve(faces.vertices.size());
    for (Point& p : faces.vertices) {
      const double height = direction * (p[axis] - value);
      const bool is_on = std::fabs(height) <= tolerance;
      if (is_on) p[axis] = value;
      sides_.push_back(static_cast<std::int8_t>(is_on ? 0 : height > 0 ? 1 : -1));
    }
  }

  void run() {
    find_sides_of_cells();
    CellFaces all;
    all.offsets.reserve(faces_.offsets.size());
    all.loops.reserve(faces_.loops.size());
    all.cells.reserve(faces_.cells.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) cut_face(f, all);
    close_cells(all);
    all.vertices = std::move(faces_.vertices);
    faces_ = std::move(all);
  }

 private:
  /// A directed edge in the plane, of a kept face with its normal out of the cell.
  struct PlaneEdge {
    std::uint32_t cell, from, to;
  };

  enum : std::uint8_t { kAbove = 1, kBelow = 2 };

  void find_sides_of_cells() {
    std::uint32_t last = num_closed_;
    for (const auto& [a, b] : faces_.cells)
      for (const std::uint32_t cell : {a, b})
        if (cell != CellFaces::kNone) last = std::max(last, cell + 1);
    has_.assign(last, 0);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      std::uint8_t has = 0;
      for (const std::uint32_t v : faces_[f])
        has = static_cast<std::uint8_t>(has | (sides_[v] > 0 ? kAbove : sides_[v] < 0 ? kBelow : 0));
      for (const std::uint32_t cell : faces_.cells[f])
        if (cell != CellFaces::kNone) has_[cell] |= has;
    }
  }

  bool is_kept(std::uint32_t cell) const { return cell != CellFaces::kNone && (has_[cell] & kAbove); }

  void cut_face(std::size_t f, CellFaces& all) {
    const std::span<const std::uint32_t> loop = faces_[f];
    bool has_above = false, has_below = false;
    for (const std::uint32_t v : loop) {
      has_above |= sides_[v] > 0;
      has_below |= sides_[v] < 0;
    }
    if (has_below && !has_above) return;
    std::array<std::uint32_t, 2> cells = faces_.cells[f];
    for (std::uint32_t& cell : cells)
      if (!is_kept(cell)) cell = CellFaces::kNone;
    if (cells[0] == CellFaces::kNone && cells[1] == CellFaces::kNone) return;
    cut_.clear();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t v = loop[i], w = loop[i + 1 < loop.size() ? i + 1 : 0];
      if (sides_[v] >= 0) cut_.push_back(v);
      if (sides_[v] * sides_[w] < 0) cut_.push_back(vertex_between(v, w));
    }
    if (cut_.size() < 3) return;
    if (cells[0] == CellFaces::kNone) {
      std::swap(cells[0], cells[1]);
      std::reverse(cut_.begin(), cut_.end());
    }
    all.add(cut_, cells);
    collect_plane_edges(cells);
  }

  /// The one place where an edge meets the plane, whichever face asks.
  std::uint32_t vertex_between(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto number = static_cast<std::uint32_t>(faces_.vertices.size());
    const auto [found, is_new] = made_.insert({std::uint64_t{a} << 32 | b, number});
    if (!is_new) return found->second;
    const Point p = faces_.vertices[a], q = faces_.vertices[b];
    const double t = (value_ - p[axis_]) / (q[axis_] - p[axis_]);
    Point at = p + t * (q - p);
    at[axis_] = value_;
    faces_.vertices.push_back(at);
    sides_.push_back(0);
    return number;
  }

  void collect_plane_edges(std::array<std::uint32_t, 2> cells) {
    for (std::size_t i = 0; i < cut_.size(); ++i) {
      const std::uint32_t v = cut_[i], w = cut_[i + 1 < cut_.size() ? i + 1 : 0];
      if (sides_[v] != 0 || sides_[w] != 0) continue;
      if (is_to_close(cells[0])) edges_.push_back({cells[0], v, w});
      if (is_to_close(cells[1])) edges_.push_back({cells[1], w, v});
    }
  }

  bool is_to_close(std::uint32_t cell) const { return cell < num_closed_ && has_[cell] == (kAbove | kBelow); }

  void close_cells(CellFaces& all) {
    std::stable_sort(edges_.begin(), edges_.end(),
                     [](const PlaneEdge& a, const PlaneEdge& b) { return a.cell < b.cell; });
    for (std::size_t i = 0, j = 0; i < edges_.size(); i = j) {
      for (j = i + 1; j < edges_.size() && edges_[j].cell == edges_[i].cell;) ++j;
      open_.clear();
      for (std::size_t k = i; k < j; ++k) {
        const auto twin = std::find_if(open_.begin(), open_.end(), [&](const PlaneEdge& e) {
          return e.from == edges_[k].to && e.to == edges_[k].from;
        });
        if (twin == open_.end())
          open_.push_back(edges_[k]);
        else
          open_.erase(twin);
      }
      while (!open_.empty()) close_loop(edges_[i].cell, all);
    }
  }

  void close_loop(std::uint32_t cell, CellFaces& all) {
    cut_.clear();
    const std::uint32_t first = open_.back().to;
    for (std::uint32_t at = first;;) {
      const auto next = std::find_if(open_.begin(), open_.end(), [&](const PlaneEdge& e) { return e.to == at; });
      DELFRONT_CHECK(next != open_.end());
      cut_.push_back(at);
      at = next->from;
      open_.erase(next);
      if (at == first) break;
    }
    all.add(cut_, {cell, CellFaces::kNone});
  }

  CellFaces& faces_;
  std::uint32_t num_closed_;
  int axis_;
  double value_;
  std::vector<std::int8_t> sides_;  ///< by vertex: 1 kept, 0 in the plane, -1 cut off
  std::vector<std::uint8_t> has_;   ///< by cell
  std::unordered_map<std::uint64_t, std::uint32_t> made_;
  std::vector<std::uint32_t> cut_;  ///< loop in the making
  std::vector<PlaneEdge> edges_, open_;
};

}  // namespace

void cut_cells(CellFaces& faces, std::uint32_t num_closed, int axis, int direction, double value, double tolerance) {
  Cutter(faces, num_closed, axis, direction, value, tolerance).run();
}

}  // namespace delfront
