// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "spatial/box_octree.hpp"
#include "volume/front_neighbourhood.hpp"
#include "volume/front_store.hpp"

namespace delfront {

/// @brief What a sweep of the front asks of its tets (F17); lengths in wanted sizes.
struct FrontSettings {
  double radius;          ///< of the search for points round the ideal one
  double quality;         ///< least squared sine of a dihedral angle
  double wedge;           ///< least squared sine of an angle left between two faces
  double clearance;       ///< between a tet and points that are not its own
  double to_points;       ///< from a new point to others
  double to_faces;        ///< from a new point to faces
  bool is_local = false;  ///< takes points of adjacent faces alone, as long and narrow faces always do
};

/// @brief A slab of space between two values of a coordinate, that one worker may change.
struct FrontSlab {
  int axis = 0;
  double low = -1e300, high = 1e300;
  bool holds(const Box& box) const { return low <= box.low[axis] && box.high[axis] < high; }
  /// @brief Whether it has a part of the box.
  bool meets(const Box& box) const { return low <= box.high[axis] && box.low[axis] < high; }
};

struct FrontCounts {
  std::uint64_t steps = 0, tets = 0, points = 0, deferred = 0, failed = 0, candidates = 0, visited = 0;
  double step_seconds = 0, test_seconds = 0;  ///< of one step in kTimed; of these, in the crossing test
  Neighbourhood::Counts near;
  FrontCounts& operator+=(const FrontCounts& other);
};

/// @brief Takes faces of the front one by one and puts tets on them (F6-F10), within a slab.
class FrontWorker {
 public:
  enum class Result : std::uint8_t {
    done,
    gone,      ///< the face is not there any more
    deferred,  ///< what is near it reaches out of the slab
    failed,    ///< no tet that is good enough fits over it
  };

  FrontWorker(FrontStore& front, const FrontSettings& settings, const FrontSlab& slab)
      : front_(front), c_(front.complex()), set_(settings), slab_(slab), near_(front) {}

  const FrontSlab& slab() const { return slab_; }

  /// @brief Faces of the front that may lie near those to come; some that are gone.
  BoxOctree tree;
  FrontStock stock;
  std::vector<std::uint32_t> made;  ///< new faces
  FrontCounts counts;

  Result advance(std::uint32_t f);
  void add_to_tree(std::uint32_t f);
  /// @brief How far from its corners a step may look.
  double reach_of_step(std::uint32_t f) const;

 private:
  struct Candidate {
    double score;
    std::uint32_t point;  ///< in the neighbourhood; kNoIndex for a new point
    Point place;          ///< new point, in space
  };

  void measure(std::uint32_t f);
  bool is_needle() const;
  Result choose(std::uint32_t f);
  bool gather(std::uint32_t f);
  bool gather_ring(std::uint32_t f);
  bool gather_round(const Point& apex);
  void gather_obstacles(const Box& box);
  void add_candidates();
  void add_new_points();
  Box box_with(const Point& low, const Point& high) const;
  Result try_new_point(std::uint32_t f, const Candidate& candidate);
  Result try_point(std::uint32_t f, const Candidate& candidate);
  bool is_roomy(std::size_t place, double size) const;
  Neighbourhood::Verdict test(std::size_t apex);
  void add_tet(std::uint32_t f, VertexIndex d);
  double quality(const Point& apex) const;

  FrontStore& front_;
  TetComplex& c_;
  const FrontSettings set_;
  const FrontSlab slab_;
  Neighbourhood near_;
  bool is_timed_ = false;
  Point place_[3];                               ///< corners of the face, in space
  Point corner_[3], centroid_, normal_, ideal_;  ///< in its frame, as all lengths are
  double edge_ = 0, wanted_ = 0;                 ///< mean edge, wanted edge
  double area_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<std::uint32_t> taken_in_;  ///< faces, in local steps
  bool is_local_ = false;
};

}  // namespace delfront
