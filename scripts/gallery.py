#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Make the smooth shapes of examples/, grid them with no sizes given, check the grids, and draw them for docs/gallery.md.

    gallery.py [NAME ...] [--delfront build/release/delfront] [--cad-shapes build/release/examples/make_cad_shapes]
               [--out docs/geometry | --check]

Of each grid: `delfront check` finds nothing, the goals of the surface are met, it is closed where the shape is, the volume
within is the shape's own (within what chords cut off), and no angle away from sharp corners is below 20 degrees. --check: no
pictures. The STEP file is left out, and that is said, where its maker was not built. Exit 1 where something is not so.
"""
import argparse
import importlib
import json
import math
import os
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
EXAMPLES = os.path.join(ROOT, "examples")
LEAST_ANGLE = 20
SIZE, COLOURS = (960, 540), 256


def text_of(folder, module, call):
    """Geometry as text, by a script of examples/."""
    def make(path, _):
        sys.path.insert(0, os.path.join(EXAMPLES, folder))
        with open(path, "w", encoding="utf-8") as out:
            out.write("\n".join(call(importlib.import_module(module))))
    return make


def shape_of(name):
    return text_of("smooth_shapes", "make_shapes", lambda m: m.SHAPES[name]())


def make_ahmed(path, options):
    subprocess.run([options.cad_shapes, os.path.dirname(path)], check=True)


def propeller_volume():
    sys.path.insert(0, os.path.join(EXAMPLES, "propeller"))
    return importlib.import_module("make_propeller").volume()


def tee_volume(radius=0.5, branch=0.3, half=1.5, height=1.4, steps=2000):
    """The run, and the branch above it: columns of the branch's disc from sqrt(radius^2 - y^2) up."""
    dy = 2 * branch / steps
    ys = [(i + 0.5) * dy - branch for i in range(steps)]
    above = sum(2 * math.sqrt(branch ** 2 - y * y) * (height - math.sqrt(radius ** 2 - y * y)) * dy for y in ys)
    return 2 * half * math.pi * radius ** 2 + above


class Row:
    """A shape: how its file is made, what is drawn of it, how large it is."""

    def __init__(self, file, title, make, views, volume=None, share=0.01, **more):
        self.file, self.title, self.make, self.views = file, title, make, views
        self.volume, self.share = volume, share  # None: not known, or open
        self.is_closed = more.get("is_closed", True)
        self.has_cells = more.get("has_cells", False)


ROWS = {
    "onera_m6": Row("m6.geom.toml", "ONERA M6 wing", text_of("onera_m6", "make_m6", lambda m: m.wing()), {
        "onera_m6": ["--by", "region"],
        "onera_m6_trailing_edge": ["--by", "region", "--normal=-1,-0.2,0", "--zoom=1.125,1.17,-0.01,1.15,1.2,0.01", "--lift", "15"],
    }),
    "ahmed": Row("ahmed.step", "Ahmed body, from STEP", make_ahmed,
                 {"ahmed_step": ["--zoom=-300,-400,0,1500,400,700"]}, 26.069091e9, 1e-3, has_cells=True),
    "tee": Row("tee.geom.toml", "Pipe tee", shape_of("tee"), {"tee": ["--by", "region"]}, tee_volume()),
    "propeller": Row("propeller.geom.toml", "Propeller: splines on a hub", text_of("propeller", "make_propeller", lambda m: m.propeller()),
                     {"propeller": ["--by", "region", "--normal=0.5,1,-1.2", "--lift", "0", "--zoom=-0.6,-0.6,-0.4,0.6,0.55,0.3"],
                      "propeller_root": ["--by", "region", "--normal=0.5,1,-0.6", "--zoom=-0.1,-0.35,-0.15,0.35,0.1,0.2", "--lift", "0"]},
                     propeller_volume()),
    "blade": Row("blade.geom.toml", "Twisted blade", shape_of("blade"),
                 {"blade": ["--by", "region", "--normal=-1,1,0", "--lift", "10"]}),
    "ball": Row("ball.geom.toml", "Sphere with its poles", shape_of("ball"), {"ball": ["--by", "region", "--lift", "50"]},
                4 * math.pi / 3, 0.02),
    "ring": Row("ring.geom.toml", "Torus", shape_of("ring"), {"ring": ["--by", "region", "--lift", "30"]},
                2 * math.pi ** 2 * 0.09, 0.02),
    "spike": Row("spike.geom.toml", "Cone with its tip", shape_of("spike"), {"spike": ["--by", "region", "--lift", "-12"]},
                 math.pi * 0.25 * 1.5 / 3, 0.02),
    "patch": Row("patch.geom.toml", "Half of a hill, trimmed", shape_of("patch"),
                 {"patch": ["--by", "region", "--lift", "35"]}, is_closed=False),
}


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="NAME", help="of " + ", ".join(ROWS))
    parser.add_argument("--delfront", default=os.path.join(ROOT, "build", "release", "delfront"))
    parser.add_argument("--cad-shapes", default=os.path.join(ROOT, "build", "release", "examples", "make_cad_shapes"))
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "geometry"))
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    for row in options.rows:
        if row not in ROWS:
            parser.error(f"no such shape: {row}; there are: {', '.join(ROWS)}")
    return options


