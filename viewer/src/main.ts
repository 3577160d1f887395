// SPDX-License-Identifier: Apache-2.0
import * as THREE from "three";
import { drawAxes } from "./axes";
import { byId, el } from "./dom";
import { NONE, type Grid } from "./grid";
import { hideInfo, showInfo } from "./info";
import { followJob } from "./job";
import { loadGrid } from "./load";
import { Panel } from "./panel";
import { Stage } from "./stage";
import "./style.css";
import { View } from "./view";

const canvas = byId("canvas") as HTMLCanvasElement;
const message = byId("message");

const DIRECTIONS: Record<string, [number, number, number]> = {
  "1": [-1, 0, 0], "2": [1, 0, 0], "3": [0, -1, 0], "4": [0, 1, 0], "5": [0, 0, 1], "6": [0, 0, -1],
};

class Page {
  private view: View | null = null;
  private panel: Panel | null = null;
  private hasWireframe = true;
  private isPerspective = true;
  private keys: [string, string, () => void][];

  constructor(private stage: Stage) {
    this.keys = [
      ["r", "reset the view", () => this.reset()],
      ["f", "fit what is shown", () => this.fit()],
      ["1 … 6", "look along x, −x, y, −y, −z, z", () => {}],
      ["o", "orthographic or perspective", () => this.toggleProjection()],
      ["w", "edges of cells on or off", () => this.toggleWireframe()],
      ["c", "cut on or off", () => this.toggleCut()],
      ["x y z v", "cut across x, y, z, the direction of view", () => {}],
      ["[ ]", "move the cut (with Shift: further)", () => {}],
      ["i", "keep the other side of the cut", () => this.panel?.flip()],
      ["Esc", "nothing picked or selected", () => this.clear()],
      ["h", "panel on or off", () => document.body.classList.toggle("wide")],
      ["s", "save a picture", () => this.save()],
      ["?", "this help", () => this.toggleHelp()],
    ];
    this.buildBar();
    this.buildHelp();
    addEventListener("keydown", (e) => this.onKey(e));
    stage.onFrame = () => {
      drawAxes(byId("axes") as HTMLCanvasElement, stage.camera, stage.isPlane);
      this.view?.plane.place();
    };
    this.watchClicks();
  }

  private buildBar(): void {
    const button = (id: string, text: string, title: string, click: () => void) => el("button", { id, title, click }, text);
    byId("bar").append(button("reset", "reset", "reset the view (r)", () => this.reset()), button("fit", "fit", "fit what is shown (f)", () => this.fit()),
      button("projection", "perspective", "orthographic or perspective (o)", () => this.toggleProjection()),
      button("wireframe", "edges", "edges of cells on or off (w)", () => this.toggleWireframe()),
      button("help-button", "?", "keys (?)", () => this.toggleHelp()));
    byId("wireframe").setAttribute("aria-pressed", "true");
  }

  private buildHelp(): void {
    const rows = this.keys.map(([key, text]) => el("tr", {}, el("th", {}, key), el("td", {}, text)));
    const mouse = [["drag", "turn (in the plane: move)"], ["right drag", "move"], ["wheel", "closer, towards the mouse"], ["click", "what is known of a cell"], ["drag the blue knob", "move the cut"]];
    byId("help").append(el("div", {}, el("h2", {}, "Keys and mouse"), el("table", {}, ...rows, ...mouse.map(([k, t]) => el("tr", {}, el("th", {}, k!), el("td", {}, t!)))),
      el("p", { class: "note" }, `drawn by ${this.stage.describe()}`)));
    byId("help").addEventListener("click", () => this.toggleHelp());
  }

  private toggleHelp(): void {
    byId("help").hidden = !byId("help").hidden;
  }

  async show(grid: Grid): Promise<void> {
    this.view?.dispose();
    this.panel?.remove();
    document.title = `${grid.name} – delfront`;
    const view = (this.view = new View(grid, this.stage, canvas));
    this.panel = new Panel(byId("panel"), view, {
      goTo: (cell) => void this.goTo(cell),
      goToPlace: (finding, place) => this.goToPlace(finding, place),
      toggleCut: () => this.toggleCut(),
      setCutAxis: (axis) => this.setCutAxis(axis),
    });
    view.onCut = () => this.panel?.refresh();
    this.reset();
    message.textContent = "finding neighbours …";
    await view.begin();
    this.panel.refresh();
    message.textContent = "";
    document.body.dataset.ready = "1";
  }

  private reset(): void {
    const view = this.view;
    if (!view) return;
    const sphere = view.visibleBox();
    if (this.stage.isPlane) {
      if (this.isPerspective) this.toggleProjection();
      this.stage.fit(sphere.center, sphere.radius, new THREE.Vector3(0, -1e-4, 1));
      this.stage.setPerspective(false);
    } else this.stage.fit(sphere.center, sphere.radius, new THREE.Vector3(-1, -1.6, 0.9));
  }

  private fit(): void {
    const sphere = this.view?.visibleBox();
    if (sphere) this.stage.fit(sphere.center, sphere.radius);
  }

