#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the jobs in examples/sizes: the wanted size on a plane beside the grid cut there, in the same colours.

    size_pictures.py [ROW ...] [--delfront PATH] [--out FOLDER]     # e.g. size_pictures.py s04; default: all rows

Writes docs/sizes/pictures/<row>.png, and <row>_2.png where one plane does not show all. Left the size that `delfront sizes` tells, with contour lines at the numbers of
the scale; right the cells beyond the plane, whole, coloured by the mean length of their edges. Needs a built
delfront, numpy, matplotlib, meshio and Pillow; no display.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile

import picture  # first: sets matplotlib up to draw without a display
import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgb
from matplotlib.ticker import MaxNLocator
from PIL import Image

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
EXAMPLES = os.path.join(ROOT, "examples", "sizes")
BUILDS = ["build/demo/delfront", "build/release/delfront"]
PANEL, GAP, MARGIN, HEADER, SCALE = 480, 24, 20, 100, 84  # pixels
MAX_COLOURS = 64
SMALL_TO_LARGE = LinearSegmentedColormap.from_list(
    "sizes", ["#b3262f", "#e8693f", "#f7b267", "#fbe3a4", "#d3e6cc", "#8cc6c6", "#4f96c4", "#356aa8"]
)
EDGES = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
CAVITY = "#c9ccd1"

# row: what stands over the picture, and the planes that show most of it: an axis and where it is cut
ROWS = {
    "s01_boundary": ("S1: from the boundary, growth 1.3", [("z", 0)]),
    "s02_expression": ("S2: a formula", [("y", 0)]),
    "s03_boxes": ("S3: box, sphere, cone and closed surface of constant size", [("z", 0), ("y", 0)]),
    "s04_sources": ("S4: point, lines, triangle and surface as sources", [("z", 0), ("y", 0)]),
    "s05_many_sources": ("S5: 2000 point sources on a spiral", [("x", -0.5)]),
    "s06_background": ("S6: sizes at the nodes of a coarse grid", [("z", 0)]),
    "s07_names": ("S7: a size on the ball, by its name", [("z", 0)]),
    "s08_adaptive_background": ("S8: a source, kept on an adaptive grid", [("z", 0.05)]),
    "s09_curvature": ("S9: cells per turn round the ball", [("z", 0)]),
    "s10_gaps": ("S10: cells across the gap between ball and wall", [("z", 0)]),
    "s11_together": ("S11: curvature, gap, formula, name, box and source at once", [("y", 0)]),
    "s12_solution": ("S12: a bent shock of a solution", [("z", 0)]),
    "s13_accuracy": ("S13: an angle and a distance that the surface is to hold", [("z", 0)]),
}


class Plane:
    """Rows of `basis` are right, up and forward on the screen; cells beyond the plane, forward of it, are kept."""

    def __init__(self, axis, at):
        self.axis, self.at = "xyz".index(axis), at
        right, up = {"x": (1, 2), "y": (0, 2), "z": (0, 1)}[axis]
        self.right, self.up, self.label = right, up, f"{axis} = {at:g}"
        self.names = "xyz"[right], "xyz"[up]
        basis = np.zeros((3, 3))
        basis[0, right] = basis[1, up] = 1
        basis[2] = np.cross(basis[1], basis[0])
        self.basis = basis

    def depth(self, points):
        """How far points are beyond the plane; never 0, so that cuts meet no vertex."""
        return (points[..., self.axis] - self.at) * self.basis[2, self.axis] + 1.2345e-9


class Straight(picture.Camera):
    """Looks straight at the plane, without perspective; the box from `low` to `high` fills the image."""

    def __init__(self, plane, low, high, pixels):
        self.width = self.height = pixels
        self.basis, self.low, self.high = plane.basis, low, high
        corner = np.abs(np.array([low, high])).max()
        self.far = 4 * corner + 1

    def project(self, points):
        local = points @ self.basis.T
        span = (self.high - self.low) @ np.abs(self.basis.T)
        start = np.minimum(self.low @ self.basis.T, self.high @ self.basis.T)
        x = (local[:, 0] - start[0]) / span[0] * self.width
        y = self.height - (local[:, 1] - start[1]) / span[1] * self.height
        return np.stack([x, y, 1 - local[:, 2] / self.far], axis=1)


