// SPDX-License-Identifier: Apache-2.0
#include "delfront/refine_grid.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "delfront/errors.hpp"
#include "delfront/findings.hpp"
#include "refine/boundary_points.hpp"
#include "refine/carry_fields.hpp"
#include "refine/cell_splitter.hpp"
#include "refine/keep_valid.hpp"
#include "refine/mid_points.hpp"
#include "refine/true_geometry.hpp"

namespace delfront {

namespace {

void check_options(const RefineGridOptions& options) {
  if (options.levels < 1)
    throw UsageError(fmt::format("levels = {}: a grid is refined at least once; give 1 or more", options.levels));
  if (!(options.feature_angle_deg >= 0 && options.feature_angle_deg <= 180))
    throw UsageError(fmt::format("feature angle {:g}: degrees from 0 to 180", options.feature_angle_deg));
  if (!(options.least_volume_share >= 0 && options.least_volume_share < 1))
    throw UsageError(fmt::format("least volume share {:g}: at least 0 and less than 1", options.least_volume_share));
}

/// What would be read out of bounds; whether it is a valid grid is check()'s to say.
void check_arrays(const Mesh& mesh) {
  for (const CellBlock& block : mesh.blocks) {
    const auto n = static_cast<std::size_t>(num_vertices(block.type));
    if (n == 0 && block.size() > 0)
      throw InputError(
          fmt::format("the grid has {} {} cells, which cannot be refined; divide them into tetrahedra, "
                      "pyramids, prisms and hexahedra (in the plane triangles and quads) first",
                      block.size(), name_of(block.type)));
    bool fits = n == 0 || block.vertices.size() % n == 0;
    fits = fits && (block.group.empty() || block.group.size() == block.size());
    for (const VertexId v : block.vertices) fits = fits && v.index() < mesh.points.size();
    for (const GroupId g : block.group) fits = fits && (!g.is_valid() || g.index() < mesh.groups.size());
    if (!fits)
      throw InputError(
          fmt::format("the arrays of the grid's {} cells do not fit each other or its points; 'delfront "
                      "check' says more",
                      name_of(block.type)));
  }
  if (mesh.top_dimension() < 1) throw InputError("the grid has no cells that could be refined");
  if (!mesh.vertex_entity.empty() && mesh.vertex_entity.size() != mesh.points.size())
    throw InputError("the grid has other than one entity a point");
  for (const Field& field : mesh.fields) {
    const std::size_t count = field.on == Field::On::vertices ? mesh.points.size() : mesh.num_cells(field.block);
    if (field.components < 1 || field.values.size() != count * static_cast<std::size_t>(field.components))
      throw InputError(fmt::format("the field '{}' has {} values for {} places of {} components", field.name,
                                   field.values.size(), count, field.components));
  }
}

void check_limit(const Mesh& mesh, int levels, const Context& context) {
  constexpr std::uint64_t kMostCells = CellId::kNone - 1;
  const std::uint64_t cells = num_cells_after(mesh, levels);
  const bool is_asked = context.max_cells > 0 && context.max_cells < kMostCells;
  if (cells <= (is_asked ? context.max_cells : kMostCells)) return;
  const std::string times = levels == 1 ? "once" : fmt::format("{} times", levels);
  const std::string count = cells > kMostCells ? fmt::format("more than {}", kMostCells) : std::to_string(cells);
  throw LimitError(fmt::format(
      "stopped: refined {} the grid would have {} cells{}; refine fewer times (--levels){}", times, count,
      is_asked ? fmt::format(", and the limit is {}", context.max_cells) : ", which is all that this version can hold",
      is_asked ? " or allow more cells (--max-cells)" : ""));
}

void check_model(const Mesh& mesh, const Model& model) {
  if (mesh.dimension != 2) return;
  for (const Point& p : model.points)
    if (p.z != 0)
      throw InputError(fmt::format("the geometry of a grid in the plane lies in the plane too; here is a point at "
                                   "({:.9g}, {:.9g}, {:.9g})",
                                   p.x, p.y, p.z),
                       {{p, {}}});
}

/// One level; its steps read in `run`.
class Level {
 public:
  Level(const Mesh& coarse, const RefineGridOptions& options, const TrueGeometry* geometry, RefineGridReport& report,
        Context& context)
      : coarse_(coarse), options_(options), geometry_(geometry), report_(report), context_(context) {}

