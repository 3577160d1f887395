// SPDX-License-Identifier: Apache-2.0
// The front in rounds: the faces that would make the smallest elements, each once, along a curve; the faces they leave
// wait for the next round. Threads share a round out by slabs of space: a face whose neighbourhood lies in one slab is
// that slab's, what is left is shared out along another axis, then the third, and the rest is done in one piece. Where
// the cuts lie depends on the front alone.
#include "volume/front.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/hilbert.hpp"
#include "base/parallel.hpp"
#include "delfront/errors.hpp"
#include "volume/front_closing.hpp"
#include "volume/front_stars.hpp"
#include "volume/front_step.hpp"

namespace delfront {

namespace {

/// Sweep by sweep less is asked for (F17).
constexpr FrontSettings kSweeps[] = {
    {.radius = 1.25, .quality = 0.01, .wedge = 0.06, .clearance = 0.05, .to_points = 0.6, .to_faces = 0.45},
    {.radius = 1.6, .quality = 0.01, .wedge = 0.001, .clearance = 0.0, .to_points = 0.4, .to_faces = 0.2},
    {.radius = 2.5, .quality = 1e-12, .wedge = 0, .clearance = 0, .to_points = 0.2, .to_faces = 0.05, .is_local = true},
};
constexpr double kSmallest = 1.5;        ///< a round takes faces up to that times the smallest
constexpr std::uint16_t kMostTries = 3;  ///< of a face in a sweep
constexpr std::size_t kFacesPerSlab = 1000, kMostSlabs = 64;
constexpr double kMostDeferred = 0.15;  ///< share of the faces that slabs may leave to the next cuts, about
constexpr double kWorthSlabs = 0.02;    ///< share that is worth cutting again
constexpr std::size_t kFacesPerCancelCheck = 256;
constexpr std::size_t kFacesPerShare = 8192;  ///< of the front, that one thread shares out among the slabs
constexpr int kSweepsAgain = 4;           ///< times that a ring round what is left is emptied and all sweeps are made
constexpr double kMuchByDelaunay = 0.01;  ///< of all cells: worth a word
constexpr std::size_t kFew = 3;  ///< times so many faces in the front as there are to do: only those near are searched
constexpr int kPhases = 4;       ///< three axes, then one piece

/// Cells of a lattice round some boxes, told by hashes: a box that is near one of them is always found, others at
/// times.
class CellMarks {
 public:
  CellMarks(std::size_t boxes, double margin) : margin_(margin), side_(4 * margin) {
    bits_.resize(std::bit_ceil(std::size_t{64} * boxes + 1));
  }
  void add(Box box) {
    const Point around{margin_, margin_, margin_};
    box.low = box.low - around;
    box.high = box.high + around;
    visit(box, [&](std::size_t bit) { return bits_[bit] = true, false; });
  }
  bool are_near(const Box& box) const {
    if (box.longest_side() > side_) return true;
    return visit(box, [&](std::size_t bit) { return bool(bits_[bit]); });
  }

 private:
  template <class Visit>
  bool visit(const Box& box, Visit&& stop_at) const {
    std::int64_t low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<std::int64_t>(std::floor(box.low[k] / side_));
      high[k] = static_cast<std::int64_t>(std::floor(box.high[k] / side_));
    }
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k)
          if (stop_at(bit_of(i, j, k))) return true;
    return false;
  }
  std::size_t bit_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
    auto h = static_cast<std::uint64_t>(i) * 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 29) ^ static_cast<std::uint64_t>(j)) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ (h >> 31) ^ static_cast<std::uint64_t>(k)) * 0x94d049bb133111ebull;
    return (h >> 20) & (bits_.size() - 1);
  }

  double margin_, side_;
  std::vector<bool> bits_;
};

class Front {
 public:
  Front(TetComplex& complex, const SizeField& size, Context& context)
      : c_(complex), front_(complex, &size), context_(context) {
    for (std::uint32_t f = 0; f < front_.num_slots(); ++f) waiting_.push_back(f);
    live_ = waiting_;
  }

