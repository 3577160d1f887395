// SPDX-License-Identifier: Apache-2.0
import type { Grid } from "./grid";
import CutWorker from "./cut.worker?worker&inline";
import type { CutResult, Plane } from "./topology";

type Waiting = { resolve: (answer: never) => void; reject: (error: Error) => void };

/** Asks the worker; of cuts that were asked for while one is made only the last is made. */
export class Cutter {
  private worker = new CutWorker();
  private waiting = new Map<number, Waiting>();
  private lastId = 0;
  private isCutting = false;
  private next: (() => void) | null = null;

  constructor() {
    this.worker.onmessage = (event) => {
      const { id, answer, error } = event.data;
      const who = this.waiting.get(id);
      this.waiting.delete(id);
      if (error) who?.reject(new Error(error));
      else who?.resolve(answer as never);
    };
    this.worker.onerror = (event) => this.waiting.forEach((who) => who.reject(new Error(event.message)));
  }

  private ask<T>(question: object): Promise<T> {
    const id = ++this.lastId;
    this.worker.postMessage({ ...question, id });
    return new Promise<T>((resolve, reject) => this.waiting.set(id, { resolve, reject } as Waiting));
  }

  /** @returns the cells on both sides of each stored face */
  begin(grid: Grid): Promise<Uint32Array> {
    const { points, blocks } = grid; // values and names stay here
    return this.ask({ ask: "begin", grid: { points, blocks } });
  }

  /** @returns null where a later question has taken its place */
  async cut(plane: Plane | null, hidden: ReadonlySet<number>): Promise<CutResult | null> {
    if (this.isCutting) {
      this.next?.();
      const isStillAsked = await new Promise<boolean>((resolve) => {
        const skip = () => resolve(false);
        this.next = skip;
        this.go = () => resolve(true);
      });
      if (!isStillAsked) return null;
    }
    this.isCutting = true;
    try {
      return await this.ask<CutResult>({ ask: "cut", plane, hidden });
    } finally {
      this.isCutting = false;
      this.next = null;
      this.go();
    }
  }

  private go: () => void = () => {};

  /** All faces round a set of cells. */
  border(kept: Uint8Array): Promise<CutResult> {
    return this.ask({ ask: "border", kept });
  }
}
