// SPDX-License-Identifier: Apache-2.0
// The page in a real browser (Chromium, software rendering): what it shows is what the files hold.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { delfront, endAll, fetchGrid, folder, numberOf, open, picture, serve, shot, writeMixed, writeSphere } from "./support.mjs";

const CENTRE = { x: 645, y: 320 }; // of the canvas
let server, page, facts;
const kept = async () => Number(await page.getAttribute("#cut-count", "data-kept"));
const changed = (before) => page.waitForFunction((n) => document.querySelector("#cut-count").dataset.kept !== String(n), before);

before(async () => {
  writeSphere("ball.stl");
  await delfront("mesh", "ball.stl", "-o", "ball.vtu", "--farfield", "box:4c", "-q");
  await delfront("check", "ball.vtu", "--json", "ball.json");
  facts = JSON.parse(fs.readFileSync(path.join(folder, "ball.json")));
  server = await serve("ball.vtu");
  page = await open(server.url);
});
after(async () => {
  server?.end();
  await endAll();
});

test("it shows the counts of the file, without complaint", async () => {
  assert.deepEqual(page.problems, []);
  for (const type of ["tetrahedron", "triangle"]) assert.equal(await numberOf(page, `#num-${type}`), facts.cells[type]);
  assert.equal(await numberOf(page, "#num-points"), facts.num_points);
  const names = await page.$$eval(".names li", (lines) => lines.map((line) => line.dataset.name));
  for (const group of facts.groups) assert.ok(names.includes(group.name), group.name);
  assert.equal(await kept(), facts.cells.tetrahedron);
  await shot(page, "ball");
});

test("the far field is hidden at first; names switch surfaces on and off", async () => {
  const box = page.locator('li[data-name="farfield"] input[type=checkbox]');
  const ball = page.locator('li[data-name="ball"] input[type=checkbox]').first();
  assert.equal(await box.isChecked(), false);
  assert.equal(await ball.isChecked(), true);
  const shown = await picture(page);
  await ball.uncheck();
  assert.ok((await picture(page)) !== shown);
  await shot(page, "toggle_off");
  await page.mouse.click(CENTRE.x, CENTRE.y);
  assert.equal(await page.isHidden("#info"), true); // what is hidden cannot be picked
  await ball.check();
  assert.ok((await picture(page)) === shown);
});

test("a click gives the cell that is there", async () => {
  await page.mouse.click(CENTRE.x, CENTRE.y);
  await page.waitForSelector("#info:not([hidden])");
  const cell = Number(await page.getAttribute("#info", "data-cell"));
  const text = await page.textContent("#info");
  const place = text.match(/place\(([^)]*)\)/)[1].split(", ").map(Number);
  assert.ok(Math.abs(Math.hypot(...place) - 1) < 0.03, `on the sphere: ${place}`);
  const { header, array } = await fetchGrid(server.url);
  const tets = header.blocks.find((b) => b.type === "tetrahedron"), points = array(header.points);
  const corners = [...array(tets.vertices).subarray(4 * cell, 4 * cell + 4)].map((v) => [0, 1, 2].map((k) => points[3 * v + k] + header.centre[k]));
  for (const k of [0, 1, 2]) {
    const values = corners.map((p) => p[k]);
    assert.ok(place[k] > Math.min(...values) - 1e-4 && place[k] < Math.max(...values) + 1e-4, `${place} is in cell ${cell}`);
  }
  const dihedral = array(header.measures.find((m) => m.name === "min_dihedral").values)[cell];
  assert.ok(text.includes(`smallest dihedral angle${Number(dihedral.toPrecision(4))}°`), text);
  await shot(page, "picked");
  await page.keyboard.press("Escape");
  assert.equal(await page.isHidden("#info"), true);
});

test("a cut keeps whole cells; both sides together are all", async () => {
  const all = facts.cells.tetrahedron;
  await page.click("#cut-y");
  await changed(all);
  const one = await kept();
  assert.ok(one > 0 && one < all);
  await shot(page, "cut");
  await page.keyboard.press("i");
  await changed(one);
  assert.equal(one + (await kept()), all);
  const before = await kept();
  await page.keyboard.press("Shift+}");
  await changed(before);
  const knob = await page.locator("#knob").boundingBox();
  const now = await kept();
  await page.mouse.move(knob.x + 16, knob.y + 16);
  await page.mouse.down();
  await page.mouse.move(knob.x + 56, knob.y - 24, { steps: 4 });
  await page.mouse.up();
  await changed(now);
  await page.keyboard.press("c");
  await page.waitForFunction((n) => document.querySelector("#cut-count").dataset.kept === String(n), all);
});

