// SPDX-License-Identifier: Apache-2.0
// The panel at the left: facts, lists of names, colours, histogram, cut, defects.
import { histogram, NUM_BINS, unscaled, worst, type Column } from "./colouring";
import { count, el, number, section } from "./dom";
import { numCells } from "./grid";
import { colourAt, css, fromHex, toHex, CELL_TYPES } from "./palette";
import type { Entry, View } from "./view";

const PLURALS: Record<string, string> = {
  vertex: "points", line: "lines", triangle: "triangles", quad: "quads", tetrahedron: "tetrahedra", pyramid: "pyramids",
  prism: "prisms", hexahedron: "hexahedra", polygon: "polygons", polyhedron: "polyhedra",
};

export interface Actions {
  goTo(cell: number): void;
  goToPlace(finding: number, place: number): void;
  toggleCut(): void;
  setCutAxis(axis: "x" | "y" | "z" | "view"): void;
}

export class Panel {
  private cutText = el("p", { id: "cut-count", class: "note" });
  private slider = el("input", { type: "range", id: "cut-position", min: 0, max: 1000, value: 500, "aria-label": "position of the cut" }) as HTMLInputElement;
  private cutBox = el("input", { type: "checkbox", id: "cut-on" }) as HTMLInputElement;
  private select = el("select", { id: "colour-by", "aria-label": "colour by" }) as HTMLSelectElement;
  private bars = el("div", { id: "histogram" });
  private worstList = el("ol", { id: "worst" });
  private boxes = new Map<Entry, HTMLInputElement>();
  private qualityPart: HTMLElement;

  constructor(private root: HTMLElement, private view: View, private actions: Actions) {
    this.qualityPart = el("div", {}, this.bars, el("p", { id: "selected-count", class: "note" }), el("h3", { id: "worst-title" }), this.worstList);
    root.append(this.facts(), ...this.lists(), this.colours(), this.cut(), ...this.defects());
    this.showColumn();
  }

  private facts(): HTMLElement {
    const { grid } = this.view;
    const table = el("table", { id: "facts" });
    const row = (name: string, value: string, id = "") => table.append(el("tr", {}, el("th", {}, name), el("td", id ? { id } : {}, value)));
    row("points", count(grid.points.length / 3), "num-points");
    for (const block of grid.blocks) row(PLURALS[block.type] ?? block.type, count(block.num_cells), `num-${block.type}`);
    for (const k of [0, 1, 2]) {
      if (k === 2 && grid.dimension === 2) continue;
      row("xyz"[k]!, `${number(grid.box[k]!)} … ${number(grid.box[k + 3]!)}`);
    }
    const title = el("h1", { title: grid.name }, grid.name);
    return el("header", {}, title, table);
  }

  private lists(): HTMLElement[] {
    const isPlane = this.view.grid.dimension === 2;
    const titles: [number, string][] = [[2, isPlane ? "Regions" : "Surfaces"], [3, "Regions"], [1, "Lines"], [0, "Points"]];
    return titles.flatMap(([dimension, title]) => {
      const entries = this.view.entries.filter((e) => e.dimension === dimension);
      if (entries.length === 0) return [];
      const [whole, body] = section(`list-${dimension}`, `${title} (${entries.length})`, dimension !== 0);
      if (entries.length > 1) body.append(this.allOrNone(entries));
      const list = el("ul", { class: "names" }, ...entries.map((e) => this.line(e)));
      body.append(list);
      return [whole];
    });
  }

  private allOrNone(entries: Entry[]): HTMLElement {
    const set = (isOn: boolean) => () => entries.forEach((e) => this.setVisible(e, isOn));
    return el("p", { class: "row" }, el("button", { click: set(true) }, "all"), el("button", { click: set(false) }, "none"));
  }

  private line(entry: Entry): HTMLElement {
    const box = el("input", { type: "checkbox", change: () => this.setVisible(entry, box.checked) }) as HTMLInputElement;
    box.checked = entry.isVisible;
    this.boxes.set(entry, box);
    const colour = el("input", {
      type: "color", value: toHex(entry.colour), title: "colour",
      input: () => this.view.setColour(entry, fromHex(colour.value)),
    }) as HTMLInputElement;
    const only = () => this.view.entries.filter((e) => e.dimension === entry.dimension).forEach((e) => this.setVisible(e, e === entry));
    const name = el("span", { class: "name", title: `${entry.name}${entry.kind ? ` (${entry.kind})` : ""}; double click: only this`, dblclick: only }, entry.name);
    const label = el("label", {}, box, name);
    return el("li", { "data-name": entry.name }, colour, label, el("span", { class: "count" }, count(entry.count)));
  }

