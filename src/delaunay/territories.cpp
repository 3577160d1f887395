// SPDX-License-Identifier: Apache-2.0
// Rounds that grow by kRoundGrowth, each along a Hilbert curve, so that a walk is short and memory is met in order,
// while no adversary's order makes cavities large. Large rounds are cut into territories along the curve, which threads
// work in; what they leave, near the borders, is done in territories along other curves, and the few points then left
// one by one.
#include "delaunay/territories.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr double kRoundGrowth = 7.5;
constexpr double kFirstRound = 2048;
constexpr std::size_t kPointsPerCancelCheck = 4096;
constexpr std::size_t kWorthTerritories = 1 << 14;  ///< points; fewer are put in one by one
constexpr std::size_t kPointsPerTerritory = 1 << 18;
constexpr std::size_t kMinTerritories = 4, kMaxTerritories = 256;
constexpr std::size_t kSlotsPerPoint = 7;  ///< a point adds 6.75 tets on average in a uniform set
constexpr std::size_t kSpareSlots = 256;
constexpr std::size_t kGrain = 1 << 14;
constexpr std::uint64_t kMaxSteps = 1000;  ///< of a walk among constraints: beyond, it wanders

using Vertices = std::vector<VertexIndex>;

std::uint64_t scramble(std::uint64_t x) {  // the finalizer of splitmix64: a fixed hash, the same in every run
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

std::vector<Vertices> make_rounds(std::span<const VertexIndex> vertices) {
  const double ratio = std::max(static_cast<double>(vertices.size()) / kFirstRound, 1.0);
  const auto last = static_cast<std::size_t>(std::log(ratio) / std::log(kRoundGrowth));
  std::vector<Vertices> rounds(last + 1);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    double u = static_cast<double>(scramble(i + 1) >> 11) * 0x1p-53;
    std::size_t round = last;
    for (; round > 0 && u * kRoundGrowth < 1; --round) u *= kRoundGrowth;
    rounds[round].push_back(vertices[i]);
  }
  return rounds;
}

/// Large ones have few points near their borders, which have to wait; few of them keep few threads busy.
std::size_t num_territories(std::size_t points) {
  return std::clamp(std::bit_floor(points / kPointsPerTerritory), kMinTerritories, kMaxTerritories);
}

class Batch {
 public:
  Batch(TetComplex& complex, const DelaunayKernel::Limits& limits, TetIndex start, KernelCounts& counts,
        Context& context)
      : c_(complex), limits_(limits), start_(start), counts_(counts), context_(context), all_(complex) {}

  void insert(std::span<const VertexIndex> vertices) {
    num_points_ = vertices.size();
    for (const Vertices& round : make_rounds(vertices)) insert_round(round);
    add_counts(counts_, all_.counts);
  }

