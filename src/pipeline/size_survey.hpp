// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "delfront/context.hpp"
#include "delfront/job.hpp"
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "delfront/size_field.hpp"
#include "pipeline/kept_domain.hpp"
#include "pipeline/prepare.hpp"

namespace delfront {

/// @brief Cells, points, memory and time that a grid of these sizes will take.
/// @par Source  cells of side h in a volume V: 6 sqrt(2) V / h^3 regular tetrahedra; in the plane 4 / sqrt(3) A / h^2
/// @param max_leaves  boxes that are looked at; with fewer sums are rougher, and sizes may be missed
/// @param growth      that the field keeps
Estimate estimate_grid(const KeptDomain& domain, const SizeField& size, double growth, Context& context,
                       std::size_t max_leaves = 500'000);

/// @brief What the pure front takes longer, a tet at a time.
void slow_down_to_front(Estimate& estimate, int threads);

/// @brief Before there is anything: cells up to hmax in so much space that are many times those that may be or can be
/// held.
/// @throws LimitError
void refuse_tiny_hmax(double volume, const Options& options, const Context& context);

/// @brief What an estimate becomes where every edge of the grid is then halved so many times.
void refine_estimate(Estimate& estimate, bool is_planar, int levels);

/// @brief Before the work: sizes that ask for many times the cells that may be or can be held.
/// @param prepared, options  of the coarse grid where there are levels
/// @throws LimitError
void refuse_too_many_cells(const Prepared& prepared, const SizeOptions& options, int levels, Context& context);
/// In the plane, where there is a limit of cells, and the boundary is as fine as the sizes.
void refuse_too_many_cells(const PlanarPrepared& prepared, const SizeOptions& options, int levels, Context& context);

/// @brief The same for the triangles of a smooth surface, from a first grid of it.
/// @param levels  halvings of every edge that come later
void refuse_too_many_triangles(const Model& look, const SizeField& size, int levels, Context& context);

/// @return the growth that the size field of a job keeps
double growth_of(const SizeOptions& options);

/// @brief The field on an octree over the kept regions (a quadtree in the plane): hexahedra with the field "h" at
/// points, to look at.
Mesh size_mesh(const KeptDomain& domain, const SizeField& size, double growth, Context& context);

}  // namespace delfront
