// SPDX-License-Identifier: Apache-2.0
// Branch and bound over sources.
//
// A law turned around says how far a source reaches: within which distance it can give less than a size. So each child
// of a node keeps, for 32 sizes, the largest reach of the sources in it; a search looks up once which of the 32 sizes
// is the next above the best value so far, and enters the children whose boxes are nearer than their reach for it. The
// sizes are quantiles of those that the field has at places of a sample, so that they stand dense where they matter:
// with flat laws a whole field may lie within a few per cent.
//
// Boxes and reaches are in single precision, in units of the extent of all: boxes are widened by kMargin and reaches by
// kWiden, which is more than all rounding of single precision adds up to, so that no source is missed. Values are
// computed by SourceTerm alone and the least of them is taken: the result is the same to the bit for any start value,
// any order of the search, and for the plain scan.
//
// The tree is built top down for the least expected work: a child is entered with the probability that a place lies
// in its box widened by its reach, averaged over the sizes of the sample (the surface-area heuristic, with volumes).
#include "sizing/source_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "sizing/source_tree_builder.hpp"

namespace delfront {
namespace {

constexpr std::uint32_t kTermBit = 0x80000000u;
constexpr float kFar = 1e18f;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxStack = 1024;  // seven left a level, 64 levels (see SourceTreeBuilder) and more

double distance_of_boxes(const Box& a, const Box& b) {
  Point away;
  for (int k = 0; k < 3; ++k) away[k] = std::max({a.low[k] - b.high[k], 0.0, b.low[k] - a.high[k]});
  return length(away);
}

}  // namespace

double SourceTerm::lower_bound(const Box& query) const {
  const double from_centre = shape.distance(query.centre()) - 0.5 * query.diagonal();
  const double away = std::max(from_centre, distance_of_boxes(shape.box(), query));
  // Rounding, of places as large as the corners of the box.
  const double size = std::abs(query.low.x) + std::abs(query.low.y) + std::abs(query.low.z) + std::abs(query.high.x) +
                      std::abs(query.high.y) + std::abs(query.high.z) + away;
  return factor * law(std::max(0.0, away - 1e-14 * size)) * (1 - 1e-13);
}

SourceTree::SourceTree(std::vector<SourceTerm> terms, Context& context) : terms_(std::move(terms)) {
  if (terms_.empty()) return;
  Box box;
  for (const SourceTerm& term : terms_) box.add(term.shape.box());
  centre_ = box.centre();
  extent_ = 0.5 * box.longest_side();
  if (!(extent_ > 0)) extent_ = 1;
  number_.resize(terms_.size());
  for (std::size_t i = 0; i < number_.size(); ++i) number_[i] = static_cast<std::uint32_t>(i);
  // The first tree, for sizes spread evenly from the least delta0, serves to sample the field for the second.
  std::vector<double> sizes;
  for (int pass = 0; pass < 2; ++pass) {
    context.check_limits();
    SourceTreeBuilder builder(terms_, centre_, extent_);
    if (pass == 0)
      builder.choose_first_sizes();
    else
      builder.choose_sizes(sample_sizes());
    const auto order = builder.build(context);
    std::copy(builder.edges().begin(), builder.edges().end(), edge_);
    nodes_.assign(builder.nodes().size(), {});
    reaches_.assign(builder.nodes().size(), {});
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const SourceTreeBuilder::Node& from = builder.nodes()[n];
      for (std::size_t c = 0; c < kWidth; ++c) {
        for (int k = 0; k < 3; ++k) nodes_[n].low[k][c] = from.low[k][c], nodes_[n].high[k][c] = from.high[k][c];
        nodes_[n].child[c] = from.child[c];
        for (std::size_t b = 0; b < kBins; ++b) reaches_[n].squared[b][c] = from.reach[b][c];
      }
    }
    std::vector<SourceTerm> sorted;
    std::vector<std::uint32_t> numbers;
    sorted.reserve(terms_.size());
    for (const std::uint32_t i : order) {
      sorted.push_back(std::move(terms_[i]));
      numbers.push_back(number_[i]);
    }
    terms_ = std::move(sorted);
    number_ = std::move(numbers);
  }
}

std::vector<double> SourceTree::sample_sizes() const {
  std::mt19937_64 random(1);
  std::vector<double> sizes;
  std::uint32_t hint = kNone;
  auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int i = 0; i < 2048; ++i) {
    Point p{2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1};
    p = centre_ + 1.1 * extent_ * p;
    sizes.push_back(least(p, kInfinity, hint));
  }
  return sizes;
}

int SourceTree::bin_of(double size) const {
  int bin = 0;
  for (int k = 0; k < kBins; ++k) bin += edge_[k] < size;
  return bin;
}