def border_lines(plane, points, triangles):
    """Where the plane cuts the border: (n, 2, 2) in right and up."""
    depth = plane.depth(points)[triangles]
    lines = []
    for t, d in zip(triangles[(np.ptp(np.sign(depth), axis=1) > 0)], depth[np.ptp(np.sign(depth), axis=1) > 0]):
        ends = []
        for i, j in ((0, 1), (1, 2), (2, 0)):
            if d[i] * d[j] < 0:
                p = points[t[i]] + d[i] / (d[i] - d[j]) * (points[t[j]] - points[t[i]])
                ends.append(p[[plane.right, plane.up]])
        lines.append(ends)
    return np.array(lines)


def is_inside(lines, xs, ys):
    """Places of the raster (rows are ys) with an odd number of border lines to their left."""
    inside = np.zeros((len(ys), len(xs)), dtype=bool)
    for (x0, y0), (x1, y1) in lines:
        for row in np.flatnonzero((ys > min(y0, y1)) & (ys <= max(y0, y1))):
            inside[row] ^= xs > x0 + (ys[row] - y0) / (y1 - y0) * (x1 - x0)
    return inside


def wanted_size(path, plane, xs, ys):
    """The field of `delfront sizes` on a raster of the plane, linear within its boxes."""
    mesh = meshio.read(path)
    h = mesh.point_data["h"].ravel()
    boxes = np.concatenate([block.data for block in mesh.cells if block.type == "hexahedron"])
    p = mesh.points[boxes]
    depth = plane.depth(p)
    result = np.full((len(ys), len(xs)), np.nan)
    for cell in np.flatnonzero((depth.min(axis=1) < 0) & (depth.max(axis=1) > 0)):
        q, values = p[cell], h[boxes[cell]]
        low, high = q.min(axis=0), q.max(axis=0)
        columns = np.flatnonzero((xs >= low[plane.right]) & (xs <= high[plane.right]))
        rows = np.flatnonzero((ys >= low[plane.up]) & (ys <= high[plane.up]))
        if not len(columns) or not len(rows):
            continue
        weight = {plane.axis: (plane.at - low[plane.axis]) / (high - low)[plane.axis],
                  plane.right: ((xs[columns] - low[plane.right]) / (high - low)[plane.right])[None, :],
                  plane.up: ((ys[rows] - low[plane.up]) / (high - low)[plane.up])[:, None]}
        total = 0
        for corner, value in zip(q, values):
            factor = value
            for axis in range(3):
                factor = factor * (weight[axis] if corner[axis] > 0.5 * (low + high)[axis] else 1 - weight[axis])
            total = total + factor
        result[np.ix_(rows, columns)] = total
    return result


def mean_edges(grid):
    p = grid.points[grid.tets]
    return np.mean([np.linalg.norm(p[:, a] - p[:, b], axis=1) for a, b in EDGES], axis=0)


def share_as_asked(grid, h):
    """Share of the edges off the given surface that are 0.5 to 2 times as long as wanted at their middles."""
    n = len(grid.points)

    def keys(cells, pairs):
        ends = np.sort(np.concatenate([cells[:, list(pair)] for pair in pairs]), axis=1)
        return np.unique(ends[:, 0].astype(np.int64) * n + ends[:, 1])

    edges = np.setdiff1d(keys(grid.tets, EDGES), keys(grid.triangles, EDGES[:2] + [(1, 2)]), assume_unique=True)
    a, b = edges // n, edges % n
    ratio = np.linalg.norm(grid.points[a] - grid.points[b], axis=1) / (0.5 * (h[a] + h[b]))
    return np.mean((ratio >= 0.5) & (ratio <= 2))


