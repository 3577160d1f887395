// SPDX-License-Identifier: Apache-2.0
#include "volume/front_closing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "spatial/box_octree.hpp"
#include "tetra/quality.hpp"
#include "volume/deepest_point.hpp"
#include "volume/recover.hpp"

namespace delfront {

namespace {

constexpr double kFloors[] = {0.02, 0.002, 1e-5, 0};  ///< least squared sines of dihedral angles
constexpr int kRounds = 20;
constexpr std::size_t kMostEmptied = 4;  ///< tets a round, so that the point can follow
constexpr std::size_t kMostFaces = 600;  ///< of a cavity that is filled round one point
constexpr int kHalvings = 8;
constexpr double kWidest = 32;  ///< sizes round obstacles that are emptied for constrained Delaunay

void sort_out_repeats(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

void insert_corners(BoxOctree& tree, const FrontStore& front, std::uint32_t f) {
  for (const VertexIndex v : front.nodes(f)) tree.insert(v, {front.complex().point(v), front.complex().point(v)});
}

/// By corners, so that what lies in a cavity is found. Obstacles have a tree of their own.
BoxOctree plant_tree(const FrontStore& front, const std::vector<std::uint32_t>& faces) {
  Box box;
  for (const std::uint32_t f : faces) box.add(front.box(f));
  BoxOctree tree;
  tree.clear(box);
  for (const std::uint32_t f : faces) insert_corners(tree, front, f);
  return tree;
}

HalfSpace half_space(const FrontStore& front, std::uint32_t f) {
  const auto n = front.nodes(f);
  const TetComplex& c = front.complex();
  const Point a = c.point(n[0]);
  return {a, cross(c.point(n[1]) - a, c.point(n[2]) - a)};
}

class CavityFiller {
 public:
  CavityFiller(FrontStore& front, BoxOctree& tree, FrontReport& report)
      : front_(front), c_(front.complex()), tree_(tree), report_(report) {}

  bool is_given_up(std::uint32_t f) const { return given_up_.count(key(f)) > 0; }

  /// Those that come on the way are added: other cavities may hang on them.
  std::vector<std::uint32_t> faces_to_see;

  /// Less and less is asked for; what was emptied in vain is put back.
  /// @return whether the cavity that has face f is filled
  bool fill(std::uint32_t f) {
    const auto first = front_.nodes(f);
    for (const bool from_kernel : {false, true})
      for (const double floor : kFloors) {
        from_kernel_ = from_kernel;
        emptied_.clear();
        if (try_fill(front_.find(first), floor)) return true;
        put_back();
      }
    collect(front_.find(first));
    for (const std::uint32_t g : faces_) given_up_.insert(key(g));
    return false;
  }

 private:
  /// Faces come again under other numbers.
  std::array<VertexIndex, 3> key(std::uint32_t f) const {
    auto n = front_.nodes(f);
    std::rotate(n.begin(), std::min_element(n.begin(), n.end()), n.end());
    return n;
  }

  bool try_fill(std::uint32_t f, double floor) {
    for (int round = 0; round < kRounds; ++round) {
      collect(f);
      if (faces_.size() > kMostFaces) return false;
      if (const VertexIndex apex = find_apex(floor); apex != kNoIndex) {
        add_star(apex);
        return true;
      }
      end_ = find_obstacle_end();
      const Point p = end_ == kNoIndex ? find_point() : c_.point(end_);
      if (empty_behind_bad_faces(p, floor) > 0) {
        if (made_.empty()) return false;
        f = made_[0];
        continue;
      }
      if (!sees_all(p) || !is_clear(p)) return false;
      add_star(end_ == kNoIndex ? add_point(p) : end_);
      return true;
    }
    return false;
  }

  /// The end of an obstacle in the cavity that can best be the point: no other can be, but one where the obstacle ends.
  VertexIndex find_obstacle_end() {
    VertexIndex best = kNoIndex;
    double highest = -1;
    for_each_obstacle([&](const FrontObstacle& o) {
      if (!winds_round(0.5 * (c_.point(o.a) + c_.point(o.b)))) return;
      for (const VertexIndex v : {o.a, o.b}) {
        batch_.measure(in_frame(v), quality_);
        double worst = front_.first_at(v) == kNoIndex ? 2 : 1;  // one that nothing hangs on yet goes first
        for (std::size_t i = 0; i < faces_.size(); ++i)
          if (!has_corner(faces_[i], v)) worst += std::min(quality_[i] - 1, 0.0) / static_cast<double>(faces_.size());
        if (worst > highest) highest = worst, best = v;
      }
    });
    return best;
  }

  template <class Visit>
  void for_each_obstacle(Visit&& visit) const {
    Box box;
    for (const std::uint32_t f : faces_) box.add(front_.box(f));
    const FrontObstacles& all = front_.obstacles();
    all.for_each_overlap(box, [&](std::uint32_t i) {
      if (all[i].is_pending() && all[i].region == front_.face(faces_[0]).region) visit(all[i]);
    });
  }

  bool has_corner(std::uint32_t f, VertexIndex v) const {
    const auto n = front_.nodes(f);
    return n[0] == v || n[1] == v || n[2] == v;
  }

  /// Whether a place lies in the cavity, about: by the solid angles of its faces.
  bool winds_round(const Point& p) const {
    double angle = 0;
    for (const std::uint32_t f : faces_) {
      const auto n = front_.nodes(f);
      const Point a = c_.point(n[0]) - p, b = c_.point(n[1]) - p, c = c_.point(n[2]) - p;
      const double u = length(a), v = length(b), w = length(c);
      angle += std::atan2(dot(a, cross(b, c)), u * v * w + dot(a, b) * w + dot(b, c) * u + dot(c, a) * v);
    }
    return std::fabs(angle) > std::numbers::pi;
  }

  void put_back() {
    FrontStock stock = front_.take(emptied_.size());
    report_.cells_emptied -= emptied_.size();
    made_.clear();
    for (; !emptied_.empty(); emptied_.pop_back()) {
      const auto& [n, region] = emptied_.back();
      bool is_back = false;
      for (unsigned i = 0; i < 4 && !is_back; ++i) {
        const auto& k = kFaceNodes[i];
        const std::uint32_t f = front_.find({n[k[0]], n[k[1]], n[k[2]]});
        is_back = f != kNoIndex;
        if (is_back) front_.add_tet(f, n[i], stock, made_);
      }
      if (!is_back) front_.add_island(n, region, made_);
    }
    faces_to_see.insert(faces_to_see.end(), made_.begin(), made_.end());
    front_.give(stock);
  }

  /// The faces that hang together with f by edges.
  void collect(std::uint32_t f) {
    faces_.assign(1, f);
    ++stamp_;
    front_.face(f).stamp = stamp_;
    for (std::size_t i = 0; i < faces_.size() && faces_.size() <= kMostFaces; ++i) {
      const auto n = front_.nodes(faces_[i]);
      for (unsigned k = 0; k < 3; ++k) {
        const VertexIndex a = n[k], b = n[k == 2 ? 0 : k + 1];
        for (std::uint32_t e = front_.first_at(b); e != kNoIndex; e = front_.next_at(e)) {
          FrontFace& g = front_.face(e >> 2);
          if (g.stamp == stamp_ || g.node[(e & 3) == 2 ? 0 : (e & 3) + 1] != a) continue;
          g.stamp = stamp_;
          faces_.push_back(e >> 2);
        }
      }
    }
    frame_ = front_.frame(f);
    batch_.clear();
    for (const std::uint32_t g : faces_) {
      const auto n = front_.nodes(g);
      batch_.add(in_frame(n[0]), in_frame(n[1]), in_frame(n[2]));
    }
  }

  /// Quality is that in the frame of one of the faces.
  Point in_frame(VertexIndex v) const { return frame_.to_frame(c_.point(v)); }

  /// Uphill in the worst quality: from the mean of the corners, or from within the kernel if that does not find it.
  Point find_point() {
    double q = 0;
    const Point p = climb_from(mean_of_corners(), q);
    if (q > 0 || !from_kernel_) return frame_.from_frame(p);
    planes_.clear();
    for (const std::uint32_t f : faces_) planes_.push_back(half_space(front_, f));
    const DeepestPoint deepest = find_deepest_point(planes_);
    return frame_.from_frame(deepest.depth > 0 ? climb_from(frame_.to_frame(deepest.at), q) : p);
  }

  Point mean_of_corners() const {
    Point p;
    for (const std::uint32_t f : faces_)
      for (const VertexIndex v : front_.nodes(f)) p = p + in_frame(v);
    return (1.0 / (3 * static_cast<double>(faces_.size()))) * p;
  }

  /// In the frame.
  Point climb_from(Point p, double& best) const {
    double extent = 0;
    for (const std::uint32_t f : faces_) extent = std::max(extent, distance(in_frame(front_.nodes(f)[0]), p));
    double step = 0.25 * extent;
    best = batch_.worst(p);
    for (int k = 0; k < kHalvings; ++k) {
      bool moved = false;
      for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
          Point next = p;
          next[axis] += sign * step;
          const double q = batch_.worst(next, best);
          if (q <= best) continue;
          p = next, best = q, moved = true;
        }
      if (!moved) step *= 0.5;
    }
    return p;
  }

  /// The tets behind faces that p sees badly go; those of the given boundary stay, however badly.
  std::size_t empty_behind_bad_faces(const Point& p, double floor) {
    batch_.measure(frame_.to_frame(p), quality_);
    made_.clear();
    std::size_t emptied = 0;
    order_.clear();
    for (std::uint32_t i = 0; i < faces_.size(); ++i)
      if (quality_[i] < floor && !has_corner(faces_[i], end_)) order_.push_back(i);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return quality_[a] < quality_[b]; });
    for (const std::uint32_t i : order_) {
      const FrontFace& f = front_.face(faces_[i]);
      if (!f.is_alive || f.is_boundary) continue;
      const TetIndex t = f.behind >> 2;
      const std::uint32_t* n = &c_.node[4 * t];
      emptied_.push_back({{n[0], n[1], n[2], n[3]}, c_.region[t]});
      front_.remove_tet(t, made_);
      if (++emptied == kMostEmptied) break;
    }
    std::erase_if(made_, [&](std::uint32_t f) { return !front_.face(f).is_alive; });
    for (const std::uint32_t f : made_) insert_corners(tree_, front_, f);
    faces_to_see.insert(faces_to_see.end(), made_.begin(), made_.end());
    report_.cells_emptied += emptied;
    return emptied;
  }

