// SPDX-License-Identifier: Apache-2.0
#include "refine/boundary_points.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>

#include "base/parallel.hpp"
#include "mesh/cell_shape.hpp"
#include "mesh/facet_table.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = 256;     ///< points a task
constexpr double kReach = 0.5;          ///< of an edge's length: what is further away is something else
constexpr double kOnFeature = 0.05;     ///< of an edge's length: its ends are there, if it stands for a feature
constexpr double kAlreadyThere = 1e-9;  ///< of an edge's length: rounding

/// A face or line that has the new point: as one of its edges' middles, or as its own.
struct Holder {
  std::uint32_t point, cell;  ///< cell: in the range of the faces, or of the lines
  bool is_line, is_forward;   ///< the edge's direction in the face
  std::uint32_t from, to;     ///< ends of the edge; of a quad's middle the longer diagonal's
  bool is_centre;
};

Point unit(Point v) {
  const double l = length(v);
  return l > 0 ? v / l : Point{};
}

class MovedPointFinder {
 public:
  MovedPointFinder(const Mesh& coarse, const MidPoints& mids, const Array<VertexId, Point>& points,
                   const TrueGeometry& geometry)
      : mesh_(coarse),
        mids_(mids),
        points_(points),
        geometry_(geometry),
        faces_(coarse, coarse.dimension == 2 ? -1 : 2),
        lines_(coarse, 1) {}

