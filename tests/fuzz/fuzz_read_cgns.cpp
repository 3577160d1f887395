// SPDX-License-Identifier: Apache-2.0
// CGNS files that are whole as HDF5 and hold any tree of nodes: a small grid, with what the fuzzer's bytes say changed
// or left out. Types and counts stay as the library wants them, which crashes on others (the program has a child
// process for it): this is to try what we do with what it gives.
#include <cgns_io.h>
#include <cgnslib.h>
#include <fuzzer/FuzzedDataProvider.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <map>
#include <string>
#include <vector>

#include "fuzz_reader.hpp"
#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {
namespace {

struct Node {
  std::string path, label, type = "MT";  ///< types of CGNS: MT none, C1 text, I4, I8, R8
  std::vector<double> values = {};
  std::string text = "";
  std::vector<cgsize_t> extents = {};
};

const std::vector<Node>& nodes() {
  static const std::vector<Node> kNodes = {
      {"/B", "CGNSBase_t", "I4", {3, 3}},
      {"/B/wall", "Family_t"},
      {"/B/wall/FamBC", "FamilyBC_t", "C1", {}, "BCWall"},
      {"/B/wall/Kind", "Descriptor_t", "C1", {}, "slip"},
      {"/B/wall/outer", "FamilyName_t", "C1", {}, "outer"},
      {"/B/Z", "Zone_t", "I8", {5, 2, 0}, "", {1, 3}},
      {"/B/Z/ZoneType", "ZoneType_t", "C1", {}, "Unstructured"},
      {"/B/Z/FamilyName", "FamilyName_t", "C1", {}, "wall"},
      {"/B/Z/GridCoordinates", "GridCoordinates_t"},
      {"/B/Z/GridCoordinates/CoordinateX", "DataArray_t", "R8", {0, 1, 0, 0, 1}},
      {"/B/Z/GridCoordinates/CoordinateY", "DataArray_t", "R8", {0, 0, 1, 0, 1}},
      {"/B/Z/GridCoordinates/CoordinateZ", "DataArray_t", "R8", {0, 0, 0, 1, 1}},
      {"/B/Z/Cells", "Elements_t", "I4", {10, 0}},
      {"/B/Z/Cells/ElementRange", "IndexRange_t", "I8", {1, 2}},
      {"/B/Z/Cells/ElementConnectivity", "DataArray_t", "I8", {1, 2, 3, 4, 2, 3, 4, 5}},
      {"/B/Z/Cells/Region", "Descriptor_t", "C1", {}, "air"},
      {"/B/Z/Mixed", "Elements_t", "I4", {20, 0}},
      {"/B/Z/Mixed/ElementRange", "IndexRange_t", "I8", {3, 4}},
      {"/B/Z/Mixed/ElementConnectivity", "DataArray_t", "I8", {5, 1, 2, 3, 5, 1, 2, 4}},
      {"/B/Z/Mixed/ElementStartOffset", "DataArray_t", "I8", {0, 4, 8}},
      {"/B/Z/ZoneBC", "ZoneBC_t"},
      {"/B/Z/ZoneBC/in", "BC_t", "C1", {}, "FamilySpecified"},
      {"/B/Z/ZoneBC/in/PointRange", "IndexRange_t", "I8", {3, 3}, "", {1, 2}},
      {"/B/Z/ZoneBC/in/GridLocation", "GridLocation_t", "C1", {}, "FaceCenter"},
      {"/B/Z/ZoneBC/in/FamilyName", "FamilyName_t", "C1", {}, "wall"},
      {"/B/Z/ZoneBC/out", "BC_t", "C1", {}, "BCOutflow"},
      {"/B/Z/ZoneBC/out/PointList", "IndexArray_t", "I8", {1, 2, 4}, "", {1, 3}},
      {"/B/Y", "Zone_t", "I8", {3, 1, 0}, "", {1, 3}},
      {"/B/Y/ZoneType", "ZoneType_t", "C1", {}, "Unstructured"},
      {"/B/Y/GridCoordinates", "GridCoordinates_t"},
      {"/B/Y/GridCoordinates/CoordinateX", "DataArray_t", "R8", {0, 1, 0}},
      {"/B/Y/GridCoordinates/CoordinateY", "DataArray_t", "R8", {0, 0, 1}},
      {"/B/Y/Faces", "Elements_t", "I4", {5, 0}},
      {"/B/Y/Faces/ElementRange", "IndexRange_t", "I8", {1, 1}},
      {"/B/Y/Faces/ElementConnectivity", "DataArray_t", "I8", {1, 2, 3}}};
  return kNodes;
}

class Tree {
 public:
  explicit Tree(FuzzedDataProvider& bytes) : bytes_(bytes) {}

