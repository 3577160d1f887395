// SPDX-License-Identifier: Apache-2.0
// Lines and points of the grid, outlines and markers of findings, edges of a picked cell.
import * as THREE from "three";
import { cornersOf, rangeOf, type Finding, type Grid } from "./grid";
import type { Colour } from "./palette";

function positions(grid: Grid, corners: number[]): THREE.BufferGeometry {
  const values = new Float32Array(3 * corners.length);
  corners.forEach((v, i) => values.set(grid.points.subarray(3 * v, 3 * v + 3), 3 * i));
  return new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(values, 3));
}

const colour = (c: Colour) => new THREE.Color().setRGB(...c, THREE.LinearSRGBColorSpace);

/** The line cells of one group (or NONE); null where there are none. */
export function linesOf(grid: Grid, group: number, c: Colour): THREE.LineSegments | null {
  const corners: number[] = [];
  for (const block of grid.blocks)
    if (block.type === "line")
      for (let i = 0; i < block.num_cells; i++)
        if (block.groups[i] === group) corners.push(...cornersOf(block, i));
  if (corners.length === 0) return null;
  return new THREE.LineSegments(positions(grid, corners), new THREE.LineBasicMaterial({ color: colour(c) }));
}

export function pointsOf(grid: Grid, group: number, c: Colour): THREE.Points | null {
  const corners: number[] = [];
  for (const block of grid.blocks)
    if (block.type === "vertex")
      for (let i = 0; i < block.num_cells; i++)
        if (block.groups[i] === group) corners.push(block.vertices[rangeOf(block, i)[0]]!);
  if (corners.length === 0) return null;
  return new THREE.Points(positions(grid, corners), new THREE.PointsMaterial({ color: colour(c), size: 7, sizeAttenuation: false }));
}

/** Edges of some faces, seen through all else. */
export function outline(grid: Grid, faces: number[][], c: Colour): THREE.LineSegments {
  const corners = faces.flatMap((f) => f.flatMap((v, i) => [v, f[(i + 1) % f.length]!]));
  const material = new THREE.LineBasicMaterial({ color: colour(c), depthTest: false, transparent: true });
  const lines = new THREE.LineSegments(positions(grid, corners), material);
  lines.renderOrder = 10;
  return lines;
}

function disc(): THREE.Texture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 32;
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = "#fff";
  pen.strokeStyle = "#000";
  pen.lineWidth = 3;
  pen.beginPath();
  pen.arc(16, 16, 12, 0, 7);
  pen.fill();
  pen.stroke();
  return new THREE.CanvasTexture(canvas);
}

const SEVERITY: Record<string, number> = { error: 0xd01c1c, warning: 0xe08a00, note: 0x2f6fd0 };

/** Places as dots, edges and faces as outlines; seen through all else. */
export function markersOf(finding: Finding): THREE.Group {
  const group = new THREE.Group();
  const c = SEVERITY[finding.severity] ?? SEVERITY.note!;
  const places = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(finding.places, 3));
  const dots = new THREE.PointsMaterial({ color: c, size: 12, sizeAttenuation: false, depthTest: false, transparent: true, map: disc(), alphaTest: 0.3 });
  const points = new THREE.Points(places, dots);
  const corners: number[] = [];
  for (let i = 0; i + 1 < finding.offsets.length; i++) {
    const begin = finding.offsets[i]!, end = finding.offsets[i + 1]!;
    for (let k = begin; k < end && end - begin > 1; k++) {
      if (end - begin === 2 && k > begin) break; // an edge is no loop
      const next = k + 1 < end ? k + 1 : begin;
      for (const v of [k, next]) corners.push(finding.outlines[3 * v]!, finding.outlines[3 * v + 1]!, finding.outlines[3 * v + 2]!);
    }
  }
  const edges = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
  const lines = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: c, depthTest: false, transparent: true }));
  points.renderOrder = 12;
  lines.renderOrder = 11;
  points.frustumCulled = lines.frustumCulled = false;
  group.add(lines, points);
  return group;
}
