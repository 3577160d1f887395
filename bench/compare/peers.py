# SPDX-License-Identifier: Apache-2.0
"""Which tools there are: Debian's, those of a Python environment of our own, and drivers built on request.

Everything lies in one folder, $DELFRONT_PEERS or build/peers: `venv` (PyPI's gmsh and triangle), `geogram` (the
sources in PyPI's source archive of geogram) and the built drivers. `scripts/setup --peers` fills it.
"""

import glob
import os
import re
import shutil
import subprocess
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "bench" / "peers"
FOLDER = Path(os.environ.get("DELFRONT_PEERS", ROOT / "build" / "peers")).absolute()
VENV_PYTHON = FOLDER / "venv" / "bin" / "python3"
SETUP = "scripts/setup --peers"
# As ours is built; the filters of CGAL and geogram want the rounding mode respected and no contraction.
EXACT_FLAGS = ["-O3", "-DNDEBUG", "-frounding-math", "-ffp-contract=off", "-w"]
GEOGRAM_SOURCES = """basic/counted basic/string basic/algorithm basic/environment basic/command_line
  basic/command_line_args basic/line_stream basic/logger basic/file_system basic/packed_arrays basic/progress
  basic/process basic/process_unix basic/factory basic/assert basic/stopwatch basic/numeric basic/boolean_expression
  basic/common mesh/mesh_reorder numerics/multi_precision numerics/PCK numerics/predicates numerics/expansion_nt
  numerics/exact_geometry delaunay/delaunay delaunay/delaunay_2d delaunay/delaunay_3d delaunay/parallel_delaunay_3d
  delaunay/periodic delaunay/periodic_delaunay_3d voronoi/convex_cell points/nn_search points/kd_tree""".split()


class NotBuilt(Exception):
    """Says why in one line."""


