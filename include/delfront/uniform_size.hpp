// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "delfront/size_field.hpp"

namespace delfront {

/// @brief The same size everywhere: for calls that take a size field, such as grid_brep().
class UniformSize : public SizeField {
 public:
  /// @param h  model units, > 0
  explicit UniformSize(double h) : h_(h) {}
  void sizes(std::span<const Point>, std::span<double> size) const override { std::fill(size.begin(), size.end(), h_); }
  double lower_bound(const Box&) const override { return h_; }
  double largest() const override { return h_; }

 private:
  double h_;
};

}  // namespace delfront
