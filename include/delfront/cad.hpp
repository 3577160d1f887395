// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/context.hpp"
#include "delfront/errors.hpp"

namespace delfront {

/// CAD files (D1, D4, D6): STEP, IGES, and the BREP and EGADS files of OpenCASCADE, become smooth geometry.
///
/// They are read by a module of its own, libdelfront_cad.so, which is found at run time: beside the program, in ../lib,
/// or at $DELFRONT_CAD_MODULE. Everything else works without it. docs/cad.md says what becomes of what.

/// @brief Whether a path has the suffix of a CAD file: .step .stp .iges .igs .brep .brp .egads, in any case.
bool is_cad_file(const std::string& path);

/// @brief Whether such files can be read.
/// @param[out] why  where not: what is missing and what to do; where so: which module by which library
bool has_cad_module(std::string& why);

struct CadOptions {
  /// @brief Gaps up to which loose faces are sewn, in units of the file; 0: 1e-6 of the diagonal, raised step by step
  /// to 1e-4 of it while edges stay free.
  double tolerance = 0;
  bool heals = true;     ///< wires, small edges, missing seams and parameter curves, orientation
  bool sews = true;      ///< faces with free edges
  bool imprints = true;  ///< several solids that touch or overlap: what they share is one face afterwards
};

/// @brief Something done to the geometry, or odd about it.
struct CadNote {
  std::string kind;     ///< stable key: "sewn", "reordered_wire", "loose_tolerance", "tiny_edge", …
  std::string message;  ///< a sentence with the entity and numbers
  Point at;
};

/// @brief What a face of the Brep was in the file, by its number.
struct CadFace {
  std::string surface;              ///< plane, cylinder, …, nurbs
  std::string name, colour, layer;  ///< as the file has them; colour RRGGBB; empty: none
  std::vector<std::string> solids;  ///< parts that it bounds; two where they share it
  double tolerance = 0;             ///< of the face, units of the file
};

struct CadReport {
  std::string format;              ///< STEP, IGES, BREP, EGADS
  std::string unit;                ///< of the coordinates: mm, m, in, …; empty: the file does not say
  double metres_per_unit = 0;      ///< 0: the file does not say
  std::size_t solids = 0;          ///< none: surfaces only
  std::size_t shells = 0;          ///< closed ones and open ones
  std::size_t free_edges = 0;      ///< that bound one face only: the surface is open there
  std::vector<CadNote> open_at;    ///< the first 1000 of them: their middle, face and length
  std::size_t internal_edges = 0;  ///< that lie within a face and bound nothing: left out
  double largest_tolerance = 0;
  std::vector<CadFace> faces;  ///< of the Brep, by number
  std::vector<CadNote> repairs, suspicious;
};

/// @brief What Context::on_log hears (debug, each followed by the path) before and after OpenCASCADE's own code is at
/// work: a damaged file may crash it, and whoever guards against that knows by these what it was at.
inline constexpr const char* kCadReadingBegins = "OpenCASCADE reads ";
inline constexpr const char* kCadReadingEnds = "OpenCASCADE has read ";

/// @brief Read a CAD file. Coordinates stay in the unit of the file.
///
/// Planes, cylinders, cones, spheres, tori, lines, circles, ellipses, splines, surfaces by extrusion and by revolution
/// become our own classes with the parameters of the file; what else there is asks OpenCASCADE at each evaluation (from
/// several threads). Placements of assemblies are applied. A face is named by its own name, else by its colour where
/// the part has several, else by its part; else it has no name. Tolerances of corners, edges and faces are kept, and
/// raised where the file's own do not hold.
/// @throws InputError  no such file, not readable as what its suffix says, no faces; no module (what to install)
/// @throws Cancelled, LimitError  within a second or so
/// @par Threads  one file at a time in a process: OpenCASCADE has global settings
Brep read_cad(const std::string& path, const CadOptions& options, CadReport& report, Context& context);

}  // namespace delfront
