// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/point.hpp"
#include "tetra/tet_complex.hpp"
#include "volume/front_store.hpp"

namespace delfront {

/// @brief The faces of the front near one of them, and the edges and points that lie in the way (FrontObstacles),
/// copied into small arrays, and the test whether a tet over that face crosses any of them (F12).
///
/// Three layers, each about ten times as dear as the one before: faces whose box lies apart are not taken in at all;
/// faces whose corners all lie outside of one side of the tet (shape functions below 0); what is left is decided by
/// exact signs, corners in common by their numbers.
/// @par Source  Löhner (2008), eq. 3.23 to 3.29
class Neighbourhood {
 public:
  struct Counts {
    std::uint64_t faces = 0;        ///< taken in
    std::uint64_t points = 0;       ///< taken in
    std::uint64_t tests = 0;        ///< tets tested
    std::uint64_t plane_tests = 0;  ///< faces not told apart by a side of the tet
    std::uint64_t exact_tests = 0;  ///< pairs of faces that were intersected exactly
  };

  explicit Neighbourhood(FrontStore& front) : front_(front), c_(front.complex()) { table_.resize(kSmallTable); }

  /// @brief Start anew round a face, whose corners get the numbers 0, 1, 2.
  void start(std::uint32_t f);
  /// @brief Take a face in (once each).
  void add_face(std::uint32_t f);
  /// @brief Take an embedded edge or point in (once each).
  void add_obstacle(const FrontObstacle& obstacle);
  bool has_obstacle(const FrontObstacle& obstacle) const;

  std::size_t num_points() const { return id_.size(); }
  std::size_t num_faces() const { return faces_.size(); }
  VertexIndex id(std::size_t p) const { return id_[p]; }
  /// @brief Relative to the origin: the centroid of the face.
  Point at(std::size_t p) const { return {x_[p], y_[p], z_[p]}; }
  /// @brief Height over the plane of the face.
  double height(std::size_t p) const { return height_[p]; }
  Point origin() const { return origin_; }
  Point normal() const { return normal_; }
  /// @brief Coordinates, heights and distances here are those of the face's frame; what is decided is decided in space.
  const FrontFrame& frame() const { return frame_; }

  /// @brief A place where there is no point yet, as the last one; drop_place() takes it away.
  std::size_t add_place(Point absolute);
  void drop_place();

  /// @brief How far the wedge between the face and the one next to it over each of its sides is open for a tet to a
  /// place: squared sine of what the tet would leave of the narrowest (1 for more than a right angle, and where that
  /// side is closed), negative where the tet would be in the way of a neighbour for sure (F14).
  double measure_wedges(std::size_t apex) const;

  enum class Verdict : std::uint8_t { free, crosses, too_close };
  /// @brief Whether the tet of the face and point `apex` meets the front in common corners, edges and faces alone
  /// (exact), with no other point nearer than about `clearance` (not exact: a preference).
  /// @param widest_cosine  no angle between a new face and one that is there has a larger cosine (near-miss rule, a
  /// preference too); 1: any angle will do
  Verdict test(std::size_t apex, double clearance, double widest_cosine);

  /// @brief How far a place is from the nearest point and, over faces, from these; both in no way exact.
  double distance_to_points(std::size_t place) const;
  double distance_to_faces(std::size_t place) const;
  double distance_to_edges(std::size_t place) const;

  Counts counts;

 private:
  static constexpr std::size_t kSmallTable = 512;
  struct Slot {
    VertexIndex id = kNoIndex;
    std::uint32_t index = 0;
    std::uint64_t step = 0;
  };
  struct Plane {
    Point normal;
    double offset = 0, bound = 0, length = 0;
  };

  struct Face {
    std::array<std::uint32_t, 3> corner;
  };
  struct Edge {
    std::uint32_t a, b;  ///< the same for a lone point
  };
  /// The wedge at a side of the face: directions across it, inwards and up, and where the neighbour's apex lies.
  struct Wedge {
    Point middle, inwards;
    double cosine, sine;  ///< of the angle to the neighbour
    std::uint32_t apex;   ///< of the neighbour
    bool is_there = false;
  };
  void add_wedge(const Face& face);
  bool leaves_narrow_wedge(const Face& face, std::size_t apex, double widest_cosine) const;
  std::uint32_t local(VertexIndex v);
  void grow_table();
  std::size_t slot_of(VertexIndex v) const { return (v * 0x9e3779b97f4a7c15ull >> 32) & (table_.size() - 1); }
  Plane plane_through(std::size_t a, std::size_t b, std::size_t c) const;
  Verdict mark_points(std::size_t apex, const std::array<Plane, 3>& planes, double clearance);
  bool crosses(const Face& face, std::size_t apex);
  bool is_apart_by_its_plane(const Face& face, const std::array<std::uint32_t, 4>& node) const;
  bool has_corner_inside(const Face& face, const std::array<std::uint32_t, 4>& node) const;
  bool meets_new_faces(const Face& face, const std::array<std::uint32_t, 4>& node);
  Verdict test_obstacles(std::size_t apex, const std::array<Plane, 3>& planes, double clearance);
  bool is_too_close(const Edge& edge, std::size_t apex, const std::array<Plane, 3>& planes, double clearance) const;
  Point place(std::size_t p) const { return exact_[p]; }

  FrontStore& front_;
  const TetComplex& c_;
  FrontFrame frame_;
  double bound_ = 0;  ///< of roundings of heights
  Point origin_, normal_;
  Plane base_;
  std::uint64_t step_ = 0;
  std::vector<Slot> table_;
  std::vector<VertexIndex> id_;
  std::vector<double> x_, y_, z_, height_, norm_;
  std::vector<Point> exact_;
  std::vector<std::uint8_t> outside_;  ///< by point: bit i where it is known to lie beyond side i of the tet
  std::vector<std::uint8_t> inside_;   ///< bit i where it is known to lie within side i
  std::vector<Face> faces_;
  std::vector<Edge> edges_;  ///< obstacles
  std::array<Wedge, 3> wedge_;
};

}  // namespace delfront
