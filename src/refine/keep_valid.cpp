// SPDX-License-Identifier: Apache-2.0
#include "refine/keep_valid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "delfront/findings.hpp"
#include "mesh/cell_shape.hpp"
#include "mesh/facet_table.hpp"
#include "predicates/predicates.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 13;  ///< cells a task
constexpr std::uint32_t kNotMoved = 0xffffffffu;

/// A power of two that brings the largest coordinate near 1, as the predicates want.
double scale_for_predicates(const Array<VertexId, Point>& points) {
  double largest = 0;
  for (const Point& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest > 0 && std::isfinite(largest) ? std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000)) : 1;
}

struct Parent {
  const CellBlock* block;
  std::size_t cell;
};

/// What one task found.
struct Found {
  std::vector<Parent> with_moved;
  std::vector<std::uint32_t> bad_points;  ///< in MovedPoint's array, to go back
  std::vector<Place> hopeless;            ///< children that are not positive for no point of ours
};

class ValidityKeeper {
 public:
  ValidityKeeper(const Mesh& coarse, const MidPoints& mids, CellSplitter& splitter, Mesh& fine,
                 std::vector<MovedPoint>& moved, double least_share)
      : coarse_(coarse),
        num_old_(mids.num_old()),
        splitter_(splitter),
        fine_(fine),
        moved_(moved),
        least_share_(least_share),
        is_plane_(fine.dimension == 2),
        scale_(scale_for_predicates(fine.points)) {
    if (moved.empty()) return;
    moved_at_.assign(mids.num_points() - num_old_, kNotMoved);
    for (std::size_t i = 0; i < moved.size(); ++i) moved_at_[moved[i].point - num_old_] = static_cast<std::uint32_t>(i);
  }