  bool sees_all(const Point& p) const {
    return std::all_of(faces_.begin(), faces_.end(), [&](std::uint32_t f) {
      const auto n = front_.nodes(f);
      return has_corner(f, end_) || orient3d(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), p) > 0;
    });
  }

  /// Whether no other part of the front, and no obstacle but those that end at p, lies in the cavity.
  bool is_clear(const Point& p) {
    Box box;
    for (const std::uint32_t f : faces_) box.add(front_.box(f));
    bool clear = true;
    tree_.for_each_overlap(box, [&](VertexIndex v) {
      if (clear && front_.first_at(v) != kNoIndex && is_inside(v, p)) clear = false;
    });
    for_each_obstacle([&](const FrontObstacle& o) { clear = clear && !meets_star(o, p); });
    return clear;
  }

  bool meets_star(const FrontObstacle& o, const Point& p) const {
    return std::any_of(faces_.begin(), faces_.end(), [&](std::uint32_t f) {
      const auto n = front_.nodes(f);
      const auto at = [&](VertexIndex v) { return NumberedPoint{v, c_.point(v)}; };
      return !has_corner(f, end_) && is_met_by_tet({at(o.a), at(o.b)}, {at(n[0]), at(n[1]), at(n[2]), {end_, p}});
    });
  }

  /// Whether v, if it is no corner of the cavity, lies in the star of p.
  bool is_inside(VertexIndex v, const Point& p) const {
    const Point at = c_.point(v);
    bool inside = false;
    for (const std::uint32_t f : faces_) {
      const auto n = front_.nodes(f);
      if (n[0] == v || n[1] == v || n[2] == v) return false;
      if (has_corner(f, end_)) continue;
      const Point a = c_.point(n[0]), b = c_.point(n[1]), c = c_.point(n[2]);
      inside = inside || (orient3d(a, b, c, at) >= 0 && orient3d(a, p, b, at) >= 0 && orient3d(b, p, c, at) >= 0 &&
                          orient3d(c, p, a, at) >= 0);
    }
    return inside;
  }

  /// The fourth corner of a cavity that is a tet; kNoIndex where that is none, or a bad one.
  VertexIndex find_apex(double floor) {
    if (faces_.size() != 4) return kNoIndex;
    const auto n = front_.nodes(faces_[0]);
    for (const VertexIndex v : front_.nodes(faces_[1])) {
      if (v == n[0] || v == n[1] || v == n[2]) continue;
      const Point a = c_.point(n[0]), b = c_.point(n[1]), c = c_.point(n[2]), d = c_.point(v);
      const double quality = measure_quality(in_frame(n[0]), in_frame(n[1]), in_frame(n[2]), in_frame(v));
      if (quality < floor || orient3d(a, b, c, d) <= 0) continue;
      end_ = v;
      return is_clear(d) ? v : kNoIndex;
    }
    return kNoIndex;
  }

  void add_star(VertexIndex apex) {
    FrontStock stock = front_.take(faces_.size());
    made_.clear();
    for (const std::uint32_t f : faces_)
      if (front_.face(f).is_alive && !has_corner(f, apex))
        ++report_.cells_refilled, front_.add_tet(f, apex, stock, made_);
    front_.give(stock);
  }

  VertexIndex add_point(const Point& p) {
    double h = 0;
    for (const std::uint32_t f : faces_) h += c_.vertex[front_.nodes(f)[0]].h;
    const VertexIndex v = c_.take_vertices(1)[0];
    c_.set_vertex(v, p, h / static_cast<double>(faces_.size()));
    front_.add_vertex();
    if (front_.sizes().are_stretched()) front_.sizes().ask(v);
    ++report_.points;
    return v;
  }

  FrontStore& front_;
  TetComplex& c_;
  BoxOctree& tree_;
  FrontReport& report_;
  std::uint64_t stamp_ = std::uint64_t{1} << 63;
  std::vector<std::uint32_t> faces_, made_, order_;
  VertexIndex end_ = kNoIndex;  ///< a vertex that is there and is to be the point
  struct Emptied {
    std::array<VertexIndex, 4> nodes;
    std::uint32_t region;
  };
  std::set<std::array<VertexIndex, 3>> given_up_;
  std::vector<Emptied> emptied_;  ///< tets, in order
  FrontFrame frame_;
  FaceBatch batch_;
  std::vector<double> quality_;
  bool from_kernel_ = false;
  std::vector<HalfSpace> planes_;
};

}  // namespace

