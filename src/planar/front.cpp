// SPDX-License-Identifier: Apache-2.0
// The advancing front in the plane (Löhner 2008, 3.4 to 3.6). Terms: a side is an edge whose left is not gridded yet;
// what stands behind it is the triangle on its right. Sides wait in buckets by the size of the triangle that they
// would make; the smallest bucket is worked off in one go, in the order in which its sides were made, which follows the
// loops. New points get their sizes together after that, and new sides go to the buckets. So the front moves in layers
// and its neighbourhood stays in the cache.
#include "planar/front.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include "planar/front_neighbours.hpp"

namespace delfront {

namespace {

constexpr double kLongestOverSide = 1.6;    ///< sides over a short side, of its length: 36 degrees between them
constexpr double kShortestOverSide = 0.68;  ///< sides over a long side, of its length: 95 degrees between them
constexpr double kLeastGrowth = 0.8, kMostGrowth = 1.25;  ///< of sizes from a side to half a triangle ahead
constexpr std::size_t kSidesPerCancelCheck = 4096;
constexpr std::size_t kSidesPerSample = 64;  ///< one in so many is timed
constexpr double kInterrupted = 1e-4;        ///< seconds: a step that took longer was not running all the time
constexpr std::uint32_t kNone = 0xffffffffu;

/// What a sweep asks of a triangle; lengths are in the side's frame, relative to the sides wanted there.
struct Rules {
  double floor;      ///< of quality
  double reach;      ///< how far away points are looked for
  double reuse;      ///< a point this near to the ideal one takes its place ...
  double preferred;  ///< ... and one whose triangle is this good, relative to the ideal one
  double to_points;  ///< a new point keeps this far from points ...
  double to_sides;   ///< ... and this far from sides
  double passing;    ///< a new side to a point that is there passes other points at this distance
};
constexpr Rules kSweeps[] = {
    {0.3, 1.6, 0.6, 0.9, 0.7, 0.55, 0.35},
    {0.2, 2, 0.6, 0.7, 0.5, 0.4, 0.15},
    {0.1, 3, 0.6, 0.7, 0.3, 0.3, 0},
};
constexpr std::size_t kMostSweeps = 8;  ///< the last rules again as long as they find something

class Front {
 public:
  Front(PlanarGrid& grid, const SizeField& size, Context& context, FrontWatcher* watcher)
      : grid_(grid), c_(grid.complex), size_(size), context_(context), watcher_(watcher) {}

  FrontReport run() {
    ask_sizes(0);
    start();
    for (; report_.sweeps < kMostSweeps && num_sides_ > 0; ++report_.sweeps) {
      const std::size_t before = report_.cells;
      rules_ = kSweeps[std::min(report_.sweeps, std::size(kSweeps) - 1)];
      enqueue();
      for (std::size_t bucket; (bucket = smallest_bucket()) != kNone;) advance(bucket);
      fresh_.swap(left_);
      if (report_.cells == before && report_.sweeps + 1 >= std::size(kSweeps)) break;
    }
    close();
    report_.crossing_share = sampled_ > 0 ? sampled_in_tests_ / sampled_ : 0;
    return report_;
  }

 private:
  struct Side {
    VertexIndex from, to;
    EdgeRef behind;            ///< kNoTri: open there too, see twin
    std::uint32_t twin;        ///< the side that runs back, of an embedded line
    std::uint32_t next_out;    ///< of those that begin at the same vertex
    std::uint32_t generation;  ///< of the slot: it is used again
    std::uint32_t region;
    bool is_constrained, is_live;
  };
  /// A side that waits; out of date where the generation is.
  struct Waiting {
    std::uint32_t side, generation;
  };

  Point2 at(VertexIndex v) const { return c_.point[v]; }

  // F5: sizes, asked for in batches

