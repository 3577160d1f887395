// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/planar.hpp"
#include "predicates/predicates.hpp"

namespace delfront {

using VertexIndex = std::uint32_t;
using TriIndex = std::uint32_t;
using EdgeRef = std::uint32_t;  ///< 4 * triangle + edge; edge e lies opposite node e

inline constexpr std::uint32_t kNoTri = 0xffffffffu;
inline constexpr VertexIndex kInfinity = 0xffffffffu;  ///< the ghost vertex: always the last node of a ghost

inline constexpr unsigned next_of(unsigned i) { return i == 2 ? 0 : i + 1; }
inline constexpr unsigned previous_of(unsigned i) { return i == 0 ? 2 : i - 1; }

inline Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
inline Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
inline Point2 operator*(double s, Point2 a) { return {s * a.x, s * a.y}; }
inline double dot(Point2 a, Point2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }
inline double squared_length(Point2 a) { return dot(a, a); }

inline int orient2d(Point2 a, Point2 b, Point2 c) { return orient2d(&a.x, &b.x, &c.x); }
inline int incircle(Point2 a, Point2 b, Point2 c, Point2 d) { return incircle(&a.x, &b.x, &c.x, &d.x); }

/// @brief Half a cache line. Nodes run anticlockwise; a ghost (a, b, infinity) lies left of a -> b, outside of the
/// hull.
struct alignas(32) Triangle {
  VertexIndex node[3];
  EdgeRef neigh[3];      ///< the same edge seen from the other side: neigh of neigh is oneself
  std::uint32_t region;  ///< colour; see kOutside
  std::uint32_t flags;   ///< bits 0-2: edge is constrained; bit 3: dead; the rest belongs to who works on the complex
};

inline constexpr std::uint32_t kOutside = 0xffffffffu;               ///< colour of what is not gridded
inline constexpr std::size_t kMostTriangles = std::size_t(1) << 30;  ///< two bits of a reference say which edge
inline constexpr std::uint32_t kDead = 8;
inline constexpr std::uint32_t kEdgeBits = 7;

/// @brief Triangles that are edited: one array of records, ghosts on the hull so that each has three neighbours.
class TriComplex {
 public:
  std::vector<Triangle> tri;
  std::vector<Point2> point;
  std::vector<double> h;             ///< wanted size, by vertex; empty until refinement sets it
  std::vector<TriIndex> vertex_tri;  ///< a triangle of each vertex, kNoTri for none; see index_vertices()
  std::vector<TriIndex> free_slots;

  bool is_ghost(TriIndex t) const { return tri[t].node[2] == kInfinity; }
  /// @brief Circumcentre relative to the first corner; not finite for a flat triangle.
  Point2 to_circumcentre(const Triangle& s) const {
    const Point2 a = point[s.node[0]], b = point[s.node[1]] - a, d = point[s.node[2]] - a;
    const double b2 = squared_length(b), d2 = squared_length(d), f = 0.5 / cross(b, d);
    return {f * (d.y * b2 - b.y * d2), f * (b.x * d2 - d.x * b2)};
  }
  bool is_dead(TriIndex t) const { return tri[t].flags & kDead; }
  bool is_constrained(EdgeRef ref) const { return tri[ref >> 2].flags >> (ref & 3) & 1; }
  EdgeRef across(EdgeRef ref) const { return tri[ref >> 2].neigh[ref & 3]; }
  /// @brief The edge runs from origin to target, its triangle on the left.
  VertexIndex origin(EdgeRef ref) const { return tri[ref >> 2].node[next_of(ref & 3)]; }
  VertexIndex target(EdgeRef ref) const { return tri[ref >> 2].node[previous_of(ref & 3)]; }
  VertexIndex apex(EdgeRef ref) const { return tri[ref >> 2].node[ref & 3]; }
  static EdgeRef next_edge(EdgeRef ref) { return (ref & ~3u) | next_of(ref & 3); }
  static EdgeRef previous_edge(EdgeRef ref) { return (ref & ~3u) | previous_of(ref & 3); }

  void set_constrained(EdgeRef ref, bool on) {
    const auto set = [&](EdgeRef r) {
      const std::uint32_t bit = 1u << (r & 3);
      tri[r >> 2].flags = on ? tri[r >> 2].flags | bit : tri[r >> 2].flags & ~bit;
    };
    set(ref);
    set(across(ref));
  }
  void bond(EdgeRef a, EdgeRef b) {
    tri[a >> 2].neigh[a & 3] = b;
    tri[b >> 2].neigh[b & 3] = a;
  }
  TriIndex new_slot();
  void free_slot(TriIndex t);
  std::size_t num_live() const { return tri.size() - free_slots.size(); }

  /// @brief Fill vertex_tri; for vertices on the hull too it is a real triangle.
  void index_vertices();
  /// @brief The edge whose origin is a and whose target is b, kNoTri where there is none. Needs vertex_tri.
  EdgeRef find_edge(VertexIndex a, VertexIndex b) const;
  /// @brief Edge with origin v of the vertex's triangle. Needs vertex_tri.
  EdgeRef first_edge(VertexIndex v) const {
    const Triangle& t = tri[vertex_tri[v]];
    const unsigned i = t.node[0] == v ? 0 : t.node[1] == v ? 1 : 2;
    return 4 * vertex_tri[v] + previous_of(i);
  }
  /// @brief Edge with the same origin, next anticlockwise.
  EdgeRef turn_left(EdgeRef ref) const { return across(previous_edge(ref)); }

  /// @brief Swap the diagonal of the two triangles at an edge; both slots and their colours stay in use.
  ///
  /// (a, b, c) over the edge a -> b and (b, a, d) become (a, d, c) in the slot of `ref` and (b, c, d) in the other.
  /// @pre the edge is not constrained, both triangles are real, the quadrilateral is strictly convex
  /// @return the new edge, running from d to c: edge 0 of the slot of `ref`
  EdgeRef flip(EdgeRef ref);

  /// @brief Everything that must hold: bonds both ways, same nodes and constraint on both sides, positive orientation.
  /// @return empty, or the first thing that is wrong
  const char* find_defect() const;
  /// @brief Whether each unconstrained edge has the opposite corner outside of, or on, the circle (exact).
  bool is_delaunay() const;
};

}  // namespace delfront
