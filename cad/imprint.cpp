// SPDX-License-Identifier: Apache-2.0
// Several solids and sheets. What coincides as it is becomes one by hashing (merge_common.cpp); those that touch or
// cross elsewhere go, in groups, through the general fuse: faces are cut by each other, and the common part is one face
// of both. Where solids overlap, what they have in common becomes a solid of its own.
#include <BOPAlgo_Builder.hxx>
#include <BRepTools_History.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Vertex.hxx>
#include <vector>

#include "fmt/format.h"
#include "geometry.hpp"
#include "translation.hpp"

namespace delfront::cad {
namespace {

std::size_t count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape all;
  TopExp::MapShapes(shape, kind, all);
  return std::size_t(all.Extent());
}

std::string place_of(const TopoDS_Shape& shape) {
  const TopExp_Explorer vertex(shape, TopAbs_VERTEX);
  if (!vertex.More()) return "?";
  const Point p = point_of(BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current())));
  return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z);
}

/// @return null where OpenCASCADE gives up
TopoDS_Shape fuse(const TopTools_IndexedMapOfShape& pieces, const std::vector<int>& group, const Say& say,
                  Handle(BRepTools_History) & history) {
  BOPAlgo_Builder builder;
  for (const int p : group) builder.AddArgument(pieces(p + 1));
  builder.SetNonDestructive(true);
  builder.SetRunParallel(false);
  Watch watch(say, "joining solids");
  try {
    builder.Perform(watch.range());
  } catch (const Standard_Failure&) {
    return {};
  }
  watch.check();
  if (builder.HasErrors() || builder.Shape().IsNull() || count(builder.Shape(), TopAbs_FACE) == 0) return {};
  history = builder.History();
  return builder.Shape();
}

/// Each group gives way to what became of it, where its first piece was.
void fuse_groups(const std::vector<std::vector<int>>& groups, Part& part, const Say& say) {
  const TopTools_IndexedMapOfShape pieces = pieces_of(part.shape);
  std::vector<TopoDS_Shape> made(std::size_t(pieces.Extent()));
  std::vector<Handle(BRepTools_History)> histories;
  for (int p = 0; p < pieces.Extent(); ++p) made[std::size_t(p)] = pieces(p + 1);
  for (const std::vector<int>& group : groups) {
    Handle(BRepTools_History) history;
    const TopoDS_Shape fused = fuse(pieces, group, say, history);
    if (fused.IsNull()) {
      part.report.suspicious.push_back(
          {"not_imprinted",
           fmt::format("{} solids and sheets that touch or cross each other could not be joined, the first with a "
                       "corner at {}",
                       group.size(), place_of(pieces(group[0] + 1))),
           {}});
      continue;
    }
    histories.push_back(history);
    for (const int p : group) made[std::size_t(p)] = TopoDS_Shape();
    made[std::size_t(group[0])] = fused;
  }
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& shape : made)
    if (!shape.IsNull()) builder.Add(all, shape);
  part.become(all, [&](const TopoDS_Shape& shape) {
    TopTools_ListOfShape images;
    for (const Handle(BRepTools_History) & history : histories) {
      if (history.IsNull()) continue;
      for (const TopoDS_Shape& image : history->Modified(shape)) images.Append(image);
    }
    return images;
  });
}

}  // namespace

Translation join(Part& part, const Say& say) {
  Translation data = translate(part, say);
  if (data.is_closed.size() < 2) return data;
  const std::size_t before = data.faces.size(), solids = count(part.shape, TopAbs_SOLID);
  say("joining solids", -1);
  std::size_t merged = merge_common(data, part.diagonal);
  const std::vector<std::vector<int>> groups = find_contacts(data);
  if (!groups.empty()) {
    fuse_groups(groups, part, say);
    data = translate(part, say);
    merged = merge_common(data, part.diagonal);
  }
  const std::size_t after = data.faces.size(), solids_after = count(part.shape, TopAbs_SOLID);
  if (merged > 0 || before != after || solids != solids_after)
    part.report.repairs.push_back(
        {"imprinted",
         fmt::format("solids and sheets that touch were joined: {} faces became {}, {} solids {}", before, after,
                     solids, solids_after),
         {}});
  return data;
}

}  // namespace delfront::cad
