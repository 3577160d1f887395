#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Names from CAD come through all writers, and select faces: every format is read back by a reader that is not ours."""
import json
import re
import subprocess
import sys
import unittest

import case


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def area(a, b, c):
    n = cross(minus(b, a), minus(c, a))
    return 0.5 * dot(n, n) ** 0.5


class Parts:
    """Of a grid: {name: [cells, measure]} of patches (triangles, area) and of regions (tetrahedra, volume)."""

    def __init__(self):
        self.patches, self.regions = {}, {}

    @staticmethod
    def add(parts, name, measure, count=1):
        part = parts.setdefault(name, [0, 0.0])
        part[0] += count
        part[1] += measure

    def renamed(self, rename):
        other = Parts()
        other.patches = {rename(name): part for name, part in self.patches.items()}
        other.regions = {rename(name): part for name, part in self.regions.items()}
        return other


def by_meshio(path, name_of):
    """@param name_of  (mesh, dimension, block) -> names of its cells"""
    import meshio

    mesh, parts = meshio.read(path), Parts()
    points = [tuple(map(float, p)) for p in mesh.points]
    for k, block in enumerate(mesh.cells):
        if block.type not in ("triangle", "tetra"):
            continue
        names = name_of(mesh, 2 if block.type == "triangle" else 3, k)
        for cell, name in zip(block.data, names):
            p = [points[i] for i in cell]
            if block.type == "triangle":
                parts.add(parts.patches, name, area(*p))
            else:
                parts.add(parts.regions, name, dot(minus(p[3], p[0]), cross(minus(p[1], p[0]), minus(p[2], p[0]))) / 6)
    return parts


def vtu_names(mesh, dimension, block):
    word = {2: "patch", 3: "region"}[dimension]
    table = {int(v.ravel()[0]): key.split(":", 1)[1] for key, v in mesh.field_data.items() if key.startswith(word + ":")}
    return [table[int(i)] for i in mesh.cell_data[word + "_id"][block].ravel()]


def msh_names_of(path):
    """By the list in the file: meshio keeps one of two groups of one name, such as a solid's region and its patch."""
    listed = re.findall(r'^(\d) (\d+) "(.*)"$', path.read_bytes().decode("latin-1"), re.M)
    table = {(int(dimension), int(number)): name for dimension, number, name in listed}
    return lambda mesh, dimension, block: [table[dimension, int(i)] for i in mesh.cell_data["gmsh:physical"][block]]


def by_su2(path):
    """SU2 has markers and no regions."""
    parts, points, markers, words = Parts(), [], {}, path.read_text().split("\n")
    i = 0
    while i < len(words):
        key, _, value = words[i].partition("=")
        i += 1
        if key.strip() == "NPOIN":
            n = int(value.split()[0])
            points = [tuple(map(float, words[i + k].split()[:3])) for k in range(n)]
            i += n
        elif key.strip() == "MARKER_TAG":
            name = value.strip()
            n = int(words[i].partition("=")[2])
            markers[name] = [list(map(int, words[i + 1 + k].split()))[1:4] for k in range(n)]
            i += n + 1
    for name, triangles in markers.items():
        for t in triangles:
            parts.add(parts.patches, name, area(*[points[v] for v in t]))
    return parts


def foam_list(path):
    """The text between the brackets of a file's list."""
    text = re.sub(r"FoamFile\s*\{.*?\n\}", "", path.read_text(), flags=re.S)
    return re.search(r"\d+\s*\((.*)\)\s*$", text, flags=re.S).group(1)


def by_foam(folder):
    folder = folder / "constant" / "polyMesh"
    points = [tuple(map(float, p.split())) for p in re.findall(r"\(([^()]*)\)", foam_list(folder / "points"))]
    faces = [list(map(int, f.split())) for f in re.findall(r"3\(([^()]*)\)", foam_list(folder / "faces"))]
    owner, neighbour = ([int(w) for w in foam_list(folder / name).split()] for name in ("owner", "neighbour"))
    parts = Parts()
    for name, body in re.findall(r"(\S+)\s*\{(.*?)\}", foam_list(folder / "boundary"), flags=re.S):
        count, start = (int(re.search(key + r"\s+(\d+);", body).group(1)) for key in ("nFaces", "startFace"))
        for face in faces[start:start + count]:
            parts.add(parts.patches, name, area(*[points[v] for v in face]))
    for name, labels in zones(folder / "faceZones"):
        for face in labels:
            parts.add(parts.patches, name, area(*[points[v] for v in faces[face]]))
    volume = [0.0] * (max(owner + neighbour) + 1)
    for k, face in enumerate(faces):  # the divergence theorem
        a, b, c = (points[v] for v in face)
        share = dot(a, cross(b, c)) / 6
        volume[owner[k]] += share
        if k < len(neighbour):
            volume[neighbour[k]] -= share
    for name, labels in zones(folder / "cellZones"):
        parts.add(parts.regions, name, sum(volume[c] for c in labels), len(labels))
    return parts


def zones(path):
    if not path.exists():
        return []
    found = re.findall(r"(\S+)\s*\{[^{}]*?List<label>\s*\d+\s*\(([^()]*)\)", foam_list(path), flags=re.S)
    return [(name, [int(w) for w in labels.split()]) for name, labels in found]


