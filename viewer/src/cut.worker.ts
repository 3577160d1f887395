// SPDX-License-Identifier: Apache-2.0
// The neighbours are found and the cut is made beside the page, which stays fluid.
import type { Grid } from "./grid";
import { Topology, type Plane } from "./topology";

export type Question =
  | { id: number; ask: "begin"; grid: Grid }
  | { id: number; ask: "cut"; plane: Plane | null; hidden: Set<number> }
  | { id: number; ask: "border"; kept: Uint8Array };

let topology: Topology | null = null;

self.onmessage = (event: MessageEvent<Question>) => {
  const question = event.data;
  try {
    if (question.ask === "begin") {
      topology = new Topology(question.grid);
      return self.postMessage({ id: question.id, answer: topology.owners });
    }
    if (!topology) throw new Error("no grid yet");
    const answer =
      question.ask === "cut" ? topology.cut(question.plane, question.hidden) : topology.borderOf(question.kept, true);
    const buffers = [answer.triangles.buffer, answer.cells.buffer, answer.shown.buffer] as Transferable[];
    self.postMessage({ id: question.id, answer }, { transfer: buffers });
  } catch (error) {
    self.postMessage({ id: question.id, error: String(error) });
  }
};
