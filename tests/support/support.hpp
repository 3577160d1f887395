// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "delfront/mesh.hpp"
#include "delfront/model.hpp"

namespace delfront::fixtures {

/// @brief $DELFRONT_SHARED, else ../shared beside the source tree; empty where it does not exist.
std::optional<std::filesystem::path> shared_data();

/// @brief A folder of this test's own, emptied; removed by the operating system's habits, not by us.
std::filesystem::path scratch_folder(const std::string& name);

/// @brief The same, named after the test that runs.
std::filesystem::path scratch_folder();

/// @brief A number from the environment, as nightly runs set them.
unsigned setting(const char* name, unsigned usual);

/// @brief How often a piece stands in a text.
std::size_t count_of(std::string_view text, std::string_view piece);

/// @brief Unit cube [0,1]^3 of 12 triangles, outward, six patches named xmin … zmax.
Mesh cube_surface();
/// @brief Icosphere of radius 1: 20 * 4^levels triangles, outward.
Mesh sphere_surface(int levels);

}  // namespace delfront::fixtures

/// @brief Skip by name, loudly, where the shared data is not there.
#define DELFRONT_NEEDS_SHARED_DATA(variable)                 \
  const auto variable = ::delfront::fixtures::shared_data(); \
  if (!variable) GTEST_SKIP() << "shared data not found: set DELFRONT_SHARED or put it at ../shared"
