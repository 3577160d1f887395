// SPDX-License-Identifier: Apache-2.0
// Renderer, cameras and mouse. Draws only when something has changed.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const FIELD_OF_VIEW = 35;

export class Stage {
  readonly scene = new THREE.Scene();
  readonly pickScene = new THREE.Scene();
  readonly sphere = new THREE.Sphere(new THREE.Vector3(), 1); // round all there is
  readonly perspective = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 100);
  readonly orthographic = new THREE.OrthographicCamera();
  camera: THREE.PerspectiveCamera | THREE.OrthographicCamera = this.perspective;
  controls: OrbitControls;
  onFrame: () => void = () => {};
  isPlane = false; // a grid in the plane is looked at from above
  frames = 0;
  private renderer: THREE.WebGLRenderer;
  private target = new THREE.WebGLRenderTarget(1, 1);
  private isAsked = false;
  private height = 1; // of what the orthographic camera sees, at zoom 1

  constructor(private canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // our colours are final
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    THREE.ColorManagement.enabled = false;
    this.scene.background = new THREE.Color(0xf3f5f8);
    for (const camera of [this.perspective, this.orthographic]) camera.up.set(0, 0, 1);
    this.controls = this.makeControls();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
  }

  private makeControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.zoomToCursor = true;
    controls.rotateSpeed = 0.8;
    controls.addEventListener("change", () => this.draw());
    return controls;
  }

  /** The graphics card's name, for reports of slowness. */
  describe(): string {
    const gl = this.renderer.getContext();
    const names = gl.getExtension("WEBGL_debug_renderer_info");
    return String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  }

  draw(): void {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      this.setDepth();
      this.renderer.render(this.scene, this.camera);
      this.frames++;
      this.onFrame();
    });
  }

  private setDepth(): void {
    const away = this.camera.position.distanceTo(this.sphere.center), r = 1.05 * this.sphere.radius;
    if (this.camera === this.perspective) {
      const target = this.camera.position.distanceTo(this.controls.target);
      this.perspective.near = Math.max(away - r, 0.02 * target, 1e-5 * r);
      this.perspective.far = Math.max(away + r, 2 * this.perspective.near);
    } else {
      this.camera.near = away - r;
      this.camera.far = away + r;
    }
    this.camera.updateProjectionMatrix();
  }

  private resize(): void {
    const box = this.canvas.parentElement!.getBoundingClientRect();
    const width = Math.max(1, box.width), height = Math.max(1, box.height);
    this.renderer.setSize(width, height, false);
    this.perspective.aspect = width / height;
    this.setHeight(this.height);
    this.draw();
  }

  private setHeight(height: number): void {
    this.height = height;
    const camera = this.orthographic, aspect = this.perspective.aspect;
    camera.top = height / 2;
    camera.bottom = -height / 2;
    camera.left = (-height * aspect) / 2;
    camera.right = (height * aspect) / 2;
  }

  /** Look at a sphere from a direction (by default the present one). */
  fit(centre: THREE.Vector3, radius: number, from?: THREE.Vector3): void {
    const direction = from?.clone() ?? this.camera.position.clone().sub(this.controls.target);
    if (direction.lengthSq() === 0) direction.set(-1, -1.6, 0.9);
    direction.normalize();
    const half = Math.atan(Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * Math.min(1, this.perspective.aspect));
    const distance = Math.max(radius, 1e-12) / Math.sin(half);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction, distance);
    this.orthographic.zoom = 1;
    this.setHeight((2.1 * Math.max(radius, 1e-12)) / Math.min(1, this.perspective.aspect));
    this.controls.update();
    this.draw();
  }

  setPerspective(isPerspective: boolean): void {
    const old = this.camera, target = this.controls.target.clone();
    const direction = old.position.clone().sub(target);
    const tangent = 2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    this.controls.dispose();
    if (isPerspective) {
      this.camera = this.perspective;
      if (old === this.orthographic) direction.setLength(this.height / this.orthographic.zoom / tangent);
    } else {
      this.camera = this.orthographic;
      if (old === this.perspective) {
        this.setHeight(direction.length() * tangent);
        this.orthographic.zoom = 1;
      }
    }
    this.camera.position.copy(target).add(direction);
    this.controls = this.makeControls();
    this.controls.target.copy(target);
    if (this.isPlane) {
      this.controls.enableRotate = false;
      this.controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
    }
    this.controls.update();
    this.draw();
  }

  /** @returns layer and face under the mouse, or null */
  pick(x: number, y: number): { layer: number; face: number } | null {
    const box = this.canvas.getBoundingClientRect();
    this.setDepth();
    this.camera.setViewOffset(box.width, box.height, x - box.left, y - box.top, 1, 1);
    this.renderer.setRenderTarget(this.target);
    this.renderer.setClearColor(0, 0);
    this.renderer.clear();
    this.renderer.render(this.pickScene, this.camera);
    const id = new Uint8Array(4);
    this.renderer.readRenderTargetPixels(this.target, 0, 0, 1, 1, id);
    this.renderer.setRenderTarget(null);
    this.camera.clearViewOffset();
    const layer = id[3]! >> 5;
    if (layer === 0) return null;
    return { layer, face: id[0]! | (id[1]! << 8) | (id[2]! << 16) | ((id[3]! & 31) << 24) };
  }

  ray(x: number, y: number): THREE.Ray {
    const box = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    return caster.ray;
  }

  /** Where a place is on the canvas, pixels. */
  project(p: THREE.Vector3): { x: number; y: number } {
    const q = p.clone().project(this.camera);
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + ((q.x + 1) / 2) * box.width, y: box.top + ((1 - q.y) / 2) * box.height };
  }

  image(): string {
    this.renderer.render(this.scene, this.camera);
    return this.canvas.toDataURL("image/png");
  }
}
