// SPDX-License-Identifier: Apache-2.0
#include "io/hdf5/hdf5_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;  // values
constexpr unsigned kDeflate = 6;
constexpr std::size_t kLeastCompressed = 8192;  // bytes: the index of an array's chunks takes 2000 to 3000

void keep_order(hid_t creation) {
  H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_obj_track_times(creation, false);
}

}  // namespace

void Hdf5Writer::check(herr_t status) const {
  if (status < 0) throw IoError(fmt::format("cannot write {}: HDF5 failed; is the disk full?", shown_path_));
}

Hdf5Handle Hdf5Writer::checked(hid_t id, herr_t (*closer)(hid_t)) const {
  check(id < 0 ? -1 : 0);
  return {id, closer};
}

Hdf5Writer::Hdf5Writer(const std::string& path, std::string shown_path, bool compress)
    : shown_path_(std::move(shown_path)), compress_(compress && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
  const Hdf5Handle creation = checked(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  keep_order(creation);
  file_ = checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT), H5Fclose);
}

Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::close() {
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
  check(file_.reset());
}

void Hdf5Writer::add_group(const std::string& path) {
  const Hdf5Handle creation = checked(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  keep_order(creation);
  checked(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose);
}

Hdf5Handle Hdf5Writer::make_array(const std::string& path, hid_t type, std::size_t total, std::size_t columns) {
  const std::array<hsize_t, 2> extents = {columns > 0 ? total / columns : total, columns};
  const int rank = columns > 0 ? 2 : 1;
  const Hdf5Handle creation = checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  check(H5Pset_obj_track_times(creation, false));
  if (compress_ && total * H5Tget_size(type) >= kLeastCompressed) {
    const hsize_t rows = std::max<hsize_t>(kChunk / std::max<std::size_t>(columns, 1), 1);
    const std::array<hsize_t, 2> chunk = {std::min(extents[0], rows), columns};
    check(H5Pset_chunk(creation, rank, chunk.data()));
    check(H5Pset_shuffle(creation));
    check(H5Pset_deflate(creation, kDeflate));
  }
  const Hdf5Handle space = checked(H5Screate_simple(rank, extents.data(), nullptr), H5Sclose);
  return checked(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
}

void Hdf5Writer::write_piece(hid_t array, hid_t type, const void* values, std::size_t first, std::size_t count,
                             std::size_t columns) {
  if (count == 0) return;
  const std::size_t width = std::max<std::size_t>(columns, 1);
  const std::array<hsize_t, 2> begin = {first / width, 0}, extents = {count / width, columns};
  const Hdf5Handle there = checked(H5Dget_space(array), H5Sclose);
  check(H5Sselect_hyperslab(there, H5S_SELECT_SET, begin.data(), nullptr, extents.data(), nullptr));
  const Hdf5Handle here = checked(H5Screate_simple(columns > 0 ? 2 : 1, extents.data(), nullptr), H5Sclose);
  check(H5Dwrite(array, type, here, there, H5P_DEFAULT, values));
}

void Hdf5Writer::add_integers(const std::string& path, std::span<const std::span<const std::uint32_t>> pieces) {
  add_pieces<std::uint32_t>(path, pieces, H5T_NATIVE_INT64, 0);
}

void Hdf5Writer::add_attribute(const std::string& path, const std::string& name, std::span<const std::int64_t> values) {
  const Hdf5Handle object = checked(H5Oopen(file_, path.c_str(), H5P_DEFAULT), H5Oclose);
  const hsize_t extent = values.size();
  const Hdf5Handle space = checked(H5Screate_simple(1, &extent, nullptr), H5Sclose);
  const Hdf5Handle attribute =
      checked(H5Acreate2(object, name.c_str(), H5T_NATIVE_INT64, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(H5Awrite(attribute, H5T_NATIVE_INT64, values.data()));
}

void Hdf5Writer::add_attribute(const std::string& path, const std::string& name, const std::string& text) {
  const Hdf5Handle object = checked(H5Oopen(file_, path.c_str(), H5P_DEFAULT), H5Oclose);
  const Hdf5Handle space = checked(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle type = checked(H5Tcopy(H5T_C_S1), H5Tclose);
  check(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)));
  check(H5Tset_strpad(type, H5T_STR_NULLPAD));
  const Hdf5Handle attribute =
      checked(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(H5Awrite(attribute, type, text.c_str()));
}

}  // namespace delfront
