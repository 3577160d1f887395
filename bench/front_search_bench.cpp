// SPDX-License-Identifier: Apache-2.0
// What the front's stores cost a step beside those of the literature: a heap for the next face and an octree of points
// with the faces at each, against rounds along a curve and an octree of boxes that is planted for each round (F6, F13,
// F16). A flat front of 2 n^2 faces moves layer by layer through a lattice of points that are moved a little; each step
// takes the next face, looks for all faces near its ideal point, and puts its copy in the next layer in its place.
// Before that both are asked for the faces near each face, and must find the same: exit 1 where they do not.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include "base/hilbert.hpp"
#include "reference/face_heap.hpp"
#include "reference/point_octree.hpp"
#include "spatial/box_octree.hpp"

namespace {

using delfront::Box;
using delfront::Point;

constexpr std::uint32_t kLayers = 2;
constexpr double kRadius = 1.25;  ///< of the search, in sides
constexpr double kLongest = 1.4;  ///< side of a face's box, at most

/// Faces by number: layer by layer, two a cell of the lattice. The side is 1.
class Layers {
 public:
  explicit Layers(std::uint32_t n) : n_(n) {
    std::mt19937_64 random(17);
    std::uniform_real_distribution<double> off(-0.2, 0.2);
    for (std::uint32_t k = 0; k <= kLayers; ++k)
      for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
          points_.push_back({i + off(random), j + off(random), 0.8 * k + off(random)});
  }
  std::uint32_t faces_a_layer() const { return 2 * n_ * n_; }
  const std::vector<Point>& points() const { return points_; }
  std::array<std::uint32_t, 3> corners(std::uint32_t f) const {
    const std::uint32_t layer = f / faces_a_layer(), cell = f % faces_a_layer() / 2, row = n_ + 1;
    const std::uint32_t a = layer * row * row + cell / n_ * row + cell % n_;
    if (f % 2 == 0) return {a, a + 1, a + row + 1};
    return {a, a + row + 1, a + row};
  }
  Box box(std::uint32_t f) const {
    Box box;
    for (const std::uint32_t p : corners(f)) box.add(points_[p]);
    return box;
  }
  Box query(std::uint32_t f) const {
    const auto [a, b, c] = corners(f);
    const Point ideal = (1.0 / 3) * (points_[a] + points_[b] + points_[c]) + Point{0, 0, 0.8};
    Box box = this->box(f);
    box.add(ideal - Point{kRadius, kRadius, kRadius});
    box.add(ideal + Point{kRadius, kRadius, kRadius});
    return box;
  }
  /// What the element over the face would measure: all alike, but none the same.
  float size(std::uint32_t f) const {
    const Box b = box(f);
    return static_cast<float>(1 + f / faces_a_layer() + 0.1 * b.longest_side());
  }
  Box bounds() const {
    Box box;
    for (const Point& p : points_) box.add(p);
    return box;
  }

 private:
  std::uint32_t n_;
  std::vector<Point> points_;
};

struct Found {
  std::uint64_t faces = 0, sum = 0;
  void add(std::uint32_t f) { ++faces, sum += f * std::uint64_t{0x9e3779b97f4a7c15}; }
};

/// Heap, octree of points, faces at points.
class Literature {
 public:
  explicit Literature(const Layers& layers) : layers_(layers), tree_(layers.bounds()), at_(layers.points().size()) {
    seen_.resize(std::size_t{layers.faces_a_layer()} * (kLayers + 1));
    for (std::uint32_t f = 0; f < layers.faces_a_layer(); ++f) add(f);
  }

  void run(std::uint32_t steps, Found& found) {
    for (std::uint32_t step = 0; step < steps; ++step) {
      const std::uint32_t f = heap_.smallest();
      look(f, found);
      remove(f);
      add(f + layers_.faces_a_layer());
    }
  }

  void look(std::uint32_t f, Found& found) {
    ++stamp_;
    const Box query = layers_.query(f);
    Box wide = query;  // a face may reach in whose points all lie out
    wide.add(query.low - Point{kLongest, kLongest, kLongest});
    wide.add(query.high + Point{kLongest, kLongest, kLongest});
    tree_.for_each_in(wide, [&](std::uint32_t p) {
      for (const std::uint32_t g : at_[p]) {
        if (seen_[g] == stamp_) continue;
        seen_[g] = stamp_;
        if (query.overlaps(layers_.box(g))) found.add(g);
      }
    });
  }

