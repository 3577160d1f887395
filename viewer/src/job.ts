// SPDX-License-Identifier: Apache-2.0
// The progress of a running job, asked for once a second.
import { byId, count, el, section } from "./dom";
import { loadJob, type JobState } from "./load";

/** @param onGrid  called whenever the job's grid has come, or a new one */
export async function followJob(panel: HTMLElement, onGrid: () => Promise<void>): Promise<boolean> {
  let state = await loadJob();
  if (!state) return false;
  const [whole, body] = section("job", "Job");
  let grids = 0;
  const step = async () => {
    try {
      state = await loadJob();
    } catch {
      byId("message").textContent = "the server has ended";
      return;
    }
    if (state) show(body, state);
    if (whole.parentElement !== panel) panel.prepend(whole);
    if (state && state.grids > grids) {
      grids = state.grids;
      await onGrid();
      panel.prepend(whole);
    }
    setTimeout(() => void step(), 1000);
  };
  panel.prepend(whole);
  void step();
  return true;
}

function show(body: HTMLElement, state: JobState): void {
  const rows = state.stages.map((s, i) => {
    const isLast = i + 1 === state.stages.length;
    const part = s.total ? Math.min(1, s.done / s.total) : isLast ? 0 : 1;
    const text = s.total ? `${count(s.done)} of ${count(s.total)} ${s.unit}` : `${count(s.done)} ${s.unit}`;
    return el("div", { class: "stage", "data-stage": s.stage }, el("span", {}, s.stage), el("span", { class: "count" }, text),
      el("div", { class: "meter" }, el("i", { style: `width:${100 * part}%` })));
  });
  const seconds = state.stages.at(-1)?.seconds;
  const head = state.error ? "failed" : state.grids ? "done" : state.has_begun ? "running" : "waiting for the job to begin";
  body.replaceChildren(el("p", { id: "job-state", class: state.error ? "error" : "note" }, head + (seconds ? `, ${seconds.toFixed(1)} s` : "")),
    ...rows, ...(state.error ? [el("p", { class: "error" }, state.error.message)] : []),
    ...state.messages.slice(-5).map((m) => el("p", { class: "note" }, m.message)));
}
