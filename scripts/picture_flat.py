# SPDX-License-Identifier: Apache-2.0
"""What picture.py draws without tetrahedra: grids in the plane, and surfaces."""

import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402

INK, PAPER = "#1c2733", "#ffffff"
REGION_COLOURS = ["#dfe7ee", "#f0dcb8", "#d6e3c8", "#e3d3ea", "#f0cfc8", "#cfe6e2"]
LINE_COLOURS = ["#b0232a", "#22577a", "#3a7d44", "#7a4fa3", "#b5651d", "#4f6d7a"]
BEST_ANGLE = {3: 60.0, 4: 90.0}  # degrees, by number of corners


class FlatGrid:
    """Points, faces of three or four corners with regions, lines with patches, names of both."""

    def __init__(self, mesh, path):
        points = np.asarray(mesh.points, dtype=float)
        self.points = points if points.shape[1] == 3 else np.c_[points, np.zeros(len(points))]
        self.is_planar = bool((self.points[:, 2] == 0).all())
        self.faces, self.lines = [], []
        for k, block in enumerate(mesh.cells):
            ids = self._numbers(mesh, k, "line" if block.type == "line" else "face", len(block.data))
            if block.type in ("triangle", "quad"):
                self.faces.append((np.asarray(block.data, dtype=int), ids))
            elif block.type == "line":
                self.lines.append((np.asarray(block.data, dtype=int), ids))
        if not self.faces:
            raise SystemExit(f"{path}: neither tetrahedra nor triangles nor quads to draw")
        # our VTU files: field data "patch:<name>" and "region:<name>" = [id, dimension]
        self.names = {1: {}, 2: {}}
        for name, value in mesh.field_data.items():
            number, dimension = (int(v) for v in np.asarray(value).ravel()[:2])
            if dimension in self.names:
                self.names[dimension][number] = name.split(":", 1)[-1]

    def _numbers(self, mesh, k, kind, count):
        wanted = ["patch_id"] if kind == "line" or not self.is_planar else ["region_id", "patch_id"]
        for name in [*wanted, "su2:tag", "gmsh:physical"]:
            if name in mesh.cell_data:
                return np.asarray(mesh.cell_data[name][k]).ravel().astype(int)
        return np.zeros(count, dtype=int)

    def num_faces(self):
        return sum(len(corners) for corners, _ in self.faces)


def min_angles(points, corners):
    """Smallest angle of each face, degrees."""
    p = points[corners]
    to, back = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    lengths = np.linalg.norm(to, axis=2) * np.linalg.norm(back, axis=2)
    cosines = np.einsum("ijk,ijk->ij", to, back) / np.maximum(lengths, 1e-300)
    return np.degrees(np.arccos(np.clip(cosines, -1, 1))).min(axis=1)


def box_of_body(grid):
    """Round the lines that are small against the whole; round all where none is."""
    low, high = grid.points.min(axis=0)[:2], grid.points.max(axis=0)[:2]
    body = []
    for ends, ids in grid.lines:
        for patch in np.unique(ids):
            at = grid.points[ends[ids == patch]].reshape(-1, 3)[:, :2]
            if (np.ptp(at, axis=0) < 0.5 * (high - low)).all():
                body.append(at)
    if body:
        at = np.concatenate(body)
        low, high = at.min(axis=0), at.max(axis=0)
    pad = (0.25 if body else 0.03) * (high - low).max()
    return np.array([low - pad, high + pad])


def draw_plane(grid, options, colour_map):
    box = np.array(options.zoom, dtype=float).reshape(2, 2) if options.zoom else box_of_body(grid)
    width, height = box[1] - box[0]
    figure = plt.figure(figsize=(10, min(max(10 * height / width, 2.5), 10) + 0.7), dpi=100, facecolor=PAPER)
    axes = figure.add_axes([0.01, 0.01, 0.98, 0.98 - 0.6 / figure.get_figheight()])
    seen, worst = 0, 180.0
    for corners, ids in grid.faces:
        at = grid.points[corners][:, :, :2]
        angles = min_angles(grid.points, corners)
        worst = min(worst, angles.min())
        is_seen = (at.max(axis=1) >= box[0]).all(axis=1) & (at.min(axis=1) <= box[1]).all(axis=1)
        seen += is_seen.sum()
        if options.by == "quality":
            colours = colour_map(np.clip(angles[is_seen] / BEST_ANGLE[corners.shape[1]], 0, 1))
        else:
            colours = [REGION_COLOURS[i % len(REGION_COLOURS)] for i in ids[is_seen]]
        drawn = np.median(np.ptp(at[is_seen], axis=1)[:, 0]) / width * 1000 if is_seen.any() else 1  # pixels
        axes.add_collection(PolyCollection(at[is_seen], facecolors=colours, edgecolors=INK,
                                           linewidths=float(np.clip(drawn / 30, 0.08, 0.6))))
    for ends, ids in grid.lines:
        for k, patch in enumerate(np.unique(ids)):
            axes.add_collection(LineCollection(grid.points[ends[ids == patch]][:, :, :2], linewidths=1.8,
                                               colors=LINE_COLOURS[k % len(LINE_COLOURS)],
                                               label=grid.names[1].get(int(patch), f"lines {patch}")))
    axes.set_xlim(box[0][0], box[1][0])
    axes.set_ylim(box[0][1], box[1][1])
    axes.set_aspect("equal")
    axes.set_axis_off()
    title = options.title or os.path.basename(options.grid)
    count = f"{grid.num_faces():,} cells, {seen:,} of them here".replace(",", "\u2009").replace("\u2009 ", ", ")
    scale = "; colours: smallest angle of a cell, red 0, blue as in a regular one" if options.by == "quality" else ""
    facts = f"{count}; smallest angle {worst:.1f}\u00b0{scale}"
    figure.text(0.01, 1 - 0.25 / figure.get_figheight(), title, color=INK, size=14, weight="bold", va="center")
    figure.text(0.01, 1 - 0.5 / figure.get_figheight(), facts, color=INK, size=10, va="center")
    if grid.lines:
        axes.legend(loc="lower left", fontsize=8, framealpha=0.9)
    save(figure, options.out)
    return worst


def save(figure, path):
    """As few colours as show all: a picture of lines is a third as large."""
    figure.savefig(path, dpi=100, facecolor=PAPER)
    plt.close(figure)
    from PIL import Image

    with Image.open(path) as image:
        small = image.convert("RGB").quantize(128)
    small.save(path, optimize=True)