def faults_of(row, report):
    """What is not as it should be."""
    smooth, surface = report["geometry"][0], report["surface"]
    last = smooth["rounds"][-1]
    if surface["is_closed"] != row.is_closed:
        yield "closed" if surface["is_closed"] else "not closed"
    if smooth["stopped"]:
        yield "goals missed: " + smooth["stopped"]
    least = last["min_angle_away_from_sharp_corners"]["value"]
    if least < LEAST_ANGLE:
        yield f"an angle of {least:.1f} degrees away from sharp corners"
    volume = report["quality"]["volume"] if row.has_cells else surface["volume"]
    if row.volume and abs(volume / row.volume - 1) > row.share:
        yield f"volume {volume:.6g}, the shape's is {row.volume:.6g}"


def run(row, options, folder):
    """@return the grid's path, and what was wrong"""
    path, grid, report = (os.path.join(folder, name) for name in (row.file, "grid.vtu", "report.json"))
    row.make(path, options)
    command = [options.delfront, "mesh", path, "-o", grid, "--report", report]
    for words in (command + ([] if row.has_cells else ["--stop-after", "surface"]), [options.delfront, "check", grid]):
        if words[1] == "check" and not row.is_closed:
            continue  # it says that the surface is open
        done = subprocess.run(words, capture_output=True, text=True, errors="replace", check=False)
        if done.returncode != 0:
            return grid, [f"{words[1]}: exit {done.returncode}: {done.stderr.strip()}"]
    with open(report, encoding="utf-8") as file:
        made = json.load(file)
    last = made["geometry"][0]["rounds"][-1]
    print(f"{row.title}: {last['triangles']:,} triangles, angles from {last['min_angle']:.1f} degrees"
          + (f", {made['quality']['num_cells']:,} tetrahedra" if row.has_cells else ""), flush=True)
    return grid, list(faults_of(row, made))


def draw(row, grid, options, folder):
    from PIL import Image
    for name, words in row.views.items():
        large, out = os.path.join(folder, name + ".png"), os.path.join(options.out, name + ".png")
        subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "picture.py"), grid, large, "--title", row.title,
                        *words], check=True, stdout=subprocess.DEVNULL)
        with Image.open(large) as image:
            small = image.convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
        small.quantize(COLOURS, kmeans=2, dither=Image.Dither.NONE).save(out, optimize=True)
        print(f"  {os.path.relpath(out)}: {os.path.getsize(out) / 1000:.0f} kB", flush=True)


def main():
    options, bad = read_options(), 0
    for name in options.rows or ROWS:
        row = ROWS[name]
        if row.make is make_ahmed and not os.path.exists(options.cad_shapes):
            print(f"gallery.py: {name} is left out: no {options.cad_shapes}; it is built where OpenCASCADE is found")
            continue
        with tempfile.TemporaryDirectory() as folder:
            grid, faults = run(row, options, folder)
            for fault in faults:
                print(f"  {name}: {fault}", flush=True)
            bad += bool(faults)
            if not options.check and os.path.exists(grid):
                draw(row, grid, options, folder)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
