// SPDX-License-Identifier: Apache-2.0
// Files and places by OpenCASCADE itself, to compare with.
#pragma once
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "delfront/point.hpp"

namespace delfront::occ {

/// @brief One shape a file; millimetres.
void write_step(const TopoDS_Shape& shape, const std::string& path);
void write_iges(const TopoDS_Shape& shape, const std::string& path);
void write_brep(const TopoDS_Shape& shape, const std::string& path);

struct Colour {
  double r, g, b;
};
/// @brief A box of 1 x 2 x 3 with a name, its faces coloured one by one.
void write_coloured_box(const std::string& name, const std::vector<Colour>& colours, const std::string& path);

/// @brief These shapes side by side, nothing joined.
TopoDS_Compound compound_of(const std::vector<TopoDS_Shape>& shapes);

/// @brief A product of an assembly: a solid with a name, at places (by steps along x).
struct Product {
  std::string name;
  TopoDS_Shape solid;
  std::vector<Point> at;  ///< one instance each
};
void write_assembly(const std::vector<Product>& products, const std::string& path);

TopoDS_Shape box(double x, double y, double z, Point at = {});
TopoDS_Shape cylinder(double radius, double height);
TopoDS_Shape sphere(double radius);
TopoDS_Shape cone(double low, double high, double height);
TopoDS_Shape torus(double radius, double tube);
/// @brief Two cylinders of different radii that meet squarely, fused.
TopoDS_Shape tee();
/// @brief Two boxes with a common face, as one compound; fused: the face is one of both already.
TopoDS_Shape two_boxes(bool is_fused);
/// @brief Boxes of 1 in a lattice, each a solid of its own, the whole turned about an odd axis.
TopoDS_Shape lattice(std::size_t a_side, double turn);
/// @brief A block with a bore, and a pin in it whose seam is turned by an angle.
TopoDS_Shape pin_in_a_block(double turn);
/// @brief A hub and blades by lofts through twisted sections, whose roots lie in the hub; each a solid of its own.
TopoDS_Shape propeller(int blades);
/// @brief A box without its top.
TopoDS_Shape open_box();
/// @brief The faces of a box, each with edges of its own.
TopoDS_Shape loose_box();
/// @brief A solid offset from a bent plate: offset and extrusion surfaces.
TopoDS_Shape bent_plate();
TopoDS_Shape revolved_spline();

double area_of(const TopoDS_Shape& shape);
double volume_of(const TopoDS_Shape& shape);

/// @brief Farthest of some places from a shape, by OpenCASCADE's own projection.
double distance_to(const TopoDS_Shape& shape, Point p);

/// @brief A file's shape in the file's own unit (its code as OpenCASCADE's: MM, M, INCH, …).
TopoDS_Shape read(const std::string& path, const std::string& unit);

}  // namespace delfront::occ