std::vector<std::uint32_t> fill_cavities(FrontStore& front, const std::vector<std::uint32_t>& faces,
                                         FrontReport& report, Context& context) {
  BoxOctree tree = plant_tree(front, faces);
  CavityFiller filler(front, tree, report);
  filler.faces_to_see = faces;
  for (const std::uint32_t f : faces) front.face(f).stamp = 0;    // of an earlier time
  for (std::size_t i = 0; i < filler.faces_to_see.size(); ++i) {  // it grows
    const std::uint32_t f = filler.faces_to_see[i];
    if (!front.face(f).is_alive || filler.is_given_up(f)) continue;
    context.check_limits();
    ++report.cavities;
    if (!filler.fill(f)) ++report.cavities_left;
  }
  std::vector<std::uint32_t> left = std::move(filler.faces_to_see);
  std::erase_if(left, [&](std::uint32_t f) { return !front.face(f).is_alive; });
  sort_out_repeats(left);
  return left;
}

std::vector<std::uint32_t> empty_around(FrontStore& front, const std::vector<std::uint32_t>& faces,
                                        FrontReport& report) {
  std::vector<std::uint32_t> near, made;
  for (const std::uint32_t f : faces)
    for (const VertexIndex v : front.nodes(f))
      for (std::uint32_t e = front.first_at(v); e != kNoIndex; e = front.next_at(e)) near.push_back(e >> 2);
  sort_out_repeats(near);
  std::vector<TetIndex> behind;
  for (const std::uint32_t f : near)
    if (!front.face(f).is_boundary) behind.push_back(front.face(f).behind >> 2);
  sort_out_repeats(behind);
  for (const TetIndex t : behind) front.remove_tet(t, made);
  report.cells_emptied += behind.size();
  std::vector<std::uint32_t> all;
  for (std::uint32_t f = 0; f < front.num_slots(); ++f)
    if (front.face(f).is_alive) all.push_back(f);
  return all;
}

