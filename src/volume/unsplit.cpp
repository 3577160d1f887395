// SPDX-License-Identifier: Apache-2.0
// Terms: the star of s is cut by constrained faces into sectors, one a region (or outside) between two facets. The
// faces of one facet that touch s form a path from the vertex before s on its edge to the vertex after it. Without s a
// path's polygon is triangulated again; its triangles bound the sectors on both sides of it.
#include "volume/unsplit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "volume/curve_points.hpp"
#include "volume/edge_flips.hpp"
#include "volume/facets.hpp"
#include "volume/thin_out.hpp"
#include "volume/visible_point.hpp"

namespace delfront {

namespace {

constexpr int kMaxPasses = 20;
constexpr double kFlat = 1e-7;  ///< mean ratio of a tet that is flat to rounding: a place to avoid as long as possible
constexpr int kMaxGrowth = 60;  ///< tets that a sector takes in beyond the star of its point
constexpr int kMaxCurvePasses = 3;  ///< in which nothing has moved, before points on curves stay
constexpr int kLookAheads = 6;      ///< places on which walls in the way are looked for, tried in turn:
constexpr double kCloser = 1. / 8;  ///< of the sector's reach from its point inwards, and so on

using Face = std::array<VertexIndex, 3>;

struct Path {
  std::vector<VertexIndex> vertices;  ///< from the vertex before s to the one after it
  std::vector<Face> triangles;        ///< of the polygon without s, in the order of the path
  int sector[2] = {-1, -1};           ///< on the side that the triangles' normals point to, and on the other
};

struct Sector {
  std::vector<TetIndex> tets;
  bool is_ghost = false;
  std::uint32_t region = TetComplex::kOutside;
  std::vector<Face> walls;                         ///< link faces and polygon triangles, normals inwards
  std::vector<FaceRef> wall_ref;                   ///< of the link faces, which come first: of the sector's tet
  std::ptrdiff_t num_polygon_walls = 0;            ///< the last ones of them
  std::optional<Point> moved;                      ///< where its point goes; none where it is filled without one
  std::vector<std::array<VertexIndex, 4>> filled;  ///< then: how
};

class PointRemoval {
 public:
  PointRemoval(TetComplex& complex, const Segments& segments) : c_(complex), segments_(segments) {}

  /// 1: take in tets beyond the star where nothing else helps; more: and take any place at all, and look elsewhere for
  /// what is in the way.
  int growth = 0;
  /// Whether the last point that had to stay lies on an edge where a facet ends, with one region on both its sides.
  bool is_at_sheet_border = false;

  /// @return false where s has to stay
  bool remove(VertexIndex s) {
    s_ = s;
    is_at_sheet_border = false;
    c_.star(s, star_);
    segments_.neighbours(s, ends_);
    if (!find_sectors() || !find_paths() || !triangulate_paths()) return false;
    for (Sector& sector : sectors_)
      if (!sector.is_ghost && !place(sector) && !fill_without_point(sector) && !(growth > 0 && grow(sector)))
        return false;
    rebuild();
    return true;
  }

 private:
  bool find_sectors() {
    sectors_.clear();
    sector_of_.clear();
    for (const TetIndex first : star_) {
      if (sector_of_.contains(first)) continue;
      Sector sector;
      sector.is_ghost = c_.is_ghost(first);
      sector.region = c_.region[first];
      const int id = static_cast<int>(sectors_.size());
      sector.tets.push_back(first);
      sector_of_[first] = id;
      for (std::size_t i = 0; i < sector.tets.size(); ++i)
        for (unsigned f = 0; f < 4; ++f) {
          const FaceRef ref = 4 * sector.tets[i] + f;
          if (c_.node[ref] == s_ || c_.is_constrained(ref)) continue;
          const TetIndex next = c_.neigh[ref] >> 2;
          if (sector_of_.try_emplace(next, id).second) sector.tets.push_back(next);
        }
      sectors_.push_back(std::move(sector));
    }
    return true;
  }

