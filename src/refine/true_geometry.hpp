// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "spatial/bvh.hpp"

namespace delfront {

/// @brief The model as the place where new boundary points of a grid belong: which of its triangles and feature edges
/// are meant by which of the grid's groups, and what lies nearest.
///
/// A place counts only where it runs like the grid does there: a triangle's normal, or an edge's direction, within 60
/// degrees of what is asked for, whichever way round, so that the far side of a thin body is rarely taken for the near
/// one. Queries are const and may run from several threads.
class TrueGeometry {
 public:
  /// @param model  stays
  TrueGeometry(const Model& model, const Array<GroupId, Group>& groups, double feature_angle_deg);

  using Hit = TriangleTree::Hit;
  /// @brief The nearest place of the triangles that any of these groups of faces means, within `reach`.
  Hit nearest_on_surface(Point p, Point normal, std::span<const GroupId> groups, double reach) const;
  /// @brief The nearest place of the feature edges and curves, within `reach`.
  /// @param curve  a group of lines: of the curves of its name, where there are some; may be invalid
  Hit nearest_on_features(Point p, Point direction, GroupId curve, double reach) const;
  /// @brief The nearest place of all triangles, in the plane of all curves, whatever they are called and however they
  /// run, within `reach`.
  Hit nearest(Point p, double reach) const;
  /// @return whether p lies on some feature edge or curve, within `tolerance`
  bool is_on_feature(Point p, double tolerance) const;
  /// @return false where the group's faces are not in the model, so that their points must not be moved
  bool is_known(GroupId group) const;

  double cos_feature_angle() const { return cos_feature_angle_; }
  /// @brief Groups of faces (in the plane of lines) that the model has no patch (curve) for, where it has for others.
  const std::vector<std::string>& unknown_groups() const { return unknown_groups_; }

 private:
  void match_groups(const Array<GroupId, Group>& groups);
  void add_triangles();
  void add_features();

  const Model& model_;
  double cos_feature_angle_;
  bool is_plane_ = false;                 ///< curves stand for patches
  bool has_names_ = false;                ///< some group is called like a patch: names are taken at their word
  std::vector<std::vector<bool>> named_;  ///< by group: the patches (or curves) called like it; empty: none
  std::vector<bool> is_outer_;            ///< by group: far field, symmetry, …: never put on what is called otherwise
  std::vector<std::string> unknown_groups_;
  TriangleTree triangles_, features_;  ///< features: triangles whose last two corners coincide
  std::vector<Point> normals_, directions_;
  std::vector<std::uint32_t> curve_of_feature_;  ///< or kNone: an edge of triangles
};

}  // namespace delfront
