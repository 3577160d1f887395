# SPDX-License-Identifier: Apache-2.0
"""Every way to ask for sizes, with every method there is: valid by the independent checker, edges as long as asked.

    test_size_ways.py DELFRONT [--write-docs] [NAME ...]

The table is the folder examples/sizes: one job file a row, gridded in the volume and, with the section in place of the
room, in the plane. Of the edges that do not lie on a kept surface 99 % are 0.5 to 2 times as long as the field asks at
their middles (the mean of both ends); sizes grow no faster than asked along any edge; the estimate is within 15 % of the
cells. Prints one line a grid; --write-docs puts them into docs/sizes/measured.md.
"""
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


def share_of_good_edges(path, dimension, slope):
    """Share of edges as long as asked, three percentiles of length/size, and the fastest growth over what is allowed."""
    mesh = meshio.read(path)
    edges = edges_of(mesh, "tetra" if dimension == 3 else "triangle")
    kept = edges_of(mesh, "triangle" if dimension == 3 else "line")
    n = len(mesh.points)
    edges = edges[~np.isin(edges[:, 0] * n + edges[:, 1], kept[:, 0] * n + kept[:, 1])]
    h = mesh.point_data["h"].ravel()
    length = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1)
    ratio = length / (0.5 * (h[edges[:, 0]] + h[edges[:, 1]]))
    growth = np.max(np.abs(h[edges[:, 0]] - h[edges[:, 1]]) / (slope * length))
    return growth, np.mean((ratio >= 0.5) & (ratio <= 2)), np.percentile(ratio, [1, 50, 99])


def run(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def check_grid(delfront, folder, name, dimension, rows):
    """One row of the table, added to rows. Returns what is wrong."""
    out, report, guess = f"{name}_{dimension}.vtu", f"{name}_{dimension}.json", f"{name}_{dimension}_estimate.json"
    job = [f"{name}.toml", "--set", "output.sizes=true"]
    if dimension == 2:
        job += ["--set", "input.files=section.poly", "--set", "planar.boundary=split",
                "--set", "boundaries.ball.select=patch_2", "--set", "boundaries.walls.select=patch_1"]
        with open(os.path.join(folder, f"{name}.toml"), encoding="utf-8") as file:
            text = file.read()
        for key in ("background", "solution"):
            match = re.search(rf"{key}.*?file = \"(\w+)\.vtu\"", text, re.S)
            if match and key in text:
                job += ["--set", f"size.{key}.file={match[1]}_2d.vtu"]
    code, said = run([delfront, "mesh", *job, "-o", out, "--report", report, "-j", "2"], folder)
    if code != 0:
        return [f"exit {code}: {said.strip()}"]
    wrong = []
    checker = [sys.executable, os.path.join(HERE, "run_checker.py"), out]
    if dimension == 3:
        checker += ["--surface", "room.stl", "--keep-surface"]
    code, said = run(checker, folder)
    if code == 77:
        print(said.strip())
    elif code != 0:
        wrong.append(f"check_mesh.py: {said.strip()[-600:]}")
    growth, share, spread = share_of_good_edges(os.path.join(folder, out), dimension, growth_of(name, folder))
    if growth > 1 + 1e-6:
        wrong.append(f"sizes grow {growth:.4f} times as fast as allowed")
    if share < 0.99:
        wrong.append(f"only {100 * share:.2f} % of the edges are as long as asked")
    code, said = run([delfront, "estimate", *job, "--report", guess, "-j", "2"], folder)
    if code != 0:
        return [*wrong, f"estimate: exit {code}: {said.strip()}"]
    with open(os.path.join(folder, guess), encoding="utf-8") as file:
        estimate = json.load(file)["estimate"]["cells"]
    with open(os.path.join(folder, report), encoding="utf-8") as file:
        cells = json.load(file)["quality"]["num_cells"]
    if abs(estimate / cells - 1) > 0.15:
        wrong.append(f"estimate {estimate:.0f} of {cells} cells")
    rows.append(f"| {name} | {dimension}-D | {cells:,} | {estimate / cells:.3f} | {100 * share:.3f} % | "
                f"{spread[0]:.2f} | {spread[1]:.2f} | {spread[2]:.2f} | {growth:.3f} |")
    print(rows[-1], flush=True)
    return wrong


HEAD = """# Sizes: asked for and got

Written by `tests/external/test_size_ways.py DELFRONT --write-docs`: each job of `examples/sizes`, in the volume and (with
the section in place of the room) in the plane; every grid passed the independent checker.

- **estimate**: cells that `delfront estimate` gave, over those that the grid has.
- **edges**: share of the edges, but for those on a kept surface, of 0.5 to 2 times the wanted length; percentiles of that
  ratio.
- **growth**: the fastest growth of the wanted size along any edge, over what the job allows.

| job | | cells | estimate | edges | 1 % | 50 % | 99 % | growth |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def write_docs(rows):
    with open(os.path.join(HERE, "..", "..", "docs", "sizes", "measured.md"), "w", encoding="utf-8") as file:
        file.write(HEAD + "\n".join(rows) + "\n")


def main():
    delfront = os.path.abspath(sys.argv[1])
    only = [word for word in sys.argv[2:] if not word.startswith("--")]
    failed, rows = 0, []
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, os.path.join(EXAMPLES, "make_inputs.py"), folder], check=True)
        for name in os.listdir(EXAMPLES):
            if name.endswith(".toml"):
                shutil.copy(os.path.join(EXAMPLES, name), folder)
        names = sorted(f[:-5] for f in os.listdir(folder) if f.endswith(".toml"))
        for name in names:
            if only and name not in only:
                continue
            for dimension in (3, 2):
                for reason in check_grid(delfront, folder, name, dimension, rows):
                    print(f"{name} {dimension}-D FAILED: {reason}", flush=True)
                    failed += 1
    print(f"{failed} failed")
    if "--write-docs" in sys.argv and not failed and not only:
        write_docs(rows)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
