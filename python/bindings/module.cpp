// SPDX-License-Identifier: Apache-2.0
// delfront._core: the library for the package in python/delfront, which is what users import.
#include <nanobind/stl/string.h>

#include <exception>

#include "core.hpp"
#include "delfront/cad.hpp"
#include "delfront/version.hpp"

namespace {

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const delfront::Error& e) {
    delfront::python::set_python_error(e);
  }
}

}  // namespace

NB_MODULE(_core, module) {
  namespace py = delfront::python;
  module.doc() = "The compiled part of delfront: use the package delfront, whose functions are made of these.";
  module.attr("__version__") = delfront::kVersion;
  nanobind::set_leak_warnings(false);  // what a traceback holds when Python ends is nobody's mistake
  nanobind::register_exception_translator(translate);
  py::add_runner(module);
  py::add_mesh(module);
  py::add_files(module);
  py::add_job(module);
  module.def(
      "has_cad",
      [] {
        std::string why;
        const bool has = delfront::has_cad_module(why);
        return nanobind::make_tuple(has, why);
      },
      "Whether CAD files can be read; and by what, or why not.");
}
