// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "delfront/size_field.hpp"
#include "surface/parts.hpp"

namespace delfront {

/// @brief The sizes that a surface is gridded with: those asked for; less where the surface bends too much for them, or
/// where a grid with them failed.
class WorkingSize : public SizeField {
 public:
  static constexpr double kGuardShare = 0.25;  ///< what is asked for is lowered to this at most

  /// @param guard  sizes that the shape needs, null: none; they lower what is asked for to a quarter at most
  WorkingSize(const SizeField& asked, std::shared_ptr<const SizeField> guard)
      : asked_(asked), guard_(std::move(guard)) {}

  /// @brief Lower the size round places; it grows again with distance.
  void lower(const BoundarySizes& places, Context& context);

  void sizes(std::span<const Point> at, std::span<double> size) const override;
  double lower_bound(const Box& box) const override;

 private:
  const SizeField& asked_;
  std::shared_ptr<const SizeField> guard_;
  std::shared_ptr<const SizeField> lowered_;
};

/// @brief Sizes that the surface's bends need: so many sides round a circle. @return null where none are less than h
std::shared_ptr<const SizeField> build_bend_guard(const Model& model, const SizeField& asked, Context& context);

}  // namespace delfront
