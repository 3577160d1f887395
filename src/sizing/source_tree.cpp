// SPDX-License-Identifier: Apache-2.0
// Branch and bound over sources.
//
// A law turned around says how far a source reaches: within which distance it can give less than a size. So each child
// of a node keeps, for 64 sizes, the largest reach of the sources in it; a search looks up once which of the 64 sizes
// is the next above the best value so far, and enters the children whose boxes are nearer than their reach for it. The
// sizes are quantiles of those that the field has at places of a sample, so that they stand dense where they matter:
// with flat laws a whole field may lie within a few per cent.
//
// Boxes and reaches are in single precision, in units of the extent of all: boxes are widened by kMargin and reaches by
// kWiden, which is more than all rounding of single precision adds up to, so that no source is missed. Values are
// computed by SourceTerm alone and the least of them is taken: the result is the same to the bit for any start value,
// any order of the search, and for the plain scan.
//
// Places come in runs that are near each other. For each run the children that may matter anywhere in its box, below
// what the winner at its first place asks for there at most, are found once; its places begin there instead of at the
// root.
//
// The tree is built top down for the least expected work: a child is entered with the probability that a place lies
// in its box widened by its reach, averaged over the sizes of the sample (the surface-area heuristic, with volumes).
#include "sizing/source_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "base/hilbert.hpp"
#include "sizing/source_tree_builder.hpp"

namespace delfront {
namespace {

constexpr std::uint32_t kTermBit = 0x80000000u;
constexpr float kFar = 1e18f;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxStack = 1024;  // seven left a level, 64 levels (see SourceTreeBuilder) and more

constexpr std::size_t kMostInFirst = 8192;           ///< terms of the tree that serves to sample
constexpr std::size_t kPlacesOfSample = 512;         ///< for quantiles of some thirty sizes
constexpr std::size_t kChunk = 64, kLeastChunk = 8;  // places that share a frontier

template <class Lanes>
unsigned mask_of(const Lanes& is_set) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(std::bit_cast<__m256>(is_set)));
#else
  unsigned mask = 0;
  for (unsigned k = 0; k < 8; ++k) mask |= (is_set[k] != 0 ? 1u : 0u) << k;
  return mask;
#endif
}

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

SourceTree::SourceTree(std::vector<SourceTerm> terms, Context& context) {
  if (terms.empty()) return;
  Box box;
  for (const SourceTerm& term : terms) box.add(term.shape.box());
  centre_ = box.centre();
  extent_ = 0.5 * box.longest_side();
  if (!(extent_ > 0)) extent_ = 1;
  per_extent_ = 1 / extent_;
  // A first tree, of some of the terms, for sizes spread evenly from the least delta0, serves to sample the field.
  const std::size_t step = terms.size() / kMostInFirst + 1;
  for (std::size_t i = 0; i < terms.size(); i += step) terms_.push_back(terms[i]);
  build(nullptr, context);
  const std::vector<double> sample = sample_sizes();
  terms_ = std::move(terms);
  build(&sample, context);
}

/// @param sample  sizes of the field at places all over it; null: not known yet
void SourceTree::build(const std::vector<double>* sample, Context& context) {
  context.check_limits();
  SourceTreeBuilder builder(terms_, centre_, extent_);
  sample != nullptr ? builder.choose_sizes(*sample) : builder.choose_first_sizes();
  number_ = builder.build(sample != nullptr, context);
  std::copy(builder.edges().begin(), builder.edges().end(), edge_);
  for (std::size_t b = 0; b < kBins; ++b) per_width_[b] = builder.width(b) > 0 ? 1 / builder.width(b) : 0;
  take_nodes(builder);
  std::vector<SourceTerm> sorted;
  sorted.reserve(terms_.size());
  for (const std::uint32_t i : number_) sorted.push_back(std::move(terms_[i]));
  terms_ = std::move(sorted);
}

