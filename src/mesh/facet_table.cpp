// SPDX-License-Identifier: Apache-2.0
#include "mesh/facet_table.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <utility>

namespace delfront {

CellRange::CellRange(const Mesh& mesh, int wanted) {
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != wanted || block.size() == 0) continue;
    parts_.push_back({&block, size_});
    size_ += block.size();
  }
}

const CellRange::Part& CellRange::part_of(std::size_t cell) const {
  std::size_t i = parts_.size() - 1;
  while (parts_[i].first > cell) --i;
  return parts_[i];
}

std::span<const VertexId> CellRange::operator[](std::size_t cell) const {
  const Part& part = part_of(cell);
  return (*part.block)[cell - part.first];
}

namespace {

/// Fills a to d and is_forward from the vertices in their order around the facet.
void set_vertices(HalfFacet& half, const std::uint32_t* v, int n) {
  if (n == 3) {  // nearly every facet of a large grid: without the divisions
    const bool first = v[0] < v[1] && v[0] < v[2], second = !first && v[1] < v[2];
    const std::uint32_t next = first ? v[1] : second ? v[2] : v[0], previous = first ? v[2] : second ? v[0] : v[1];
    half.a = first ? v[0] : second ? v[1] : v[2];
    half.b = std::min(next, previous);
    half.c = std::max(next, previous);
    half.d = VertexId::kNone;
    half.is_forward = next < previous;
    return;
  }
  int low = 0;
  for (int i = 1; i < n; ++i)
    if (v[i] < v[low]) low = i;
  const std::uint32_t next = v[(low + 1) % n], previous = v[(low + n - 1) % n];
  half.a = v[low];
  half.b = std::min(next, previous);
  half.c = n == 2 ? VertexId::kNone : v[(low + 2) % n];
  half.d = n == 4 ? std::max(next, previous) : VertexId::kNone;
  half.is_forward = n == 2 ? low == 0 : next < previous;
}

/// Calls visit(shape, vertices, cell) for the cells of a list, which ascends.
template <class Visit>
void for_each_listed(const CellRange& cells, std::span<const std::uint32_t> list, Visit&& visit) {
  constexpr std::size_t kAhead = 16;  // the list jumps through memory
  std::size_t i = 0;
  for (const CellRange::Part& part : cells.parts()) {
    const CellShape& shape = shape_of(part.block->type);
    const auto n = static_cast<std::size_t>(num_vertices(part.block->type));
    const VertexId* vertices = part.block->vertices.data();
    const std::size_t end = part.first + part.block->size();
    for (; i < list.size() && list[i] < end; ++i) {
      const std::size_t soon = std::min(i + kAhead, list.size() - 1);
      if (list[soon] < end) __builtin_prefetch(vertices + (list[soon] - part.first) * n);
      visit(shape, vertices + (list[i] - part.first) * n, list[i]);
    }
  }
}

/// Calls visit(vertices, n, cell) for cells first to last - 1 that have sides or, where stored, vertices enough.
template <class Visit>
void for_each_cell(const CellRange& cells, std::size_t first, std::size_t last, Visit&& visit) {
  for (const CellRange::Part& part : cells.parts()) {
    const auto n = static_cast<std::size_t>(num_vertices(part.block->type));
    if (n < 2) continue;
    const VertexId* vertices = part.block->vertices.data();
    const std::size_t end = std::min(last, part.first + part.block->size());
    for (std::size_t cell = std::max(first, part.first); cell < end; ++cell)
      visit(vertices + (cell - part.first) * n, n, cell);
  }
}

/// Calls visit(bin) once for each bin that holds the smaller end of some edge of the cell: not so for the largest
/// vertex.
template <class Visit>
void for_each_bin(const BinWidth& width, const VertexId* v, std::size_t n, Visit&& visit) {
  std::size_t last = 0;
  for (std::size_t i = 1; i < n; ++i)
    if (v[last].value < v[i].value) last = i;
  std::size_t seen[8];
  std::size_t num_seen = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t bin = width.bin_of(v[i].value);
    if (i == last || std::find(seen, seen + num_seen, bin) != seen + num_seen) continue;
    seen[num_seen++] = bin;
    visit(bin);
  }
}

/// Empty slots of the hash tables; also the end of a chain.
constexpr std::uint32_t kNone = VertexId::kNone;

