// SPDX-License-Identifier: Apache-2.0
#include "io/cgns/same_bytes.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <vector>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

/// An HDF5 identifier, closed by the function that its kind has.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& shown_path) : id_(id), close_(close) {
    if (id < 0) throw IoError(fmt::format("cannot write {}: HDF5 failed; is the disk full?", shown_path));
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

class Copier {
 public:
  explicit Copier(std::string shown_path) : shown_path_(std::move(shown_path)) {}

  void copy_file(const std::string& from, const std::string& to) {
    const Handle source(H5Fopen(from.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, shown_path_);
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, shown_path_);
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    check(H5Pset_obj_track_times(creation, false));
    hid_t target_id = H5Fcreate(to.c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT);
    {
      const Handle target(target_id, H5Fclose, shown_path_);
      const Handle old_root(H5Gopen2(source, "/", H5P_DEFAULT), H5Gclose, shown_path_);
      const Handle new_root(H5Gopen2(target, "/", H5P_DEFAULT), H5Gclose, shown_path_);
      copy_group(old_root, new_root);
      check(H5Fflush(target, H5F_SCOPE_GLOBAL));
    }
  }

 private:
  void check(herr_t status) const {
    if (status < 0) throw IoError(fmt::format("cannot write {}: HDF5 failed; is the disk full?", shown_path_));
  }

  void copy_group(hid_t from, hid_t to) {
    copy_attributes(from, to);
    H5G_info_t facts;
    check(H5Gget_info(from, &facts));
    for (hsize_t i = 0; i < facts.nlinks; ++i) {
      const std::string name = link_name(from, i);
      const Handle object(H5Oopen(from, name.c_str(), H5P_DEFAULT), H5Oclose, shown_path_);
      H5Iget_type(object) == H5I_GROUP ? copy_child(object, to, name) : copy_array(object, to, name);
    }
  }

  /// In the order of making, as the root and all groups of the library keep it.
  std::string link_name(hid_t group, hsize_t i) const {
    const ssize_t length = H5Lget_name_by_idx(group, ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    check(length < 0 ? -1 : 0);
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    const ssize_t got =
        H5Lget_name_by_idx(group, ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    check(got < 0 ? -1 : 0);
    name.resize(static_cast<std::size_t>(length));
    return name;
  }

  void copy_child(hid_t from, hid_t to, const std::string& name) {
    const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, shown_path_);
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    check(H5Pset_obj_track_times(creation, false));
    const Handle child(H5Gcreate2(to, name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, shown_path_);
    copy_group(from, child);
  }

  void copy_array(hid_t from, hid_t to, const std::string& name) {
    const Handle type(H5Dget_type(from), H5Tclose, shown_path_);
    const Handle space(H5Dget_space(from), H5Sclose, shown_path_);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, shown_path_);
    check(H5Pset_obj_track_times(creation, false));
    const Handle array(H5Dcreate2(to, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                       shown_path_);
    const auto n = static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0));
    std::vector<char> values(n * H5Tget_size(type));
    if (!values.empty()) {
      check(H5Dread(from, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
      check(H5Dwrite(array, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    }
    copy_attributes(from, array);
  }

  void copy_attributes(hid_t from, hid_t to) {
    H5O_info_t facts;
    check(H5Oget_info(from, &facts));
    for (hsize_t i = 0; i < facts.num_attrs; ++i) {
      const Handle old(H5Aopen_by_idx(from, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                       shown_path_);
      const Handle type(H5Aget_type(old), H5Tclose, shown_path_);
      const Handle space(H5Aget_space(old), H5Sclose, shown_path_);
      const auto n = static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0));
      const std::size_t size = H5Tget_size(type);
      std::vector<char> values(n * size);
      check(H5Aread(old, type, values.data()));
      if (H5Tget_class(type) == H5T_STRING)
        for (std::size_t k = 0; k < n; ++k) {
          const auto begin = values.begin() + static_cast<std::ptrdiff_t>(k * size);
          const auto end = begin + static_cast<std::ptrdiff_t>(size);
          std::fill(std::find(begin, end, '\0'), end, '\0');
        }
      char name[256] = {};
      check(H5Aget_name(old, sizeof(name), name) < 0 ? -1 : 0);
      const Handle attribute(H5Acreate2(to, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, shown_path_);
      check(H5Awrite(attribute, type, values.data()));
    }
  }

  std::string shown_path_;
};

}  // namespace

void write_same_bytes(const std::string& from, const std::string& to, const std::string& shown_path) {
  Copier(shown_path).copy_file(from, to);
}

}  // namespace delfront
