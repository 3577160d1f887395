#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Picture of a grid: a cut through the volume coloured by quality, with the body's surface; or all of a plane.

    picture.py GRID.vtu OUT.png [--normal 0,1,0] [--origin x,y,z] [--zoom x0,y0,z0,x1,y1,z1]
    picture.py PLANE.vtu OUT.png [--by quality|region] [--zoom x0,y0,x1,y1]
    picture.py SURFACE.stl OUT.png [--by quality|region] [--normal 0,1,0] [--zoom x0,y0,z0,x1,y1,z1]

Cells whose centre lies on the side of the plane that the normal points to are kept and drawn whole ("crinkle cut"),
coloured by their smallest dihedral angle; the viewer stands on the other side. Patches of the boundary that are small
against the whole (the body) are drawn uncut, the others (a far field, a tunnel) only where seen from inside. Needs no
display: a software z-buffer draws the triangles, matplotlib the frame. Needs numpy, matplotlib and meshio.
"""

import argparse
import os
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import meshio  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap, to_rgb  # noqa: E402
from picture_flat import FlatGrid, draw_plane, min_angles  # noqa: E402

WIDTH, HEIGHT = 1600, 900
LEFT, TOP_BAR, RIGHT_BAR, BOTTOM_BAR = 0, 76, 206, 44  # frame round the drawing, pixels
OVERSAMPLING = 2
TOP_ANGLE = 70.5288  # degrees, of the regular tetrahedron
FACES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])  # outward for positive tets
INK, PAPER = "#1c2733", "#ffffff"
QUALITY = LinearSegmentedColormap.from_list(
    "quality", ["#7f0f2b", "#d1342f", "#f58b4c", "#fbd98b", "#d5e8c8", "#86c5c3", "#3f8fbf", "#2a5a9b"]
)
PATCH_COLOURS = ["#d3d6db", "#e3b26b", "#a9b88f", "#b79fc4", "#8fb0c9", "#d39a8d", "#cfc48f", "#9fb9b4"]
FAR_COLOUR = "#e4e3de"


class Grid:
    """Points, positive tets, boundary triangles with patch numbers and names."""

    def __init__(self, mesh):
        self.points = np.asarray(mesh.points, dtype=float)
        tets, triangles, patches = [np.empty((0, 4), int)], [np.empty((0, 3), int)], [np.empty(0, int)]
        patch_data = mesh.cell_data.get("patch_id")
        for k, block in enumerate(mesh.cells):
            if block.type == "tetra":
                tets.append(block.data)
            elif block.type == "triangle":
                triangles.append(block.data)
                ids = np.zeros(len(block.data)) if patch_data is None else np.asarray(patch_data[k]).ravel()
                patches.append(ids.astype(int))
        self.tets = np.concatenate(tets).astype(int)
        self.triangles, self.patch = np.concatenate(triangles).astype(int), np.concatenate(patches)
        # our VTU files: field data "patch:<name>" = [id, dimension]
        tables = {name: np.asarray(value).ravel() for name, value in mesh.field_data.items()}
        self.names = {int(v[0]): name[6:] for name, v in tables.items() if name.startswith("patch:") and v[1] == 2}
        self._face_outwards()

    def _face_outwards(self):
        """Turn boundary triangles as the cells see them, whatever the file's habit is, and note their cells."""
        faces = self.tets[:, FACES].reshape(-1, 3)
        found = find_faces(self.triangles, faces, len(self.points))
        self.triangles[found >= 0] = faces[found[found >= 0]]
        self.cell_behind = found // 4  # -1 for a triangle that is no face

    def name(self, patch):
        return self.names.get(patch, f"patch {patch}")