  /// Follows the constrained faces from the vertex before s to the one after it.
  bool find_paths() {
    struct Wing {
      FaceRef ref;
      VertexIndex other;
    };
    std::map<VertexIndex, std::vector<Wing>> wings;  // by link vertex: the faces (s, vertex, other), once each
    std::size_t faces = 0;
    for (const TetIndex t : star_)
      for (unsigned f = 0; f < 4; ++f) {
        const FaceRef ref = 4 * t + f;
        if (c_.node[ref] == s_ || !c_.is_constrained(ref) || ref > c_.neigh[ref]) continue;
        const auto n = c_.face_nodes(ref);
        const auto at = static_cast<std::size_t>(std::find(n.begin(), n.end(), s_) - n.begin());
        const VertexIndex x = n[(at + 1) % 3], y = n[(at + 2) % 3];
        wings[x].push_back({ref, y});
        wings[y].push_back({ref, x});
        ++faces;
      }
    paths_.clear();
    std::size_t walked = 0;
    for (const Wing& start : wings[ends_[0]]) {
      Path path;
      path.vertices = {ends_[0], start.other};
      sides_of(start.ref, ends_[0], path);
      FaceRef came = start.ref;
      while (path.vertices.back() != ends_[1]) {
        const auto& here = wings[path.vertices.back()];
        if (here.size() != 2) return false;
        const Wing& next = here[here[0].ref == came ? 1 : 0];
        came = next.ref;
        path.vertices.push_back(next.other);
      }
      walked += path.vertices.size() - 1;
      paths_.push_back(std::move(path));
    }
    return walked == faces && !paths_.empty();
  }

  /// The sectors on both sides of face (s, x, next on the path).
  void sides_of(FaceRef ref, VertexIndex x, Path& path) {
    const auto n = c_.face_nodes(ref);
    const auto at = static_cast<std::size_t>(std::find(n.begin(), n.end(), s_) - n.begin());
    const bool same_side = n[(at + 1) % 3] == x;  // the normal of (s, x, next) points into ref's own tet
    path.sector[same_side ? 0 : 1] = sector_of_.at(ref >> 2);
    path.sector[same_side ? 1 : 0] = sector_of_.at(c_.neigh[ref] >> 2);
  }

  bool triangulate_paths() {
    for (Path& path : paths_) {
      is_at_sheet_border = path.sector[0] == path.sector[1];
      if (is_at_sheet_border) return false;
      const VertexIndex apex = off_plane(path);
      if (apex == kNoIndex || !clip_ears(path, apex)) return false;
    }
    for (Sector& sector : sectors_) {
      for (const TetIndex t : sector.tets) {
        if (sector.is_ghost) continue;
        sector.wall_ref.push_back(4 * t + static_cast<unsigned>(c_.local_index(t, s_)));
        sector.walls.push_back(c_.face_nodes(sector.wall_ref.back()));
      }
    }
    for (const Path& path : paths_)
      for (const Face& f : path.triangles)
        for (const int side : {0, 1}) {
          Sector& sector = sectors_[static_cast<std::size_t>(path.sector[side])];
          sector.walls.push_back(side == 0 ? f : Face{f[0], f[2], f[1]});
          ++sector.num_polygon_walls;
        }
    return true;
  }

  VertexIndex off_plane(const Path& path) {
    for (const TetIndex t : star_) {
      if (c_.is_ghost(t)) continue;
      for (unsigned k = 0; k < 4; ++k) {
        const VertexIndex v = c_.node[4 * t + k];
        if (v != s_ && c_.orient(s_, path.vertices[0], path.vertices[1], v) != 0) return v;
      }
    }
    return kNoIndex;
  }

