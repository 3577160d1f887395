// SPDX-License-Identifier: Apache-2.0
#include "volume/regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <unordered_map>

namespace delfront {

namespace {

constexpr std::uint32_t kUncoloured = TetComplex::kOutside - 1;

std::size_t flood(TetComplex& c) {
  std::vector<TetIndex> stack;
  auto fill = [&](std::uint32_t colour) {
    while (!stack.empty()) {
      const TetIndex t = stack.back();
      stack.pop_back();
      for (unsigned f = 0; f < 4; ++f) {
        const TetIndex next = c.neigh[4 * t + f] >> 2;
        if (c.region[next] != kUncoloured || c.is_constrained(4 * t + f)) continue;
        c.region[next] = colour;
        stack.push_back(next);
      }
    }
  };
  for (TetIndex t = 0; t < c.num_slots(); ++t) c.region[t] = kUncoloured;
  for (TetIndex t = 0; t < c.num_slots(); ++t)
    if (!c.is_dead(t) && c.is_ghost(t) && c.region[t] == kUncoloured) {
      c.region[t] = TetComplex::kOutside;
      stack.push_back(t);
      fill(TetComplex::kOutside);
    }
  std::uint32_t colours = 0;
  for (TetIndex t = 0; t < c.num_slots(); ++t)
    if (!c.is_dead(t) && c.region[t] == kUncoloured) {
      c.region[t] = colours;
      stack.push_back(t);
      fill(colours++);
    }
  return colours;
}

/// By sorted nodes: is the given face an even permutation of the subface's nodes?
class SubfaceMap {
 public:
  explicit SubfaceMap(const std::vector<Subface>& subfaces) : subfaces_(subfaces) {
    index_.reserve(subfaces.size());
    for (std::size_t i = 0; i < subfaces.size(); ++i) index_.emplace(key(subfaces[i].node), i);
  }
  const Subface& find(const std::array<VertexIndex, 3>& face, bool& same_side) const {
    const auto found = index_.find(key(face));
    DELFRONT_CHECK(found != index_.end());
    const auto& node = subfaces_[found->second].node;
    const auto at = static_cast<std::size_t>(std::find(node.begin(), node.end(), face[0]) - node.begin());
    same_side = node[(at + 1) % 3] == face[1];
    return subfaces_[found->second];
  }

 private:
  struct Hash {
    std::size_t operator()(const std::array<VertexIndex, 3>& k) const {
      std::uint64_t h = k[0] * 0x9e3779b97f4a7c15ull;
      h = (h ^ (h >> 29) ^ k[1]) * 0xbf58476d1ce4e5b9ull;
      return (h ^ (h >> 31) ^ k[2]) * 0x94d049bb133111ebull;
    }
  };
  static std::array<VertexIndex, 3> key(std::array<VertexIndex, 3> f) {
    std::sort(f.begin(), f.end());
    return f;
  }
  const std::vector<Subface>& subfaces_;
  std::unordered_map<std::array<VertexIndex, 3>, std::size_t, Hash> index_;
};

struct Border {
  std::uint32_t front, back;  ///< colours on the normal's side and behind; back is wound once more
  auto operator<=>(const Border&) const = default;
};

/// Breadth-first from the outside: the votes of all faces to components decided before.
void decide_holes(std::vector<RegionFacts>& facts, const std::map<Border, std::size_t>& borders) {
  const std::size_t outside = facts.size();
  auto node = [&](std::uint32_t colour) { return colour == TetComplex::kOutside ? outside : colour; };
  constexpr int kUnknown = 1 << 20;
  std::vector<int> winding(facts.size() + 1, kUnknown);
  winding[outside] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    std::map<std::size_t, std::vector<int>> votes;
    for (const auto& [border, count] : borders) {
      const std::size_t a = node(border.front), b = node(border.back);
      if (winding[a] != kUnknown && winding[b] == kUnknown) votes[b].push_back(winding[a] + 1);
      if (winding[b] != kUnknown && winding[a] == kUnknown) votes[a].push_back(winding[b] - 1);
    }
    for (const auto& [component, given] : votes) {
      const bool all_equal = std::adjacent_find(given.begin(), given.end(), std::not_equal_to<>()) == given.end();
      winding[component] = all_equal ? given[0] : 1;
      facts[component].is_undecided = !all_equal;
      facts[component].is_hole = all_equal && given[0] == 0;
      changed = true;
    }
  }
}

double volume_of(const TetComplex& c, TetIndex t) {
  const Point a = c.point(c.node[4 * t]);
  return dot(cross(c.point(c.node[4 * t + 1]) - a, c.point(c.node[4 * t + 2]) - a), c.point(c.node[4 * t + 3]) - a) / 6;
}

}  // namespace

