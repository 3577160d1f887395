// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <unordered_map>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief Mesh::add_group for one dimension and very many names: each is found in constant time.
class NamedGroups {
 public:
  /// Groups that the mesh has already count; those that it gets from elsewhere later do not.
  NamedGroups(Mesh& mesh, int dimension) : mesh_(mesh), dimension_(dimension) {
    for (std::size_t g = 0; g < mesh.groups.size(); ++g)
      if (mesh.groups[GroupId(g)].dimension == dimension) groups_.try_emplace(mesh.groups[GroupId(g)].name, g);
  }

  /// @brief The group of that name, added where there is none.
  GroupId operator()(std::string_view name) {
    const auto [it, is_new] = groups_.try_emplace(std::string(name), mesh_.groups.size());
    if (is_new) mesh_.groups.push_back({it->first, dimension_, "", false});
    return it->second;
  }

 private:
  Mesh& mesh_;
  int dimension_;
  std::unordered_map<std::string, GroupId> groups_;
};

}  // namespace delfront
