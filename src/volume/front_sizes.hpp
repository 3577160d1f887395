// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "delfront/size_field.hpp"
#include "tetra/tet_complex.hpp"
#include "volume/front_frame.hpp"

namespace delfront {

/// @brief What is wanted at the vertices of a front (F5): a length each, in the complex, and where the field has
/// directions also the root of its metric; the length is the mean over these then.
class FrontSizes {
 public:
  /// @brief Asks for what is not there yet: sizes of embedded points, and directions.
  /// @param field  null: there are none
  FrontSizes(TetComplex& complex, const SizeField* field);

  bool are_stretched() const { return is_stretched_; }
  /// @brief For all vertices of the complex.
  void make_room() {
    if (is_stretched_) root_.resize(c_.num_vertices());
  }
  /// @brief Ask the field at a vertex that has its place. @pre there is a field
  void ask(VertexIndex v);
  /// @brief As three vertices see space, about their middle.
  FrontFrame frame(const std::array<VertexIndex, 3>& nodes) const;

 private:
  TetComplex& c_;
  const SizeField* field_;
  bool is_stretched_;
  std::vector<Symmetric3> root_;  ///< by vertex
};

}  // namespace delfront
