#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The advancing front in the plane beside our other methods, Triangle and Gmsh's Frontal-Delaunay.

    bench/planar_front.py [--ours build/release/delfront] [--sizes 100000,1000000] [--gmsh-size 100000] [--repeat 3]
                          [--write-docs]

The unit square at one size, its boundary divided beforehand and kept, on one core. Ours is timed by the stages of its
report: placing and connecting points (front or refine), and what follows (smooth, improve); Triangle around its call,
Gmsh by the time it prints for its 2-D stage. Quality is 4 sqrt(3) area over the sum of squared sides, by one routine for
all. Then the sections of the shared data in a far field of 50 chords. Runs take turns; medians. Tables go into
docs/front-plane.md between their markers.
"""

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import grids, machine, peers, script  # noqa: E402

PAGE = peers.ROOT / "docs" / "front-plane.md"
MAKER = "planar_front.py"
METHODS = ("front", "front-delaunay", "delaunay")
SECTIONS = ("naca0012", "rae2822", "s1223")
ANGLE = 30  # asked of all that can be asked
TIME_LIMIT = 300


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ours", help="our program; default: the newest of build/*")
    parser.add_argument("--sizes", default="100000,1000000", help="triangles, about")
    parser.add_argument("--gmsh-size", type=int, default=100_000, help="most triangles that Gmsh is asked for")
    parser.add_argument("--repeat", type=int, default=3)
    shared = Path(os.environ.get("DELFRONT_SHARED", peers.ROOT.parent / "shared"))
    parser.add_argument("--shared-data", type=Path, default=shared / "data")
    parser.add_argument("--write-docs", action="store_true", help="write the tables into docs/front-plane.md")
    return parser.parse_args()


def run_words(command: list[str], folder: Path) -> str:
    done = subprocess.run(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=TIME_LIMIT, check=False
    )
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: {done.stdout.strip()[-400:]}")
    return done.stdout


def mean_quality(points: np.ndarray, triangles: np.ndarray) -> float:
    corner = points[triangles][:, :, :2]
    to_next = np.roll(corner, -1, axis=1) - corner
    area = (to_next[:, 0, 0] * to_next[:, 1, 1] - to_next[:, 0, 1] * to_next[:, 1, 0]) / 2
    return float((4 * 3**0.5 * np.abs(area) / (to_next**2).sum(axis=(1, 2))).mean())


def measure(points: np.ndarray, triangles: np.ndarray) -> dict:
    facts = grids.measure_triangles(points, triangles)
    return {"triangles": facts["triangles"], "angle": facts["min_angle"], "quality": mean_quality(points, triangles)}


def segments_a_side(triangles: int) -> int:
    return round((triangles * 3**0.5 / 4) ** 0.5)


def write_square(folder: Path, n: int) -> None:
    """For ours a .poly, for Triangle a case.json, for Gmsh a .geo: the same points on the same boundary."""
    t = [i / n for i in range(n)]
    points = [(x, 0.0) for x in t] + [(1.0, y) for y in t] + [(1 - x, 1.0) for x in t] + [(0.0, 1 - y) for y in t]
    count = len(points)
    with (folder / "square.poly").open("w", encoding="ascii") as file:
        file.write(f"{count} 2 0 0\n" + "".join(f"{i + 1} {x!r} {y!r}\n" for i, (x, y) in enumerate(points)))
        file.write(f"{count} 0\n" + "".join(f"{i + 1} {i + 1} {(i + 1) % count + 1}\n" for i in range(count)) + "0\n")
    (folder / "case.json").write_text(json.dumps({"loops": [points], "hole": None, "split": None}), encoding="ascii")
    with (folder / "square.geo").open("w", encoding="ascii") as file:
        for i, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)), 1):
            file.write(f"Point({i}) = {{{x}, {y}, 0, {1 / n!r}}};\n")
        file.write("".join(f"Line({i}) = {{{i}, {i % 4 + 1}}};\n" for i in range(1, 5)))
        file.write(f"Curve Loop(1) = {{1:4}};\nPlane Surface(1) = {{1}};\nTransfinite Curve{{1:4}} = {n + 1};\n")


def run_ours(program: str, folder: Path, method: str, words: list[str], grid: str) -> tuple[dict, dict]:
    report = folder / "report.json"
    run_words(
        [program, "mesh", *words, "-o", grid, "--set", f"planar.method={method}", "--set", f"planar.min_angle={ANGLE}"]
        + ["--threads", "1", "--report", str(report)],
        folder,
    )
    text = json.loads(report.read_text(encoding="utf-8"))
    seconds: dict[str, float] = {}
    for stage in text["stages"]:
        seconds[stage["stage"]] = seconds.get(stage["stage"], 0) + stage["seconds"]
    times = {"place": seconds["front" if method == "front" else "refine"]}
    times["rest"] = seconds.get("smooth", 0) + seconds.get("improve", 0)
    return times, text


def run_triangle(folder: Path, n: int) -> dict:
    area = 3**0.5 / 4 / n**2 * 1.552  # its triangles are on average 0.64 of the bound
    words = [str(peers.VENV_PYTHON), str(peers.SOURCES / "triangle_refine.py"), "case.json"]
    facts = json.loads(run_words([*words, f"pYq{ANGLE}a{area:.15f}Q"], folder).splitlines()[-1])
    return {"place": facts["seconds"], "rest": 0, "triangles": facts["triangles"]} | {
        "angle": facts["min_angle"],
        "quality": facts["mean_quality"],
    }


def run_gmsh(words: list[str], folder: Path) -> dict:
    log = run_words(
        [*words, "-2", "square.geo", "-algo", "front2d", "-nt", "1", "-o", "gmsh.mesh", "-format", "mesh"], folder
    )
    seconds = float(re.findall(r"Done meshing 2D \(Wall ([\d.eE+-]+)s", log)[-1])
    return {"place": seconds, "rest": 0} | measure(*grids.read_medit(folder / "gmsh.mesh", b"Triangles", 3))


def collect_square(options, program: str, size: int) -> list[str]:
    n = segments_a_side(size)
    with tempfile.TemporaryDirectory(prefix="delfront_plane_") as name:
        folder = Path(name)
        write_square(folder, n)
        runs: dict[str, list[dict]] = {}
        _, gmsh, version, gmsh_lacks = peers.find_gmshs()[0]
        triangle = peers.pypi_version("triangle")
        for _ in range(options.repeat):
            for method in METHODS:
                times, _ = run_ours(program, folder, method, ["square.poly"], "ours.mesh")
                facts = measure(*grids.read_medit(folder / "ours.mesh", b"Triangles", 3, dimension=2))
                runs.setdefault(f"delfront, {method}", []).append(times | facts)
            if triangle:
                runs.setdefault(f"Triangle 1.6 (PyPI {triangle})", []).append(run_triangle(folder, n))
            if not gmsh_lacks and size <= options.gmsh_size:
                runs.setdefault(f"Gmsh {version} Frontal-Delaunay", []).append(run_gmsh(gmsh, folder))
    lines = []
    for tool, found in runs.items():
        middle = {key: statistics.median(run[key] for run in found) for key in found[0]}
        whole = middle["place"] + middle["rest"]
        lines.append(
            f"| {size:.0e} | {tool} | {middle['triangles']:,.0f} | {middle['place']:.3f} | {middle['rest']:.3f} | "
            f"{middle['triangles'] / middle['place'] * 1e-6:.2f} | {middle['triangles'] / whole * 1e-6:.2f} | "
            f"{middle['quality']:.4f} | {middle['angle']:.1f} |"
        )
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


def collect_sections(options, program: str) -> list[str]:
    lines = []
    with tempfile.TemporaryDirectory(prefix="delfront_plane_") as name:
        folder = Path(name)
        for section in SECTIONS:
            path = options.shared_data / "airfoil" / f"{section}.dat"
            if not path.exists():
                sys.exit(f"{path.name} is not in the shared data; set DELFRONT_SHARED")
            for method in METHODS:
                words = [str(path), "--farfield", "circle:50c"]
                _, text = run_ours(program, folder, method, words, "ours.mesh")
                facts = measure(*grids.read_medit(folder / "ours.mesh", b"Triangles", 3, dimension=2))
                front = text["front"]
                counts = f"{front['sweeps']} | {front['cavities']} | {front['closed_by_delaunay']}"
                lines.append(
                    f"| {section} | {method} | {facts['triangles']:,} | {counts if method == 'front' else ' | | '} | "
                    f"{facts['quality']:.4f} | {facts['angle']:.1f} |"
                )
    return lines


def main() -> int:
    options = parse()
    program, why = peers.find_ours("delfront", options.ours)
    if not program:
        print(why, file=sys.stderr)
        return 1
    text = f"{machine.describe()}; one core, medians of {options.repeat}, by `bench/planar_front.py --write-docs`; load "
    text += f"average {machine.load():.1f} when it began (over 1: other work ran beside it).\n\n"
    text += "The unit square, its boundary kept; an angle of 30 degrees asked for. Millions of triangles a second: of the "
    text += "stage that places and connects points, and with smoothing and improvement.\n\n"
    text += "| size | tool | triangles | points, s | the rest, s | 1e6 / s | 1e6 / s, all | mean quality | least angle |\n"
    text += "| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n"
    for size in options.sizes.split(","):
        text += "\n".join(collect_square(options, program, int(size))) + "\n"
    text += "\nSections of airfoils, `delfront mesh SECTION.dat --farfield circle:50c --set planar.method=…`:\n\n"
    text += "| section | method | triangles | sweeps | cavities | closed by Delaunay | mean quality | least angle |\n"
    text += "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n"
    text += "\n".join(collect_sections(options, program)) + "\n"
    return script.publish(text, PAGE, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
