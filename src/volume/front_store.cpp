// SPDX-License-Identifier: Apache-2.0
#include "volume/front_store.hpp"

#include <algorithm>

#include "delfront/errors.hpp"

namespace delfront {

FrontStore::FrontStore(TetComplex& complex, const SizeField* field)
    : c_(complex), obstacles_(complex), sizes_(complex, field) {
  first_.assign(c_.num_vertices(), kNoIndex);
  std::vector<TetIndex> emptied;
  std::vector<FaceRef> sides;
  for (TetIndex t = 0; t < c_.num_slots(); ++t) {
    if (c_.is_dead(t) || c_.is_ghost(t)) continue;
    emptied.push_back(t);
    for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref)
      if (c_.is_constrained(ref)) sides.push_back(ref);
  }
  std::vector<FaceRef> behind(sides.size());
  std::vector<TetIndex> made_by(sides.size());
  const auto new_wall = [&](const std::array<VertexIndex, 3>& n) {
    const TetIndex t = c_.new_tet();
    c_.set_nodes(t, n[0], n[1], n[2], kGhost);
    c_.region[t] = TetComplex::kOutside;
    return t;
  };
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const FaceRef other = c_.neigh[sides[i]];
    behind[i] = other;
    if (c_.is_ghost(other >> 2)) continue;
    const auto n = c_.face_nodes(sides[i]);
    const TetIndex own = new_wall(n);
    behind[i] = 4 * own + 3;
    made_by[i] = own;
    if (other < sides[i]) {  // sides are in order, so the other one was met before
      const auto at = std::lower_bound(sides.begin(), sides.end(), other) - sides.begin();
      walls_.push_back({made_by[static_cast<std::size_t>(at)], own});
    }
  }
  for (std::size_t i = 0; i < sides.size(); ++i)
    add_face(c_.face_nodes(sides[i]), behind[i], c_.region[sides[i] >> 2], true, new_slot());
  for (const TetIndex t : emptied) c_.kill_tet(t);
  std::fill(c_.vertex_tet.begin(), c_.vertex_tet.end(), kNoIndex);
}

std::uint32_t FrontStore::new_slot() {
  if (free_.empty()) {
    faces_.push_back({});
    return static_cast<std::uint32_t>(faces_.size() - 1);
  }
  const std::uint32_t f = free_.back();
  free_.pop_back();
  return f;
}

std::uint32_t FrontStore::add_face(const std::array<VertexIndex, 3>& n, FaceRef behind, std::uint32_t region,
                                   bool is_boundary, std::uint32_t slot) {
  FrontFace& f = faces_[slot];
  double size = 0;
  for (unsigned i = 0; i < 3; ++i) {
    size += c_.vertex[n[i]].h;
    f.node[i] = n[i];
    f.next[i] = first_[n[i]];
    first_[n[i]] = 4 * slot + i;
  }
  f.behind = behind;
  f.region = region;
  f.size = static_cast<float>(size / 3);
  f.tries = 0;
  f.is_boundary = is_boundary;
  f.is_alive = true;
  f.stamp = 0;
  return slot;
}

void FrontStore::remove_face(std::uint32_t f) {
  for (unsigned i = 0; i < 3; ++i) {
    std::uint32_t* at = &first_[faces_[f].node[i]];
    while (*at != 4 * f + i) at = &faces_[*at >> 2].next[*at & 3];
    *at = faces_[f].next[i];
  }
  faces_[f].is_alive = false;
}

std::uint32_t FrontStore::find(const std::array<VertexIndex, 3>& n) const {
  for (std::uint32_t e = first_[n[0]]; e != kNoIndex; e = next_at(e)) {
    const FrontFace& f = faces_[e >> 2];
    const unsigned i = e & 3;
    if (f.node[i == 2 ? 0 : i + 1] == n[1] && f.node[i == 0 ? 2 : i - 1] == n[2]) return e >> 2;
  }
  return kNoIndex;
}

FrontStock FrontStore::take(std::size_t tets) {
  FrontStock stock{c_.take_slots(tets), {}, {}, c_.take_vertices(tets)};
  const std::size_t faces = 3 * tets, reused = std::min(faces, free_.size());
  std::vector<std::uint32_t> used(free_.end() - static_cast<std::ptrdiff_t>(reused), free_.end());
  free_.resize(free_.size() - reused);
  const std::size_t first = faces_.size(), total = first + faces - reused;
  faces_.resize(total);
  for (std::size_t f = first; f < total; ++f) faces_[f].is_alive = false;
  stock.faces = {std::move(used), static_cast<TetIndex>(first), static_cast<TetIndex>(total)};
  add_vertex();
  return stock;
}

void FrontStore::give(FrontStock& stock) {
  c_.give_slots(stock.tets);
  c_.give_vertices(stock.vertices);
  while (stock.faces.size() > 0) free_.push_back(stock.faces.take());
  free_.insert(free_.end(), stock.freed.begin(), stock.freed.end());
}

