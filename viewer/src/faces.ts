// SPDX-License-Identifier: Apache-2.0
// Faces drawn from textures: one texel a triangle (points, face, which sides are edges), one a point, one a face (value,
// state). The vertex shader fetches by gl_VertexID, so that nothing is stored twice; edges are drawn by the fragment
// shader in the same call, without the diagonals of quads; normals are derivatives.
import * as THREE from "three";
import { colourAt, type Colour, type MapName } from "./palette";

export enum State { hidden = 0, shown = 1, marked = 2 }
export enum Paint { constant = 0, faces = 1, points = 2 }
const WIDTH = 4096;

const VERTEX = `
precision highp float; precision highp int; precision highp usampler2D; precision highp sampler2D;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform usampler2D uTriangles; uniform sampler2D uPoints, uFaces;
uniform int uFirst;
out vec3 vView; out vec3 vCorner; out float vValue; flat out uint vFace; flat out uint vEdges; flat out float vState;
ivec2 at(int i) { return ivec2(i % ${WIDTH}, i / ${WIDTH}); }
void main() {
  int triangle = uFirst + gl_VertexID / 3, corner = gl_VertexID % 3;
  uvec4 t = texelFetch(uTriangles, at(triangle), 0);
  vec4 p = texelFetch(uPoints, at(int(t[corner])), 0);
  vFace = t.w & 0x1fffffffu; vEdges = t.w >> 29;
  vec4 face = texelFetch(uFaces, at(int(vFace)), 0);
  vState = face.y;
  vValue = face.x;
  vCorner = vec3(corner == 0, corner == 1, corner == 2);
#ifdef BY_POINTS
  vValue = p.w;
#endif
  vec4 view = modelViewMatrix * vec4(p.xyz, 1.0);
  vView = view.xyz;
  gl_Position = face.y < 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * view;
}`;

const FRAGMENT = `
precision highp float; precision highp int;
uniform sampler2D uMap; uniform vec3 uColour, uMarked; uniform vec2 uRange;
uniform int uPaint; uniform float uEdges, uAlpha, uFlat;
in vec3 vView; in vec3 vCorner; in float vValue; flat in uint vFace; flat in uint vEdges; flat in float vState;
out vec4 colour;
void main() {
  vec3 base = uColour;
  if (uPaint != 0) {
    float t = (vValue - uRange.x) / max(uRange.y - uRange.x, 1e-30);
    base = isnan(vValue) ? vec3(0.75) : texture(uMap, vec2(clamp(t, 0.001, 0.999), 0.5)).rgb;
  }
  if (vState > 1.5) base = uMarked;
  vec3 normal = normalize(cross(dFdx(vView), dFdy(vView)));
  float light = mix(0.42 + 0.58 * abs(dot(normal, normalize(vec3(0.25, 0.35, 1.0)))), 1.0, uFlat);
  vec3 width = fwidth(vCorner), d = vCorner / max(width, vec3(1e-6));
  float nearest = 1e6;
  if ((vEdges & 1u) != 0u) nearest = min(nearest, d.z);
  if ((vEdges & 2u) != 0u) nearest = min(nearest, d.x);
  if ((vEdges & 4u) != 0u) nearest = min(nearest, d.y);
  float crowd = max(width.x, max(width.y, width.z));
  float line = (1.0 - smoothstep(0.4, 1.3, nearest)) * uEdges * (1.0 - smoothstep(0.12, 0.6, crowd));
  colour = vec4(mix(base * light, vec3(0.07, 0.09, 0.13), 0.75 * line), max(uAlpha, 2.5 * uAlpha * line));
}`;

const PICK = `
precision highp float; precision highp int;
uniform uint uLayer;
flat in uint vFace; in vec3 vView; in vec3 vCorner; in float vValue; flat in uint vEdges; flat in float vState;
out vec4 colour;
void main() {
  uint id = vFace | (uLayer << 29);
  colour = vec4(id & 255u, (id >> 8) & 255u, (id >> 16) & 255u, id >> 24) / 255.0;
}`;