  void ask_sizes(std::size_t first) {
    is_isotropic_ = size_.is_isotropic();
    const std::size_t n = c_.point.size() - first;
    if (n == 0) return;
    if (is_isotropic_ && first == 0) return;  // c_.h has them
    places_.resize(n);
    for (std::size_t i = 0; i < n; ++i) places_[i] = {c_.point[first + i].x, c_.point[first + i].y, 0};
    c_.h.resize(c_.point.size());
    if (is_isotropic_) {
      size_.sizes(places_, std::span(c_.h).subspan(first));
      return;
    }
    metrics_.resize(n);
    size_.metrics(places_, metrics_);
    for (std::size_t i = 0; i < n; ++i) {
      metric_.push_back(FrontMetric::root_of(metrics_[i]));
      c_.h[first + i] = metric_.back().size();
    }
  }

  FrontMetric metric_of(const Side& s) const {
    if (is_isotropic_) return FrontMetric::isotropic(std::min(0.5 * (c_.h[s.from] + c_.h[s.to]), h_of(s.region)));
    const FrontMetric mean = FrontMetric::mean_of(metric_[s.from], metric_[s.to]);
    return mean.scaled(std::max(1.0, mean.size() / h_of(s.region)));
  }
  /// Sizes ahead of a side over those at it, half a triangle on, as they have grown since the triangle behind it.
  double growth_ahead(const Side& s) const {
    if (s.behind == kNoTri || c_.tri[s.behind >> 2].region == kOutside) return 1;
    const VertexIndex apex = c_.apex(s.behind);
    if (apex >= c_.h.size()) return 1;
    return std::clamp(1.5 - c_.h[apex] / (c_.h[s.from] + c_.h[s.to]), kLeastGrowth, kMostGrowth);
  }

  double h_of(std::uint32_t region) const { return grid_.region_h[region]; }

  /// Length of the sides wanted over one of a length in the metric.
  static double wanted_over(double length) {
    return std::clamp(1.0, kShortestOverSide * length, kLongestOverSide * length);
  }

  // F1 to F3: the front at first

  void start() {
    Point2 low = {1e300, 1e300}, high = {-1e300, -1e300};
    std::vector<std::uint32_t> side_of(4 * c_.tri.size(), kNone);
    reserve();
    first_out_.assign(c_.point.size(), kNone);
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (!is_inside(t)) continue;
      for (const VertexIndex v : c_.tri[t].node) {
        low = {std::min(low.x, at(v).x), std::min(low.y, at(v).y)};
        high = {std::max(high.x, at(v).x), std::max(high.y, at(v).y)};
      }
      for (unsigned e = 0; e < 3; ++e) add_loop(4 * t + e, side_of);
    }
    search_.clear(low, high);
    for (std::uint32_t s = 0; s < sides_.size(); ++s) search_.insert(found_as(s));
    add_loose_points();
    for (TriIndex t = static_cast<TriIndex>(c_.tri.size()); t-- > 0;)
      if (is_inside(t)) c_.free_slot(t);
  }

  /// Room for what the largest sizes at the corners ask for, so that arrays are rarely moved.
  void reserve() {
    double triangles = 0;
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (!is_inside(t)) continue;
      const VertexIndex* n = c_.tri[t].node;
      const double h = std::min(std::max({c_.h[n[0]], c_.h[n[1]], c_.h[n[2]]}), h_of(c_.tri[t].region));
      triangles += cross(at(n[1]) - at(n[0]), at(n[2]) - at(n[0])) / (h * h);
    }
    triangles = std::min(1.2 * triangles, double(kMostTriangles) / 2);  // a regular one has sqrt(3)/4 h^2
    const auto points = static_cast<std::size_t>(0.5 * triangles) + c_.point.size();
    c_.tri.reserve(static_cast<std::size_t>(triangles) + c_.tri.size());
    c_.point.reserve(points);
    c_.h.reserve(points);
    first_out_.reserve(points);
    if (!is_isotropic_) metric_.reserve(points);
  }

