// SPDX-License-Identifier: Apache-2.0
#include "io/cgns/cgns_file.hpp"

#include <cgns_io.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

struct TypeRow {
  CellType type;
  ElementType_t cgns;
};
constexpr TypeRow kTypes[] = {{CellType::vertex, NODE},   {CellType::line, BAR_2},          {CellType::triangle, TRI_3},
                              {CellType::quad, QUAD_4},   {CellType::tetrahedron, TETRA_4}, {CellType::pyramid, PYRA_5},
                              {CellType::prism, PENTA_6}, {CellType::hexahedron, HEXA_8}};

struct KindRow {
  BCType_t condition;
  const char* kind;
};
/// The first of a kind is the one that is written.
constexpr KindRow kKinds[] = {{BCWall, "wall"},
                              {BCWallViscous, "wall"},
                              {BCWallInviscid, "wall"},
                              {BCWallViscousHeatFlux, "wall"},
                              {BCWallViscousIsothermal, "wall"},
                              {BCInflow, "inlet"},
                              {BCInflowSubsonic, "inlet"},
                              {BCInflowSupersonic, "inlet"},
                              {BCTunnelInflow, "inlet"},
                              {BCOutflow, "outlet"},
                              {BCOutflowSubsonic, "outlet"},
                              {BCOutflowSupersonic, "outlet"},
                              {BCTunnelOutflow, "outlet"},
                              {BCFarfield, "farfield"},
                              {BCSymmetryPlane, "symmetry"},
                              {BCSymmetryPolar, "symmetry"}};

/// @return the first child of that name or label, to be released; nothing where there is none
std::optional<double> find_child(int io, double parent, std::string_view wanted) {
  int num_children = 0, num_found = 0;
  cgio_number_children(io, parent, &num_children);
  for (int i = 1; i <= num_children; ++i) {
    double child = 0;
    std::array<char, 33> name{}, label{};
    if (cgio_children_ids(io, parent, i, 1, &num_found, &child) != CG_OK || num_found != 1) continue;
    cgio_get_name(io, child, name.data());
    cgio_get_label(io, child, label.data());
    if (wanted == name.data() || wanted == label.data()) return child;
    cgio_release_id(io, child);
  }
  return std::nullopt;
}

}  // namespace

CgnsFile::CgnsFile(const std::string& path, int mode, std::string shown_path)
    : is_writing_(mode == CG_MODE_WRITE), shown_path_(std::move(shown_path)) {
  if (is_writing_) cg_set_file_type(CG_FILE_HDF5);
  check(cg_open(path.c_str(), mode, &number_), "the file");
}

CgnsFile::~CgnsFile() {
  if (number_ >= 0) cg_close(number_);
}

void CgnsFile::check(int status, const std::string& doing) const {
  if (status == CG_OK) return;
  if (is_writing_) throw IoError(fmt::format("cannot write {}: {}: {}", shown_path_, doing, cg_get_error()));
  throw InputError(fmt::format("{}: {} cannot be read as CGNS: {}; the file is damaged or of another kind", shown_path_,
                               doing, cg_get_error()));
}

std::uint64_t CgnsFile::num_values(std::initializer_list<std::string_view> path) const {
  int io = 0, rank = 0;
  double root = 0;
  check(cg_get_cgio(number_, &io), "the file");
  check(cg_root_id(number_, &root), "the file");
  std::optional<double> node = root;
  for (const std::string_view step : path) {
    const double parent = *node;
    node = find_child(io, parent, step);
    if (parent != root) cgio_release_id(io, parent);
    if (!node) return 0;
  }
  std::array<cgsize_t, CGIO_MAX_DIMENSIONS> extents{};
  const int status = cgio_get_dimensions(io, *node, &rank, extents.data());
  cgio_release_id(io, *node);
  check(status, "the size of an array");
  std::uint64_t n = rank > 0 ? 1 : 0;
  for (int i = 0; i < rank; ++i) n *= static_cast<std::uint64_t>(std::max<cgsize_t>(extents[std::size_t(i)], 0));
  return n;
}

void CgnsFile::close() {
  const int number = number_;
  number_ = -1;
  check(cg_close(number), "the file");
}

std::optional<ElementType_t> cgns_type(CellType type) {
  for (const TypeRow& row : kTypes)
    if (row.type == type) return row.cgns;
  return std::nullopt;
}

std::optional<CellType> type_from_cgns(ElementType_t type) {
  for (const TypeRow& row : kTypes)
    if (row.cgns == type) return row.type;
  return std::nullopt;
}

BCType_t cgns_condition(const std::string& kind) {
  for (const KindRow& row : kKinds)
    if (kind == row.kind) return row.condition;
  return BCTypeUserDefined;
}

std::string kind_from_cgns(BCType_t condition) {
  for (const KindRow& row : kKinds)
    if (condition == row.condition) return row.kind;
  return "";
}

}  // namespace delfront
