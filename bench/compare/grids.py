# SPDX-License-Identifier: Apache-2.0
"""Reading what a tool wrote, and its quality by one routine for all. Large files are read in parts."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

PART_BYTES = 1 << 26
PART_CELLS = 250_000


def read_numbers(file, count: int) -> np.ndarray:
    """The next `count` numbers of an open binary file of text; leaves the file somewhere behind them."""
    values = np.empty(count)
    done, rest = 0, b""
    while done < count:
        part = file.read(PART_BYTES)
        text = rest + part
        cut = len(text) if not part else text.rfind(b"\n") + 1
        text, rest = text[:cut], text[cut:]
        word = re.search(rb"[A-Za-z]{2}|#", text)  # the next section
        found = np.fromstring(text[: word.start()] if word else text, sep=" ")[: count - done]
        values[done : done + len(found)] = found
        done += len(found)
        if not part:
            break
    if done < count:
        raise ValueError(f"{file.name}: ends after {done} of {count} numbers")
    return values


def find_sections(path: Path, names: set[bytes]) -> dict[bytes, tuple[int, int]]:
    """Place behind the count, and the count, of each wanted section of a medit file."""
    sections, offset, overlap = {}, 0, b""
    pattern = re.compile(rb"(?:^|\n)\s*(" + b"|".join(names) + rb")\s+(\d+)\s")
    with path.open("rb") as file:
        while part := file.read(PART_BYTES):
            text = overlap + part
            for match in pattern.finditer(text):
                sections[match[1]] = (offset - len(overlap) + match.end(), int(match[2]))
            offset += len(part)
            overlap = text[-200:]
    return sections


def read_medit(path: Path, cells: bytes, nodes: int, dimension: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, dimension) and cells (m, nodes) from 0. `cells`: b"Tetrahedra" or b"Triangles"."""
    sections = find_sections(path, {b"Vertices", cells})
    with path.open("rb") as file:

        def table(name: bytes, width: int) -> np.ndarray:
            place, count = sections.get(name, (0, 0))
            file.seek(place)
            return read_numbers(file, count * width).reshape(count, width)

        points = table(b"Vertices", dimension + 1)[:, :dimension].copy()
        return points, (table(cells, nodes + 1)[:, :nodes] - 1).astype(np.int32)


