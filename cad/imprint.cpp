// SPDX-License-Identifier: Apache-2.0
// The general fuse of several solids: faces that touch are cut by each other, and the common part is one face of both.
// Where solids overlap, what they have in common becomes a solid of its own.
#include <BOPAlgo_Builder.hxx>
#include <BRepBndLib.hxx>
#include <BRepTools_History.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <vector>

#include "fmt/format.h"
#include "part.hpp"

namespace delfront::cad {
namespace {

bool may_touch(const TopTools_IndexedMapOfShape& solids) {
  std::vector<Bnd_Box> boxes(std::size_t(solids.Extent()));
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    BRepBndLib::Add(solids(int(i) + 1), boxes[i], false);
    for (std::size_t j = 0; j < i; ++j)
      if (!boxes[i].IsOut(boxes[j])) return true;
  }
  return false;
}

std::size_t count_faces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return std::size_t(faces.Extent());
}

}  // namespace

void imprint(Part& part, const Say& say) {
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(part.shape, TopAbs_SOLID, solids);
  if (solids.Extent() < 2 || !may_touch(solids)) return;
  BOPAlgo_Builder fuse;
  for (int i = 1; i <= solids.Extent(); ++i) fuse.AddArgument(solids(i));
  fuse.SetNonDestructive(true);
  fuse.SetRunParallel(false);
  Watch watch(say, "joining solids");
  fuse.Perform(watch.range());
  watch.check();
  if (fuse.HasErrors() || fuse.Shape().IsNull() || count_faces(fuse.Shape()) == 0) {
    part.report.suspicious.push_back(
        {"not_imprinted", fmt::format("the {} solids could not be joined where they touch", solids.Extent()), {}});
    return;
  }
  const std::size_t before = count_faces(part.shape), after = count_faces(fuse.Shape());
  const Handle(BRepTools_History) history = fuse.History();
  part.shape = fuse.Shape();
  part.faces.follow(part.shape, [&](const TopoDS_Shape& face) {
    return history.IsNull() ? TopTools_ListOfShape() : history->Modified(face);
  });
  TopTools_IndexedMapOfShape made;
  TopExp::MapShapes(part.shape, TopAbs_SOLID, made);
  if (before != after || made.Extent() != solids.Extent())
    part.report.repairs.push_back({"imprinted",
                                   fmt::format("solids that touch were joined: {} faces became {}, {} solids {}",
                                               before, after, solids.Extent(), made.Extent()),
                                   {}});
}

}  // namespace delfront::cad
