// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "delfront/brep.hpp"

namespace delfront {

/// @brief The sizes that a face is gridded with: those asked for, and less where a side of that length would turn too
/// much along the surface or an edge.
class WantedSize {
 public:
  /// @param most_turn  radians that a side may turn
  /// @param least      sizes are not lowered below it
  WantedSize(const SizeField& asked, double most_turn, double least = 0)
      : asked_(asked), most_turn_(most_turn), least_(least) {}

  const SizeField& asked() const { return asked_; }

  /// @brief Where surfaces come to a tip: bends are infinite there, sizes need not be nothing. And how large all is:
  /// what is sharper than that by far counts as a crease.
  void look_at(const Brep& brep);

  /// @brief From now on bends ask for no less than half of the least size asked for: surfaces that cross each other by
  /// little are seen to do so where sides are as short as that.
  /// @return whether they did ask for less
  bool forgo_fine_bends() {
    const bool is_new = least_ < coarse_least_;
    least_ = std::max(least_, coarse_least_);
    return is_new;
  }

  /// @brief What is left of an asked size where so much is bent.
  double lowered(double asked, double curvature, Point at) const {
    if (!(asked * curvature > most_turn_)) return asked;
    double allowed = std::max(most_turn_ / curvature, least_);
    for (const Tip& tip : tips_)
      allowed = std::max(allowed, kTipShare * std::max(distance(at, tip.at), std::min(kTipCells * asked, tip.least)));
    return std::min(asked, allowed);
  }

  /// @brief Whether a bend twice as strong would lower an asked size.
  bool is_nearly_lowered(double asked, double curvature) const { return 2 * asked * curvature > most_turn_; }

  /// @brief Whether lowered() says less than is asked for anywhere on a face, by samples in a box of parameters.
  bool is_lowered_on(const SmoothSurface& surface, const ParameterBox& box) const;

 private:
  void find_tips(const Brep& brep);
  static constexpr double kTipShare = 0.8;  ///< of the distance from a tip: allowed there at least
  static constexpr double kTipCells = 0.6;  ///< of the asked size, as that distance
  struct Tip {
    Point at;
    double least;  ///< a share of how far its face goes: no distance from it counts for less
  };
  const SizeField& asked_;
  double most_turn_;
  std::vector<Tip> tips_;
  double least_;             ///< no bend asks for less
  double coarse_least_ = 0;  ///< after forgo_fine_bends()
};

}  // namespace delfront
