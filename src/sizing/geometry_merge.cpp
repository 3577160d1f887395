// SPDX-License-Identifier: Apache-2.0
// Small sources of about one size in one cell of a lattice become a ball round them all; segments from one cell to
// another one become one with a radius that covers them all. Sizes fall into classes, four
// to a factor of two, and the lattice of a class is a power of two wide, so that scaling by powers of two changes
// nothing.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <variant>

#include "sizing/geometry_facets.hpp"

namespace delfront {
namespace {

using Cell = std::array<std::int64_t, 3>;

struct Entry {
  int size_class = 0;
  int num_ends = 1;            ///< 1: small, one cell; 2: a segment, the cells of both ends
  std::array<Cell, 2> cell{};  ///< of a segment the lower one first
  std::uint32_t source = 0;
  bool is_turned = false;  ///< the segment's second end is in the first cell

  friend bool operator<(const Entry& a, const Entry& b) {
    return std::tie(a.size_class, a.num_ends, a.cell, a.source) < std::tie(b.size_class, b.num_ends, b.cell, b.source);
  }
  bool is_like(const Entry& b) const { return size_class == b.size_class && num_ends == b.num_ends && cell == b.cell; }
};

constexpr double kSmall = 0.5;  // of the size: the extent of a source, and the side of a cell

Box box_of(const Simplex& shape) {
  Box box;
  for (int k = 0; k < shape.num_corners; ++k) box.add(shape.corner[std::size_t(k)]);
  return box;
}

/// @return false where cells so small cannot be numbered there
bool find_cell(Point at, double side, Cell& cell) {
  constexpr double kLargest = 1e18;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = std::floor(at[axis] / side);
    if (!(std::abs(place) < kLargest)) return false;
    cell[std::size_t(axis)] = static_cast<std::int64_t>(place);
  }
  return true;
}

/// @return whether the source is small beside its size or a segment, and may be merged
bool classify(const SizeSource& source, Entry& entry) {
  constexpr int kClasses = 4;
  const Simplex* const shape = std::get_if<Simplex>(&source.shape);
  const double h = source.law.delta0;
  if (!shape || source.law.kind != SizeLaw::Kind::step || source.law.r0 != 0 || source.stretching || source.motion)
    return false;
  int exponent = 0;
  const double mantissa = std::frexp(h, &exponent);  // in [0.5, 1)
  entry.size_class = kClasses * exponent + static_cast<int>((mantissa - 0.5) * (2 * kClasses));
  const double side = std::ldexp(kSmall, exponent - 1);
  const Box box = box_of(*shape);
  if (box.diagonal() <= kSmall * h) return find_cell(box.centre(), side, entry.cell[0]);
  if (shape->num_corners != 2) return false;
  entry.num_ends = 2;
  if (!find_cell(shape->corner[0], side, entry.cell[0]) || !find_cell(shape->corner[1], side, entry.cell[1]))
    return false;
  entry.is_turned = entry.cell[1] < entry.cell[0];
  if (entry.is_turned) std::swap(entry.cell[0], entry.cell[1]);
  return true;
}

SizeSource merged_source(const std::vector<SizeSource>& sources, std::span<const Entry> members) {
  SizeSource merged = sources[members[0].source];
  std::array<Box, 2> box;
  for (const Entry& entry : members) {
    const Simplex& shape = std::get<Simplex>(sources[entry.source].shape);
    merged.law.delta0 = std::min(merged.law.delta0, sources[entry.source].law.delta0);
    if (entry.num_ends == 1) {
      box[0].add(box_of(shape));
    } else {
      box[0].add(shape.corner[entry.is_turned ? 1 : 0]);
      box[1].add(shape.corner[entry.is_turned ? 0 : 1]);
    }
  }
  const bool is_ball = members[0].num_ends == 1;
  merged.shape = is_ball ? simplex(box[0].centre()) : simplex(box[0].centre(), box[1].centre());
  // places along a segment are no farther from those along the middle one than its ends; to spare for rounding
  constexpr double kMargin = 1 + 1e-9;
  merged.law.r0 = kMargin * 0.5 * std::max(box[0].diagonal(), box[1].diagonal());
  return merged;
}

}  // namespace

std::size_t merge_close_sources(GeometrySources& found) {
  std::vector<Entry> entries;
  std::vector<bool> is_merged(found.sources.size(), false);
  for (std::uint32_t i = 0; i < found.sources.size(); ++i) {
    Entry entry;
    entry.source = i;
    if (classify(found.sources[i], entry)) entries.push_back(entry);
  }
  std::sort(entries.begin(), entries.end());
  for (std::size_t first = 0, last = 0; first < entries.size(); first = last) {
    while (last < entries.size() && entries[first].is_like(entries[last])) ++last;
    if (last - first < 2) continue;
    const auto members = std::span(entries).subspan(first, last - first);
    SizeSource merged = merged_source(found.sources, members);
    for (const Entry& entry : members) is_merged[entry.source] = true;
    is_merged[members[0].source] = false;  // it stands where its first member stood
    found.sources[members[0].source] = std::move(merged);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < found.sources.size(); ++i)
    if (!is_merged[i]) {
      if (kept != i) found.sources[kept] = std::move(found.sources[i]);
      ++kept;
    }
  const std::size_t gone = found.sources.size() - kept;
  found.sources.resize(kept);
  found.report.num_sources = kept;
  return gone;
}

}  // namespace delfront