void SourceTree::take_nodes(const SourceTreeBuilder& builder) {
  nodes_.assign(builder.nodes().size(), {});
  reaches_.assign(builder.nodes().size() * kBins, {});
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const SourceTreeBuilder::Node& from = builder.nodes()[n];
    for (std::size_t c = 0; c < kWidth; ++c) {
      for (int k = 0; k < 3; ++k) nodes_[n].low[k][c] = from.low[k][c], nodes_[n].high[k][c] = from.high[k][c];
      nodes_[n].child[c] = from.child[c];
      nodes_[n].turned = from.turned;
      for (std::size_t b = 0; b < kBins; ++b) {
        reaches_[b * nodes_.size() + n].reach[c] = from.reach[b][c];
        reaches_[b * nodes_.size() + n].fall[c] = from.fall[b][c];
      }
    }
  }
  turned_.assign(builder.turned_boxes().size(), {});
  for (std::size_t n = 0; n < turned_.size(); ++n) {
    const SourceTreeBuilder::TurnedBoxes& from = builder.turned_boxes()[n];
    for (std::size_t c = 0; c < kWidth; ++c)
      for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) turned_[n].axis[k][j][c] = from.axis[k][j][c];
        turned_[n].at[k][c] = from.at[k][c];
        turned_[n].half[k][c] = from.half[k][c];
      }
  }
}

/// In Hilbert order: the winner at one place is a good start at the next, and far from all sources, where each is about
/// as near as the others, a search without one looks at most of them.
std::vector<double> SourceTree::sample_sizes() const {
  std::mt19937_64 random(1);
  auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Point> places(kPlacesOfSample);
  for (Point& p : places) {
    p = {2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1};
    p = centre_ + 1.1 * extent_ * p;
  }
  std::vector<double> sizes;
  Hint hint;
  for (const std::uint32_t i : hilbert_order(places)) sizes.push_back(least(places[i], hint));
  return sizes;
}

SourceTree::Lanes SourceTree::Reach::squared(float below) const {
  Lanes lanes, falls;
  std::memcpy(&lanes, reach, sizeof(lanes));
  std::memcpy(&falls, fall, sizeof(falls));
  lanes -= below * falls;
  lanes = lanes > 0 ? lanes : Lanes{};
  return lanes * lanes;
}

float SourceTree::Reach::squared(std::uint32_t lane, float below) const {
  const float left = reach[lane] - below * fall[lane];
  return left > 0 ? left * left : 0;
}

/// The first bin whose size is not below `size`, from that of the query; and where in it.
void SourceTree::set_best(Query& query, double size) const {
  int bin = query.bin;
  while (edge_[bin] < size) ++bin;
  while (bin > 0 && !(edge_[bin - 1] < size)) --bin;
  query.best = size;
  query.bin = bin;
  query.below = 0;
  if (per_width_[bin] > 0)
    query.below = static_cast<float>(std::min(1.0, (edge_[bin] - size) * per_width_[bin]) * (1 - 1e-6));
}

SourceTree::Query SourceTree::start(Point low, Point high, double best, int bin) const {
  Query query{{}, {}, {}, {}, best, bin, 0};
  set_best(query, best);
  for (int k = 0; k < 3; ++k) {
    const auto place = [&](double x) {
      return std::min(kFar, std::max(-kFar, static_cast<float>((x - centre_[k]) * per_extent_)));
    };
    query.low[k] = place(low[k]);
    query.high[k] = place(high[k]);
    query.middle[k] = 0.5f * (query.low[k] + query.high[k]);
    query.half[k] = query.low[k] == query.high[k] ? 0 : (query.high[k] - query.middle[k]) * (1 + 1e-6f);
  }
  return query;
}

SourceTree::Lanes SourceTree::squared_distance(const Lanes low[3], const Lanes high[3], const Query& query) {
  const Lanes zero = {};
  Lanes sum = zero;
  for (int k = 0; k < 3; ++k) {
    const Lanes below = low[k] - query.high[k], above = query.low[k] - high[k];
    Lanes gap = below > above ? below : above;
    gap = gap > zero ? gap : zero;
    sum += gap * gap;
  }
  return sum;
}

