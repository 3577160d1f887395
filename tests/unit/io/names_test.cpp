// SPDX-License-Identifier: Apache-2.0
#include "io/names.hpp"

#include <gtest/gtest.h>

namespace delfront {
namespace {

std::vector<std::string> fitted(const std::vector<std::string>& names, NameRule rule, std::size_t num_changed) {
  Mesh mesh;
  for (const std::string& name : names) {
    mesh.groups.push_back(Group());
    mesh.groups[GroupId(mesh.groups.size() - 1)].name = name;
    mesh.groups[GroupId(mesh.groups.size() - 1)].dimension = 2;
  }
  std::vector<std::string> notes;
  std::vector<std::string> result = fit_names(mesh, rule, "X", notes);
  EXPECT_EQ(notes.size(), num_changed);
  return result;
}

using Names = std::vector<std::string>;

TEST(FitNames, names_that_differ_in_case_alone_are_the_same_for_abaqus) {
  EXPECT_EQ(fitted({"Wall", "wall", "WALL", "wall_2"}, NameRule::any_case, 2),
            (Names{"Wall", "wall_3", "WALL_4", "wall_2"}));
  EXPECT_EQ(fitted({"Wall", "wall", "WALL"}, NameRule::foam_word, 0), (Names{"Wall", "wall", "WALL"}));
}

TEST(FitNames, paths_are_no_names_in_hdf5) {
  EXPECT_EQ(fitted({".", "..", "a/b", "..."}, NameRule::cgns, 3), (Names{"_", "__", "a_b", "..."}));
  EXPECT_EQ(fitted({".", "..", "a/b", "..."}, NameRule::hdf5, 3), (Names{"_", "__", "a_b", "..."}));
}

TEST(FitNames, marks_of_comments_are_no_letters_of_words) {
  EXPECT_EQ(fitted({"! x", "%", "a"}, NameRule::word, 2), (Names{"__x", "_", "a"}));
}

}  // namespace
}  // namespace delfront
