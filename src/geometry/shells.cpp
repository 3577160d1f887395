// SPDX-License-Identifier: Apache-2.0
// Shells: the triangles around an edge, in turning order, leave a wedge of space between each two neighbours; both
// sides that look into a wedge belong to one shell. Nesting: a segment from a vertex of a component to a place outside
// of everything; each triangle it crosses takes it from the shell of one side to that of the other, so a shell that is
// left once more than it is entered holds the vertex. Segments that meet an edge or a corner are drawn anew.
#include "geometry/shells.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "predicates/predicates.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

/// Sides 2 t and 2 t + 1 joined across the wedges about all edges.
void join_across_wedges(const Surface& surface, DisjointSets& sides) {
  auto next_side = [&](std::uint32_t h) { return 2 * (h / 3) + (runs_up(surface, h) ? 0u : 1u); };
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const std::vector<std::uint32_t> order = sort_about_edge(surface, e);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t after = order[(i + 1) % order.size()];
      sides.join(next_side(order[i]), next_side(after) ^ 1u);
    }
  }
}

/// Six times the volume under each triangle, seen from a place near its component (for accuracy), summed by shell.
void add_volumes(const Surface& surface, SurfaceShells& out) {
  std::vector<Point> origin(out.parent_shell.size());
  for (std::size_t t = 0; t < surface.num_triangles(); ++t)
    if (out.component[t] != kNoTriangle) origin[out.component[t]] = surface.corner(t, 0);
  for (std::size_t t = 0; t < surface.num_triangles(); ++t) {
    if (out.component[t] == kNoTriangle) continue;
    const Point o = origin[out.component[t]];
    const Point a = surface.corner(t, 0) - o, b = surface.corner(t, 1) - o, c = surface.corner(t, 2) - o;
    const double volume = dot(a, cross(b, c)) / 6;
    out.shells[out.front(t)].volume -= volume;
    out.shells[out.back(t)].volume += volume;
    ++out.shells[out.front(t)].num_sides;
    ++out.shells[out.back(t)].num_sides;
  }
  for (Shell& shell : out.shells) shell.volume /= surface.scale * surface.scale * surface.scale;
}

void mark_outer_shells(SurfaceShells& out) {
  // The outer shell's volume is minus the sum of the others', so it is the lowest.
  std::vector<std::uint32_t> lowest(out.parent_shell.size(), kNoShell);
  for (std::uint32_t s = 0; s < out.shells.size(); ++s) {
    if (out.shells[s].component == kNoTriangle) continue;  // of a triangle that repeats a corner
    std::uint32_t& best = lowest[out.shells[s].component];
    if (best == kNoShell || out.shells[s].volume < out.shells[best].volume) best = s;
  }
  for (std::uint32_t s : lowest)
    if (s != kNoShell) out.shells[s].is_outer = true;
}

enum class Meeting { misses, to_front, to_back, unclear };

/// How the segment p -> q crosses a triangle that does not hold p.
Meeting cross_triangle(Point p, Point q, Point a, Point b, Point c) {
  const int from = orient3d(a, b, c, p), to = orient3d(a, b, c, q);
  if (from == 0 && to == 0) return Meeting::unclear;
  if (from == 0 || to == 0 || from == to) return Meeting::misses;
  const int ab = orient3d(p, q, a, b), bc = orient3d(p, q, b, c), ca = orient3d(p, q, c, a);
  const bool has_plus = ab > 0 || bc > 0 || ca > 0, has_minus = ab < 0 || bc < 0 || ca < 0;
  if (has_plus && has_minus) return Meeting::misses;
  if (ab == 0 || bc == 0 || ca == 0) return Meeting::unclear;
  return to > 0 ? Meeting::to_front : Meeting::to_back;
}

class Nesting {
 public:
  Nesting(const Surface& surface, SurfaceShells& shells, Context& context);
  void run();

 private:
  Point place_on(std::uint32_t component) const;
  std::optional<std::uint32_t> shell_around(std::uint32_t component, Point p, Point q) const;

  const Surface& surface_;
  SurfaceShells& out_;
  Context& context_;
  Bvh bvh_;
  std::vector<std::uint32_t> owner_;           // by vertex: its only component, or kNoTriangle
  std::vector<std::uint32_t> first_triangle_;  // by component
  std::vector<VertexId> own_vertex_;           // by component: a vertex that no other component has, if any
};