def min_dihedrals(points, tets):
    """Smallest dihedral angle of each tet, degrees."""
    p = points[tets]
    normals = np.stack([np.cross(p[:, f[1]] - p[:, f[0]], p[:, f[2]] - p[:, f[0]]) for f in FACES], axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-300)
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    cosines = np.stack([-np.einsum("ij,ij->i", normals[:, i], normals[:, j]) for i, j in pairs], axis=1)
    return np.degrees(np.arccos(np.clip(cosines.max(axis=1), -1, 1)))


def cut_faces(grid, keep):
    """Faces between kept and dropped cells: triangles, and the kept cell behind each."""
    owners = np.flatnonzero(keep)
    faces = grid.tets[owners][:, FACES].reshape(-1, 3)
    owner = np.repeat(owners, 4)
    others = grid.tets[~keep][:, FACES].reshape(-1, 3)
    shared = find_faces(faces, others, len(grid.points)) >= 0
    return faces[shared], owner[shared]


def find_faces(wanted, among, num_points):
    """For each wanted triangle the number of one with the same three points among the others, or -1."""
    touched = np.zeros(num_points, dtype=bool)
    touched[wanted] = True
    candidates = np.flatnonzero(touched[among].all(axis=1))
    both = np.sort(np.concatenate([wanted, among[candidates]]), axis=1).astype(np.int64)
    key = np.unique(both[:, 0] * num_points + both[:, 1], return_inverse=True)[1].ravel() * num_points + both[:, 2]
    if len(candidates) == 0:
        return np.full(len(wanted), -1)
    order = np.argsort(key[len(wanted) :], kind="stable")
    sorted_keys = key[len(wanted) :][order]
    at = np.minimum(np.searchsorted(sorted_keys, key[: len(wanted)]), len(order) - 1)
    return np.where(sorted_keys[at] == key[: len(wanted)], candidates[order[at]], -1)


def body_patches(grid):
    """Patches that are small against the whole boundary: what the picture is about."""
    span = np.ptp(grid.points, axis=0)
    result = []
    for patch in np.unique(grid.patch):
        extent = np.ptp(grid.points[grid.triangles[grid.patch == patch]].reshape(-1, 3), axis=0)
        if (extent > 0.6 * span).sum() < 2:
            result.append(patch)
    return result


class Camera:
    """Perspective view that frames points round their middle; rows of `basis` are right, up and forward."""

    def __init__(self, points, forward, up, width, height, margin=1.04):
        right = np.cross(forward, up)
        right /= np.linalg.norm(right)
        self.basis = np.stack([right, np.cross(right, forward), forward])
        self.width, self.height = width, height
        self.focal = 2.4 * height
        local = points @ self.basis.T
        centre = 0.5 * (local.min(axis=0) + local.max(axis=0)) @ self.basis
        local -= centre @ self.basis.T
        half = np.array([width, height]) / (2 * margin * self.focal)
        back = (np.abs(local[:, :2]) / half).max(axis=1) - local[:, 2]
        self.eye = centre - max(back.max(), 1e-12) * forward

    def project(self, points):
        """Pixel x (right), y (down) and inverse depth, which is linear on the screen; 0 behind the viewer."""
        local = (points - self.eye) @ self.basis.T
        inverse = np.where(local[:, 2] > 1e-9, 1.0 / np.maximum(local[:, 2], 1e-9), 0.0)
        x = self.width / 2 + self.focal * local[:, 0] * inverse
        y = self.height / 2 - self.focal * local[:, 1] * inverse
        return np.stack([x, y, inverse], axis=1)