std::vector<RegionFacts> colour_regions(TetComplex& complex, const std::vector<Subface>& subfaces, const Model& model,
                                        const std::vector<bool>& is_far_field, Context& context) {
  std::vector<RegionFacts> facts(flood(complex));
  const SubfaceMap map(subfaces);
  std::map<Border, std::size_t> borders;
  std::vector<std::map<RegionId, std::size_t>> votes(model.sides.empty() ? 0 : facts.size());
  for (TetIndex t = 0; t < complex.num_slots(); ++t) {
    if (complex.is_dead(t)) continue;
    const std::uint32_t colour = complex.region[t];
    if (colour != TetComplex::kOutside) facts[colour].volume += volume_of(complex, t);
    for (unsigned f = 0; f < 4; ++f) {
      const FaceRef ref = 4 * t + f;
      const std::uint32_t other = complex.region[complex.neigh[ref] >> 2];
      if (other == colour || !complex.is_constrained(ref)) continue;
      bool is_front = false;
      const Subface& subface = map.find(complex.face_nodes(ref), is_front);
      if (is_front) ++borders[{colour, other}];
      if (colour != TetComplex::kOutside && is_far_field[model.patch_of_triangle[subface.triangle].index()])
        facts[colour].touches_far_field = true;
      if (colour != TetComplex::kOutside && subface.triangle.index() < model.sides.size())
        if (const RegionId region = model.sides[subface.triangle][is_front ? 1 : 0]; region.is_valid())
          ++votes[colour][region];
    }
  }
  decide_holes(facts, borders);
  for (std::size_t i = 0; i < votes.size(); ++i) {
    const auto most = std::max_element(votes[i].begin(), votes[i].end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == votes[i].end()) continue;
    facts[i].declared = most->first;
    facts[i].is_hole = facts[i].is_undecided = false;
  }
  for (std::size_t i = 0; i < facts.size(); ++i)
    if (facts[i].is_undecided)
      context.log(
          LogLevel::warning,
          fmt::format("region {}: the orientation of its faces does not tell whether it is a hole; taken as a region",
                      i + 1));
  return facts;
}

namespace {

void keep_by_seeds(const TetComplex& complex, const std::vector<Point>& seeds, std::vector<bool>& keep) {
  keep.assign(keep.size(), false);
  for (const Point& seed : seeds) {
    bool found = false;
    for (TetIndex t = 0; t < complex.num_slots() && !found; ++t) {
      if (complex.is_dead(t) || complex.is_ghost(t) || complex.region[t] == TetComplex::kOutside) continue;
      bool holds = true;
      for (unsigned f = 0; f < 4 && holds; ++f) {
        const auto n = complex.face_nodes(4 * t + f);
        holds = orient3d(complex.exact(n[0]), complex.exact(n[1]), complex.exact(n[2]),
                         ExactPoint::explicit_point(seed)) >= 0;
      }
      if (holds) keep[complex.region[t]] = found = true;
    }
    if (!found)
      throw InputError(fmt::format("domain.keep: the point ({:g}, {:g}, {:g}) lies outside of every closed surface; "
                                   "give a point inside of the region to keep",
                                   seed.x, seed.y, seed.z),
                       {{seed, {}}});
  }
}

}  // namespace

std::vector<bool> choose_regions(const TetComplex& complex, const std::vector<RegionFacts>& facts,
                                 const DomainOptions& domain) {
  std::vector<bool> keep(facts.size());
  const bool has_far_field = std::any_of(facts.begin(), facts.end(), [](const auto& f) { return f.touches_far_field; });
  for (std::size_t i = 0; i < facts.size(); ++i) {
    keep[i] = has_far_field ? facts[i].touches_far_field : !facts[i].is_hole;
    if (domain.keep == "all") keep[i] = true;
  }
  if (domain.keep == "largest" && !facts.empty()) {
    const auto largest =
        std::max_element(facts.begin(), facts.end(), [](const auto& a, const auto& b) { return a.volume < b.volume; });
    keep.assign(facts.size(), false);
    keep[static_cast<std::size_t>(largest - facts.begin())] = true;
  }
  if (!domain.keep_points.empty()) keep_by_seeds(complex, domain.keep_points, keep);
  if (std::find(keep.begin(), keep.end(), true) == keep.end())
    throw InputError("the surface encloses no region to grid; domain.keep = \"all\" keeps holes too");
  return keep;
}

std::vector<std::uint32_t> order_regions(const std::vector<RegionFacts>& facts, const std::vector<bool>& keep) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) kept.push_back(i);
  std::stable_sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) {
    return facts[a].declared.value < facts[b].declared.value;  // none is the last
  });
  std::vector<std::uint32_t> order(keep.size(), TetComplex::kOutside);
  for (std::size_t i = 0; i < kept.size(); ++i) order[kept[i]] = static_cast<std::uint32_t>(i);
  return order;
}