function texture(data: Float32Array | Uint32Array, texels: number, kind: "points" | "faces" | "triangles"): THREE.DataTexture {
  const each = kind === "faces" ? 2 : 4;
  const height = Math.max(1, Math.ceil(texels / WIDTH));
  let padded = data;
  if (data.length !== WIDTH * height * each) {
    padded = kind === "triangles" ? new Uint32Array(WIDTH * height * each) : new Float32Array(WIDTH * height * each);
    padded.set(data.subarray(0, texels * each));
  }
  const format = kind === "points" ? THREE.RGBAFormat : kind === "faces" ? THREE.RGFormat : THREE.RGBAIntegerFormat;
  const made = new THREE.DataTexture(padded, WIDTH, height, format,
                                     kind === "triangles" ? THREE.UnsignedIntType : THREE.FloatType);
  made.internalFormat = kind === "points" ? "RGBA32F" : kind === "faces" ? "RG32F" : "RGBA32UI";
  made.needsUpdate = true;
  return made;
}

/** The points of a grid, and a value on each. */
export class PointTexture {
  readonly texture: THREE.DataTexture;

  constructor(points: Float32Array) {
    const n = points.length / 3;
    const data = new Float32Array(4 * Math.ceil(Math.max(1, n) / WIDTH) * WIDTH);
    for (let i = 0; i < n; i++) for (let k = 0; k < 3; k++) data[4 * i + k] = points[3 * i + k]!;
    this.texture = texture(data, n, "points");
  }

  setValues(values: Float32Array): void {
    const data = this.texture.image.data as Float32Array;
    for (let i = 0; i < values.length; i++) data[4 * i + 3] = values[i]!;
    this.texture.needsUpdate = true;
  }
}

/** What all layers show in the same way. */
export class Look {
  readonly map = new THREE.DataTexture(new Uint8Array(4 * 256), 256, 1, THREE.RGBAFormat);
  readonly range = new THREE.Vector2(0, 1);
  readonly edges = { value: 1 };
  readonly flat = { value: 0 };

  constructor() {
    this.map.minFilter = this.map.magFilter = THREE.LinearFilter;
    this.setMap("values");
  }

  setMap(name: MapName): void {
    const data = this.map.image.data as Uint8Array;
    for (let i = 0; i < 256; i++) data.set([...colourAt(name, i / 255).map((c) => Math.round(255 * c)), 255], 4 * i);
    this.map.needsUpdate = true;
  }

  /** Any colours by number: cell types, regions. */
  setColours(colours: Colour[]): void {
    const data = this.map.image.data as Uint8Array;
    for (let i = 0; i < 256; i++) {
      const c = colours[Math.min(colours.length - 1, Math.floor((i / 256) * colours.length))] ?? [0.7, 0.7, 0.7];
      data.set([...c.map((x) => Math.round(255 * x)), 255], 4 * i);
    }
    this.map.needsUpdate = true;
  }
}

interface Part {
  mesh: THREE.Mesh;
  pick: THREE.Mesh;
  paint: THREE.RawShaderMaterial;
}

/** Faces of one kind (stored ones, those of the cut …): parts are ranges of triangles, each drawn in one call. */
export class FaceLayer {
  readonly group = new THREE.Group();
  readonly pickGroup = new THREE.Group();
  readonly parts: Part[] = [];
  numFaces = 0;
  triangles: Uint32Array = new Uint32Array(0);
  private faces: Float32Array = new Float32Array(2);
  private uniforms: Record<string, { value: unknown }>;

  constructor(points: PointTexture, look: Look, readonly layer: number, private byPoints = false) {
    this.uniforms = {
      uTriangles: { value: null }, uPoints: { value: points.texture }, uFaces: { value: null }, uMap: { value: look.map },
      uRange: { value: look.range }, uPaint: { value: Paint.constant }, uEdges: look.edges, uFlat: look.flat,
      uAlpha: { value: 1 }, uMarked: { value: new THREE.Color(1, 0.42, 0) }, uLayer: { value: layer },
    };
  }