SourceTree::Query SourceTree::start(const Box& box, double best) const {
  Query query{{}, {}, best, bin_of(best)};
  for (int k = 0; k < 3; ++k) {
    const auto place = [&](double x) {
      return std::clamp(static_cast<float>((x - centre_[k]) / extent_), -kFar, kFar);
    };
    query.low[k] = place(box.low[k]);
    query.high[k] = place(box.high[k]);
  }
  return query;
}

/// Calls visit(term) for each that may be below query.best, which `visit` may lower.
template <class Visit>
void SourceTree::search(Query& query, const Visit& visit) const {
  struct Entry {
    float squared;
    std::uint32_t child, parent, lane;
  };
  Entry stack[kMaxStack];
  std::size_t top = 0;
  std::uint32_t node_id = 0;
  const Lanes zero = {};
  for (;;) {
    const Node& node = nodes_[node_id];
    Lanes sum = zero;
    for (int k = 0; k < 3; ++k) {
      const Lanes below = node.low[k] - query.high[k], above = query.low[k] - node.high[k];
      Lanes gap = below > above ? below : above;
      gap = gap > zero ? gap : zero;
      sum += gap * gap;
    }
    const auto is_near = sum < reaches_[node_id].squared[query.bin];
#if defined(__AVX__)
    auto mask = static_cast<unsigned>(_mm256_movemask_ps(std::bit_cast<__m256>(is_near)));
#else
    unsigned mask = 0;
    for (unsigned k = 0; k < kWidth; ++k) mask |= (is_near[k] != 0 ? 1u : 0u) << k;
#endif
    const std::size_t bottom = top;
    for (; mask != 0; mask &= mask - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
      const std::uint32_t child = node.child[lane];
      const float squared = sum[lane];
      std::size_t place = top++;  // the nearest on top
      for (; place > bottom && stack[place - 1].squared < squared; --place) stack[place] = stack[place - 1];
      stack[place] = {squared, child, node_id, lane};
    }
    for (;;) {
      if (top == 0) return;
      const Entry& entry = stack[--top];
      const float reach = reaches_[entry.parent].squared[query.bin][entry.lane];
      if (!(entry.squared < reach)) continue;
      node_id = entry.child;
      if (!(node_id & kTermBit)) break;
      visit(node_id & ~kTermBit, reach);
    }
  }
}

double SourceTree::least(Point p, double best, std::uint32_t& hint) const {
  std::uint32_t winner = kNone;
  const std::uint32_t tried = hint;
  if (tried != kNone) {
    const double value = terms_[tried](p);
    if (value < best) best = value, winner = tried;
  }
  Query query = start({p, p}, best);
  const double unit = 1 / (extent_ * extent_);
  search(query, [&](std::uint32_t t, float reach) {
    if (t == tried) return;
    const SourceTerm& term = terms_[t];
    const double away = term.shape.distance(p);
    if (away * away * unit > static_cast<double>(reach)) return;
    const double value = term.factor * term.law(away);
    if (!(value < query.best)) return;
    query.best = value;
    query.bin = bin_of(value);
    winner = t;
  });
  hint = winner;
  return query.best;
}

double SourceTree::least_by_scan(Point p) const {
  double best = kInfinity;
  for (const SourceTerm& term : terms_) best = std::min(best, term(p));
  return best;
}

double SourceTree::lower_bound(const Box& box) const {
  std::uint32_t hint = kNone;
  Query query = start(box, least(box.centre(), kInfinity, hint));
  search(query, [&](std::uint32_t t, float) {
    const double value = terms_[t].lower_bound(box);
    if (!(value < query.best)) return;
    query.best = value;
    query.bin = bin_of(value);
  });
  return query.best * (1 - 1e-13);
}

std::vector<std::uint32_t> SourceTree::below(const Box& box, double size) const {
  std::vector<std::uint32_t> found;
  if (terms_.empty()) return found;
  Query query = start(box, size);
  const bool is_point = box.low == box.high;
  search(query, [&](std::uint32_t t, float) {
    if ((is_point ? terms_[t](box.low) : terms_[t].lower_bound(box)) < size) found.push_back(number_[t]);
  });
  std::sort(found.begin(), found.end());
  return found;
}

double SourceTree::largest() const {
  double result = kInfinity;
  for (const SourceTerm& term : terms_) result = std::min(result, term.factor * term.law.largest());
  return result;
}

double SourceTree::smallest() const {
  double result = kInfinity;
  for (const SourceTerm& term : terms_) result = std::min(result, term.factor * term.law.delta0());
  return result;
}

}  // namespace delfront