  bool clip_ears(Path& path, VertexIndex apex) {
    std::vector<VertexIndex> left = path.vertices;
    const int sign = c_.orient(s_, left[0], left[1], apex);
    auto turns = [&](VertexIndex a, VertexIndex b, VertexIndex c) { return c_.orient(a, b, c, apex) * sign; };
    auto is_ear = [&](std::size_t i) {
      const VertexIndex a = left[i - 1], b = left[i], c = left[i + 1];
      if (turns(a, b, c) <= 0) return false;
      for (const VertexIndex v : left)
        if (v != a && v != b && v != c && turns(a, b, v) >= 0 && turns(b, c, v) >= 0 && turns(c, a, v) >= 0)
          return false;
      return true;
    };
    path.triangles.clear();
    while (left.size() > 2) {
      std::size_t best = 0;
      double shortest = 0;
      for (std::size_t i = 1; i + 1 < left.size(); ++i) {
        const double cut = distance(c_.point(left[i - 1]), c_.point(left[i + 1]));
        if ((best == 0 || cut < shortest) && is_ear(i)) best = i, shortest = cut;
      }
      if (best == 0) return false;
      path.triangles.push_back({left[best - 1], left[best], left[best + 1]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return true;
  }

  /// Finds a place that sees all walls of a sector, from s inwards.
  bool place(Sector& sector) {
    const Point s = c_.point(s_);
    Point centre;
    double reach = 0;
    std::vector<Wall> walls;
    for (const Face& f : sector.walls) {
      walls.push_back({c_.exact(f[0]), c_.exact(f[1]), c_.exact(f[2])});
      for (const VertexIndex v : f) {
        centre = centre + c_.point(v) / (3 * static_cast<double>(sector.walls.size()));
        reach = std::max(reach, distance(s, c_.point(v)));
      }
    }
    sector.moved = find_visible_point(walls, s, {centre - s, inwards_of(sector)}, reach, growth > 1);
    if (growth <= 1 && sector.moved && measure_worst_ratio(walls, *sector.moved) < kFlat) sector.moved.reset();
    return sector.moved.has_value();
  }

  /// The direction from s that leads away from all the polygons of a sector.
  Point inwards_of(const Sector& sector) const {
    const Point s = c_.point(s_);
    Point inwards;
    for (const Path& path : paths_)
      for (const int side : {0, 1})
        if (&sectors_[static_cast<std::size_t>(path.sector[side])] == &sector) {
          const Point n = cross(c_.point(path.vertices[0]) - s, c_.point(path.vertices[1]) - s);
          if (const double l = length(n); l > 0) inwards = inwards + (side == 0 ? 1 : -1) * n / l;
        }
    return inwards;
  }

  /// Takes in the tets behind walls that leave no place to see them from, until there is one.
  bool grow(Sector& sector) {
    for (int k = 0; k < kMaxGrowth; ++k) {
      if (!take_tet_behind_nearest_wall(sector)) return false;
      if (place(sector) && loses_nothing_given(sector)) return true;
    }
    return false;
  }

  bool take_tet_behind_nearest_wall(Sector& sector) {
    const Point s = c_.point(s_), inwards = inwards_of(sector);
    double reach = 0;
    for (const Face& f : sector.walls) reach = std::max(reach, distance(s, c_.point(f[0])));
    const double norm = length(inwards);
    const Point look = norm > 0 ? s + (std::pow(kCloser, 1 + growth % kLookAheads) * reach / norm) * inwards : s;
    std::size_t nearest = kNoIndex;
    double least = 0;
    for (std::size_t i = 0; i < sector.wall_ref.size(); ++i) {
      if (!may_take(sector, c_.neigh[sector.wall_ref[i]])) continue;
      const Face& f = sector.walls[i];
      const Point n = cross(c_.point(f[1]) - c_.point(f[0]), c_.point(f[2]) - c_.point(f[0]));
      const double l = length(n), ahead = l > 0 ? dot(n, look - c_.point(f[0])) / l : 0;
      if (nearest == kNoIndex || ahead < least) nearest = i, least = ahead;
    }
    if (nearest == kNoIndex) return false;
    take(sector, c_.neigh[sector.wall_ref[nearest]] >> 2);
    return true;
  }

  bool may_take(const Sector& sector, FaceRef behind) const {
    const TetIndex t = behind >> 2;
    if (c_.is_constrained(behind) || c_.is_ghost(t) || c_.region[t] != sector.region) return false;
    const int id = static_cast<int>(&sector - sectors_.data());
    for (unsigned f = 0; f < 4; ++f) {
      const auto found = sector_of_.find(c_.neigh[4 * t + f] >> 2);
      if (found == sector_of_.end()) continue;
      if (found->second != id || c_.is_constrained(4 * t + f)) return false;
    }
    return !sector_of_.contains(t);
  }

  void take(Sector& sector, TetIndex t) {
    sector.tets.push_back(t);
    sector_of_[t] = static_cast<int>(&sector - sectors_.data());
    for (unsigned f = 0; f < 4; ++f) {
      const FaceRef ref = 4 * t + f;
      const auto shared = std::find(sector.wall_ref.begin(), sector.wall_ref.end(), c_.neigh[ref]);
      if (shared != sector.wall_ref.end()) {
        sector.walls.erase(sector.walls.begin() + (shared - sector.wall_ref.begin()));
        sector.wall_ref.erase(shared);
      } else {
        sector.walls.insert(sector.walls.begin(), c_.face_nodes(ref));
        sector.wall_ref.insert(sector.wall_ref.begin(), ref);
      }
    }
  }

  /// Only free vertices, and edges that are not kept, may vanish inside of a sector that has grown.
  bool loses_nothing_given(const Sector& sector) const {
    const auto is_in_wall = [&](VertexIndex a, VertexIndex b) {
      return std::any_of(sector.walls.begin(), sector.walls.end(), [&](const Face& f) {
        return std::find(f.begin(), f.end(), a) != f.end() && std::find(f.begin(), f.end(), b) != f.end();
      });
    };
    if (c_.loses_kept_edge(sector.tets, is_in_wall)) return false;
    for (const TetIndex t : sector.tets)
      for (unsigned k = 0; k < 4; ++k) {
        const VertexIndex v = c_.node[4 * t + k];
        if (v == s_ || (!c_.on_boundary[v] && !c_.segment_points.contains(v))) continue;
        if (std::none_of(sector.walls.begin(), sector.walls.end(),
                         [v](const Face& f) { return f[0] == v || f[1] == v || f[2] == v; }))
          return false;
      }
    return true;
  }

  bool fill_without_point(Sector& sector) {
    std::vector<VertexIndex> vertices;
    for (const Face& f : sector.walls) vertices.insert(vertices.end(), f.begin(), f.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::vector<ExactPoint> points;
    for (const VertexIndex v : vertices) points.push_back(c_.exact(v));
    auto local = [&](VertexIndex v) {
      return static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin());
    };
    std::vector<std::array<std::uint32_t, 3>> faces;
    for (const Face& f : sector.walls) faces.push_back({local(f[0]), local(f[1]), local(f[2])});
    std::vector<std::array<std::uint32_t, 4>> tets;
    if (!fill_polyhedron(points, faces, tets)) return false;
    for (const auto& t : tets)
      sector.filled.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]], vertices[t[3]]});
    return true;
  }