  void run(Context& context) {
    std::vector<Parent> parents = look_at_all(context);
    while (!parents.empty()) {  // each time round a point goes back at least, which it can twice
      context.check_limits();
      std::vector<Found> found((parents.size() + kGrain - 1) / kGrain);
      parallel_ranges(context.threads, parents.size(), kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) look_at(parents[i], found[first / kGrain]);
      });
      if (!move_back(found)) return;
    }
  }

 private:
  using Child = CellSplitter::Child;
  using Children = std::array<Child, CellSplitter::kMaxChildren>;

  /// Cells without moved points are judged at once. @return those with
  std::vector<Parent> look_at_all(Context& context) {
    std::vector<Parent> parents;
    const CellRange cells(coarse_, coarse_.top_dimension());
    for (const CellRange::Part& part : cells.parts()) {
      const CellBlock& block = *part.block;
      context.check_limits();
      std::vector<Found> found((block.size() + kGrain - 1) / kGrain);
      parallel_ranges(context.threads, block.size(), kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t cell = first; cell < last; ++cell) {
          Found& here = found[first / kGrain];
          if (has_moved_points({&block, cell}))
            here.with_moved.push_back({&block, cell});
          else if (!is_good({&block, cell}))
            look_at({&block, cell}, here);
        }
      });
      for (const Found& f : found) parents.insert(parents.end(), f.with_moved.begin(), f.with_moved.end());
      fail_if_hopeless(found);
    }
    return parents;
  }

  bool has_moved_points(const Parent& parent) const {
    if (moved_.empty()) return false;
    Children children;
    const std::size_t n = splitter_.list_children(*parent.block, parent.cell, children);
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < num_vertices(children[i].type); ++k)
        if (moved_point(children[i].vertices[k])) return true;
    return false;
  }

  const MovedPoint* moved_point(VertexId v) const {
    if (v.index() < num_old_ || moved_at_.empty()) return nullptr;
    const std::uint32_t i = moved_at_[v.index() - num_old_];
    return i == kNotMoved ? nullptr : &moved_[i];
  }

  bool is_good(const Parent& parent) const {
    Children children;
    const std::size_t n = splitter_.list_children(*parent.block, parent.cell, children);
    return std::all_of(children.begin(), children.begin() + n, [this](const Child& c) { return is_good(c); });
  }

  bool is_good(const Child& child) const {
    const CellShape& shape = shape_of(child.type);
    for (int i = 0; i < shape.num_corners; ++i) {
      Point p[4], middle[4];
      bool has_moved = false;
      for (int k = 0; k < (is_plane_ ? 3 : 4); ++k) {
        const VertexId v = child.vertices[shape.corners[i][k]];
        p[k] = middle[k] = scale_ * fine_.points[v];
        const MovedPoint* m = moved_point(v);
        if (!m || m->halves == 0) continue;
        middle[k] = scale_ * m->middle;
        has_moved = true;
      }
      if (!is_positive(p) || (has_moved && volume(p) < least_share_ * volume(middle))) return false;
    }
    return true;
  }

  bool is_positive(const Point* p) const {
    return (is_plane_ ? orient2d(&p[0].x, &p[1].x, &p[2].x) : orient3d(p[0], p[1], p[2], p[3])) > 0;
  }
  /// Six times the volume, in the plane twice the area.
  double volume(const Point* p) const {
    const Point normal = cross(p[1] - p[0], p[2] - p[0]);
    return is_plane_ ? normal.z : dot(normal, p[3] - p[0]);
  }

  void look_at(const Parent& parent, Found& found) {
    if (parent.block->type == CellType::tetrahedron) {
      const auto diagonals = splitter_.diagonals_by_length(parent.cell);
      for (const unsigned d : diagonals) {
        splitter_.split_tet(parent.cell, d);
        if (is_good(parent)) return;
      }
      splitter_.split_tet(parent.cell, diagonals[0]);
    }
    Children children;
    const std::size_t n = splitter_.list_children(*parent.block, parent.cell, children);
    for (std::size_t i = 0; i < n; ++i)
      if (!is_good(children[i])) note_bad(children[i], found);
  }

  void note_bad(const Child& child, Found& found) const {
    bool has_way_back = false;
    for (int k = 0; k < num_vertices(child.type); ++k)
      if (const MovedPoint* m = moved_point(child.vertices[k]); m && m->halves > 0) {
        found.bad_points.push_back(static_cast<std::uint32_t>(m - moved_.data()));
        has_way_back = true;
      }
    if (has_way_back) return;
    Place place;
    for (int k = 0; k < num_vertices(child.type); ++k) {
      place.at = place.at + fine_.points[child.vertices[k]] / num_vertices(child.type);
      place.ids.push_back(child.vertices[k].value);
    }
    found.hopeless.push_back(std::move(place));
  }

  static void fail_if_hopeless(const std::vector<Found>& found) {
    std::vector<Place> places;
    for (const Found& f : found) places.insert(places.end(), f.hopeless.begin(), f.hopeless.end());
    if (places.empty()) return;
    const std::size_t count = places.size();
    if (places.size() > kMaxPlaces) places.resize(kMaxPlaces);
    const Point at = places[0].at;
    throw MeshingError(
        fmt::format("{} cells of the refined grid would be inverted or flat, since those they come from are too warped "
                    "or too flat; the first at ({:.9g}, {:.9g}, {:.9g}). 'delfront check' of the coarse grid shows its "
                    "worst cells; grid again with better ones",
                    count, at.x, at.y, at.z),
        std::move(places));
  }

  /// @return whether any point moved
  bool move_back(const std::vector<Found>& found) {
    std::vector<std::uint32_t> bad;
    for (const Found& f : found) bad.insert(bad.end(), f.bad_points.begin(), f.bad_points.end());
    if (bad.empty()) {
      fail_if_hopeless(found);
      return false;
    }
    std::sort(bad.begin(), bad.end());
    bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
    for (const std::uint32_t i : bad) {
      --moved_[i].halves;
      fine_.points[VertexId(moved_[i].point)] = moved_[i].place();
    }
    return true;
  }

  const Mesh& coarse_;
  std::size_t num_old_;
  CellSplitter& splitter_;
  Mesh& fine_;
  std::vector<MovedPoint>& moved_;
  double least_share_;
  bool is_plane_;
  double scale_;
  std::vector<std::uint32_t> moved_at_;  ///< by new point: where in moved_
};

}  // namespace

void keep_valid(const Mesh& coarse, const MidPoints& mids, CellSplitter& splitter, Mesh& fine,
                std::vector<MovedPoint>& moved, double least_share, Context& context) {
  ValidityKeeper(coarse, mids, splitter, fine, moved, least_share).run(context);
}

}  // namespace delfront