def draw_cut(grid, plane, length, norm):
    """Image of the cells beyond the plane, coloured by their mean edge length."""
    keep = plane.depth(grid.points[grid.tets].mean(axis=1)) > 0
    camera = Straight(plane, grid.points.min(axis=0), grid.points.max(axis=0), PANEL * picture.OVERSAMPLING)
    canvas = picture.Canvas(camera.width, camera.height)
    faces, owner = picture.cut_faces(grid, keep)
    line = 0.45 * picture.OVERSAMPLING
    colours = picture.lit(SMALL_TO_LARGE(norm(length[owner]))[:, :3], picture.normals_of(grid.points, faces), camera, 0.9)
    canvas.draw(camera, grid.points, faces, colours, line, 0.7)
    behind = grid.triangles[(grid.cell_behind >= 0) & keep[grid.cell_behind]]
    colours = np.tile(to_rgb(CAVITY), (len(behind), 1))
    colours = picture.lit(colours, picture.normals_of(grid.points, behind), camera, 0.55)
    canvas.draw(camera, grid.points, behind, colours, line, 0.35)
    return np.clip(canvas.reduced(), 0, 1)


class Sheet:
    """A figure laid out in pixels from its top left corner."""

    def __init__(self):
        self.width, self.height = 2 * MARGIN + 2 * PANEL + GAP + SCALE, HEADER + PANEL + MARGIN
        self.figure = plt.figure(figsize=(self.width / 100, self.height / 100), dpi=100, facecolor=picture.PAPER)

    def axes(self, x, y, width, height):
        return self.figure.add_axes(
            [x / self.width, 1 - (y + height) / self.height, width / self.width, height / self.height])

    def text(self, x, y, words, **how):
        self.figure.text(x / self.width, 1 - y / self.height, words, color=picture.INK, va="center", **how)

    def save(self, path):
        """With a palette: a third of the bytes."""
        self.figure.savefig(path, dpi=100, facecolor=picture.PAPER)
        plt.close(self.figure)
        with Image.open(path) as image:
            image.convert("RGB").quantize(MAX_COLOURS, kmeans=2, dither=Image.Dither.NONE).save(path, optimize=True)


def draw_wanted(axes, wanted, box, lines, norm, levels):
    image = SMALL_TO_LARGE(norm(wanted))[:, :, :3]
    image[np.isnan(wanted)] = 1
    axes.imshow(image, origin="lower", extent=box, interpolation="nearest", aspect="auto")
    xs, ys = (np.linspace(box[i], box[i + 1], n) for i, n in ((0, wanted.shape[1]), (2, wanted.shape[0])))
    levels = np.array(levels) + 1e-3 * (norm.vmax - norm.vmin)  # where the size is constant at a level none is drawn
    axes.contour(xs, ys, wanted, levels=levels, colors=[picture.INK], linewidths=0.5, alpha=0.55)
    axes.add_collection(LineCollection(lines, colors=[picture.INK], linewidths=1.2))


