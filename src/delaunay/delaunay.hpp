// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "delfront/context.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief What the kernel did, for comparison with the floor (5.6 walk steps, 48 in-sphere tests, 28 tets a point).
struct KernelCounts {
  std::uint64_t points = 0, walk_steps = 0, insphere_tests = 0, tets_deleted = 0, tets_created = 0;
};

/// @brief Circumsphere in plain arithmetic; squared_radius is negative where rounding may have spoilt it, -inf at
/// worst.
struct alignas(32) Circumsphere {
  Point centre;
  double squared_radius = -1;
  bool is_sure() const { return squared_radius > 0; }
};
Circumsphere circumsphere(const Point& a, const Point& b, const Point& c, const Point& d);

/// @brief Inserts points one at a time into a TetComplex (Bowyer-Watson), exactly in every degenerate case.
///
/// Constrained faces stop the cavity, which is then reduced until it is star-shaped: with constraints the complex stays
/// valid, and Delaunay where the constraints let it. Nothing is allocated per point once the work arrays have grown.
/// @par Source  Bowyer (1981), Watson (1981); perturbation: Devillers & Teillaud (2011)
class DelaunayKernel {
 public:
  explicit DelaunayKernel(TetComplex& complex) : c_(complex) {}

  enum class Insert : std::uint8_t {
    done,
    duplicate,   ///< equals a vertex that is in already; see `duplicate_of`
    outside,     ///< in a constrained complex: outside of the hull
    too_close,   ///< a vertex of the cavity is nearer than asked
    not_visible  ///< in a constrained complex: no star-shaped cavity, or one that would swallow a vertex
  };

  /// @brief What `insert` may do.
  struct Limits {
    double min_distance = 0;   ///< > 0: refuse where a vertex of the cavity is nearer than this
    bool constrained = false;  ///< the complex is not Delaunay everywhere: make the cavity star-shaped, swallow nothing
  };

  /// @brief Make the first tet and its ghosts from four vertices that are not coplanar.
  void start(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d);

  /// @brief The tet that holds vertex v's place (a ghost where it lies outside of the hull), walking from `hint`.
  /// @param max_steps  > 0: kNoIndex where it is not found in so many; else all tets are tried after a long walk
  TetIndex locate(VertexIndex v, TetIndex hint, std::uint64_t max_steps = 0);

  /// @brief Insert vertex v, whose place stands in the complex already. `hint`: a live tet near it, or kNoIndex.
  Insert insert(VertexIndex v, TetIndex hint, const Limits& limits);
  Insert insert(VertexIndex v, TetIndex hint) { return insert(v, hint, Limits()); }

  /// @brief The same where the tet that holds v's place is known: from locate(v), nothing changed since.
  Insert insert_into(TetIndex holder, VertexIndex v, const Limits& limits);

  /// @brief From now on keep the circumsphere of every tet: most in-sphere tests then are one distance.
  ///
  /// For constrained insertion into a complex without segment points. Where rounding could decide, the exact test does.
  /// Only insertions may change the complex as long as the spheres are used.
  void keep_spheres();
  const Circumsphere& sphere(TetIndex t) const { return spheres_[t]; }

  KernelCounts counts;
  TetIndex last_tet = kNoIndex;  ///< a live tet made by the last insertion
  VertexIndex duplicate_of = kNoIndex;
  const std::vector<TetIndex>& made() const { return made_; }  ///< tets of the last insertion

 private:
  struct CavityFace {
    VertexIndex node[3];    ///< normal into the cavity
    FaceRef outer;          ///< the same face from outside
    TetIndex inner;         ///< the cavity's tet
    std::uint32_t slot[3];  ///< of the nodes in ball_vertices_
    bool constrained;
  };

  template <class View>
  TetIndex walk(const View& view, VertexIndex v, TetIndex hint, std::uint64_t max_steps);
  template <class View>
  Insert insert_with(const View& view, VertexIndex v, TetIndex start, const Limits& limits);
  template <class View>
  bool in_conflict(const View& view, TetIndex t, VertexIndex v);
  template <class View>
  bool grow_cavity(const View& view, TetIndex start, VertexIndex v, const Limits& limits);
  void prefetch_neighbours(TetIndex t) const;
  void collect_cavity_faces();
  void add_cavity_face(FaceRef ref, bool constrained);
  template <class View>
  bool make_star_shaped(const View& view, TetIndex start, VertexIndex v);
  bool is_seen(CavityFace& face, const Point& p, Circumsphere& sphere) const;
  void number_ball_vertices();
  bool swallows_a_vertex() const;
  bool is_in_ball(VertexIndex v) const;
  bool is_too_close(VertexIndex w, const Point& p, double min_distance) const;
  void fill_cavity(VertexIndex v);
  void bond_new_tets();
  void bond_by_hash();
  void clear_marks();
  std::uint32_t random();

  TetComplex& c_;
  std::vector<TetIndex> cavity_, tested_, made_;
  std::vector<VertexIndex> reached_;  ///< every vertex of the grown cavity, some of them more than once
  bool is_cavity_reduced_ = false;    ///< since it was grown: reached_ may have too many
  std::vector<CavityFace> faces_;
  std::vector<Circumsphere> face_spheres_;     ///< of the tet over each of faces_, where spheres are kept
  std::vector<Circumsphere> spheres_;          ///< by tet, or empty
  std::vector<std::uint32_t> slot_of_vertex_;  ///< by vertex + 1 (ghost: 0): a sparse set, never cleared
  std::vector<VertexIndex> ball_vertices_;
  std::vector<FaceRef> edge_table_;
  std::vector<std::pair<std::uint64_t, FaceRef>> edge_hash_;
  std::uint32_t random_state_ = 12345;
};

/// @brief Delaunay tetrahedrization of all the complex's vertices, in biased random insertion and Hilbert order.
/// @return pairs (vertex, the earlier one it equals): such vertices are not in any tet
/// @throws InputError  fewer than four distinct points, or all in one plane
/// @par Source  insertion order: Amenta, Choi & Rote (2003)
std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TetComplex& complex, Context& context);

/// @brief The same over a kernel of the caller's, to read its counts or go on inserting.
std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TetComplex& complex, DelaunayKernel& kernel,
                                                                Context& context);

}  // namespace delfront