TetIndex FrontStore::add_tet(std::uint32_t f, VertexIndex d, FrontStock& stock, std::vector<std::uint32_t>& made) {
  const TetIndex t = stock.tets.take();
  const FrontFace base = faces_[f];
  c_.set_nodes(t, base.node[0], base.node[1], base.node[2], d);
  c_.flag[t] = 0;
  c_.region[t] = base.region;
  obstacles_.count_tet({base.node[0], base.node[1], base.node[2], d}, true);
  const auto close = [&](std::uint32_t g, FaceRef ref) {
    c_.bond(ref, faces_[g].behind);
    c_.set_constrained(ref, faces_[g].is_boundary);
    remove_face(g);
    stock.freed.push_back(g);
  };
  close(f, 4 * t + 3);
  for (FaceRef ref = 4 * t; ref < 4 * t + 3; ++ref) {
    const auto n = c_.face_nodes(ref);
    const std::uint32_t g = find(n);
    if (g != kNoIndex) {
      close(g, ref);
    } else {
      c_.neigh[ref] = kNoIndex;
      made.push_back(add_face({n[0], n[2], n[1]}, ref, base.region, false, stock.faces.take()));
    }
  }
  return t;
}

void FrontStore::add_island(const std::array<VertexIndex, 4>& n, std::uint32_t region,
                            std::vector<std::uint32_t>& made) {
  const TetIndex t = c_.new_tet();
  c_.set_nodes(t, n[0], n[1], n[2], n[3]);
  c_.region[t] = region;
  obstacles_.count_tet(n, true);
  for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) {
    const auto k = c_.face_nodes(ref);
    c_.neigh[ref] = kNoIndex;
    made.push_back(add_face({k[0], k[2], k[1]}, ref, region, false, new_slot()));
  }
}

void FrontStore::remove_tet(TetIndex t, std::vector<std::uint32_t>& made) {
  for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) {
    const auto n = c_.face_nodes(ref);
    const FaceRef other = c_.neigh[ref];
    if (other == kNoIndex) {
      const std::uint32_t g = find({n[0], n[2], n[1]});
      DELFRONT_CHECK(g != kNoIndex);
      remove_face(g);
      free_.push_back(g);
    } else {
      c_.neigh[other] = kNoIndex;
      made.push_back(add_face(n, other, c_.region[t], c_.is_constrained(ref), new_slot()));
    }
  }
  const std::uint32_t* n = &c_.node[4 * t];
  obstacles_.count_tet({n[0], n[1], n[2], n[3]}, false);
  c_.kill_tet(t);
}

void FrontStore::add_vertex() {
  first_.resize(c_.num_vertices(), kNoIndex);
  sizes_.make_room();
}

std::size_t FrontStore::add_tets(const TetComplex& from, const std::vector<VertexIndex>& number) {
  std::vector<TetIndex> slot(from.num_slots(), kNoIndex);
  const auto is_filled = [&](TetIndex t) { return !from.is_dead(t) && !from.is_ghost(t); };
  std::vector<TetIndex> coloured;
  for (TetIndex t = 0; t < from.num_slots(); ++t) {
    if (!is_filled(t)) continue;
    const std::uint32_t* n = &from.node[4 * t];
    slot[t] = c_.new_tet();
    c_.set_nodes(slot[t], number[n[0]], number[n[1]], number[n[2]], number[n[3]]);
    obstacles_.count_tet({number[n[0]], number[n[1]], number[n[2]], number[n[3]]}, true);
    c_.region[slot[t]] = TetComplex::kOutside;
  }
  for (TetIndex t = 0; t < from.num_slots(); ++t) {
    if (!is_filled(t)) continue;
    for (unsigned i = 0; i < 4; ++i) {
      const FaceRef other = from.neigh[4 * t + i], ref = 4 * slot[t] + i;
      const std::uint32_t f = find(c_.face_nodes(ref));
      if (f == kNoIndex) {
        DELFRONT_CHECK(is_filled(other >> 2));
        c_.neigh[ref] = 4 * slot[other >> 2] + (other & 3);
        continue;
      }
      if (c_.region[slot[t]] == TetComplex::kOutside) coloured.push_back(t);
      c_.region[slot[t]] = faces_[f].region;
      c_.bond(ref, faces_[f].behind);
      c_.set_constrained(ref, faces_[f].is_boundary);
      remove_face(f);
      free_.push_back(f);
    }
  }
  for (std::size_t i = 0; i < coloured.size(); ++i)
    for (unsigned k = 0; k < 4; ++k) {
      const TetIndex other = from.neigh[4 * coloured[i] + k] >> 2;
      if (!is_filled(other) || c_.region[slot[other]] != TetComplex::kOutside) continue;
      if (c_.neigh[4 * slot[coloured[i]] + k] >> 2 != slot[other]) continue;
      c_.region[slot[other]] = c_.region[slot[coloured[i]]];
      coloured.push_back(other);
    }
  return static_cast<std::size_t>(std::count_if(slot.begin(), slot.end(), [](TetIndex t) { return t != kNoIndex; }));
}

void FrontStore::join() {
  for (const auto& [a, b] : walls_) {
    c_.bond(c_.neigh[4 * a + 3], c_.neigh[4 * b + 3]);
    c_.kill_tet(a);
    c_.kill_tet(b);
  }
  walls_.clear();
  for (TetIndex t = 0; t < c_.num_slots(); ++t) {
    if (c_.is_dead(t)) continue;
    for (unsigned i = 0; i < 4; ++i)
      if (const VertexIndex v = c_.node[4 * t + i]; v != kGhost) c_.vertex_tet[v] = t;
  }
}

}  // namespace delfront