SourceTree::Lanes SourceTree::squared_distance(const TurnedBoxes& boxes, const Query& query) {
  const auto absolute = [](const Lanes& x) { return x < 0 ? -x : x; };
  const bool is_point = query.half[0] == 0 && query.half[1] == 0 && query.half[2] == 0;
  Lanes sum = {};
  for (int k = 0; k < 3; ++k) {
    const Lanes(&axis)[3] = boxes.axis[k];
    Lanes gap =
        absolute(axis[0] * query.middle[0] + axis[1] * query.middle[1] + axis[2] * query.middle[2] - boxes.at[k]) -
        boxes.half[k];
    if (!is_point)
      gap -= absolute(axis[0]) * query.half[0] + absolute(axis[1]) * query.half[1] + absolute(axis[2]) * query.half[2];
    gap = gap > 0 ? gap : Lanes{};
    sum += gap * gap;
  }
  return sum;
}

/// @return those that may be below query.best, as bits; how far away they are
inline unsigned SourceTree::near_children(std::uint32_t id, const Reach& reach, const Query& query, Lanes& away) const {
  const Node& node = nodes_[id];
  away = squared_distance(node.low, node.high, query);
  const Lanes within = reach.squared(query.below);
  const unsigned mask = mask_of(away < within);
  if (mask == 0 || node.turned == kNone) return mask;
  const Lanes turned = squared_distance(turned_[node.turned], query);
  away = away > turned ? away : turned;
  return mask_of(away < within);
}

void SourceTree::prefetch(std::uint32_t child) const {
  const auto* first = (child & kTermBit) ? reinterpret_cast<const char*>(&terms_[child & ~kTermBit])
                                         : reinterpret_cast<const char*>(&nodes_[child]);
  for (int line = 0; line < 4; ++line) __builtin_prefetch(first + 64 * line);
}

/// Calls visit(term, squared reach) for each that may be below query.best, which `visit` may lower. Begins at the root,
/// or at a frontier of a box that holds the query.
template <class Visit>
void SourceTree::search(Query& query, Frontier* frontier, const Visit& visit) const {
  Entry stack[kMaxStack];
  std::size_t top = 0;
  const Reach* reaches = row(query.bin);
  const auto push = [&](Entry entry, std::size_t bottom) {  // the nearest on top
    std::size_t place = top++;
    for (; place > bottom && stack[place - 1].squared < entry.squared; --place) stack[place] = stack[place - 1];
    stack[place] = entry;
    prefetch(entry.child);
  };
  const auto enter = [&](std::uint32_t id) {
    const Node& node = nodes_[id];
    const std::size_t bottom = top;
    Lanes away;
    for (unsigned mask = near_children(id, reaches[id], query, away); mask != 0; mask &= mask - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
      push({away[lane], node.child[lane], id, lane}, bottom);
    }
  };
  if (frontier == nullptr) {
    enter(0);
  } else {
    if (!(frontier->filled >> query.bin & 1)) fill_reaches(query.bin, *frontier);
    const Lanes zero = {};
    for (std::size_t g = 0; g * kWidth < frontier->size; ++g) {
      const Lanes away = squared_distance(frontier->low[g], frontier->high[g], query);
      Lanes reach = frontier->reach[query.bin][g] - query.below * frontier->fall[query.bin][g];
      reach = reach > zero ? reach : zero;
      for (unsigned mask = mask_of(away < reach * reach); mask != 0; mask &= mask - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
        Entry entry = frontier->entry[g * kWidth + lane];
        entry.squared = away[lane];
        push(entry, 0);
      }
    }
  }
  while (top > 0) {
    const Entry entry = stack[--top];
    const float reach = reaches[entry.parent].squared(entry.lane, query.below);
    if (!(entry.squared < reach)) continue;
    if (entry.child & kTermBit) {
      visit(entry.child & ~kTermBit, reach);
      reaches = row(query.bin);
    } else {
      enter(entry.child);
    }
  }
}

