// SPDX-License-Identifier: Apache-2.0
// What goes between Python's objects and the library's plain data.
#include <fmt/format.h>
#include <nanobind/stl/string.h>

#include <limits>

#include "core.hpp"
#include "pipeline/report_json.hpp"

namespace delfront::python {

nb::str text_of(const std::string& bytes) {
  return nb::steal<nb::str>(PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "replace"));
}

nb::tuple places_tuple(const std::vector<Place>& places) {
  std::vector<double> at;
  nb::list ids;
  for (const Place& place : places) {
    at.insert(at.end(), {place.at.x, place.at.y, place.at.z});
    nb::list of_place;
    for (const std::uint32_t id : place.ids) of_place.append(id);
    ids.append(of_place);
  }
  return nb::make_tuple(array_of(std::move(at), 3), ids);
}

nb::list findings_list(const std::vector<Finding>& findings) {
  nb::list result;
  for (const Finding& f : findings) {
    const nb::tuple places = places_tuple(f.places);
    nb::dict finding;
    finding["kind"] = f.kind;
    finding["severity"] = severity_name(f.severity);
    finding["count"] = f.count;
    finding["message"] = text_of(f.message);
    finding["remedy"] = text_of(f.remedy);
    finding["places"] = places[0];
    finding["ids"] = places[1];
    result.append(finding);
  }
  return result;
}

nb::list texts_list(const std::vector<std::string>& texts) {
  nb::list result;
  for (const std::string& text : texts) result.append(text_of(text));
  return result;
}

static JobValue integer_value(nb::handle object) {
  int overflow = 0;
  const long long value = PyLong_AsLongLongAndOverflow(object.ptr(), &overflow);
  if (overflow == 0) return JobValue::of(std::int64_t{value});
  return JobValue::of(overflow > 0 ? std::numeric_limits<double>::infinity()
                                   : -std::numeric_limits<double>::infinity());
}

static JobValue table_value(nb::handle object, const std::string& key) {
  JobValue value = JobValue::table();
  for (const auto [name, item] : nb::borrow<nb::dict>(object)) {
    if (!nb::isinstance<nb::str>(name))
      throw UsageError(fmt::format("{}: keys are texts; got {}", key.empty() ? "the job" : key,
                                   nb::cast<std::string>(nb::repr(name))));
    if (item.is_none()) continue;
    const std::string text = nb::cast<std::string>(name);
    value.add(text, job_value(item, key.empty() ? text : key + "." + text));
  }
  return value;
}

JobValue job_value(nb::handle object, const std::string& key) {
  if (PyBool_Check(object.ptr())) return JobValue::of(object.ptr() == Py_True);
  if (PyLong_Check(object.ptr())) return integer_value(object);
  if (PyFloat_Check(object.ptr())) return JobValue::of(PyFloat_AsDouble(object.ptr()));
  if (PyUnicode_Check(object.ptr())) return JobValue::of(nb::cast<std::string>(object));
  if (PyDict_Check(object.ptr())) return table_value(object, key);
  if (nb::hasattr(object, "__fspath__")) return job_value(object.attr("__fspath__")(), key);
  if (nb::hasattr(object, "tolist")) return job_value(object.attr("tolist")(), key);  // numpy's arrays and scalars
  if (!PyList_Check(object.ptr()) && !PyTuple_Check(object.ptr()))
    throw UsageError(fmt::format("{}: expected a number, a text, a list or a dict; got {}", key.empty() ? "job" : key,
                                 nb::cast<std::string>(nb::repr(object.type()))));
  JobValue list = JobValue::list();
  for (const nb::handle item : nb::borrow<nb::sequence>(object)) list.items.push_back(job_value(item, key));
  return list;
}

void set_python_error(const Error& error) {
  const nb::tuple places = places_tuple(error.places);
  const nb::object made =
      nb::module_::import_("delfront._errors")
          .attr("make_error")(static_cast<int>(error.exit_code), text_of(error.what()), places[0], places[1]);
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
}

}  // namespace delfront::python
