// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>

#include "delfront/brep_shapes.hpp"

namespace delfront {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTurn = 2 * std::numbers::pi;

/// Surfaces given in a frame of their own: they turn what they find into space.
class InFrame : public SmoothSurface {
 public:
  explicit InFrame(const SpaceFrame& frame) : frame_(frame) {}
  SurfaceDerivatives derivatives(Point2 uv) const final {
    const SurfaceDerivatives s = local(uv);
    return {frame_.to_space(s.at), frame_.turn(s.u),  frame_.turn(s.v),
            frame_.turn(s.uu),     frame_.turn(s.uv), frame_.turn(s.vv)};
  }
  SurfaceTangents tangents(Point2 uv) const final {
    const SurfaceDerivatives s = local(uv);
    return {frame_.to_space(s.at), frame_.turn(s.u), frame_.turn(s.v)};
  }
  Point at(Point2 uv) const final { return frame_.to_space(local(uv).at); }

 protected:
  virtual SurfaceDerivatives local(Point2 uv) const = 0;

 private:
  SpaceFrame frame_;
};

class PlaneSurface final : public InFrame {
 public:
  using InFrame::InFrame;
  ParameterBox box() const override { return {{-kInfinite, -kInfinite}, {kInfinite, kInfinite}}; }

 private:
  SurfaceDerivatives local(Point2 uv) const override { return {{uv.x, uv.y, 0}, {1, 0, 0}, {0, 1, 0}, {}, {}, {}}; }
};

class CylinderSurface final : public InFrame {
 public:
  CylinderSurface(const SpaceFrame& frame, double radius) : InFrame(frame), r_(radius) {}
  ParameterBox box() const override { return {{0, -kInfinite}, {kTurn, kInfinite}}; }
  std::array<double, 2> period() const override { return {kTurn, 0}; }

 private:
  SurfaceDerivatives local(Point2 uv) const override {
    const double c = r_ * std::cos(uv.x), s = r_ * std::sin(uv.x);
    return {{c, s, uv.y}, {-s, c, 0}, {0, 0, 1}, {-c, -s, 0}, {}, {}};
  }
  double r_;
};

class ConeSurface final : public InFrame {
 public:
  ConeSurface(const SpaceFrame& frame, double half_angle)
      : InFrame(frame), out_(std::sin(half_angle)), up_(std::cos(half_angle)) {}
  ParameterBox box() const override { return {{0, 0}, {kTurn, kInfinite}}; }
  std::array<double, 2> period() const override { return {kTurn, 0}; }
  DegenerateSides degenerate_sides() const override { return {.v_low = true}; }

 private:
  SurfaceDerivatives local(Point2 uv) const override {
    const double c = out_ * std::cos(uv.x), s = out_ * std::sin(uv.x), v = uv.y;
    return {{v * c, v * s, v * up_}, {-v * s, v * c, 0}, {c, s, up_}, {-v * c, -v * s, 0}, {-s, c, 0}, {}};
  }
  double out_, up_;
};

class SphereSurface final : public InFrame {
 public:
  SphereSurface(const SpaceFrame& frame, double radius) : InFrame(frame), r_(radius) {}
  ParameterBox box() const override { return {{0, -0.25 * kTurn}, {kTurn, 0.25 * kTurn}}; }
  std::array<double, 2> period() const override { return {kTurn, 0}; }
  DegenerateSides degenerate_sides() const override { return {.v_low = true, .v_high = true}; }

 private:
  SurfaceDerivatives local(Point2 uv) const override {
    const double cu = std::cos(uv.x), su = std::sin(uv.x), c = r_ * std::cos(uv.y), s = r_ * std::sin(uv.y);
    return {{c * cu, c * su, s},   {-c * su, c * cu, 0}, {-s * cu, -s * su, c},
            {-c * cu, -c * su, 0}, {s * su, -s * cu, 0}, {-c * cu, -c * su, -s}};
  }
  double r_;
};

class TorusSurface final : public InFrame {
 public:
  TorusSurface(const SpaceFrame& frame, double radius, double tube) : InFrame(frame), r_(radius), tube_(tube) {}
  ParameterBox box() const override { return {{0, 0}, {kTurn, kTurn}}; }
  std::array<double, 2> period() const override { return {kTurn, kTurn}; }

