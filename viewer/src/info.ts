// SPDX-License-Identifier: Apache-2.0
// What is known of the cell that was clicked.
import type * as THREE from "three";
import { unscaled } from "./colouring";
import { byId, el, number } from "./dom";
import { blockOf, cornersOf, NONE } from "./grid";
import type { Picked, View } from "./view";

export function hideInfo(): void {
  byId("info").hidden = true;
}

export function showInfo(view: View, picked: Picked): void {
  const { grid } = view, box = byId("info");
  const table = el("table");
  const measures = el("table"); // of its own: long names, short values
  const row = (name: string, value: string, into = table) => into.append(el("tr", {}, el("th", {}, name), el("td", {}, value)));
  const place = (p: THREE.Vector3 | number[]) => {
    const values = Array.isArray(p) ? p : p.toArray();
    return "(" + values.slice(0, grid.dimension).map((v, k) => number(v + grid.centre[k]!, 5)).join(", ") + ")";
  };
  if (picked.at) row("place", place(picked.at));
  if (picked.face !== null && grid.top_dimension === 3) {
    const face = blockOf(grid, 2, picked.face);
    row("surface", grid.groups[face.groups[picked.face - face.first]!]?.name ?? "(no name)");
    row("face", `${face.type} ${picked.face}`);
  }
  box.dataset.cell = picked.cell === NONE ? "" : String(picked.cell);
  if (picked.cell !== NONE) {
    const block = blockOf(grid, grid.top_dimension, picked.cell), index = picked.cell - block.first;
    const group = grid.groups[block.groups[index]!];
    if (group) row("region", group.name);
    row("type", block.type);
    row("centre", place(view.centreOf(picked.cell).centre));
    for (const column of view.columns) {
      const value = column.ofCells?.[picked.cell];
      if (value !== undefined && !Number.isNaN(value)) row(column.title, number(unscaled(column, value)) + column.unit, measures);
    }
    const corners = cornersOf(block, index).map((v) =>
      el("tr", {}, el("th", {}, String(v)), el("td", {}, place([...grid.points.subarray(3 * v, 3 * v + 3)]))));
    const points = el("details", {}, el("summary", {}, `${corners.length} points`), el("table", {}, ...corners));
    box.replaceChildren(el("h2", {}, `cell ${picked.cell}`), table, measures, points);
  } else box.replaceChildren(el("h2", {}, "face"), table);
  box.prepend(el("button", { class: "close", title: "close (Esc)", click: () => { hideInfo(); view.mark(NONE); } }, "×"));
  box.hidden = false;
}