  BoundaryPlaces run(int threads) {
    collect_faces();
    collect_lines();
    std::sort(holders_.begin(), holders_.end(), [](const Holder& a, const Holder& b) {
      return std::tie(a.point, a.is_line, a.cell) < std::tie(b.point, b.is_line, b.cell);
    });
    std::vector<std::size_t> firsts;
    for (std::size_t i = 0; i < holders_.size(); ++i)
      if (i == 0 || holders_[i].point != holders_[i - 1].point) firsts.push_back(i);
    const std::size_t num_points = firsts.size();
    firsts.push_back(holders_.size());
    std::vector<Found> found(num_points);
    parallel_ranges(threads, num_points, kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        found[i] = place(std::span(holders_).subspan(firsts[i], firsts[i + 1] - firsts[i]));
    });
    BoundaryPlaces places;
    for (std::size_t i = 0; i < num_points; ++i) {
      if (found[i].moved) places.moved.push_back(*found[i].moved);
      if (found[i].is_looked_at) ++places.num_looked_at;
      if (found[i].is_out_of_reach) places.out_of_reach.push_back(holders_[firsts[i]].point);
    }
    return places;
  }

 private:
  struct Found {
    bool is_looked_at = false, is_out_of_reach = false;
    std::optional<MovedPoint> moved;
  };

  void collect_faces() {
    for (const CellRange::Part& part : faces_.parts()) {
      const ChildTable& table = child_table(part.block->type);
      for (std::size_t i = 0; i < part.block->size(); ++i) {
        const auto v = (*part.block)[i];
        std::uint32_t nodes[ChildTable::kMaxNodes];
        mids_.find_nodes(table, v.data(), i, nodes);
        const auto face = static_cast<std::uint32_t>(part.first + i);
        const std::size_t n = v.size();
        for (std::size_t k = 0; k < n; ++k) {
          const VertexId a = v[k], b = v[(k + 1) % n];
          add({mids_.of_edge(a.value, b.value), face, false, a < b, a.value, b.value, false});
        }
        if (table.has_centre) add_centre(v, nodes[table.num_nodes - 1], face);
      }
    }
  }

  void add_centre(std::span<const VertexId> v, std::uint32_t point, std::uint32_t face) {
    const auto diagonal = [&](std::size_t k) { return squared_length(mesh_.points[v[k + 2]] - mesh_.points[v[k]]); };
    const std::size_t k = diagonal(0) < diagonal(1) ? 1 : 0;
    add({point, face, false, true, v[k].value, v[k + 2].value, true});
  }

  void collect_lines() {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const std::uint32_t a = lines_[i][0].value, b = lines_[i][1].value;
      add({mids_.of_edge(a, b), static_cast<std::uint32_t>(i), true, true, a, b, false});
    }
  }

  /// What no cell has is refused when cells are divided.
  void add(const Holder& holder) {
    if (holder.point != VertexId::kNone) holders_.push_back(holder);
  }

  GroupId group_of(const CellRange& range, std::uint32_t cell) const {
    const CellRange::Part& part = range.part_of(cell);
    return part.block->group.empty() ? GroupId() : part.block->group[cell - part.first];
  }

  Point normal_of(std::uint32_t face) const {
    const auto v = faces_[face];
    const std::size_t last = v.size() - 1;  // of a quad the diagonals: (2 - 0) x (3 - 1)
    return unit(
        cross(mesh_.points[v[last - 1]] - mesh_.points[v[0]], mesh_.points[v[last]] - mesh_.points[v[last - 2]]));
  }

  Found place(std::span<const Holder> holders) const {
    const Point a = mesh_.points[VertexId(holders[0].from)], b = mesh_.points[VertexId(holders[0].to)];
    const Point middle = points_[VertexId(holders[0].point)];
    const double edge = distance(a, b), reach = kReach * edge;
    const auto moved_to = [&](const TrueGeometry::Hit& hit, bool on_feature) -> Found {
      if (!hit.found()) return {true, !geometry_.nearest(middle, reach).found(), {}};
      if (hit.distance <= kAlreadyThere * edge) return {true, false, {}};
      return {true, false, MovedPoint{holders[0].point, middle, hit.at, on_feature}};
    };
    if (may_be_feature(holders) && has_ends_on_features(a, b, kOnFeature * edge)) {
      const Holder& last = holders.back();
      const GroupId curve = last.is_line ? group_of(lines_, last.cell) : GroupId();
      if (mesh_.dimension == 2 && !geometry_.is_known(curve)) return {};
      const TrueGeometry::Hit hit = geometry_.nearest_on_features(middle, unit(b - a), curve, reach);
      if (hit.found() || mesh_.dimension == 2) return moved_to(hit, true);
    }
    if (holders[0].is_line || (holders.size() != 2 && !holders[0].is_centre && !holders.back().is_line)) return {};
    std::vector<GroupId> groups;
    Point normal;
    for (const Holder& h : holders) {
      if (h.is_line) continue;
      groups.push_back(group_of(faces_, h.cell));
      if (!geometry_.is_known(groups.back())) return {};
      const Point n = normal_of(h.cell);
      normal = normal + (groups.size() == 2 && h.is_forward == holders[0].is_forward ? -1 : 1) * n;
    }
    return moved_to(geometry_.nearest_on_surface(middle, unit(normal), groups, reach), false);
  }

  /// The middle of an edge between two faces of one group that lie nearly in a plane is not.
  bool may_be_feature(std::span<const Holder> holders) const {
    if (holders[0].is_centre) return false;
    if (holders.size() != 2 || holders[1].is_line) return is_any_known(holders);
    const GroupId group = group_of(faces_, holders[0].cell), other = group_of(faces_, holders[1].cell);
    if (group != other) return is_any_known(holders);
    const double sign = holders[0].is_forward == holders[1].is_forward ? -1 : 1;
    const double cosine = sign * dot(normal_of(holders[0].cell), normal_of(holders[1].cell));
    return cosine < geometry_.cos_feature_angle() && geometry_.is_known(group);
  }

  /// Else the edge is sharp only because the grid is coarse there. In the plane all that is known is curves.
  bool has_ends_on_features(Point a, Point b, double tolerance) const {
    return mesh_.dimension == 2 || (geometry_.is_on_feature(a, tolerance) && geometry_.is_on_feature(b, tolerance));
  }

  bool is_any_known(std::span<const Holder> holders) const {
    return std::any_of(holders.begin(), holders.end(),
                       [&](const Holder& h) { return h.is_line || geometry_.is_known(group_of(faces_, h.cell)); });
  }

  const Mesh& mesh_;
  const MidPoints& mids_;
  const Array<VertexId, Point>& points_;
  const TrueGeometry& geometry_;
  CellRange faces_, lines_;
  std::vector<Holder> holders_;
};

}  // namespace

BoundaryPlaces find_boundary_places(const Mesh& coarse, const MidPoints& mids, const Array<VertexId, Point>& points,
                                    const TrueGeometry& geometry, int threads) {
  return MovedPointFinder(coarse, mids, points, geometry).run(threads);
}

}  // namespace delfront
