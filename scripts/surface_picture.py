#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Picture of a surface grid: its triangles, a colour a patch.

    surface_picture.py GRID.vtu OUT.png [--forward 0.6,0.6,-0.4] [--zoom x0,y0,z0,x1,y1,z1]

Needs no display, as picture.py, whose drawing it uses. Needs numpy, matplotlib and meshio.
"""

import argparse

import meshio
import numpy as np
import picture
from matplotlib import image
from matplotlib.colors import to_rgb

WIDTH, HEIGHT = 1000, 640


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("grid")
    parser.add_argument("out")
    parser.add_argument("--forward", type=picture.numbers(3), default=[0.6, 0.6, -0.4], help="where the viewer looks to")
    parser.add_argument("--zoom", type=picture.numbers(6), help="box to look at; default: all of it")
    options = parser.parse_args()
    mesh = meshio.read(options.grid)
    points, triangles, patches = np.asarray(mesh.points, dtype=float), [], []
    ids = mesh.cell_data.get("patch_id")
    for k, block in enumerate(mesh.cells):
        if block.type == "triangle":
            triangles.append(block.data)
            patches.append(np.zeros(len(block.data)) if ids is None else np.asarray(ids[k]).ravel())
    triangles, patches = np.concatenate(triangles).astype(int), np.concatenate(patches).astype(int)
    forward = np.array(options.forward) / np.linalg.norm(options.forward)
    up = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    frame = points[np.unique(triangles)]
    if options.zoom:
        box = np.array(options.zoom).reshape(2, 3)
        frame = np.array([[box[i][0], box[j][1], box[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    scale = picture.OVERSAMPLING
    camera = picture.Camera(frame, forward, up, WIDTH * scale, HEIGHT * scale)
    canvas = picture.Canvas(WIDTH * scale, HEIGHT * scale)
    palette = np.array([to_rgb(c) for c in picture.PATCH_COLOURS])
    colours = picture.lit(palette[np.unique(patches, return_inverse=True)[1] % len(palette)],
                          picture.normals_of(points, triangles), camera, 0.6)
    canvas.draw(camera, points, triangles, colours, 0.5 * scale, 0.8)
    image.imsave(options.out, np.clip(canvas.reduced(), 0, 1))
    print(f"{options.out}: {len(triangles)} triangles")


if __name__ == "__main__":
    main()
