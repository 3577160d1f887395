#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fill a unit sphere's given surface with delfront, TetGen and Gmsh in one run and compare.

    bench/compare_peers.py --delfront build/release/delfront -n 3 [--write-docs]

Surfaces: geodesic spheres of 8,820 / 42,320 / 121,680 triangles (about 1e5, 1e6 and 5e6 tetrahedra), the same
coordinates to 17 digits for every tool. Each tool is a separate process; all outputs are read by one routine, and their
volume must be that of the surface. Times are medians over the repeats, smallest and largest in brackets. "phase": the
gridding time that the tool itself prints (delfront: tetrahedralize, recover, refine, improve); "whole": wall time of
the process, reading and writing text included; "RSS": peak memory of the process. eta = 12 (3V)^(2/3) / sum of squared
edges. Tools that are missing are listed as not installed. Needs numpy.
"""

import argparse
import json
import os
import platform
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

FREQUENCIES = (21, 46, 78)
TETGEN_VOLUMES = {21: 9.5e-5, 46: 9.04e-6, 78: 1.855e-6}  # of tets with edges as long as the surface's
BEGIN, END = "<!-- begin: made by bench/compare_peers.py -->", "<!-- end -->"


# --- the surface ------------------------------------------------------------------------------------------------------


def geodesic_sphere(frequency: int) -> tuple[np.ndarray, np.ndarray]:
    """Icosahedron with each face cut into frequency^2 triangles, on the unit sphere: points and triangles."""
    golden = (1 + 5**0.5) / 2
    corners = np.array(
        [[-1, golden, 0], [1, golden, 0], [-1, -golden, 0], [1, -golden, 0], [0, -1, golden], [0, 1, golden]]
        + [[0, -1, -golden], [0, 1, -golden], [golden, 0, -1], [golden, 0, 1], [-golden, 0, -1], [-golden, 0, 1]]
    )
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)]
    faces += [(7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)]
    faces += [(8, 6, 7), (9, 8, 1)]
    ids: dict[tuple, int] = {}
    points: list[np.ndarray] = []
    triangles = []

    def vertex(face: tuple, weights: tuple) -> int:
        key = tuple(sorted((corner, weight) for corner, weight in zip(face, weights) if weight))
        if key not in ids:
            ids[key] = len(points)
            place = sum(weight * corners[corner] for corner, weight in key)
            points.append(place / np.linalg.norm(place))
        return ids[key]

    for face in faces:
        for i in range(frequency):
            for j in range(frequency - i):
                k = frequency - i - j
                a, b, c = (vertex(face, w) for w in ((k, i, j), (k - 1, i + 1, j), (k - 1, i, j + 1)))
                triangles.append((a, b, c))
                if k > 1:
                    triangles.append((b, vertex(face, (k - 2, i + 1, j + 1)), c))
    return np.array(points), np.array(triangles)


def enclosed_volume(points: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", np.cross(a, b), c).sum() / 6)


def write_surfaces(folder: Path, points: np.ndarray, triangles: np.ndarray) -> None:
    """The same surface as OFF (delfront), .smesh (TetGen) and medit .mesh with a .geo (Gmsh)."""
    place = ["%.17g %.17g %.17g" % tuple(p) for p in points]
    facet = ["%d %d %d" % tuple(t) for t in triangles]
    facet1 = ["%d %d %d" % tuple(t + 1) for t in triangles]
    n, m = len(place), len(facet)
    (folder / "s.off").write_text("\n".join([f"OFF\n{n} {m} 0", *place, *("3 " + f for f in facet)]) + "\n")
    nodes = [f"{i} {p}" for i, p in enumerate(place)]
    (folder / "s.smesh").write_text(
        "\n".join([f"{n} 3 0 0", *nodes, f"{m} 0", *("3 " + f for f in facet), "0", "0"]) + "\n"
    )
    medit = [f"MeshVersionFormatted 2\nDimension\n3\nVertices\n{n}", *(p + " 1" for p in place)]
    medit += [f"Triangles\n{m}", *(f + " 1" for f in facet1), "End"]
    (folder / "s.mesh").write_text("\n".join(medit) + "\n")
    (folder / "fill.geo").write_text(
        'Merge "s.mesh";\nSurface Loop(1) = {1};\nVolume(1) = {1};\nMesh.MeshSizeExtendFromBoundary = 1;\n'
    )


# --- the tools --------------------------------------------------------------------------------------------------------


@dataclass
class Tool:
    name: str
    program: str | None
    version: str
    threads: int
    command: list[str]  # {program} and {volume} are filled in
    output: str
    phase: object  # (log, folder) -> seconds or None


def phase_of_delfront(log: str, folder: Path) -> float | None:
    report = folder / "report.json"
    if not report.exists():
        return None
    stages = json.loads(report.read_text()).get("stages", [])
    names = {"tetrahedralize", "recover", "refine", "improve"}
    return sum(stage["seconds"] for stage in stages if stage["stage"] in names) or None


def phase_of_tetgen(log: str, folder: Path) -> float | None:
    found = re.findall(r"^\s*([A-Za-z ]+) seconds:\s*([\d.eE+-]+)", log, re.M)
    times = {name.strip(): float(value) for name, value in found}
    total = times.get("Total running")
    return None if total is None else total - times.get("Output", 0.0)


def phase_of_gmsh(log: str, folder: Path) -> float | None:
    found = re.findall(r"Done (?:meshing 3D|optimizing mesh).*?\(Wall ([\d.eE+-]+)s", log)
    return sum(map(float, found)) if found else None


def first_line_with_digits(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    lines = [line for line in (done.stdout + "\n" + done.stderr).splitlines() if re.search(r"\d\.\d", line)]
    found = re.search(r"\d+\.\d+(\.\d+)?\S*", lines[0]) if lines else None
    return found.group(0) if found else "unknown"


def find_tools(arguments: argparse.Namespace) -> list[Tool]:
    """delfront; TetGen and Gmsh from the PATH; further Gmshs (PyPI's) by --gmsh, or where `import gmsh` finds one."""
    ours = arguments.delfront or shutil.which("delfront")
    tools = []
    for threads in arguments.threads:
        command = ["{program}", "mesh", "s.off", "-o", "o.mesh", "--ascii", "--report", "report.json", "-q"]
        version = first_line_with_digits([ours, "--version"]) if ours else ""
        command += ["-j", str(threads)]
        tools.append(Tool("delfront", ours, version, threads, command, "o.mesh", phase_of_delfront))
    tetgen = shutil.which("tetgen")
    version = first_line_with_digits(["dpkg-query", "-W", "tetgen"]) if tetgen else ""
    tools.append(
        Tool("TetGen", tetgen, version, 1, ["{program}", "-pYq1.414a{volume}V", "s.smesh"], "s.1.ele", phase_of_tetgen)
    )
    for program in find_gmshs(arguments):
        version = first_line_with_digits([*words_of(program), "--version"]) if program else ""
        for algorithm, label, all_threads in (("del3d", "Gmsh Delaunay", (1,)), ("hxt", "Gmsh HXT", arguments.threads)):
            for threads in all_threads:
                command = ["{program}", "-3", "fill.geo", "-algo", algorithm, "-nt", str(threads)]
                command += ["-o", "o.mesh", "-format", "mesh"]
                tools.append(Tool(label, program, version, threads, command, "o.mesh", phase_of_gmsh))
    wanted = arguments.tools
    return [tool for tool in tools if not wanted or any(w.lower() in tool.name.lower() for w in wanted)]


def words_of(program: str) -> list[str]:
    """The program, or a Python script (PyPI's gmsh) with the interpreter that it was installed for."""
    with open(program, "rb") as file:
        is_script = b"python" in file.readline()
    python = Path(program).parent / "python3"
    return [str(python), program] if is_script and python.exists() else [program]


def find_gmshs(arguments: argparse.Namespace) -> list[str | None]:
    programs = list(arguments.gmsh)
    try:
        import gmsh

        programs += [str(path) for path in Path(gmsh.__file__).parents[3].glob("bin/gmsh")]
    except (ImportError, OSError):
        pass
    on_path = shutil.which("gmsh")
    if on_path:
        programs.insert(0, on_path)
    return list(dict.fromkeys(programs)) or [None]


# --- one run ----------------------------------------------------------------------------------------------------------


@dataclass
class Run:
    whole: float
    phase: float | None
    rss: float  # bytes
    rss_floor: float  # our own memory at the start: Linux counts it as the child's until that has more
    status: str  # "" or why there is no result


def run_once(tool: Tool, command: list[str], folder: Path, limit: float) -> Run:
    for old in [folder / tool.output, folder / "report.json"]:
        old.unlink(missing_ok=True)
    log = folder / "log.txt"
    floor = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    with log.open("w") as sink:
        start = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, stdout=sink, stderr=subprocess.STDOUT)
        timer = threading.Timer(limit, process.kill)
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        whole = time.perf_counter() - start
        was_killed = not timer.is_alive()
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)  # reaped above
    reason = ""
    if was_killed:
        reason = f"stopped after {limit:.0f} s"
    elif process.returncode != 0 or not (folder / tool.output).exists():
        tail = log.read_text(errors="replace").strip().splitlines()[-1:] or [""]
        reason = f"failed (status {process.returncode}): {tail[0][:90]}"
    phase = None if reason else tool.phase(log.read_text(errors="replace"), folder)
    return Run(whole, phase, usage.ru_maxrss * 1024, floor, reason)


