// SPDX-License-Identifier: Apache-2.0
// Gift wrapping: a front of faces that look into what is still empty; each takes the vertex in front of it whose sphere
// holds no other. Positive tets whose faces close up with the given ones fill the polyhedron exactly once, so that
// success needs no test of overlap; the tests of crossing only guide the second try, where some vertices are hidden
// from a face.
#include <algorithm>
#include <unordered_map>

#include "volume/facets.hpp"

namespace delfront {

namespace {

using Face = std::array<std::uint32_t, 3>;

/// The same for rotations of a face, another one for its reverse.
std::uint64_t directed_key(Face f) {
  while (f[0] > f[1] || f[0] > f[2]) f = {f[1], f[2], f[0]};
  return static_cast<std::uint64_t>(f[0]) << 42 | static_cast<std::uint64_t>(f[1]) << 21 | f[2];
}

class GiftWrap {
 public:
  GiftWrap(const std::vector<ExactPoint>& points, bool look_out) : p_(points), look_out_(look_out) {}

  bool run(const std::vector<Face>& faces, std::vector<std::array<std::uint32_t, 4>>& tets) {
    for (const Face& f : faces)
      if (!push(f)) return false;
    const std::size_t most = 30 * faces.size() + 100;
    while (!front_.empty()) {
      Face f;
      if (!pop(f)) return false;
      candidates(f);
      bool done = false;
      for (const std::uint32_t w : order_)
        if ((done = fits(f, w) && take(f, w, tets))) break;
      if (!done || tets.size() > most) return false;
    }
    return uses_every_vertex(tets);
  }

 private:
  int orient(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    return orient3d(p_[a], p_[b], p_[c], p_[d]);
  }

  bool push(const Face& f) {
    if (!front_.emplace(directed_key(f), f).second) return false;
    queue_.push_back(f);
    return true;
  }

  bool pop(Face& f) {  // oldest first: the front closes from the given faces inwards
    while (head_ < queue_.size()) {
      f = queue_[head_++];
      if (front_.erase(directed_key(f)) > 0) return true;
    }
    return false;
  }

  /// Vertices in front of f; the one with the empty sphere first, in the second try all in that order.
  void candidates(const Face& f) {
    order_.clear();
    for (std::uint32_t w = 0; w < p_.size(); ++w)
      if (w != f[0] && w != f[1] && w != f[2] && orient(f[0], f[1], f[2], w) > 0) order_.push_back(w);
    auto is_nearer = [&](std::uint32_t a, std::uint32_t b) {
      return a != b && insphere_perturbed(p_[f[0]], p_[f[1]], p_[f[2]], p_[b], p_[a]) > 0;
    };
    if (look_out_) {
      std::sort(order_.begin(), order_.end(), is_nearer);
    } else if (!order_.empty()) {
      order_[0] = *std::min_element(order_.begin(), order_.end(), is_nearer);
      order_.resize(1);
    }
  }

  bool segment_crosses(std::uint32_t a, std::uint32_t b, const Face& f) const {
    for (const std::uint32_t v : f)
      if (v == a || v == b) return false;
    const int sa = orient(f[0], f[1], f[2], a), sb = orient(f[0], f[1], f[2], b);
    if (sa * sb >= 0) return false;
    const int s0 = orient(a, b, f[0], f[1]), s1 = orient(a, b, f[1], f[2]), s2 = orient(a, b, f[2], f[0]);
    return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
  }

  bool is_inside(const Face& f, std::uint32_t w, std::uint32_t v) const {
    return orient(f[0], f[1], f[2], v) >= 0 && orient(f[0], f[2], w, v) >= 0 && orient(f[0], w, f[1], v) >= 0 &&
           orient(f[1], w, f[2], v) >= 0;
  }

  bool fits(const Face& f, std::uint32_t w) const {
    if (!look_out_) return true;
    for (std::uint32_t v = 0; v < p_.size(); ++v)
      if (v != w && v != f[0] && v != f[1] && v != f[2] && is_inside(f, w, v)) return false;
    const Face sides[3] = {{f[0], f[1], w}, {f[1], f[2], w}, {f[2], f[0], w}};
    for (const auto& [key, g] : front_) {
      for (const std::uint32_t v : f)
        if (segment_crosses(v, w, g)) return false;
      for (int k = 0; k < 3; ++k)
        for (const Face& side : sides)
          if (segment_crosses(g[static_cast<std::size_t>(k)], g[static_cast<std::size_t>((k + 1) % 3)], side))
            return false;
    }
    return true;
  }

  /// Adds the tet (f, w): each of its other faces is one of the front's, now filled, or a new one of the front.
  bool take(const Face& f, std::uint32_t w, std::vector<std::array<std::uint32_t, 4>>& tets) {
    const Face inward[3] = {{f[0], w, f[1]}, {f[1], w, f[2]}, {f[2], w, f[0]}};
    for (const Face& side : inward) {
      const Face outward = {side[0], side[2], side[1]};
      if (!front_.contains(directed_key(side)) && front_.contains(directed_key(outward))) return false;
    }
    for (const Face& side : inward)
      if (front_.erase(directed_key(side)) == 0) push({side[0], side[2], side[1]});
    tets.push_back({f[0], f[1], f[2], w});
    return true;
  }

  bool uses_every_vertex(const std::vector<std::array<std::uint32_t, 4>>& tets) const {
    std::vector<bool> used(p_.size(), false);
    for (const auto& tet : tets)
      for (const std::uint32_t v : tet) used[v] = true;
    return std::find(used.begin(), used.end(), false) == used.end();
  }

  const std::vector<ExactPoint>& p_;
  bool look_out_;
  std::unordered_map<std::uint64_t, Face> front_;
  std::vector<Face> queue_;
  std::size_t head_ = 0;
  std::vector<std::uint32_t> order_;
};

}  // namespace

bool fill_polyhedron(const std::vector<ExactPoint>& points, const std::vector<Face>& faces,
                     std::vector<std::array<std::uint32_t, 4>>& tets) {
  for (const bool look_out : {false, true}) {
    tets.clear();
    if (GiftWrap(points, look_out).run(faces, tets)) return true;
  }
  return false;
}

}  // namespace delfront
