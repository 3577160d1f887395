// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "delfront/size_field.hpp"
#include "spatial/box_octree.hpp"
#include "surface/support.hpp"

namespace delfront {

/// @brief A grid of one region: its border's points first, then new ones.
struct RegionGrid {
  std::vector<Point> points;
  std::vector<std::uint32_t> triangle_of_point;  ///< of the support: where a new point lies; kNoTriangle for the border
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::size_t num_border = 0;
  std::vector<std::uint64_t> border_sides;  ///< sorted; lower point * 2^32 + higher point
  std::size_t steps = 0;
  std::string gave_up;  ///< why the region is not whole; empty: it is
  Point gave_up_at;
};

/// @brief What a try at a side asks of its triangle; lengths in wanted sides.
struct SurfaceFrontSettings {
  double radius;     ///< of the search for points round the ideal one
  double quality;    ///< least mean ratio
  double clearance;  ///< between new sides and points that are not theirs
  double to_points;  ///< from a new point to others
  double agreement;  ///< least cosine between the triangle and the surface
  bool makes_points;
};

/// @brief An advancing front on the triangles of one region, directly in space (F5-F11).
///
/// The front is made of sides with the region to their left. Each in turn, the shortest first, gets a triangle with a
/// point of the front or a new one: the ideal place lies in the tangent plane at the middle of the side, and is put on
/// the support. What crosses is told in that plane, among sides whose normals agree.
class SurfaceFront {
 public:
  SurfaceFront(const SurfaceSupport& support, const SizeField& size) : support_(support), size_(size) {}

  /// @throws Cancelled, LimitError
  RegionGrid grid(const RegionBorder& border, const Context& context);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct FrontPoint {
    Point at, normal;
    double h;                     ///< wanted side
    std::uint32_t first = kNone;  ///< side at it, as 2 * side + end
    std::uint32_t foot = kNoTriangle;
    bool is_vague = false;
  };
  struct FrontSide {
    std::uint32_t node[2], next[2];
    Point normal;
    float length;
    std::uint8_t tries = 0;
    bool is_alive = true;
  };
  /// The plane at the middle of a side: u along it, v into the region.
  struct Plane {
    Point origin, u, v, n;
    std::array<double, 2> flat(Point p) const { return {dot(p - origin, u), dot(p - origin, v)}; }
    double height(Point p) const { return dot(p - origin, n); }
  };
  struct NearPoint {
    std::uint32_t point;
    double x, y;
  };
  struct NearSide {
    std::uint32_t a, b;  ///< in near_points_
  };
  struct Candidate {
    double score;
    std::uint32_t near;  ///< in near_points_; kNone: a new point
    std::array<double, 2> flat;
    Point at;
    SurfaceSupport::Foot foot;
  };

  // front.cpp: the store, the queue, the rounds
  void begin(const RegionBorder& border);
  void seed();
  void run(const Context& context);
  std::uint32_t add_point(Point at, Point normal, double h, std::uint32_t foot, bool is_vague);
  void add_side(std::uint32_t a, std::uint32_t b, Point normal);
  void remove_side(std::uint32_t s);
  std::uint32_t find_side(std::uint32_t a, std::uint32_t b) const;
  void add_triangle(std::uint32_t s, std::uint32_t c);
  void queue(std::uint32_t s);
  std::uint32_t next_side();
  void add_to_tree(std::uint32_t s);
  void rebuild_tree();
  RegionGrid finish();
  // front_step.cpp: one side
  bool advance(std::uint32_t s);
  void look_round(std::uint32_t s, double radius);
  std::uint32_t near_point(std::uint32_t point);
  void add_candidates(std::uint32_t s);
  void add_new_points(std::uint32_t s);
  void add_new_point(std::uint32_t s, double height, double bonus);
  bool is_free(std::uint32_t s, const Candidate& candidate) const;
  bool agrees(const Candidate& candidate) const;
  double quality(Point apex) const;
  Point normal_between(std::uint32_t a, std::uint32_t b, Point fallback) const;

  const SurfaceSupport& support_;
  const SizeField& size_;
  RegionGrid result_;
  std::vector<FrontPoint> points_;
  std::vector<FrontSide> sides_;
  std::size_t num_alive_ = 0, num_in_tree_ = 0;
  double shortest_ = 1;
  double area_ = 0;  ///< of the triangles made
  std::vector<std::vector<std::uint32_t>> bins_;
  std::vector<std::size_t> bin_begin_;
  std::size_t lowest_bin_ = 0;
  BoxOctree tree_;
  // of the step under way
  const SurfaceFrontSettings* set_ = nullptr;
  Plane plane_;
  Point a_, b_, ideal_;
  double half_ = 0, wanted_ = 0;
  SurfaceSupport::Foot ideal_foot_;
  std::vector<std::uint32_t> near_index_;  ///< by point: index in near_points_ ...
  std::vector<std::uint32_t> near_stamp_;  ///< ... if this is the step's
  std::uint32_t stamp_ = 0;
  std::vector<NearPoint> near_points_;
  std::vector<NearSide> near_sides_;
  std::vector<Candidate> candidates_;
};

}  // namespace delfront
