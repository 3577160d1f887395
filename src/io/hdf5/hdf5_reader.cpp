// SPDX-License-Identifier: Apache-2.0
// Numbers are those of the standard types alone, in either byte order. Stored bytes bound what is read: all of it where
// an array is stored as it is, and 1032 times as much (the most that deflate can do) where it is compressed.
#include "io/hdf5/hdf5_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "delfront/errors.hpp"
#include "io/whole_numbers.hpp"

namespace delfront {

namespace {

constexpr std::uint64_t kMaxInflation = 1032;
constexpr std::size_t kMaxAttribute = std::size_t{1} << 20;    // bytes
constexpr std::size_t kMaxText = std::size_t{1} << 20;         // characters of one value
constexpr std::uint64_t kMaxCount = std::uint64_t{1} << 42;    // values of an array
constexpr std::uint64_t kPlainChunk = std::uint64_t{1} << 24;  // bytes that a chunk may have in any file

/// Another file is never opened.
herr_t refuse_other_file(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) { return -1; }

bool is_one_of(hid_t type, std::initializer_list<hid_t> known) {
  return std::any_of(known.begin(), known.end(), [&](hid_t candidate) { return H5Tequal(type, candidate) > 0; });
}

std::optional<Hdf5Reader::Holds> what_it_holds(hid_t type) {
  if (is_one_of(type, {H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_IEEE_F32BE, H5T_IEEE_F64BE}))
    return Hdf5Reader::Holds::reals;
  if (is_one_of(type, {H5T_STD_I8LE, H5T_STD_I16LE, H5T_STD_I32LE, H5T_STD_I64LE, H5T_STD_U8LE, H5T_STD_U16LE,
                       H5T_STD_U32LE, H5T_STD_U64LE, H5T_STD_I8BE, H5T_STD_I16BE, H5T_STD_I32BE, H5T_STD_I64BE,
                       H5T_STD_U8BE, H5T_STD_U16BE, H5T_STD_U32BE, H5T_STD_U64BE}))
    return Hdf5Reader::Holds::integers;
  if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) return Hdf5Reader::Holds::text;
  return std::nullopt;
}

herr_t note_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  try {
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

}  // namespace

Hdf5Reader::Hdf5Reader(const std::string& path) : path_(path) {
  std::error_code error;
  file_size_ = std::filesystem::file_size(path, error);
  if (error) throw InputError(fmt::format("cannot read {}: {}", path, error.message()));
  if (file_size_ == 0) throw InputError(fmt::format("{}: the file is empty; export it again", path));
  if (H5Fis_hdf5(path.c_str()) <= 0)
    throw InputError(fmt::format("{}: this is no HDF5 file, or its beginning is damaged", path));
  access_ = Hdf5Handle(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
  H5Pset_elink_cb(access_, refuse_other_file, nullptr);
  file_ = Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file_.is_valid())
    throw InputError(fmt::format("{}: it cannot be opened as HDF5; it is damaged or truncated, export it again", path));
}

void Hdf5Reader::fail(const std::string& where, const std::string& message) const {
  throw InputError(fmt::format("{}: {}: {}", path_, where.substr(0, 200), message));
}

Hdf5Handle Hdf5Reader::open(const std::string& path) const { return {H5Oopen(file_, path.c_str(), access_), H5Oclose}; }

bool Hdf5Reader::has(const std::string& path) const { return open(path).is_valid(); }

bool Hdf5Reader::has_group(const std::string& path) const {
  const Hdf5Handle object = open(path);
  return object.is_valid() && H5Iget_type(object) == H5I_GROUP;
}

std::optional<Hdf5Reader::Array> Hdf5Reader::find_array(const std::string& path) const {
  Array array;
  array.path = path;
  array.id = open(path);
  if (!array.id.is_valid()) return std::nullopt;
  if (H5Iget_type(array.id) != H5I_DATASET) fail(path, "an array should stand here, and this is none");
  const Hdf5Handle type(H5Dget_type(array.id), H5Tclose), space(H5Dget_space(array.id), H5Sclose);
  const auto holds = type.is_valid() ? what_it_holds(type) : std::nullopt;
  if (!holds) fail(path, "its values are of a type that is not read; whole numbers and reals of 1 to 8 bytes are");
  array.holds = *holds;
  array.value_size = H5Tget_size(type);
  if (array.value_size < 1 || array.value_size > kMaxText) fail(path, "its texts are too long; the file is damaged");
  array.shape = extents_of(array.id, path);
  if (H5Sget_simple_extent_type(space) == H5S_NULL) array.count = 0;
  for (const std::uint64_t extent : array.shape) {
    if (extent > 0 && array.count > kMaxCount / extent) fail(path, "its size cannot be; the file is damaged");
    array.count *= extent;
  }
  check_storage(array);
  return array;
}

std::vector<std::uint64_t> Hdf5Reader::extents_of(hid_t dataset, const std::string& path) const {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = space.is_valid() ? H5Sget_simple_extent_ndims(space) : -1;
  if (rank < 0 || rank > H5S_MAX_RANK) fail(path, "it has no shape; the file is damaged");
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  if (rank > 0) H5Sget_simple_extent_dims(space, extents.data(), nullptr);
  return {extents.begin(), extents.end()};
}

std::vector<std::uint64_t> Hdf5Reader::shape(const std::string& path) const {
  const Hdf5Handle object = open(path);
  if (!object.is_valid() || H5Iget_type(object) != H5I_DATASET) return {};
  return extents_of(object, path);
}

Hdf5Reader::Array Hdf5Reader::array(const std::string& path) const {
  std::optional<Array> found = find_array(path);
  if (!found) fail(path, "it is not there (links to other files are not followed); the file is damaged or incomplete");
  return std::move(*found);
}

void Hdf5Reader::check_storage(const Array& array) const {
  const Hdf5Handle creation(H5Dget_create_plist(array.id), H5Pclose);
  if (!creation.is_valid()) fail(array.path, "it cannot be read; the file is damaged");
  if (H5Pget_external_count(creation) > 0) fail(array.path, "its values stand in another file, which is not read");
  const H5D_layout_t layout = H5Pget_layout(creation);
  if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT)
    fail(array.path, "it is stored in a way that is not read (virtual); copy the file with h5repack");
  const int num_filters = std::max(H5Pget_nfilters(creation), 0);
  for (int i = 0; i < num_filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t num_values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &num_values, nullptr, 0, nullptr, &config);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      fail(array.path, fmt::format("it is compressed by filter {}, which is not read; h5repack -f GZIP=6 changes that",
                                   static_cast<int>(filter)));
  }
  if (layout == H5D_CHUNKED) check_chunks(array, creation);
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(array.id), file_size_);
  const std::uint64_t most = num_filters > 0 ? stored * kMaxInflation : stored;
  if (array.count * array.value_size / kMaxInflation > file_size_ || array.count * array.value_size > most)
    fail(array.path,
         fmt::format("{} values are announced, and {} bytes are stored; the file is damaged", array.count, stored));
}