  Mesh run(std::uint64_t cells_before, std::uint64_t cells_in_all) {
    context_.progress("refine", cells_before, cells_in_all, "cells");
    fine_.dimension = coarse_.dimension;
    fine_.groups = coarse_.groups;
    {
      const StageTimer timer(context_, "refine: points");
      mids_.emplace(coarse_, context_.threads);
      place_points();
    }
    put_on_geometry();
    std::optional<CellSplitter> splitter;
    {
      const StageTimer timer(context_, "refine: cells");
      splitter.emplace(coarse_, *mids_, fine_);
      splitter->split_all(context_, cells_before, cells_in_all);
    }
    if (coarse_.top_dimension() == coarse_.dimension) {
      const StageTimer timer(context_, "refine: validity");
      keep_valid(coarse_, *mids_, *splitter, fine_, moved_, options_.least_volume_share, context_);
    }
    carry_entities(coarse_, *mids_, fine_, context_.threads);
    carry_fields(coarse_, *mids_, fine_, context_.threads);
    count_moved();
    return std::move(fine_);
  }

 private:
  void place_points() {
    fine_.points.resize(mids_->num_points());
    std::copy(coarse_.points.begin(), coarse_.points.end(), fine_.points.begin());
    mids_->for_each(context_.threads, [this](std::size_t point, std::span<const std::uint32_t> corners) {
      const double share = 1 / static_cast<double>(corners.size());
      Point sum;
      for (const std::uint32_t corner : corners) sum = sum + share * coarse_.points[VertexId(corner)];
      fine_.points[VertexId(point)] = sum;
    });
  }

  void put_on_geometry() {
    if (!geometry_) return;
    const StageTimer timer(context_, "refine: geometry");
    context_.check_limits();
    BoundaryPlaces places = find_boundary_places(coarse_, *mids_, fine_.points, *geometry_, context_.threads);
    report_.boundary_points += places.num_looked_at;
    report_.out_of_reach += places.out_of_reach.size();
    find_farthest(places.out_of_reach);
    moved_ = std::move(places.moved);
    for (const MovedPoint& m : moved_) fine_.points[VertexId(m.point)] = m.target;
  }

  /// The farthest of some of them, evenly spread: to look from far away costs more than from near by.
  void find_farthest(const std::vector<std::uint32_t>& out_of_reach) {
    constexpr std::size_t kMostLooks = 200;
    const std::size_t step = out_of_reach.size() / kMostLooks + 1;
    for (std::size_t i = 0; i < out_of_reach.size(); i += step) {
      const Point p = fine_.points[VertexId(out_of_reach[i])];
      const double d = geometry_->nearest(p, std::numeric_limits<double>::infinity()).distance;
      if (!(d > report_.farthest)) continue;
      report_.farthest = d;
      report_.farthest_at = p;
    }
  }

  void count_moved() {
    for (const MovedPoint& m : moved_) {
      ++(m.on_feature ? report_.points_on_features : report_.points_on_surface);
      report_.largest_move = std::max(report_.largest_move, distance(m.middle, m.place()));
      if (m.halves == 2) continue;
      ++(m.halves == 1 ? report_.halved : report_.reversed);
      if (report_.reversed_places.size() < kMaxPlaces) report_.reversed_places.push_back({m.place(), {m.point}});
    }
  }