  /** @param ranges  [first triangle, number of triangles] of each part */
  setTriangles(triangles: Uint32Array, numFaces: number, ranges: [number, number][]): void {
    this.dispose();
    this.triangles = triangles;
    this.numFaces = numFaces;
    this.faces = new Float32Array(2 * Math.ceil(Math.max(1, numFaces) / WIDTH) * WIDTH);
    for (let f = 0; f < numFaces; f++) this.faces[2 * f + 1] = State.shown;
    this.uniforms.uTriangles!.value = texture(triangles, triangles.length / 4, "triangles");
    this.uniforms.uFaces!.value = texture(this.faces, numFaces, "faces");
    for (const [first, count] of ranges) this.addPart(first, count);
  }

  private addPart(first: number, count: number): void {
    const own = { ...this.uniforms, uFirst: { value: first }, uColour: { value: new THREE.Color(0.7, 0.75, 0.8) } };
    const make = (fragmentShader: string) =>
      new THREE.RawShaderMaterial({
        glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader, uniforms: own, side: THREE.DoubleSide,
        defines: this.byPoints ? { BY_POINTS: 1 } : {},
      });
    const geometry = new THREE.BufferGeometry();
    geometry.setDrawRange(0, 3 * count);
    const paint = make(FRAGMENT);
    const mesh = new THREE.Mesh(geometry, paint), pick = new THREE.Mesh(geometry, make(PICK));
    mesh.frustumCulled = pick.frustumCulled = false;
    this.group.add(mesh);
    this.pickGroup.add(pick);
    this.parts.push({ mesh, pick, paint });
  }

  setVisible(part: number, isVisible: boolean): void {
    this.parts[part]!.mesh.visible = this.parts[part]!.pick.visible = isVisible;
  }

  setColour(part: number, colour: Colour): void {
    (this.parts[part]!.paint.uniforms.uColour!.value as THREE.Color).setRGB(...colour, THREE.LinearSRGBColorSpace);
  }

  /** How faces get their colour; `values` is one a face, or null. */
  setPaint(paint: Paint, values: ArrayLike<number> | null): void {
    this.uniforms.uPaint!.value = paint;
    if (values) for (let f = 0; f < this.numFaces; f++) this.faces[2 * f] = values[f]!;
    this.upload();
    if ((paint === Paint.points) !== this.byPoints) {
      this.byPoints = paint === Paint.points;
      for (const { mesh, pick } of this.parts)
        for (const material of [mesh.material, pick.material] as THREE.RawShaderMaterial[]) {
          material.defines = this.byPoints ? { BY_POINTS: 1 } : {};
          material.needsUpdate = true;
        }
    }
  }

  setStates(states: ArrayLike<number>): void {
    for (let f = 0; f < this.numFaces; f++) this.faces[2 * f + 1] = states[f]!;
    this.upload();
  }

  private upload(): void {
    const made = this.uniforms.uFaces!.value as THREE.DataTexture | null;
    if (!made) return;
    (made.image.data as Float32Array).set(this.faces.subarray(0, made.image.data!.length));
    made.needsUpdate = true;
  }

  /** 1: solid; less: a ghost that hides nothing. */
  setAlpha(alpha: number): void {
    this.uniforms.uAlpha!.value = alpha;
    for (const { paint } of this.parts) {
      paint.transparent = alpha < 1;
      paint.depthWrite = alpha >= 1;
    }
  }

  isShown(face: number): boolean {
    return this.faces[2 * face + 1]! > 0.5;
  }

  dispose(): void {
    for (const { mesh, pick, paint } of this.parts) {
      mesh.geometry.dispose();
      paint.dispose();
      (pick.material as THREE.Material).dispose();
    }
    this.parts.length = 0;
    this.group.clear();
    this.pickGroup.clear();
    for (const name of ["uTriangles", "uFaces"]) (this.uniforms[name]!.value as THREE.DataTexture | null)?.dispose();
  }
}
