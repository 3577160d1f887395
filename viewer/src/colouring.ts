// SPDX-License-Identifier: Apache-2.0
// What cells can be coloured by, as one list of columns: measures, fields; and their bins.
import { blockOf, NONE, numCells, type Block, type Grid } from "./grid";
import type { MapName } from "./palette";

export interface Column {
  key: string;
  title: string;
  unit: string;
  map: MapName;
  isLog: boolean;
  low: number; // of the legend; on its scale
  high: number;
  worstIsLow: boolean | null; // null: no quality
  ofCells: Float32Array | null; // one a cell of the highest dimension, on the scale
  ofPoints: Float32Array | null;
  ofFaces: Map<Block, Float32Array> | null; // fields of stored faces of a grid in space
}

const TITLES: Record<string, string> = {
  min_dihedral: "smallest dihedral angle", max_dihedral: "largest dihedral angle", min_angle: "smallest angle",
  max_angle: "largest angle", mean_ratio: "mean ratio", aspect_ratio: "aspect ratio", max_nonortho: "non-orthogonality",
  skewness: "skewness", volume_ratio: "volume ratio of neighbours", volume: "volume", area: "area", size: "size (mean edge)",
};

function extent(values: Float32Array): [number, number] {
  let low = Infinity, high = -Infinity;
  for (const v of values)
    if (Number.isFinite(v)) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
  return low <= high ? [low, high] : [0, 1];
}

function finish(column: Omit<Column, "low" | "high" | "isLog">, range: [number, number] | null, mayBeLog: boolean): Column {
  const arrays = [column.ofCells, column.ofPoints, ...(column.ofFaces?.values() ?? [])].filter((a) => a !== null) as Float32Array[];
  let low = Infinity, high = -Infinity;
  for (const a of arrays) {
    const [l, h] = extent(a);
    low = Math.min(low, l);
    high = Math.max(high, h);
  }
  const isLog = mayBeLog && low > 0 && high / low > 30;
  if (isLog) {
    const logs = (a: Float32Array | null) => a && a.map((v) => Math.log10(v));
    column = { ...column, ofCells: logs(column.ofCells), ofPoints: logs(column.ofPoints) };
    [low, high] = [Math.log10(low), Math.log10(high)];
  } else if (range && range[1] > range[0] && Math.min(high, range[1]) > Math.max(low, range[0])) {
    [low, high] = [Math.max(low, range[0]), Math.min(high, range[1])]; // outliers take no colours
  }
  if (!(high > low)) high = low + (Math.abs(low) || 1) * 1e-3;
  return { ...column, isLog, low, high };
}

function fieldColumns(grid: Grid): Column[] {
  const columns: Column[] = [];
  const names = new Set(grid.fields.map((f) => `${f.on} ${f.name} ${f.components}`));
  for (const key of names) {
    const parts = grid.fields.filter((f) => `${f.on} ${f.name} ${f.components}` === key);
    const { name, on, components } = parts[0]!;
    const pieces = components === 1 ? [-1] : [-2, ...Array.from({ length: Math.min(components, 9) }, (_, k) => k)];
    for (const piece of pieces) {
      const pickOf = (values: Float32Array) => piece === -1 ? values : new Float32Array(values.length / components).map((_, i) => {
        if (piece >= 0) return values[components * i + piece]!;
        return Math.hypot(...values.subarray(components * i, components * (i + 1)));
      });
      const suffix = piece === -1 ? "" : piece === -2 ? " (magnitude)" : ` [${components <= 3 ? "xyz"[piece] : piece}]`;
      const column = { key: `field ${key} ${piece}`, title: name + suffix, unit: "", map: "values" as MapName, worstIsLow: null, ofCells: null, ofPoints: null, ofFaces: null };
      if (on === "vertices") columns.push(finish({ ...column, ofPoints: pickOf(parts[0]!.values) }, null, false));
      else columns.push(finish({ ...column, ...cellField(grid, parts.map((p) => [p.block, pickOf(p.values)])) }, null, false));
    }
  }
  return columns;
}

function cellField(grid: Grid, parts: [string, Float32Array][]): { ofCells: Float32Array; ofFaces: Map<Block, Float32Array> } {
  const ofCells = new Float32Array(numCells(grid, grid.top_dimension)).fill(NaN);
  const ofFaces = new Map<Block, Float32Array>();
  for (const [type, values] of parts) {
    const block = grid.blocks.find((b) => b.type === type);
    if (block?.dimension === grid.top_dimension) ofCells.set(values.subarray(0, block.num_cells), block.first);
    else if (block?.dimension === 2) ofFaces.set(block, values);
  }
  return { ofCells, ofFaces };
}

export function columnsOf(grid: Grid): Column[] {
  const measures = grid.measures.map((m) =>
    finish({
      key: m.name, title: TITLES[m.name] ?? m.name, unit: m.unit === "deg" ? "°" : m.unit,
      map: !m.is_quality ? "values" : m.worst_is_low ? "low_is_bad" : "high_is_bad",
      worstIsLow: m.is_quality ? m.worst_is_low : null, ofCells: m.values, ofPoints: null, ofFaces: null,
    }, m.range, !m.is_quality));
  return [...measures, ...fieldColumns(grid)];
}

/** The value on the scale as it is in the file. */
export const unscaled = (column: Column, v: number): number => (column.isLog ? 10 ** v : v);

export const NUM_BINS = 24;
/** The bin of a value; the first and the last take what lies beyond. NONE for no value. */
export function binOf(column: Column, v: number): number {
  if (Number.isNaN(v)) return NONE;
  const bin = Math.floor(((v - column.low) / (column.high - column.low)) * NUM_BINS);
  return Math.min(NUM_BINS - 1, Math.max(0, bin));
}

export function histogram(column: Column): Uint32Array {
  const bins = new Uint32Array(NUM_BINS);
  for (const v of column.ofCells ?? []) {
    const bin = binOf(column, v);
    if (bin !== NONE) bins[bin]!++;
  }
  return bins;
}

/** The worst cells (of no quality: the smallest), the worst first. */
export function worst(column: Column, most = 10): number[] {
  const values = column.ofCells;
  if (!values) return [];
  const sign = column.worstIsLow === false ? -1 : 1;
  const found: number[] = [];
  for (let c = 0; c < values.length; c++) {
    const v = sign * values[c]!;
    if (Number.isNaN(v) || (found.length === most && !(v < sign * values[found[most - 1]!]!))) continue;
    let k = Math.min(found.length, most - 1);
    for (; k > 0 && v < sign * values[found[k - 1]!]!; k--) found[k] = found[k - 1]!;
    found[k] = c;
  }
  return found;
}

/** Number of the cell's type, for colours by type. */
export function typeOf(grid: Grid, dimension: number, cell: number): string {
  return blockOf(grid, dimension, cell).type;
}
