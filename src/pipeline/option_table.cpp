// SPDX-License-Identifier: Apache-2.0
// The option table itself, one row an option; what is done with it stands in option_tree.cpp.
#include "pipeline/option_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "pipeline/boundary_options.hpp"
#include "pipeline/option_rows.hpp"
#include "pipeline/quantities.hpp"
#include "pipeline/size_options.hpp"

namespace delfront {

namespace {

// --- rows that are one of a kind -----------------------------------------------------------------------------

OptionRow corners_row() {
  OptionRow row{"domain.enclose.corners",
                Takes::numbers,
                "",
                "",
                "a box given by its corners: [xmin, ymin, zmin, xmax, ymax, zmax]",
                "six numbers, each minimum below its maximum",
                {},
                {}};
  row.set = [](Options& o, const JobValue& v) {
    const std::vector<double> x = as_numbers(v);
    if (x.size() != 6) throw BadValue(fmt::format("got {} numbers", x.size()));
    for (std::size_t k = 0; k < 3; ++k)
      if (!(x[k] < x[k + 3])) throw BadValue(fmt::format("got {} to {} along {}", x[k], x[k + 3], "xyz"[k]));
    o.domain.enclose.corners = {x[0], x[1], x[2], x[3], x[4], x[5]};
  };
  row.get = [](const Options& o) {
    if (!o.domain.enclose.corners) return JobValue();
    JobValue list = JobValue::list();
    for (const double x : *o.domain.enclose.corners) list.items.push_back(JobValue::of(x));
    return list;
  };
  return row;
}

OptionRow enclose_size_row() {
  OptionRow row{"domain.enclose.size",
                Takes::length,
                "",
                "LENGTH",
                "sphere, circle: its radius; box: half its side",
                kLengthAllowed,
                [](Options& o, const JobValue& v) { o.domain.enclose.size = as_length(v); },
                [](const Options& o) {
                  return o.domain.enclose.size.value > 0 ? length_value(o.domain.enclose.size) : JobValue();
                }};
  return row;
}

void set_keep(Options& options, const JobValue& value) {
  DomainOptions& domain = options.domain;
  static const std::vector<std::string> words = {"largest", "all", "outside"};
  if (value.is(JobValue::Kind::text) && std::find(words.begin(), words.end(), value.text) != words.end()) {
    domain.keep = value.text;
    domain.keep_points.clear();
    return;
  }
  std::vector<Point> points;
  if (value.is(JobValue::Kind::text)) {
    if (value.text.find(',') == std::string::npos)
      throw BadValue("got " + describe(value) + did_you_mean(value.text, words));
    points.push_back(as_point(value));
  } else {
    if (value.find("seeds")) throw BadValue("named seeds are" + planned_note("domain.keep.seeds").substr(1));
    const JobValue* point = value.is(JobValue::Kind::table) && value.items.size() == 1 ? value.find("point") : nullptr;
    if (!point || !point->is(JobValue::Kind::list)) throw BadValue("got " + describe(value));
    const bool is_many = !point->items.empty() && point->items[0].is(JobValue::Kind::list);
    if (is_many)
      for (const JobValue& item : point->items) points.push_back(as_point(item));
    else
      points.push_back(as_point(*point));
  }
  domain.keep.clear();
  domain.keep_points = std::move(points);
}

JobValue get_keep(const Options& options) {
  if (!options.domain.keep.empty()) return JobValue::of(options.domain.keep);
  if (options.domain.keep_points.empty()) return {};
  std::vector<JobValue> points;
  for (const Point p : options.domain.keep_points)
    points.push_back(JobValue::list({JobValue::of(p.x), JobValue::of(p.y), JobValue::of(p.z)}));
  JobValue table = JobValue::table();
  table.add("point", points.size() == 1 ? points[0] : JobValue::list(points));
  return table;
}

OptionRow keep_row() {
  return {"domain.keep",
          Takes::keep,
          "--keep",
          "largest|all|outside|X,Y,Z",
          "which regions to grid: the largest, all bounded ones, what is outside the body (the default with a far "
          "field), or the one that holds a point",
          "largest, all, outside, or { point = [x, y, z] }",
          set_keep,
          get_keep};
}

OptionRow duration_row() {
  return {"limits.time",
          Takes::duration,
          "--time-limit",
          "TIME",
          "stop after this time (exit 6); 0: no limit",
          "seconds, or a text such as \"90s\", \"10min\", \"2h\"",
          [](Options& o, const JobValue& v) {
            o.limits.time = v.is_number() ? as_number_between(v, 0, 1e18) : parse_duration(as_text(v));
          },
          [](const Options& o) { return JobValue::of(o.limits.time); }};
}

OptionRow memory_row() {
  return {
      "limits.memory",
      Takes::memory,
      "--memory-limit",
      "MEMORY",
      "stop where the process holds more memory (exit 6); 0: no limit",
      "bytes, or a text such as \"500MB\", \"20GB\", \"16GiB\"",
      [](Options& o, const JobValue& v) { o.limits.memory = v.is_number() ? as_count(v) : parse_memory(as_text(v)); },
      [](const Options& o) { return JobValue::of(static_cast<std::int64_t>(o.limits.memory)); }};
}

const std::vector<std::string> kUnits = {"m", "mm", "in", "ft"};
const std::vector<std::string> kStages = {"geometry", "surface", "volume", "improve", "write"};

std::vector<OptionRow> build_table() {
  std::vector<std::string> input_units = kUnits;
  input_units.insert(input_units.begin(), "auto");
  std::vector<OptionRow> t;
  const auto add = [&t](OptionRow row) { t.push_back(std::move(row)); };
  add(text_row(
      "stop_after", "--stop-after", "STAGE",
      "last stage to run: geometry (look only), surface (write the boundary), volume (no improvement), "
      "improve (write nothing), write",
      [](auto& o) -> auto& { return o.stop_after; }, kStages));
  add(texts_row(
      "input.files", "", "",
      "surfaces to grid together: STL, OBJ, PLY, OFF, VTP, …, smooth geometry (.geom.toml), CAD (.step .iges .brep "
      ".egads); or lines in the plane: DAT, POLY, …",
      [](auto& o) -> auto& { return o.input.files; }));
  add(text_row(
      "input.units", "--units", "UNIT", "unit of the coordinates, where lengths in m, mm, in, ft are used",
      [](auto& o) -> auto& { return o.input.units; }, input_units));
  add(number_row(
      "input.feature_angle", "--feature-angle", "DEG", "angle between facets from which an edge is a feature",
      "degrees from 0 to 180", 0, 180, [](auto& o) -> auto& { return o.input.feature_angle; }));
  add(keep_row());
  add(text_row("domain.enclose.shape", "", "", "outer boundary made around the input, for external flow",
               [](auto& o) -> auto& { return o.domain.enclose.shape; }, {"none", "box", "sphere", "circle"}));
  add(enclose_size_row());
  add(corners_row());
  add(text_row(
      "domain.enclose.name", "", "", "its patch", [](auto& o) -> auto& { return o.domain.enclose.name; }));
  add(length_row(
      "domain.enclose.h", "--farfield-h",
      "side of the far field's triangles; by default from its size, and at most hmax",
      [](auto& o) -> auto& { return o.domain.enclose.h; }));
  add_size_rows(t);
  add(text_row("planar.boundary", "--boundary", "keep|split",
               "grids in the plane: keep the given boundary points and no others, or split segments by size",
               [](auto& o) -> auto& { return o.planar.boundary; }, {"keep", "split"}));
  add(text_row(
      "planar.method", "--planar-method", "front-delaunay|front|delaunay",
      "how the plane is gridded: by the points of a front, connected by Delaunay; by an advancing front; or by "
      "Delaunay with points at the centres of circles",
      [](auto& o) -> auto& { return o.planar.method; }, {"front-delaunay", "front", "delaunay"}));
  add(number_row(
      "planar.min_angle", "", "", "grids in the plane: smallest angle to work towards", "degrees from 0 to 40", 0, 40,
      [](auto& o) -> auto& { return o.planar.min_angle; }));
  add(text_row(
      "surface.method", "--surface-method", "keep|front|delaunay|mapped",
      "the surface's triangles: keep the given ones, or make new ones of the sizes asked for, by a front or by a "
      "front and Delaunay flips; smooth geometry: mapped (also keep), through its parameters, or front, in space",
      [](auto& o) -> auto& { return o.surface.method; }, {"keep", "front", "delaunay", "mapped"}));
  add(boolean_row(
      "surface.bridge",
      "smooth geometry: grid across tiny edges, sliver faces and borders that touch, where they are narrower than hmin",
      [](auto& o) -> auto& { return o.surface.bridge; }));
  add(text_row("volume.method", "--volume-method", "front-delaunay|front|delaunay|none",
               "how the volume is gridded: by the points of a front, connected by Delaunay; by an advancing front; by "
               "Delaunay with points at the centres of spheres; none: the surface only",
               [](auto& o) -> auto& { return o.volume.method; }, {"front-delaunay", "front", "delaunay", "none"}));
  add(boolean_row(
      "volume.core", "a regular lattice in the middle, where sizes are largest and the boundary is far",
      [](auto& o) -> auto& { return o.volume.core; }));
  add(boolean_row(
      "improve.enabled", "switch faces and edges and move points until the goals are met",
      [](auto& o) -> auto& { return o.improve.enabled; }));
  add(count_row(
      "improve.max_passes", "", "passes at most", "a whole number",
      [](auto& o) -> auto& { return o.improve.max_passes; }));
  add(number_row(
      "improve.goals.min_dihedral", "", "",
      "worst dihedral angle to work towards; cells a good deal above it are bettered too, where that costs little",
      "degrees from 0 to 70", 0, 70, [](auto& o) -> auto& { return o.improve.min_dihedral; }));
  add(number_row(
      "improve.goals.max_nonortho", "", "", "worst non-orthogonality to work towards", "degrees from 0 to 90", 0, 90,
      [](auto& o) -> auto& { return o.improve.max_nonortho; }));
  add(count_row(
      "refine.levels", "--levels",
      "grid with sizes 2^N times those asked for, then halve every edge N times; given surfaces that are kept become "
      "finer by that",
      "a whole number from 0 to 8", [](auto& o) -> auto& { return o.refine.levels; }));
  add(text_row(
      "refine.geometry", "--geometry", "FILE",
      "with levels: surface (in the plane: lines) on which new boundary points are put; by default the given one",
      [](auto& o) -> auto& { return o.refine.geometry; }));
  add(duration_row());
  add(memory_row());
  add(count_row(
      "limits.max_cells", "--max-cells", "stop where the grid passes this many cells (exit 6); 0: no limit",
      "a whole number", [](auto& o) -> auto& { return o.limits.max_cells; }));
  add(texts_row(
      "output.files", "-o,--output", "OUT",
      "grid to write, repeatable; the type comes from the extension, a name ending in / is an OpenFOAM case",
      [](auto& o) -> auto& { return o.output.files; }));
  add(text_row(
      "output.format", "--format", "FORMAT", "file type of all outputs, instead of by extension",
      [](auto& o) -> auto& { return o.output.format; }));
  add(text_row(
      "output.units", "--output-units", "UNIT", "rescale on output (needs input.units)",
      [](auto& o) -> auto& { return o.output.units; }, kUnits));
  add(boolean_row(
      "output.ascii", "text instead of binary, where a format has both",
      [](auto& o) -> auto& { return o.output.ascii; }));
  add(boolean_row(
      "output.compress", "VTU and VTP: compressed", [](auto& o) -> auto& { return o.output.compress; }));
  add(boolean_row(
      "output.sizes",
      "the wanted size at each point goes with the grid, as the field h (VTU); of stretched sizes the metric too",
      [](auto& o) -> auto& { return o.output.sizes; }));
  add(text_row("output.msh_version", "--msh-version", "V", "version of MSH files; by default 4.1",
               [](auto& o) -> auto& { return o.output.msh_version; }, {"2.2", "4.1"}));
  add(text_row(
      "output.solver", "--solver", "su2|openfoam",
      "starter files for this solver beside its grid, naming every boundary: NAME.cfg, or 0/, constant/ and system/ of "
      "the case; files that exist are kept",
      [](auto& o) -> auto& { return o.output.solver; }, starter_solvers()));
  add(text_row(
      "output.report", "--report", "FILE",
      "report of the run as JSON, written also when the run fails; NAME.html: a page to read, with NAME.json beside it",
      [](auto& o) -> auto& { return o.output.report; }));
  add(text_row(
      "output.defects", "--defects", "FILE", "where defects are shown (.vtp); by default beside the first output",
      [](auto& o) -> auto& { return o.output.defects; }));
  add(text_row(
      "output.require", "--require", "GATES",
      "quality the grid must have, or exit 5: \"min_dihedral > 8, max_nonortho < 70\"",
      [](auto& o) -> auto& { return o.output.require; }));
  return t;
}

}  // namespace

const std::vector<OptionRow>& option_table() {
  static const std::vector<OptionRow> table = build_table();
  return table;
}

static EntryTable curve_table() {
  using C = PlanarCurveOptions;
  const auto curves = [](auto& o) -> auto& { return o.planar.curves; };
  static const std::vector<std::string> types = {"spline", "line"};
  EntryTable table = list_table<C>("planar.curve", curves);
  add_entry<C>(
      table, curves, {"name", Takes::text, "its name in the grid", "a text"},
      [](C& c, const JobValue& v) { c.name = as_text(v); }, [](const C& c) { return text_value(c.name); });
  add_entry<C>(
      table, curves, {"type", Takes::text, "smooth through its points, or straight between them", "spline or line"},
      [](C& c, const JobValue& v) { c.type = as_choice(v, types); }, [](const C& c) { return text_value(c.type); });
  add_entry<C>(
      table, curves, {"at", Takes::numbers, "its points", "points [[x, y], ...]"},
      [](C& c, const JobValue& v) { c.at = as_points(v); },
      [](const C& c) {
        JobValue list = JobValue::list();
        for (const Point& p : c.at) list.items.push_back(point_value(p));
        return c.at.empty() ? JobValue() : list;
      });
  add_entry<C>(
      table, curves, {"closed", Takes::boolean, "from the last point to the first", "true or false"},
      [](C& c, const JobValue& v) {
        if (!v.is(JobValue::Kind::boolean)) throw BadValue("got " + describe(v));
        c.closed = v.boolean;
      },
      [](const C& c) { return JobValue::of(c.closed); });
  add_entry<C>(
      table, curves, {"h", Takes::length, "length of its pieces; by default as the points lie apart", kLengthAllowed},
      [](C& c, const JobValue& v) { c.h = as_length(v); },
      [](const C& c) { return c.h ? length_value(*c.h) : JobValue(); });
  return table;
}

const std::vector<EntryTable>& entry_tables() {
  static const std::vector<EntryTable> tables = [] {
    std::vector<EntryTable> all = size_entry_tables();
    all.push_back(boundary_table());
    all.push_back(curve_table());
    return all;
  }();
  return tables;
}

/// "sphere:20c", "circle:20c", "box:10c", "box:xmin,ymin,zmin,xmax,ymax,zmax", "none".
static void set_farfield(Options& options, const std::string& text) {
  EncloseOptions& enclose = options.domain.enclose;
  const std::size_t colon = text.find(':');
  const std::string shape = text.substr(0, colon);
  const std::string size = colon == std::string::npos ? "" : text.substr(colon + 1);
  const auto bad = [&](const std::string& why) {
    return UsageError(
        fmt::format("--farfield {}: {}; write sphere:20c or, in 2-D, circle:20c (radius), box:10c (half side) or "
                    "box:xmin,ymin,zmin,xmax,ymax,zmax",
                    text, why));
  };
  if (shape == "none" && size.empty()) {
    enclose.shape = shape;
    enclose.h.reset();  // of the far field that the job file asks for
    return;
  }
  if (shape != "sphere" && shape != "box" && shape != "circle")
    throw bad("unknown shape '" + shape + "'" + did_you_mean(shape, {"sphere", "circle", "box", "none"}));
  if (size.empty()) throw bad("the size is missing");
  enclose.shape = shape;
  enclose.corners.reset();
  try {
    if (shape == "box" && size.find(',') != std::string::npos)
      corners_row().set(options, JobValue::of(size));
    else
      enclose_size_row().set(options, JobValue::of(size));
  } catch (const std::exception& e) {
    throw bad(e.what());
  }
}

const std::vector<Shorthand>& shorthand_table() {
  static const std::vector<Shorthand> table = {
      {"--farfield", "SHAPE:SIZE",
       "outer boundary around the body: sphere:20c, circle:20c (2-D), box:10c (c = the body's longest side), or "
       "box:xmin,…,zmax; patches "
       "of "
       "the input get the kind wall unless they have one",
       true, set_farfield},
      {"--no-improve", "", "no improvement after gridding", false,
       [](Options& o, const std::string&) { o.improve.enabled = false; }},
      {"--ascii", "", "write text instead of binary, where a format has both", false,
       [](Options& o, const std::string&) { o.output.ascii = true; }},
  };
  return table;
}

}  // namespace delfront