  FrontReport run() {
    for (const FrontSettings& settings : kSweeps) sweep(settings);
    report_.sides_left = waiting_.size();
    std::vector<std::uint32_t> left = fill_cavities(front_, waiting_, report_, context_);
    left = fill_by_stars(front_, left, report_, context_);
    for (int again = 0; again < kSweepsAgain && !left.empty(); ++again) {
      live_ = waiting_ = empty_around(front_, left, report_);
      for (const FrontSettings& settings : kSweeps) sweep(settings);
      left = fill_cavities(front_, waiting_, report_, context_);
      left = fill_by_stars(front_, left, report_, context_);
    }
    if (!left.empty()) {
      report_.delaunay_places = places_of_cavities(front_, left);
      close_by_delaunay(front_, left, report_, context_);
    }
    DELFRONT_CHECK(front_.obstacles().num_pending() == 0);
    front_.join();
    fill_report();
    warn_of_delaunay();
    return report_;
  }

 private:
  /// A grid that was asked of the front is not quite one.
  void warn_of_delaunay() const {
    const double share = static_cast<double>(report_.closed_by_delaunay) / static_cast<double>(c_.num_live());
    if (share <= kMuchByDelaunay) return;
    const Point at = report_.delaunay_places.empty() ? Point{} : report_.delaunay_places[0].at;
    context_.warn(fmt::format(
        "{} cells ({:.0f} % of all) were put in by constrained Delaunay, not by the front, in {} cavities that it "
        "could "
        "not fill, the widest at ({:g}, {:g}, {:g}): most often the surface's triangles there are much longer than the "
        "space before them is wide; finer ones help (--surface-method front --gap 1)",
        report_.closed_by_delaunay, 100 * share, report_.delaunay_places.size(), at.x, at.y, at.z));
  }

  void sweep(const FrontSettings& settings) {
    if (waiting_.empty()) return;
    settings_ = &settings;
    ++report_.sweeps;
    while (choose_faces()) {
      context_.progress("front", c_.num_live(), 0, "cells");
      context_.check_cells(c_.num_live());
      const auto few = static_cast<std::size_t>(kWorthSlabs * static_cast<double>(active_.size()));
      for (int phase = 0; phase < kPhases && !active_.empty(); ++phase)
        run_phase(phase > 0 && active_.size() <= few ? kPhases - 1 : phase);
      ++report_.rounds;
    }
    waiting_.swap(skipped_);
    skipped_.clear();
    keep_live(waiting_);
    for (const std::uint32_t f : waiting_) front_.face(f).tries = 0;
  }

  /// Slots are used again, so a number may stand there twice. The order stays: it is nearly that of space.
  void keep_live(std::vector<std::uint32_t>& faces) {
    is_listed_.assign(front_.num_slots(), false);
    std::erase_if(faces, [&](std::uint32_t f) {
      if (!front_.face(f).is_alive || is_listed_[f]) return true;
      is_listed_[f] = true;
      return false;
    });
  }

  /// F6: those that would make the smallest elements, along a curve.
  bool choose_faces() {
    keep_live(waiting_);
    float smallest = 1e30f;
    for (const std::uint32_t f : waiting_) smallest = std::min(smallest, front_.face(f).size);
    active_.clear();
    std::erase_if(waiting_, [&](std::uint32_t f) {
      const bool is_active = front_.face(f).size <= static_cast<float>(kSmallest) * smallest;
      if (is_active) active_.push_back(f);
      return is_active;
    });
    sort_active();
    return !active_.empty();
  }

  void sort_active() {
    if (active_.empty()) return;
    Box box;
    for (const std::uint32_t f : active_) box.add(middle(f));
    const HilbertCurve curve(box);
    order_.clear();
    for (const std::uint32_t f : active_) order_.push_back({curve.key(middle(f)), f});
    radix_sort(order_, context_.threads);
    for (std::size_t i = 0; i < active_.size(); ++i) active_[i] = order_[i].second;
  }

  Point middle(std::uint32_t f) const {
    const auto n = front_.nodes(f);
    return (1.0 / 3) * (c_.point(n[0]) + c_.point(n[1]) + c_.point(n[2]));
  }