test("faces of a cut belong to the cells that are kept", async () => {
  await page.click("#cut-y");
  await changed(facts.cells.tetrahedron);
  await page.click("#reset");
  await page.mouse.click(CENTRE.x + 140, CENTRE.y - 10); // beside the ball: only the cut is there
  await page.waitForSelector("#info:not([hidden])");
  assert.match(await page.textContent("#info"), /typetetrahedron/);
  assert.doesNotMatch(await page.textContent("#info"), /surface/);
  const { header, array } = await fetchGrid(server.url);
  const tets = header.blocks.find((b) => b.type === "tetrahedron"), points = array(header.points), vertices = array(tets.vertices);
  for (let x = -300; x <= 300; x += 60) {
    await page.mouse.click(CENTRE.x + x, CENTRE.y - 200);
    const cell = Number(await page.getAttribute("#info", "data-cell"));
    const place = (await page.textContent("#info")).match(/place\(([^)]*)\)/)[1].split(", ").map(Number);
    const corners = [...vertices.subarray(4 * cell, 4 * cell + 4)].map((v) => [0, 1, 2].map((k) => points[3 * v + k] + header.centre[k]));
    for (const k of [0, 1, 2]) {
      const values = corners.map((p) => p[k]), slack = 0.03; // a pixel
      assert.ok(place[k] > Math.min(...values) - slack && place[k] < Math.max(...values) + slack, `${place} is at cell ${cell}`);
    }
  }
  await page.keyboard.press("Escape");
  await page.keyboard.press("c");
});

test("bars of the histogram count all cells and select theirs", async () => {
  await page.selectOption("#colour-by", "min_dihedral");
  await page.waitForSelector(".bar");
  const counts = await page.$$eval(".bar", (bars) => bars.map((bar) => Number(bar.dataset.count)));
  assert.equal(counts.reduce((a, b) => a + b), facts.cells.tetrahedron);
  const first = counts.findIndex((n) => n > 0);
  await page.click(`.bar[data-bin="${first}"]`);
  await page.waitForFunction((n) => document.querySelector("#selected-count").dataset.selected === String(n), counts[first]);
  await shot(page, "histogram");
  const other = counts.findLastIndex((n) => n > 0);
  await page.click(`.bar[data-bin="${other}"]`);
  await page.waitForFunction((n) => document.querySelector("#selected-count").dataset.selected === String(n), counts[first] + counts[other]);
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => document.querySelector("#selected-count").dataset.selected === "0");
});

test("the worst ten are the report's", async () => {
  for (const name of ["min_dihedral", "max_nonortho"]) {
    await page.selectOption("#colour-by", name);
    const lines = await page.$$eval("#worst li", (all) => all.map((li) => [Number(li.querySelector("button").dataset.cell), parseFloat(li.querySelector(".count").textContent)]));
    assert.equal(lines.length, 10);
    const measure = facts.quality.measures.find?.((m) => m.name === name) ?? facts.quality.measures[name];
    const wanted = name === "min_dihedral" ? measure.min : measure.max;
    assert.ok(Math.abs(lines[0][1] - wanted) < 1e-3 * Math.abs(wanted), `${lines[0][1]} is ${wanted}`);
    const sign = name === "min_dihedral" ? 1 : -1;
    for (let i = 1; i < 10; i++) assert.ok(sign * lines[i][1] >= sign * lines[i - 1][1]);
  }
  await page.click("#worst li button");
  await page.waitForFunction(() => document.querySelector("#selected-count").dataset.selected === "1");
  assert.equal(await page.getAttribute("#info", "data-cell"), await page.getAttribute("#worst li button", "data-cell"));
  await shot(page, "worst");
  await page.keyboard.press("Escape");
});

test("projection, edges, help and panel follow their keys", async () => {
  await page.click("#reset");
  const first = await picture(page);
  await page.keyboard.press("w");
  assert.equal(await page.getAttribute("#wireframe", "aria-pressed"), "false");
  assert.ok((await picture(page)) !== first);
  await shot(page, "edges_off");
  await page.keyboard.press("w");
  await page.keyboard.press("o");
  assert.equal(await page.textContent("#projection"), "orthographic");
  await shot(page, "orthographic");
  await page.keyboard.press("o");
  assert.equal(await page.textContent("#projection"), "perspective");
  await page.keyboard.press("?");
  assert.equal(await page.isVisible("#help"), true);
  await shot(page, "help");
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#help"), false);
  await page.keyboard.press("h");
  assert.equal(await page.isVisible("#panel"), false);
  await page.keyboard.press("h");
  assert.deepEqual(page.problems, []);
});

test("an exported page needs no server and no network", async () => {
  await delfront("view", "ball.vtu", "--export", "ball.html");
  const exported = await open("file://" + path.join(folder, "ball.html"), { offline: true });
  assert.deepEqual(exported.problems, []);
  assert.deepEqual(exported.asked.filter((url) => !/^(file|blob|data):/.test(url)), []);
  assert.equal(await numberOf(exported, "#num-tetrahedron"), facts.cells.tetrahedron);
  await exported.click("#cut-x");
  await exported.waitForFunction((n) => document.querySelector("#cut-count").dataset.kept !== String(n), facts.cells.tetrahedron);
  await exported.context().close();
});

