// SPDX-License-Identifier: Apache-2.0
// The grid in the scene: layers of faces, what is visible, how it is coloured, which cells are selected.
import * as THREE from "three";
import { binOf, columnsOf, NUM_BINS, type Column } from "./colouring";
import { Cutter } from "./cutter";
import { CutPlane } from "./cutplane";
import { FaceLayer, Look, Paint, PointTexture } from "./faces";
import { blockOf, cornersOf, NONE, numCells, rangeOf, type Grid } from "./grid";
import { linesOf, markersOf, outline, pointsOf } from "./lines";
import { CELL_TYPES, groupColour, SELECTED, type Colour } from "./palette";
import type { Stage } from "./stage";
import { facesOf, Triangles, type CutResult } from "./topology";

const SURFACE = 1, CUT = 2, SELECTION = 3;
const GHOST = 0.1;

/** What a list of the panel shows one line of. */
export interface Entry {
  group: number; // NONE: cells without one
  name: string;
  kind: string;
  dimension: number;
  count: number;
  colour: Colour;
  isVisible: boolean;
  part: number; // of the surface layer; -1 for regions and lines
}

export interface Picked {
  cell: number; // of the highest dimension; NONE where a face has none
  at: THREE.Vector3 | null; // where it was clicked
  face: number | null; // a stored face
}

export class View {
  readonly columns: Column[];
  readonly entries: Entry[] = [];
  readonly plane: CutPlane;
  readonly markers: THREE.Group[];
  column: Column | null = null; // null: by name, or by type
  byType = false;
  bins = new Set<number>(); // that are selected
  numKept: number;
  numSelected = 0;
  onCut: () => void = () => {};
  private top: number;
  private look = new Look();
  private points: PointTexture;
  private surface: FaceLayer;
  private cutLayer: FaceLayer;
  private selection: FaceLayer;
  private cutter = new Cutter();
  private owners: Uint32Array = new Uint32Array(0);
  private cutCells: Uint32Array = new Uint32Array(0);
  private selectionCells: Uint32Array = new Uint32Array(0);
  private lines = new Map<Entry, THREE.Object3D>();
  private picked: THREE.Object3D | null = null;
  private root = new THREE.Group();

  constructor(readonly grid: Grid, readonly stage: Stage, canvas: HTMLCanvasElement) {
    this.top = grid.top_dimension;
    this.columns = columnsOf(grid);
    this.numKept = numCells(grid, this.top);
    this.points = new PointTexture(grid.points);
    const make = (layer: number) => new FaceLayer(this.points, this.look, layer);
    [this.surface, this.cutLayer, this.selection] = [make(SURFACE), make(CUT), make(SELECTION)];
    const c = grid.centre, b = grid.box;
    const low = new THREE.Vector3(b[0] - c[0], b[1] - c[1], b[2] - c[2]);
    const high = new THREE.Vector3(b[3] - c[0], b[4] - c[1], b[5] - c[2]);
    stage.sphere.set(low.clone().add(high).multiplyScalar(0.5), Math.max(low.distanceTo(high) / 2, 1e-30));
    stage.isPlane = grid.dimension === 2;
    this.look.flat.value = stage.isPlane ? 1 : 0;
    this.plane = new CutPlane(stage, low, high, canvas);
    if (stage.isPlane) this.plane.normal.set(1, 0, 0);
    this.plane.onMove = () => void this.cut();
    for (const layer of [this.surface, this.cutLayer, this.selection]) {
      this.root.add(layer.group);
      stage.pickScene.add(layer.pickGroup);
    }
    stage.scene.add(this.root);
    this.markers = grid.findings.map(markersOf);
    for (const marker of this.markers) this.root.add(marker);
    this.buildSurface();
    this.buildLines();
    this.hideOuter();
    this.paint();
  }

  /** Find neighbours, then show what lies open. */
  async begin(): Promise<void> {
    this.owners = await this.cutter.begin(this.grid);
    await this.cut();
    this.paint();
  }

  dispose(): void {
    for (const layer of [this.surface, this.cutLayer, this.selection]) {
      layer.dispose();
      this.stage.pickScene.remove(layer.pickGroup);
    }
    this.stage.scene.remove(this.root);
    document.getElementById("knob")?.remove();
  }

  private nameOf(group: number): string {
    return this.grid.groups[group]?.name ?? "(no name)";
  }

