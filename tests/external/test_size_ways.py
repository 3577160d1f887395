# SPDX-License-Identifier: Apache-2.0
"""Every way to ask for sizes, with every method there is: valid by the independent checker, edges as long as asked.

    test_size_ways.py DELFRONT [--all | --methods front,delaunay] [--write-docs] [NAME ...]

The table is the folder examples/sizes: one job file a row, gridded in the volume, on the room's surface and, with the
section in place of the room, in the plane, by the front, or (--all) by every method of KINDS_OF_GRID. A new surface is
closed and has the room's topology. Of the edges that do not lie on a kept surface 99 % are 0.5 to 2 times as long as the
field asks at their middles (the mean of both ends; where the front in the plane is asked for stretched triangles, in the
metric); sizes grow no faster than asked along any edge; the estimate is near the cells. What cannot be is in IMPOSSIBLE
with its reason, which stands in the table. Prints one line a grid; --all --write-docs puts them into
docs/sizes/measured.md.
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import meshio
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = os.path.join(HERE, "..", "..", "examples", "sizes")
# What is gridded, as the table calls it: the key of its method, and the methods.
METHODS = ["front", "front-delaunay", "delaunay"]
KINDS_OF_GRID = {"volume": ("volume.method", METHODS), "plane": ("planar.method", METHODS),
                 "surface": ("surface.method", ["front", "delaunay"])}
EULER = 4  # of the room's surface: walls and a ball
# How far the estimate, which knows nothing of methods, may be from the cells.
ESTIMATE_WITHIN = {"front": 0.25, "front-delaunay": 0.15, "delaunay": 0.25}
IMPOSSIBLE = {}  # (job, what is gridded, method): why
KINDS = {"tetra": [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)], "triangle": [(0, 1), (1, 2), (2, 0)],
         "line": [(0, 1)]}


def edges_of(mesh, kind):
    cells = [block.data for block in mesh.cells if block.type == kind]
    if not cells:
        return np.empty((0, 2), int)
    cells = np.concatenate(cells)
    return np.unique(np.sort(np.concatenate([cells[:, list(pair)] for pair in KINDS[kind]]), 1), axis=0)


def growth_of(name, folder):
    """(c - 1) / c: how fast a size may rise with distance; solutions have a growth of their own."""
    with open(os.path.join(folder, f"{name}.toml"), encoding="utf-8") as job:
        match = re.search(r"^growth = (\S+)", job.read(), re.M)
    growth = 1.5 if name.startswith("s12") else float(match[1]) if match else 1.2
    return (growth - 1) / growth


def lengths_in(metric, edges, vectors):
    """Lengths of edges in the mean of both ends' metrics, as length over the mean size."""
    xx, yy, zz, xy, yz, xz = metric.T
    tensor = np.stack([np.stack([xx, xy, xz], 1), np.stack([xy, yy, yz], 1), np.stack([xz, yz, zz], 1)], 1)
    ends = [np.sqrt(np.einsum("ei,eij,ej->e", vectors, tensor[edges[:, k]], vectors)) for k in (0, 1)]
    return 2 / (1 / ends[0] + 1 / ends[1])


def share_of_good_edges(path, what, method, slope):
    """Share of edges as long as asked, three percentiles of length/size, and the fastest growth over what is allowed."""
    mesh = meshio.read(path)
    edges = edges_of(mesh, "tetra" if what == "volume" else "triangle")
    kept = edges_of(mesh, {"volume": "triangle", "plane": "line", "surface": "none"}[what])
    n = len(mesh.points)
    edges = edges[~np.isin(edges[:, 0] * n + edges[:, 1], kept[:, 0] * n + kept[:, 1])]
    h = mesh.point_data["h"].ravel()
    vectors = mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]]
    length = np.linalg.norm(vectors, axis=1)
    ratio = length / (0.5 * (h[edges[:, 0]] + h[edges[:, 1]]))
    if "metric" in mesh.point_data and what == "plane" and method == "front":
        ratio = lengths_in(mesh.point_data["metric"].reshape(n, 6), edges, vectors)
    growth = np.max(np.abs(h[edges[:, 0]] - h[edges[:, 1]]) / (slope * length))
    return growth, np.mean((ratio >= 0.5) & (ratio <= 2)), np.percentile(ratio, [1, 50, 99])


