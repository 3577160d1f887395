// SPDX-License-Identifier: Apache-2.0
// Terms: a cavity is faces of the front that hang together by edges; its star from a place is the tets of that place
// and the faces that see it. A star is sound without a test of its tets with each other: two of them that met inside
// would have one of their faces in the other's way.
#include "volume/front_stars.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "predicates/predicates.hpp"
#include "tetra/quality.hpp"
#include "volume/deepest_point.hpp"
#include "volume/front_neighbourhood.hpp"

namespace delfront {

namespace {

constexpr double kFloors[] = {0, 1e-7, 1e-4, 0.01};  ///< least squared sines of dihedral angles, asked for last first
constexpr std::size_t kMostFaces = 240;              ///< of a cavity
constexpr double kMostWork = 1e8;                    ///< pairs of faces looked at for a cavity, over all places
constexpr double kMostInVain = 3e8;                  ///< the same for all cavities that came to no end
constexpr double kFarthest = 4;                      ///< a place from the middle of a face, in its longest edges
constexpr std::uint64_t kLeft = ~std::uint64_t{0};   ///< stamp of faces of cavities that came to no end
constexpr double kAlongRay[] = {0.5, 0.15};          ///< places between a face and what lies opposite
constexpr std::size_t kPartners = 4;                 ///< edges that are looked at from each edge

/// A place that may become the middle of a star.
struct Place {
  Point at;
  VertexIndex vertex = kNoIndex;    ///< kNoIndex: a new point
  std::vector<std::uint32_t> seen;  ///< faces of the cavity, by position
};

struct Star {
  int gain = 0;  ///< faces that go, less those that come
  double worst = 0;
  std::uint32_t place = kNoIndex;
  std::vector<std::uint32_t> faces;
  bool is_better_than(const Star& other) const {
    return place != kNoIndex &&
           (other.place == kNoIndex || gain > other.gain || (gain == other.gain && worst > other.worst));
  }
};

class StarFiller {
 public:
  StarFiller(FrontStore& front, FrontReport& report, Context& context)
      : front_(front), c_(front.complex()), report_(report), context_(context), near_(front) {}

  std::vector<std::uint32_t> all;  ///< faces of the front; some that were

  bool is_left(std::uint32_t f) const { return front_.face(f).stamp == kLeft; }

  /// @return whether the cavity that has face f is filled
  bool fill(std::uint32_t f) {
    const auto first = front_.nodes(f);
    with_others_ = false;
    for (const bool with_others : {false, true}) {
      if (in_vain_ > kMostInVain) break;
      with_others_ = with_others;
      work_ = 0;
      for (num_floors_ = std::size(kFloors); num_floors_ > 0 && work_ < kMostWork; --num_floors_) {
        tets_.clear();
        if (try_fill(front_.find(first))) {
          report_.cells_refilled += tets_.size();
          return true;
        }
        take_back();
      }
      in_vain_ += work_;
      if (others_.empty()) break;
    }
    collect(front_.find(first));
    if (with_others_) join_others();
    for (const std::uint32_t g : cavity_) front_.face(g).stamp = kLeft;
    return false;
  }

 private:
  bool try_fill(std::uint32_t f) {
    collect(f);
    collect_others();
    if (with_others_) join_others();
    const std::size_t most = 2 * cavity_.size() + 20, most_idle = cavity_.size() / 3 + 5;
    std::size_t idle = 0;
    for (std::size_t step = 0; !cavity_.empty(); ++step) {
      if (step > most || cavity_.size() > kMostFaces || work_ > kMostWork) return false;
      context_.check_limits();
      find_places();
      look();
      const Star star = choose();
      if (star.place == kNoIndex || (star.gain <= 0 && ++idle > most_idle)) return false;
      add(star);
    }
    return true;
  }

  /// The faces that hang together with f by edges.
  void collect(std::uint32_t f) {
    cavity_.clear();
    ++stamp_;
    add_connected(f);
  }

  void add_connected(std::uint32_t f) {
    std::size_t i = cavity_.size();
    cavity_.push_back(f);
    front_.face(f).stamp = stamp_;
    for (; i < cavity_.size(); ++i) {
      const auto n = front_.nodes(cavity_[i]);
      for (unsigned k = 0; k < 3; ++k)
        for (std::uint32_t e = front_.first_at(n[k == 2 ? 0 : k + 1]); e != kNoIndex; e = front_.next_at(e)) {
          FrontFace& g = front_.face(e >> 2);
          if (g.stamp == stamp_ || g.node[(e & 3) == 2 ? 0 : (e & 3) + 1] != n[k]) continue;
          g.stamp = stamp_;
          cavity_.push_back(e >> 2);
        }
    }
  }

