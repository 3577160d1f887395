# SPDX-License-Identifier: Apache-2.0
"""STEP files of boxes in a lattice, written without a CAD kernel: instances of one product, or each a solid of its own."""

from __future__ import annotations

from itertools import product
from pathlib import Path

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('boxes','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""


class Step:
    """Entities in the order they are added."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def add(self, text: str) -> str:
        self.lines.append(f"#{len(self.lines) + 1}={text};\n")
        return f"#{len(self.lines)}"

    def point(self, p: tuple[float, ...]) -> str:
        return self.add(f"CARTESIAN_POINT('',({','.join(f'{x:.15G}' if '.' in f'{x:.15G}' else f'{x:.15G}.' for x in p)}))")

    def direction(self, d: tuple[float, ...]) -> str:
        return self.add(f"DIRECTION('',({','.join(f'{float(x)}' for x in d)}))")

    def placement(self, at: tuple[float, ...], z: tuple[float, ...] = (0, 0, 1), x: tuple[float, ...] = (1, 0, 0)) -> str:
        return self.add(f"AXIS2_PLACEMENT_3D('',{self.point(at)},{self.direction(z)},{self.direction(x)})")


def add_box(step: Step, at: tuple[float, float, float], name: str) -> str:
    """A cube of side 1; its eight corners by their bits."""
    place = [tuple(at[k] + (c >> k & 1) for k in range(3)) for c in range(8)]
    corners = [step.add(f"VERTEX_POINT('',{step.point(p)})") for p in place]
    edges = {}
    for a in range(8):
        for k in range(3):
            if a >> k & 1:
                continue
            along = tuple(float(i == k) for i in range(3))
            vector = step.add(f"VECTOR('',{step.direction(along)},1.)")
            line = step.add(f"LINE('',{step.point(place[a])},{vector})")
            edges[a, a | 1 << k] = step.add(f"EDGE_CURVE('',{corners[a]},{corners[a | 1 << k]},{line},.T.)")
    faces = []
    for k, side in product(range(3), range(2)):
        u, v = 1 << (k + 1) % 3, 1 << (k + 2) % 3
        base = side << k
        ring = [base, base | u, base | u | v, base | v] if side else [base, base | v, base | u | v, base | u]
        uses = []
        for a, b in zip(ring, ring[1:] + ring[:1]):
            uses.append(step.add(f"ORIENTED_EDGE('',*,*,{edges[min(a, b), max(a, b)]},{'.T.' if a < b else '.F.'})"))
        bound = step.add(f"FACE_OUTER_BOUND('',{step.add(f'EDGE_LOOP({chr(39)}{chr(39)},({chr(44).join(uses)}))')},.T.)")
        normal = tuple((2 * side - 1) * float(i == k) for i in range(3))
        x = tuple(float(i == (k + 1) % 3) for i in range(3))
        plane = step.add(f"PLANE('',{step.placement(place[base], normal, x)})")
        faces.append(step.add(f"ADVANCED_FACE('',({bound}),{plane},.T.)"))
    shell = step.add(f"CLOSED_SHELL('',({','.join(faces)}))")
    return step.add(f"MANIFOLD_SOLID_BREP('{name}',{shell})")


class Products:
    """What products need beside their shapes."""

    def __init__(self, step: Step) -> None:
        self.step = step
        add = step.add
        application = add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')")
        add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})")
        self.product_context = add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
        self.definition_context = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
        length = add("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))")
        angle = add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))")
        solid = add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())")
        within = add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length},'distance_accuracy_value','')")
        self.context = add(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((" + within + ")) "
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid})) REPRESENTATION_CONTEXT('',''))")

    def define(self, name: str, kind: str, items: list[str]) -> tuple[str, str]:
        """A product and its shape: their definition and representation."""
        add = self.step.add
        part = add(f"PRODUCT('{name}','{name}','',({self.product_context}))")
        formation = add(f"PRODUCT_DEFINITION_FORMATION('','',{part})")
        definition = add(f"PRODUCT_DEFINITION('design','',{formation},{self.definition_context})")
        shape = add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        made = add(f"{kind}('',({','.join(items)}),{self.context})")
        add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{made})")
        return definition, made


def lattice(count: int, gap: float) -> list[tuple[float, float, float]]:
    side = round(count ** (1 / 3))
    side += side**3 < count
    return [tuple((1 + gap) * x for x in (i % side, i // side % side, i // side // side)) for i in range(count)]


def write_step(path: Path, step: Step) -> None:
    with path.open("w", encoding="ascii") as out:
        out.write(HEAD)
        out.writelines(step.lines)
        out.write("ENDSEC;\nEND-ISO-10303-21;\n")


def write_assembly(path: Path, products: list[tuple[str, list[tuple[float, float, float]]]]) -> None:
    """Boxes of side 1: each product by its name, and the places of its instances."""
    step = Step()
    made = Products(step)
    origin = step.placement((0, 0, 0))
    parts = []
    for name, _ in products:
        box = add_box(step, (0, 0, 0), name)
        parts.append(made.define(name, "ADVANCED_BREP_SHAPE_REPRESENTATION", [origin, box]))
    places = [[step.placement(at) for at in where] for _, where in products]
    items = [origin, *(place for where in places for place in where)]
    whole, whole_shape = made.define("wall", "SHAPE_REPRESENTATION", items)
    for (part, part_shape), where in zip(parts, places):
        for place in where:
            use = step.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{len(step.lines)}','','',{whole},{part},$)")
            shape = step.add(f"PRODUCT_DEFINITION_SHAPE('Placement','',{use})")
            move = step.add(f"ITEM_DEFINED_TRANSFORMATION('','',{origin},{place})")
            relation = step.add(
                f"(REPRESENTATION_RELATIONSHIP('','',{part_shape},{whole_shape}) "
                f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({move}) SHAPE_REPRESENTATION_RELATIONSHIP())")
            step.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{shape})")
    write_step(path, step)


def write_boxes(path: Path, count: int, gap: float = 0, instances: bool = True) -> None:
    """The first `count` boxes of a cubic lattice, rows along x first; side 1, `gap` apart."""
    if instances:
        return write_assembly(path, [("brick", lattice(count, gap))])
    step = Step()
    products = Products(step)
    solids = [add_box(step, at, f"box{i + 1}") for i, at in enumerate(lattice(count, gap))]
    products.define("boxes", "ADVANCED_BREP_SHAPE_REPRESENTATION", [step.placement((0, 0, 0)), *solids])
    return write_step(path, step)