  /** Triangles by group, each group a part; a list entry for each, and one for each region. */
  private buildSurface(): void {
    const counts = new Map<number, number>(), regions = new Map<number, number>();
    for (const block of this.grid.blocks) {
      const into = block.dimension === 2 ? counts : block.dimension === 3 ? regions : null;
      if (into) for (const g of block.groups) into.set(g, (into.get(g) ?? 0) + 1);
    }
    const triangles = new Triangles();
    const ranges: [number, number][] = [];
    for (const group of [...counts.keys()].sort((a, b) => a - b)) {
      const first = triangles.size / 4;
      for (const block of this.grid.blocks.filter((b) => b.dimension === 2))
        for (let i = 0; i < block.num_cells; i++)
          if (block.groups[i] === group) triangles.addFace(block.vertices, ...rangeOf(block, i), block.first + i);
      this.addEntry(group, 2, counts.get(group)!, ranges.length);
      ranges.push([first, triangles.size / 4 - first]);
    }
    for (const group of [...regions.keys()].sort((a, b) => a - b)) this.addEntry(group, 3, regions.get(group)!, -1);
    this.surface.setTriangles(triangles.take(), numCells(this.grid, 2), ranges);
    for (const e of this.entries) if (e.part >= 0) this.surface.setColour(e.part, e.colour);
  }

  private addEntry(group: number, dimension: number, n: number, part: number): Entry {
    const colour = dimension === 3 ? groupColour(group === NONE ? 9 : group + 4) : groupColour(this.entries.length);
    const entry = { group, name: this.nameOf(group), kind: this.grid.groups[group]?.kind ?? "", dimension, count: n, colour, isVisible: true, part };
    this.entries.push(entry);
    return entry;
  }

  private buildLines(): void {
    const counts = [new Map<number, number>(), new Map<number, number>()];
    for (const block of this.grid.blocks)
      if (block.dimension < 2)
        for (const g of block.groups) counts[block.dimension]!.set(g, (counts[block.dimension]!.get(g) ?? 0) + 1);
    for (const dimension of [1, 0])
      for (const [group, n] of counts[dimension]!) {
        const colour = groupColour(this.entries.length).map((c) => 0.55 * c) as Colour;
        const object = dimension === 1 ? linesOf(this.grid, group, colour) : pointsOf(this.grid, group, colour);
        if (!object) continue;
        const entry = this.addEntry(group, dimension, n, -1);
        entry.colour = colour;
        object.renderOrder = 1;
        this.lines.set(entry, object);
        this.root.add(object);
      }
  }

  private boxOf(entries: Entry[]): THREE.Box3 {
    const box = new THREE.Box3(), p = new THREE.Vector3(), groups = new Set(entries.map((e) => e.group));
    for (const block of this.grid.blocks.filter((b) => b.dimension === 2))
      for (let i = 0; i < block.num_cells; i++) {
        if (!groups.has(block.groups[i]!)) continue;
        const [begin, end] = rangeOf(block, i);
        for (let k = begin; k < end; k++) box.expandByPoint(p.fromArray(this.grid.points, 3 * block.vertices[k]!));
      }
    return box;
  }

  /** Far fields and walls of tunnels stand in front of the body: hidden at first where what is inside is much smaller. */
  private hideOuter(): void {
    const faces = this.entries.filter((e) => e.part >= 0);
    if (this.top !== 3 || faces.length < 2) return;
    const radius = this.stage.sphere.radius, all = this.boxOf(faces), slack = 1e-4 * radius;
    const inner = faces.filter((e) => {
      const box = this.boxOf([e]);
      const isWhole = box.min.distanceTo(all.min) < slack && box.max.distanceTo(all.max) < slack;
      const isSide = (["x", "y", "z"] as const).some((k) => box.max[k] - box.min[k] < slack &&
        (Math.abs(box.min[k] - all.min[k]) < slack || Math.abs(box.max[k] - all.max[k]) < slack));
      return !isWhole && !isSide && e.kind !== "farfield";
    });
    if (inner.length === 0 || this.boxOf(inner).getSize(new THREE.Vector3()).length() > radius) return;
    for (const e of faces) if (!inner.includes(e)) this.setVisible(e, false);
  }