def read_tetgen(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """NAME.ele and NAME.node."""

    def table(name: Path) -> np.ndarray:
        with name.open("rb") as file:
            head = file.readline().split()
            start = file.tell()
            width = len(file.readline().split())
            file.seek(start)
            return read_numbers(file, int(head[0]) * width).reshape(-1, width)

    nodes = table(path.with_suffix(".node"))
    return nodes[:, 1:4].copy(), (table(path)[:, 1:5] - int(nodes[0, 0])).astype(np.int32)


def measure_tets(points: np.ndarray, tets: np.ndarray) -> dict:
    """Count, volume, worst dihedral angles, mean of each tet's smallest, share of those below 10 degrees, mean eta.

    Orientation as the tool left it.
    """
    volume_sum = eta_sum = smallest_sum = 0.0
    below, low, high = 0, 180.0, 0.0
    faces = [(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)]
    for first in range(0, len(tets), PART_CELLS):
        p = points[tets[first : first + PART_CELLS]]
        normals = np.stack([np.cross(p[:, f[1]] - p[:, f[0]], p[:, f[2]] - p[:, f[0]]) for f in faces], axis=1)
        volume = np.abs(np.einsum("ij,ij->i", normals[:, 3], p[:, 0] - p[:, 3])) / 6
        with np.errstate(invalid="ignore", divide="ignore"):
            normals /= np.linalg.norm(normals, axis=2, keepdims=True)
        cosines = [-np.einsum("ij,ij->i", normals[:, i], normals[:, j]) for i in range(4) for j in range(i)]
        angles = np.degrees(np.arccos(np.clip(np.nan_to_num(np.stack(cosines, axis=1), nan=1.0), -1, 1)))
        squares = sum(np.einsum("ij,ij->i", p[:, i] - p[:, j], p[:, i] - p[:, j]) for i in range(4) for j in range(i))
        smallest = angles.min(axis=1)
        low, high = min(low, float(smallest.min())), max(high, float(angles.max()))
        volume_sum += float(volume.sum())
        eta_sum += float((12 * np.cbrt(3 * volume) ** 2 / squares).sum())
        smallest_sum += float(smallest.sum())
        below += int((smallest < 10).sum())
    count = max(len(tets), 1)
    return {
        "tets": len(tets),
        "volume": volume_sum,
        "min_dihedral": low,
        "max_dihedral": high,
        "mean_min_dihedral": smallest_sum / count,
        "below_10": below / count,
        "eta": eta_sum / count,
    }


def read_vtu(path: Path) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Points, tets and fields of points of a VTU of ours: one piece, appended raw data, not compressed."""
    data = path.read_bytes()
    start = data.index(b"_", data.index(b"<AppendedData")) + 1
    head = data[:start].decode("ascii", "replace")
    kinds = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1"}

    def arrays(section: str) -> dict[str, np.ndarray]:
        found = {}
        for tag in re.findall(r"<DataArray [^>]*>", re.search(rf"<{section}>(.*?)</{section}>", head, re.S)[1]):
            words = dict(re.findall(r'(\w+)="([^"]*)"', tag))
            place, kind = start + int(words["offset"]), np.dtype(kinds[words["type"]])
            size = int(np.frombuffer(data, "<u8", 1, place)[0])
            found[words["Name"]] = np.frombuffer(data, kind, size // kind.itemsize, place + 8)
        return found

    cells = arrays("Cells")
    first = cells["offsets"][cells["types"] == 10] - 4
    tets = cells["connectivity"][first[:, None] + np.arange(4)].astype(np.int32)
    return arrays("Points")["Points"].reshape(-1, 3), tets, arrays("PointData") if "<PointData>" in head else {}


def sample_edges(tets: np.ndarray, most: int = 400_000) -> np.ndarray:
    """About `most` edges at the most, each edge of the grid with the same chance and always the same: shape (n, 2)."""
    share = min(1.0, most / max(1.2 * len(tets), 1))
    kept = []
    for first in range(0, len(tets), PART_CELLS):
        for i, j in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]:
            ends = np.sort(tets[first : first + PART_CELLS][:, [i, j]], axis=1).astype(np.uint64)
            key = (ends[:, 0] << np.uint64(32)) | ends[:, 1]
            mixed = (key * np.uint64(0x9E3779B97F4A7C15)) ^ (key >> np.uint64(29))
            mixed = (mixed * np.uint64(0xBF58476D1CE4E5B9)) >> np.uint64(32)
            kept.append(key[mixed < np.uint64(share * 2**32)])
    keys = np.unique(np.concatenate(kept))
    return np.stack([keys >> np.uint64(32), keys & np.uint64(0xFFFFFFFF)], axis=1).astype(np.int64)


def edges_near(points: np.ndarray, tets: np.ndarray, size: Callable[[np.ndarray], np.ndarray]) -> dict:
    """Of length / size: the share of edges with it within [0.8, 1.25], its mean, and the share within that range of it.

    The size is asked at the middles of edges.
    """
    edges = sample_edges(tets)
    ends = points[edges]
    ratio = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / size(ends.mean(axis=1))
    mean = float(ratio.mean())
    near, alike = (((r >= 0.8) & (r <= 1.25)).mean() for r in (ratio, ratio / mean))
    return {"edges_near": float(near), "edges_alike": float(alike), "edge_ratio": mean}


def triangle_angles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Degrees, shape (triangles, 3)."""
    p = points[triangles]
    to_next, to_last = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    lengths = np.linalg.norm(to_next, axis=2) * np.linalg.norm(to_last, axis=2)
    return np.degrees(np.arccos(np.clip((to_next * to_last).sum(axis=2) / lengths, -1, 1)))


def measure_triangles(points: np.ndarray, triangles: np.ndarray) -> dict:
    a, b, c = (points[triangles[:, i], :2] for i in range(3))
    area = float(np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum() / 2)
    return {
        "triangles": len(triangles),
        "area": area,
        "min_angle": float(triangle_angles(points[:, :2], triangles).min()),
    }