test("defects are shown with their counts, from a file and of the surface itself", async () => {
  writeSphere("open.stl", 16, (k) => k === 100 || k === 101);
  await delfront("check", "open.stl", "--defects", "defects.vtp", "--json", "open.json").catch(() => {}); // exit code 3
  const findings = JSON.parse(fs.readFileSync(path.join(folder, "open.json"))).surface.findings;
  for (const words of [["open.stl"], ["open.stl", "defects.vtp"]]) {
    const other = await serve(...words);
    const looked = await open(other.url);
    assert.deepEqual(looked.problems, []);
    const shown = await looked.$$eval(".finding", (all) => Object.fromEntries(all.map((f) => [f.dataset.kind, Number(f.dataset.count)])));
    for (const finding of findings.filter((f) => f.severity === "error")) assert.equal(shown[finding.kind], finding.count, finding.kind);
    await shot(looked, `defects_${words.length}`);
    const withMarkers = await picture(looked);
    for (const box of await looked.locator(".finding input").all()) await box.uncheck();
    assert.ok((await picture(looked)) !== withMarkers);
    await looked.context().close();
    other.end();
  }
});

test("prisms, pyramids, hexahedra; fields on points and cells", async () => {
  writeMixed("mixed.vtu");
  const other = await serve("mixed.vtu");
  const mixed = await open(other.url);
  assert.deepEqual(mixed.problems, []);
  for (const type of ["hexahedron", "prism", "pyramid", "tetrahedron"]) assert.equal(await numberOf(mixed, `#num-${type}`), 1);
  const titles = await mixed.$$eval("#colour-by option", (all) => all.map((o) => o.textContent));
  for (const title of ["pressure", "velocity (magnitude)", "velocity [x]", "weight"]) assert.ok(titles.includes(title), title);
  await mixed.selectOption("#colour-by", { label: "pressure" });
  await shot(mixed, "mixed_pressure");
  await mixed.selectOption("#colour-by", { label: "weight" });
  const counts = await mixed.$$eval(".bar", (bars) => bars.map((bar) => Number(bar.dataset.count)));
  assert.equal(counts.reduce((a, b) => a + b), 4);
  await mixed.selectOption("#colour-by", "type");
  await shot(mixed, "mixed_types");
  assert.deepEqual(mixed.problems, []);
  await mixed.context().close();
  other.end();
});

test("a grid in the plane: cells, lines, cut, pick", async () => {
  const lens = ["lens"];
  for (const side of [1, -1])
    for (let i = 0; i < 30; i++) {
      const t = i / 30, x = side === 1 ? 1 - t : t;
      lens.push(`${x} ${side * 0.4 * x * (1 - x)}`);
    }
  fs.writeFileSync(path.join(folder, "lens.dat"), [...lens, "1 0", ""].join("\n"));
  await delfront("mesh", "lens.dat", "-o", "lens.su2", "--farfield", "circle:4c", "-q");
  const other = await serve("lens.su2");
  const plane = await open(other.url);
  assert.deepEqual(plane.problems, []);
  const all = await numberOf(plane, "#num-triangle");
  assert.ok((await numberOf(plane, "#num-line")) > 0);
  await plane.selectOption("#colour-by", "min_angle");
  await shot(plane, "plane");
  await plane.mouse.click(CENTRE.x + 150, CENTRE.y + 100);
  await plane.waitForSelector("#info:not([hidden])");
  assert.match(await plane.textContent("#info"), /typetriangle/);
  await plane.keyboard.press("x");
  await plane.waitForFunction((n) => document.querySelector("#cut-count").dataset.kept !== String(n), all);
  await shot(plane, "plane_cut");
  assert.deepEqual(plane.problems, []);
  await plane.context().close();
  other.end();
});

test("a job's progress, then its grid", async () => {
  fs.writeFileSync(path.join(folder, "run.jsonl"), '{"event":"progress","stage":"refine","done":30,"total":120,"unit":"points","seconds":1.5}\n');
  const other = await serve("later.vtu", "--job", "run.jsonl");
  const job = await open(other.url, { ready: false });
  await job.waitForSelector('.stage[data-stage="refine"]');
  assert.match(await job.textContent(".stage"), /30 of 120 points/);
  assert.match(await job.textContent("#job-state"), /running/);
  await shot(job, "job");
  fs.copyFileSync(path.join(folder, "ball.vtu"), path.join(folder, "coming.vtu"));
  fs.renameSync(path.join(folder, "coming.vtu"), path.join(folder, "later.vtu"));
  await job.waitForSelector("body[data-ready]", { state: "attached" });
  assert.equal(await numberOf(job, "#num-tetrahedron"), facts.cells.tetrahedron);
  await job.context().close();
  other.end();
});

test("names of files and groups are text, never code", async () => {
  const name = "<img src=x onerror=document.title='bad'>";
  fs.writeFileSync(path.join(folder, "names.stl"), fs.readFileSync(path.join(folder, "ball.stl"), "utf8").replaceAll("solid ball", `solid ${name}`));
  const other = await serve("names.stl");
  const names = await open(other.url);
  assert.deepEqual(names.problems, []);
  assert.equal(await names.locator("img").count(), 0);
  assert.match(await names.title(), /^names\.stl/);
  await names.context().close();
  other.end();
});