Nesting::Nesting(const Surface& surface, SurfaceShells& shells, Context& context)
    : surface_(surface), out_(shells), context_(context) {
  const std::size_t n = surface.num_triangles();
  std::vector<Box> boxes(n);
  for (std::size_t t = 0; t < n; ++t) boxes[t] = surface.box(t);
  bvh_ = Bvh(boxes);
  constexpr std::uint32_t kSeveral = kNoTriangle - 1;
  owner_.assign(surface.points.size(), kNoTriangle);
  first_triangle_.assign(shells.parent_shell.size(), kNoTriangle);
  own_vertex_.resize(shells.parent_shell.size());
  for (std::size_t t = n; t-- > 0;) {
    const std::uint32_t c = shells.component[t];
    first_triangle_[c] = static_cast<std::uint32_t>(t);
    for (VertexId v : surface.corners(t)) {
      std::uint32_t& owner = owner_[v.index()];
      owner = owner == kNoTriangle || owner == c ? c : kSeveral;
    }
  }
  for (std::size_t v = 0; v < owner_.size(); ++v)
    if (owner_[v] < kSeveral && !own_vertex_[owner_[v]].is_valid()) own_vertex_[owner_[v]] = VertexId(v);
}

/// A place that belongs to the component and to no other: a vertex of its own, else (all are shared) about the middle
/// of a triangle, which no other component can touch.
Point Nesting::place_on(std::uint32_t component) const {
  if (own_vertex_[component].is_valid()) return surface_.points[own_vertex_[component]];
  const std::uint32_t t = first_triangle_[component];
  return (surface_.corner(t, 0) + surface_.corner(t, 1) + surface_.corner(t, 2)) / 3;
}

/// The innermost inner shell of another component around p; kNoShell: none; nothing: p -> q meets an edge.
std::optional<std::uint32_t> Nesting::shell_around(std::uint32_t component, Point p, Point q) const {
  std::map<std::uint32_t, int> left;  // by shell: times the segment leaves it minus times it enters it
  bool is_clear = true;
  bvh_.for_each_on_ray(p, q - p, 1, [&](std::uint32_t t) {
    if (!is_clear || out_.component[t] == component) return;
    const Meeting meeting = cross_triangle(p, q, surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2));
    if (meeting == Meeting::unclear) is_clear = false;
    if (meeting == Meeting::unclear || meeting == Meeting::misses) return;
    const int sign = meeting == Meeting::to_front ? 1 : -1;
    left[out_.back(t)] += sign;
    left[out_.front(t)] -= sign;
  });
  if (!is_clear) return std::nullopt;
  std::uint32_t best = kNoShell;
  for (const auto& [shell, count] : left) {
    if (count <= 0 || out_.shells[shell].is_outer) continue;
    if (best == kNoShell || out_.shells[shell].volume < out_.shells[best].volume) best = shell;
  }
  return best;
}

void Nesting::run() {
  const Box& box = bvh_.box_of_all();
  const double reach = 1.5 * box.diagonal();
  // Directions without any symmetry; the first is nearly always clear of edges.
  constexpr int kMaxDraws = 64;
  for (std::uint32_t c = 0; c < first_triangle_.size(); ++c) {
    if (c % 256 == 0) context_.check_limits();
    const Point p = place_on(c);
    std::optional<std::uint32_t> found;
    for (int draw = 0; draw < kMaxDraws && !found; ++draw) {
      const double turn = 0.7390851332 + 2.3999632297 * draw,
                   up = std::fmod(0.2718281828 + 0.6180339887 * draw, 2.0) - 1;
      const double flat = std::sqrt(1 - up * up);
      const Point q = box.centre() + reach * Point{flat * std::cos(turn), flat * std::sin(turn), up};
      found = shell_around(c, p, q);
    }
    DELFRONT_CHECK(found.has_value());
    out_.parent_shell[c] = *found;
  }
}

/// Union by triangle with a parity: do two triangles agree in orientation?
class ParitySets {
 public:
  explicit ParitySets(std::size_t size) : parent_(size), parity_(size, 0) {
    for (std::uint32_t i = 0; i < size; ++i) parent_[i] = i;
  }
  std::pair<std::uint32_t, char> find(std::uint32_t i) {
    std::uint32_t root = i;
    char parity = 0;
    while (parent_[root] != root) {
      parity ^= parity_[root];
      root = parent_[root];
    }
    for (char p = parity; parent_[i] != i;) {  // compress
      const std::uint32_t up = parent_[i];
      const char rest = p ^ parity_[i];
      parent_[i] = root;
      parity_[i] = p;
      p = rest;
      i = up;
    }
    return {root, parity};
  }
  /// @return false where i and j are already known to disagree
  bool join(std::uint32_t i, std::uint32_t j, char differ) {
    const auto [a, pa] = find(i);
    const auto [b, pb] = find(j);
    if (a == b) return (pa ^ pb) == differ;
    parent_[std::max(a, b)] = std::min(a, b);
    parity_[std::max(a, b)] = static_cast<char>(pa ^ pb ^ differ);
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<char> parity_;
};

/// Both triangles of a simple edge run along it the same way.
bool is_flip(const Surface& surface, std::size_t edge) {
  const auto h = surface.edges.half_edges(edge);
  return h.size() == 2 && runs_up(surface, h[0]) == runs_up(surface, h[1]);
}

}  // namespace

