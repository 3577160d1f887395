// SPDX-License-Identifier: Apache-2.0
#include "mesh/facet_table.hpp"

#include <algorithm>
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

template <class Visit>
void for_each_side(const CellRange& cells, Visit&& visit) {
  for (const CellRange::Part& part : cells.parts()) {
    const CellShape& shape = shape_of(part.block->type);
    const auto n = static_cast<std::size_t>(num_vertices(part.block->type));
    const VertexId* vertices = part.block->vertices.data();
    const std::size_t end = shape.num_facets > 0 ? part.block->size() : 0;
    for (std::size_t cell = 0; cell < end; ++cell)
      for (int f = 0; f < shape.num_facets; ++f) {
        const LocalFacet& facet = shape.facets[f];
        std::uint32_t v[4];
        for (int i = 0; i < facet.num_vertices; ++i) v[i] = vertices[cell * n + facet.vertices[i]].value;
        HalfFacet half{};
        set_vertices(half, v, facet.num_vertices);
        half.cell = static_cast<std::uint32_t>(part.first + cell);
        half.local_facet = static_cast<std::uint8_t>(f);
        visit(half);
      }
  }
}

template <class Visit>
void for_each_stored(const CellRange& stored, Visit&& visit) {
  for (const CellRange::Part& part : stored.parts()) {
    const int n = num_vertices(part.block->type);
    if (n < 2) continue;
    for (std::size_t facet = 0; facet < part.block->size(); ++facet) {
      const auto vertices = (*part.block)[facet];
      std::uint32_t v[4];
      for (int i = 0; i < n; ++i) v[i] = vertices[i].value;
      HalfFacet half{};
      set_vertices(half, v, n);
      half.cell = static_cast<std::uint32_t>(part.first + facet);
      half.is_stored = true;
      visit(half);
    }
  }
}

bool comes_before(const HalfFacet& p, const HalfFacet& q) {
  if (p.b != q.b) return p.b < q.b;
  if (p.c != q.c) return p.c < q.c;
  if (p.d != q.d) return p.d < q.d;
  if (p.is_stored != q.is_stored) return q.is_stored;
  if (p.cell != q.cell) return p.cell < q.cell;
  return p.local_facet < q.local_facet;
}

/// By comes_before. A bucket is short, and its sides stand in the order of the cells already.
void sort_bucket(std::span<HalfFacet> bucket) {
  constexpr std::size_t kShort = 64;
  if (bucket.size() > kShort) return std::sort(bucket.begin(), bucket.end(), comes_before);
  for (std::size_t i = 1; i < bucket.size(); ++i) {
    const HalfFacet half = bucket[i];
    std::size_t at = i;
    for (; at > 0 && comes_before(half, bucket[at - 1]); --at) bucket[at] = bucket[at - 1];
    bucket[at] = half;
  }
}

void sums_to_offsets(std::vector<std::size_t>& counts) {
  std::size_t sum = 0;
  for (std::size_t& count : counts) sum += std::exchange(count, sum);
}

}  // namespace

std::vector<HalfFacet> build_facet_table(const Mesh& mesh, const CellRange& cells, const CellRange& stored) {
  const auto for_each = [&](auto&& visit) {
    for_each_side(cells, visit);
    for_each_stored(stored, visit);
  };
  std::vector<std::size_t> next(mesh.points.size() + 1, 0);
  for_each([&](const HalfFacet& half) { ++next[half.a]; });
  sums_to_offsets(next);
  std::vector<HalfFacet> table(next.back());
  for_each([&](const HalfFacet& half) { table[next[half.a]++] = half; });
  // next[v] is now the end of the bucket of v
  for (std::size_t v = 0, first = 0; v < mesh.points.size(); first = next[v++])
    sort_bucket(std::span(table).subspan(first, next[v] - first));
  return table;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_edges(const Mesh& mesh, const CellRange& cells) {
  const auto for_each = [&](auto&& visit) {
    for (const CellRange::Part& part : cells.parts()) {
      const CellShape& shape = shape_of(part.block->type);
      const std::size_t end = shape.num_edges > 0 ? part.block->size() : 0;
      for (std::size_t cell = 0; cell < end; ++cell) {
        const auto v = (*part.block)[cell];
        for (int e = 0; e < shape.num_edges; ++e)
          visit(std::minmax(v[shape.edges[e][0]].value, v[shape.edges[e][1]].value));
      }
    }
  };
  std::vector<std::size_t> next(mesh.points.size() + 1, 0);
  for_each([&](std::pair<std::uint32_t, std::uint32_t> edge) { ++next[edge.first]; });
  sums_to_offsets(next);
  std::vector<std::uint32_t> other(next.back());
  for_each([&](std::pair<std::uint32_t, std::uint32_t> edge) { other[next[edge.first]++] = edge.second; });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(other.size() / 4);
  std::size_t first = 0;
  std::vector<std::uint32_t> seen_from(mesh.points.size(), VertexId::kNone);
  for (std::uint32_t v = 0; v < mesh.points.size(); ++v) {
    const std::size_t start = edges.size();
    for (; first < next[v]; ++first)
      if (std::exchange(seen_from[other[first]], v) != v) edges.emplace_back(v, other[first]);
    std::sort(edges.begin() + static_cast<std::ptrdiff_t>(start), edges.end());
  }
  return edges;
}

}  // namespace delfront