def run(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def words_of_job(folder, name, what, method):
    """The job file and what is set beside it: the method, and in the plane other inputs."""
    job = [f"{name}.toml", "--set", "output.sizes=true", "--set", f"{KINDS_OF_GRID[what][0]}={method}"]
    if what == "surface":
        job += ["--stop-after", "surface"]
    if what != "plane":
        return job
    job += ["--set", "input.files=section.poly", "--set", "planar.boundary=split",
            "--set", "boundaries.ball.select=patch_2", "--set", "boundaries.walls.select=patch_1"]
    with open(os.path.join(folder, f"{name}.toml"), encoding="utf-8") as file:
        text = file.read()
    for key in ("background", "solution"):
        match = re.search(rf"{key}.*?file = \"(\w+)\.vtu\"", text, re.S)
        if match and key in text:
            job += ["--set", f"size.{key}.file={match[1]}_2d.vtu"]
    return job


def check_surface(folder, out):
    """Closed, oriented, of the room's topology."""
    mesh = meshio.read(os.path.join(folder, out))
    triangles = np.concatenate([block.data for block in mesh.cells if block.type == "triangle"])
    n = len(mesh.points)
    there = np.concatenate([triangles[:, i] * n + triangles[:, (i + 1) % 3] for i in range(3)])
    back = np.concatenate([triangles[:, (i + 1) % 3] * n + triangles[:, i] for i in range(3)])
    if len(np.unique(there)) != len(there) or not np.array_equal(np.sort(there), np.sort(back)):
        return ["the surface is not closed, or sides are used twice in one direction"]
    euler = len(np.unique(triangles)) - len(there) // 2 + len(triangles)
    return [] if euler == EULER else [f"Euler's number is {euler} instead of {EULER}"]


def check_by_checker(folder, out, what):
    if what == "surface":
        return check_surface(folder, out)
    checker = [sys.executable, os.path.join(HERE, "run_checker.py"), out]
    if what == "volume":
        checker += ["--surface", "room.stl", "--keep-surface"]
    code, said = run(checker, folder)
    if code == 77:
        print(said.strip())
    return [] if code in (0, 77) else [f"check_mesh.py: {said.strip()[-600:]}"]


def estimated_cells(delfront, job, folder):
    """Cells that the estimate gives; or what it said instead."""
    code, said = run([delfront, "estimate", *job, "--report", "guess.json", "-j", "2"], folder)
    if code != 0:
        return None, [f"estimate: exit {code}: {said.strip()}"]
    with open(os.path.join(folder, "guess.json"), encoding="utf-8") as file:
        return json.load(file)["estimate"]["cells"], []


def compare_with_estimate(delfront, folder, job, report, method):
    """Cells, the estimate over them, what is wrong."""
    cells = report["quality"]["num_cells"]
    estimate, wrong = estimated_cells(delfront, job, folder)
    if wrong:
        return cells, "", wrong
    if report["front"]["gave_up"]:
        wrong.append(f"the front gave up: {report['front']['gave_up']}")
    if abs(estimate / cells - 1) > ESTIMATE_WITHIN[method]:
        wrong.append(f"estimate {estimate:.0f} of {cells} cells")
    return cells, f"{estimate / cells:.3f}", wrong


def check_grid(delfront, folder, name, what, method, rows):
    """One row of the table, added to rows. Returns what is wrong."""
    if (name, what, method) in IMPOSSIBLE:
        rows.append(f"| {name} | {what} | {method} | {IMPOSSIBLE[name, what, method]} | | | | | | |")
        print(rows[-1], flush=True)
        return []
    job = words_of_job(folder, name, what, method)
    code, said = run([delfront, "mesh", *job, "-o", "grid.vtu", "--report", "grid.json", "-j", "2"], folder)
    if code != 0:
        return [f"exit {code}: {said.strip()}"]
    wrong = check_by_checker(folder, "grid.vtu", what)
    grid = os.path.join(folder, "grid.vtu")
    growth, share, spread = share_of_good_edges(grid, what, method, growth_of(name, folder))
    if growth > 1 + 1e-6:
        wrong.append(f"sizes grow {growth:.4f} times as fast as allowed")
    if share < 0.99:
        wrong.append(f"only {100 * share:.2f} % of the edges are as long as asked")
    with open(os.path.join(folder, "grid.json"), encoding="utf-8") as file:
        report = json.load(file)
    if what == "surface":
        cells, ratio = report["surface_grid"]["triangles"], ""
        if report["surface_grid"]["fallbacks"]:
            wrong.append(f"pieces without a front: {report['surface_grid']['fallbacks']}")
    else:
        cells, ratio, failure = compare_with_estimate(delfront, folder, job, report, method)
        wrong += failure
    rows.append(f"| {name} | {what} | {method} | {cells:,} | {ratio} | {100 * share:.3f} % | "
                f"{spread[0]:.2f} | {spread[1]:.2f} | {spread[2]:.2f} | {growth:.3f} |")
    print(rows[-1], flush=True)
    return wrong


HEAD = """# Sizes: asked for and got

Written by `tests/external/test_size_ways.py DELFRONT --all --write-docs`: each job of `examples/sizes`, in the volume,
(with the section in place of the room) in the plane, and on the room's surface gridded anew, by every method; every grid
of the first two passed the independent checker, every surface is closed and has the room's topology.

- **estimate**: cells that `delfront estimate` gave, over those that the grid has. It knows nothing of methods: it is fitted
  to `front-delaunay`.
- **edges**: share of the edges, but for those on a kept surface, of 0.5 to 2 times the wanted length; percentiles of that
  ratio (on a surface, which is kept in the volume, of all edges). Where the front in the plane is asked for stretched triangles (s04), lengths are those in the metric.
- **growth**: the fastest growth of the wanted size along any edge, over what the job allows.
- A job that a method cannot do has the reason in place of its figures.

| job | | method | cells | estimate | edges | 1 % | 50 % | 99 % | growth |
| --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def write_docs(rows):
    with open(os.path.join(HERE, "..", "..", "docs", "sizes", "measured.md"), "w", encoding="utf-8") as file:
        file.write(HEAD + "\n".join(rows) + "\n")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("delfront")
    parser.add_argument("names", nargs="*", help="jobs; all where none is named")
    parser.add_argument("--methods", default="front", help="separated by commas")
    parser.add_argument("--all", action="store_true", help="every method")
    parser.add_argument("--write-docs", action="store_true", help="with --all: write docs/sizes/measured.md")
    return parser.parse_args()


def make_jobs(folder):
    subprocess.run([sys.executable, os.path.join(EXAMPLES, "make_inputs.py"), folder], check=True)
    for name in os.listdir(EXAMPLES):
        if name.endswith(".toml"):
            shutil.copy(os.path.join(EXAMPLES, name), folder)
    return sorted(f[:-5] for f in os.listdir(folder) if f.endswith(".toml"))


def main():
    options = parse()
    delfront = os.path.abspath(options.delfront)
    failed, rows = 0, []
    with tempfile.TemporaryDirectory() as folder:
        every = make_jobs(folder)
        for name in options.names or every:
            for what, (_, methods) in KINDS_OF_GRID.items():
                for method in [m for m in methods if options.all or m in options.methods.split(",")]:
                    for reason in check_grid(delfront, folder, name, what, method, rows):
                        print(f"{name} {what} {method} FAILED: {reason}", flush=True)
                        failed += 1
    print(f"{failed} failed")
    if options.write_docs and options.all and not failed and not options.names:
        write_docs(rows)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