def output_of(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout + done.stderr


def first_version(text: str) -> str:
    found = re.search(r"\d+\.\d+(\.\d+)?", text)
    return found.group(0) if found else "unknown"


def debian_version(package: str) -> str:
    return first_version(output_of(["dpkg-query", "-W", "-f", "${Version}", package]))


def pypi_version(package: str) -> str:
    """Of the package in our environment, "" where it is not there."""
    code = f"import importlib.metadata as m; print(m.version('{package}'))"
    return output_of([str(VENV_PYTHON), "-c", code]).strip() if has_pypi(package) else ""


def has_pypi(package: str) -> bool:
    return VENV_PYTHON.exists() and any(
        glob.glob(str(FOLDER / f"venv/lib/python3*/site-packages/{package}-*.dist-info"))
    )


def cpu_flags() -> list[str]:
    try:
        flags = Path("/proc/cpuinfo").read_text().split("flags", 1)[1].split("\n", 1)[0].split()
    except (OSError, IndexError):
        flags = []
    return ["-march=x86-64-v3"] if {"avx2", "fma", "bmi2"} <= set(flags) else []


def compile_to(target: Path, inputs: list[Path], words: list[str]) -> Path:
    """With ccache where there is one; nothing is done where the target is newer than the inputs."""
    if target.exists() and all(target.stat().st_mtime >= source.stat().st_mtime for source in inputs):
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    compiler = [*filter(None, [shutil.which("ccache")]), os.environ.get("CXX", "g++")]
    done = subprocess.run([*compiler, *words, "-o", str(target)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        errors = [line for line in done.stderr.splitlines() if "error" in line or "undefined" in line]
        raise NotBuilt(f"{target.name} does not compile: {(errors or ['unknown'])[0][:160]}")
    return target


def build_launcher() -> Path:
    source = SOURCES / "run_measured.cpp"
    return compile_to(FOLDER / "run_measured", [source], ["-std=c++20", "-O2", str(source)])


def build_cgal() -> Path:
    source = SOURCES / "cgal_delaunay.cpp"
    if not Path("/usr/include/CGAL/Delaunay_triangulation_3.h").exists() or not Path("/usr/include/tbb").exists():
        raise NotBuilt(f"libcgal-dev and libtbb-dev; {SETUP}")
    words = ["-std=c++17", *EXACT_FLAGS, *cpu_flags(), "-DCGAL_LINKED_WITH_TBB", "-DCGAL_HAS_THREADS", str(source)]
    return compile_to(
        FOLDER / "cgal_delaunay", [source], [*words, "-ltbb", "-ltbbmalloc", "-lgmp", "-lmpfr", "-pthread"]
    )


def geogram_archive() -> Path | None:
    archives = sorted(FOLDER.glob("geogram/geogram-*.tar.gz"))
    return archives[-1] if archives else None


def geogram_version() -> str:
    archive = geogram_archive()
    return f"PyPI {first_version(archive.name)}" if archive else ""


def build_geogram() -> Path:
    source, target = SOURCES / "geogram_delaunay.cpp", FOLDER / "geogram_delaunay"
    archive = geogram_archive()
    if not archive:
        raise NotBuilt(f"geogram's source archive from PyPI; {SETUP}")
    if target.exists() and target.stat().st_mtime >= max(source.stat().st_mtime, archive.stat().st_mtime):
        return target
    tree = FOLDER / "geogram" / archive.name.removesuffix(".tar.gz")
    library = tree / "src/extern/geogram/src/lib"
    if not library.exists():
        with tarfile.open(archive) as file:
            file.extractall(FOLDER / "geogram")
    generated = FOLDER / "geogram" / "generated"
    (generated / "geogram").mkdir(parents=True, exist_ok=True)
    version = (library / "geogram/basic/version.h.in").read_text()
    (generated / "geogram/version.h").write_text(re.sub(r"@\w+@", "0", version))
    words = ["-std=c++17", *EXACT_FLAGS, *cpu_flags(), "-DGEOGRAM_PSM", "-DGEOGRAM_WITH_PDEL", "-include", "functional"]
    words += [f"-I{library}", f"-I{generated}"]
    objects = []
    for name in GEOGRAM_SOURCES:
        unit = library / "geogram" / f"{name}.cpp"
        objects.append(compile_to(generated / f"{unit.stem}.o", [unit], [*words, "-c", str(unit)]))
    links = [*map(str, objects), "-pthread", "-ldl"]
    return compile_to(target, [source, *objects], [*words, str(source), *links])


def build_all(say) -> None:
    """What can be built is; the rest is named."""
    for build in (build_launcher, build_cgal, build_geogram):
        try:
            say(f"built {build().name}")
        except NotBuilt as reason:
            say(f"not installed: {reason}")


def built(build) -> tuple[str, str]:
    """@return (program, why it is missing)"""
    try:
        return str(build()), ""
    except NotBuilt as reason:
        return "", str(reason)


def find_ours(name: str, given: str | None) -> tuple[str, str]:
    """An executable of ours: as given, else of the newest build folder, else from the PATH."""
    if given:
        return (str(Path(given).absolute()), "") if Path(given).exists() else ("", f"{given} does not exist")
    found = [*ROOT.glob(f"build/*/{name}"), *ROOT.glob(f"build/*/bench/{name}")]
    if found:
        return str(max(found, key=lambda path: path.stat().st_mtime)), ""
    program = shutil.which(name)
    return (
        (program, "") if program else ("", f"build it: cmake --preset bench && cmake --build --preset bench ({name})")
    )


def find_gmshs() -> list[tuple[str, list[str], str, str]]:
    """(label, words, version, why missing) of PyPI's and of Debian's Gmsh."""
    script = FOLDER / "venv" / "bin" / "gmsh"
    version = pypi_version("gmsh")
    pypi = ("PyPI", [str(VENV_PYTHON), str(script)], version, "" if version else f"PyPI gmsh; {SETUP}")
    program = shutil.which("gmsh") or ""
    debian = ("Debian", [program], debian_version("gmsh") if program else "", "" if program else f"gmsh; {SETUP}")
    return [pypi, debian]


def find_tetgen() -> tuple[str, str, str]:
    program = shutil.which("tetgen") or ""
    return program, debian_version("tetgen") if program else "", "" if program else f"tetgen; {SETUP}"