/// Breadth first from the root, as far as there is room.
void SourceTree::find_frontier(const Query& query, Frontier& frontier) const {
  const Reach* const reaches = row(query.bin);
  Entry queue[Frontier::kLanes];  // nodes to open: first ... last
  std::size_t first = 0, last = 0;
  frontier.size = 0;
  frontier.filled = 0;
  const auto add = [&](const Entry& entry) {
    const std::size_t g = frontier.size / kWidth, lane = frontier.size % kWidth;
    const Node& parent = nodes_[entry.parent];
    for (int k = 0; k < 3; ++k) {
      frontier.low[g][k][lane] = parent.low[k][entry.lane];
      frontier.high[g][k][lane] = parent.high[k][entry.lane];
    }
    frontier.entry[frontier.size++] = entry;
  };
  Entry node{0, 0, kNone, 0};
  for (;;) {
    const Node& opened = nodes_[node.child];
    Lanes away;
    unsigned mask = near_children(node.child, reaches[node.child], query, away);
    const std::size_t room = Frontier::kLanes - frontier.size - (last - first);
    if (static_cast<std::size_t>(std::popcount(mask)) > room) {
      add(node);
    } else {
      for (; mask != 0; mask &= mask - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
        const Entry entry{0, opened.child[lane], node.child, lane};
        if (entry.child & kTermBit)
          add(entry);
        else
          queue[last++ % Frontier::kLanes] = entry;
      }
    }
    if (first == last) break;
    node = queue[first++ % Frontier::kLanes];
  }
}

void SourceTree::fill_reaches(int bin, Frontier& frontier) const {
  const Reach* const reaches = row(bin);
  for (std::size_t g = 0; g * kWidth < frontier.size; ++g) {
    Lanes reach = {}, fall = {};
    const std::size_t used = std::min<std::size_t>(kWidth, frontier.size - g * kWidth);
    for (std::size_t k = 0; k < used; ++k) {
      const Entry& entry = frontier.entry[g * kWidth + k];
      const Reach& of = reaches[entry.parent];
      reach[k] = of.reach[entry.lane];
      fall[k] = of.fall[entry.lane];
    }
    frontier.reach[bin][g] = reach;
    frontier.fall[bin][g] = fall;
  }
  frontier.filled |= std::uint64_t(1) << bin;
}

double SourceTree::least(Point p, Hint& hint, Frontier* frontier, double bound) const {
  std::uint32_t winner = hint.term;
  const std::uint32_t tried = hint.term;
  Query query = start(p, p, tried == kNone ? bound : std::min(bound, terms_[tried](p)), hint.bin);
  const double unit = 1 / (extent_ * extent_);
  search(query, frontier, [&](std::uint32_t t, float reach) {
    if (t == tried) return;
    const SourceTerm& term = terms_[t];
    const double away = term.shape.distance(p);
    if (away * away * unit > static_cast<double>(reach)) return;
    const double value = term.factor * term.law(away);
    if (!(value < query.best)) return;
    set_best(query, value);
    winner = t;
  });
  hint = {winner, query.bin};
  return query.best;
}

void SourceTree::least(std::span<const Point> at, std::span<double> size) const {
  Hint hint;
  if (at.size() < kLeastChunk) {
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = least(at[i], hint, nullptr, kNoBound);
    return;
  }
  Frontier frontier{};
  for (std::size_t begin = 0; begin < at.size(); begin += kChunk) {
    const std::size_t end = std::min(at.size(), begin + kChunk);
    size[begin] = least(at[begin], hint, nullptr, kNoBound);
    if (end - begin < kLeastChunk || hint.term == kNone) {
      for (std::size_t i = begin + 1; i < end; ++i) size[i] = least(at[i], hint, nullptr, kNoBound);
      continue;
    }
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.add(at[i]);
    // The winner at the first place asks for no more than this anywhere in the box: distances have slope 1.
    const SourceTerm& term = terms_[hint.term];
    const double far = (term.shape.distance(at[begin]) + box.diagonal()) * (1 + 1e-12);
    find_frontier(start(box.low, box.high, term.factor * term.law(far) * (1 + 1e-12), hint.bin), frontier);
    for (std::size_t i = begin + 1; i < end; ++i) size[i] = least(at[i], hint, &frontier, kNoBound);
  }
}

