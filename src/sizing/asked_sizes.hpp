// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "delfront/mesh.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Where neither growth nor accuracy is asked for.
inline constexpr double kDefaultGrowth = 1.2;

/// @return options.growth, else that of options.accuracy
double growth_asked(const SizeOptions& options);

/// @return the growth that the boundary's sizes keep, with options.steeper: then of a slope of at most 1/2
double growth_of_boundary(const SizeOptions& options);

/// @brief The growth whose slope (c - 1) / c is so many times that of the given one: at most 1/2, or the given one's.
double steeper_growth(double growth, double times);

/// @return the largest size of any boundary point, 0 without points
double largest_size(const BoundarySizes& boundary);

/// @brief Whether the options ask for sizes by a way that has an opinion everywhere: a formula, a grid, a solution, a
/// field of the program that calls.
bool has_field_everywhere(const SizeOptions& options);

/// @brief Sizes from the boundary (S1), as the options ask for them.
///
/// Without options.growth it is kDefaultGrowth, and no size exceeds `largest`, or hmin where that is more, unless
/// has_field_everywhere.
/// @param boundary  points and sizes; the rest of it is set from the options
/// @param options   lengths in model units
/// @param largest   of the boundary as it was given
std::unique_ptr<SizeField> build_asked_size_field(BoundarySizes boundary, const SizeOptions& options, double largest,
                                                  Context& context);

/// @brief Edges of a boundary that is kept and that are much longer than the sizes asked for there.
struct LongEdges {
  std::size_t count = 0;
  double length = 0, size = 0;  ///< of the worst
  Point at;                     ///< its middle
};

/// @param asked  null: options.hmax alone
LongEdges find_long_edges(std::span<const std::array<Point, 2>> edges, const SizeOptions& options,
                          const SizeField* asked, const Context& context);

/// @brief The wanted sizes at the points of a grid, as its field "h"; of stretched ones also the tensors "metric".
void add_size_field(Mesh& mesh, const SizeField& size, const Context& context);

/// @brief The lesser of both, clamped to the options' hmin and hmax.
std::shared_ptr<const SizeField> combine_with_asked(std::shared_ptr<const SizeField> of_boundary,
                                                    std::shared_ptr<const SizeField> asked, const SizeOptions& options);

}  // namespace delfront