  /// Each sector's tets give way to one a wall, or to those that fill it. Faces are matched inside of each sector; the
  /// polygons' triangles across them.
  void rebuild() {
    c_.segment_points.erase(s_);
    c_.vertex_tet[s_] = kNoIndex;
    const double h = c_.vertex[s_].h;
    bool s_is_used = false;
    for (Sector& sector : sectors_) {
      VertexIndex apex = kGhost;
      if (sector.moved) {
        apex = s_is_used ? c_.add_vertex(*sector.moved, h) : s_;
        c_.vertex[apex] = {sector.moved->x, sector.moved->y, sector.moved->z, h};
        c_.on_boundary[apex] = 0;
        s_is_used = true;
      }
      if (sector.filled.empty())
        for (const auto& [x, y, z] : sector.walls) sector.filled.push_back({x, y, z, apex});
      if (sector.is_ghost) sector.filled.erase(sector.filled.begin(), sector.filled.end() - sector.num_polygon_walls);
    }
    std::map<std::pair<Face, int>, FaceRef> polygon_faces;  // sorted triangle and side
    for (std::size_t i = 0; i < sectors_.size(); ++i) fill(static_cast<int>(i), polygon_faces);
    for (const auto& [key, ref] : polygon_faces) {
      if (key.second != 0) continue;
      c_.bond(ref, polygon_faces.at({key.first, 1}));
      c_.set_constrained_both(ref, true);
    }
  }