 private:
  SurfaceDerivatives local(Point2 uv) const override {
    const double cu = std::cos(uv.x), su = std::sin(uv.x), c = tube_ * std::cos(uv.y), s = tube_ * std::sin(uv.y);
    const double r = r_ + c;
    return {{r * cu, r * su, s},   {-r * su, r * cu, 0}, {-s * cu, -s * su, c},
            {-r * cu, -r * su, 0}, {s * su, -s * cu, 0}, {-c * cu, -c * su, -s}};
  }
  double r_, tube_;
};

class BicubicSurface final : public SmoothSurface {
 public:
  explicit BicubicSurface(const std::array<std::array<Point, 4>, 4>& control) : b_(control) {
    sides_.u_low = is_point(b_[0][0], b_[0][1], b_[0][2], b_[0][3]);
    sides_.u_high = is_point(b_[3][0], b_[3][1], b_[3][2], b_[3][3]);
    sides_.v_low = is_point(b_[0][0], b_[1][0], b_[2][0], b_[3][0]);
    sides_.v_high = is_point(b_[0][3], b_[1][3], b_[2][3], b_[3][3]);
  }
  ParameterBox box() const override { return {{0, 0}, {1, 1}}; }
  DegenerateSides degenerate_sides() const override { return sides_; }
  SurfaceDerivatives derivatives(Point2 uv) const override {
    const Weights fu(uv.x), fv(uv.y);
    SurfaceDerivatives s;
    for (std::size_t i = 0; i < 4; ++i) {
      Point value, first, second;
      for (std::size_t j = 0; j < 4; ++j) {
        value = value + fv.value[j] * b_[i][j];
        first = first + fv.first[j] * b_[i][j];
        second = second + fv.second[j] * b_[i][j];
      }
      s.at = s.at + fu.value[i] * value;
      s.u = s.u + fu.first[i] * value;
      s.v = s.v + fu.value[i] * first;
      s.uu = s.uu + fu.second[i] * value;
      s.uv = s.uv + fu.first[i] * first;
      s.vv = s.vv + fu.value[i] * second;
    }
    return s;
  }
  SurfaceTangents tangents(Point2 uv) const override {
    const Weights fu(uv.x), fv(uv.y);
    SurfaceTangents s;
    for (std::size_t i = 0; i < 4; ++i) {
      Point value, first;
      for (std::size_t j = 0; j < 4; ++j) {
        value = value + fv.value[j] * b_[i][j];
        first = first + fv.first[j] * b_[i][j];
      }
      s.at = s.at + fu.value[i] * value;
      s.u = s.u + fu.first[i] * value;
      s.v = s.v + fu.value[i] * first;
    }
    return s;
  }

 private:
  struct Weights {  // Bernstein polynomials of degree 3 and their derivatives
    explicit Weights(double t) {
      const double s = 1 - t;
      value = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
      first = {-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t};
      second = {6 * s, 6 * (t - 2 * s), 6 * (s - 2 * t), 6 * t};
    }
    std::array<double, 4> value, first, second;
  };
  static bool is_point(Point a, Point b, Point c, Point d) { return a == b && b == c && c == d; }
  std::array<std::array<Point, 4>, 4> b_;
  DegenerateSides sides_;
};

}  // namespace

SurfacePointer make_plane_surface(const SpaceFrame& frame) { return std::make_shared<PlaneSurface>(frame); }
SurfacePointer make_cylinder_surface(const SpaceFrame& frame, double radius) {
  return std::make_shared<CylinderSurface>(frame, radius);
}
SurfacePointer make_cone_surface(const SpaceFrame& frame, double half_angle) {
  return std::make_shared<ConeSurface>(frame, half_angle);
}
SurfacePointer make_sphere_surface(const SpaceFrame& frame, double radius) {
  return std::make_shared<SphereSurface>(frame, radius);
}
SurfacePointer make_torus_surface(const SpaceFrame& frame, double radius, double tube) {
  return std::make_shared<TorusSurface>(frame, radius, tube);
}
SurfacePointer make_bicubic_surface(const std::array<std::array<Point, 4>, 4>& control) {
  return std::make_shared<BicubicSurface>(control);
}

}  // namespace delfront