  setVisible(entry: Entry, isVisible: boolean): void {
    entry.isVisible = isVisible;
    if (entry.part >= 0) this.surface.setVisible(entry.part, isVisible);
    const object = this.lines.get(entry);
    if (object) object.visible = isVisible;
    if (entry.dimension === 3) void this.cut();
    this.stage.draw();
  }

  setColour(entry: Entry, colour: Colour): void {
    entry.colour = colour;
    if (entry.part >= 0) this.surface.setColour(entry.part, colour);
    const material = (this.lines.get(entry) as THREE.LineSegments | undefined)?.material as THREE.LineBasicMaterial | undefined;
    material?.color.setRGB(...colour, THREE.LinearSRGBColorSpace);
    this.paint();
  }

  /** By a column, by cell type, or (null) by name. */
  colourBy(column: Column | null, byType = false): void {
    this.column = column;
    this.byType = byType;
    if (column?.ofPoints) this.points.setValues(column.ofPoints);
    this.paint();
  }

  paint(): void {
    const column = this.column;
    const regions = this.entries.filter((e) => e.dimension === 3);
    const types = Object.keys(CELL_TYPES);
    if (column) {
      this.look.setMap(column.map);
      this.look.range.set(column.low, column.high);
    } else {
      const colours = this.byType ? Object.values(CELL_TYPES) : regions.map((e) => e.colour);
      this.look.setColours(colours);
      this.look.range.set(0, Math.max(1, colours.length));
    }
    const paint = column?.ofPoints ? Paint.points : Paint.faces;
    const typeNumber = this.numberOf((block) => types.indexOf(block.type) + 0.5);
    const regionNumber = this.numberOf((block, i) => regions.findIndex((e) => e.group === block.groups[i]) + 0.5);
    const ofCell = (cell: number) => column ? column.ofCells?.[cell] ?? NaN : this.byType ? typeNumber(cell) : regionNumber(cell);
    const isByName = !column && !this.byType;
    this.surface.setPaint(isByName ? Paint.constant : paint, isByName ? null : this.surfaceValues(ofCell));
    this.cutLayer.setPaint(paint, Array.from(this.cutCells, ofCell));
    this.selection.setPaint(paint, Array.from(this.selectionCells, ofCell));
    this.stage.draw();
  }

  private numberOf(of: (block: Grid["blocks"][0], index: number) => number): (cell: number) => number {
    let block = this.grid.blocks[0]!;
    return (cell) => {
      if (block.dimension !== this.top || cell < block.first || cell >= block.first + block.num_cells)
        block = blockOf(this.grid, this.top, cell);
      return of(block, cell - block.first);
    };
  }

  private surfaceValues(ofCell: (cell: number) => number): Float32Array {
    const values = new Float32Array(this.surface.numFaces).fill(NaN);
    for (const block of this.grid.blocks.filter((b) => b.dimension === 2)) {
      const own = this.column?.ofFaces?.get(block);
      for (let i = 0; i < block.num_cells; i++) {
        const face = block.first + i, cell = this.ownerOf(face);
        values[face] = own ? own[i]! : cell === NONE ? NaN : ofCell(cell);
      }
    }
    return values;
  }

  /** The cell a stored face belongs to: of two the one that is shown. */
  private ownerOf(face: number): number {
    return this.top === 2 ? face : this.owners[2 * face] ?? NONE;
  }

  async cut(): Promise<void> {
    const regions = this.entries.filter((e) => e.dimension === 3 && !e.isVisible);
    const result = await this.cutter.cut(this.plane.plane(), new Set(regions.map((e) => e.group)));
    if (!result) return;
    this.numKept = result.numKept;
    this.cutCells = result.cells;
    this.showFaces(this.cutLayer, result);
    this.surface.setStates(result.shown);
    this.paint();
    this.onCut();
  }

  private showFaces(layer: FaceLayer, result: CutResult): void {
    layer.setTriangles(result.triangles, result.cells.length, result.cells.length ? [[0, result.triangles.length / 4]] : []);
    this.setGhosts();
  }

  private setGhosts(): void {
    const hasSelection = this.numSelected > 0;
    for (const layer of [this.surface, this.cutLayer]) layer.setAlpha(hasSelection ? GHOST : 1);
  }