  private setVisible(entry: Entry, isVisible: boolean): void {
    this.boxes.get(entry)!.checked = isVisible;
    this.view.setVisible(entry, isVisible);
  }

  private colours(): HTMLElement {
    const [whole, body] = section("colours", "Colour and quality");
    const option = (value: string, text: string) => el("option", { value }, text);
    this.select.append(option("name", "name"), option("type", "cell type"));
    const groups: [string, (c: Column) => boolean][] = [
      ["quality", (c) => c.worstIsLow !== null], ["size", (c) => c.worstIsLow === null && !c.key.startsWith("field ")], ["fields", (c) => c.key.startsWith("field ")],
    ];
    for (const [label, isOf] of groups) {
      const columns = this.view.columns.filter(isOf);
      if (columns.length) this.select.append(el("optgroup", { label }, ...columns.map((c) => option(c.key, c.title))));
    }
    this.select.addEventListener("change", () => this.choose(this.select.value));
    body.append(el("p", { class: "row" }, this.select), this.qualityPart);
    return whole;
  }

  choose(key: string): void {
    this.select.value = key;
    void this.view.selectBins(new Set());
    this.view.colourBy(this.view.columns.find((c) => c.key === key) ?? null, key === "type");
    this.showColumn();
  }

  private showColumn(): void {
    const column = this.view.column;
    this.qualityPart.hidden = !column?.ofCells;
    this.drawLegend();
    if (!column?.ofCells) return;
    this.drawBars(column);
    const title = column.worstIsLow === null ? "Smallest ten" : "Worst ten";
    this.qualityPart.querySelector("#worst-title")!.textContent = title;
    this.worstList.replaceChildren(...worst(column).map((cell) =>
      el("li", {}, el("button", { class: "link", "data-cell": cell, click: () => this.actions.goTo(cell) },
        `cell ${cell}`), el("span", { class: "count" }, number(unscaled(column, column.ofCells![cell]!)) + column.unit))));
  }

  private drawBars(column: Column): void {
    const bins = histogram(column), most = Math.max(1, ...bins);
    const edge = (b: number) => number(unscaled(column, column.low + (b / NUM_BINS) * (column.high - column.low)), 3);
    this.bars.replaceChildren(...Array.from(bins, (n, b) => {
      // logarithmic: the few bad cells are what one looks for
      const height = n === 0 ? 0 : 6 + (94 * Math.log(1 + n)) / Math.log(1 + most);
      const bar = el("i", { style: `height:${height}%;background:${css(colourAt(column.map, (b + 0.5) / NUM_BINS))}` });
      return el("button", { class: "bar", "data-bin": b, "data-count": n, title: `${edge(b)} … ${edge(b + 1)}${column.unit}: ${count(n)} cells`,
        "aria-pressed": "false", click: (e) => this.toggleBin(b, (e as MouseEvent).shiftKey) }, bar);
    }));
    const ends = el("p", { class: "ends" }, el("span", {}, edge(0)), el("span", {}, edge(NUM_BINS) + column.unit));
    this.bars.after(ends);
    this.qualityPart.querySelectorAll(".ends").forEach((e) => e !== ends && e.remove());
    this.showSelected();
  }

  private lastBin = 0;
  private toggleBin(bin: number, isRange: boolean): void {
    const bins = new Set(this.view.bins);
    if (isRange) for (let b = Math.min(bin, this.lastBin); b <= Math.max(bin, this.lastBin); b++) bins.add(b);
    else if (bins.has(bin)) bins.delete(bin);
    else bins.add(bin);
    this.lastBin = bin;
    void this.view.selectBins(bins);
  }

  clearSelection(): void {
    void this.view.selectBins(new Set());
    this.view.mark(0xffffffff);
  }

  private showSelected(): void {
    const { numSelected, bins } = this.view;
    this.bars.querySelectorAll(".bar").forEach((bar, b) => bar.setAttribute("aria-pressed", String(bins.has(b))));
    this.bars.classList.toggle("chosen", bins.size > 0);
    const text = this.qualityPart.querySelector("#selected-count") as HTMLElement;
    text.dataset.selected = String(numSelected);
    text.textContent = numSelected ? `${count(numSelected)} ${numSelected === 1 ? "cell" : "cells"} selected (Esc: none)` : "click bars to select cells";
  }

