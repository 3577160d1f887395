# SPDX-License-Identifier: Apache-2.0
"""Refined grids of all cell types, in several formats, before the shared independent checker.

    test_refine.py DELFRONT

Exit 77 where the checker is not there ($DELFRONT_SHARED, else ../shared).
"""
import json
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
# A hexahedron, a pyramid on its top, a prism at its side and a tetrahedron on the prism's end.
VOLUME = 1 + 0.7 / 3 + 0.5 + 1 / 6
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0.5, 0.5, 1.7),
          (2, 0, 0.5), (2, 1, 0.5), (1.4, 2, 0.5)]
TET, HEX, PRISM, PYRAMID, TRIANGLE, QUAD = 4, 5, 6, 7, 2, 3  # of MSH
CELLS = [(HEX, (0, 1, 2, 3, 4, 5, 6, 7)), (PYRAMID, (4, 5, 6, 7, 8)), (PRISM, (1, 5, 9, 2, 6, 10)), (TET, (2, 6, 10, 11))]
SIDES = {HEX: ["0321", "4567", "0154", "1265", "2376", "3047"], PYRAMID: ["0321", "014", "124", "234", "304"],
         PRISM: ["021", "345", "0143", "1254", "2035"], TET: ["123", "032", "013", "021"]}


def boundary():
    alone = {}
    for kind, cell in CELLS:
        for side in SIDES[kind]:
            face = tuple(cell[int(k)] for k in side)
            if alone.pop(frozenset(face), None) is None:
                alone[frozenset(face)] = face
    return list(alone.values())


def write_msh(path):
    """MSH 2.2 as text: every cell type, two boundary groups."""
    rows = [(3, 1, kind, cell) for kind, cell in CELLS]
    rows += [(2, 2 + len(face) % 2, QUAD if len(face) == 4 else TRIANGLE, face) for face in boundary()]
    with open(path, "w", encoding="ascii") as file:
        file.write('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 "air"\n2 2 "quads"\n2 3 "triangles"\n')
        file.write(f"$EndPhysicalNames\n$Nodes\n{len(POINTS)}\n")
        file.writelines(f"{i + 1} {x} {y} {z}\n" for i, (x, y, z) in enumerate(POINTS))
        file.write(f"$EndNodes\n$Elements\n{len(rows)}\n")
        for i, (_, group, kind, cell) in enumerate(rows):
            file.write(f"{i + 1} {kind} 2 {group} {group} {' '.join(str(v + 1) for v in cell)}\n")
        file.write("$EndElements\n")


def check(grid, result):
    done = subprocess.run([sys.executable, os.path.join(HERE, "run_checker.py"), grid, "--json", result],
                          capture_output=True, text=True, check=False)
    if done.returncode == 77:
        print(done.stdout.strip())
        sys.exit(77)
    return done


def main():
    delfront, failed = os.path.abspath(sys.argv[1]), 0
    with tempfile.TemporaryDirectory() as folder:
        coarse, result = os.path.join(folder, "mixed.msh"), os.path.join(folder, "check.json")
        write_msh(coarse)
        for levels in (1, 3):
            for name in ("fine.vtu", "fine.msh", "fine.su2", "fine.mesh"):
                fine = os.path.join(folder, name)
                done = subprocess.run([delfront, "refine", coarse, "-o", fine, "--levels", str(levels)],
                                      capture_output=True, text=True, check=False)
                if done.returncode == 0:
                    done = check(fine, result)
                if done.returncode != 0:
                    print(f"{name}, {levels} levels FAILED: exit {done.returncode}\n{done.stdout}{done.stderr}")
                    failed += 1
                    continue
                with open(result, encoding="utf-8") as file:
                    facts = json.load(file)
                print(name, levels, facts["cells"], facts["volume"])
                failed += abs(facts["volume"] - VOLUME) > 1e-12
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
