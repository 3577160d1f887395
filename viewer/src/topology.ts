// SPDX-License-Identifier: Apache-2.0
// Which cells are neighbours, and the faces between cells that are kept and cells that are not. Plain arrays and no
// document, so that a worker can do it.
import { NONE, rangeOf, type Block, type CellType, type Grid } from "./grid";

/** Sides of a cell by its local vertices, outward; as in src/mesh/cell_shape.cpp. */
const FACES: Partial<Record<CellType, number[][]>> = {
  tetrahedron: [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]],
  pyramid: [[0, 3, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
  prism: [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
  hexahedron: [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
};

/** The sides of one cell, as points. */
export function facesOf(block: Block, index: number): number[][] {
  const [begin, end] = rangeOf(block, index);
  const faces: number[][] = [];
  if (block.type === "polyhedron") {
    for (let k = begin + 1; k < end; k += block.vertices[k]! + 1)
      faces.push([...block.vertices.subarray(k + 1, k + 1 + block.vertices[k]!)]);
    return faces;
  }
  if (block.dimension === 2) return [[...block.vertices.subarray(begin, end)]];
  for (const local of FACES[block.type] ?? []) faces.push(local.map((i) => block.vertices[begin + i]!));
  return faces;
}

/** Triangles to draw: four numbers each, three points and the face with three bits on top: which sides are edges. */
export class Triangles {
  data = new Uint32Array(4096);
  size = 0; // numbers used

  add(a: number, b: number, c: number, face: number, edges: number): void {
    if (this.size + 4 > this.data.length) {
      const larger = new Uint32Array(2 * this.data.length);
      larger.set(this.data);
      this.data = larger;
    }
    this.data[this.size++] = a;
    this.data[this.size++] = b;
    this.data[this.size++] = c;
    this.data[this.size++] = (face | (edges << 29)) >>> 0;
  }

  /** A face as a fan; of the edges only those of the face itself are drawn (1: ab, 2: bc, 4: ca). */
  addFace(corners: ArrayLike<number>, begin: number, end: number, face: number): void {
    for (let k = begin + 1; k + 1 < end; k++) {
      const edges = 2 | (k === begin + 1 ? 1 : 0) | (k + 2 === end ? 4 : 0);
      this.add(corners[begin]!, corners[k]!, corners[k + 1]!, face, edges);
    }
  }

  take(): Uint32Array {
    return this.data.slice(0, this.size);
  }
}

export interface Plane {
  normal: [number, number, number];
  offset: number; // cells with normal . centre <= offset are kept …
  isFlipped: boolean; // … or just all others
}

export interface CutResult {
  triangles: Uint32Array; // faces are entries of `cells`
  cells: Uint32Array; // of each face the cell it belongs to
  shown: Uint8Array; // one a stored face: whether it belongs to a kept cell
  numKept: number;
}

/** All sides of all volume cells one after the other, and what lies behind each. */
export class Topology {
  readonly numCells: number;
  readonly numFaces: number; // stored ones
  /** Two a stored face: the cells on its sides, NONE where there is none. */
  readonly owners: Uint32Array;
  private blocks: Block[];
  private faces: Block[];
  private centres: Float32Array; // of volume cells, or of faces where there are none
  private groups: Uint32Array;
  private firstSide: Uint32Array; // of each cell
  private corners: Uint32Array; // of all sides, then of the stored faces
  private firstCorner: Uint32Array; // of each side
  private behind: Uint32Array; // the cell behind each side
  private isStored: Uint8Array; // there is a stored face on the side

  constructor(grid: Grid) {
    this.blocks = grid.blocks.filter((b) => b.dimension === 3);
    this.faces = grid.blocks.filter((b) => b.dimension === 2);
    this.numCells = this.blocks.reduce((n, b) => n + b.num_cells, 0);
    this.numFaces = this.faces.reduce((n, b) => n + b.num_cells, 0);
    this.owners = new Uint32Array(2 * this.numFaces).fill(NONE);
    this.firstSide = new Uint32Array(this.numCells + 1);
    [this.corners, this.firstCorner] = this.collectSides();
    const numSides = this.firstSide[this.numCells]!;
    this.behind = new Uint32Array(numSides).fill(NONE);
    this.isStored = new Uint8Array(numSides);
    this.matchSides();
    this.groups = new Uint32Array(this.numCells);
    for (const b of this.blocks) this.groups.set(b.groups, b.first);
    this.centres = this.findCentres(grid.points);
  }

  private collectSides(): [Uint32Array, Uint32Array] {
    let numSides = 0, numCorners = 0;
    const eachSide = (visit: (cell: number, vertices: Uint32Array, at: number, local: number[] | null, n: number) => void) => {
      for (const block of this.blocks) {
        const table = FACES[block.type];
        for (let i = 0; i < block.num_cells; i++) {
          const [begin, end] = rangeOf(block, i);
          const cell = block.first + i;
          if (table) for (const local of table) visit(cell, block.vertices, begin, local, local.length);
          else
            for (let k = begin + 1; k < end; k += block.vertices[k]! + 1)
              visit(cell, block.vertices, k + 1, null, block.vertices[k]!);
        }
      }
    };
    eachSide((cell, _v, _at, _local, n) => {
      numSides++;
      numCorners += n;
      this.firstSide[cell + 1] = numSides;
    });
    for (const block of this.faces) numCorners += block.vertices.length;
    const corners = new Uint32Array(numCorners);
    const first = new Uint32Array(numSides + this.numFaces + 1);
    let side = 0, corner = 0;
    eachSide((_cell, vertices, at, local, n) => {
      for (let k = 0; k < n; k++) corners[corner++] = vertices[at + (local ? local[k]! : k)]!;
      first[++side] = corner;
    });
    for (const block of this.faces)
      for (let i = 0; i < block.num_cells; i++) {
        const [begin, end] = rangeOf(block, i);
        corners.set(block.vertices.subarray(begin, end), corner);
        first[++side] = corner += end - begin;
      }
    return [corners, first];
  }

  /** Sides and stored faces with the same points meet in the bin of their smallest one. */
  private matchSides(): void {
    const numSides = this.behind.length;
    const total = numSides + this.numFaces;
    const low = new Uint32Array(total), next = new Uint32Array(total), sum = new Float64Array(total);
    let largest = 0;
    for (let item = 0; item < total; item++) {
      let least = NONE, second = NONE, all = 0;
      for (let k = this.firstCorner[item]!; k < this.firstCorner[item + 1]!; k++) {
        const v = this.corners[k]!;
        all += v;
        if (v < least) {
          second = least;
          least = v;
        } else if (v < second) second = v;
        if (v > largest) largest = v;
      }
      low[item] = least;
      next[item] = second;
      sum[item] = all;
    }
    const start = new Uint32Array(largest + 2);
    for (let i = 0; i < total; i++) start[low[i]! + 1]!++;
    for (let v = 0; v <= largest; v++) start[v + 1]! += start[v]!;
    const place = start.slice(0, largest + 1);
    const sorted = new Uint32Array(total);
    for (let i = 0; i < total; i++) sorted[place[low[i]!]!++] = i;
    const cellOf = new Uint32Array(numSides);
    for (let c = 0; c < this.numCells; c++) cellOf.fill(c, this.firstSide[c]!, this.firstSide[c + 1]!);
    for (let v = 0; v <= largest; v++)
      for (let i = start[v]!; i < start[v + 1]!; i++) {
        const a = sorted[i]!;
        for (let j = i + 1; j < start[v + 1]!; j++) {
          const b = sorted[j]!;
          if (next[a] === next[b] && sum[a] === sum[b] && this.isSame(a, b)) this.join(a, b, numSides, cellOf);
        }
      }
  }

  /** The same points, in any order. */
  private isSame(a: number, b: number): boolean {
    const [beginA, endA, beginB, endB] = [this.firstCorner[a]!, this.firstCorner[a + 1]!, this.firstCorner[b]!, this.firstCorner[b + 1]!];
    if (endA - beginA !== endB - beginB) return false;
    for (let i = beginA; i < endA; i++) {
      let k = beginB;
      while (k < endB && this.corners[k] !== this.corners[i]) k++;
      if (k === endB) return false;
    }
    return true;
  }

  private join(a: number, b: number, numSides: number, cellOf: Uint32Array): void {
    if (a >= numSides) return; // two stored faces
    if (b < numSides) {
      this.behind[a] = cellOf[b]!;
      this.behind[b] = cellOf[a]!;
      return;
    }
    const face = b - numSides;
    this.isStored[a] = 1;
    this.owners[2 * face + (this.owners[2 * face] === NONE ? 0 : 1)] = cellOf[a]!;
  }

  private findCentres(points: Float32Array): Float32Array {
    const isVolume = this.numCells > 0;
    const centres = new Float32Array(3 * (isVolume ? this.numCells : this.numFaces));
    const mean = (vertices: Uint32Array, begin: number, end: number, to: number) => {
      for (let k = 0; k < 3; k++) {
        let all = 0;
        for (let i = begin; i < end; i++) all += points[3 * vertices[i]! + k]!;
        centres[3 * to + k] = all / (end - begin);
      }
    };
    if (isVolume)
      for (let c = 0; c < this.numCells; c++)
        mean(this.corners, this.firstCorner[this.firstSide[c]!]!, this.firstCorner[this.firstSide[c + 1]!]!, c);
    else
      for (const block of this.faces)
        for (let i = 0; i < block.num_cells; i++) {
          const [begin, end] = rangeOf(block, i);
          mean(block.vertices, begin, end, block.first + i);
        }
    return centres;
  }

  centreOf(cell: number): [number, number, number] {
    return [this.centres[3 * cell]!, this.centres[3 * cell + 1]!, this.centres[3 * cell + 2]!];
  }

  private isBehind(plane: Plane | null, cell: number): boolean {
    if (!plane) return true;
    const [x, y, z] = plane.normal, c = this.centres;
    return x * c[3 * cell]! + y * c[3 * cell + 1]! + z * c[3 * cell + 2]! <= plane.offset !== plane.isFlipped;
  }

  /** Whole cells behind the plane, without those of hidden regions. */
  cut(plane: Plane | null, hidden: ReadonlySet<number>): CutResult {
    if (this.numCells === 0) {
      const shown = new Uint8Array(this.numFaces);
      for (let f = 0; f < this.numFaces; f++) shown[f] = this.isBehind(plane, f) ? 1 : 0;
      return { triangles: new Uint32Array(0), cells: new Uint32Array(0), shown, numKept: shown.reduce((n, s) => n + s, 0) };
    }
    const kept = new Uint8Array(this.numCells);
    for (let c = 0; c < this.numCells; c++)
      kept[c] = this.isBehind(plane, c) && !hidden.has(this.groups[c]!) ? 1 : 0;
    return this.borderOf(kept, false);
  }

  /** The faces round the cells of a set. @param all  also those that are stored faces */
  borderOf(kept: Uint8Array, all: boolean): CutResult {
    const triangles = new Triangles();
    const cells: number[] = [];
    const shown = new Uint8Array(this.numFaces);
    let numKept = 0;
    for (let c = 0; c < this.numCells; c++) {
      if (!kept[c]) continue;
      numKept++;
      for (let s = this.firstSide[c]!; s < this.firstSide[c + 1]!; s++) {
        const other = this.behind[s]!;
        if ((other !== NONE && kept[other]) || (this.isStored[s] && !all)) continue;
        triangles.addFace(this.corners, this.firstCorner[s]!, this.firstCorner[s + 1]!, cells.length);
        cells.push(c);
      }
    }
    for (let f = 0; f < this.numFaces; f++) {
      const a = this.owners[2 * f]!, b = this.owners[2 * f + 1]!;
      shown[f] = a === NONE || kept[a] || (b !== NONE && kept[b]) ? 1 : 0;
    }
    return { triangles: triangles.take(), cells: Uint32Array.from(cells), shown, numKept };
  }
}