  /// Cuts where as many faces lie on either side, no more than leave most faces to one slab.
  std::vector<FrontSlab> cut_slabs(int axis, bool is_last) const {
    std::vector<double> at;
    double reach = 0;
    for (const std::uint32_t f : active_) {
      at.push_back(middle(f)[axis]);
      reach += 2 * settings_->radius * static_cast<double>(front_.face(f).size) * front_.frame(f).reach()[axis];
    }
    const auto [low, high] = std::minmax_element(at.begin(), at.end());
    const double cuts = kMostDeferred * (*high - *low) * static_cast<double>(at.size()) / (2 * reach);
    const auto most = static_cast<std::size_t>(std::clamp(cuts, 0.0, static_cast<double>(kMostSlabs - 1)));
    // A power of two, so that two and four threads have as much to do each.
    const std::size_t count = is_last ? 1 : std::bit_floor(1 + std::min(active_.size() / kFacesPerSlab, most));
    std::vector<FrontSlab> slabs(1);
    slabs[0].axis = axis;
    for (std::size_t i = 1; i < count; ++i) {
      const auto nth = at.begin() + static_cast<std::ptrdiff_t>(i * at.size() / count);
      std::nth_element(at.begin(), nth, at.end());
      if (!(*nth > slabs.back().low)) continue;
      slabs.back().high = *nth;
      slabs.push_back({axis, *nth});
    }
    return slabs;
  }

