// SPDX-License-Identifier: Apache-2.0
// CAD files for whole runs, made by OpenCASCADE itself:
//   cad_tool turn IN OUT FROM TO SCALE DEGREES   IN has the unit FROM (MM, M, INCH, …); its coordinates times SCALE,
//                                                turned round (1, 2, 3), are written; STEP says the unit TO
//   cad_tool assembly OUT.step                   two named solids that share a face, some faces named, some coloured
//   cad_tool propeller OUT.step                  a hub and a twisted blade by a loft through splines, whose root is in
//   it cad_tool coloured OUT.step                   a box of 1 x 2 x 3, its first four faces red, green, blue, red
#include <BRepBuilderAPI_Transform.hxx>
#include <Standard_Failure.hxx>
#include <cstdio>
#include <gp_Ax1.hxx>
#include <gp_Trsf.hxx>
#include <stdexcept>
#include <string>
#include <vector>

#include "occ_documents.hpp"
#include "occ_files.hpp"

namespace delfront::occ {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

double number(const std::string& text) {
  std::size_t used = 0;
  const double value = std::stod(text, &used);
  if (used != text.size()) throw std::invalid_argument("'" + text + "' is no number");
  return value;
}

void turn(const std::vector<std::string>& words) {
  const std::string &in = words[1], &out = words[2];
  gp_Trsf turned, scaled;
  turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 3)), number(words[6]) * kDegree);
  scaled.SetScale(gp_Pnt(0, 0, 0), number(words[5]));
  set_unit(words[3]);
  const TopoDS_Shape shape = BRepBuilderAPI_Transform(read(in, words[3]), turned * scaled, true).Shape();
  if (out.ends_with(".brep"))
    write_brep(shape, out);
  else
    write_step_in(words[4], shape, out);
}

void run(const std::vector<std::string>& words) {
  if (words.size() == 7 && words[0] == "turn") return turn(words);
  if (words.size() == 2 && words[0] == "assembly") return write_assembly(words[1]);
  if (words.size() == 2 && words[0] == "propeller") return write_step(propeller(1), words[1]);
  if (words.size() == 2 && words[0] == "coloured")
    return write_coloured_box("block", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, words[1]);
  throw std::invalid_argument(
      "cad_tool turn IN OUT FROM TO SCALE DEGREES | assembly OUT | propeller OUT | coloured OUT");
}

}  // namespace
}  // namespace delfront::occ

int main(int argc, char** argv) {
  try {
    delfront::occ::run(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const Standard_Failure& e) {
    std::fprintf(stderr, "OpenCASCADE: %s\n", e.GetMessageString());
    return 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "cad_tool: %s\n", e.what());
    return 1;
  }
}
