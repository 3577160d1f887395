// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "brep/face_grid.hpp"

namespace delfront {

/// @brief The faces' grids as one model: corners, curves and patches of what the Brep has, each point's entity.
Model assemble_brep(const Brep& brep, const Array<EdgeId, EdgePoints>& edges, const Array<FaceId, FaceGrid>& grids,
                    std::size_t num_vertices, std::vector<VertexEntity>& entity,
                    std::vector<std::array<Point2, 3>>* corner_uv = nullptr);

}  // namespace delfront