/// The library takes memory for a whole chunk at once.
void Hdf5Reader::check_chunks(const Array& array, hid_t creation) const {
  std::vector<hsize_t> chunk(array.shape.size());
  std::uint64_t bytes = array.value_size;
  if (H5Pget_chunk(creation, static_cast<int>(chunk.size()), chunk.data()) < 0)
    fail(array.path, "its chunks have no shape; the file is damaged");
  for (const hsize_t extent : chunk) {
    if (extent == 0 || extent > kMaxCount || bytes > kMaxCount / extent)
      fail(array.path, "the size of its chunks cannot be; the file is damaged");
    bytes *= extent;
  }
  if (bytes > std::max(kPlainChunk, file_size_ * kMaxInflation))
    fail(array.path, fmt::format("chunks of {} bytes in a file of {}; it is damaged", bytes, file_size_));
}

void Hdf5Reader::read(const Array& array, hid_t type, void* values) const {
  if (array.count > 0 && H5Dread(array.id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    fail(array.path, "its values cannot be read; the file is damaged or truncated");
}

std::vector<double> Hdf5Reader::reals(const Array& array) const {
  if (array.holds == Holds::text) fail(array.path, "it holds text where numbers should stand");
  std::vector<double> values(array.count);
  read(array, H5T_NATIVE_DOUBLE, values.data());
  return values;
}

std::vector<std::int64_t> Hdf5Reader::integers(const Array& array) const {
  if (array.holds == Holds::reals)
    return to_whole(reals(array), [&](const std::string& message) { fail(array.path, message); });
  if (array.holds == Holds::text) fail(array.path, "it holds text where whole numbers should stand");
  std::vector<std::int64_t> values(array.count);
  read(array, H5T_NATIVE_INT64, values.data());
  return values;
}

std::string Hdf5Reader::text(const Array& array) const {
  if (array.holds != Holds::text) fail(array.path, "it holds numbers where text should stand");
  std::string values(array.count * array.value_size, '\0');
  const Hdf5Handle type(H5Dget_type(array.id), H5Tclose);
  read(array, type, values.data());
  return values;
}

std::string Hdf5Reader::text_attribute(const std::string& path, const std::string& name) const {
  const Hdf5Handle object = open(path);
  if (!object.is_valid() || H5Aexists(object, name.c_str()) <= 0) return "";
  const Hdf5Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(attribute.is_valid() ? H5Aget_type(attribute) : -1, H5Tclose);
  const Hdf5Handle space(attribute.is_valid() ? H5Aget_space(attribute) : -1, H5Sclose);
  if (!type.is_valid() || !space.is_valid() || H5Tget_class(type) != H5T_STRING ||
      H5Sget_simple_extent_npoints(space) != 1)
    return "";
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute, type, &text) < 0 || !text) return "";
    std::string found(text, std::find(text, text + kMaxAttribute, '\0'));
    H5free_memory(text);
    return found;
  }
  const std::size_t size = H5Tget_size(type);
  if (size > std::min<std::uint64_t>(kMaxAttribute, file_size_)) return "";
  std::string found(size, '\0');
  if (H5Aread(attribute, type, found.data()) < 0) return "";
  found.resize(std::min(found.find('\0'), found.size()));
  return found;
}