std::size_t hash_of(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  const std::uint64_t h = (a * 0x9e3779b97f4a7c15ull ^ b) * 0xbf58476d1ce4e5b9ull;
  return static_cast<std::size_t>(((h ^ h >> 29) + c) * 0x94d049bb133111ebull >> 32);
}

/// Makes an empty table with room for `count` entries. @return its mask
std::size_t clear_table(std::vector<std::uint32_t>& table, std::size_t count) {
  table.assign(std::bit_ceil(2 * count + 1), kNone);
  return table.size() - 1;
}

/// Neighbours of a vertex with larger numbers that are kept in a row; the few beyond are sorted at the end.
constexpr std::size_t kRow = 16;

bool is_in_row(const std::uint32_t* row, std::uint32_t vertex) {
  typedef std::uint32_t Half __attribute__((vector_size(32)));
  typedef std::uint64_t Quarters __attribute__((vector_size(32)));
  static_assert(2 * sizeof(Half) == kRow * sizeof(std::uint32_t));
  Half first, second;
  std::memcpy(&first, row, sizeof first);
  std::memcpy(&second, row + kRow / 2, sizeof second);
  const auto found = reinterpret_cast<Quarters>((first == vertex) | (second == vertex));
  return (found[0] | found[1] | found[2] | found[3]) != 0;
}

}  // namespace

FacetSweep::FacetSweep(const Mesh& mesh, const CellRange& cells, const CellRange& stored, int threads)
    : cells_(cells), stored_(stored), dimension_(mesh.top_dimension()), width_(mesh.points.size()) {
  cells_of_bin_ = sort_into_bins(cells.size(), width_.num_bins, threads, [&](auto first, auto last, auto&& visit) {
    for_each_cell(cells, first, last, [&](const VertexId* v, std::size_t n, std::size_t cell) {
      for_each_bin(width_, v, n, [&](std::size_t bin) { visit(cell, bin); });
    });
  });
  stored_of_bin_ = sort_into_bins(stored.size(), width_.num_bins, threads, [&](auto first, auto last, auto&& visit) {
    for_each_cell(stored, first, last, [&](const VertexId* v, std::size_t n, std::size_t facet) {
      visit(facet, width_.bin_of(std::min_element(v, v + n)->value));
    });
  });
}

/// A tetrahedron's vertices in ascending order, and where they stood.
struct SortedTet {
  std::uint32_t v[4];
  std::uint8_t local[4];
  bool is_odd;  ///< whether that took an odd number of exchanges