# --- reading and measuring the output ---------------------------------------------------------------------------------


def numbers(text: str, count: int) -> np.ndarray:
    return np.fromstring(text, dtype=float, count=count, sep=" ")


def read_medit(path: Path) -> tuple[np.ndarray, np.ndarray]:
    text = path.read_text()

    def section(name: str, width: int) -> np.ndarray:
        found = re.search(rf"^\s*{name}\s+(\d+)\s", text, re.M)
        if not found:
            return np.zeros((0, width))
        count = int(found.group(1))
        return numbers(text[found.end() :], count * width).reshape(count, width)

    return section("Vertices", 4)[:, :3], section("Tetrahedra", 5)[:, :4].astype(np.int64) - 1


def read_tetgen(path: Path) -> tuple[np.ndarray, np.ndarray]:
    def table(file: Path) -> np.ndarray:
        head, body = file.read_text().split("\n", 1)
        body = body.split("\n#", 1)[0]
        rows = int(head.split()[0])
        return numbers(body, -1).reshape(rows, -1)

    nodes, cells = table(path.with_suffix(".node")), table(path)
    return nodes[:, 1:4], cells[:, 1:5].astype(np.int64) - int(nodes[0, 0])


@dataclass
class Quality:
    tets: int = 0
    volume: float = 0.0
    min_dihedral: float = 0.0
    max_dihedral: float = 0.0
    below_10: float = 0.0  # share of tets whose smallest dihedral angle is under 10 degrees
    mean_eta: float = 0.0


