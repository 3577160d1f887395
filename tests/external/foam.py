# SPDX-License-Identifier: Apache-2.0
"""OpenFOAM as a judge of grids: its programs run on cases of ours, their fields read back, cases damaged on purpose.

Its programs end with status 0 whatever happens, so what they say and write decides.
"""
import os
import re
import subprocess

import numpy as np

SPEED = 10  # of the starter files, m/s
ENVIRONMENT = {**os.environ, "WM_PROJECT_DIR": os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam")}


def foam(program, case, *options):
    """What it said, and what is wrong with how it ended."""
    done = subprocess.run([program, "-case", str(case), *options], capture_output=True, text=True, errors="replace",
                          timeout=600, env=ENVIRONMENT)
    status, text = done.returncode, done.stdout + done.stderr
    fatal = re.search(r"FOAM FATAL(?:.*\n?){6}", text)
    if status or fatal or not re.search(r"^End", text, re.M):  # a status below 0: a signal, as of a division by zero
        return text, [f"{program} ends with {status}: {fatal.group(0) if fatal else text[-500:]}"]
    return text, []


def first_list(path):
    text = path.read_text()
    begin = text.index("\n(\n") + 3
    return text[begin:text.index("\n)", begin)]


def table(path, width):
    """The first list of an OpenFOAM file of vectors or numbers."""
    return np.array(re.sub(r"[()]", " ", first_list(path)).split(), dtype=float).reshape(-1, width)


def read_triangles(case):
    """Area vectors and owners of all faces (which must be triangles), neighbours of the inner ones; middles of cells."""
    mesh = case / "constant" / "polyMesh"
    corners = np.array(re.sub(r"3\(|\)", " ", first_list(mesh / "faces")).split(), dtype=int)
    points = table(mesh / "points", 3)[corners.reshape(-1, 3)]
    areas = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]) / 2
    owner, neighbour = (table(mesh / name, 1)[:, 0].astype(int) for name in ("owner", "neighbour"))
    sums, faces = np.zeros((max(owner.max(), neighbour.max()) + 1, 3)), 4
    np.add.at(sums, owner, points.mean(axis=1))
    np.add.at(sums, neighbour, points[:len(neighbour)].mean(axis=1))
    return areas, owner, neighbour, sums / faces


def read_fluxes(case, num_inner, num_faces):
    """0/phi, of all faces."""
    text = (case / "0" / "phi").read_text()
    inner, outer = text[text.index("internalField"):].split("boundaryField")

    def values(part):
        listed = re.search(r"nonuniform List<scalar>\s*\d*\s*\(([^)]*)\)", part)
        return [float(w) for w in listed[1].split()] if listed else float(re.search(r"uniform (\S+);", part)[1])
    fluxes = np.zeros(num_faces)
    fluxes[:num_inner] = values(inner)
    boundary = (case / "constant" / "polyMesh" / "boundary").read_text()
    for name, count, start in re.findall(r"(\S+)\s*\{\s*type\s+\w+;\s*nFaces\s+(\d+);\s*startFace\s+(\d+);", boundary):
        entries = re.search(rf"\s{name}\s*\{{(.*?)\}}", outer, re.S)[1]
        fluxes[int(start):int(start) + int(count)] = values(entries)
    return fluxes


def velocities_of_fluxes(case):
    """Each cell's velocity that fits the fluxes through its faces best, over SPEED; the middles of the cells; the largest
    net flux of a cell over the largest flux of a face.

    Made from 0/phi, since potentialFoam of Debian 12 writes wrong velocities: their y and z are not those of its fluxes.
    """
    areas, owner, neighbour, middles = read_triangles(case)
    fluxes, n = read_fluxes(case, len(neighbour), len(areas)), len(neighbour)
    size = np.linalg.norm(areas, axis=1)
    matrix, right, net = np.zeros((len(middles), 3, 3)), np.zeros((len(middles), 3)), np.zeros(len(middles))
    for cells, faces, sign in ((owner, slice(None), 1), (neighbour, slice(0, n), -1)):
        np.add.at(matrix, cells, areas[faces, :, None] * areas[faces, None, :] / size[faces, None, None])
        np.add.at(right, cells, areas[faces] * (fluxes / size)[faces, None])
        np.add.at(net, cells, sign * fluxes[faces])
    velocities = np.linalg.solve(matrix, right[:, :, None])[:, :, 0] / SPEED
    return velocities, middles, abs(net).max() / abs(fluxes).max()


def root_mean_square(differences):
    """Of the lengths of vectors; nan is infinity."""
    value = float(np.sqrt((differences ** 2).sum(axis=1).mean()))
    return value if value == value else float("inf")


def judge_check_mesh(case):
    text, problems = foam("checkMesh", case)
    return problems or ([] if re.search(r"^ *Mesh OK\.", text, re.M) else re.findall(r" \*\*\*.*", text) or [text[-500:]])


def judge_potential_foam(case):
    """With the whole correction for non-orthogonality, which this grid bears (below 60 degrees)."""
    schemes = case / "system" / "fvSchemes"
    schemes.write_text(schemes.read_text().replace("limited corrected 0.5", "corrected"))
    _, problems = foam("potentialFoam", case, "-writephi")
    if problems:
        return problems
    velocities, _, net = velocities_of_fluxes(case)
    off = root_mean_square(velocities - [1, 0, 0])
    # Its potential has no slope at the inlet, where the exact one has: no scheme is exact in the cells there.
    return [f"{name} is {value:.3g}" for name, value, bound in (("net flux of a cell", net, 1e-5), ("velocities' error", off, 0.1))
            if not value < bound]


def stop_after_50(case):
    control = case / "system" / "controlDict"
    control.write_text(control.read_text().replace("endTime         500", "endTime         50")
                       .replace("writeInterval   100", "writeInterval   50"))


def judge_simple_foam(case):
    """50 iterations from rest, laminar."""
    stop_after_50(case)
    _, problems = foam("simpleFoam", case)
    if problems:
        return problems
    error = abs(table(case / "50" / "U", 3) / SPEED - [1, 0, 0]).max()
    return [] if error < 2e-3 else [f"a cell's velocity is {error:.3g} off the exact one"]


def edit_list(path, index, change):
    """Change one entry of the list of an OpenFOAM file, one a line."""
    lines = path.read_text().split("\n")
    first = lines.index("(") + 1
    lines[first + index] = change(lines[first + index])
    path.write_text("\n".join(lines))


def turn_a_face(case):
    """The corners of the first inner face in the other order."""
    edit_list(case / "constant" / "polyMesh" / "faces", 0, lambda face: f"3({' '.join(reversed(face[2:-1].split()))})")


def throw_a_point(case):
    """The last point, one inside, to the far end of the duct: cells round it are turned inside out."""
    points = case / "constant" / "polyMesh" / "points"
    count = int(points.read_text().split("(", 1)[0].split()[-1])
    edit_list(points, count - 1, lambda _: "(1.99 0.01 0.5)")


def rename_a_patch(case):
    """zmax in the grid's list of patches, so that the starter files do not name it."""
    boundary = case / "constant" / "polyMesh" / "boundary"
    boundary.write_text(boundary.read_text().replace("    zmax\n", "    lid\n"))
