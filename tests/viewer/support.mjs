// SPDX-License-Identifier: Apache-2.0
// What the tests of the page share: the program, a browser, small inputs, the data as the server sends them.
import { execFile, spawn } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { promisify } from "node:util";

const root = path.resolve(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname), "../..");
const require = createRequire(path.join(root, "viewer", "package.json"));
const { chromium } = require("playwright-core");
export const DELFRONT = process.env.DELFRONT ?? "delfront";
export const folder = fs.mkdtempSync(path.join(os.tmpdir(), "delfront_viewer_"));
const shots = process.env.DELFRONT_SCREENSHOTS ?? folder;

/** Run the program in the tests' folder; throws where it fails. */
export async function delfront(...words) {
  return (await promisify(execFile)(DELFRONT, words, { cwd: folder, timeout: 300000 })).stdout;
}

let browser = null;
export async function openBrowser() {
  browser ??= await chromium.launch({
    executablePath: process.env.DELFRONT_CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
    timeout: 180000,
  });
  return browser;
}

const servers = [];
/** Serve a file until `end`, or until all ends. */
export async function serve(...words) {
  const child = spawn(DELFRONT, ["view", ...words, "--no-browser"], { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
  servers.push(child);
  let said = "";
  child.stderr.on("data", (text) => (said += text));
  const url = await new Promise((resolve, reject) => {
    let text = "";
    child.stdout.on("data", (piece) => {
      text += piece;
      if (text.includes("\n")) resolve(text.trim());
    });
    child.on("exit", (code) => reject(new Error(`delfront view ended with ${code}: ${said}`)));
  });
  return { url, end: () => child.kill("SIGINT") };
}

/** A page that must not complain. */
export async function open(url, { offline = false, ready = true } = {}) {
  const context = await (await openBrowser()).newContext({ viewport: { width: 1000, height: 640 }, offline });
  const page = await context.newPage();
  page.setDefaultTimeout(120000);
  page.problems = [];
  page.asked = [];
  page.on("pageerror", (error) => page.problems.push(String(error)));
  page.on("console", (message) => message.type() === "error" && page.problems.push(message.text()));
  page.on("request", (request) => page.asked.push(request.url()));
  await page.goto(url);
  if (ready) await page.waitForSelector("body[data-ready], body[data-failed]", { state: "attached" });
  return page;
}

const isDrawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** What is drawn, without panel and mouse. */
export async function picture(page) {
  await isDrawn(page);
  return page.evaluate(() => document.getElementById("canvas").toDataURL());
}

/** Keep a picture of all of the window, to look at. */
export async function shot(page, name) {
  await isDrawn(page);
  return page.screenshot({ path: path.join(shots, `${name}.png`) });
}

export const numberOf = async (page, selector) => Number((await page.textContent(selector)).replaceAll(",", ""));

/** The data that the server sends, read without the page's own code. */
export async function fetchGrid(url) {
  const bytes = await (await fetch(url + "grid")).arrayBuffer();
  const size = new DataView(bytes).getUint32(8, true);
  const header = JSON.parse(Buffer.from(bytes, 16, size).toString());
  const array = (at) => new (at.type === "f4" ? Float32Array : Uint32Array)(bytes, 16 + size + at.offset, at.length);
  return { header, array };
}

export async function endAll() {
  for (const child of servers) child.kill("SIGKILL");
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
}

/** A sphere of triangles about the origin as ASCII STL; some triangles may be left out. */
export function writeSphere(name, rings = 16, isLeftOut = () => false) {
  const point = (i, j) => {
    const a = (Math.PI * i) / rings, b = (2 * Math.PI * j) / (2 * rings);
    if (i === 0 || i === rings) return [0, 0, i === 0 ? 1 : -1];
    return [Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b), Math.cos(a)];
  };
  const triangles = [];
  for (let i = 0; i < rings; i++)
    for (let j = 0; j < 2 * rings; j++) {
      const next = (j + 1) % (2 * rings);
      const [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, next), point(i, next)];
      if (i + 1 < rings) triangles.push([a, b, c]);
      if (i > 0) triangles.push([a, c, d]);
    }
  const kept = triangles.filter((_, k) => !isLeftOut(k));
  const facet = (t) => `facet normal 0 0 0\nouter loop\n${t.map((p) => `vertex ${p.join(" ")}`).join("\n")}\nendloop\nendfacet`;
  fs.writeFileSync(path.join(folder, name), `solid ball\n${kept.map(facet).join("\n")}\nendsolid ball\n`);
  return kept.length;
}

/** Hexahedron, prism, pyramid and tetrahedron that touch, with a value on each. */
export function writeMixed(name) {
  const points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [0.5, 0.5, 2], [2, 0, 0.5], [2, 1, 0.5], [0.5, -0.5, 2]];
  const cells = [[12, [0, 1, 2, 3, 4, 5, 6, 7]], [14, [4, 5, 6, 7, 8]], [13, [1, 5, 9, 2, 6, 10]], [10, [4, 5, 8, 11]]];
  let end = 0;
  const array = (type, label, values, n = 1) => `<DataArray type="${type}" Name="${label}" NumberOfComponents="${n}" format="ascii">${values.join(" ")}</DataArray>`;
  fs.writeFileSync(path.join(folder, name), `<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="${points.length}" NumberOfCells="${cells.length}">
<PointData>${array("Float64", "pressure", points.map((p) => p[2]))}${array("Float64", "velocity", points.flatMap((p) => [p[0], p[1], 0]), 3)}</PointData>
<CellData>${array("Float64", "weight", [1, 2, 3, 4])}</CellData>
<Points>${array("Float64", "Points", points.flat(), 3)}</Points>
<Cells>${array("Int64", "connectivity", cells.flatMap((c) => c[1]))}${array("Int64", "offsets", cells.map((c) => (end += c[1].length)))}${array("UInt8", "types", cells.map((c) => c[0]))}</Cells>
</Piece></UnstructuredGrid></VTKFile>\n`);
}