/// By runs: what can be less than the largest of the given sizes anywhere in the box of a run; often nothing.
void SourceTree::lower(std::span<const Point> at, std::span<double> size) const {
  Hint hint;
  Frontier frontier{};
  for (std::size_t begin = 0; begin < at.size(); begin += kChunk) {
    const std::size_t end = std::min(at.size(), begin + kChunk);
    Box box;
    double limit = 0;
    for (std::size_t i = begin; i < end; ++i) {
      box.add(at[i]);
      limit = std::max(limit, size[i]);
    }
    if (hint.term != kNone) {  // the winner of the last run allows no more than this anywhere in the box
      const SourceTerm& term = terms_[hint.term];
      const double far = (term.shape.distance(at[begin]) + box.diagonal()) * (1 + 1e-12);
      limit = std::min(limit, term.factor * term.law(far) * (1 + 1e-12));
    }
    const bool is_run = end - begin >= kLeastChunk;
    if (is_run) find_frontier(start(box.low, box.high, limit, hint.bin), frontier);
    for (std::size_t i = begin; i < end; ++i) size[i] = least(at[i], hint, is_run ? &frontier : nullptr, size[i]);
  }
}

double SourceTree::least_by_scan(Point p) const {
  double best = kInfinity;
  for (const SourceTerm& term : terms_) best = std::min(best, term(p));
  return best;
}

double SourceTree::lower_bound(const Box& box) const {
  Hint hint;
  const double at_centre = least(box.centre(), hint);
  Query query = start(box.low, box.high, at_centre, hint.bin);
  search(query, nullptr, [&](std::uint32_t t, float) {
    const double value = terms_[t].lower_bound(box);
    if (!(value < query.best)) return;
    set_best(query, value);
  });
  return query.best * (1 - 1e-13);
}

std::vector<std::uint32_t> SourceTree::below(const Box& box, double size) const {
  std::vector<std::uint32_t> found;
  if (terms_.empty()) return found;
  Query query = start(box.low, box.high, size, 0);
  const bool is_point = box.low == box.high;
  search(query, nullptr, [&](std::uint32_t t, float) {
    if ((is_point ? terms_[t](box.low) : terms_[t].lower_bound(box)) < size) found.push_back(number_[t]);
  });
  std::sort(found.begin(), found.end());
  return found;
}

bool SourceTree::candidates(const Box& box, std::size_t most, Hint& hint, std::vector<Candidate>& found,
                            std::size_t& visited) const {
  found.clear();
  const Point centre = box.centre();
  least(centre, hint);
  visited += kWidth;
  if (hint.term == kNone) {  // all are infinite at the centre: nothing is known
    if (terms_.size() > most) return false;
    for (std::uint32_t t = 0; t < terms_.size(); ++t) found.push_back({0, t});
    return true;
  }
  const auto ceiling = [&](const SourceTerm& term) {
    return term.factor * term.law((term.shape.distance(centre) + 0.5 * box.diagonal()) * (1 + 1e-12)) * (1 + 1e-12);
  };
  Query query = start(box.low, box.high, ceiling(terms_[hint.term]), hint.bin);
  const double bound = query.best;
  std::size_t left = 4 * most;
  search(query, nullptr, [&](std::uint32_t t, float) {
    if (left == 0) return;
    --left;
    ++visited;
    const double value = terms_[t].lower_bound(box);
    if (value > bound) return;
    float floor = static_cast<float>(value);
    if (static_cast<double>(floor) > value) floor = std::nextafter(floor, 0.0f);
    found.push_back({floor, t});
    if (found.size() > most) left = 0;
    if (left == 0) set_best(query, 0);  // leaves next to nothing to search
  });
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.floor != b.floor ? a.floor < b.floor : a.term < b.term;
  });
  return left > 0;
}

Box SourceTree::box() const {
  Box box;
  for (const SourceTerm& term : terms_) box.add(term.shape.box());
  return box;
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
