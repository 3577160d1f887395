// SPDX-License-Identifier: Apache-2.0
// Names come from files: text is only ever set as text.
type Props = Partial<Record<string, string | number | boolean | ((e: Event) => void)>>;

export function el(tag: string, props: Props = {}, ...children: (Node | string)[]): HTMLElement {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (typeof value === "boolean") made.toggleAttribute(name, value);
    else if (value !== undefined) made.setAttribute(name, String(value));
  }
  made.append(...children);
  return made;
}

export function section(id: string, title: string, isOpen = true): [HTMLElement, HTMLElement] {
  const body = el("div", { class: "body" });
  const whole = el("details", { id, open: isOpen }, el("summary", {}, title), body);
  return [whole, body];
}

export const byId = (id: string): HTMLElement => document.getElementById(id)!;
export const count = (n: number): string => n.toLocaleString("en-US");

/** Four digits; more where the places ask for them. */
export function number(v: number, digits = 4): string {
  if (Number.isNaN(v)) return "–";
  if (!Number.isFinite(v)) return v > 0 ? "∞" : "−∞";
  if (v === 0) return "0";
  const size = Math.abs(v);
  return size >= 1e6 || size < 1e-3 ? v.toExponential(digits - 1) : String(Number(v.toPrecision(digits)));
}