  bool is_inside(TriIndex t) const { return c_.tri[t].region != kOutside && !c_.is_dead(t) && !c_.is_ghost(t); }

  /// The loop of sides that an edge is on, from there.
  void add_loop(EdgeRef ref, std::vector<std::uint32_t>& side_of) {
    while (c_.is_constrained(ref) && side_of[ref] == kNone) {
      const EdgeRef other = c_.across(ref);
      const bool is_open = is_inside(other >> 2);
      const std::uint32_t s =
          add_side(c_.origin(ref), c_.target(ref), is_open ? kNoTri : other, c_.tri[ref >> 2].region, true);
      side_of[ref] = s;
      fresh_.push_back({s, sides_[s].generation});
      if (is_open && side_of[other] != kNone) {
        sides_[s].twin = side_of[other];
        sides_[side_of[other]].twin = s;
      }
      ref = TriComplex::next_edge(ref);
      while (!c_.is_constrained(ref)) ref = TriComplex::next_edge(c_.across(ref));
    }
  }

  /// Points that no side uses stand in the search as sides of no length.
  void add_loose_points() {
    is_loose_.assign(c_.point.size(), false);
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (!is_inside(t)) continue;
      for (const VertexIndex v : c_.tri[t].node) {
        if (is_loose_[v] || first_out_[v] != kNone) continue;
        is_loose_[v] = true;
        search_.insert({at(v), at(v), v, v, kNone});
      }
    }
  }

  std::uint32_t add_side(VertexIndex from, VertexIndex to, EdgeRef behind, std::uint32_t region, bool is_constrained) {
    std::uint32_t s;
    if (free_sides_.empty()) {
      s = static_cast<std::uint32_t>(sides_.size());
      sides_.push_back({});
    } else {
      s = free_sides_.back();
      free_sides_.pop_back();
    }
    Side& side = sides_[s];
    side = {from, to, behind, kNone, first_out_[from], side.generation + 1, region, is_constrained, true};
    first_out_[from] = s;
    ++num_sides_;
    return s;
  }

  FrontSide found_as(std::uint32_t s) const {
    const Side& side = sides_[s];
    return {at(side.from), at(side.to), side.from, side.to, s};
  }

  // F6: the next side is one of those that would make the smallest triangle

  bool is_current(const Waiting& w) const {
    return sides_[w.side].generation == w.generation && sides_[w.side].is_live;
  }

  /// Two an octave, by the length of the sides wanted.
  std::size_t bucket_of(std::uint32_t s) const {
    const Side& side = sides_[s];
    const FrontMetric metric = metric_of(side);
    const Point2 along = at(side.to) - at(side.from);
    const double length = std::sqrt(squared_length(metric.map(along)));
    const double wanted = std::sqrt(squared_length(along)) * (wanted_over(length) / length);
    return std::bit_cast<std::uint64_t>(wanted) >> 51;
  }

  void enqueue() {
    for (const Waiting& w : fresh_) {
      if (!is_current(w)) continue;
      const std::size_t bucket = bucket_of(w.side);
      if (buckets_.empty()) first_bucket_ = bucket;
      if (bucket < first_bucket_) {
        buckets_.insert(buckets_.begin(), first_bucket_ - bucket, {});
        first_bucket_ = bucket;
      }
      if (bucket - first_bucket_ >= buckets_.size()) buckets_.resize(bucket - first_bucket_ + 1);
      buckets_[bucket - first_bucket_].push_back(w);
    }
    fresh_.clear();
  }

  std::size_t smallest_bucket() const {
    for (std::size_t b = 0; b < buckets_.size(); ++b)
      if (!buckets_[b].empty()) return b;
    return kNone;
  }

  void advance(std::size_t bucket) {
    batch_.swap(buckets_[bucket]);
    const std::size_t num_points = c_.point.size();
    for (const Waiting& w : batch_) {
      if (!is_current(w)) continue;
      if (report_.sides_processed++ % kSidesPerCancelCheck == 0) {
        context_.progress("front", report_.cells, 0, "cells");
        context_.check_cells(report_.cells);
      }
      if (!work_on(w.side)) left_.push_back(w);
    }
    batch_.clear();
    ask_sizes(num_points);
    enqueue();
  }

  // F7: the triangle over a side

  bool work_on(std::uint32_t s) {
    if (report_.sides_processed % kSidesPerSample != 0) return find_triangle(s);
    is_timed_ = true;
    in_tests_ = 0;
    const auto begin = std::chrono::steady_clock::now();
    const bool is_done = find_triangle(s);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    is_timed_ = false;
    if (seconds < kInterrupted) {
      sampled_ += seconds;
      sampled_in_tests_ += in_tests_;
    }
    return is_done;
  }

  bool is_free(Point2 p, VertexIndex apex) {
    if (!is_timed_) return near_.is_free(p, apex);
    const auto begin = std::chrono::steady_clock::now();
    const bool is_free = near_.is_free(p, apex);
    in_tests_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return is_free;
  }

  bool find_triangle(std::uint32_t s) {
    const Side side = sides_[s];
    const FrontFrame frame(at(side.from), at(side.to), metric_of(side).scaled(1 / growth_ahead(side)));
    const double wanted = wanted_over(frame.length);
    near_.gather(search_, found_as(s), frame, rules_.reach * std::max(wanted, frame.length));
    const Point2 ideal = {0, std::sqrt(wanted * wanted - 0.25 * frame.length * frame.length)};
    const double least = std::max(rules_.floor, rules_.preferred * front_quality(frame.length, ideal));
    const double reuse2 = rules_.reuse * rules_.reuse * wanted * wanted;
    for (const FrontNeighbours::Candidate& c : near_.candidates()) {
      const bool is_preferred = c.quality >= least || squared_length(c.at - ideal) <= reuse2;
      if (is_preferred && c.quality >= rules_.floor && take(s, c, wanted)) return true;
    }
    if (add_point(s, frame, ideal, wanted)) return true;
    for (const FrontNeighbours::Candidate& c : near_.candidates()) {
      if (c.quality < rules_.floor) break;
      if (take(s, c, wanted)) return true;
    }
    return false;
  }

  bool take(std::uint32_t s, const FrontNeighbours::Candidate& candidate, double wanted) {
    const VertexIndex v = candidate.v;
    if (near_.passes_near(candidate, rules_.passing * wanted) || !is_free(at(v), v)) return false;
    if (first_out_[v] == kNone) tie_in(v);
    make_triangle(s, v);
    return true;
  }

  /// At the ideal place, or a little lower where it is too near to something.
  bool add_point(std::uint32_t s, const FrontFrame& frame, Point2 ideal, double wanted) {
    for (const double height : {1.0, 0.75}) {
      const Point2 place = {0, height * ideal.y};
      if (front_quality(frame.length, place) < rules_.floor) return false;
      if (near_.is_near(place, rules_.to_points * wanted, rules_.to_sides * wanted)) continue;
      const Point2 p = frame.from_frame(place);
      if (!is_free(p, kInfinity)) continue;
      const auto v = static_cast<VertexIndex>(c_.point.size());
      c_.point.push_back(p);
      first_out_.push_back(kNone);
      ++report_.points;
      make_triangle(s, v);
      return true;
    }
    return false;
  }

  // F8 to F10: the triangle goes in, sides that it closes go, its other sides come

  void make_triangle(std::uint32_t s, VertexIndex v) {
    const VertexIndex a = sides_[s].from, b = sides_[s].to;
    if (watcher_) tell(a, b, v);
    const std::uint32_t region = sides_[s].region;
    const TriIndex t = c_.new_slot();
    c_.tri[t] = {{a, b, v}, {kNoTri, kNoTri, kNoTri}, region, 0};
    close_side(s, 4 * t + 2);
    close_or_add(b, v, 4 * t + 0, region);
    close_or_add(v, a, 4 * t + 1, region);
    ++report_.cells;
  }

  /// A point that stood loose is no obstacle of its own any more.
  void tie_in(VertexIndex v) {
    search_.remove({at(v), at(v), v, v, kNone});
    is_loose_[v] = false;
  }

  /// The edge of a triangle just made, from a to b, either closes the side a -> b or opens b -> a.
  void close_or_add(VertexIndex a, VertexIndex b, EdgeRef ref, std::uint32_t region) {
    for (std::uint32_t s = first_out_[a]; s != kNone; s = sides_[s].next_out)
      if (sides_[s].to == b) return close_side(s, ref);
    const std::uint32_t s = add_side(b, a, ref, region, false);
    search_.insert(found_as(s));
    fresh_.push_back({s, sides_[s].generation});
  }

  void close_side(std::uint32_t s, EdgeRef ref) {
    Side& side = sides_[s];
    if (side.behind != kNoTri) {
      c_.bond(ref, side.behind);
    } else {
      sides_[side.twin].behind = ref;
    }
    if (side.is_constrained) c_.tri[ref >> 2].flags |= 1u << (ref & 3);
    search_.remove(found_as(s));
    std::uint32_t* link = &first_out_[side.from];
    while (*link != s) link = &sides_[*link].next_out;
    *link = side.next_out;
    side.is_live = false;
    free_sides_.push_back(s);
    --num_sides_;
  }

  void tell(VertexIndex a, VertexIndex b, VertexIndex v) {
    std::vector<std::array<VertexIndex, 2>> all;
    for (const Side& side : sides_)
      if (side.is_live) all.push_back({side.from, side.to});
    for (const VertexIndex p : loose_points()) all.push_back({p, p});
    watcher_->before_triangle(c_, all, {a, b, v});
  }

  // F17: what is left is closed

  void close() {
    std::vector<LeftSide> all;
    for (const Side& side : sides_)
      if (side.is_live) all.push_back({side.from, side.to, side.behind, side.region, side.is_constrained});
    if (!all.empty()) close_by_delaunay(c_, all, loose_points(), report_, context_);
  }

  std::vector<VertexIndex> loose_points() const {
    std::vector<VertexIndex> loose;
    for (VertexIndex v = 0; v < is_loose_.size(); ++v)
      if (is_loose_[v]) loose.push_back(v);
    return loose;
  }

  PlanarGrid& grid_;
  TriComplex& c_;
  const SizeField& size_;
  Context& context_;
  FrontWatcher* watcher_;
  FrontReport report_;
  Rules rules_{};
  bool is_isotropic_ = true;
  std::vector<FrontMetric> metric_;  ///< by vertex; empty where sizes do
  std::vector<Point> places_;
  std::vector<Metric> metrics_;

  std::vector<Side> sides_;
  std::vector<std::uint32_t> free_sides_;
  std::vector<std::uint32_t> first_out_;  ///< by vertex: a side that begins there
  std::size_t num_sides_ = 0;
  std::vector<bool> is_loose_;  ///< by given vertex: no side uses it yet
  SideGrid search_;
  FrontNeighbours near_;

  std::vector<std::vector<Waiting>> buckets_;
  std::size_t first_bucket_ = 0;
  std::vector<Waiting> fresh_, batch_, left_;

  bool is_timed_ = false;
  double sampled_ = 0, sampled_in_tests_ = 0, in_tests_ = 0;
};

}  // namespace

FrontReport fill_by_front(PlanarGrid& grid, const SizeField& size, Context& context, FrontWatcher* watcher) {
  const StageTimer timer(context, "front");
  return Front(grid, size, context, watcher).run();
}

}  // namespace delfront
