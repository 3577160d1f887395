#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Size sources: scan, tree and lists of delfront, and Gmsh's Min of Distance and Threshold fields, in one run.

    bench/compare_sizes.py [--bench size_field_bench] [--repeat 3] [--sources 10,100,1000,10000] [--write-docs]

Gmsh (PyPI, in the environment that scripts/setup --peers makes) is driven as a process of its own by
bench/peers/gmsh_size_field.py. The same point sources and places for both, in turn; medians; times are of the process
on its core. Gmsh gets fewer places where it would take minutes; the sizes at common places are compared. Tables go into
docs/sizes/sources.md between their markers. Needs Debian's python3-numpy.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import machine, peers, script  # noqa: E402

PAGE = peers.ROOT / "docs" / "sizes" / "sources.md"
MAKER = "compare_sizes.py"
NUM_PLACES = 1_000_000
GMSH_WORK = 400_000  # sources times places


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", help="our program; default: the newest of build/*")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--sources", default="10,100,1000,10000,100000")
    parser.add_argument("--gmsh-limit", type=int, default=10_000, help="most sources that Gmsh is given")
    parser.add_argument("--no-gmsh", action="store_true", help="keep Gmsh's table as it is in docs/sizes/sources.md")
    parser.add_argument("--time-limit", type=float, default=300, help="seconds after which one run is stopped")
    parser.add_argument("--write-docs", action="store_true", help="write the tables into docs/sizes/sources.md")
    return parser.parse_args()


def along_a_curve(places: np.ndarray) -> np.ndarray:
    """In Morton order: neighbours in the list are near in space."""
    cell = np.minimum((places * 1024).astype(np.int64), 1023)
    key = np.zeros(len(places), np.int64)
    for bit in range(10):
        for axis in range(3):
            key |= ((cell[:, axis] >> bit) & 1) << (3 * bit + axis)
    return places[np.argsort(key, kind="stable")]


def run(command: list[str], time_limit: float) -> tuple[float, float] | str:
    """@return seconds to build and to evaluate, or why there are none"""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=time_limit, check=False)
    except subprocess.TimeoutExpired:
        return f"over {time_limit:g} s"
    if done.returncode != 0:
        return (done.stderr.strip().splitlines() or ["failed"])[-1][:80]
    build, evaluate = done.stdout.split()[-2:]
    return float(build), float(evaluate)


def median(runs: list) -> tuple[float, float] | str:
    failed = [r for r in runs if isinstance(r, str)]
    return failed[0] if failed else tuple(np.median(np.array(runs), axis=0))


def cell(result, num_places: int) -> str:
    return result if isinstance(result, str) else f"{result[1] / num_places * 1e6:.3g} µs"


def compare_with_gmsh(bench: str, options, folder: Path) -> str:
    random = np.random.default_rng(5)
    places = along_a_curve(random.random((NUM_PLACES, 3)))
    version = peers.pypi_version("gmsh")
    lines = [f"| point sources | delfront | Gmsh {version} | ratio | places given to Gmsh | largest difference |"]
    lines += ["| ---: | ---: | ---: | ---: | ---: | ---: |"]
    for n in [int(float(word)) for word in options.sources.split(",")]:
        delta0, r1 = 0.001 * 100 ** random.random(n), 0.05 * 20 ** random.random(n)
        np.savetxt(folder / "sources.txt", np.column_stack([random.random((n, 3)), delta0, r1]), fmt="%.17g")
        num_given = int(min(100_000, max(40, GMSH_WORK // n)))
        step = NUM_PLACES // num_given
        np.savetxt(folder / "all.txt", places, fmt="%.17g")
        np.savetxt(folder / "some.txt", places[::step][:num_given], fmt="%.17g")
        words = [str(folder / name) for name in ("sources.txt", "some.txt", "gmsh.txt")]
        script = str(peers.SOURCES / "gmsh_size_field.py")
        ours, theirs = [], []
        for _ in range(options.repeat):
            files = [str(folder / name) for name in ("sources.txt", "all.txt", "ours.txt")]
            ours.append(run([bench, "--given", *files], options.time_limit))
            if not version:
                theirs.append("not installed; scripts/setup --peers")
            elif n > options.gmsh_limit:
                theirs.append("not run")
            elif not theirs or not isinstance(theirs[-1], str):
                theirs.append(run([str(peers.VENV_PYTHON), script, *words], options.time_limit))
        us, them = median(ours), median(theirs)
        ratio = difference = given = ""
        if not isinstance(us, str) and not isinstance(them, str):
            ratio = f"{them[1] / num_given / (us[1] / NUM_PLACES):,.0f}"
            a, b = np.loadtxt(folder / "ours.txt")[::step][:num_given], np.loadtxt(folder / "gmsh.txt")
            difference, given = f"{np.max(np.abs(a / b - 1)):.1e}", str(num_given)
        lines.append(f"| {n} | {cell(us, NUM_PLACES)} | {cell(them, num_given)} | {ratio} | {given} | {difference} |")
        print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines)


def measure(bench: str, options, methods: str, layouts: str) -> dict[tuple[str, str], dict[str, tuple[float, ...]]]:
    """@return by layout and number of sources, then by method: seconds to build, million a second, megabytes"""
    command = [bench, "--sources", options.sources, "--repeat", str(options.repeat)]
    command += ["--methods", methods, "--layout", layouts]
    found: dict[tuple[str, str], dict[str, tuple[float, ...]]] = {}
    for line in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[1:]:
        layout, n, method, *numbers = line.split()
        found.setdefault((layout, n), {})[method] = tuple(float(x) for x in numbers[:3])
    return found


def compare_searches(bench: str, options) -> str:
    """Places after which lists have paid for their building: `from places`, nothing where they never do."""
    found = measure(bench, options, "scan,tree,lists", "scattered,curves,surfaces")
    head = "layout|sources|scan, µs|tree, µs|lists, µs|tree, million a second|tree against 10|build tree, s|lists, s"
    lines = [f"| {' | '.join([*head.split('|'), 'tree, MB', 'lists, MB', 'lists pay from places'])} |"]
    lines += ["| --- |" + " ---: |" * 11]
    for (layout, n), row in found.items():
        tree, lists, first = row["tree"], row["lists"], found.get((layout, "10"))
        growth = f"{first['tree'][1] / tree[1]:.1f}" if first else ""
        gain, price = 1 / tree[1] - 1 / lists[1], max(0.0, lists[0] - tree[0])
        pays = f"{price / gain * 1e6:.1g}" if gain > 0 else "never"
        times = [f"{1 / row[method][1]:.3g}" for method in ("scan", "tree", "lists")]
        rest = [f"{tree[1]:.2f}", growth, f"{tree[0]:.2f}", f"{lists[0]:.2f}", f"{tree[2]:.1f}", f"{lists[2]:.1f}", pays]
        lines.append(f"| {' | '.join([layout, n, *times, *rest])} |")
    return "\n".join(lines)


def compare_body(bench: str, options) -> str:
    found = measure(bench, options, "tree,lists,boundary", "body")
    lines = ["| triangles | tree, µs | lists, µs | sizes from as many boundary points, µs | build: tree, lists, points, s |"]
    lines += ["| ---: | ---: | ---: | ---: | ---: |"]
    for (_, n), row in found.items():
        three = [row[method] for method in ("tree", "lists", "boundary")]
        build = ", ".join(f"{seconds[0]:.3f}" for seconds in three)
        lines.append(f"| {n} | {' | '.join(f'{1 / r[1]:.3g}' for r in three)} | {build} |")
    return "\n".join(lines)


def main() -> int:
    options = parse()
    bench, why = peers.find_ours("size_field_bench", options.bench)
    if not bench:
        print(why, file=sys.stderr)
        return 1
    if options.no_gmsh:
        text = script.between(PAGE, MAKER)
        gmsh = text[text.index("| point sources |") :]
    else:
        with tempfile.TemporaryDirectory(prefix="delfront_sizes_") as folder:
            gmsh = compare_with_gmsh(bench, options, Path(folder))
    text = (
        f"{machine.describe()}; medians of {options.repeat}, one core, by `bench/compare_sizes.py --write-docs`.\n\n"
        f"Sources of all three laws (points, lines, triangles), a million places in Hilbert order:\n\n"
        f"{compare_searches(bench, options)}\n\n"
        f"The triangles of a sphere, all of one size that grows with the distance, as sizes on a patch are:\n\n"
        f"{compare_body(bench, options)}\n\n"
        f"Point sources with linear laws, beside Gmsh's `Min` of `Distance` and `Threshold`, time of one value:\n\n{gmsh}\n"
    )
    return script.publish(text, PAGE, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