def measure(points: np.ndarray, tets: np.ndarray) -> Quality:
    """One routine for every tool; in parts of 250,000 tets. Orientation is taken as the tool left it."""
    sums = {"volume": 0.0, "eta": 0.0, "below": 0}
    low, high = 180.0, 0.0
    faces = [(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)]
    for first in range(0, len(tets), 250_000):
        p = points[tets[first : first + 250_000]]
        normals = np.stack([np.cross(p[:, f[1]] - p[:, f[0]], p[:, f[2]] - p[:, f[0]]) for f in faces], axis=1)
        volume = np.abs(np.einsum("ij,ij->i", normals[:, 3], p[:, 0] - p[:, 3])) / 6
        with np.errstate(invalid="ignore", divide="ignore"):
            normals /= np.linalg.norm(normals, axis=2, keepdims=True)
        cosines = [-np.einsum("ij,ij->i", normals[:, i], normals[:, j]) for i in range(4) for j in range(i)]
        angles = np.degrees(np.arccos(np.clip(np.nan_to_num(np.stack(cosines, axis=1), nan=1.0), -1, 1)))
        squares = sum(np.einsum("ij,ij->i", p[:, i] - p[:, j], p[:, i] - p[:, j]) for i in range(4) for j in range(i))
        smallest = angles.min(axis=1)
        low, high = min(low, float(smallest.min())), max(high, float(angles.max()))
        sums["volume"] += float(volume.sum())
        sums["eta"] += float((12 * np.cbrt(3 * volume) ** 2 / squares).sum())
        sums["below"] += int((smallest < 10).sum())
    count = max(len(tets), 1)
    return Quality(len(tets), sums["volume"], low, high, sums["below"] / count, sums["eta"] / count)


# --- the table --------------------------------------------------------------------------------------------------------


@dataclass
class Row:
    tool: Tool
    command: str
    runs: list[Run] = field(default_factory=list)
    quality: Quality = field(default_factory=Quality)
    status: str = ""


def compare(tool: Tool, folder: Path, frequency: int, volume: float, arguments: argparse.Namespace) -> Row:
    fill_in = {"program": tool.program or "", "volume": f"{TETGEN_VOLUMES.get(frequency, volume / 10):g}"}
    command = [part.format(**fill_in) for part in tool.command]
    row = Row(tool, " ".join([Path(command[0]).name or tool.name.split()[0].lower(), *command[1:]]))
    if not tool.program:
        row.status = "not installed"
        return row
    command = words_of(command[0]) + command[1:]
    for _ in range(arguments.repeats):
        run = run_once(tool, command, folder, arguments.limit)
        if run.status:
            row.status = run.status
            return row
        row.runs.append(run)
    output = folder / tool.output
    row.quality = measure(*(read_medit(output) if output.suffix == ".mesh" else read_tetgen(output)))
    if not abs(row.quality.volume - volume) <= 1e-9 * volume:
        row.status = f"wrong volume {row.quality.volume:.12g}, the surface encloses {volume:.12g}"
    return row


def spread(values: list[float]) -> str:
    middle = statistics.median(values)
    return f"{middle:.2f}" if len(values) == 1 else f"{middle:.2f} ({min(values):.2f}-{max(values):.2f})"


