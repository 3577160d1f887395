// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "delfront/background.hpp"
#include "delfront/context.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief The largest size that a point of size delta1 allows at distance s; both rise with slope (c - 1) / c.
enum class PointRule : std::uint8_t {
  slope,  ///< delta1 + s (c - 1) / c: points whose sizes come from the field lower nothing
  /// max(delta1, (s (c - 1) + delta1) / c), up to c times less (eq. 3.17): for points whose sizes come from elsewhere.
  /// Fed with points of its own sizes again and again, it lowers them each time.
  sequence,
};

struct AdaptiveBackgroundOptions {
  double growth = 1.2;  ///< c_i > 1
  PointRule rule = PointRule::slope;
  double refine_above = 1.5;  ///< c_f > 1: a cell is refined whose least size is more than this times a point's in it
  std::size_t max_cells = 5'000'000;  ///< refinement stops before it makes more
};

/// @brief What one call of adapt() did.
struct AdaptReport {
  std::size_t nodes_lowered = 0;   ///< of those there were before
  std::size_t cells_refined = 0;   ///< one into eight (in the plane four)
  std::size_t points_outside = 0;  ///< they lower sizes, but refine nothing
  std::size_t rounds = 0;
  bool is_converged = true;  ///< false where max_cells stopped it
};

/// @brief A background grid that follows the sizes of generated points (S8).
///
/// adapt() lowers the size of every node to what the points allow there (PointRule); refines each cell whose least size
/// is then more than refine_above times the size of a point in it; and repeats both until no cell is. Values of new
/// nodes are linear. Sizes are never raised, and the same points again change nothing.
///
/// Cells are split into eight (triangles: four). Their neighbours are closed by halves and quarters, which are taken
/// back before they would be split themselves, so that angles do not get worse from round to round.
/// @par Source  Löhner (2008), eq. 3.16 to 3.19; closure: Löhner, Baum (1992), Bank, Sherman, Weiser (1983)
class AdaptiveBackground {
 public:
  /// @brief Cubes of six tetrahedra over the box (where z is flat: squares of two triangles), about `cells` along its
  /// longest side, all of this size.
  /// @throws UsageError  an empty box, cells < 1, a size that is not positive
  AdaptiveBackground(const Box& box, std::size_t cells, double size, Context& context);
  /// @brief From a grid with node sizes (no metrics).
  /// @throws InputError, UsageError  as build_background_size_field; faces with more than two cells
  AdaptiveBackground(const BackgroundGrid& grid, Context& context);
  ~AdaptiveBackground();
  AdaptiveBackground(AdaptiveBackground&&) noexcept;
  AdaptiveBackground& operator=(AdaptiveBackground&&) noexcept;

  /// @param size  one a point, > 0
  /// @throws UsageError, InputError  options out of range, sizes not positive (point and place are named)
  /// @par Cost  O((nodes + points) log points) a round
  AdaptReport adapt(std::span<const Point> points, std::span<const double> size,
                    const AdaptiveBackgroundOptions& options, Context& context);

  /// @brief The grid as it is now: conforming, with its boundary stored, node field "size".
  BackgroundGrid grid(Context& context) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace delfront
