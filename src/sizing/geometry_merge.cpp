// SPDX-License-Identifier: Apache-2.0
// Small sources of about one size in one cell of a lattice become a ball round them all. Sizes fall into classes, four
// to a factor of two, and the lattice of a class is a power of two wide, so that scaling by powers of two changes
// nothing.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <variant>

#include "sizing/geometry_facets.hpp"

namespace delfront {
namespace {

struct Entry {
  int size_class = 0;
  std::array<std::int64_t, 3> cell{};
  std::uint32_t source = 0;
  friend auto operator<=>(const Entry&, const Entry&) = default;
};

Box box_of(const Simplex& shape) {
  Box box;
  for (int k = 0; k < shape.num_corners; ++k) box.add(shape.corner[std::size_t(k)]);
  return box;
}

/// @return whether the source is small beside its size, and may be merged
bool classify(const SizeSource& source, Entry& entry) {
  constexpr double kSmall = 0.5;  // of the size: the extent of a source, and the side of a cell
  constexpr int kClasses = 4;
  const Simplex* const shape = std::get_if<Simplex>(&source.shape);
  const double h = source.law.delta0;
  if (!shape || source.law.kind != SizeLaw::Kind::step || source.law.r0 != 0 || source.stretching || source.motion)
    return false;
  const Box box = box_of(*shape);
  if (box.diagonal() > kSmall * h) return false;
  int exponent = 0;
  const double mantissa = std::frexp(h, &exponent);  // in [0.5, 1)
  entry.size_class = kClasses * exponent + static_cast<int>((mantissa - 0.5) * (2 * kClasses));
  const double side = std::ldexp(kSmall, exponent - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const double place = std::floor(box.centre()[axis] / side);
    constexpr double kLargest = 1e18;  // beyond it cells cannot be numbered
    if (!(std::abs(place) < kLargest)) return false;
    entry.cell[std::size_t(axis)] = static_cast<std::int64_t>(place);
  }
  return true;
}

SizeSource ball_round(const std::vector<SizeSource>& sources, std::span<const Entry> members) {
  SizeSource merged = sources[members[0].source];
  Box box;
  for (const Entry& entry : members) {
    const SizeSource& source = sources[entry.source];
    box.add(box_of(std::get<Simplex>(source.shape)));
    merged.law.delta0 = std::min(merged.law.delta0, source.law.delta0);
  }
  merged.shape = simplex(box.centre());
  // a little more than half of the diagonal, for the rounding of distances
  constexpr double kMargin = 1 + 1e-9;
  merged.law.r0 = kMargin * 0.5 * box.diagonal();
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
  const auto is_one_cell = [](const Entry& a, const Entry& b) {
    return a.size_class == b.size_class && a.cell == b.cell;
  };
  for (std::size_t first = 0, last = 0; first < entries.size(); first = last) {
    while (last < entries.size() && is_one_cell(entries[first], entries[last])) ++last;
    if (last - first < 2) continue;
    const auto members = std::span(entries).subspan(first, last - first);
    SizeSource merged = ball_round(found.sources, members);
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
