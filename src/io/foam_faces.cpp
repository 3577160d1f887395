// SPDX-License-Identifier: Apache-2.0
// Faces are matched by their three smallest vertices: half-faces are put into buckets by the smallest (counting sort),
// each bucket is sorted by the other two, and equal ones are one face. Stored faces take part as half-faces without a
// cell, so that the same pass finds which face they name.
#include "io/foam_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <tuple>

#include "delfront/errors.hpp"
#include "io/cells.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kNone = FoamFace::kNone;

struct Half {
  std::uint32_t second, third;  // smallest vertices after the first, which is the bucket
  std::uint32_t cell;           // kNone: a stored face
  std::uint32_t local;          // face of the cell, or index of the stored face
};

struct Stored {
  std::uint32_t block, cell;
};

std::array<std::uint32_t, 3> three_smallest(std::span<const VertexId> corners) {
  std::array<std::uint32_t, 3> least = {kNone, kNone, kNone};
  for (VertexId v : corners) {
    std::uint32_t value = v.value;
    for (std::uint32_t& place : least)
      if (value < place) std::swap(value, place);
  }
  return least;
}

/// All half-faces in buckets by smallest vertex.
class Halves {
 public:
  Halves(const Mesh& mesh, const FoamFaces& cells) : mesh_(mesh) {
    for (std::uint32_t b = 0; b < mesh.blocks.size(); ++b)
      if (dimension(mesh.blocks[b].type) == 2)
        for (std::uint32_t cell = 0; cell < mesh.blocks[b].size(); ++cell) stored_.push_back({b, cell});
    begin_.assign(mesh.points.size() + 1, 0);
    visit(cells, [&](const std::array<std::uint32_t, 3>& key, std::uint32_t, std::uint32_t) { ++begin_[key[0] + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    halves_.resize(begin_.back());
    std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
    visit(cells, [&](const std::array<std::uint32_t, 3>& key, std::uint32_t cell, std::uint32_t local) {
      halves_[next[key[0]]++] = {key[1], key[2], cell, local};
    });
  }

  std::span<Half> bucket(std::size_t vertex) {
    return {halves_.data() + begin_[vertex], static_cast<std::size_t>(begin_[vertex + 1] - begin_[vertex])};
  }
  std::span<const VertexId> stored_corners(std::uint32_t i) const {
    return mesh_.blocks[stored_[i].block][stored_[i].cell];
  }
  std::uint32_t stored_group(std::uint32_t i) const {
    const std::int64_t group = group_of(mesh_.blocks[stored_[i].block], stored_[i].cell);
    return group < 0 ? kNone : static_cast<std::uint32_t>(group);
  }

 private:
  template <class Function>
  void visit(const FoamFaces& cells, Function&& take) {
    for (std::size_t b = 0; b < cells.blocks.size(); ++b)
      for (std::size_t i = 0; i < cells.blocks[b]->size(); ++i) {
        std::uint32_t local = 0;
        for_each_face(*cells.blocks[b], i, [&](std::span<const VertexId> corners) {
          take(three_smallest(corners), static_cast<std::uint32_t>(cells.first_cell[b] + i), local++);
        });
      }
    for (std::uint32_t i = 0; i < stored_.size(); ++i) take(three_smallest(stored_corners(i)), kNone, i);
  }

  const Mesh& mesh_;
  std::vector<Stored> stored_;
  std::vector<std::uint64_t> begin_;
  std::vector<Half> halves_;
};

/// True where both run round the same way.
bool same_turn(std::span<const VertexId> a, std::span<const VertexId> b) {
  for (std::size_t i = 0; i < b.size(); ++i)
    if (b[i] == a[0]) return b[(i + 1) % b.size()] == a[1];
  return false;
}

/// One face: `run` holds its one or two cells, then its stored faces.
void take_run(std::span<const Half> run, const Halves& halves, FoamFaces& faces) {
  std::size_t num_cells = 0;
  while (num_cells < run.size() && run[num_cells].cell != kNone) ++num_cells;
  if (num_cells > 2)
    throw InputError(
        fmt::format("a face of cell {} belongs to {} cells; the grid is not conforming", run[0].cell, num_cells));
  if (num_cells == 0) {
    faces.num_loose += run.size();
    return;
  }
  FoamFace face;
  face.owner = run[0].cell;
  face.local = run[0].local;
  if (num_cells < run.size()) {
    face.group = halves.stored_group(run[num_cells].local);
    face.is_flipped = !same_turn(halves.stored_corners(run[num_cells].local), faces.corners(face));
  }
  if (num_cells == 1) {
    faces.boundary.push_back(face);
    return;
  }
  face.neighbour = run[1].cell;
  faces.internal.push_back(face);
}

/// Inner groups with the same region on both sides are baffles: the face is doubled and leaves the inside.
void double_baffles(const Mesh& mesh, const std::vector<std::uint32_t>& other_local, FoamFaces& faces) {
  std::vector<bool> has_inner(mesh.groups.size(), false), separates(mesh.groups.size(), false);
  for (const FoamFace& face : faces.internal) {
    if (face.group == kNone) continue;
    has_inner[face.group] = true;
    if (faces.region_of(face.owner) != faces.region_of(face.neighbour)) separates[face.group] = true;
  }
  for (std::size_t group = 0; group < mesh.groups.size(); ++group)
    faces.is_baffle[group] = has_inner[group] && !separates[group] && mesh.groups[GroupId(group)].kind != "interface";
  std::vector<FoamFace> kept;
  for (std::size_t i = 0; i < faces.internal.size(); ++i) {
    const FoamFace& face = faces.internal[i];
    if (face.group == kNone || !faces.is_baffle[face.group]) {
      kept.push_back(face);
      continue;
    }
    FoamFace owner_side = face, other_side = face;
    owner_side.neighbour = kNone;
    owner_side.is_slave = face.is_flipped;
    other_side.owner = face.neighbour;
    other_side.neighbour = kNone;
    other_side.local = other_local[i];
    other_side.is_slave = !face.is_flipped;
    faces.boundary.push_back(owner_side);
    faces.boundary.push_back(other_side);
  }
  faces.internal = std::move(kept);
}

}  // namespace

std::int64_t FoamFaces::region_of(std::size_t cell) const {
  const auto block =
      static_cast<std::size_t>(std::upper_bound(first_cell.begin(), first_cell.end(), cell) - first_cell.begin() - 1);
  return group_of(*blocks[block], cell - first_cell[block]);
}

std::vector<VertexId> FoamFaces::corners(const FoamFace& face) const {
  const auto block = static_cast<std::size_t>(
      std::upper_bound(first_cell.begin(), first_cell.end(), std::size_t{face.owner}) - first_cell.begin() - 1);
  std::vector<VertexId> found;
  std::uint32_t local = 0;
  for_each_face(*blocks[block], face.owner - first_cell[block], [&](std::span<const VertexId> corners) {
    if (local++ == face.local) found.assign(corners.begin(), corners.end());
  });
  return found;
}

FoamFaces build_foam_faces(const Mesh& mesh, Context& context) {
  FoamFaces faces;
  faces.first_cell.push_back(0);
  faces.is_baffle.assign(mesh.groups.size(), false);
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != 3 || block.size() == 0) continue;
    faces.blocks.push_back(&block);
    faces.first_cell.push_back(faces.first_cell.back() + block.size());
  }
  Halves halves(mesh, faces);
  std::vector<std::uint32_t> other_local;
  for (std::size_t vertex = 0; vertex < mesh.points.size(); ++vertex) {
    if (vertex % 65536 == 0) context.check_limits();
    const std::span<Half> bucket = halves.bucket(vertex);
    std::sort(bucket.begin(), bucket.end(), [](const Half& a, const Half& b) {
      return std::tie(a.second, a.third, a.cell, a.local) < std::tie(b.second, b.third, b.cell, b.local);
    });
    for (std::size_t begin = 0, end = 0; begin < bucket.size(); begin = end) {
      while (end < bucket.size() && bucket[end].second == bucket[begin].second &&
             bucket[end].third == bucket[begin].third)
        ++end;
      const std::size_t before = faces.internal.size();
      take_run(bucket.subspan(begin, end - begin), halves, faces);
      if (faces.internal.size() > before) other_local.push_back(bucket[begin + 1].local);
    }
  }
  double_baffles(mesh, other_local, faces);
  std::sort(faces.internal.begin(), faces.internal.end(), [](const FoamFace& a, const FoamFace& b) {
    return std::tie(a.owner, a.neighbour) < std::tie(b.owner, b.neighbour);
  });
  return faces;
}

}  // namespace delfront
