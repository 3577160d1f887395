// SPDX-License-Identifier: Apache-2.0
#include "pipeline/patch_colours.hpp"

#include <algorithm>
#include <optional>

namespace delfront {

/// A second colour under a name leaves none.
static void add_colour(const std::string& name, const std::string& colour, ColoursByName& colours) {
  const auto [place, is_new] = colours.emplace(name, colour);
  if (!is_new && place->second != colour) place->second.clear();
}

void add_face_colours(const Brep& brep, const CadReport& cad, const std::string& stem, ColoursByName& colours) {
  const std::size_t count = std::min(cad.faces.size(), brep.faces.size());
  for (std::size_t f = 0; f < count; ++f) {
    const std::string& name = brep.faces[FaceId(f)].name;
    add_colour(name.empty() ? stem : name, cad.faces[f].colour, colours);
  }
}

PatchesBefore::PatchesBefore(const Model& model) : patch_of_triangle(model.patch_of_triangle) {
  for (const Patch& patch : model.patches) names.push_back(patch.name);
}

ColoursByName colours_after(const PatchesBefore& before, const Model& model, const ColoursByName& colours) {
  if (colours.empty()) return {};
  std::vector<std::string> old_colour;  // by patch as it was
  for (const std::string& name : before.names) {
    const auto it = colours.find(name);
    old_colour.push_back(it == colours.end() ? "" : it->second);
  }
  std::vector<std::optional<std::string>> new_colour(model.patches.size());
  for (std::size_t t = 0; t < before.patch_of_triangle.size(); ++t) {
    const std::string& colour = old_colour[before.patch_of_triangle[TriangleId(t)].index()];
    std::optional<std::string>& now = new_colour[model.patch_of_triangle[TriangleId(t)].index()];
    if (!now)
      now = colour;
    else if (*now != colour)
      now = "";
  }
  ColoursByName result;
  for (std::size_t p = 0; p < new_colour.size(); ++p)
    if (new_colour[p] && !new_colour[p]->empty()) result.emplace(model.patches[PatchId(p)].name, *new_colour[p]);
  return result;
}

}  // namespace delfront
