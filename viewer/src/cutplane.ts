// SPDX-License-Identifier: Apache-2.0
// The plane of the cut: its frame in the scene, and a knob in its middle to drag it by.
import * as THREE from "three";
import type { Stage } from "./stage";
import type { Plane } from "./topology";

const REACH = 16; // pixels round the knob

export class CutPlane {
  isOn = false;
  isFlipped = false;
  readonly normal = new THREE.Vector3(0, 1, 0);
  position = 0.5; // from one end of the grid to the other
  onMove: () => void = () => {};
  private frame = new THREE.LineLoop(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x2563eb }));
  private knob: HTMLElement;
  private isDragged = false;

  constructor(private stage: Stage, private low: THREE.Vector3, private high: THREE.Vector3, canvas: HTMLCanvasElement) {
    this.frame.frustumCulled = false;
    stage.scene.add(this.frame);
    this.knob = document.createElement("div");
    this.knob.id = "knob";
    this.knob.title = "drag the plane";
    this.knob.hidden = true;
    canvas.parentElement!.append(this.knob);
    this.knob.addEventListener("pointerdown", (e) => this.begin(e));
    this.knob.addEventListener("pointermove", (e) => this.drag(e));
    for (const end of ["pointerup", "pointercancel"]) this.knob.addEventListener(end, () => (this.isDragged = false));
    this.update();
  }

  /** Least and largest normal . p over the box. */
  private range(): [number, number] {
    let low = 0, high = 0;
    for (const k of ["x", "y", "z"] as const) {
      const a = this.normal[k] * this.low[k], b = this.normal[k] * this.high[k];
      low += Math.min(a, b);
      high += Math.max(a, b);
    }
    return [low, high];
  }

  /** normal . p of the plane. */
  offset(): number {
    const [low, high] = this.range();
    return low + this.position * (high - low);
  }

  setNormal(x: number, y: number, z: number): void {
    this.normal.set(x, y, z).normalize();
    this.update();
  }

  /** Move it to a place, with the same normal. */
  moveTo(p: THREE.Vector3): void {
    const [low, high] = this.range();
    this.position = Math.min(1, Math.max(0, (this.normal.dot(p) - low) / Math.max(high - low, 1e-30)));
    this.update();
  }

  plane(): Plane | null {
    if (!this.isOn) return null;
    return { normal: this.normal.toArray(), offset: this.offset(), isFlipped: this.isFlipped };
  }

  private middle(): THREE.Vector3 {
    const centre = this.low.clone().add(this.high).multiplyScalar(0.5);
    return centre.addScaledVector(this.normal, this.offset() - this.normal.dot(centre));
  }

  update(): void {
    this.frame.visible = this.isOn;
    const n = this.normal;
    const side = Math.abs(n.z) > 0.9 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, 0, 1);
    const u = new THREE.Vector3().crossVectors(side, n).normalize(), v = new THREE.Vector3().crossVectors(n, u);
    const half = this.high.clone().sub(this.low).multiplyScalar(0.52);
    const reach = (d: THREE.Vector3) => Math.abs(d.x) * half.x + Math.abs(d.y) * half.y + Math.abs(d.z) * half.z;
    u.multiplyScalar(reach(u));
    v.multiplyScalar(reach(v));
    const m = this.middle();
    this.frame.geometry.setFromPoints([
      m.clone().add(u).add(v), m.clone().sub(u).add(v), m.clone().sub(u).sub(v), m.clone().add(u).sub(v),
    ]);
    this.place();
    this.stage.draw();
  }

  /** The knob follows the camera. */
  place(): void {
    this.knob.hidden = !this.isOn;
    if (!this.isOn) return;
    const at = this.stage.project(this.middle());
    const box = this.knob.parentElement!.getBoundingClientRect();
    this.knob.style.transform = `translate(${at.x - box.left - REACH}px, ${at.y - box.top - REACH}px)`;
  }

  private begin(e: PointerEvent): void {
    this.isDragged = true;
    this.knob.setPointerCapture(e.pointerId);
    e.preventDefault();
  }

  private drag(e: PointerEvent): void {
    if (!this.isDragged) return;
    const [low, high] = this.range();
    const m = this.middle(), a = this.stage.project(m);
    const step = 0.01 * (high - low);
    const b = this.stage.project(m.clone().addScaledVector(this.normal, step));
    const dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
    const pixels = e.movementX * dx + e.movementY * dy;
    // looked at along the normal it cannot be seen to move: then up is away
    const moved = squared > 1e-3 ? (pixels / squared) * step : -e.movementY * 0.003 * (high - low);
    this.position = Math.min(1, Math.max(0, this.position + moved / Math.max(high - low, 1e-30)));
    this.update();
    this.onMove();
  }
}
