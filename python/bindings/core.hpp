// SPDX-License-Identifier: Apache-2.0
// What the parts of the extension module share. All that users see is made of it in python/delfront.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <string>
#include <utility>
#include <vector>

#include "delfront/errors.hpp"
#include "delfront/findings.hpp"
#include "delfront/mesh.hpp"
#include "pipeline/job_value.hpp"

namespace delfront::python {

namespace nb = nanobind;

/// Arrays that are handed out: T const makes them read-only.
template <class T>
using NumpyArray = nb::ndarray<nb::numpy, T, nb::device::cpu>;
/// Arrays that are taken in: C order, of the exact type; python/delfront sees to that.
template <class T, std::size_t N>
using GivenArray = nb::ndarray<const T, nb::ndim<N>, nb::c_contig, nb::device::cpu>;

/// @brief A view of memory that `owner` keeps alive. @param strides  in elements; empty: C order
template <class T>
NumpyArray<const T> view_of(const T* data, std::initializer_list<std::size_t> shape, nb::handle owner,
                            std::initializer_list<std::int64_t> strides = {}) {
  static const T nothing{};  // arrays of no elements have an address too
  return NumpyArray<const T>(data ? data : &nothing, shape, owner, strides);
}

/// @brief An array of its own, moved from a vector.
template <class T>
NumpyArray<T> array_of(std::vector<T> values, std::size_t columns = 0) {
  auto* const held = new std::vector<T>(std::move(values));
  const nb::capsule owner(held, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  if (columns == 0) return NumpyArray<T>(held->data(), {held->size()}, owner);
  return NumpyArray<T>(held->data(), {held->size() / columns, columns}, owner);
}

/// @return the points, (n, 3), and a list of lists of ids
nb::tuple places_tuple(const std::vector<Place>& places);
/// @return a list of dicts with kind, severity, count, message, remedy, places, ids
nb::list findings_list(const std::vector<Finding>& findings);
nb::list texts_list(const std::vector<std::string>& texts);
/// @brief A str of bytes that need not be UTF-8: names come from files. What is none is replaced.
nb::str text_of(const std::string& bytes);

/// @brief Numbers, texts, lists and dicts as a value of a job; arrays and paths too. Entries that are None are left
/// out.
/// @throws UsageError  an object of any other type
JobValue job_value(nb::handle object, const std::string& key = "");

/// @brief Sets Python's error to the exception of delfront that belongs to it.
void set_python_error(const Error& error);

void add_runner(nb::module_& module);
void add_mesh(nb::module_& module);
void add_files(nb::module_& module);
void add_job(nb::module_& module);

}  // namespace delfront::python