std::vector<Place> places_of_cavities(const FrontStore& front, const std::vector<std::uint32_t>& faces) {
  std::unordered_map<VertexIndex, VertexIndex> towards;  // trees of corners; at a root itself
  const auto root_of = [&](VertexIndex v) {
    for (VertexIndex up = towards.try_emplace(v, v).first->second; up != v; up = towards[v]) {
      towards[v] = towards[up];
      v = up;
    }
    return v;
  };
  for (const std::uint32_t f : faces) {
    const auto n = front.nodes(f);
    for (unsigned i = 1; i < 3; ++i) towards[root_of(n[i])] = root_of(n[0]);
  }
  std::map<VertexIndex, std::vector<std::uint32_t>> cavities;
  for (const std::uint32_t f : faces) cavities[root_of(front.nodes(f)[0])].push_back(f);
  std::vector<const std::vector<std::uint32_t>*> widest_first;
  for (const auto& [root, cavity] : cavities) widest_first.push_back(&cavity);
  std::stable_sort(widest_first.begin(), widest_first.end(), [](auto* a, auto* b) { return a->size() > b->size(); });
  if (widest_first.size() > kMaxPlaces) widest_first.resize(kMaxPlaces);
  std::vector<Place> places;
  for (const auto* cavity : widest_first) {
    const auto n = front.nodes(cavity->front());
    const TetComplex& c = front.complex();
    places.push_back({(1.0 / 3) * (c.point(n[0]) + c.point(n[1]) + c.point(n[2])), {}});
  }
  return places;
}

