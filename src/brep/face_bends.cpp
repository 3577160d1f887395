// SPDX-License-Identifier: Apache-2.0
#include "brep/face_bends.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace delfront {
namespace {

constexpr int kPieces = 64;                            ///< of a line, before it is halved where normals turn
constexpr int kMostHalvings = 7;                       ///< of a piece
constexpr double kTurn = 15 * std::numbers::pi / 180;  ///< of normals over a piece: beyond, it is halved
constexpr double kLineDistance = 2;                    ///< between lines, of the least size found on one
constexpr double kFewestLines = 32, kMostLines = 1000;
constexpr double kLowerShare = 0.8;  ///< of the asked size: what is not less is not noted

struct Place {
  Point2 uv;
  Point normal;
};

class BendFinder {
 public:
  BendFinder(const SmoothSurface& surface, const ParameterBox& box, const WantedSize& wanted, BoundarySizes& found)
      : surface_(surface), box_(box), wanted_(wanted), found_(found) {}

  /// Lines along u (or along v), from one end of the box to the other.
  void run(bool along_u) {
    along_u_ = along_u;
    const double low = along_u ? box_.low.y : box_.low.x, range = (along_u ? box_.high.y : box_.high.x) - low;
    for (double at = 0; at <= 1;) {
      scan(low + at * range);
      at += std::clamp(kLineDistance * least_of_line_ / std::max(range, 1e-300), 1 / kMostLines, 1 / kFewestLines);
    }
  }

 private:
  Point2 uv(double line, double along) const {
    const Point2 low = box_.low, high = box_.high;
    return along_u_ ? Point2{low.x + along * (high.x - low.x), line} : Point2{line, low.y + along * (high.y - low.y)};
  }
  Place place(double line, double along) const {
    const Point2 at = uv(line, along);
    return {at, surface_.normal(at)};
  }

  void scan(double line) {
    at_.clear();
    curvature_.clear();
    least_of_line_ = 1e300;
    Place before = place(line, 0);
    for (int i = 1; i <= kPieces; ++i) {
      const Place next = place(line, double(i) / kPieces);
      halve(line, double(i - 1) / kPieces, before, double(i) / kPieces, next, 0);
      before = next;
    }
    note();
  }

  void halve(double line, double from, const Place& a, double to, const Place& b, int depth) {
    const double middle = 0.5 * (from + to);
    if (depth < kMostHalvings && dot(a.normal, b.normal) < std::cos(kTurn)) {
      const Place c = place(line, middle);
      halve(line, from, a, middle, c, depth + 1);
      halve(line, middle, c, to, b, depth + 1);
      return;
    }
    const SurfaceDerivatives s = surface_.derivatives(uv(line, middle));
    at_.push_back(s.at);
    curvature_.push_back(largest_curvature(s));
    across_.push_back(length(along_u_ ? s.v : s.u));
  }

  void note() {
    std::vector<double> asked(at_.size());
    wanted_.asked().sizes(at_, asked);
    for (std::size_t i = 0; i < at_.size(); ++i) {
      const double size = wanted_.lowered(asked[i], curvature_[i], at_[i]);
      if (!(size < kLowerShare * asked[i])) continue;
      found_.points.push_back(at_[i]);
      found_.size.push_back(size);
      least_of_line_ = std::min(least_of_line_, size / std::max(across_[i], 1e-300));
    }
    across_.clear();
  }

  const SmoothSurface& surface_;
  const ParameterBox& box_;
  const WantedSize& wanted_;
  BoundarySizes& found_;
  bool along_u_ = true;
  double least_of_line_ = 0;  ///< in the parameter that goes across lines
  std::vector<Point> at_;     ///< of the line, as the next two
  std::vector<double> curvature_, across_;
};

}  // namespace

void find_bends(const SmoothSurface& surface, const ParameterBox& box, const WantedSize& wanted, BoundarySizes& found) {
  BendFinder finder(surface, box, wanted, found);
  finder.run(true);
  finder.run(false);
}

}  // namespace delfront
