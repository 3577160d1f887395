// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cgnslib.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "delfront/mesh.hpp"
#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {

/// @brief An open CGNS file; closed at the end whatever happens. The library keeps the place it is at in one variable:
/// hold a Hdf5Turn as long as one of these is there.
class CgnsFile {
 public:
  /// @throws InputError (reading), IoError (writing)  with the library's reason
  CgnsFile(const std::string& path, int mode, std::string shown_path);
  ~CgnsFile();
  CgnsFile(const CgnsFile&) = delete;
  CgnsFile& operator=(const CgnsFile&) = delete;

  int number() const { return number_; }
  /// @brief Throws where a call of the library failed. @param doing  "the coordinates of zone 'x'", …
  void check(int status, const std::string& doing) const;
  /// @brief How many numbers a node really holds, which the library copies whole whatever room it has asked for.
  /// @param path  names, or labels of nodes of which there is one: {"Base", "Zone", "ZoneBC_t", "wall", "PointList"}
  /// @return 0 where there is no such node
  std::uint64_t num_values(std::initializer_list<std::string_view> path) const;
  /// @brief Close it now and check that.
  void close();

 private:
  int number_ = -1;
  bool is_writing_;
  std::string shown_path_;
};

/// @brief CGNS's type of linear cells, whose vertices it orders as Mesh does; and back.
std::optional<ElementType_t> cgns_type(CellType type);
std::optional<CellType> type_from_cgns(ElementType_t type);

/// @brief BC type of a boundary kind, BCTypeUserDefined where there is none; and back, "" for none.
BCType_t cgns_condition(const std::string& kind);
std::string kind_from_cgns(BCType_t condition);

inline constexpr const char* kRegionMark = "Region";  ///< descriptor of a section: the region of its cells
inline constexpr const char* kKindMark = "Kind";  ///< descriptor of a family: the kind, where the BC type cannot say it

}  // namespace delfront