  /// Those of other cavities that may be in the way.
  void collect_others() {
    Box box;
    for (const std::uint32_t f : cavity_) box.add(front_.box(f));
    others_.clear();
    for (const std::uint32_t f : all)
      if (front_.face(f).is_alive && front_.face(f).stamp != stamp_ && box.overlaps(front_.box(f)))
        others_.push_back(f);
  }

  /// Shells one inside the other have to be filled as one.
  void join_others() {
    for (const std::uint32_t f : others_)
      if (front_.face(f).stamp != stamp_) add_connected(f);
    collect_others();
  }

  std::array<Point, 3> corners(std::uint32_t f) const {
    const auto n = front_.nodes(f);
    return {c_.point(n[0]), c_.point(n[1]), c_.point(n[2])};
  }

  void find_places() {
    obstacles_ = cavity_;
    for (const std::uint32_t f : others_)
      if (front_.face(f).is_alive) obstacles_.push_back(f);
    std::sort(obstacles_.begin(), obstacles_.end());
    obstacles_.erase(std::unique(obstacles_.begin(), obstacles_.end()), obstacles_.end());
    places_.clear();
    place_of_.clear();
    for (const std::uint32_t f : cavity_)
      for (const VertexIndex v : front_.nodes(f))
        if (place_of_.try_emplace(v, static_cast<std::uint32_t>(places_.size())).second)
          places_.push_back({c_.point(v), v, {}});
    find_edges();
    add_deepest();
    add_before_faces();
    add_between_edges();
  }

  /// Embedded edges and points that have no tets yet are in the way, and their ends are places.
  void find_edges() {
    Box box;
    for (const std::uint32_t f : obstacles_) box.add(front_.box(f));
    edges_.clear();
    front_.obstacles().for_each_overlap(box, [&](std::uint32_t i) {
      const FrontObstacle& o = front_.obstacles()[i];
      if (!o.is_pending()) return;
      edges_.push_back(i);
      for (const VertexIndex v : {o.a, o.b})
        if (place_of_.try_emplace(v, static_cast<std::uint32_t>(places_.size())).second)
          places_.push_back({c_.point(v), v, {}});
    });
  }

  void add_deepest() {
    std::vector<HalfSpace> planes;
    for (const std::uint32_t f : cavity_) {
      const auto p = corners(f);
      planes.push_back({p[0], cross(p[1] - p[0], p[2] - p[0])});
    }
    places_.push_back({find_deepest_point(planes).at, kNoIndex, {}});
  }

  /// How far a ray goes before it meets a face; not exact, as places need not be.
  double range(const Point& from, const Point& along) const {
    double nearest = 1e300;
    for (const std::uint32_t g : obstacles_) {
      const auto [a, b, c] = corners(g);
      const Point n = cross(b - a, c - a);
      const double slope = dot(n, along), t = dot(n, a - from) / slope;
      if (!(t > 0 && t < nearest)) continue;
      const Point at = from + t * along;
      if (dot(cross(b - a, at - a), n) < 0 || dot(cross(c - b, at - b), n) < 0 || dot(cross(a - c, at - c), n) < 0)
        continue;
      nearest = t;
    }
    return nearest;
  }

  void add_before_faces() {
    for (const std::uint32_t f : cavity_) {
      const auto [a, b, c] = corners(f);
      const Point n = cross(b - a, c - a);
      const double l = length(n);
      if (!(l > 0)) continue;
      const Point middle = (1.0 / 3) * (a + b + c), up = n / l;
      const double longest = std::max({distance(a, b), distance(b, c), distance(c, a)});
      const double reach = std::min(range(middle + 1e-9 * longest * up, up), longest);
      for (const double share : kAlongRay) places_.push_back({middle + share * reach * up, kNoIndex, {}});
    }
  }

  struct Edge {
    VertexIndex a, b;
  };
  struct Bridge {
    double length;
    Point middle;
  };

  /// The shortest line between two segments, if its ends lie within both.
  static std::optional<Bridge> bridge(const Point& a, const Point& b, const Point& p, const Point& q) {
    const Point u = b - a, v = q - p, w = a - p;
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
    const double det = uu * vv - uv * uv;
    if (!(det > 1e-12 * uu * vv)) return {};
    const double s = (uv * vw - vv * uw) / det, t = (uu * vw - uv * uw) / det;
    if (s < 0.01 || s > 0.99 || t < 0.01 || t > 0.99) return {};
    const Point x = a + s * u, y = p + t * v;
    return Bridge{distance(x, y), 0.5 * (x + y)};
  }

