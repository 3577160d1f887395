// SPDX-License-Identifier: Apache-2.0
#include "hdf5_recipe.hpp"

namespace {

const std::vector<delfront::RecipeObject>& objects() {
  static const std::vector<delfront::RecipeObject> kObjects = {
      {.path = "/VTKHDF/", .attribute = "Type", .attribute_text = "UnstructuredGrid"},
      {.path = "/VTKHDF/NumberOfPoints", .values = {4, 3}},
      {.path = "/VTKHDF/NumberOfCells", .values = {2, 1}},
      {.path = "/VTKHDF/NumberOfConnectivityIds", .values = {7, 3}},
      {.path = "/VTKHDF/Types", .values = {10, 5, 5}},
      {.path = "/VTKHDF/Offsets", .values = {0, 4, 7, 0, 3}},
      {.path = "/VTKHDF/Connectivity", .values = {0, 1, 2, 3, 0, 2, 1, 0, 1, 2}},
      {.path = "/VTKHDF/Points",
       .values = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 0, 0, 6, 0, 0, 5, 1, 0},
       .is_real = true,
       .columns = 3},
      {.path = "/VTKHDF/PointData/"},
      {.path = "/VTKHDF/PointData/t", .values = {1, 2, 3, 4, 5, 6, 7}, .is_real = true},
      {.path = "/VTKHDF/CellData/"},
      {.path = "/VTKHDF/CellData/patch_id", .values = {-1, 0, 3}},
      {.path = "/VTKHDF/CellData/region_id", .values = {0, -1, -1}},
      {.path = "/VTKHDF/FieldData/"},
      {.path = "/VTKHDF/FieldData/patch:a", .values = {0, 2}, .attribute = "kind", .attribute_text = "wall"},
      {.path = "/VTKHDF/FieldData/region:b", .values = {0, 3}}};
  return kObjects;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return delfront::fuzz_hdf5(data, size, objects(), delfront::read_vtkhdf);
}
