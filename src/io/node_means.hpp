// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief One value a node from values that cells give their corners: the mean; NaN for nodes without any.
class NodeMeans {
 public:
  NodeMeans(std::size_t num_nodes, int components)
      : components_(static_cast<std::size_t>(components)), count_(num_nodes, 0), sum_(num_nodes * components_, 0.0) {}

  /// @param values  `components` numbers
  void add(std::size_t node, const double* values) {
    const double before = static_cast<double>(count_[node]);
    for (std::size_t k = 0; k < components_; ++k) {
      double& sum = sum_[node * components_ + k];
      const double difference = std::abs(sum - before * values[k]);
      differ_ = differ_ || difference > kSame * (std::abs(sum) + before * std::abs(values[k]));
      sum += values[k];
    }
    ++count_[node];
  }
  /// @return whether some node got values that are not the same to rounding
  bool differ() const { return differ_; }

  Field take(std::string name) {
    for (std::size_t node = 0; node < count_.size(); ++node)
      for (std::size_t k = 0; k < components_; ++k) {
        double& value = sum_[node * components_ + k];
        value = count_[node] > 0 ? value / static_cast<double>(count_[node]) : std::numeric_limits<double>::quiet_NaN();
      }
    return {std::move(name), Field::On::vertices, CellType::vertex, static_cast<int>(components_), std::move(sum_)};
  }

 private:
  static constexpr double kSame = 1e-6;  // files hold six digits and more
  std::size_t components_;
  std::vector<std::uint32_t> count_;
  std::vector<double> sum_;
  bool differ_ = false;
};

}  // namespace delfront