class CadNames(case.Case):
    def expect_same(self, one, other, what):
        self.assertEqual(set(one), set(other), what)
        for name, (count, measure) in one.items():
            self.assertEqual(count, other[name][0], f"{what}: {name}")
            self.assertAlmostEqual(measure / other[name][1], 1, delta=1e-9, msg=f"{what}: {name}")

    def expect_names_in_all_formats(self, path, *arguments):
        """@return what is in the VTU, and the report"""
        try:
            import meshio  # noqa: F401
        except ImportError:
            self.skipTest("meshio is not there (Debian: python3-meshio)")
        self.expect(0, "mesh", path, *arguments, "-o", "a.vtu", "-o", "a.msh", "-o", "a.su2", "-o", "foam/", "--report",
                    "a.json")
        report = self.report("a.json")
        vtu = by_meshio(self.folder / "a.vtu", vtu_names)
        for parts, groups in ((vtu.patches, report["boundaries"]), (vtu.regions, report["regions"])):
            self.assertEqual({name: part[0] for name, part in parts.items()},
                             {group["name"]: group["num_cells"] for group in groups})
        self.assertAlmostEqual(sum(v for _, v in vtu.regions.values()) / report["quality"]["volume"], 1, delta=1e-9)
        msh = by_meshio(self.folder / "a.msh", msh_names_of(self.folder / "a.msh"))
        self.expect_same(vtu.patches, msh.patches, "MSH")
        self.expect_same(vtu.regions, msh.regions, "MSH")
        # what a format cannot hold of a name is an underscore, and that is said
        foam = by_foam(self.folder / "foam")
        as_foam = vtu.renamed(lambda name: re.sub(r"[^A-Za-z0-9_.-]", "_", name))
        self.expect_same(as_foam.patches, foam.patches, "OpenFOAM")
        if len(vtu.regions) > 1:
            self.expect_same(as_foam.regions, foam.regions, "OpenFOAM")
        su2 = by_su2(self.folder / "a.su2")
        inner = self.inner_names()  # which SU2 has no place for
        as_su2 = {re.sub(r"[\s%=,;()\"'{}]", "_", name): part for name, part in vtu.patches.items()
                  if re.sub(r"[^A-Za-z0-9_.-]", "_", name) not in inner}
        self.expect_same(as_su2, su2.patches, "SU2")
        for name in vtu.patches:
            if re.search(r"\s", name):
                for file in ("a.su2: SU2", "foam/: OpenFOAM"):
                    self.assertTrue(any(f'{file}: patch "{name}" is written as' in said for said in report["name_changes"]))
        return vtu, report

    def inner_names(self):
        return {name for name, _ in zones(self.folder / "foam" / "constant" / "polyMesh" / "faceZones")}

    def test_an_assembly_keeps_the_names_of_faces_colours_and_parts(self):
        vtu, _ = self.expect_names_in_all_formats(self.make_cad("assembly", "parts.step"))
        areas = {"inlet": 1, "outlet": 1, "colour_FF8000": 2, "left part": 2, "right#2": 8, "left part-right#2": 1}
        self.assertEqual(set(vtu.patches), set(areas))
        for name, asked in areas.items():
            self.assertAlmostEqual(vtu.patches[name][1], asked, delta=1e-9)
        self.assertEqual(sorted(round(v, 9) for _, v in vtu.regions.values()), [1, 2])
        self.assertEqual(self.inner_names(), {"left_part-right_2"})

    def test_a_shared_file_keeps_its_names(self):
        self.make_cad("coloured", "a.step")  # skips where there is no module
        path = self.shared("cad/as1-oc-214.stp")
        vtu, _ = self.expect_names_in_all_formats(path, "--accuracy", "coarse")
        # of a patch with outer and inner faces the few have a name of their own
        self.assertEqual({re.sub("_(inner|outer)$", "", name) for name in vtu.patches},
                         {"colour_FF0000", "colour_FF8000", "colour_0000FF", "colour_00FF00", "colour_CCFF00"})
        self.assertEqual(len(vtu.regions), 18)

    def job(self, path, *selectors):
        text = f'[input]\nfiles = ["{path}"]\n[size]\nhmax = 0.5\n[output]\nfiles = ["a.vtu"]\nreport = "a.json"\n'
        for name, selector in selectors:
            text += f"[boundaries.{name}]\nselect = {selector}\n"
        return self.write("a.toml", text)

    def patches(self):
        return {group["name"]: group["num_cells"] for group in self.report("a.json")["boundaries"]}

    def test_faces_are_selected_by_colour(self):
        path = self.make_cad("coloured", "block.step")
        self.expect(0, "mesh", self.job(path, ("hot", '{ colour = "#ff0000" }'), ("cold", '{ colour = ["00FF00", "0000FF"] }')))
        self.assertEqual(set(self.patches()), {"hot", "cold", "block"})
        self.expect(0, "info", path, says=["colour FF0000"])
        self.expect(2, "mesh", self.job(path, ("hot", '{ colour = "FF8000" }')),
                    says=["a.toml:", "boundaries.hot: no face of block.step has the colour FF8000",
                          "there are: 0000FF (1 face), 00FF00 (1 face), FF0000 (2 faces)"])
        self.expect(2, "mesh", self.job(path, ("hot", '{ colour = "red" }')), says=["a.toml:", 'such as "FF8000"'])
        self.expect(2, "mesh", self.job(path, ("hot", "{ colour = [] }")), says="empty list")
        self.assertEqual(json.loads((self.folder / "a.json").read_text())["exit_code"], 2)

    def test_a_file_without_colours_says_so(self):
        self.make_cad("coloured", "block.step")
        self.make_cad("turn", "block.step", "plain.brep", "MM", "MM", "1", "0")
        self.expect(2, "mesh", self.job("plain.brep", ("hot", '{ colour = "FF0000" }')), says="the file gives its faces no colours")


if __name__ == "__main__":
    sys.exit(unittest.main())
