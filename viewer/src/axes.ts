// SPDX-License-Identifier: Apache-2.0
// The three directions in the corner, as the camera sees them.
import * as THREE from "three";

const COLOURS = ["#d0312d", "#2a8a3e", "#2563eb"];

export function drawAxes(canvas: HTMLCanvasElement, camera: THREE.Camera, isPlane: boolean): void {
  const pen = canvas.getContext("2d")!;
  const size = canvas.width, middle = size / 2, reach = 0.33 * size;
  pen.clearRect(0, 0, size, size);
  const turn = camera.matrixWorldInverse;
  const axes = [0, 1, 2].filter((k) => !isPlane || k < 2).map((k) => {
    const d = new THREE.Vector3().setComponent(k, 1).transformDirection(turn);
    return { k, x: d.x, y: -d.y, depth: d.z };
  });
  axes.sort((a, b) => a.depth - b.depth); // far ones first
  pen.lineWidth = 5;
  pen.font = "600 26px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  for (const { k, x, y } of axes) {
    pen.strokeStyle = pen.fillStyle = COLOURS[k]!;
    pen.beginPath();
    pen.moveTo(middle, middle);
    pen.lineTo(middle + reach * x, middle + reach * y);
    pen.stroke();
    pen.fillText("xyz"[k]!, middle + 1.3 * reach * x, middle + 1.3 * reach * y);
  }
}