 private:
  void insert_round(const Vertices& round) {
    Vertices left = round;
    for (int curve = 0; curve < kNumCurves && left.size() >= kWorthTerritories; ++curve) {
      key_along_curve(curve, left);
      const auto is_before = [&](VertexIndex a, VertexIndex b) {
        return key_[a] != key_[b] ? key_[a] < key_[b] : a < b;
      };
      if (!std::is_sorted(left.begin(), left.end(), is_before)) std::sort(left.begin(), left.end(), is_before);
      left = insert_in_territories(left, num_territories(round.size()));
    }
    std::sort(left.begin(), left.end());
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (i % kPointsPerCancelCheck == 0) report_progress();
      const auto result = insert_one(all_, left[i]);
      DELFRONT_CHECK(limits_.constrained || result == DelaunayKernel::Insert::done);
    }
  }

  void report_progress() {
    context_.progress("tetrahedralize", counts_.points + all_.counts.points, num_points_, "points");
  }

  void key_along_curve(int number, const Vertices& left) {
    key_.resize(c_.num_vertices());
    const HilbertCurve curve = curve_over(c_, number);
    parallel_ranges(context_.threads, key_.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v)  // of those that tets have; the others' are not asked for
        if (c_.vertex_tet[v] != kNoIndex) key_[v] = territory_key(curve.key(c_.vertex[v].point()));
    });
    parallel_ranges(context_.threads, left.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) key_[left[i]] = territory_key(curve.key(c_.vertex[left[i]].point()));
    });
  }

  /// @param points  by key
  /// @return those that lie too near a border of the territories
  Vertices insert_in_territories(const Vertices& points, std::size_t n) {
    report_progress();
    Territories territories(
        c_, n, points.size(), [&](std::size_t i) { return key_[points[i]]; }, kSlotsPerPoint);
    std::vector<Vertices> left(n);
    territories.run(key_.data(), context_.threads, [&](Territories::Part& part, std::size_t number) {
      for (std::size_t i = part.begin; i < part.end; ++i) {
        if (i % kPointsPerCancelCheck == 0) context_.check_limits();
        if (insert_one(part.kernel, points[i]) == DelaunayKernel::Insert::not_ours) left[number].push_back(points[i]);
      }
    });
    territories.finish(counts_);
    Vertices all_left;
    for (const Vertices& some : left) all_left.insert(all_left.end(), some.begin(), some.end());
    return all_left;
  }

  DelaunayKernel::Insert insert_one(DelaunayKernel& kernel, VertexIndex v) {
    const TetIndex start = find_start(kernel, v);
    if (start == kNoIndex) return DelaunayKernel::Insert::not_ours;
    const TetIndex holder = kernel.locate(v, start, limits_.constrained ? kMaxSteps : 0);
    return holder == kNoIndex ? DelaunayKernel::Insert::not_ours : kernel.insert_into(holder, v, limits_);
  }

  /// A tet of ours at a vertex that lies near v along the first curve; else the last one made, or any.
  TetIndex find_start(const DelaunayKernel& kernel, VertexIndex v) {
    constexpr VertexIndex kReach = 32;
    auto start_at = [&](VertexIndex w) {
      if (w >= c_.num_vertices() || !kernel.holds(w)) return kNoIndex;
      const TetIndex t = c_.vertex_tet[w];
      return t != kNoIndex && kernel.is_ours(t) ? t : kNoIndex;
    };
    for (VertexIndex reach = 1; reach <= kReach; ++reach)
      for (const VertexIndex w : {v - reach, v + reach})
        if (const TetIndex t = start_at(w); t != kNoIndex) return t;
    if (kernel.last_tet != kNoIndex && !c_.is_dead(kernel.last_tet)) return kernel.last_tet;
    if (kernel.is_confined()) return kNoIndex;
    while (c_.is_dead(start_)) start_ = static_cast<TetIndex>((start_ + 1) % c_.num_slots());
    return start_;
  }

  TetComplex& c_;
  const DelaunayKernel::Limits limits_;
  TetIndex start_;
  KernelCounts& counts_;
  Context& context_;
  DelaunayKernel all_;  ///< for what is put in one by one
  std::size_t num_points_ = 0;
  std::vector<std::uint32_t> key_;  ///< by vertex, along the curve of this pass
};

}  // namespace

HilbertCurve curve_over(const TetComplex& complex, int number) {
  constexpr Point kShifts[kNumCurves] = {{}, {0.37, 0.29, 0.43}, {0.11, 0.59, 0.19}};
  Box box;
  for (const TetVertex& v : complex.vertex) box.add(v.point());
  const double side = box.longest_side();
  if (number > 0) {
    box.low = box.low - side * kShifts[number];
    box.high = box.low + Point{1.8 * side, 1.8 * side, 1.8 * side};
  }
  return HilbertCurve(box);
}

Territories::Territories(TetComplex& complex, std::size_t num_parts, std::size_t num_items,
                         const std::function<std::uint32_t(std::size_t)>& key_of_item, std::size_t slots_per_item)
    : c_(complex) {
  parts_.reserve(num_parts);
  auto begin_of = [&](std::size_t i) { return i * num_items / num_parts; };
  for (std::size_t i = 0; i < num_parts; ++i) {
    const std::size_t begin = begin_of(i), end = begin_of(i + 1);
    const std::uint32_t first = i == 0 ? 0 : key_of_item(begin);
    const std::uint32_t last = i + 1 == num_parts ? kNoIndex : key_of_item(end);
    DELFRONT_CHECK(first <= last);  // or two parts would overlap
    parts_.push_back({begin,
                      end,
                      {nullptr, first, last - first},
                      c_.take_slots(slots_per_item * (end - begin) + kSpareSlots),
                      DelaunayKernel(c_)});
  }
}

void Territories::run(const std::uint32_t* key_of_vertex, int threads,
                      const std::function<void(Part&, std::size_t)>& work) {
  parallel_for(threads, parts_.size(), [&](std::size_t i) {
    Part& part = parts_[i];
    part.territory.key = parts_.size() > 1 ? key_of_vertex : nullptr;
    part.kernel.enter(part.territory, std::move(part.slots));
    work(part, i);
    part.slots = part.kernel.leave();
  });
}

void Territories::finish(KernelCounts& counts) {
  for (Part& part : parts_) {
    c_.give_slots(part.slots);
    add_counts(counts, part.kernel.counts);
    part.kernel.counts = {};
  }
}

void insert_batch(TetComplex& complex, std::span<const VertexIndex> vertices, const DelaunayKernel::Limits& limits,
                  TetIndex start, KernelCounts& counts, Context& context) {
  Batch(complex, limits, start, counts, context).insert(vertices);
}

}  // namespace delfront