class Canvas:
    """Image with a z-buffer."""

    def __init__(self, width, height):
        self.image = np.ones((height, width, 3), dtype=np.float32)
        self.depth = np.zeros((height, width), dtype=np.float32)

    def draw(self, camera, points, triangles, colours, line, line_strength):
        """Filled triangles with their sides as lines; `line` is half a side's width in pixels."""
        screen = camera.project(points)
        corners = screen[triangles]
        seen = (corners[:, :, 2] > 0).all(axis=1)
        low, high = corners[:, :, :2].min(axis=1), corners[:, :, :2].max(axis=1)
        seen &= (high > 0).all(axis=1) & (low < [camera.width, camera.height]).all(axis=1)
        order = np.flatnonzero(seen)
        order = order[np.argsort(-corners[order, :, 2].mean(axis=1), kind="stable")]  # near ones first: fewer writes
        ink = np.array(to_rgb(INK), dtype=np.float32)
        for t in order:
            self._triangle(corners[t], colours[t], line, line_strength, ink)

    def _triangle(self, p, colour, line, line_strength, ink):
        height, width = self.depth.shape
        x0, y0 = max(int(p[:, 0].min()), 0), max(int(p[:, 1].min()), 0)
        x1, y1 = min(int(p[:, 0].max()) + 2, width), min(int(p[:, 1].max()) + 2, height)
        ax, ay, az = p[0]
        bx, by, bz = p[1] - p[0]
        cx, cy, cz = p[2] - p[0]
        area = bx * cy - by * cx
        if x0 >= x1 or y0 >= y1 or abs(area) < 1e-9:
            return
        x = np.arange(x0, x1) + (0.5 - ax)
        y = (np.arange(y0, y1) + (0.5 - ay))[:, None]
        v = (x * cy - y * cx) / area
        w = (bx * y - by * x) / area
        u = 1.0 - v - w
        inside = (u >= 0) & (v >= 0) & (w >= 0)
        depth = az + v * bz + w * cz
        buffer = self.depth[y0:y1, x0:x1]
        inside &= depth > buffer
        if not inside.any():
            return
        buffer[inside] = depth[inside]
        doubled = abs(area)
        heights = doubled / np.array([np.hypot(cx - bx, cy - by), np.hypot(cx, cy), np.hypot(bx, by)])
        away = np.minimum(np.minimum(u[inside] * heights[0], v[inside] * heights[1]), w[inside] * heights[2])
        strength = line_strength * min(1.0, heights.min() / (8.0 * line))  # lines fade where cells are tiny
        mix = (strength * np.clip(line + 0.5 - away, 0.0, 1.0))[:, None].astype(np.float32)
        self.image[y0:y1, x0:x1][inside] = colour * (1 - mix) + ink * mix

    def reduced(self):
        h, w = self.depth.shape
        k = OVERSAMPLING
        return self.image.reshape(h // k, k, w // k, k, 3).mean(axis=(1, 3))


def normals_of(points, triangles):
    p = points[triangles]
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    return n / np.maximum(np.linalg.norm(n, axis=1), 1e-300)[:, None]


def lit(colours, normals, camera, ambient):
    """Soft light from over the viewer's left shoulder; both sides of a face alike."""
    light = camera.basis.T @ np.array([-0.45, 0.65, -0.75])
    light /= np.linalg.norm(light)
    shade = ambient + (1 - ambient) * np.abs(normals @ light)
    return (colours * np.minimum(shade, 1.0)[:, None]).astype(np.float32)


def draw_grid(grid, quality, options):
    width = (WIDTH - LEFT - RIGHT_BAR) * OVERSAMPLING
    height = (HEIGHT - TOP_BAR - BOTTOM_BAR) * OVERSAMPLING
    body = body_patches(grid)
    is_body = np.isin(grid.patch, body)
    if options.zoom:
        box = np.array(options.zoom).reshape(2, 3)
    else:
        focus = grid.triangles[is_body] if is_body.any() else grid.triangles if len(grid.triangles) else grid.tets
        box = np.stack([grid.points[focus].reshape(-1, 3).min(axis=0), grid.points[focus].reshape(-1, 3).max(axis=0)])
        pad = (0.12 if is_body.any() else 0.0) * np.ptp(box, axis=0).max()
        box += [[-pad], [pad]]
    normal = np.array(options.normal) / np.linalg.norm(options.normal)
    origin = np.array(options.origin) if options.origin else 0.5 * (box[0] + box[1])
    up = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.8 else np.array([0.0, 1.0, 0.0])
    side = np.cross(normal, up)
    turn, lift = np.radians(options.turn), np.radians(options.lift)
    forward = np.cos(lift) * (np.cos(turn) * normal + np.sin(turn) * side) - np.sin(lift) * up
    frame = np.array([[box[i][0], box[j][1], box[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    if not options.zoom and not is_body.any():
        frame = grid.points[np.unique(grid.tets)]
    camera = Camera(frame, forward / np.linalg.norm(forward), up, width, height)

    keep = (grid.points[grid.tets].mean(axis=1) - origin) @ normal > 0
    canvas = Canvas(width, height)
    faces, owner = cut_faces(grid, keep)
    colours = QUALITY(np.clip(quality[owner] / TOP_ANGLE, 0, 1))[:, :3]
    line = 0.55 * OVERSAMPLING
    canvas.draw(camera, grid.points, faces, lit(colours, normals_of(grid.points, faces), camera, 0.78), line, 0.85)

    n = normals_of(grid.points, grid.triangles)
    from_inside = np.einsum("ij,ij->i", grid.points[grid.triangles[:, 0]] - camera.eye, n) > 0
    if not is_body.any():  # no body: the kept half of the boundary, as a shell behind the cut
        show, hue = keep[grid.cell_behind] & (grid.cell_behind >= 0), np.zeros(len(grid.triangles), dtype=int)
    else:
        show, hue = is_body | from_inside, np.searchsorted(body, grid.patch)
    palette = np.array([to_rgb(c) for c in PATCH_COLOURS])
    colours = np.where(
        (is_body | (not is_body.any()))[:, None], palette[hue % len(palette)], np.array(to_rgb(FAR_COLOUR))
    )
    colours = lit(colours, n, camera, 0.6)
    canvas.draw(camera, grid.points, grid.triangles[show], colours[show], line, 0.45)
    legend = [(grid.name(b), PATCH_COLOURS[k % len(PATCH_COLOURS)], int((grid.patch == b).sum()))
              for k, b in enumerate(body)]
    if not body:
        legend = [("boundary", PATCH_COLOURS[0], len(grid.triangles))]
    elif not is_body.all():
        legend.append(("outer boundary", FAR_COLOUR, int((~is_body).sum())))
    return canvas.reduced(), legend


def draw_surface(flat, options):
    """All faces of a surface, from outside, by quality or by patch."""
    triangles, angles, patches = [], [], []
    for corners, ids in flat.faces:
        parts = corners if corners.shape[1] == 3 else np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
        triangles.append(parts)
        patches.append(np.resize(ids, len(parts)))
        angles.append(min_angles(flat.points, parts))
    triangles, patches, angles = np.concatenate(triangles), np.concatenate(patches), np.concatenate(angles)
    normal = np.array(options.normal) / np.linalg.norm(options.normal)
    up = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.8 else np.array([0.0, 1.0, 0.0])
    turn, lift = np.radians(options.turn), np.radians(options.lift)
    forward = np.cos(lift) * (np.cos(turn) * normal + np.sin(turn) * np.cross(normal, up)) - np.sin(lift) * up
    frame = flat.points[np.unique(triangles)]
    if options.zoom:
        box = np.array(options.zoom).reshape(2, 3)
        frame = np.array([[box[i][0], box[j][1], box[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    width, height = WIDTH * OVERSAMPLING, (HEIGHT - TOP_BAR - BOTTOM_BAR) * OVERSAMPLING
    camera = Camera(frame, forward / np.linalg.norm(forward), up, width, height)
    palette = np.array([to_rgb(c) for c in PATCH_COLOURS])
    by_patch = palette[np.unique(patches, return_inverse=True)[1].ravel() % len(palette)]
    colours = by_patch if options.by == "region" else QUALITY(np.clip(angles / 60, 0, 1))[:, :3]
    canvas = Canvas(width, height)
    shades = lit(colours, normals_of(flat.points, triangles), camera, 0.6)
    canvas.draw(camera, flat.points, triangles, shades, 0.55 * OVERSAMPLING, 0.6)
    figure = plt.figure(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100, facecolor=PAPER)
    axes = figure.add_axes([0, BOTTOM_BAR / HEIGHT, 1, 1 - (TOP_BAR + BOTTOM_BAR) / HEIGHT])
    axes.imshow(np.clip(canvas.reduced(), 0, 1), interpolation="nearest", aspect="auto")
    axes.set_axis_off()
    title = options.title or os.path.basename(options.grid)
    figure.text(24 / WIDTH, 1 - 24 / HEIGHT, title, color=INK, size=17, weight="bold", va="center")
    facts = f"{grouped(len(triangles))} triangles     smallest angle {angles.min():.1f}\u00b0"
    figure.text(24 / WIDTH, 1 - 55 / HEIGHT, facts, color=INK, size=11.5, va="center")
    if options.by == "region":
        add_legend(figure, [(flat.names[2].get(int(p), f"patch {p}"), PATCH_COLOURS[k % len(PATCH_COLOURS)],
                             int((patches == p).sum())) for k, p in enumerate(np.unique(patches))])
    figure.savefig(options.out, dpi=100, facecolor=PAPER)
    plt.close(figure)
    return len(triangles), angles.min()


def grouped(number):
    return f"{number:,}".replace(",", "\u2009")


def compose(image, legend, grid, quality, options):
    figure = plt.figure(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100, facecolor=PAPER)
    plt.rcParams["font.family"] = "DejaVu Sans"

    def box(x, y, w, h):
        return [x / WIDTH, y / HEIGHT, w / WIDTH, h / HEIGHT]

    axes = figure.add_axes(box(LEFT, BOTTOM_BAR, image.shape[1], image.shape[0]))
    axes.imshow(np.clip(image, 0, 1), interpolation="nearest", aspect="auto")
    axes.set_axis_off()
    title = options.title or os.path.basename(options.grid)
    figure.text(24 / WIDTH, 1 - 24 / HEIGHT, title, color=INK, size=17, weight="bold", va="center")
    below = 100.0 * (quality < 10).mean()
    share = "none" if not (quality < 10).any() else f"{below:.2g} %"
    facts = (f"{grouped(len(grid.tets))} tetrahedra     {grouped(len(grid.points))} points     "
             f"{grouped(len(grid.triangles))} boundary triangles     smallest dihedral angle {quality.min():.1f}\u00b0"
             f"     below 10\u00b0: {share}")
    figure.text(24 / WIDTH, 1 - 55 / HEIGHT, facts, color=INK, size=11.5, va="center")
    add_scale(figure, box, quality)
    add_legend(figure, legend)
    figure.savefig(options.out, dpi=100, facecolor=PAPER)
    plt.close(figure)


def add_scale(figure, box, quality):
    """Colour bar with the share of all cells in each bin beside it."""
    x, y, h = WIDTH - RIGHT_BAR + 44, BOTTOM_BAR + 40, HEIGHT - TOP_BAR - BOTTOM_BAR - 110
    bar = figure.add_axes(box(x, y, 22, h))
    ramp = np.linspace(0, 1, 512)[:, None]
    bar.imshow(ramp, cmap=QUALITY, origin="lower", aspect="auto", extent=(0, 1, 0, TOP_ANGLE))
    bar.set_xticks([])
    bar.set_yticks(range(0, 71, 10))
    bar.tick_params(axis="y", labelsize=10, colors=INK, length=3)
    bar.set_yticklabels([f"{k}\u00b0" for k in range(0, 71, 10)])
    counts, edges = np.histogram(quality, bins=47, range=(0, TOP_ANGLE))
    side = figure.add_axes(box(x + 26, y, 100, h))
    middles = 0.5 * (edges[1:] + edges[:-1])
    side.barh(middles, counts / max(counts.max(), 1), height=np.diff(edges) * 0.86, color=QUALITY(middles / TOP_ANGLE))
    side.set_xlim(0, 1.02)
    side.set_ylim(0, TOP_ANGLE)
    side.set_axis_off()
    figure.text((x - 28) / WIDTH, (y + h + 34) / HEIGHT, "smallest dihedral angle", color=INK, size=10, weight="bold")
    figure.text((x - 28) / WIDTH, (y + h + 17) / HEIGHT, "and share of all cells", color=INK, size=10)


def add_legend(figure, legend):
    x = 24.0
    for name, colour, count in legend:
        if x > WIDTH - RIGHT_BAR - 120:
            break
        patch = plt.Rectangle((x / WIDTH, 15 / HEIGHT), 15 / WIDTH, 15 / HEIGHT, facecolor=colour, edgecolor=INK,
                              linewidth=0.6, transform=figure.transFigure, figure=figure)
        figure.patches.append(patch)
        text = f"{name}  {grouped(count)}"
        figure.text((x + 22) / WIDTH, 22 / HEIGHT, text, color=INK, size=10.5, va="center")
        x += 22 + 7.3 * len(text) + 30


def numbers(*counts):
    def parse(text):
        values = [float(v) for v in text.split(",")]
        if len(values) not in counts or not np.isfinite(values).all():
            wanted = " or ".join(map(str, counts))
            raise argparse.ArgumentTypeError(f"{wanted} numbers with commas between, got '{text}'")
        return values

    return parse


def parse_arguments(arguments):
    # argparse takes "-1,0,0" for an option; joined to its flag it is a value
    joined = re.sub(r"(?m)^(--(?:normal|origin|zoom))\n", r"\1=", "\n".join(arguments)).split("\n")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("grid", help="VTU or any other file that meshio reads")
    parser.add_argument("out", help="PNG to write")
    parser.add_argument("--normal", type=numbers(3), default=[0, 1, 0], help="of the cut; cells behind it are kept")
    parser.add_argument("--origin", type=numbers(3), help="a point of the cut; default: the middle of the zoom box")
    parser.add_argument("--zoom", type=numbers(4, 6), help="box to look at; default: round the body")
    parser.add_argument("--by", choices=["quality", "region"], default="quality", help="colours, without tetrahedra")
    parser.add_argument("--turn", type=float, default=-24, help="degrees to go round, seen from above")
    parser.add_argument("--lift", type=float, default=16, help="degrees to look down")
    parser.add_argument("--title", help="default: the file's name")
    return parser.parse_args([a for a in joined if a])


def main():
    options = parse_arguments(sys.argv[1:])
    mesh = meshio.read(options.grid)
    is_volume = any(block.type == "tetra" for block in mesh.cells)
    flat = None if is_volume else FlatGrid(mesh, options.grid)
    corners = 4 if flat and flat.is_planar else 6
    if options.zoom and len(options.zoom) != corners:
        raise SystemExit(f"--zoom: {corners} numbers for this grid, got {len(options.zoom)}")
    if flat and flat.is_planar:
        worst = draw_plane(flat, options, QUALITY)
        print(f"{options.out}: {flat.num_faces()} cells, smallest angle {worst:.2f} deg")
        return
    if flat:
        count, worst = draw_surface(flat, options)
        print(f"{options.out}: {count} triangles, smallest angle {worst:.2f} deg")
        return
    grid = Grid(mesh)
    quality = min_dihedrals(grid.points, grid.tets)
    image, legend = draw_grid(grid, quality, options)
    compose(image, legend, grid, quality, options)
    print(f"{options.out}: {len(grid.tets)} tetrahedra, smallest dihedral angle {quality.min():.2f} deg")


if __name__ == "__main__":
    main()