  const Mesh& coarse_;
  const RefineGridOptions& options_;
  const TrueGeometry* geometry_;
  RefineGridReport& report_;
  Context& context_;
  Mesh fine_;
  std::optional<MidPoints> mids_;
  std::vector<MovedPoint> moved_;
};

}  // namespace

std::size_t num_cells_after(const Mesh& mesh, int levels) {
  constexpr std::size_t kTooMany = std::numeric_limits<std::size_t>::max() / 16;
  const int top = mesh.top_dimension();
  std::array<std::size_t, kNumCellTypes> count{};
  for (const CellBlock& block : mesh.blocks)
    if (dimension(block.type) == top) count[static_cast<std::size_t>(block.type)] = block.size();
  std::size_t sum = 0;
  for (int level = 0; level <= levels; ++level) {
    sum = 0;
    for (const std::size_t n : count) sum += n;
    if (sum > kTooMany / 8 || level == levels) break;
    const std::size_t pyramids = count[static_cast<std::size_t>(CellType::pyramid)];
    for (std::size_t type = 0; type < count.size(); ++type)
      count[type] *= child_table(static_cast<CellType>(type)).num_children();
    count[static_cast<std::size_t>(CellType::tetrahedron)] += child_table(CellType::pyramid).tets.size() * pyramids;
  }
  return sum;
}

Mesh refine_grid(const Mesh& mesh, const RefineGridOptions& options, RefineGridReport& report, Context& context) {
  check_floating_point_mode();
  check_options(options);
  check_arrays(mesh);
  check_limit(mesh, options.levels, context);
  report = {};
  std::optional<TrueGeometry> geometry;
  if (options.model) {
    check_model(mesh, *options.model);
    geometry.emplace(*options.model, mesh.groups, options.feature_angle_deg);
    report.groups_not_in_model = geometry->unknown_groups();
  }
  std::uint64_t cells_in_all = 0, cells_before = 0;
  for (int level = 1; level <= options.levels; ++level) cells_in_all += num_cells_after(mesh, level);
  Mesh fine;
  for (int level = 1; level <= options.levels; ++level) {
    const Mesh coarse = std::move(fine);
    fine = Level(level == 1 ? mesh : coarse, options, geometry ? &*geometry : nullptr, report, context)
               .run(cells_before, cells_in_all);
    cells_before += fine.num_cells_of_dimension(fine.top_dimension());
  }
  context.progress("refine", cells_in_all, cells_in_all, "cells");
  report.levels = options.levels;
  report.num_points = fine.points.size();
  report.num_cells = fine.num_cells_of_dimension(fine.top_dimension());
  return fine;
}

std::vector<std::string> warnings_of(const RefineGridReport& report, const std::string& geometry) {
  std::vector<std::string> warnings;
  if (!report.groups_not_in_model.empty())
    warnings.push_back(fmt::format("{} has nothing called {}: new points there stay in the middle of their edges",
                                   geometry, fmt::join(report.groups_not_in_model, ", ")));
  if (report.out_of_reach > 0) {
    const Point at = report.farthest_at;
    const std::string count = report.out_of_reach == report.boundary_points
                                  ? fmt::format("none of the {}", report.boundary_points)
                                  : fmt::format("{} of the {}", report.out_of_reach, report.boundary_points);
    warnings.push_back(fmt::format(
        "{} new boundary points {} half an edge's length {} {}, e.g. ({:.9g}, {:.9g}, {:.9g}), from which "
        "it is {:.4g} away; they stay in the middle of their edges: does it lie elsewhere, or in other "
        "units?",
        count, report.out_of_reach == report.boundary_points ? "is within" : "are farther than",
        report.out_of_reach == report.boundary_points ? "of" : "from", geometry, at.x, at.y, at.z, report.farthest));
  }
  if (!report.reversed_places.empty()) {
    const Point at = report.reversed_places[0].at;
    warnings.push_back(
        fmt::format("{} new points stand halfway between their edge and {}, {} on their edge, since cells would have "
                    "been inverted or squashed; the first at ({:.9g}, {:.9g}, {:.9g})",
                    report.halved, geometry, report.reversed, at.x, at.y, at.z));
  }
  return warnings;
}

Model model_of_lines(const Mesh& lines, const std::string& stem) {
  Model model;
  model.points = lines.points;
  if (const CellBlock* block = lines.find_block(CellType::line))
    for (std::size_t i = 0; i < block->size(); ++i) {
      const GroupId group = block->group.empty() ? GroupId() : block->group[i];
      model.curves.push_back({group.is_valid() ? lines.groups[group].name : stem, {(*block)[i][0], (*block)[i][1]}});
    }
  if (model.curves.empty())
    throw InputError(fmt::format("{} has no lines, which the geometry of a grid in the plane consists of", stem));
  return model;
}

}  // namespace delfront