  void run_phase(int phase) {
    std::erase_if(active_, [&](std::uint32_t f) { return !front_.face(f).is_alive; });
    keep_live(live_);  // before the slots of what is gone are handed out again
    const int axis = static_cast<int>((report_.rounds + static_cast<unsigned>(phase)) % 3);
    const std::vector<FrontSlab> slabs = cut_slabs(axis, phase == kPhases - 1);
    std::vector<std::vector<std::uint32_t>> faces(slabs.size()), left(slabs.size()), failed(slabs.size());
    for (const std::uint32_t f : active_) {
      const double x = middle(f)[axis];
      std::size_t i = 0;
      while (x >= slabs[i].high) ++i;
      faces[i].push_back(f);
    }
    share_out_front(slabs);
    std::vector<FrontWorker> workers;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      workers.emplace_back(front_, *settings_, slabs[i]);
      workers.back().stock = front_.take(faces[i].size());
    }
    parallel_for(context_.threads, slabs.size(),
                 [&](std::size_t i) { work(workers[i], i, faces[i], left[i], failed[i]); });
    active_.clear();
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      FrontWorker& worker = workers[i];
      front_.give(worker.stock);
      counts_ += worker.counts;
      waiting_.insert(waiting_.end(), worker.made.begin(), worker.made.end());
      live_.insert(live_.end(), worker.made.begin(), worker.made.end());
      active_.insert(active_.end(), left[i].begin(), left[i].end());
      for (const std::uint32_t f : failed[i])
        if (front_.face(f).is_alive) (++front_.face(f).tries < kMostTries ? waiting_ : skipped_).push_back(f);
    }
  }

  /// Which faces of the front have a part of which slab. Told before any worker changes its own.
  void share_out_front(const std::vector<FrontSlab>& slabs) {
    shares_.resize((live_.size() + kFacesPerShare - 1) / kFacesPerShare);
    const int axis = slabs[0].axis;
    parallel_for(context_.threads, shares_.size(), [&](std::size_t s) {
      shares_[s].assign(slabs.size(), {});
      const std::size_t end = std::min(live_.size(), (s + 1) * kFacesPerShare);
      for (std::size_t i = s * kFacesPerShare; i < end; ++i) {
        const Box box = front_.box(live_[i]);
        const auto first = std::partition_point(slabs.begin(), slabs.end(),
                                                [&](const FrontSlab& slab) { return slab.high <= box.low[axis]; });
        for (auto slab = first; slab != slabs.end() && slab->meets(box); ++slab)
          shares_[s][static_cast<std::size_t>(slab - slabs.begin())].push_back(live_[i]);
      }
    });
  }

  void work(FrontWorker& worker, std::size_t slab, const std::vector<std::uint32_t>& faces,
            std::vector<std::uint32_t>& left, std::vector<std::uint32_t>& failed) const {
    plant_tree(worker, slab, faces);
    std::size_t seen = 0;
    for (const std::uint32_t f : faces) {
      if (seen++ % kFacesPerCancelCheck == 0) context_.check_limits();
      const auto result = worker.advance(f);
      if (result == FrontWorker::Result::deferred) left.push_back(f);
      if (result == FrontWorker::Result::failed) failed.push_back(f);
    }
  }

  /// The faces of the slab that may be met round these.
  void plant_tree(FrontWorker& worker, std::size_t slab, const std::vector<std::uint32_t>& faces) const {
    Box box;
    double margin = 0;
    for (const std::uint32_t f : faces) {
      for (const VertexIndex v : front_.nodes(f)) box.add(c_.point(v));
      margin = std::max(margin, worker.reach_of_step(f));
    }
    const Point around{margin, margin, margin};
    box.low = box.low - around;
    box.high = box.high + around;
    const FrontSlab& own = worker.slab();
    box.low[own.axis] = std::max(box.low[own.axis], own.low);
    box.high[own.axis] = std::min(box.high[own.axis], own.high);
    worker.tree.clear(box);
    const bool are_few = kFew * faces.size() < live_.size();
    CellMarks marks(are_few ? faces.size() : 0, margin);
    if (are_few)
      for (const std::uint32_t f : faces) marks.add(front_.box(f));
    for (const std::vector<std::vector<std::uint32_t>>& share : shares_)
      for (const std::uint32_t f : share[slab]) {
        const Box of_face = front_.box(f);
        if (box.overlaps(of_face) && (!are_few || marks.are_near(of_face))) worker.tree.insert(f, of_face);
      }
  }

  void fill_report() {
    report_.sides_processed = counts_.steps;
    report_.cells = counts_.tets;
    report_.points += counts_.points;
    report_.crossing_share = counts_.step_seconds > 0 ? counts_.test_seconds / counts_.step_seconds : 0;
    const auto a_step = [&](std::uint64_t n) {
      return static_cast<double>(n) / static_cast<double>(std::max<std::uint64_t>(counts_.steps, 1));
    };
    context_.log(
        LogLevel::debug,
        fmt::format("front: {} steps, {} deferred, {} failed; a step looks at {:.1f} faces ({:.1f} near, {:.1f} "
                    "points), {:.2f} candidates, tests {:.2f} tets, {:.2f} faces by planes, {:.2f} exactly",
                    counts_.steps, counts_.deferred, counts_.failed, a_step(counts_.visited),
                    a_step(counts_.near.faces), a_step(counts_.near.points), a_step(counts_.candidates),
                    a_step(counts_.near.tests), a_step(counts_.near.plane_tests), a_step(counts_.near.exact_tests)));
  }

  TetComplex& c_;
  FrontStore front_;
  Context& context_;
  const FrontSettings* settings_ = nullptr;
  std::vector<std::uint32_t> waiting_, skipped_, active_;        ///< faces
  std::vector<std::uint32_t> live_;                              ///< all faces of the front; some that were
  std::vector<std::vector<std::vector<std::uint32_t>>> shares_;  ///< of live_, by part of it and slab
  std::vector<bool> is_listed_;                                  ///< scratch of keep_live()
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
  FrontCounts counts_;
  FrontReport report_;
};

}  // namespace

FrontReport fill_by_front(BoundaryGrid& grid, const SizeField& size, Context& context) {
  const StageTimer timer(context, "front");
  FrontReport report;
  const auto give_up = [&](const char* why) {
    report = {};
    report.gave_up = why;
    context.warn(fmt::format("no pure front here: {}; points by the front, connected by Delaunay, instead", why));
  };
  const TetComplex empty = grid.complex;
  try {
    report = Front(grid.complex, size, context).run();
  } catch (const MeshingError& e) {
    grid.complex = empty;
    give_up(e.what());
  }
  return report;
}

}  // namespace delfront
