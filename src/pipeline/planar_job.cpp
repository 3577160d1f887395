// SPDX-License-Identifier: Apache-2.0
#include "pipeline/planar_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "delfront/io.hpp"
#include "pipeline/boundaries.hpp"
#include "pipeline/levels.hpp"
#include "pipeline/option_table.hpp"
#include "pipeline/quantities.hpp"
#include "planar/far_field.hpp"
#include "planar/pieces.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {

namespace {

/// Curves take the place of patches, so that one selection serves both.
CurveId apply_boundaries(const std::vector<BoundaryOptions>& boundaries, PlanarDomain& domain, CurveId far_field) {
  Model stand_in;
  for (const PlanarCurve& curve : domain.curves) stand_in.patches.push_back({curve.name, curve.kind});
  for (const CurveId curve : domain.curve_of_segment) stand_in.patch_of_triangle.push_back(PatchId(curve.index()));
  const PatchId patch =
      apply_boundaries(boundaries, stand_in, far_field.is_valid() ? PatchId(far_field.index()) : PatchId());
  domain.curves.clear();
  for (const Patch& p : stand_in.patches) domain.curves.push_back({p.name, p.kind});
  for (std::size_t i = 0; i < domain.segments.size(); ++i)
    domain.curve_of_segment[i] = CurveId(stand_in.patch_of_triangle[TriangleId(i)].index());
  return patch.is_valid() ? CurveId(patch.index()) : CurveId();
}

/// Straight pieces, divided evenly where a length is given.
std::vector<Point2> divide_line(const std::vector<Point2>& through, bool closed, double h, const Context& context) {
  check_curve_points(through, closed);
  std::vector<Point2> points;
  const std::size_t pieces = through.size() - (closed ? 0 : 1);
  double length = 0;
  for (std::size_t i = 0; i < pieces; ++i) {
    const Point2 a = through[i], b = through[(i + 1) % through.size()];
    length += std::hypot(b.x - a.x, b.y - a.y);
  }
  if (h > 0) number_of_pieces(length / h, context);  // of all
  for (std::size_t i = 0; i < pieces; ++i) {
    const Point2 a = through[i], b = through[(i + 1) % through.size()];
    const std::size_t parts = h > 0 ? number_of_pieces(std::hypot(b.x - a.x, b.y - a.y) / h, context) : 1;
    for (std::size_t k = 0; k < parts; ++k) {
      if (k % kPiecesPerLimitCheck == kPiecesPerLimitCheck - 1) context.check_limits();
      const double t = static_cast<double>(k) / static_cast<double>(parts);
      points.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  }
  if (!closed) points.push_back(through.back());
  return points;
}

Mesh mesh_of_curve(const PlanarCurveOptions& curve, const LengthScale& scale, const Context& context) {
  std::vector<Point2> through;
  for (const Point& p : curve.at) {
    if (p.z != 0) throw UsageError("at: a curve lies in the plane z = 0");
    through.push_back({p.x, p.y});
  }
  const double h = curve.h ? resolve_length(*curve.h, scale) : 0;
  const std::vector<Point2> points = curve.type == "line" ? divide_line(through, curve.closed, h, context)
                                                          : sample_spline(through, curve.closed, h, context);
  Mesh mesh;
  mesh.dimension = 2;
  for (const Point2 p : points) mesh.points.push_back({p.x, p.y, 0});
  context.check_limits();
  CellBlock& lines = mesh.block(CellType::line);
  const std::size_t pieces = points.size() - (curve.closed ? 0 : 1);
  for (std::size_t i = 0; i < pieces; ++i) {
    lines.vertices.push_back(VertexId(i));
    lines.vertices.push_back(VertexId((i + 1) % points.size()));
  }
  return mesh;
}

}  // namespace

bool is_planar_input(const Mesh& mesh) {
  return mesh.num_cells(CellType::line) > 0 && mesh.top_dimension() <= 2 &&
         (mesh.dimension == 2 || mesh.top_dimension() == 1) &&
         std::all_of(mesh.points.begin(), mesh.points.end(), [](const Point& p) { return p.z == 0; });
}

bool is_planar_job(const std::vector<NamedMesh>& inputs) {
  return std::all_of(inputs.begin(), inputs.end(), [](const NamedMesh& input) { return is_planar_input(input.mesh); });
}

CurveId set_curves(PlanarDomain& domain, Options& options, const LengthScale& scale, Context& context) {
  const bool has_far_field = options.domain.enclose.shape != "none";
  const bool looks_only = has_far_field && options.stop_after == "geometry";
  const std::vector<BoundaryOptions> boundaries = looks_only ? boundaries_of_input(options) : options.boundaries;
  CurveId far_field;
  if (has_far_field && !looks_only) {
    const Options coarse = coarse_options(options);
    SizeOptions sizes = coarse.size;
    if (options.refine.levels > 0) sizes.growth = growth_of_boundary(sizes);
    far_field = add_far_field(domain, coarse.domain.enclose, sizes, scale, context);
    if (options.domain.keep.empty() && options.domain.keep_points.empty()) options.domain.keep = "outside";
  }
  far_field = apply_boundaries(boundaries, domain, far_field);
  const auto is_far_field = [](const PlanarCurve& curve) { return curve.kind == "farfield"; };
  if (has_far_field) {
    for (PlanarCurve& curve : domain.curves)
      if (curve.kind.empty()) curve.kind = "wall";
  } else if (options.domain.keep == "outside" &&
             std::none_of(domain.curves.begin(), domain.curves.end(), is_far_field)) {
    throw usage_error(options, "domain.keep",
                      "there is no far field that bounds the outside; add e.g. --farfield circle:50c, or "
                      "give the outer curve the kind farfield ([boundaries.NAME])");
  }
  return far_field;
}

std::vector<NamedMesh> curves_of_job(const Options& options, const std::vector<NamedMesh>& inputs, const Context& all) {
  Box box;
  for (const NamedMesh& input : inputs)
    for (const Point& p : input.mesh.points) box.add(p);
  for (const PlanarCurveOptions& curve : options.planar.curves)
    for (const Point& p : curve.at) box.add(p);
  const LengthScale scale{box.diagonal(), box.longest_side(), metres_per_unit(options.input.units)};
  std::vector<NamedMesh> result;
  for (std::size_t i = 0; i < options.planar.curves.size(); ++i) {
    const PlanarCurveOptions& curve = options.planar.curves[i];
    Context context = all;
    context.limit_advice = fmt::format("give planar.curve[{}] a larger h", i);
    try {
      result.push_back(
          {mesh_of_curve(curve, scale, context), curve.name.empty() ? fmt::format("curve_{}", i + 1) : curve.name});
    } catch (const UsageError& e) {
      throw usage_error(options, fmt::format("planar.curve[{}]", i), e.what());
    } catch (const InputError& e) {
      throw usage_error(options, fmt::format("planar.curve[{}]", i), e.what());
    }
  }
  return result;
}

void check_planar_outputs(const Options& options) {
  for (std::size_t i = 0; i < options.output.files.size(); ++i) {
    const std::string& path = options.output.files[i];
    if (format_of(path, options.output.format, true).name == "openfoam")
      throw usage_error(
          options, fmt::format("output.files[{}]", i),
          fmt::format("{}: an OpenFOAM case holds grids of volume cells, and the input lies in the plane; "
                      "write su2, vtu, msh or mesh, or extrude the grid by one cell",
                      path));
  }
}

Model true_lines(Options options, std::vector<NamedMesh> inputs, const LengthScale& scale, Context& context) {
  constexpr double kFiner = 8, kPiecesOfCircle = 4000;
  const bool has_circle = options.domain.enclose.shape == "circle" || options.domain.enclose.shape == "sphere";
  if (options.planar.curves.empty() && !has_circle) return {};
  options.refine = {};
  for (PlanarCurveOptions& curve : options.planar.curves) {
    double chords = 0;
    for (std::size_t i = 1; i < curve.at.size(); ++i) chords += distance(curve.at[i - 1], curve.at[i]);
    if (!curve.h) curve.h = Length{chords / static_cast<double>(curve.at.size()), ""};
    curve.h->value /= kFiner;
  }
  if (has_circle)
    options.domain.enclose.h = Length{2 * std::numbers::pi / kPiecesOfCircle * options.domain.enclose.size.value, ""};
  inputs.resize(options.input.files.size());
  Context unlimited = context;  // these pieces are no cells
  unlimited.max_cells = 0;
  std::vector<NamedMesh> curves = curves_of_job(options, inputs, unlimited);
  std::move(curves.begin(), curves.end(), std::back_inserter(inputs));
  PlanarDomain domain = build_planar_domain(inputs, context);
  set_curves(domain, options, scale, context);
  return model_of_lines(line_mesh(domain), "lines");
}

Outcome generate_in_far_field(const PlanarDomain& domain, CurveId far_field, const Options& options,
                              const std::shared_ptr<const SizeField>& sizes, const Model* geometry, Context& context) {
  if (!far_field.is_valid()) return generate_planar_in_levels(domain, options, context, sizes, geometry);
  PlanarDomain known = domain;
  const PlanarCurve asked = known.curves[far_field];
  known.curves[far_field].kind = "farfield";
  Outcome outcome = generate_planar_in_levels(known, options, context, sizes, geometry);
  const GroupId group = outcome.mesh.find_group(1, asked.name);
  if (group.is_valid()) outcome.mesh.groups[group].kind = asked.kind;
  return outcome;
}

Mesh line_mesh(const PlanarDomain& domain) {
  Mesh mesh;
  mesh.dimension = 2;
  for (const Point2 p : domain.points) mesh.points.push_back({p.x, p.y, 0});
  for (const PlanarCurve& curve : domain.curves) mesh.groups.push_back({curve.name, 1, curve.kind, false});
  CellBlock& lines = mesh.block(CellType::line);
  for (std::size_t i = 0; i < domain.segments.size(); ++i) {
    lines.vertices.insert(lines.vertices.end(), domain.segments[i].begin(), domain.segments[i].end());
    lines.group.push_back(GroupId(domain.curve_of_segment[i].index()));
  }
  return mesh;
}

}  // namespace delfront