def line_of(row: Row) -> str:
    start = f"| {row.tool.name} | {row.tool.version} | {row.tool.threads} |"
    if row.status:
        return f"{start} {row.status} |" + " |" * 9
    q = row.quality
    whole = statistics.median(run.whole for run in row.runs)
    phases = [run.phase for run in row.runs if run.phase is not None]
    rss = statistics.median(run.rss for run in row.runs)
    is_known = all(run.rss > 1.02 * run.rss_floor for run in row.runs)
    per_phase = f"{q.tets / statistics.median(phases) / 1e3:.0f} k" if phases else "-"
    cells = [f"{q.tets:,}", spread(phases) if phases else "-", per_phase, spread([run.whole for run in row.runs])]
    cells += [f"{q.tets / whole / 1e3:.0f} k", f"{'' if is_known else '≤ '}{rss / 2**20:.0f}"]
    cells.append(f"{rss / q.tets:.0f}" if is_known else "–")
    cells += [f"{q.min_dihedral:.2f}", f"{100 * q.below_10:.3f} %", f"{q.mean_eta:.3f}"]
    return f"{start} " + " | ".join(cells) + " |"


def machine() -> str:
    model, memory = platform.processor() or platform.machine(), 0
    try:
        model = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text()).group(1)
        memory = int(re.search(r"MemTotal:\s*(\d+)", Path("/proc/meminfo").read_text()).group(1)) / 2**20
    except (OSError, AttributeError):
        pass
    load = os.getloadavg()[0]
    system = f"{platform.system()} {platform.release()}"
    return f"{model}, {os.cpu_count()} cores, {memory:.0f} GiB, {system}; load at the start {load:.1f}"


def report_of(arguments: argparse.Namespace) -> str:
    lines = [f"Machine: {machine()}. Repeats: {arguments.repeats}.", ""]
    commands: dict[str, str] = {}
    for frequency in arguments.frequencies:
        points, triangles = geodesic_sphere(frequency)
        volume = enclosed_volume(points, triangles)
        lines += [f"### {len(triangles):,} triangles", ""]
        head = "tool | version | threads | tets | phase s | tets/s phase | whole s | tets/s whole | RSS MiB | bytes/tet"
        head += " | min dihedral | below 10° | mean eta"
        lines += [f"| {head} |", "|" + "---|" * (head.count("|") + 1)]
        with tempfile.TemporaryDirectory() as name:
            write_surfaces(Path(name), points, triangles)
            for tool in find_tools(arguments):
                row = compare(tool, Path(name), frequency, volume, arguments)
                commands.setdefault(f"{tool.name}, {tool.threads} thread{'s' if tool.threads > 1 else ''}", row.command)
                lines.append(line_of(row))
                print(lines[-1], file=sys.stderr, flush=True)
        lines.append("")
    lines += ["Commands (of the first surface):", ""]
    lines += [f"- {name}: `{command}`" for name, command in commands.items()]
    return "\n".join(lines) + "\n"


def write_docs(path: Path, report: str) -> None:
    """Put the report between the markers of the page, or at its end; the rest stays."""
    text = path.read_text() if path.exists() else "# Performance\n"
    explanation = __doc__.split("\n\n", 2)[2].strip()
    section = f"{BEGIN}\n## Filling a unit sphere, beside the peers\n\n{explanation}\n\n{report}{END}"
    if BEGIN in text and END in text:
        before, rest = text.split(BEGIN, 1)
        text = before + section + rest.split(END, 1)[1]
    else:
        text = text.rstrip() + "\n\n" + section + "\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def main() -> int:
    root = Path(__file__).resolve().parents[1]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", help="our program; default: from the PATH")
    parser.add_argument("--gmsh", action="append", default=[], help="a further Gmsh program, e.g. PyPI's; may repeat")
    parser.add_argument("-n", "--repeats", type=int, default=3)
    parser.add_argument("--frequencies", type=int, nargs="+", default=list(FREQUENCIES), help="20 f^2 triangles each")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, os.cpu_count() or 1])
    parser.add_argument("--tools", nargs="+", help="only tools whose name contains one of these")
    parser.add_argument("--limit", type=float, default=600, help="seconds after which a run is stopped")
    parser.add_argument("--write-docs", action="store_true", help="also write the section of docs/performance.md")
    arguments = parser.parse_args()
    arguments.threads = sorted(set(arguments.threads))
    arguments.gmsh = [str(Path(program).absolute()) for program in arguments.gmsh]
    if arguments.delfront:
        arguments.delfront = str(Path(arguments.delfront).absolute())
    report = report_of(arguments)
    print(report)
    if arguments.write_docs:
        write_docs(root / "docs" / "performance.md", report)
    return 0


if __name__ == "__main__":
    sys.exit(main())
