// SPDX-License-Identifier: Apache-2.0
#include "pipeline/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "delfront/errors.hpp"
#include "pipeline/geometry_job.hpp"
#include "pipeline/surface_job.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {

namespace {

/// Turned and looked at; what cannot bound a volume goes no further.
SurfaceReport prepare_surface(Model& model, Context& context) {
  const std::size_t turned = orient_shells(model, context);
  SurfaceReport report = check_surface(model, context);
  report.reoriented = turned;
  return report;
}

void refuse_invalid(const SurfaceReport& surface) {
  if (surface.can_bound_volume && !has_errors(surface.findings)) return;
  std::string message = "the surface cannot be gridded:";
  std::vector<Place> places;
  for (const Finding& f : surface.findings) {
    if (f.severity != Severity::error) continue;
    message += "\n  " + f.message + (f.remedy.empty() ? "" : "; " + f.remedy);
    places.insert(places.end(), f.places.begin(), f.places.end());
  }
  throw InputError(message, std::move(places));
}

std::vector<bool> far_field_patches(const Model& model) {
  std::vector<bool> is_far_field;
  for (const Patch& patch : model.patches) is_far_field.push_back(patch.kind == "farfield");
  return is_far_field;
}

/// A new surface is looked at as a given one is.
void regrid(Model& model, const Options& options, const std::shared_ptr<const SizeField>& asked, Report& report,
            Context& context) {
  regrid_as_asked(model, options, *surface_sizes(model, options, asked), report.surface_grid, context);
  const std::size_t turned = report.surface.reoriented;
  report.surface = check_surface(model, context);
  report.surface.reoriented = turned;
  refuse_invalid(report.surface);
}

BoundaryGrid recover(Model& model, const Options& options, Report& report, Context& context,
                     const RecoveryEffort& effort = {}) {
  return tetrahedralize_boundary(model, options.domain, far_field_patches(model), report.recovery, context, effort);
}

/// A new surface that cannot be recovered gives way to the given one, which most often can.
BoundaryGrid regrid_and_recover(Model& model, const Options& options, const std::shared_ptr<const SizeField>& asked,
                                Report& report, Context& context) {
  const Model given = model;
  const SurfaceReport of_given = report.surface;
  try {
    regrid(model, options, asked, report, context);
    return recover(model, options, report, context, {.gives_up = true});
  } catch (const MeshingError& e) {
    const Point at = e.places.empty() ? Point{} : e.places[0].at;
    context.warn(fmt::format("the new surface cannot be filled, the given triangles are kept: {}", e.what()));
    report.surface_grid = {};
    report.surface_grid.fallbacks.push_back({SurfaceFallback::Kind::kept, "", at, e.what()});
    report.surface = of_given;
    report.recovery = {};
    model = given;
    return recover(model, options, report, context);
  }
}

/// The boundary vertices that the grid uses and that have sizes.
std::vector<VertexIndex> sized_vertices(const TetComplex& complex) {
  std::vector<VertexIndex> sized;
  for (VertexIndex v = 0; v < complex.num_vertices(); ++v)
    if (complex.on_boundary[v] && complex.vertex_tet[v] != kNoIndex && complex.vertex[v].h > 0) sized.push_back(v);
  return sized;
}

BoundarySizes boundary_sizes(const TetComplex& complex, const std::vector<VertexIndex>& vertices) {
  BoundarySizes boundary;
  for (const VertexIndex v : vertices) {
    boundary.points.push_back(complex.point(v));
    boundary.size.push_back(complex.vertex[v].h);
  }
  return boundary;
}

/// Takes out those whose edges are about as long as the metric asks there, or longer: the short edges of long
/// triangles must not bound what is wanted along the long ones.
void drop_those_that_suit(std::vector<VertexIndex>& vertices, const Model& model, const SizeField& asked) {
  constexpr double kSuits = 0.8;  ///< wanted lengths
  std::vector<Metric> metric(model.points.size());
  std::vector<double> sum(model.points.size(), 0), count(model.points.size(), 0);
  for (const VertexIndex v : vertices)
    if (v < model.points.size()) asked.metrics({&model.points[VertexId(v)], 1}, {&metric[v], 1});
  for (const std::array<VertexId, 3>& triangle : model.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
        const std::size_t v = triangle[k].index();
        sum[v] += length_in(metric[v], model.points[triangle[other]] - model.points[triangle[k]]);
        ++count[v];
      }
  std::erase_if(vertices, [&](VertexIndex v) { return v < sum.size() && count[v] > 0 && sum[v] >= kSuits * count[v]; });
}

std::shared_ptr<const SizeField> build_size_field(const TetComplex& complex, const Model& model, const Options& options,
                                                  std::shared_ptr<const SizeField> asked, Context& context) {
  std::vector<VertexIndex> vertices = sized_vertices(complex);
  const double largest = largest_size(boundary_sizes(complex, vertices));
  if (makes_stretched_cells(options, asked.get())) drop_those_that_suit(vertices, model, *asked);
  std::shared_ptr<const SizeField> of_boundary;
  if (!vertices.empty() || !asked)
    of_boundary = build_asked_size_field(boundary_sizes(complex, vertices), options.size, largest, context);
  return asked ? combine_with_asked(std::move(of_boundary), std::move(asked), options.size) : of_boundary;
}

/// What helps where edges of the surface are longer than what is asked for.
const char* remedy_of_coarse_surface(const Options& options) {
  const auto& files = options.input.files;
  return !files.empty() && std::all_of(files.begin(), files.end(), is_smooth_file)
             ? "sizes fall faster there than its triangles can: a smaller size.growth, or size.on of the face, helps"
             : "of given facets --surface-method front makes new triangles, to the sizes asked for";
}

/// Surfaces are kept as they are given, whatever sizes are asked for: flat cells stand where the two do not fit.
/// @param asked  null: hmax alone
void warn_of_coarse_surface(const Model& model, const Options& options, const SizeField* asked, Context& context) {
  std::vector<std::array<Point, 2>> edges;
  for (const std::array<VertexId, 3>& triangle : model.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = triangle[k], w = triangle[(k + 1) % 3];
      if (v.index() < w.index()) edges.push_back({model.points[v], model.points[w]});  // its other triangle has it too
    }
  const LongEdges found = find_long_edges(edges, options.size, asked, context);
  if (found.count == 0) return;
  context.warn(fmt::format(
      "{} edges of the surface are longer than the sizes asked for there, the worst {:g} where {:g} is asked "
      "for (at {:g} {:g} {:g}): cells along it may be flat; {}",
      found.count, found.length, found.size, found.at.x, found.at.y, found.at.z, remedy_of_coarse_surface(options)));
}

/// The field's size at every vertex, so that all sizes keep the growth. Vertices that the grid does not use are not
/// asked for: some lie far outside, where a formula need not have a value.
void set_vertex_sizes(TetComplex& complex, const SizeField& field, const Context& context) {
  std::vector<VertexIndex> used;
  std::vector<Point> places;
  for (VertexIndex v = 0; v < complex.num_vertices(); ++v) {
    if (complex.vertex_tet[v] == kNoIndex) continue;
    used.push_back(v);
    places.push_back(complex.point(v));
  }
  std::vector<double> sizes(places.size());
  evaluate_sizes(field, places, sizes, context);
  for (std::size_t i = 0; i < used.size(); ++i) complex.vertex[used[i]].h = sizes[i];
}

}  // namespace

bool makes_stretched_cells(const Options& options, const SizeField* size) {
  return options.volume.method == "front" && size != nullptr && !size->is_isotropic();
}

Prepared prepare_volume(Model& model, const Options& options, std::shared_ptr<const SizeField> asked, Report& report,
                        Context& context) {
  report.surface = prepare_surface(model, context);
  refuse_invalid(report.surface);
  Prepared prepared;
  prepared.grid = options.surface.method == "keep" ? recover(model, options, report, context)
                                                   : regrid_and_recover(model, options, asked, report, context);
  if (options.surface.method == "keep" && !makes_stretched_cells(options, asked.get()))
    warn_of_coarse_surface(model, options, asked.get(), context);
  prepared.size = build_size_field(prepared.grid.complex, model, options, std::move(asked), context);
  set_vertex_sizes(prepared.grid.complex, *prepared.size, context);
  return prepared;
}

}  // namespace delfront
