// SPDX-License-Identifier: Apache-2.0
// Exodus in netCDF-4.
#include "hdf5_recipe.hpp"

namespace {

const std::vector<delfront::RecipeObject>& objects() {
  static const std::vector<delfront::RecipeObject> kObjects = {
      {.path = "/coordx", .values = {0, 1, 0, 0, 1}, .is_real = true},
      {.path = "/coordy", .values = {0, 0, 1, 0, 1}, .is_real = true},
      {.path = "/coordz", .values = {0, 0, 0, 1, 1}, .is_real = true},
      {.path = "/num_el_blk", .values = {0, 0}},
      {.path = "/eb_prop1", .values = {1, 7}},
      {.path = "/eb_names", .text = std::string("air\0sk\0\0", 8), .columns = 4},
      {.path = "/connect1", .values = {1, 2, 3, 4}, .columns = 4, .attribute = "elem_type", .attribute_text = "TETRA"},
      {.path = "/connect2", .values = {1, 2, 3}, .columns = 3, .attribute = "elem_type", .attribute_text = "SHELL"},
      {.path = "/num_side_sets", .values = {0, 0}},
      {.path = "/ss_prop1", .values = {1, 2}},
      {.path = "/ss_names", .text = "wall____", .columns = 4},
      {.path = "/elem_ss1", .values = {1, 2}},
      {.path = "/side_ss1", .values = {2, 1}},
      {.path = "/elem_ss2", .values = {1}},
      {.path = "/side_ss2", .values = {4}}};
  return kObjects;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = [](const std::string& path, delfront::Context& context) {
    return delfront::read_exodus("\x89HDF", path, context);
  };
  return delfront::fuzz_hdf5(data, size, objects(), read);
}
