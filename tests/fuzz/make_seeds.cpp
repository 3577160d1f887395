// SPDX-License-Identifier: Apache-2.0
// make_seeds FOLDER: small valid files of every format and encoding, FOLDER/<format>/…, for the fuzzers to start from.
#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include "delfront/io.hpp"

namespace {

using namespace delfront;

void add(Mesh& mesh, CellType type, std::initializer_list<std::size_t> vertices, GroupId group) {
  CellBlock& block = mesh.block(type);
  for (std::size_t v : vertices) block.vertices.push_back(VertexId(v));
  if (num_vertices(type) == 0) {
    if (block.offsets.empty()) block.offsets.push_back(0);
    block.offsets.push_back(block.vertices.size());
  }
  block.group.push_back(group);
}

Mesh grid() {
  Mesh mesh;
  for (std::size_t i = 0; i < 8; ++i) mesh.points.push_back({double(i % 2), double(i / 2 % 2), double(i / 4) / 3});
  const GroupId region = mesh.add_group(3, "air"), patch = mesh.add_group(2, "the wall", "wall");
  add(mesh, CellType::tetrahedron, {0, 1, 2, 4}, region);
  add(mesh, CellType::hexahedron, {0, 1, 3, 2, 4, 5, 7, 6}, GroupId());
  add(mesh, CellType::triangle, {0, 2, 1}, patch);
  add(mesh, CellType::quad, {0, 1, 3, 2}, patch);
  mesh.fields.push_back({"t", Field::On::vertices, CellType::vertex, 1, std::vector<double>(8, 0.5)});
  return mesh;
}

Mesh plane() {
  Mesh mesh;
  mesh.dimension = 2;
  for (std::size_t i = 0; i < 4; ++i) mesh.points.push_back({double(i % 2), double(i / 2), 0});
  const GroupId region = mesh.add_group(2, "plane"), side = mesh.add_group(1, "side");
  add(mesh, CellType::triangle, {0, 1, 2}, region);
  add(mesh, CellType::line, {0, 1}, side);
  return mesh;
}

Mesh surface() {
  Mesh mesh;
  for (std::size_t i = 0; i < 5; ++i) mesh.points.push_back({double(i % 2), double(i / 2), double(i) / 4});
  const GroupId group = mesh.add_group(2, "body");
  add(mesh, CellType::triangle, {0, 1, 2}, group);
  add(mesh, CellType::quad, {0, 1, 3, 2}, group);
  return mesh;
}

Mesh general_cells() {
  Mesh mesh = surface();
  add(mesh, CellType::polygon, {0, 1, 3, 4, 2}, mesh.add_group(2, "body"));
  add(mesh, CellType::polyhedron, {4, 3, 0, 2, 1, 3, 0, 1, 4, 3, 1, 2, 4, 3, 2, 0, 4}, mesh.add_group(3, "cell"));
  return mesh;
}

void write_all(const Mesh& mesh, const std::string& root, const std::string& stem) {
  Context context;
  for (const FormatInfo& format : formats()) {
    if (!format.can_write || !format.can_read || format.name == "openfoam") continue;
    const std::string folder = root + "/" + format.name.substr(0, format.name.find('-'));  // one reader, one folder
    std::filesystem::create_directories(folder);
    for (const WriteOptions& options : {WriteOptions{.binary = true, .version = "", .compress = false},
                                        WriteOptions{.binary = false, .version = "2.2", .compress = false},
                                        WriteOptions{.binary = true, .version = "2.2", .compress = true},
                                        WriteOptions{.binary = false, .version = "", .compress = false}}) {
      const std::string name =
          stem + "_" + format.name + (options.binary ? "_b" : "_t") + (options.compress ? "_z" : "") + options.version;
      try {
        write_mesh(mesh, folder + "/" + name, context, options, format.name);
      } catch (const std::exception&) {  // not every format holds every mesh
      }
    }
  }
}

/// One case in one file, as fuzz_read_openfoam takes it apart.
void write_case(const Mesh& mesh, const std::string& root, const std::string& stem) {
  const std::string folder = root + "/openfoam", parts = root + "/case_in_parts/";
  std::filesystem::create_directories(folder);
  Context context;
  write_mesh(mesh, parts, context);
  std::ofstream whole(folder + "/" + stem, std::ios::binary);
  for (const char* name : {"points", "faces", "owner", "neighbour", "boundary", "cellZones", "faceZones"}) {
    std::ifstream part(parts + "constant/polyMesh/" + name, std::ios::binary);
    if (part) whole << part.rdbuf();
    whole << '\f';
  }
  std::filesystem::remove_all(parts);
}

/// Two tetrahedra of two regions on one face, which is a group.
Mesh two_regions() {
  Mesh mesh;
  for (std::size_t i = 0; i < 4; ++i) mesh.points.push_back({double(i == 1), double(i == 2), double(i == 3)});
  mesh.points.push_back({1, 1, 1});
  const GroupId one = mesh.add_group(3, "one"), other = mesh.add_group(3, "other");
  add(mesh, CellType::tetrahedron, {0, 1, 2, 3}, one);
  add(mesh, CellType::tetrahedron, {1, 2, 3, 4}, other);
  add(mesh, CellType::triangle, {1, 2, 3}, mesh.add_group(2, "between", "interface"));
  add(mesh, CellType::triangle, {0, 2, 1}, mesh.add_group(2, "low", "wall"));
  return mesh;
}

void write_text(const std::string& root, const std::string& format, const std::string& text) {
  std::filesystem::create_directories(root + "/" + format);
  std::ofstream(root + "/" + format + "/by_hand", std::ios::binary) << text;
}

/// Bytes for recipes (hdf5_recipe.hpp), which any will do for: of a length that reaches all objects.
std::string any_bytes(std::uint32_t seed) {
  std::string bytes;
  for (int i = 0; i < 600; ++i) bytes += static_cast<char>((seed = seed * 1664525u + 1013904223u) >> 24);
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_seeds FOLDER\n", stderr);
    return 2;
  }
  const std::string root = argv[1];
  write_all(grid(), root, "grid");
  write_all(plane(), root, "plane");
  write_all(surface(), root, "surface");
  write_all(general_cells(), root, "general");
  write_case(general_cells(), root, "polyhedron");
  write_case(two_regions(), root, "two_regions");
  write_text(root, "obj", "o a\nusemtl b\nv 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1/1 2//2 -1/3/4\nf 1 2 \\\n3\n");
  write_text(root, "poly",
             "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n1 1\n2 0 5\n4 1 2 3 4\n2 1 3\n1\n1 0 0 0\n0\n");
  write_text(root, "planar_poly",
             "4 2 1 1\n1 0 0 9 1\n2 1 0 9 1\n3 1 1 9 0\n4 0 1 9 2\n4 1\n1 1 2 1\n2 2 3 1\n3 3 4 2\n4 4 1 0\n1\n1 2 "
             "2\n1\n1 .5 .5 7 .1\n");
  write_text(root, "dat", "name\n 3. 3.\n\n0 0\n.5 .06\n1 .01\n\n0 0\n.5 -.06\n1 -.01\n999 999\n2 0\n3 0\n2.5 1\n");
  write_text(
      root, "pos",
      "View \"h\" { ST(0,0,0,1,0,0,0,1,0){.1,.2,.3}; VP(0,0,0){1,2,3}; SS(0,0,0,1,0,0,0,1,0,0,0,1){1,1,1,1}; };\n"
      "// c\nView \"g\" { TIME{0}; TT(0,0,0,1,0,0,0,1,0){1,0,0,0,1,0,0,0,1,1,0,0,0,1,0,0,0,1,1,0,0,0,1,0,0,0,1};};");
  write_text(root, "sol",
             "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n3\n3 1 2 3\n1 1 2 3 1 0 1 0 0 1\n"
             "1 1 2 3 1 0 1 0 0 1\n1 1 2 3 1 0 1 0 0 1\nEnd\n");
  write_text(root, "msh",
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n"
             "7 2 2 0 1 1 2 3\n$EndElements\n$NodeData\n1\n\"h\"\n1\n0\n3\n0\n1\n3\n1 .1\n2 .2\n3 .3\n$EndNodeData\n"
             "$ElementNodeData\n1\n\"g\"\n1\n0\n3\n0\n1\n1\n7 3 .1 .2 .3\n$EndElementNodeData\n");
  write_text(
      root, "geometry_text",
      "tolerance = 1e-9\n[[surface]]\nname = \"s\"\ntype = \"nurbs\"\ndegree = [2, 1]\nknots_u = [0, 0, 0, 1, 1, 1]\n"
      "knots_v = [0, 0, 1, 1]\npoints = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 1], [1, 1, 0]], [[2, 0, 1], [2, 1, 1]]]\n"
      "weights = [[1, 1], [1, 2], [1, 1]]\n[[surface]]\nname = \"c\"\ntype = \"cone\"\nhalf_angle = 30\norigin = "
      "[0, 0, 1]\naxis = [1, 1, 0]\n[[corner]]\nname = \"a\"\nat = [0, 0, 0]\n[[edge]]\nname = \"e\"\ntype = "
      "\"circle\"\nradius = 1\nrange = [0, 90]\n[[edge]]\nname = \"o\"\ntype = \"on\"\nsurface = \"s\"\nuv = "
      "[[0, 0], [1, 0]]\n[[face]]\nsurface = \"s\"\n[[face]]\nname = \"f\"\nkind = \"wall\"\nsurface = \"s\"\n"
      "reversed = true\nloops = [[\"o\", {edge = \"-e\", uv = [[0, 0], [1, 1]]}]]\n[[shape]]\ntype = \"torus\"\n"
      "radius = 1\ntube = 0.5\n");
  write_text(root, "mapbc", "3\n1 4000 wall\n2 6662 mirror\n3 5000 sky\n# volume 1 air\n");
  write_text(root, "solb",
             std::string("\x01\0\0\0\x02\0\0\0\x03\0\0\0\x14\0\0\0\x03\0\0\0>\0\0\0\x40\0\0\0\x03\0\0\0\x01\0\0\0\x01"
                         "\0\0\0\0\0\0\0\0\0\xf0?\0\0\0\0\0\0\xf0?\0\0\0\0\0\0\xf0?6\0\0\0\0\0\0\0",
                         72));
  write_text(
      root, "xdmf",
      "<Xdmf Version=\"3.0\"><Domain><Grid Name=\"g\"><Information Name=\"I\"><![CDATA[<main><map "
      "key=\"patch:a\" dim=\"2\" kind=\"wall\">0</map></main>]]></Information><Geometry GeometryType=\"XYZ\">"
      "<DataItem Dimensions=\"5 3\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataItem></Geometry><Topology "
      "TopologyType=\"Mixed\"><DataItem>6 0 1 2 3 4 0 1 2 2 2 0 1 1 1 3 3 3 0 1 4 16 4 3 0 1 2 3 0 1 4 3 1 2 4 3 "
      "2 0 4</DataItem></Topology><Attribute Name=\"patch_id\" Center=\"Cell\"><DataItem>-1 0 -1 -1 0 -1</DataItem>"
      "</Attribute><Attribute Name=\"t\" Center=\"Node\"><DataItem>1 2 3 4 5</DataItem></Attribute></Grid><Grid>"
      "<Geometry Type=\"XY\"><DataItem>0 0 1 0</DataItem></Geometry><Topology Type=\"Polyline\" "
      "NodesPerElement=\"2\"><DataItem>0 1</DataItem></Topology></Grid></Domain></Xdmf>");
  write_text(root, "vtkhdf", any_bytes(1));
  write_text(root, "netcdf4", any_bytes(2));
  write_text(root, "cgns", any_bytes(3));
  write_text(
      root, "nastran",
      "$HMNAME COMP                   1\"wall\"\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID    2               1.0+0   0.0     "
      "0.0\nGRID*   3                               0.              1.\n*       0.\nGRID,4,,0.,0.,1.\nCTRIA3,1,1,1,2,"
      "3\nCHEXA,2,2,1,2,3,4,1,2,+\n+,3,4\n$ANSA_NAME;2;PSOLID;~\n$air\nPSOLID  2       1\nENDDATA\n");
  write_text(
      root, "abaqus",
      "*HEADING\n*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=a\n1, 1, 2,\n3, "
      "4\n*ELSET, ELSET=b, GENERATE\n1, 1, 1\n*ELSET, ELSET=c\nb\n*SURFACE, NAME=s\n1, S1\nb, S2\n*NSET, NSET=n\n1\n");
  write_text(root, "fluent",
             "(0 \"c\")(2 2)(10 (0 1 3 0 2))(10 (1 1 3 1 2)(0 0 1 0 0 1))(12 (2 1 1 1 1))(13 (3 1 3 3 2)(1 2 0 1\n2 3 "
             "0 1 3 1 0 "
             "1))(45 (3 wall edge)())(45 (2 fluid air)())");
  write_text(root, "off", "COFF # c\n3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2 9\n");
  write_text(root, "stl",
             "SOLID a\r\nFACET NORMAL 0 0 1\r\nOUTER LOOP\r\nVERTEX 0 0 1E+000\r\nVERTEX +1 1.#QNAN 0\r\n");
  write_text(
      root, "vtu",
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\"><Points>"
      "<DataArray type=\"Float32\" NumberOfComponents=\"3\" "
      "format=\"binary\">JAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAA"
      "AIA/AAAAAA==</DataArray></Points><Cells><DataArray Name=\"connectivity\" type=\"Int8\" format=\"ascii\">0 1 2"
      "</DataArray><DataArray Name=\"offsets\" format=\"ascii\">3</DataArray><DataArray Name=\"types\" "
      "format=\"ascii\">6</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>");
  return 0;
}