  void add_between_edges() {
    std::vector<Edge> edges;
    for (const std::uint32_t f : cavity_) {
      const auto n = front_.nodes(f);
      for (unsigned k = 0; k < 3; ++k)
        if (const VertexIndex a = n[k], b = n[k == 2 ? 0 : k + 1]; a < b) edges.push_back({a, b});
    }
    std::vector<Bridge> bridges;
    for (const Edge& e : edges) {
      bridges.clear();
      for (const Edge& g : edges) {
        if (g.a == e.a || g.a == e.b || g.b == e.a || g.b == e.b) continue;
        if (const auto found = bridge(c_.point(e.a), c_.point(e.b), c_.point(g.a), c_.point(g.b)))
          bridges.push_back(*found);
      }
      const std::size_t some = std::min(kPartners, bridges.size());
      std::partial_sort(bridges.begin(), bridges.begin() + static_cast<std::ptrdiff_t>(some), bridges.end(),
                        [](const Bridge& x, const Bridge& y) { return x.length < y.length; });
      for (std::size_t i = 0; i < some; ++i) places_.push_back({bridges[i].middle, kNoIndex, {}});
    }
  }

  /// Which faces see which places.
  void look() {
    quality_.assign(cavity_.size() * places_.size(), 0);
    work_ += static_cast<double>(quality_.size()) * static_cast<double>(obstacles_.size());
    for (std::uint32_t i = 0; i < cavity_.size(); ++i) {
      const std::uint32_t f = cavity_[i];
      const auto n = front_.nodes(f);
      const auto [a, b, c] = corners(f);
      const Point middle = (1.0 / 3) * (a + b + c);
      const double reach = kFarthest * std::max({distance(a, b), distance(b, c), distance(c, a)});
      const FrontFrame frame = front_.frame(f);
      near_.start(f);
      for (const std::uint32_t o : edges_) near_.add_obstacle(front_.obstacles()[o]);
      for (const std::uint32_t g : obstacles_)
        if (g != f) near_.add_face(g);
      local_.assign(places_.size(), kNoIndex);
      for (std::uint32_t k = 3; k < near_.num_points(); ++k)
        if (const auto at = place_of_.find(near_.id(k)); at != place_of_.end()) local_[at->second] = k;
      for (std::uint32_t p = 0; p < places_.size(); ++p) {
        Place& place = places_[p];
        if (place.vertex != kNoIndex && (place.vertex == n[0] || place.vertex == n[1] || place.vertex == n[2]))
          continue;
        if (squared_length(place.at - middle) > reach * reach) continue;
        const double q =
            measure_quality(frame.to_frame(a), frame.to_frame(b), frame.to_frame(c), frame.to_frame(place.at));
        if (q <= 0 || orient3d(a, b, c, place.at) <= 0) continue;
        const std::size_t k = place.vertex == kNoIndex ? near_.add_place(place.at) : local_[p];
        if (near_.test(k, 0, 1) == Neighbourhood::Verdict::free) {
          place.seen.push_back(i);
          quality_[p * cavity_.size() + i] = q;
        }
        if (place.vertex == kNoIndex) near_.drop_place();
      }
    }
  }

  /// The star that leaves the fewest faces under the highest floor under which one leaves fewer than there are.
  Star choose() {
    Star idle;
    for (std::size_t k = num_floors_; k-- > 0;) {
      Star best;
      for (std::uint32_t p = 0; p < places_.size(); ++p) {
        const Star star = star_of(p, kFloors[k]);
        if (star.is_better_than(best)) best = star;
      }
      if (best.gain > 0) return best;
      if (best.gain == 0 && idle.place == kNoIndex) idle = best;
    }
    return idle;
  }

  /// All parts of the star that gain; where none does, the best one.
  Star star_of(std::uint32_t p, double floor) {
    seen_.clear();
    for (const std::uint32_t i : places_[p].seen)
      if (quality_[p * cavity_.size() + i] >= floor) seen_.push_back(i);
    parts_of(seen_);
    Star star;
    for (const auto& part : parts_) {
      const Star one = measure(p, part);
      if (one.gain > 0 && star.gain > 0) {
        star.gain += one.gain;
        star.worst = std::min(star.worst, one.worst);
        star.faces.insert(star.faces.end(), part.begin(), part.end());
      } else if (one.is_better_than(star)) {
        star = one;
      }
    }
    return star;
  }

  /// The faces among some over whose side a -> b another of them lies, as positions.
  void parts_of(const std::vector<std::uint32_t>& seen) {
    parts_.clear();
    std::vector<std::uint32_t> rest = seen;
    while (!rest.empty()) {
      std::vector<std::uint32_t> part{rest.back()};
      rest.pop_back();
      for (std::size_t i = 0; i < part.size(); ++i)
        std::erase_if(rest, [&](std::uint32_t g) {
          const bool hangs = share_edge(cavity_[part[i]], cavity_[g]);
          if (hangs) part.push_back(g);
          return hangs;
        });
      parts_.push_back(std::move(part));
    }
  }

