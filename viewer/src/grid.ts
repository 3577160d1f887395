// SPDX-License-Identifier: Apache-2.0
// The grid as the library sends it (docs/viewer.md): header and arrays of one block of bytes.

export const NONE = 0xffffffff;

export type CellType =
  | "vertex" | "line" | "triangle" | "quad" | "tetrahedron" | "pyramid" | "prism" | "hexahedron" | "polygon" | "polyhedron";

export interface Group {
  name: string;
  dimension: number;
  kind: string;
  two_sided: boolean;
}

export interface Block {
  type: CellType;
  dimension: number;
  num_cells: number;
  vertices: Uint32Array;
  groups: Uint32Array;
  offsets?: Uint32Array; // of polygons and polyhedra
  first: number; // number of its first cell among those of its dimension
}

/** One value a cell of the highest dimension. */
export interface Measure {
  name: string;
  unit: string;
  is_quality: boolean;
  worst_is_low: boolean;
  range: [number, number];
  values: Float32Array;
}

export interface Field {
  name: string;
  on: "vertices" | "cells";
  block: CellType;
  components: number;
  values: Float32Array;
}

export interface Finding {
  kind: string;
  severity: string;
  count: number;
  message: string;
  remedy: string;
  places: Float32Array;
  ids: Uint32Array;
  outlines: Float32Array;
  offsets: Uint32Array;
}

export interface Grid {
  name: string;
  version: string;
  is_grid: boolean;
  dimension: number;
  top_dimension: number;
  centre: [number, number, number];
  box: [number, number, number, number, number, number];
  points: Float32Array; // relative to the centre
  groups: Group[];
  blocks: Block[];
  measures: Measure[];
  fields: Field[];
  findings: Finding[];
}

interface Placed {
  type: "f4" | "u4";
  filter: "none" | "planes" | "differences";
  offset: number;
  length: number;
}

function readArray(bytes: ArrayBuffer, begin: number, at: Placed): Float32Array | Uint32Array {
  const place = begin + at.offset;
  if (place + 4 * at.length > bytes.byteLength) throw new Error("the data of the grid are cut off");
  if (at.filter === "none")
    return at.type === "f4" ? new Float32Array(bytes, place, at.length) : new Uint32Array(bytes, place, at.length);
  const planes = new Uint8Array(bytes, place, 4 * at.length);
  const n = at.length;
  const words = new Uint32Array(n);
  for (let i = 0; i < n; i++)
    words[i] = planes[i]! | (planes[n + i]! << 8) | (planes[2 * n + i]! << 16) | (planes[3 * n + i]! << 24);
  if (at.filter === "differences") {
    let before = 0;
    for (let i = 0; i < n; i++) {
      const word = words[i]!;
      before = (before + ((word >>> 1) ^ -(word & 1))) | 0;
      words[i] = before;
    }
  }
  return at.type === "f4" ? new Float32Array(words.buffer) : words;
}

/** Arrays stand in the header as their places; this puts the arrays themselves there. */
function resolve(value: unknown, bytes: ArrayBuffer, begin: number): unknown {
  if (Array.isArray(value)) return value.map((v) => resolve(v, bytes, begin));
  if (value === null || typeof value !== "object") return value;
  if ("filter" in value) return readArray(bytes, begin, value as Placed);
  return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, resolve(v, bytes, begin)]));
}

export function parseGrid(bytes: ArrayBuffer): Grid {
  const magic = new TextDecoder().decode(new Uint8Array(bytes, 0, Math.min(7, bytes.byteLength)));
  if (magic !== "DFVIEW1") throw new Error("the data are no grid of this program's version");
  const size = new DataView(bytes).getUint32(8, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 16, size)));
  const grid = resolve(header, bytes, 16 + size) as Grid;
  const firsts = [0, 0, 0, 0];
  for (const block of grid.blocks) {
    block.first = firsts[block.dimension]!;
    firsts[block.dimension]! += block.num_cells;
  }
  return grid;
}

export function numCells(grid: Grid, dimension: number): number {
  return grid.blocks.reduce((n, b) => n + (b.dimension === dimension ? b.num_cells : 0), 0);
}

export function blockOf(grid: Grid, dimension: number, cell: number): Block {
  const found = grid.blocks.find((b) => b.dimension === dimension && cell >= b.first && cell < b.first + b.num_cells);
  if (!found) throw new Error(`there is no cell ${cell}`);
  return found;
}

const CORNERS: Partial<Record<CellType, number>> = {
  vertex: 1, line: 2, triangle: 3, quad: 4, tetrahedron: 4, pyramid: 5, prism: 6, hexahedron: 8,
};

/** The entries of a cell in block.vertices: [begin, end). */
export function rangeOf(block: Block, index: number): [number, number] {
  if (block.offsets) return [block.offsets[index]!, block.offsets[index + 1]!];
  const n = CORNERS[block.type]!;
  return [n * index, n * (index + 1)];
}

/** The points of a cell, each once, in the order of the file. */
export function cornersOf(block: Block, index: number): number[] {
  const [begin, end] = rangeOf(block, index);
  if (block.type !== "polyhedron") return [...block.vertices.subarray(begin, end)];
  const found = new Set<number>();
  for (let k = begin + 1; k < end; k += block.vertices[k]! + 1)
    for (let i = 1; i <= block.vertices[k]!; i++) found.add(block.vertices[k + i]!);
  return [...found];
}