std::vector<std::uint32_t> find_components(const Surface& surface, std::uint32_t& num_components) {
  const std::size_t n = surface.num_triangles();
  DisjointSets sets(n);
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto half_edges = surface.edges.half_edges(e);
    for (std::uint32_t h : half_edges) sets.join(half_edges[0] / 3, h / 3);
  }
  std::vector<std::uint32_t> component(n, kNoTriangle), number(n, kNoTriangle);
  num_components = 0;
  for (std::uint32_t t = 0; t < n; ++t) {
    if (!surface.has_edges[t]) continue;
    const std::uint32_t root = sets.find(t);
    if (number[root] == kNoTriangle) number[root] = num_components++;
    component[t] = number[root];
  }
  return component;
}

std::vector<std::uint32_t> sort_about_edge(const Surface& surface, std::size_t edge) {
  const auto half_edges = surface.edges.half_edges(edge);
  std::vector<std::uint32_t> order(half_edges.begin(), half_edges.end());
  if (order.size() <= 2) return order;
  const auto [low, high] = surface.edges.ends(edge);
  const Point a = surface.points[low], b = surface.points[high];
  const Point reference = surface.points[surface.apex(order[0])];
  auto apex = [&](std::uint32_t h) { return surface.points[surface.apex(h)]; };
  // 0 the reference itself, 1 less than half a turn on, 2 opposite, 3 more than half a turn on
  std::map<std::uint32_t, int> half;
  for (std::uint32_t h : order) {
    const int side = orient3d(a, b, reference, apex(h));
    half[h] = h == order[0] ? 0 : side > 0 ? 1 : side == 0 ? 2 : 3;
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t g, std::uint32_t h) {
    if (half[g] != half[h]) return half[g] < half[h];
    const int side = g == h ? 0 : orient3d(a, b, apex(g), apex(h));
    return side != 0 ? side > 0 : g < h;
  });
  return order;
}

std::vector<SurfaceShells::Region> SurfaceShells::regions() const {
  std::vector<Region> list;
  std::vector<std::size_t> region_of_shell(shells.size());
  for (std::uint32_t s = 0; s < shells.size(); ++s) {
    if (shells[s].is_outer) continue;
    region_of_shell[s] = list.size();
    list.push_back({s, shells[s].volume});
  }
  for (const Shell& shell : shells)
    if (shell.is_outer && parent_shell[shell.component] != kNoShell)
      list[region_of_shell[parent_shell[shell.component]]].volume += shell.volume;
  return list;
}

SurfaceShells find_shells(const Surface& surface, Context& context) {
  SurfaceShells out;
  std::uint32_t num_components = 0, num_shells = 0;
  out.component = find_components(surface, num_components);
  DisjointSets sides(2 * surface.num_triangles());
  join_across_wedges(surface, sides);
  out.shell_of_side = sides.number(num_shells);
  out.shells.resize(num_shells);
  out.parent_shell.assign(num_components, kNoShell);
  for (std::size_t side = 0; side < out.shell_of_side.size(); ++side)
    out.shells[out.shell_of_side[side]].component = out.component[side / 2];
  add_volumes(surface, out);
  mark_outer_shells(out);
  if (num_components > 1) Nesting(surface, out, context).run();
  return out;
}

std::vector<bool> find_triangles_to_turn(const Surface& surface, const SurfaceShells& shells) {
  const std::size_t n = surface.num_triangles();
  std::vector<bool> turn(n, false), is_mixed(shells.parent_shell.size(), false);
  ParitySets patches(n);
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto h = surface.edges.half_edges(e);
    if (h.size() != 2) continue;
    const bool flip = is_flip(surface, e);
    if (flip) is_mixed[shells.component[h[0] / 3]] = true;
    patches.join(h[0] / 3, h[1] / 3, flip);
  }
  auto is_outside = [&](std::uint32_t shell) { return shells.shells[shell].is_outer; };
  std::vector<std::array<std::size_t, 2>> votes(n, {0, 0});
  for (std::uint32_t t = 0; t < n; ++t) {
    const auto [root, parity] = patches.find(t);
    ++votes[root][std::size_t(parity)];
  }
  for (std::uint32_t t = 0; t < n; ++t) {
    if (!surface.has_edges[t] || !is_mixed[shells.component[t]]) continue;
    const bool front = is_outside(shells.front(t)), back = is_outside(shells.back(t));
    if (front != back) {
      turn[t] = back;
    } else {
      const auto [root, parity] = patches.find(t);
      turn[t] = parity == (votes[root][0] >= votes[root][1] ? 1 : 0);
    }
  }
  return turn;
}

}  // namespace delfront