namespace {

/// The cavities as a model of their own: one patch, faces turned outwards.
struct CavityModel {
  Model model;
  std::vector<VertexIndex> vertex;  ///< of the complex, by point of the model
};

/// With the obstacles of the region, all of which lie in cavities by now.
CavityModel model_of(FrontStore& front, const std::vector<std::uint32_t>& faces, std::uint32_t region) {
  CavityModel cavity;
  const TetComplex& c = front.complex();
  std::unordered_map<VertexIndex, VertexId> number;
  const auto number_of = [&](VertexIndex v) {
    const auto [at, is_new] = number.try_emplace(v, VertexId(cavity.vertex.size()));
    if (is_new) {
      cavity.vertex.push_back(v);
      cavity.model.points.push_back(c.point(v));
    }
    return at->second;
  };
  cavity.model.patches.push_back({"cavities", ""});
  for (const std::uint32_t f : faces) {
    const auto n = front.nodes(f);
    const std::uint32_t twin = front.find({n[0], n[2], n[1]});  // a sheet in the region is one triangle
    if (twin < f && front.face(twin).region == front.face(f).region) continue;
    std::array<VertexId, 3> corner;
    for (unsigned i = 0; i < 3; ++i) corner[i] = number_of(n[i == 0 ? 0 : 3 - i]);
    cavity.model.triangles.push_back(corner);
    cavity.model.patch_of_triangle.push_back(PatchId(0));
    cavity.model.input_face.push_back(f);
  }
  const FrontObstacles& obstacles = front.obstacles();
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const FrontObstacle& o = obstacles[i];
    if (!o.is_pending() || o.region != region) continue;
    if (o.is_point())
      cavity.model.corners.push_back(number_of(o.a));
    else
      cavity.model.curves.push_back({"", {number_of(o.a), number_of(o.b)}});
  }
  return cavity;
}

