// SPDX-License-Identifier: Apache-2.0
// Colours as [r, g, b] in 0 … 1, sRGB.
export type Colour = [number, number, number];

const hex = (text: string): Colour => [0, 2, 4].map((i) => parseInt(text.slice(i, i + 2), 16) / 255) as Colour;

/** Of groups: apart from one another also for those who see red and green alike (Okabe and Ito, lightened). */
const GROUPS = ["8fb7d9", "e9b872", "86c5a4", "d99a8b", "b3a3d6", "d9cf7a", "9fc3c9", "d6a0bd", "a9b88a", "c2a98c"].map(hex);
export const CELL_TYPES: Record<string, Colour> = {
  triangle: hex("8fb7d9"), quad: hex("e9b872"), tetrahedron: hex("8fb7d9"), pyramid: hex("d99a8b"), prism: hex("86c5a4"),
  hexahedron: hex("e9b872"), polyhedron: hex("b3a3d6"), polygon: hex("b3a3d6"),
};
export const groupColour = (index: number): Colour => GROUPS[index % GROUPS.length]!;
export const SELECTED: Colour = hex("ff6a00");

const VIRIDIS = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"].map(hex);
/** Bad to good: red, yellow, blue (ColorBrewer's RdYlBu). */
const QUALITY = ["a50026", "d73027", "f46d43", "fdae61", "fee090", "e0f3f8", "abd9e9", "74add1", "4575b4"].map(hex);

export type MapName = "values" | "low_is_bad" | "high_is_bad";

export function colourAt(map: MapName, t: number): Colour {
  const stops = map === "values" ? VIRIDIS : QUALITY;
  const at = Math.min(1, Math.max(0, map === "high_is_bad" ? 1 - t : t)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(at)), part = at - i;
  return [0, 1, 2].map((k) => stops[i]![k]! * (1 - part) + stops[i + 1]![k]! * part) as Colour;
}

export const css = (c: Colour): string => `rgb(${c.map((x) => Math.round(255 * x)).join(",")})`;
export const toHex = (c: Colour): string => "#" + c.map((x) => Math.round(255 * x).toString(16).padStart(2, "0")).join("");
export const fromHex = (text: string): Colour => hex(text.slice(1));