  static Face sorted(Face f) {
    std::sort(f.begin(), f.end());
    return f;
  }

  void fill(int id, std::map<std::pair<Face, int>, FaceRef>& polygon_faces) {
    const Sector& sector = sectors_[static_cast<std::size_t>(id)];
    std::map<Face, std::pair<FaceRef, bool>> open;
    for (const TetIndex t : sector.tets)
      for (unsigned f = 0; f < 4; ++f) {
        const FaceRef ref = 4 * t + f;
        if (c_.node[ref] != s_ && c_.has_vertex(t, s_)) continue;
        const auto beyond = sector_of_.find(c_.neigh[ref] >> 2);
        if (beyond != sector_of_.end() && beyond->second == id) continue;
        open[sorted(c_.face_nodes(ref))] = {c_.neigh[ref], c_.is_constrained(ref)};
      }
    for (const TetIndex t : sector.tets) {
      if (!sector.is_ghost)
        for (unsigned k = 0; k < 4; ++k)
          if (c_.node[4 * t + k] != s_) c_.vertex_tet[c_.node[4 * t + k]] = kNoIndex;
      c_.kill_tet(t);
    }
    std::map<Face, int> polygon_side;
    for (const Path& path : paths_)
      for (const int side : {0, 1})
        if (path.sector[side] == id)
          for (const Face& f : path.triangles) polygon_side[sorted(f)] = side;
    for (const auto& n : sector.filled) {
      const TetIndex t = c_.new_tet();
      c_.set_nodes(t, n[0], n[1], n[2], n[3]);
      c_.flag[t] = TetComplex::fresh;
      c_.region[t] = sector.region;
      if (!sector.is_ghost)
        for (const VertexIndex v : n) c_.vertex_tet[v] = t;
      for (unsigned f = 0; f < 4; ++f) {
        const FaceRef ref = 4 * t + f;
        const Face key = sorted(c_.face_nodes(ref));
        if (const auto side = polygon_side.find(key); side != polygon_side.end()) {
          polygon_faces[{key, side->second}] = ref;
        } else if (const auto found = open.find(key); found != open.end()) {
          c_.bond(ref, found->second.first);
          c_.set_constrained(ref, found->second.second);
          open.erase(found);
        } else {
          open[key] = {ref, false};
        }
      }
    }
    DELFRONT_CHECK(open.empty());
  }

