// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "delaunay/ball.hpp"
#include "delfront/context.hpp"
#include "delfront/delaunay.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

void add_counts(KernelCounts& sum, const KernelCounts& other);

/// @brief The part of a complex that one thread may touch: the tets whose vertices all have keys in [first, first +
/// size).
///
/// Two territories of disjoint ranges share no tet, and no tet of one has a neighbour in the other: a neighbour has
/// three vertices in common. So threads that write what is theirs, and the bonds of what lies beside it, never meet.
struct Territory {
  const std::uint32_t* key = nullptr;  ///< by vertex; null: everything is ours
  std::uint32_t first = 0, size = 0;
  bool holds(VertexIndex v) const { return !key || v == kGhost || key[v] - first < size; }
};

/// @brief Inserts points one at a time into a TetComplex (Bowyer-Watson), exactly in every degenerate case.
///
/// Constrained faces stop the cavity, which is then reduced until it is star-shaped: with constraints the complex stays
/// valid, and Delaunay where the constraints let it. Nothing is allocated per point once the work arrays have grown.
/// @par Source  Bowyer (1981), Watson (1981); perturbation: Devillers & Teillaud (2011); territories: Marot, Pellerin &
/// Remacle (2019)
class DelaunayKernel {
 public:
  explicit DelaunayKernel(TetComplex& complex) : c_(complex) {}

  enum class Insert : std::uint8_t {
    done,
    duplicate,    ///< equals a vertex that is in already; see `duplicate_of`
    outside,      ///< in a constrained complex: outside of the hull
    too_close,    ///< a vertex of the cavity is nearer than asked
    not_visible,  ///< in a constrained complex: no star-shaped cavity, or one that would swallow a vertex or a kept
                  ///< edge
    not_ours      ///< it touches tets that are not ours, or no slot is left: nothing changed, try again later
  };

  /// @brief What `insert` may do.
  struct Limits {
    double min_distance = 0;   ///< > 0: refuse where a vertex of the cavity is nearer than this
    bool constrained = false;  ///< the complex is not Delaunay everywhere: make the cavity star-shaped, swallow nothing
  };

  /// @brief Stay within a territory and make tets of these slots, until leave(): for one thread among several. In a
  /// territory that is everything the complex may grow beyond them.
  void enter(const Territory& territory, SlotStock slots);
  /// @return the slots that were not used, or have become free
  SlotStock leave();
  /// @brief Whether all vertices of a tet are ours: only then may it be read.
  bool is_ours(TetIndex t) const;
  bool holds(VertexIndex v) const { return territory_.holds(v); }
  bool is_confined() const { return territory_.key != nullptr; }

  /// @brief Make the first tet and its ghosts from four vertices that are not coplanar.
  void start(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d);

  /// @brief The tet that holds vertex v's place (a ghost where it lies outside of the hull), walking from `hint`.
  /// @param max_steps  > 0: kNoIndex where it is not found in so many; else all tets are tried after a long walk
  /// @return kNoIndex also where the walk leaves the territory
  TetIndex locate(VertexIndex v, TetIndex hint, std::uint64_t max_steps = 0);

  /// @brief Insert vertex v, whose place stands in the complex already. `hint`: a live tet near it, or kNoIndex.
  Insert insert(VertexIndex v, TetIndex hint, const Limits& limits);
  Insert insert(VertexIndex v, TetIndex hint) { return insert(v, hint, Limits()); }

  /// @brief The same where the tet that holds v's place is known: from locate(v), nothing changed since.
  Insert insert_into(TetIndex holder, VertexIndex v, const Limits& limits);

  KernelCounts counts;
  TetIndex last_tet = kNoIndex;  ///< a live tet made by the last insertion
  VertexIndex duplicate_of = kNoIndex;
  const std::vector<TetIndex>& made() const { return made_; }  ///< tets of the last insertion

 private:
  /// Of a cavity tet, bits by face.
  struct Faces {
    std::uint8_t inside, seen, close;
  };

  unsigned faces_behind(TetIndex t, VertexIndex v) const;
  TetIndex scan(VertexIndex v) const;
  template <class View>
  bool in_conflict(const View& view, TetIndex t, VertexIndex v);
  Faces look_across(TetIndex t, VertexIndex v, unsigned open, bool with_sides, double min_distance);
  bool is_inside_exactly(FaceRef face, VertexIndex v, bool is_tie);
  template <class View>
  Faces look_across_exactly(const View& view, TetIndex t, VertexIndex v, double min_distance);
  Insert insert_checked(VertexIndex v, TetIndex start, const Limits& limits);
  VertexIndex find_duplicate(TetIndex start, VertexIndex v) const;
  template <bool kConstrained>
  bool look_across_fast(TetIndex t, const VertexIndex* apex, VertexIndex v, unsigned open, double min_distance2,
                        Faces& faces);
  template <bool kConstrained>
  Insert grow_cavity(TetIndex start, VertexIndex v, double min_distance);
  bool has_foreign(const VertexIndex* apex, unsigned faces) const;
  void add_to_border(TetIndex t, unsigned faces);
  void collect_border();
  void make_ball();
  bool make_star_shaped(TetIndex start);
  bool swallows_a_vertex() const;
  bool spare_kept_edges(TetIndex start);
  void drop_unmarked();
  void clear_marks();
  bool has_room() const { return !is_confined() || slots_.size() + cavity_.size() >= ball_.faces.size(); }
  TetIndex take_slot();
  void fill_cavity(VertexIndex v);
  std::uint32_t random();

  TetComplex& c_;
  Territory territory_;
  bool is_in_territory_ = false;
  SlotStock slots_;  ///< of the territory
  std::vector<TetIndex> made_;
  FlatArray<TetIndex> cavity_;
  FlatArray<FaceRef> border_;         ///< faces of the cavity, from inside
  std::vector<std::uint8_t> seen_;    ///< by cavity tet: faces that see the point; with constraints only
  std::vector<VertexIndex> reached_;  ///< every vertex of the grown cavity, some of them more than once
  bool is_star_shaped_ = true;        ///< as it was grown
  Ball ball_;
  std::uint32_t random_state_ = 12345;
};

/// @brief Four vertices of the complex that span a volume.
/// @throws InputError  there are none
std::array<VertexIndex, 4> find_first_tet(const TetComplex& complex);

/// @brief Delaunay tetrahedrization of all the complex's vertices, in biased random insertion and Hilbert order.
///
/// Several threads work on intervals of the curve that depend on the points alone, so the result does not depend on
/// how many there are.
/// @return pairs (vertex, the lowest one it equals): such vertices are not in any tet
/// @throws InputError  fewer than four distinct points, or all in one plane
/// @par Source  insertion order: Amenta, Choi & Rote (2003)
std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TetComplex& complex, Context& context,
                                                                KernelCounts* counts = nullptr);

}  // namespace delfront
