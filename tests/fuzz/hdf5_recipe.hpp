// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fuzzer/FuzzedDataProvider.h>
#include <hdf5.h>
#include <unistd.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "fuzz_reader.hpp"
#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {

/// @brief An object that a file should have, with values that make it a valid one.
struct RecipeObject {
  std::string path;  ///< groups end in '/'
  std::vector<double> values = {};
  bool is_real = false;
  std::string text = "";  ///< not empty: characters
  hsize_t columns = 0;
  std::string attribute = "", attribute_text = "";
};

/// @brief Makes HDF5 files that are whole as such and hold anything: what the bytes of a fuzzer say of each object.
/// (Bytes that are no HDF5 would try the library, not what we do with it.)
class Recipe {
 public:
  Recipe(FuzzedDataProvider& bytes, std::string path) : bytes_(bytes), path_(std::move(path)) {}

  void make(std::span<const RecipeObject> objects) {
    const Hdf5Turn turn;
    file_ = Hdf5Handle(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    for (const RecipeObject& object : objects) {
      const int what = bytes_.remaining_bytes() > 0 ? bytes_.ConsumeIntegralInRange(0, 15) : 0;
      if (object.path.ends_with('/')) {
        if (what < 15) make_group(object);
      } else if (what < 8) {
        make_whole(object);
      } else if (what < 12) {
        make_odd(object);
      } else if (what < 15) {
        make_link(object, objects);
      }
    }
    file_.reset();
  }

 private:
  void make_group(const RecipeObject& object) {
    const Hdf5Handle group(
        H5Gcreate2(file_, object.path.substr(0, object.path.size() - 1).c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Gclose);
    add_attributes(group, object);
  }

  /// Text as the object says, and now and then a number of another size.
  void add_attributes(hid_t to, const RecipeObject& object) {
    if (to < 0 || object.attribute.empty()) return;
    const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose), type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, object.attribute_text.size());
    const Hdf5Handle attribute(H5Acreate2(to, object.attribute.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    H5Awrite(attribute, type, object.attribute_text.c_str());
    if (object.attribute != "Type") return;
    const hsize_t two = 2;
    const Hdf5Handle pair(H5Screate_simple(1, &two, nullptr), H5Sclose);
    const std::int64_t version[] = {2, 0};
    const Hdf5Handle number(H5Acreate2(to, "Version", H5T_NATIVE_INT64, pair, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    H5Awrite(number, H5T_NATIVE_INT64, version);
  }

  void make_whole(const RecipeObject& object) {
    std::vector<double> values = object.values;
    for (double& value : values)
      if (bytes_.remaining_bytes() > 0 && bytes_.ConsumeIntegralInRange(0, 7) == 0)
        value =
            bytes_.ConsumeBool() ? bytes_.ConsumeIntegralInRange<int>(-2, 12) : bytes_.ConsumeFloatingPoint<double>();
    if (!object.text.empty()) {
      const hsize_t extents[] = {object.columns > 0 ? object.text.size() / object.columns : object.text.size(),
                                 object.columns};
      return make_array(object, H5T_C_S1, {extents, extents + (object.columns > 0 ? 2 : 1)}, object.text.data(),
                        H5T_C_S1);
    }
    std::vector<hsize_t> extents = {values.size()};
    if (object.columns > 0) extents = {values.size() / object.columns, object.columns};
    make_array(object, object.is_real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, extents, values.data(),
               H5T_NATIVE_DOUBLE);
  }

  /// Any type and shape; values only where they are few.
  void make_odd(const RecipeObject& object) {
    const hid_t types[] = {H5T_STD_I8LE,  H5T_STD_U8BE,    H5T_STD_I16BE,  H5T_STD_U32LE,
                           H5T_STD_U64LE, H5T_STD_I64BE,   H5T_IEEE_F32LE, H5T_IEEE_F64BE,
                           H5T_C_S1,      H5T_STD_REF_OBJ, H5T_STD_B16LE,  H5T_STD_I64LE};
    const hid_t type = types[bytes_.ConsumeIntegralInRange<std::size_t>(0, std::size(types) - 1)];
    std::vector<hsize_t> extents;
    hsize_t count = 1;
    for (int rank = bytes_.ConsumeIntegralInRange(0, 3); rank > 0; --rank) {
      extents.push_back(bytes_.ConsumeIntegralInRange(0, 9) > 0 ? bytes_.ConsumeIntegralInRange<hsize_t>(0, 12)
                                                                : bytes_.ConsumeIntegral<std::uint32_t>());
      count = extents.back() < 100 ? count * extents.back() : 1 << 20;
    }
    std::vector<std::uint8_t> values;
    if (count * H5Tget_size(type) <= 4096) values = bytes_.ConsumeBytes<std::uint8_t>(count * H5Tget_size(type));
    values.resize(4096);
    make_array(object, type, extents, count * H5Tget_size(type) <= 4096 ? values.data() : nullptr, type);
  }

  void make_array(const RecipeObject& object, hid_t type, const std::vector<hsize_t>& extents, const void* values,
                  hid_t type_of_values) {
    const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const int storage = bytes_.remaining_bytes() > 0 ? bytes_.ConsumeIntegralInRange(0, 9) : 0;
    if (storage >= 7 && !extents.empty()) {
      std::vector<hsize_t> chunk;
      for (const hsize_t extent : extents) chunk.push_back(std::clamp<hsize_t>(extent, 1, 8));
      H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
      if (storage >= 8) H5Pset_shuffle(creation);
      if (storage >= 8) H5Pset_deflate(creation, 1);
      if (storage == 9) H5Pset_fletcher32(creation);
    }
    const Hdf5Handle space(extents.empty()
                               ? H5Screate(H5S_SCALAR)
                               : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                           H5Sclose);
    const Hdf5Handle array(H5Dcreate2(file_, object.path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                           H5Dclose);
    if (!array.is_valid()) return;
    if (values) H5Dwrite(array, type_of_values, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    add_attributes(array, object);
  }

  void make_link(const RecipeObject& object, std::span<const RecipeObject> objects) {
    const RecipeObject& other = objects[bytes_.ConsumeIntegralInRange<std::size_t>(0, objects.size() - 1)];
    std::string target = other.path;
    if (target.ends_with('/')) target.pop_back();
    switch (bytes_.ConsumeIntegralInRange(0, 2)) {
      case 0:
        H5Lcreate_soft(target.c_str(), file_, object.path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        return;
      case 1:
        H5Lcreate_hard(file_, target.c_str(), file_, object.path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        return;
      default:
        H5Lcreate_external(path_.c_str(), target.c_str(), file_, object.path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    }
  }

  FuzzedDataProvider& bytes_;
  std::string path_;
  Hdf5Handle file_;
};

/// @brief One run: make a file, read it. @param read  by name
template <class Read>
int fuzz_hdf5(const std::uint8_t* data, std::size_t size, std::span<const RecipeObject> objects, Read&& read) {
  const std::string path = "/dev/shm/delfront_fuzz_" + std::to_string(::getpid()) + ".h5";
  FuzzedDataProvider bytes(data, size);
  Recipe(bytes, path).make(objects);
  Context context;
  try {
    const Mesh mesh = read(path, context);
    if (!is_sound(mesh)) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}

}  // namespace delfront
