// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <utility>

#include "delfront/size_field.hpp"

namespace delfront::fixtures {

/// @brief A field of any two functions; the second must be a lower bound of the first.
class FunctionField : public SizeField {
 public:
  FunctionField(std::function<double(Point)> size, std::function<double(const Box&)> least)
      : size_(std::move(size)), least_(std::move(least)) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = size_(at[i]);
  }
  double lower_bound(const Box& box) const override { return least_(box); }

 private:
  std::function<double(Point)> size_;
  std::function<double(const Box&)> least_;
};

/// @brief h inside of the box, `outside` elsewhere: rises as steeply as can be.
inline FunctionField step_field(const Box& inside, double h, double outside) {
  return {[=](Point p) {
            return inside.overlaps({p, p}) ? h : outside;
          },
          [=](const Box& box) { return inside.overlaps(box) ? h : outside; }};
}

}  // namespace delfront::fixtures
