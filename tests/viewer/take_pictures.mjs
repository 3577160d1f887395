// SPDX-License-Identifier: Apache-2.0
// The pictures of docs/viewer.md (scripts/viewer_pictures).
import { endAll, open, serve, shot } from "./support.mjs";

const server = await serve(process.argv[2]);
try {
  const page = await open(server.url);
  await page.click("#cut-y");
  await page.waitForTimeout(3000);
  await shot(page, "viewer_cut");
  await page.selectOption("#colour-by", "min_dihedral");
  await page.mouse.click(560, 150);
  await page.waitForSelector("#info:not([hidden])");
  await shot(page, "viewer_quality");
} finally {
  server.end();
  await endAll();
}
