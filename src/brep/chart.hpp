// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "brep/plane_map.hpp"
#include "delfront/brep.hpp"

namespace delfront {

/// @brief A rising function by straight pieces over equal steps, and its inverse; goes on straight beyond its ends.
class RisingTable {
 public:
  RisingTable() = default;
  /// @param values  rising, at first + i * step; almost straight ones become one piece
  RisingTable(double first, double step, std::vector<double> values);
  double at(double x) const;
  struct Inverse {
    double x, slope;  ///< dx / dy
  };
  Inverse inverse(double y) const;

 private:
  double first_ = 0, step_ = 1;
  std::vector<double> values_;
};

/// @brief A plane with the parts of a face that have a mild metric there: lengths and angles are about those in space.
///
/// linear: u and v, each stretched to the mean length along it. polar: round a degenerate side, which is the origin;
/// the angle is that parameter along it, the radius such that the metric of a surface of revolution is the same
/// multiple in both directions everywhere but for a constant: on a sphere the stereographic projection; a cone is
/// unrolled. flat: straight down to a plane. All keep the orientation of (u, v), and are about 1 wide.
class Chart {
 public:
  enum class Pole : std::uint8_t { none, u_low, u_high, v_low, v_high };

  /// @param box  of what is to be mapped; finite
  Chart(const SmoothSurface& surface, const ParameterBox& box, Pole pole);

  /// @brief Flat.
  Chart(const SmoothSurface& surface, std::shared_ptr<const PlaneMap> plane)
      : surface_(surface), pole_(Pole::none), plane_(std::move(plane)) {}

  bool is_polar() const { return pole_ != Pole::none; }
  Point2 to_chart(Point2 uv) const;
  Point2 to_uv(Point2 xy) const;

  struct Place {
    Point2 uv;
    Point at, x, y;  ///< tangents along the chart's axes
  };
  /// @brief At the origin of a polar chart the tangents are those a little beside it.
  Place place(Point2 xy) const;
  const SmoothSurface& surface() const { return surface_; }

  /// @brief Ratio of the greatest to the least length in space over all directions of the chart.
  static double stretch(const Place& place);

 private:
  void make_linear(const ParameterBox& box);
  void make_polar(const ParameterBox& box);
  bool is_radial_v() const { return pole_ == Pole::v_low || pole_ == Pole::v_high; }
  bool is_low() const { return pole_ == Pole::u_low || pole_ == Pole::v_low; }
  Point2 uv_of(double angular, double radial) const {
    return is_radial_v() ? Point2{angular, radial} : Point2{radial, angular};
  }

  const SmoothSurface& surface_;
  Pole pole_;
  std::shared_ptr<const PlaneMap> plane_;  ///< flat; else null
  RisingTable u_, v_;                      ///< linear
  RisingTable radius_;                     ///< polar: by the distance of the radial parameter from the pole's
  double pole_at_ = 0;                     ///< the radial parameter there
  double middle_ = 0;                      ///< angular parameter at angle 0
  double angle_ = 1;                       ///< radians a unit of it, with the sign that keeps orientation
  double smallest_ = 0;                    ///< radius that counts as the origin
};

}  // namespace delfront
