// SPDX-License-Identifier: Apache-2.0
#include "refine/mid_points.hpp"

#include <fmt/format.h>

#include <numeric>
#include <utility>

#include "delfront/errors.hpp"
#include "mesh/facet_table.hpp"

namespace delfront {

namespace {

/// The rows of one bin of vertices: how many keys each has, and the keys, row by row.
template <class Key>
struct BinRows {
  std::vector<std::uint32_t> sizes;
  std::vector<Key> keys;
};

/// @param items  (row, key) of rows that begin at first_row, each once, in any order
template <class Key>
BinRows<Key> sort_rows(std::span<const std::pair<std::uint32_t, Key>> items, std::size_t first_row,
                       std::size_t num_rows) {
  BinRows<Key> rows;
  rows.sizes.assign(num_rows, 0);
  for (const auto& [row, key] : items) ++rows.sizes[row - first_row];
  std::vector<std::uint32_t> next(num_rows + 1, 0);
  std::partial_sum(rows.sizes.begin(), rows.sizes.end(), next.begin() + 1);
  rows.keys.resize(items.size());
  for (const auto& [row, key] : items) rows.keys[next[row - first_row]++] = key;
  std::size_t first = 0;
  for (const std::uint32_t size : rows.sizes) {
    std::sort(rows.keys.begin() + static_cast<std::ptrdiff_t>(first),
              rows.keys.begin() + static_cast<std::ptrdiff_t>(first + size));
    first += size;
  }
  return rows;
}

/// Number the keys of all bins through.
template <class Key>
void join_bins(std::vector<BinRows<Key>>& bins, std::size_t num_rows, int threads, RowTable<Key>& table) {
  std::vector<std::size_t> first_row(bins.size() + 1, 0), first_key(bins.size() + 1, 0);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    first_row[i + 1] = first_row[i] + bins[i].sizes.size();
    first_key[i + 1] = first_key[i] + bins[i].keys.size();
  }
  if (first_key.back() + num_rows >= VertexId::kNone)
    throw LimitError(
        fmt::format("stopped: the refined grid would have more than {} points, and this version holds no "
                    "more; refine fewer times (--levels)",
                    VertexId::kNone - 1));
  table.start(num_rows, first_key.back());
  parallel_for(threads, bins.size(), [&](std::size_t i) {
    std::uint32_t* offset = table.offsets() + first_row[i];
    auto sum = static_cast<std::uint32_t>(first_key[i]);
    for (const std::uint32_t size : bins[i].sizes) *++offset = sum += size;
    std::copy(bins[i].keys.begin(), bins[i].keys.end(), table.keys() + first_key[i]);
    bins[i] = {};
  });
}

/// Rows of the bin: the last bin may be shorter than the others.
std::size_t rows_of_bin(const BinWidth& width, std::size_t bin, std::size_t num_rows) {
  return std::min(width.width(), num_rows - width.begin_of(bin));
}

constexpr std::size_t kBinsATask = 4;  ///< that share the memory for their facets

/// Lines alone: the sweep knows cells that have sides.
void number_lines(const CellBlock& lines, std::size_t num_points, RowTable<std::uint32_t>& edges) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t i = 0; i < lines.size(); ++i) pairs.push_back(std::minmax({lines[i][0].value, lines[i][1].value}));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<BinRows<std::uint32_t>> bins;
  bins.push_back(sort_rows(std::span<const std::pair<std::uint32_t, std::uint32_t>>(pairs), 0, num_points));
  join_bins(bins, num_points, 1, edges);
}

}  // namespace

MidPoints::MidPoints(const Mesh& mesh, int threads) : mesh_(mesh), num_old_(mesh.points.size()) {
  const int top = mesh.top_dimension();
  for (const CellBlock& block : mesh.blocks)
    if (dimension(block.type) == 3 && block.type != CellType::tetrahedron && block.size() > 0) has_quad_faces_ = true;
  number_edges(threads);
  first_quad_ = num_old_ + edges_.size();
  if (has_quad_faces_) number_quads(threads);
  first_centre_ = first_quad_ + quads_.size();
  centred_ = mesh.find_block(top == 3 ? CellType::hexahedron : CellType::quad);
  if (top >= 2 && centred_) num_centres_ = centred_->size();
  if (num_points() >= VertexId::kNone)
    throw LimitError(
        fmt::format("stopped: the refined grid would have {} points, and this version holds {} at most; "
                    "refine fewer times (--levels)",
                    num_points(), VertexId::kNone - 1));
}

void MidPoints::number_edges(int threads) {
  const int top = mesh_.top_dimension();
  if (top == 1) return number_lines(*mesh_.find_block(CellType::line), num_old_, edges_);
  const CellRange cells(mesh_, top), none(mesh_, -1);
  const FacetSweep sweep(mesh_, cells, none, threads);
  const BinWidth width(num_old_);
  std::vector<BinRows<std::uint32_t>> bins(width.num_bins);
  parallel_ranges(threads, bins.size(), kBinsATask, [&](std::size_t first, std::size_t last) {
    FacetSweep::Scratch scratch;
    for (std::size_t bin = first; bin < last; ++bin)
      bins[bin] = sort_rows(sweep.edges(bin, scratch), width.begin_of(bin), rows_of_bin(width, bin, num_old_));
  });
  join_bins(bins, num_old_, threads, edges_);
}

void MidPoints::number_quads(int threads) {
  const CellRange cells(mesh_, 3), none(mesh_, -1);
  const FacetSweep sweep(mesh_, cells, none, threads);
  const BinWidth width(num_old_);
  std::vector<BinRows<QuadKey>> bins(width.num_bins);
  parallel_ranges(threads, bins.size(), kBinsATask, [&](std::size_t first, std::size_t last) {
    FacetSweep::Scratch scratch;
    std::vector<std::pair<std::uint32_t, QuadKey>> items;
    for (std::size_t bin = first; bin < last; ++bin) {
      items.clear();
      sweep.for_each_facet(bin, scratch, [&](std::span<const HalfFacet> sides, std::span<const HalfFacet>) {
        const HalfFacet& f = sides[0];
        if (f.num_vertices() == 4) items.push_back({f.a, {f.b, f.c, f.d}});
      });
      bins[bin] = sort_rows(std::span<const std::pair<std::uint32_t, QuadKey>>(items), width.begin_of(bin),
                            rows_of_bin(width, bin, num_old_));
    }
  });
  join_bins(bins, num_old_, threads, quads_);
}

std::uint32_t MidPoints::of_quad(const std::array<std::uint32_t, 4>& corners) const {
  const auto low = static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
  const auto [next, previous] = std::minmax(corners[(low + 1) % 4], corners[(low + 3) % 4]);
  const std::uint32_t quad = quads_.find(corners[low], {next, corners[(low + 2) % 4], previous});
  return quad == VertexId::kNone ? quad : static_cast<std::uint32_t>(first_quad_ + quad);
}

}  // namespace delfront