  private toggleProjection(): void {
    this.isPerspective = !this.isPerspective;
    this.stage.setPerspective(this.isPerspective);
    byId("projection").textContent = this.isPerspective ? "perspective" : "orthographic";
  }

  private toggleWireframe(): void {
    this.hasWireframe = !this.hasWireframe;
    byId("wireframe").setAttribute("aria-pressed", String(this.hasWireframe));
    this.view?.setWireframe(this.hasWireframe);
  }

  private toggleCut(): void {
    const plane = this.view?.plane;
    if (!plane) return;
    plane.isOn = !plane.isOn;
    if (plane.isOn) this.aimCut();
    plane.update();
    void this.view!.cut();
  }

  /** Through what is shown: the body, not the middle of its far field; what faces the camera is cut away. */
  private aimCut(): void {
    const { plane } = this.view!;
    plane.moveTo(this.view!.visibleBox().center);
    const towards = this.stage.camera.position.clone().sub(this.stage.controls.target);
    plane.isFlipped = plane.normal.dot(towards) < 0;
  }

  private setCutAxis(axis: "x" | "y" | "z" | "view"): void {
    const plane = this.view?.plane;
    if (!plane) return;
    if (axis === "view") {
      const d = this.stage.camera.position.clone().sub(this.stage.controls.target);
      plane.setNormal(d.x, d.y, d.z);
    } else plane.setNormal(Number(axis === "x"), Number(axis === "y"), Number(axis === "z"));
    plane.isOn = true;
    this.aimCut();
    plane.update();
    void this.view!.cut();
  }

  private moveCut(step: number): void {
    const plane = this.view?.plane;
    if (!plane?.isOn) return;
    plane.position = Math.min(1, Math.max(0, plane.position + step));
    plane.update();
    void this.view!.cut();
  }

  private async goTo(cell: number): Promise<void> {
    const view = this.view!;
    const kept = new Uint8Array(view.grid.blocks.reduce((n, b) => n + (b.dimension === view.grid.top_dimension ? b.num_cells : 0), 0));
    kept[cell] = 1;
    view.bins = new Set();
    const { centre, radius } = view.centreOf(cell);
    this.stage.fit(centre, 5 * radius);
    showInfo(view, { cell, at: null, face: null });
    view.mark(cell);
    await view.select(kept);
  }

  private goToPlace(finding: number, place: number): void {
    const found = this.view!.grid.findings[finding]!;
    const at = new THREE.Vector3().fromArray(found.places, 3 * place);
    this.stage.fit(at, 0.06 * this.view!.visibleBox().radius);
  }

  private clear(): void {
    byId("help").hidden = true;
    hideInfo();
    this.panel?.clearSelection();
  }

  private save(): void {
    const link = el("a", { href: this.stage.image(), download: `${this.view?.grid.name ?? "grid"}.png` });
    link.click();
  }

  private onKey(e: KeyboardEvent): void {
    const target = e.target as HTMLElement;
    const isTyping = target.tagName === "SELECT" || (target.tagName === "INPUT" && (target as HTMLInputElement).type === "text");
    if (e.ctrlKey || e.metaKey || e.altKey || isTyping) return;
    const direction = DIRECTIONS[e.key];
    const step = e.shiftKey ? 0.05 : 0.005;
    if (direction && this.view && !this.stage.isPlane) {
      const s = this.view.visibleBox();
      this.stage.fit(s.center, s.radius, new THREE.Vector3(...direction).addScaledVector(new THREE.Vector3(0, -1e-3, 1e-3), 1));
    } else if (e.key === "x" || e.key === "y" || e.key === "z") this.setCutAxis(e.key);
    else if (e.key === "v") this.setCutAxis("view");
    else if (e.key === "[" || e.key === "{") this.moveCut(-step);
    else if (e.key === "]" || e.key === "}") this.moveCut(step);
    else if (e.key === "Escape") this.clear();
    else this.keys.find(([key]) => key === e.key)?.[2]();
  }

  /** A click is no drag. */
  private watchClicks(): void {
    let x = 0, y = 0;
    canvas.addEventListener("pointerdown", (e) => ([x, y] = [e.clientX, e.clientY]));
    canvas.addEventListener("pointerup", (e) => {
      if (e.button !== 0 || Math.hypot(e.clientX - x, e.clientY - y) > 4 || !this.view) return;
      const picked = this.view.pickAt(e.clientX, e.clientY);
      this.view.mark(picked?.cell ?? NONE);
      if (picked) showInfo(this.view, picked);
      else hideInfo();
    });
  }
}

async function main(): Promise<void> {
  message.textContent = "loading …";
  const page = new Page(new Stage(canvas));
  const load = async () => {
    const grid = await loadGrid();
    if (grid) await page.show(grid);
    return grid !== null;
  };
  const hasJob = await followJob(byId("panel"), async () => void (await load()));
  if (hasJob) message.textContent = "";
  else if (!(await load())) message.textContent = "there is no grid to show";
}

main().catch((error: unknown) => {
  message.textContent = `this does not work here: ${error instanceof Error ? error.message : String(error)}`;
  document.body.dataset.failed = "1";
});