  /** Bars of the histogram. */
  async selectBins(bins: Set<number>): Promise<void> {
    this.bins = bins;
    const values = this.column?.ofCells;
    const kept = new Uint8Array(numCells(this.grid, this.top));
    if (values && bins.size)
      for (let c = 0; c < kept.length; c++) kept[c] = bins.has(binOf(this.column!, values[c]!)) ? 1 : 0;
    await this.select(kept);
  }

  /** Show these cells whole, all else as a ghost. */
  async select(kept: Uint8Array): Promise<void> {
    const n = kept.reduce((sum, k) => sum + k, 0);
    const result = this.top === 3 && n ? await this.cutter.border(kept) : this.facesOfSet(kept, n);
    this.numSelected = n;
    this.selectionCells = result.cells;
    this.showFaces(this.selection, result);
    this.paint();
    this.onCut();
  }

  private facesOfSet(kept: Uint8Array, n: number): CutResult {
    const triangles = new Triangles(), cells: number[] = [];
    for (const block of n && this.top === 2 ? this.grid.blocks.filter((b) => b.dimension === 2) : [])
      for (let i = 0; i < block.num_cells; i++)
        if (kept[block.first + i]) {
          triangles.addFace(block.vertices, ...rangeOf(block, i), cells.length);
          cells.push(block.first + i);
        }
    return { triangles: triangles.take(), cells: Uint32Array.from(cells), shown: new Uint8Array(0), numKept: n };
  }

  selectWithin(low: number, high: number): Promise<void> {
    const column = this.column!;
    const bins = new Set<number>();
    for (let b = binOf(column, low); b <= binOf(column, high) && b < NUM_BINS; b++) bins.add(b);
    return this.selectBins(bins);
  }

  centreOf(cell: number): { centre: THREE.Vector3; radius: number } {
    const block = blockOf(this.grid, this.top, cell);
    const box = new THREE.Box3(), p = new THREE.Vector3();
    for (const v of cornersOf(block, cell - block.first)) box.expandByPoint(p.fromArray(this.grid.points, 3 * v));
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    return { centre: sphere.center, radius: sphere.radius };
  }

  /** Edges of a cell in bright colour, over all else; NONE: none. */
  mark(cell: number): void {
    if (this.picked) this.root.remove(this.picked);
    this.picked = null;
    if (cell !== NONE) {
      const block = blockOf(this.grid, this.top, cell);
      this.picked = outline(this.grid, facesOf(block, cell - block.first), SELECTED);
      this.root.add(this.picked);
    }
    this.stage.draw();
  }

  pickAt(x: number, y: number): Picked | null {
    const hit = this.stage.pick(x, y);
    if (!hit) return null;
    const layer = [this.surface, this.cutLayer, this.selection][hit.layer - 1]!;
    const at = this.pointOn(layer, hit.face, this.stage.ray(x + 0.5, y + 0.5)); // the middle of the pixel
    if (hit.layer === SURFACE) return { cell: this.ownerOf(hit.face), at, face: hit.face };
    return { cell: (hit.layer === CUT ? this.cutCells : this.selectionCells)[hit.face]!, at, face: null };
  }

  private pointOn(layer: FaceLayer, face: number, ray: THREE.Ray): THREE.Vector3 | null {
    const corner = (v: number) => new THREE.Vector3().fromArray(this.grid.points, 3 * v);
    const t = layer.triangles;
    let beside: THREE.Vector3 | null = null; // the pixel may be seen of a face, but its middle miss it
    for (let k = 0; k < t.length; k += 4) {
      if ((t[k + 3]! & 0x1fffffff) !== face) continue;
      const [a, b, c] = [corner(t[k]!), corner(t[k + 1]!), corner(t[k + 2]!)];
      const at = ray.intersectTriangle(a, b, c, false, new THREE.Vector3());
      if (at) return at;
      beside ??= ray.intersectPlane(new THREE.Plane().setFromCoplanarPoints(a, b, c), new THREE.Vector3());
    }
    return beside;
  }

  setWireframe(isOn: boolean): void {
    this.look.edges.value = isOn ? 1 : 0;
    this.stage.draw();
  }

  /** What is visible now, for fit. */
  visibleBox(): THREE.Sphere {
    const shown = this.entries.filter((e) => e.part >= 0 && e.isVisible);
    const box = this.boxOf(shown);
    if (box.isEmpty()) return this.stage.sphere.clone();
    return box.getBoundingSphere(new THREE.Sphere());
  }
}
