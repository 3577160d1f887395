// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "delfront/context.hpp"
#include "planar/tri_complex.hpp"

namespace delfront {

/// @brief What the kernel did, for comparison with the floor (about 9 in-circle tests, 6 triangles made a point).
struct PlanarCounts {
  std::uint64_t points = 0, walk_steps = 0, incircle_tests = 0, triangles_created = 0;
};

/// @brief Inserts points one at a time into a TriComplex (Bowyer-Watson), exactly in every degenerate case.
///
/// The cavity of a point is the triangles whose open circle holds it, reached over unconstrained edges. Each of them is
/// entered over the one edge that the point lies behind, so the angles under which the point sees the edges met are
/// nested: no triangle is met twice, no vertex is swallowed, and the edges of the cavity come out in anticlockwise
/// order. That holds in any valid triangulation with exact signs, whichever way ties (four points on a circle) are
/// decided, so long as "on the circle" is always "outside": a symbolic perturbation is not needed in the plane, no
/// marks are kept and no star-shape test is made. New triangles are bonded to the one before and the one after.
/// @par Source  Bowyer (1981), Watson (1981)
class PlanarKernel {
 public:
  explicit PlanarKernel(TriComplex& complex) : c_(complex) {}

  enum class Insert : std::uint8_t {
    done,
    duplicate,   ///< equals a vertex that is in already; see `duplicate_of`
    too_close,   ///< a vertex of the cavity is nearer than asked
    encroached,  ///< sees a constrained edge under an angle over the one asked for, or lies on it
  };

  struct Limits {
    double min_distance = 0;          ///< > 0: refuse where a vertex of the cavity is nearer than this
    bool keeps_off_segments = false;  ///< refuse what stands so low over a constrained edge that angles get bad
  };

  /// @brief An edge of the cavity, from a to b with the cavity on its left.
  struct CavityEdge {
    EdgeRef outer;  ///< the same edge from outside
    VertexIndex a, b;
    std::uint32_t is_constrained;
  };

  /// @brief Make the first triangle and its ghosts from three vertices that are not collinear.
  void start(VertexIndex a, VertexIndex b, VertexIndex c);

  /// @brief The triangle that holds p (a ghost where p lies outside of the hull), walking from `hint`.
  TriIndex locate(Point2 p, TriIndex hint);

  /// @brief Insert vertex v, whose place stands in the complex already. `hint`: a live triangle near it, or kNoTri.
  Insert insert(VertexIndex v, TriIndex hint) { return insert_into(locate(c_.point[v], start_of(hint)), v); }
  /// @brief The same where the triangle that holds v's place is known.
  Insert insert_into(TriIndex holder, VertexIndex v);
  Insert insert_into(TriIndex holder, VertexIndex v, const Limits& limits);

  /// @brief Find the cavity of p, which lies in `holder`, and change nothing. `edges()` then has it.
  void grow_cavity(TriIndex holder, Point2 p) { grow_cavity(holder, p, 0); }
  /// @brief The same; given up where a vertex of the cavity is met whose squared distance is less than `min_squared`.
  /// @return false where it was given up
  bool grow_cavity(TriIndex holder, Point2 p, double min_squared);
  /// @brief Fill the cavity found last with triangles to v.
  void fill_cavity(VertexIndex v);
  const std::vector<CavityEdge>& edges() const { return edges_; }
  const std::vector<TriIndex>& cavity() const { return cavity_; }
  const std::vector<TriIndex>& made() const { return made_; }  ///< triangles of the last insertion, in order round it

  PlanarCounts counts;
  TriIndex last_tri = kNoTri;  ///< a live real triangle made by the last insertion
  VertexIndex duplicate_of = kInfinity;
  std::uint32_t flags_of_new = 0;  ///< put into `flags` of every triangle made

 private:
  TriIndex start_of(TriIndex hint) const { return hint == kNoTri ? last_tri : hint; }
  /// An edge on the way out, with its ends relative to the point.
  struct Open {
    EdgeRef outer;
    VertexIndex a, b;
    std::uint32_t is_constrained;
    Point2 to_a, to_b;
  };
  bool is_in_conflict(const Triangle& s, VertexIndex apex, const Open& edge, Point2 p, Point2 to_apex) const;
  bool is_ghost_in_conflict(const Triangle& ghost, Point2 p) const;
  bool has_duplicate(TriIndex holder, Point2 p);
  void turn_ghost(TriIndex t);
  Insert check_segments(Point2 p, const Limits& limits) const;
  std::uint32_t random();

  TriComplex& c_;
  std::vector<Open> stack_;
  std::vector<TriIndex> cavity_, made_;
  std::vector<CavityEdge> edges_;
  std::uint32_t random_state_ = 12345;
};

/// @brief 40-bit key along the Hilbert curve in the plane: 20 bits an axis over a square around the box.
class HilbertCurve2 {
 public:
  explicit HilbertCurve2(std::span<const Point2> points);
  std::uint64_t key(Point2 p) const;

 private:
  Point2 low_;
  double scale_ = 0;
};

/// @brief Delaunay triangulation of all the complex's vertices, in biased random insertion and Hilbert order.
/// @return pairs (vertex, the earlier one it equals): such vertices are in no triangle
/// @throws InputError  fewer than three distinct points, or all on one line
/// @par Source  insertion order: Amenta, Choi & Rote (2003)
std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TriComplex& complex, PlanarKernel& kernel,
                                                                Context& context);

}  // namespace delfront