std::vector<std::string> name_regions(const std::vector<RegionFacts>& facts, const std::vector<std::uint32_t>& order,
                                      const Model& model) {
  std::vector<std::size_t> by_number(facts.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != TetComplex::kOutside) by_number[order[i]] = i, ++count;
  std::set<std::string> taken;
  for (const Region& region : model.regions) taken.insert(region.name);
  std::vector<bool> is_given(model.regions.size(), false);
  const auto unused = [&](const std::string& wanted, std::size_t number) {
    std::string name = wanted;
    while (!taken.insert(name).second) name = fmt::format("{}_{}", wanted, number++);
    return name;
  };
  std::vector<std::string> names;
  bool has_fluid = false;
  for (std::size_t i = 0; i < count; ++i) {
    const RegionId declared = facts[by_number[i]].declared;
    const std::string given = declared.index() < model.regions.size() ? model.regions[declared].name : std::string();
    if (given.empty()) {
      names.push_back(has_fluid ? unused(fmt::format("region_{}", i + 1), 2) : unused("fluid", 2));
      has_fluid = true;
    } else if (!is_given[declared.index()]) {
      is_given[declared.index()] = true;
      names.push_back(given);
    } else {
      names.push_back(unused(given, 2));
    }
  }
  return names;
}

void strip_outside(TetComplex& c, const std::vector<std::uint32_t>& new_colour) {
  const auto slots = static_cast<TetIndex>(c.num_slots());
  auto is_kept = [&](TetIndex t) { return c.region[t] != TetComplex::kOutside; };
  std::vector<FaceRef> border;
  for (TetIndex t = 0; t < slots; ++t)
    if (!c.is_dead(t) && c.region[t] != TetComplex::kOutside) c.region[t] = new_colour[c.region[t]];
  for (TetIndex t = 0; t < slots; ++t)
    if (!c.is_dead(t) && is_kept(t))
      for (unsigned f = 0; f < 4; ++f)
        if (!is_kept(c.neigh[4 * t + f] >> 2)) border.push_back(4 * t + f);

  // Which border face follows each border face round each of its edges, through what goes away.
  struct Side {
    FaceRef face;
    std::array<FaceRef, 3> across;  ///< over the edge opposite face node k
  };
  std::vector<Side> sides;
  for (const FaceRef ref : border) {
    Side side{ref, {}};
    const auto n = c.face_nodes(ref);
    for (unsigned k = 0; k < 3; ++k) {
      const VertexIndex u = n[(k + 1) % 3], v = n[(k + 2) % 3];
      FaceRef into = c.neigh[ref];
      for (;;) {  // turn round edge (u, v) until a kept tet is entered
        const TetIndex t = into >> 2;
        unsigned leave = 0;
        while (c.node[4 * t + leave] == u || c.node[4 * t + leave] == v || leave == (into & 3)) ++leave;
        const FaceRef out = c.neigh[4 * t + leave];
        if (is_kept(out >> 2)) {
          side.across[k] = out;
          break;
        }
        into = out;
      }
    }
    sides.push_back(side);
  }
  for (TetIndex t = 0; t < slots; ++t)
    if (!c.is_dead(t) && !is_kept(t)) c.kill_tet(t);
  std::fill(c.vertex_tet.begin(), c.vertex_tet.end(), kNoIndex);

  std::unordered_map<FaceRef, TetIndex> ghost_of;
  ghost_of.reserve(sides.size());
  for (const Side& side : sides) {
    const TetIndex g = c.new_tet();
    const auto n = c.face_nodes(side.face);
    c.set_nodes(g, n[0], n[2], n[1], kGhost);
    c.flag[g] = 0;
    c.region[g] = TetComplex::kOutside;
    c.bond(side.face, 4 * g + 3);
    c.set_constrained_both(side.face, true);
    ghost_of.emplace(side.face, g);
  }
  for (const Side& side : sides) {
    const TetIndex g = ghost_of.at(side.face);
    const auto n = c.face_nodes(side.face);
    for (unsigned k = 0; k < 3; ++k) {
      const TetIndex other = ghost_of.at(side.across[k]);
      const VertexIndex u = n[(k + 1) % 3], v = n[(k + 2) % 3];
      unsigned face = 0;
      while (c.node[4 * other + face] == u || c.node[4 * other + face] == v) ++face;
      c.neigh[4 * g + static_cast<unsigned>(c.local_index(g, n[k]))] = 4 * other + face;
    }
  }
  for (TetIndex t = 0; t < c.num_slots(); ++t)
    if (!c.is_dead(t) && !c.is_ghost(t))
      for (unsigned k = 0; k < 4; ++k) c.vertex_tet[c.node[4 * t + k]] = t;
}

}  // namespace delfront