/// @return false where embedded edges would have to be divided: nothing has changed then
bool close_region(FrontStore& front, const std::vector<std::uint32_t>& faces, std::uint32_t region, FrontReport& report,
                  Context& context) {
  CavityModel cavity = model_of(front, faces, region);
  RecoveryReport recovery;
  const BoundaryGrid grid = tetrahedralize_boundary(cavity.model, DomainOptions(), {false}, recovery, context);
  if (!grid.split.empty()) throw MeshingError("faces of cavities would have to be divided", recovery.left);
  const bool has_all = recovery.curve_edges == cavity.model.curves.size() && recovery.curve_edges_split == 0 &&
                       recovery.embedded_points == cavity.model.corners.size();
  if (!has_all) return false;
  const TetComplex& from = grid.complex;
  TetComplex& c = front.complex();
  for (auto v = static_cast<VertexIndex>(cavity.vertex.size()); v < from.num_vertices(); ++v) {
    const VertexIndex own = c.take_vertices(1)[0];
    c.set_vertex(own, from.point(v), from.vertex[v].h);
    cavity.vertex.push_back(own);
    front.add_vertex();
    if (front.sizes().are_stretched()) front.sizes().ask(own);
  }
  report.closed_by_delaunay += front.add_tets(from, cavity.vertex);
  return true;
}

/// Take away what is within some sizes of the obstacles that have no tets: edges are found more easily where there is
/// room.
/// @return the faces of the region
std::vector<std::uint32_t> empty_along_obstacles(FrontStore& front, std::uint32_t region, double sizes,
                                                 FrontReport& report) {
  const TetComplex& c = front.complex();
  std::vector<std::array<VertexIndex, 2>> pending;
  for (std::size_t i = 0; i < front.obstacles().size(); ++i)
    if (const FrontObstacle& o = front.obstacles()[i]; o.is_pending() && o.region == region)
      pending.push_back({o.a, o.b});
  const auto is_near = [&](VertexIndex v) {
    return std::any_of(pending.begin(), pending.end(), [&](const auto& ends) {
      const Point to = c.point(v) - c.point(ends[0]), along = c.point(ends[1]) - c.point(ends[0]);
      const double l2 = squared_length(along), t = l2 > 0 ? std::clamp(dot(to, along) / l2, 0.0, 1.0) : 0;
      return length(to - t * along) < sizes * c.vertex[v].h;
    });
  };
  std::vector<std::uint32_t> made;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t) || c.region[t] != region) continue;
    const std::uint32_t* n = &c.node[4 * t];
    if (std::none_of(n, n + 4, is_near)) continue;
    front.remove_tet(t, made);
    ++report.cells_emptied;
  }
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < front.num_slots(); ++f)
    if (front.face(f).is_alive && front.face(f).region == region) faces.push_back(f);
  return faces;
}

}  // namespace

void close_by_delaunay(FrontStore& front, const std::vector<std::uint32_t>& faces, FrontReport& report,
                       Context& context) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> of_region;
  for (const std::uint32_t f : faces) of_region[front.face(f).region].push_back(f);
  Context quiet = context;  // it warns of edges that it divides
  quiet.on_log = nullptr;
  for (auto& [region, some] : of_region) {
    double sizes = 1;
    while (!close_region(front, some, region, report, quiet)) {
      if (sizes > kWidest) throw MeshingError("embedded edges in cavities would have to be divided");
      some = empty_along_obstacles(front, region, sizes, report);
      sizes *= 2;
    }
  }
}

}  // namespace delfront
