// SPDX-License-Identifier: Apache-2.0
#include "volume/front_sizes.hpp"

namespace delfront {

FrontSizes::FrontSizes(TetComplex& complex, const SizeField* field)
    : c_(complex), field_(field), is_stretched_(field != nullptr && !field->is_isotropic()) {
  if (field_ == nullptr) return;
  make_room();
  for (VertexIndex v = 0; v < c_.num_vertices(); ++v)
    if (c_.vertex_tet[v] != kNoIndex && c_.on_boundary[v] && (is_stretched_ || !(c_.vertex[v].h > 0))) ask(v);
}

void FrontSizes::ask(VertexIndex v) {
  const Point at = c_.point(v);
  if (!is_stretched_) {
    c_.vertex[v].h = field_->size(at);
    return;
  }
  Metric metric;
  field_->metrics({&at, 1}, {&metric, 1});
  root_[v] = root_of(metric);
  c_.vertex[v].h = mean_size(root_[v]);
}

FrontFrame FrontSizes::frame(const std::array<VertexIndex, 3>& n) const {
  if (!is_stretched_) return {};
  return {(1.0 / 3) * (c_.point(n[0]) + c_.point(n[1]) + c_.point(n[2])), root_[n[0]] + root_[n[1]] + root_[n[2]]};
}

}  // namespace delfront
