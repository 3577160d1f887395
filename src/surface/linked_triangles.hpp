// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace delfront {

/// @brief Triangles round a point and the points opposite, in order, anticlockwise. Where the border runs through the
/// point: from border to border, one point more than triangles.
struct TriangleRing {
  std::vector<std::uint32_t> triangles, points;
};

/// @brief Triangles that know their neighbours, and the edits of their connections; places are the business of others.
///
/// Side 3 t + k runs from corner k of triangle t to corner k + 1. Triangles that are gone have corners kNone.
class LinkedTriangles {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  using Triangle = std::array<std::uint32_t, 3>;

  /// @brief Take triangles of points 0 to num_points - 1, and join sides that run between the same points.
  /// @param open  sides that stay open though two triangles have them: lower point * 2^32 + higher, sorted
  /// @par Cost O(n)
  void link(std::vector<Triangle> triangles, std::size_t num_points, const std::vector<std::uint64_t>& open = {});

  static std::uint32_t next(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
  static std::uint32_t before(std::uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }

  std::size_t num_sides() const { return other_.size(); }
  std::size_t num_triangles() const { return triangles_.size(); }
  const Triangle& triangle(std::uint32_t t) const { return triangles_[t]; }
  bool is_gone(std::uint32_t t) const { return triangles_[t][0] == kNone; }
  /// @brief Where a side begins.
  std::uint32_t point(std::uint32_t side) const { return triangles_[side / 3][side % 3]; }
  /// @brief The same side of the triangle across; kNone at the border.
  std::uint32_t other(std::uint32_t side) const { return other_[side]; }
  /// @brief A side that begins at a point; kNone where nothing uses it.
  std::uint32_t side_at(std::uint32_t p) const { return side_at_[p]; }

  /// @brief Number of a further point, which no triangle uses yet.
  std::uint32_t add_point();
  /// @brief Side a b of triangles a b c and b a d becomes d c; there is a triangle across, c and d are not joined.
  void flip(std::uint32_t side);
  /// @brief Divide a side, and the triangles at it, at a point that nothing uses.
  void split(std::uint32_t side, std::uint32_t p);
  /// @brief Triangles with side v u go, the others at v get u. The caller has seen to it that no side comes twice.
  void collapse(std::uint32_t v, std::uint32_t u);

  /// @brief The triangles round an inner point. @return false at the border, or where there are over a hundred
  bool ring(std::uint32_t p, TriangleRing& found) const;
  /// @brief The triangles at a point; where the border touches itself in the point: one such part.
  void fan(std::uint32_t p, TriangleRing& found) const;

  /// @brief The triangles, those that are gone among them.
  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  void bond(std::uint32_t side, std::uint32_t other);
  void bond_points(std::uint32_t t);

  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> other_;    ///< by side
  std::vector<std::uint32_t> side_at_;  ///< by point
  TriangleRing round_;
  std::vector<std::uint32_t> touched_;
};

}  // namespace delfront