  private drawLegend(): void {
    const legend = document.getElementById("legend")!;
    const column = this.view.column;
    legend.hidden = !column && !this.view.byType;
    if (column) {
      const stops = Array.from({ length: 17 }, (_, i) => css(colourAt(column.map, i / 16))).join(",");
      const ticks = [0, 0.25, 0.5, 0.75, 1].map((t) => el("span", {}, number(unscaled(column, column.low + t * (column.high - column.low)), 3)));
      legend.replaceChildren(el("b", {}, column.title + (column.unit ? ` (${column.unit})` : "")),
        el("div", { class: "ramp", style: `background:linear-gradient(to right,${stops})` }), el("div", { class: "ticks" }, ...ticks));
    } else if (this.view.byType) {
      const types = [...new Set(this.view.grid.blocks.filter((b) => b.dimension === this.view.grid.top_dimension).map((b) => b.type))];
      legend.replaceChildren(el("b", {}, "cell type"), ...types.map((t) =>
        el("div", { class: "key" }, el("i", { style: `background:${css(CELL_TYPES[t]!)}` }), PLURALS[t]!)));
    }
  }

  private cut(): HTMLElement {
    const [whole, body] = section("cut", "Cut");
    this.cutBox.addEventListener("change", () => this.actions.toggleCut());
    this.slider.addEventListener("input", () => {
      this.view.plane.position = Number(this.slider.value) / 1000;
      if (!this.view.plane.isOn) return this.actions.toggleCut();
      this.view.plane.update();
      void this.view.cut();
    });
    const axes = (["x", "y", "z", "view"] as const).filter((a) => this.view.grid.dimension === 3 || a === "x" || a === "y");
    const axis = axes.map((a) => el("button", { id: `cut-${a}`, title: `normal along ${a}`, click: () => this.actions.setCutAxis(a) }, a));
    const flip = el("button", { id: "cut-flip", title: "keep the other side", click: () => this.flip() }, "flip");
    body.append(el("p", { class: "row" }, el("label", {}, this.cutBox, " cut"), ...axis, flip), this.slider, this.cutText);
    return whole;
  }

  flip(): void {
    this.view.plane.isFlipped = !this.view.plane.isFlipped;
    void this.view.cut();
  }

  /** After a cut or a selection. */
  refresh(): void {
    const plane = this.view.plane;
    this.cutBox.checked = plane.isOn;
    this.slider.value = String(Math.round(1000 * plane.position));
    const all = numCells(this.view.grid, this.view.grid.top_dimension);
    this.cutText.dataset.kept = String(this.view.numKept);
    this.cutText.textContent = `${count(this.view.numKept)} of ${count(all)} cells shown`;
    this.showSelected();
  }

  private defects(): HTMLElement[] {
    const { findings } = this.view.grid;
    if (findings.length === 0) return [];
    const [whole, body] = section("defects", `Findings (${findings.length})`);
    findings.forEach((finding, f) => {
      const box = el("input", { type: "checkbox", change: () => this.show(f, box.checked) }) as HTMLInputElement;
      box.checked = finding.severity !== "note";
      this.view.markers[f]!.visible = box.checked;
      const name = finding.kind.replaceAll("_", " ");
      const head = el("label", {}, box, el("b", { class: finding.severity }, name), el("span", { class: "count" }, count(finding.count)));
      const places = Array.from({ length: Math.min(8, finding.ids.length) }, (_, k) =>
        el("button", { class: "link", click: () => this.actions.goToPlace(f, k) }, finding.ids[k] === 0xffffffff ? `place ${k + 1}` : `id ${finding.ids[k]}`));
      body.append(el("div", { class: "finding", "data-kind": finding.kind, "data-count": finding.count }, head,
        el("p", { class: "note" }, [finding.message, finding.remedy].filter(Boolean).join("; ")), el("p", { class: "row" }, ...places)));
    });
    return [whole];
  }

  private show(finding: number, isVisible: boolean): void {
    this.view.markers[finding]!.visible = isVisible;
    this.view.stage.draw();
  }

  remove(): void {
    this.root.replaceChildren();
  }
}