 private:
  void add(std::uint32_t f) {
    heap_.insert(f, layers_.size(f));
    for (const std::uint32_t p : layers_.corners(f)) {
      if (at_[p].empty()) tree_.insert(p, layers_.points()[p]);
      at_[p].push_back(f);
    }
  }
  void remove(std::uint32_t f) {
    heap_.remove(f);
    for (const std::uint32_t p : layers_.corners(f)) {
      std::erase(at_[p], f);
      if (at_[p].empty()) tree_.remove(p, layers_.points()[p]);
    }
  }
  const Layers& layers_;
  delfront::reference::FaceHeap heap_;
  delfront::reference::PointOctree tree_;
  std::vector<std::vector<std::uint32_t>> at_;  ///< faces by point
  std::vector<std::uint32_t> seen_;
  std::uint32_t stamp_ = 0;
};

/// Rounds, as in src/volume/front.cpp: a layer is a round here.
class Rounds {
 public:
  explicit Rounds(const Layers& layers)
      : layers_(layers), is_alive_(std::size_t{layers.faces_a_layer()} * (kLayers + 1)) {
    for (std::uint32_t f = 0; f < layers.faces_a_layer(); ++f) waiting_.push_back(f), is_alive_[f] = true;
  }

  void run(std::uint32_t steps, Found& found) {
    for (std::uint32_t step = 0; step < steps; step += layers_.faces_a_layer()) round(found);
  }

  /// Of the round under way.
  void look(std::uint32_t f, Found& found) const {
    const Box query = layers_.query(f);
    tree_.for_each_overlap(query, [&](std::uint32_t g) {
      if (is_alive_[g] && query.overlaps(layers_.box(g))) found.add(g);
    });
  }
  void choose_and_plant() {
    choose();
    Box box;
    for (const std::uint32_t f : active_) box.add(layers_.query(f));
    tree_.clear(box);
    for (const std::uint32_t f : active_) tree_.insert(f, layers_.box(f));
  }

 private:
  void round(Found& found) {
    choose_and_plant();
    for (const std::uint32_t f : active_) {
      look(f, found);
      const std::uint32_t next = f + layers_.faces_a_layer();
      is_alive_[f] = false;
      is_alive_[next] = true;
      tree_.insert(next, layers_.box(next));
      waiting_.push_back(next);
    }
  }
  void choose() {
    float smallest = 1e30f;
    for (const std::uint32_t f : waiting_) smallest = std::min(smallest, layers_.size(f));
    Box box;
    for (const std::uint32_t f : waiting_) box.add(layers_.box(f).centre());
    const delfront::HilbertCurve curve(box);
    order_.clear();
    for (const std::uint32_t f : waiting_)
      if (layers_.size(f) <= 1.5f * smallest) order_.push_back({curve.key(layers_.box(f).centre()), f});
    delfront::radix_sort(order_);
    active_.clear();
    for (const auto& [key, f] : order_) active_.push_back(f);
    waiting_.clear();  // all of them: sizes of a layer differ by less than that
  }

  const Layers& layers_;
  delfront::BoxOctree tree_;
  std::vector<std::uint32_t> waiting_, active_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
  std::vector<bool> is_alive_;
};

/// Before the front moves.
bool find_the_same(const Layers& layers) {
  Literature literature(layers);
  Rounds rounds(layers);
  rounds.choose_and_plant();
  for (std::uint32_t f = 0; f < layers.faces_a_layer(); ++f) {
    Found of_literature, of_rounds;
    literature.look(f, of_literature);
    rounds.look(f, of_rounds);
    if (of_literature.faces != of_rounds.faces || of_literature.sum != of_rounds.sum) return false;
  }
  return true;
}

template <class Stores>
double nanoseconds_a_step(const Layers& layers, std::uint32_t steps, Found& found) {
  Stores stores(layers);
  const auto start = std::chrono::steady_clock::now();
  stores.run(steps, found);
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / steps;
}

}  // namespace

int main() {
  fmt::print(
      "| faces of the front | found a step | heap, octree of points: ns a step | rounds, octree of boxes | gain |\n");
  fmt::print("| ---: | ---: | ---: | ---: | ---: |\n");
  for (const std::uint32_t n : {30u, 100u, 300u, 600u}) {
    const Layers layers(n);
    if (n < 300 && !find_the_same(layers)) {
      fmt::print(stderr, "front_search_bench: the stores do not find the same faces\n");
      return 1;
    }
    const std::uint32_t steps = kLayers * layers.faces_a_layer();
    Found of_literature, of_rounds;
    const double there = nanoseconds_a_step<Literature>(layers, steps, of_literature);
    const double here = nanoseconds_a_step<Rounds>(layers, steps, of_rounds);
    fmt::print("| {} | {:.1f}, {:.1f} | {:.0f} | {:.0f} | {:.1f} |\n", layers.faces_a_layer(),
               static_cast<double>(of_literature.faces) / steps, static_cast<double>(of_rounds.faces) / steps, there,
               here, there / here);
    std::fflush(stdout);
  }
}