class Row:
    """One job: its grid, and the sizes it asks for."""

    def __init__(self, title, folder):
        path = os.path.join(folder, "grid.vtu")
        self.title, self.sizes = title, os.path.join(folder, "sizes.vtu")
        self.grid = picture.Grid(path)
        h = meshio.read(path).point_data["h"].ravel()
        self.range = h.min(), h.max()
        self.levels = [v for v in MaxNLocator(8, steps=[1, 2, 2.5, 5, 10]).tick_values(*self.range) if h.min() < v < h.max()]
        self.length = mean_edges(self.grid)
        self.facts = (f"{picture.grouped(len(self.grid.tets))} tetrahedra, {100 * share_as_asked(self.grid, h):.2f} % of "
                      "their edges 0.5 to 2 times as long as wanted")

    def draw(self, plane, out):
        grid, norm, sheet = self.grid, Normalize(*self.range), Sheet()
        low, high = grid.points.min(axis=0), grid.points.max(axis=0)
        box = low[plane.right], high[plane.right], low[plane.up], high[plane.up]
        xs, ys = ((np.arange(PANEL) + 0.5) / PANEL * (box[i + 1] - box[i]) + box[i] for i in (0, 2))
        lines = border_lines(plane, grid.points, grid.triangles)
        wanted = wanted_size(self.sizes, plane, xs, ys)
        wanted[~is_inside(lines, xs, ys)] = np.nan
        left, right = (sheet.axes(x, HEADER, PANEL, PANEL) for x in (MARGIN, MARGIN + PANEL + GAP))
        draw_wanted(left, wanted, box, lines, norm, self.levels)
        right.imshow(draw_cut(grid, plane, self.length, norm), interpolation="nearest", aspect="auto")
        left.set_axis_off()
        right.set_axis_off()
        self._label(sheet, plane)
        sheet.save(out)

    def _label(self, sheet, plane):
        sheet.text(MARGIN, 22, self.title, size=15, weight="bold")
        sheet.text(MARGIN, 48, self.facts, size=10)
        sheet.text(MARGIN, HEADER - 14, f"wanted size where {plane.label}; {plane.names[0]} to the right, "
                   f"{plane.names[1]} up", size=10.5)
        sheet.text(MARGIN + PANEL + GAP, HEADER - 14, "the grid cut there; mean edge length of the cells", size=10.5)
        x, low, high = MARGIN + 2 * (PANEL + GAP), *self.range
        bar = sheet.axes(x, HEADER + 30, 20, PANEL - 60)
        bar.imshow(np.linspace(0, 1, 256)[:, None], cmap=SMALL_TO_LARGE, origin="lower", aspect="auto",
                   extent=(0, 1, low, high))
        bar.set_xticks([])
        bar.yaxis.tick_right()
        bar.set_yticks(self.levels, [f"{v:g}" for v in np.round(self.levels, 6)])
        bar.tick_params(axis="y", labelsize=10, colors=picture.INK, length=3)
        sheet.text(x, HEADER + 14, "length", size=10.5)


def run(delfront, folder, name):
    job = os.path.join(folder, f"{name}.toml")
    for command in ([delfront, "sizes", job, "-o", os.path.join(folder, "sizes.vtu")],
                    [delfront, "mesh", job, "-o", os.path.join(folder, "grid.vtu"), "--set", "output.sizes=true"]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(command)}\nexit {done.returncode}: {done.stderr.strip()}")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", help="rows to draw, by the start of their names; default: all")
    built = [os.path.join(ROOT, b) for b in BUILDS if os.path.exists(os.path.join(ROOT, b))]
    parser.add_argument("--delfront", default=built[0] if built else shutil.which("delfront"), help="the program")
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "sizes", "pictures"), help="folder of the pictures")
    options = parser.parse_args()
    if not options.delfront:
        parser.error(f"no delfront in {', '.join(BUILDS)}; build it (scripts/demo) or name it by --delfront")
    options.rows = [name for name in ROWS if not options.rows or any(name.startswith(row) for row in options.rows)]
    if not options.rows:
        parser.error(f"no such row; there are: {', '.join(ROWS)}")
    return options


def main():
    options = parse_arguments()
    os.makedirs(options.out, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, os.path.join(EXAMPLES, "make_inputs.py"), folder], check=True)
        for name in os.listdir(EXAMPLES):
            if name.endswith(".toml"):
                shutil.copy(os.path.join(EXAMPLES, name), folder)
        for name in options.rows:
            title, planes = ROWS[name]
            run(os.path.abspath(options.delfront), folder, name)
            row = Row(title, folder)
            for i, (axis, at) in enumerate(planes):
                out = os.path.join(options.out, f"{name}{f'_{i + 1}' if i else ''}.png")
                row.draw(Plane(axis, at), out)
                print(f"{os.path.relpath(out)}: {os.path.getsize(out) / 1000:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
