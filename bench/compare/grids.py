# SPDX-License-Identifier: Apache-2.0
"""Reading what a tool wrote, and its quality by one routine for all. Large files are read in parts."""

import re
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
    """Count, volume, worst dihedral angles, share below 10 degrees, mean eta. Orientation as the tool left it."""
    volume_sum = eta_sum = 0.0
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
        below += int((smallest < 10).sum())
    count = max(len(tets), 1)
    return {
        "tets": len(tets),
        "volume": volume_sum,
        "min_dihedral": low,
        "max_dihedral": high,
        "below_10": below / count,
        "eta": eta_sum / count,
    }


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
