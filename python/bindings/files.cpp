// SPDX-License-Identifier: Apache-2.0
// Reading, writing, converting, looking at and refining: what needs no job.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core.hpp"
#include "delfront/io.hpp"
#include "delfront/job.hpp"
#include "pipeline/convert_job.hpp"
#include "pipeline/geometry_job.hpp"
#include "pipeline/inspect.hpp"
#include "pipeline/refine_job.hpp"
#include "pipeline/report_json.hpp"
#include "runner.hpp"

namespace delfront::python {

using namespace nb::literals;

namespace {

std::string dumped(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

WriteOptions write_options(bool binary, const std::string& version, bool compress) {
  return {.binary = binary, .version = version, .compress = compress};
}

/// What was changed or left out, and what starter files take for granted.
nb::list texts_of(std::vector<std::string> changes, const StarterFiles& starter) {
  changes.insert(changes.end(), starter.notes.begin(), starter.notes.end());
  return texts_list(changes);
}

nb::list write(const Mesh& mesh, const std::string& path, bool binary, const std::string& version, bool compress,
               const std::string& format, const std::string& solver, const Hooks& hooks) {
  const ConvertOptions options{
      .from = "", .to = format, .how = write_options(binary, version, compress), .solver = solver};
  StarterFiles starter;
  const std::vector<std::string> changes =
      run_released(hooks, [&](Context& context) { return write_for_solver(mesh, path, options, context, starter); });
  return texts_of(changes, starter);
}

nb::tuple convert(const std::string& in, const std::string& out, const std::string& from, const std::string& to,
                  bool binary, const std::string& version, bool compress, const std::string& solver,
                  const Hooks& hooks) {
  const ConvertOptions options{
      .from = from, .to = to, .how = write_options(binary, version, compress), .solver = solver};
  std::vector<std::string> changes;
  StarterFiles starter;
  Mesh mesh =
      run_released(hooks, [&](Context& context) { return convert_file(in, out, options, changes, context, &starter); });
  return nb::make_tuple(std::move(mesh), texts_of(changes, starter), texts_list(starter.written));
}

struct RefineWish {
  int levels = 1;
  double feature_angle = 40;
  std::uint64_t max_cells = 0;
};

/// @param geometry  a surface (in the plane: lines), or null
std::pair<Mesh, RefineGridReport> refine(const Mesh& coarse, const Mesh* geometry, const std::string& name,
                                         const std::string& geometry_name, const RefineWish& wish, Context& context) {
  RefineGridOptions options;
  options.levels = wish.levels;
  options.feature_angle_deg = wish.feature_angle;
  check_refine_options(options, "levels =", "feature_angle =");
  check_grid_to_refine(coarse, name, context);
  context.limit_advice = "refine fewer times (levels)";
  context.max_cells = wish.max_cells;
  const Model model = geometry ? geometry_to_refine_on(coarse, *geometry, geometry_name, context) : Model();
  if (geometry) options.model = &model;
  std::pair<Mesh, RefineGridReport> result;
  result.first = refine_and_check(coarse, options, result.second, context);
  return result;
}

nb::tuple refine_to_python(const Mesh& coarse, nb::object geometry, const std::string& name,
                           const std::string& geometry_name, int levels, double feature_angle, std::uint64_t max_cells,
                           const Hooks& hooks) {
  const Mesh* const surface = geometry.is_none() ? nullptr : &nb::cast<const Mesh&>(geometry);
  auto [mesh, report] = run_released(hooks, [&](Context& context) {
    return refine(coarse, surface, name, geometry_name, {levels, feature_angle, max_cells}, context);
  });
  nb::list warnings = texts_list(warnings_of(report, geometry_name));
  return nb::make_tuple(std::move(mesh), text_of(dumped(to_json(report))), warnings);
}

void add_inspected(nb::module_& module) {
  using It = Inspected;
  nb::class_<It>(module, "Inspected", "What a look at an input or a grid gives.")
      .def_prop_ro("is_grid", [](const It& self) { return self.is_grid; })
      .def_prop_ro("is_usable", &It::is_usable)
      .def_prop_ro("quality",
                   [](const It& self) {
                     return self.is_grid && self.is_usable() ? nb::cast(self.quality) : nb::object(nb::none());
                   })
      .def("facts_json",
           [](const It& self, const std::string& name) { return text_of(dumped(facts_json(name, self))); })
      .def("facts_text", [](const It& self, const std::string& name) { return text_of(facts_text(name, self)); })
      .def("check_text", [](const It& self) { return text_of(check_text(self)); })
      .def("verdict", [](const It& self, const std::string& name) { return text_of(verdict_text(name, self)); })
      .def(
          "findings",
          [](const It& self, const std::string& gates, const Hooks& hooks) {
            return findings_list(
                run_released(hooks, [&](Context& context) { return findings_with_gates(self, gates, context); }));
          },
          "gates"_a, "hooks"_a)
      .def(
          "write_defects",
          [](const It& self, const std::string& gates, const std::string& path, const Hooks& hooks) {
            run_released(hooks, [&](Context& context) {
              check_writable(path);
              write_defects(findings_with_gates(self, gates, context), path, context);
              return true;
            });
          },
          "gates"_a, "path"_a, "hooks"_a);
  module.def(
      "inspect_file",
      [](const std::string& path, const std::string& format, const Hooks& hooks) {
        return run_released(hooks, [&](Context& context) { return inspect_file(path, format, context); });
      },
      "path"_a, "format"_a, "hooks"_a);
  module.def(
      "inspect_mesh",
      [](std::shared_ptr<Mesh> mesh, const std::string& name, const Hooks& hooks) {
        return run_released(hooks, [&](Context& context) { return inspect_mesh(mesh, name, context); });
      },
      "mesh"_a, "name"_a, "hooks"_a);
  module.def(
      "inspect_inputs",
      [](const std::vector<std::shared_ptr<HeldInput>>& inputs, const Hooks& hooks) {
        const std::vector<std::shared_ptr<const HeldInput>> held(inputs.begin(), inputs.end());
        return run_released(hooks, [&](Context& context) { return inspect_inputs(held, context); });
      },
      "inputs"_a, "hooks"_a);
}

void add_inputs(nb::module_& module) {
  nb::class_<HeldInput>(module, "Input", "What an input of a job holds.")
      .def_prop_ro("stem", [](const HeldInput& self) { return text_of(self.stem); })
      .def_prop_ro("is_smooth", [](const HeldInput& self) { return self.brep != nullptr; })
      .def_prop_ro("unit", [](const HeldInput& self) { return text_of(self.cad.unit); })
      .def_prop_ro(
          "mesh", [](const HeldInput& self) -> const Mesh& { return self.mesh; }, nb::rv_policy::reference_internal);
  module.def(
      "read_input",
      [](const std::string& path, const std::string& format, const Hooks& hooks) {
        return run_released(hooks, [&](Context& context) { return read_input(path, context, format); });
      },
      "path"_a, "format"_a, "hooks"_a);
  module.def(
      "hold_mesh",
      [](const Mesh& mesh, const std::string& stem) {
        HeldInput held;
        held.mesh = mesh;
        held.stem = stem;
        return held;
      },
      "mesh"_a, "stem"_a);
  module.def("is_smooth_file", &is_smooth_file, "path"_a);
}

}  // namespace

void add_files(nb::module_& module) {
  add_inputs(module);
  add_inspected(module);
  module.def(
      "read_mesh",
      [](const std::string& path, const std::string& format, const Hooks& hooks) {
        return run_released(hooks, [&](Context& context) { return read_mesh(path, context, format); });
      },
      "path"_a, "format"_a, "hooks"_a);
  module.def("write_mesh", &write, "mesh"_a, "path"_a, "binary"_a, "version"_a, "compress"_a, "format"_a, "solver"_a,
             "hooks"_a, "Returns what the format could not hold and how it was changed.");
  module.def("convert", &convert, "source"_a, "target"_a, "from_format"_a, "format"_a, "binary"_a, "version"_a,
             "compress"_a, "solver"_a, "hooks"_a);
  module.def("refine", &refine_to_python, "mesh"_a, "geometry"_a.none(), "name"_a, "geometry_name"_a, "levels"_a,
             "feature_angle"_a, "max_cells"_a, "hooks"_a);
  module.def("formats", [] {
    nb::list result;
    for (const FormatInfo& f : formats())
      result.append(nb::make_tuple(f.name, f.title, texts_list(f.extensions), f.can_read, f.can_write));
    return result;
  });
}

}  // namespace delfront::python