  void make(const std::string& path) {
    if (cgio_open_file(path.c_str(), CGIO_MODE_WRITE, CGIO_FILE_HDF5, &file_) != CG_OK) std::abort();
    cgio_get_root_id(file_, &ids_[""]);
    const float version = 3.4F;
    add({"/CGNSLibraryVersion", "CGNSLibraryVersion_t", "R4"}, {1}, &version);
    for (const Node& node : nodes()) make(node);
    cgio_close_file(file_);
  }

 private:
  bool is_odd() { return bytes_.remaining_bytes() > 0 && bytes_.ConsumeIntegralInRange(0, 15) == 0; }

  void make(Node node) {
    const bool may_change = node.label != "ZoneType_t";
    if (may_change && is_odd()) return;
    if (may_change && is_odd()) node.path += "2";
    if (may_change && !node.text.empty() && is_odd())
      node.text = bytes_.ConsumeBool() ? std::string(bytes_.ConsumeIntegralInRange(1, 900), 'x')
                                       : bytes_.ConsumeRandomLengthString(40) + "x";
    if (node.type == "C1") return add(node, {static_cast<cgsize_t>(node.text.size())}, node.text.data());
    if (node.type == "MT") return add(node, {}, nullptr);
    make_numbers(node);
  }

  void make_numbers(Node& node) {
    for (double& value : node.values)
      if (is_odd())
        value = bytes_.ConsumeBool() ? bytes_.ConsumeIntegralInRange(-2, 30) : bytes_.ConsumeIntegral<int>();
    const bool is_array = node.label == "DataArray_t" || node.label == "IndexArray_t";
    if (is_array && is_odd()) node.values.resize(bytes_.ConsumeIntegralInRange<std::size_t>(0, 12));
    if (is_array && is_odd()) node.type = node.type == "R8" ? "R4" : "I4";
    std::vector<cgsize_t> extents = {static_cast<cgsize_t>(node.values.size())};
    if (!node.extents.empty() && node.extents[0] * node.extents[1] == extents[0]) extents = node.extents;
    const auto write = [&]<class T>(T) {
      std::vector<T> values(node.values.size() + 1);
      for (std::size_t i = 0; i < node.values.size(); ++i) values[i] = static_cast<T>(node.values[i]);
      add(node, extents, values.data());
    };
    if (node.type == "I8") return write(std::int64_t());
    if (node.type == "R8") return write(double());
    if (node.type == "R4") return write(float());
    write(std::int32_t());
  }

  void add(const Node& node, const std::vector<cgsize_t>& extents, const void* values) {
    const std::size_t slash = node.path.rfind('/');
    const auto parent = ids_.find(node.path.substr(0, slash));
    if (parent == ids_.end()) return;
    double id = 0;
    if (cgio_create_node(file_, parent->second, node.path.c_str() + slash + 1, &id) != CG_OK) return;
    ids_[node.path] = id;
    std::array<char, 40> label{};  // the library copies all 33 characters
    node.label.copy(label.data(), 32);
    cgio_set_label(file_, id, label.data());
    if (extents.empty() || extents[0] == 0) return;
    if (cgio_set_dimensions(file_, id, node.type.c_str(), static_cast<int>(extents.size()), extents.data()) == CG_OK)
      cgio_write_all_data(file_, id, values);
  }

  FuzzedDataProvider& bytes_;
  int file_ = 0;
  std::map<std::string, double> ids_;
};

/// Tried in a process of its own, since the library leaves files open that it gives up, and crashes on some. (The
/// program has a child process for all of reading.)
bool can_be_opened(const std::string& path) {
  const pid_t child = ::fork();
  if (child == 0) {
    int file = 0;
    ::_exit(cg_open(path.c_str(), CG_MODE_READ, &file) == CG_OK ? 0 : 1);
  }
  int status = 1;
  return ::waitpid(child, &status, 0) == child && status == 0;
}

}  // namespace
}  // namespace delfront

/// The CGNS library itself keeps what it had read when it gives up.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = "/dev/shm/delfront_fuzz_" + std::to_string(::getpid()) + ".cgns";
  FuzzedDataProvider bytes(data, size);
  {
    const delfront::Hdf5Turn turn;
    delfront::Tree(bytes).make(path);
  }
  if (!delfront::can_be_opened(path)) return 0;
  delfront::Context context;
  try {
    const delfront::Mesh mesh = delfront::read_cgns(path, context);
    if (!delfront::is_sound(mesh)) std::abort();
  } catch (const delfront::InputError&) {
  }
  return 0;
}