  TetComplex& c_;
  const Segments& segments_;
  VertexIndex s_ = kNoIndex;
  std::vector<VertexIndex> ends_;
  std::vector<TetIndex> star_;
  std::vector<Sector> sectors_;
  std::map<TetIndex, int> sector_of_;
  std::vector<Path> paths_;
};

void forget(Segments& segments, VertexIndex s) {
  auto& chain = segments.chain[segments.steiner_edge[s - segments.first_steiner]];
  std::erase_if(chain, [&](const Segments::Steiner& p) { return p.vertex == s; });
}

bool is_on_curve(const Segments& segments, VertexIndex s) {
  return segments.steiner_edge[s - segments.first_steiner] >= segments.num_surface_edges;
}

/// Takes the free vertices around s away, or moves those that stay to where their own tets are best.
void make_room(TetComplex& c, VertexIndex s) {
  std::vector<TetIndex> star, ball;
  c.star(s, star);
  std::vector<VertexIndex> around;
  for (const TetIndex t : star)
    for (unsigned k = 0; k < 4; ++k)
      if (const VertexIndex v = c.node[4 * t + k];
          v != kGhost && v != s && !c.on_boundary[v] && !c.segment_points.contains(v))
        around.push_back(v);
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  for (const VertexIndex v : around) {
    if (contract_free_vertex(c, v, false)) continue;
    c.star(v, ball);
    std::vector<Wall> walls;
    Point centre;
    double reach = 0;
    for (const TetIndex t : ball) {
      const Face f = c.face_nodes(4 * t + static_cast<unsigned>(c.local_index(t, v)));
      walls.push_back({c.exact(f[0]), c.exact(f[1]), c.exact(f[2])});
      for (const VertexIndex w : f) centre = centre + c.point(w) / (3 * static_cast<double>(ball.size()));
      reach = std::max(reach, distance(c.point(v), c.point(f[0])));
    }
    if (const auto place = find_visible_point(walls, c.point(v), {centre - c.point(v)}, reach))
      c.vertex[v] = {place->x, place->y, place->z, c.vertex[v].h};
  }
}

/// Points that stay become plain coordinates; every tet around them has to stay positive.
/// @param at_border  the points of them that lie on the border of a sheet
void round_points(TetComplex& c, const Segments& segments, const std::vector<VertexIndex>& left,
                  const std::set<VertexIndex>& at_border, RecoveryReport& report) {
  std::vector<TetIndex> star;
  c.segment_points.clear();
  for (const VertexIndex s : left) {
    c.on_boundary[s] = 1;
    const Point at = c.point(s);
    report.left.push_back({at, {s}});
    report.left_why.push_back(
        is_on_curve(segments, s) ? "an edge of a curve stays divided: switches did not find it whole"
        : at_border.contains(s)  ? "a sheet ends at this edge, and one region lies all round it: a point that leaves "
                                   "the edge would have to cross the sheet"
                                 : "no place inside sees all around the point in double precision: the surface is "
                                   "too thin there");
    c.star(s, star);
    for (const TetIndex t : star) {
      const std::uint32_t* n = &c.node[4 * t];
      if (!c.is_ghost(t) && c.orient(n[0], n[1], n[2], n[3]) <= 0)
        throw MeshingError(
            fmt::format("boundary recovery: a point on an edge near ({:g}, {:g}, {:g}) cannot be rounded to "
                        "double precision without turning a cell over; the surface is too thin there",
                        at.x, at.y, at.z),
            {{at, {s}}});
    }
  }
}

}  // namespace

void unsplit_boundary(TetComplex& complex, Segments& segments, RecoveryReport& report, Context& context) {
  std::vector<VertexIndex> left;
  const auto first = static_cast<VertexIndex>(segments.first_steiner);
  for (VertexIndex s = first; s < first + segments.steiner_edge.size(); ++s) {
    if (complex.vertex_tet[s] == kNoIndex)
      complex.segment_points.erase(s);  // on a border of nothing that is kept
    else
      left.push_back(s);
  }
  report.steiner_points = segments.steiner_edge.size();
  std::reverse(left.begin(), left.end());  // the last ones split the shortest pieces
  PointRemoval removal(complex, segments);
  EdgeFlips flips(complex, complex.kept_edges);  // constrained faces hold all other edges that matter
  std::vector<VertexIndex> ends;
  const auto remove = [&](VertexIndex s) {
    if (!is_on_curve(segments, s)) return removal.remove(s);
    removal.is_at_sheet_border = false;
    if (removal.growth > kMaxCurvePasses) return false;
    ends.clear();
    segments.neighbours(s, ends);
    return remove_curve_point(complex, s, ends[0], ends[1], removal.growth > 0);
  };
  std::set<VertexIndex> at_border;
  for (int pass = 0; pass < kMaxPasses && !left.empty(); ++pass) {
    std::vector<VertexIndex> still;
    at_border.clear();
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (remove(left[i])) {
        forget(segments, left[i]);
        ++report.steiner_moved;
      } else {
        still.push_back(left[i]);
        if (removal.is_at_sheet_border) at_border.insert(left[i]);
      }
      if (i % 64 == 0) context.progress("recover", i, left.size(), "points moved off edges");
    }
    const bool is_stuck = still.size() == left.size();
    left = std::move(still);
    if (!is_stuck) continue;
    ++removal.growth;
    // Other tets around a point, or its neighbours at better places, may let it go.
    for (const VertexIndex s : left) make_room(complex, s);
    flips.restore_delaunay(context);
  }
  report.curve_points_left = static_cast<std::size_t>(
      std::count_if(left.begin(), left.end(), [&](VertexIndex s) { return is_on_curve(segments, s); }));
  report.steiner_left = left.size() - report.curve_points_left;
  round_points(complex, segments, left, at_border, report);
}

}  // namespace delfront