  bool share_edge(std::uint32_t f, std::uint32_t g) const {
    const auto n = front_.nodes(f), m = front_.nodes(g);
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned k = 0; k < 3; ++k)
        if (n[i] == m[k == 2 ? 0 : k + 1] && n[i == 2 ? 0 : i + 1] == m[k]) return true;
    return false;
  }

  Star measure(std::uint32_t p, const std::vector<std::uint32_t>& part) {
    Star star;
    star.place = p;
    star.faces = part;
    star.worst = 1e300;
    star.gain = static_cast<int>(part.size());
    const VertexIndex v = places_[p].vertex;
    sides_.clear();
    for (const std::uint32_t i : part) {
      star.worst = std::min(star.worst, quality_[p * cavity_.size() + i]);
      const auto n = front_.nodes(cavity_[i]);
      for (unsigned k = 0; k < 3; ++k) sides_.push_back({n[k], n[k == 2 ? 0 : k + 1]});
    }
    std::sort(sides_.begin(), sides_.end());
    for (const auto& [a, b] : sides_) {
      if (std::binary_search(sides_.begin(), sides_.end(), std::pair{b, a})) continue;
      star.gain += v != kNoIndex && front_.find({a, v, b}) != kNoIndex ? 1 : -1;
    }
    return star;
  }

  void add(const Star& star) {
    VertexIndex apex = places_[star.place].vertex;
    if (apex == kNoIndex) apex = add_point(star);
    FrontStock stock = front_.take(star.faces.size());
    std::vector<std::uint32_t> made;
    std::vector<std::uint32_t> faces;
    for (const std::uint32_t i : star.faces) faces.push_back(cavity_[i]);
    for (const std::uint32_t f : faces)
      if (front_.face(f).is_alive) tets_.push_back(front_.add_tet(f, apex, stock, made));
    front_.give(stock);
    cavity_.insert(cavity_.end(), made.begin(), made.end());
    std::erase_if(cavity_, [&](std::uint32_t f) { return !front_.face(f).is_alive; });
    std::sort(cavity_.begin(), cavity_.end());
    cavity_.erase(std::unique(cavity_.begin(), cavity_.end()), cavity_.end());
  }

  VertexIndex add_point(const Star& star) {
    double h = 0;
    for (const std::uint32_t i : star.faces) h += c_.vertex[front_.nodes(cavity_[i])[0]].h;
    const VertexIndex v = c_.take_vertices(1)[0];
    c_.set_vertex(v, places_[star.place].at, h / static_cast<double>(star.faces.size()));
    front_.add_vertex();
    if (front_.sizes().are_stretched()) front_.sizes().ask(v);
    ++report_.points;
    return v;
  }

  void take_back() {
    std::vector<std::uint32_t> made;
    for (; !tets_.empty(); tets_.pop_back()) front_.remove_tet(tets_.back(), made);
    all.insert(all.end(), made.begin(), made.end());
  }

  FrontStore& front_;
  TetComplex& c_;
  FrontReport& report_;
  Context& context_;
  Neighbourhood near_;
  std::size_t num_floors_ = 0;
  bool with_others_ = false;
  double work_ = 0, in_vain_ = 0;
  std::uint64_t stamp_ = std::uint64_t{1} << 62;
  std::vector<std::uint32_t> cavity_, others_, obstacles_;
  std::vector<std::uint32_t> edges_;  ///< embedded ones, and points
  std::vector<Place> places_;
  std::unordered_map<VertexIndex, std::uint32_t> place_of_;
  std::vector<std::uint32_t> local_;
  std::vector<double> quality_;  ///< by place, then face of the cavity
  std::vector<std::uint32_t> seen_;
  std::vector<std::vector<std::uint32_t>> parts_;
  std::vector<std::pair<VertexIndex, VertexIndex>> sides_;
  std::vector<TetIndex> tets_;  ///< made, in order
};

}  // namespace

std::vector<std::uint32_t> fill_by_stars(FrontStore& front, const std::vector<std::uint32_t>& faces,
                                         FrontReport& report, Context& context) {
  StarFiller filler(front, report, context);
  filler.all = faces;
  report.cavities_left = 0;
  for (const std::uint32_t f : faces) front.face(f).stamp = 0;
  for (std::size_t i = 0; i < filler.all.size(); ++i) {  // it grows
    const std::uint32_t f = filler.all[i];
    if (front.face(f).is_alive && !filler.is_left(f))
      ++(filler.fill(f) ? report.cavities_by_stars : report.cavities_left);
  }
  std::vector<std::uint32_t> left = std::move(filler.all);
  std::erase_if(left, [&](std::uint32_t f) { return !front.face(f).is_alive; });
  std::sort(left.begin(), left.end());
  left.erase(std::unique(left.begin(), left.end()), left.end());
  return left;
}

}  // namespace delfront