  explicit SortedTet(const VertexId* vertices) {
    std::uint64_t key[4];
    for (unsigned i = 0; i < 4; ++i) key[i] = std::uint64_t{vertices[i].value} << 2 | i;
    is_odd = false;
    constexpr int kExchanges[5][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
    for (const auto [a, b] : kExchanges) {
      const std::uint64_t low = std::min(key[a], key[b]), high = std::max(key[a], key[b]);
      is_odd ^= key[a] != low;
      key[a] = low;
      key[b] = high;
    }
    for (int i = 0; i < 4; ++i) {
      v[i] = static_cast<std::uint32_t>(key[i] >> 2);
      local[i] = key[i] & 3;
    }
  }
  /// The facet opposite v[k]. Facet f of a tetrahedron, preceded by f, is an even permutation of 0, 1, 2, 3.
  HalfFacet facet(int k, std::uint32_t cell) const {
    const int a = k == 0, b = k <= 1 ? 2 : 1, c = k <= 2 ? 3 : 2;
    return {v[a], v[b], v[c], VertexId::kNone, cell, local[k], is_odd == (k % 2 == 1), false};
  }
};

void FacetSweep::collect_sides(std::size_t bin, std::vector<HalfFacet>& halves) const {
  for_each_listed(cells_, cells_of_bin_[bin],
                  [&](const CellShape& shape, const VertexId* vertices, std::uint32_t cell) {
                    if (shape.num_facets == 4 && dimension_ == 3) {
                      const SortedTet tet(vertices);
                      if (width_.bin_of(tet.v[0]) == bin)
                        for (int k = 3; k > 0; --k) halves.push_back(tet.facet(k, cell));
                      if (width_.bin_of(tet.v[1]) == bin) halves.push_back(tet.facet(0, cell));
                      return;
                    }
                    for (int f = 0; f < shape.num_facets; ++f) {
                      const LocalFacet& facet = shape.facets[f];
                      std::uint32_t v[4], smallest = kNone;
                      for (int i = 0; i < facet.num_vertices; ++i) {
                        v[i] = vertices[facet.vertices[i]].value;
                        smallest = std::min(smallest, v[i]);
                      }
                      if (width_.bin_of(smallest) != bin) continue;
                      HalfFacet half{};
                      set_vertices(half, v, facet.num_vertices);
                      half.cell = cell;
                      half.local_facet = static_cast<std::uint8_t>(f);
                      halves.push_back(half);
                    }
                  });
}

void FacetSweep::collect_stored(std::size_t bin, std::vector<HalfFacet>& halves) const {
  for (const std::uint32_t facet : stored_of_bin_[bin]) {
    const auto vertices = stored_[facet];
    std::uint32_t v[4];
    for (std::size_t i = 0; i < vertices.size(); ++i) v[i] = vertices[i].value;
    HalfFacet half{};
    set_vertices(half, v, static_cast<int>(vertices.size()));
    half.cell = facet;
    half.is_stored = true;
    halves.push_back(half);
  }
}

/// A hash table of the facets seen so far; nearly every facet has two sides, and a chain that long.
void FacetSweep::match_halves(std::size_t bin, Scratch& scratch) const {
  std::vector<HalfFacet>& halves = scratch.halves;
  halves.clear();
  collect_sides(bin, halves);
  collect_stored(bin, halves);
  scratch.next.assign(halves.size(), kNone);
  scratch.firsts.clear();
  const std::size_t mask = clear_table(scratch.table, halves.size() / 2);
  for (std::uint32_t i = 0; i < halves.size(); ++i) {
    const HalfFacet& half = halves[i];
    std::size_t at = hash_of(half.a, half.b, half.c) & mask;
    while (scratch.table[at] != kNone && !halves[scratch.table[at]].is_same_facet(half)) at = (at + 1) & mask;
    std::uint32_t last = scratch.table[at];
    if (last == kNone) {
      scratch.table[at] = i;
      scratch.firsts.push_back(i);
      continue;
    }
    while (scratch.next[last] != kNone) last = scratch.next[last];
    scratch.next[last] = i;
  }
}

template <class Visit>
void FacetSweep::for_each_half_edge(std::size_t bin, Visit&& visit) const {
  for_each_listed(cells_, cells_of_bin_[bin], [&](const CellShape& shape, const VertexId* vertices, std::uint32_t) {
    if (shape.num_edges == 6) {
      const SortedTet tet(vertices);
      for (int i = 0; i < 3; ++i)
        if (width_.bin_of(tet.v[i]) == bin)
          for (int j = i + 1; j < 4; ++j) visit(tet.v[i], tet.v[j]);
      return;
    }
    for (int e = 0; e < shape.num_edges; ++e) {
      const auto [low, high] = std::minmax({vertices[shape.edges[e][0]].value, vertices[shape.edges[e][1]].value});
      if (width_.bin_of(low) == bin) visit(low, high);
    }
  });
}

std::span<const FacetSweep::Edge> FacetSweep::edges(std::size_t bin, Scratch& scratch) const {
  const auto first_vertex = static_cast<std::uint32_t>(width_.begin_of(bin));
  scratch.rows.assign(width_.width() * kRow, kNone);
  scratch.row_sizes.assign(width_.width(), 0);
  std::vector<Edge>& edges = scratch.edges;
  edges.clear();
  for_each_half_edge(bin, [&](std::uint32_t low, std::uint32_t high) {
    std::uint32_t* const row = &scratch.rows[(low - first_vertex) * kRow];
    if (is_in_row(row, high)) return;
    std::uint8_t& size = scratch.row_sizes[low - first_vertex];
    if (size < kRow)
      row[size++] = high;
    else
      edges.emplace_back(low, high);
  });
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (std::size_t i = 0; i < width_.width(); ++i)
    for (std::size_t k = 0; k < scratch.row_sizes[i]; ++k)
      edges.emplace_back(first_vertex + static_cast<std::uint32_t>(i), scratch.rows[i * kRow + k]);
  return edges;
}

}  // namespace delfront
