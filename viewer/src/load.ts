// SPDX-License-Identifier: Apache-2.0
// Where the data come from: the page itself (an exported file), or the server that sent it.
import { parseGrid, type Grid } from "./grid";

async function inflate(text: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** @returns null where the server has no grid yet */
export async function loadGrid(): Promise<Grid | null> {
  const inside = document.getElementById("delfront-data");
  if (inside) return parseGrid(await inflate(inside.textContent!.trim()));
  const answer = await fetch("grid", { cache: "no-store" });
  if (answer.status === 404) return null;
  if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
  return parseGrid(await answer.arrayBuffer());
}

export interface StageEvent {
  stage: string;
  done: number;
  total: number;
  unit: string;
  seconds: number;
}

export interface JobState {
  stages: StageEvent[];
  messages: { event: string; level?: string; message: string }[];
  error: { message: string; exit_code: number } | null;
  has_begun: boolean;
  has_ended: boolean;
  grids: number; // that were loaded so far
}

/** @returns null where no job is shown */
export async function loadJob(): Promise<JobState | null> {
  if (document.getElementById("delfront-data")) return null;
  const answer = await fetch("progress", { cache: "no-store" });
  return answer.ok ? ((await answer.json()) as JobState) : null;
}
