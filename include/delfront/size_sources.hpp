// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/metric.hpp"
#include "delfront/point.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Size as a function of the distance r from a source; rho = max(0, (r - r0) / r1).
/// @par Source  Löhner (2008), eq. 3.10 to 3.13
struct SizeLaw {
  enum class Kind : std::uint8_t {
    step,         ///< delta0 for r <= r0, no bound beyond it
    power,        ///< delta0 (1 + rho^gamma)
    exponential,  ///< delta0 e^(gamma rho)
    polynomial,   ///< delta0 (1 + sum a_i rho^i), i from 1
  };
  Kind kind = Kind::power;
  double delta0 = 1;               ///< > 0
  double r0 = 0;                   ///< >= 0, within it the size is delta0
  double r1 = 1;                   ///< > 0, scaling length
  double gamma = 1;                ///< > 0
  std::vector<double> polynomial;  ///< a_1, a_2, …; the law must not decrease

  double size_at(double r) const;
};

/// @throws UsageError  what is wrong with the law: r1 = 0, r0 < 0, delta0 <= 0, a law that decreases (and where), …
void check_law(const SizeLaw& law);

/// @brief Point, line or triangle; a degenerate one is a legal smaller one, with exact distances (eq. 3.1 to 3.9).
struct Simplex {
  std::array<Point, 3> corner;
  int num_corners = 1;
};
struct AlignedBox {
  Box box;
};
struct Ball {
  Point centre;
  double radius = 0;
};
/// @brief Cylinder or frustum of a cone with flat ends; radius 0 at one end: a cone.
struct Frustum {
  Point from, to;
  double radius_from = 0, radius_to = 0;
};

/// @brief What a source is: distance 0 on it and, for solids, inside it.
using SourceShape = std::variant<Simplex, AlignedBox, Ball, Frustum>;

/// @return exact distance to rounding
double distance_to(const SourceShape& shape, Point at);

/// @brief Where a body is at a time: turned about an axis through `centre` by rate * time, then moved by velocity *
/// time.
struct Motion {
  Point velocity;           ///< model units a time unit
  Point centre, axis;       ///< axis of any length; zero: no turning
  double degrees_rate = 0;  ///< degrees a time unit, right-handed about the axis
};

struct SizeSource {
  SourceShape shape;
  SizeLaw law;
  std::optional<Stretching> stretching;  ///< constant in space; the law is that of delta
  std::optional<Motion> motion;
  std::string group;  ///< name for messages and for switching on and off
};

struct SourceFieldOptions {
  /// Sizes rise with the distance from any place by at most (growth - 1) / growth: laws that rise faster are cut to
  /// that (neighbours then keep the growth). Infinity: laws as they are.
  double growth = std::numeric_limits<double>::infinity();
  double time = 0;  ///< for sources that move
};

/// @brief The minimum over any number of sources (S3, S4, S5; eq. 3.14), exact, at a cost that grows like the logarithm
/// of their number. Metrics: the intersection of those of the sources with stretchings, and of the minimum of the rest.
/// @throws UsageError  no source, or a bad one (its number and group are named)
/// @par Cost  O(n log n) to build, about O(log n) a point, best in space-filling-curve order
std::unique_ptr<SizeField> build_source_size_field(std::vector<SizeSource> sources, const SourceFieldOptions& options,
                                                   Context& context);

}  // namespace delfront