std::vector<std::int64_t> Hdf5Reader::integer_attribute(const std::string& path, const std::string& name) const {
  constexpr hssize_t kMost = 1000;
  const Hdf5Handle object = open(path);
  if (!object.is_valid() || H5Aexists(object, name.c_str()) <= 0) return {};
  const Hdf5Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(attribute.is_valid() ? H5Aget_type(attribute) : -1, H5Tclose);
  const Hdf5Handle space(attribute.is_valid() ? H5Aget_space(attribute) : -1, H5Sclose);
  if (!type.is_valid() || !space.is_valid() || what_it_holds(type) != Holds::integers) return {};
  const hssize_t n = H5Sget_simple_extent_npoints(space);
  if (n < 1 || n > kMost) return {};
  std::vector<std::int64_t> values(static_cast<std::size_t>(n));
  if (H5Aread(attribute, H5T_NATIVE_INT64, values.data()) < 0) return {};
  return values;
}

std::vector<std::string> Hdf5Reader::names(const std::string& path) const {
  const Hdf5Handle group = open(path);
  std::vector<std::string> found;
  if (!group.is_valid() && H5Lexists(file_, path.c_str(), H5P_DEFAULT) <= 0) return found;
  if (!group.is_valid()) fail(path, "it is not there (links to other files are not followed)");
  if (H5Iget_type(group) != H5I_GROUP) fail(path, "a group should stand here, and this is none");
  const Hdf5Handle creation(H5Gget_create_plist(group), H5Pclose);
  unsigned order = 0;
  if (creation.is_valid()) H5Pget_link_creation_order(creation, &order);
  const H5_index_t index = order & H5P_CRT_ORDER_TRACKED ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
  hsize_t at = 0;
  if (H5Literate(group, index, H5_ITER_INC, &at, note_name, &found) < 0)
    fail(path, "what is in this group cannot be listed; the file is damaged");
  return found;
}

}  // namespace delfront
