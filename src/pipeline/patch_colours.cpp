// SPDX-License-Identifier: Apache-2.0
#include "pipeline/patch_colours.hpp"

#include <algorithm>

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
  ColoursByName result;
  for (std::size_t t = 0; t < before.patch_of_triangle.size(); ++t) {
    const auto old = colours.find(before.names[before.patch_of_triangle[TriangleId(t)].index()]);
    add_colour(model.patches[model.patch_of_triangle[TriangleId(t)]].name, old == colours.end() ? "" : old->second,
               result);
  }
  std::erase_if(result, [](const auto& entry) { return entry.second.empty(); });
  return result;
}

}  // namespace delfront
