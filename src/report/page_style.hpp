// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace delfront {

/// Light, and dark where the reader's screen is; on paper always light, and no card is cut in two.
inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark; --paper: #fff; --back: #f4f6f9; --ink: #1b2430; --faint: #5d6b80; --line: #dde2ea;
  --blue: #2f6fde; --good: #18794e; --good-back: #e6f5ec; --warn: #8a5300; --warn-back: #fff3db; --bad: #b3261e;
  --bad-back: #fdeae8; --second: #8250df; }
@media screen and (prefers-color-scheme: dark) { :root { --paper: #171c24; --back: #0f1319; --ink: #e4e9f1;
  --faint: #97a4b8; --line: #2c3542; --blue: #6ea2ff; --good: #5fd39a; --good-back: #12291e; --warn: #f0b95a;
  --warn-back: #2e2412; --bad: #ff8a80; --bad-back: #351715; --second: #b79bff; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--back); color: var(--ink); font: 14px/1.45 system-ui, -apple-system, "Segoe UI", sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 20px 20px 40px; }
h1 { font-size: 20px; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 16px; margin: 0 0 10px; }
h3 { font-size: 13px; margin: 0; }
p { margin: 4px 0; }
code, .mono { font: 12px/1.5 ui-monospace, "Cascadia Mono", Menlo, Consolas, monospace; overflow-wrap: anywhere; }
section, .verdict { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 14px 18px; margin-top: 14px; }
.sub, .note { color: var(--faint); overflow-wrap: anywhere; }
.note { font-size: 12px; }
.verdict { display: flex; gap: 14px; align-items: center; border-left-width: 6px; }
.verdict .mark { font-size: 30px; line-height: 1; font-weight: 700; }
.verdict .words { font-size: 17px; font-weight: 600; overflow-wrap: anywhere; }
.verdict.good { border-color: var(--good); background: var(--good-back); } .good .mark { color: var(--good); }
.verdict.warn { border-color: var(--warn); background: var(--warn-back); } .warn .mark { color: var(--warn); }
.verdict.bad { border-color: var(--bad); background: var(--bad-back); } .bad .mark { color: var(--bad); }
.verdict p { font-weight: 400; font-size: 13px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(150px, 1fr)); gap: 10px; margin-top: 14px; }
.tile { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 9px 13px; }
.tile b { display: block; font-size: 20px; font-weight: 650; font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
.tile span { color: var(--faint); font-size: 12px; display: block; }
.tile.warn b { color: var(--warn); } .tile.bad b { color: var(--bad); } .tile.good b { color: var(--good); }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; font-size: 12px; color: var(--faint); padding: 3px 14px 3px 0; border-bottom: 1px solid var(--line); vertical-align: bottom; }
td { padding: 3px 14px 3px 0; vertical-align: top; overflow-wrap: anywhere; border-bottom: 1px solid var(--line); }
tr:last-child > td { border-bottom: none; }
.num { text-align: right; white-space: nowrap; }
td.name { font-weight: 600; } td.kind { font-weight: 600; overflow-wrap: normal; white-space: nowrap; }
table.facts { max-width: 480px; }
.wide { overflow-x: auto; }
.meter { min-width: 120px; width: 45%; }
.meter div { height: 11px; border-radius: 3px; background: var(--blue); min-width: 1px; }
.word { font-weight: 600; white-space: nowrap; }
.word.error { color: var(--bad); } .word.warning { color: var(--warn); } .word.note { color: var(--faint); font-size: inherit; }
ul { margin: 0; padding-left: 18px; } li { margin: 3px 0; overflow-wrap: anywhere; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(310px, 1fr)); gap: 16px 22px; }
figure { margin: 0; break-inside: avoid; }
figcaption { font-size: 12px; color: var(--faint); font-variant-numeric: tabular-nums; }
figcaption b { color: var(--ink); font-size: 13px; }
svg { display: block; width: 100%; height: auto; }
.chart .bar { fill: var(--blue); } .chart .bar.bad { fill: var(--bad); }
.chart .grid { stroke: var(--line); stroke-width: 1; } .chart .axis { stroke: var(--faint); stroke-width: 1; }
.chart .tick { fill: var(--faint); font-size: 10px; }
.overview img { display: block; max-width: 100%; height: auto; margin: 0 auto; }
.names span { margin-right: 12px; white-space: nowrap; } .names i { display: inline-block; width: 10px; height: 10px; border-radius: 3px; margin-right: 5px; }
.cells { display: grid; grid-template-columns: repeat(auto-fill, minmax(190px, 1fr)); gap: 14px; }
.cells figure { border: 1px solid var(--line); border-radius: 8px; padding: 8px 10px; }
.cell { max-width: 220px; margin: 0 auto 4px; overflow: hidden; }
.cell .near { stroke: var(--faint); stroke-opacity: .45; stroke-width: .8; }
.cell .fill { fill: var(--blue); fill-opacity: .22; } .cell .second { fill: var(--second); }
.cell .edge { stroke: var(--ink); stroke-width: 1.5; stroke-linecap: round; } .cell .hidden { stroke-dasharray: 3 3; stroke-width: 1; }
.cell .sharp { stroke: var(--bad); stroke-width: 3.2; stroke-linecap: round; }
.swatch { display: inline-block; width: 13px; height: 13px; border-radius: 3px; border: 1px solid var(--faint); vertical-align: -2px; margin-right: 6px; }
summary { cursor: pointer; color: var(--blue); margin-top: 8px; }
.columns { columns: 300px; column-gap: 26px; } .columns p { break-inside: avoid; margin: 1px 0; }
footer { color: var(--faint); font-size: 12px; margin-top: 18px; overflow-wrap: anywhere; }
@media (max-width: 560px) { main { padding: 12px 10px 30px; } section, .verdict { padding: 12px; } }
@media print { body { background: #fff; font-size: 11px; } main { max-width: none; padding: 0; } section, .tile, .verdict { break-inside: avoid-page; }
  section.long { break-inside: auto; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .charts { grid-template-columns: repeat(3, 1fr); } .cells { grid-template-columns: repeat(5, 1fr); } }
)css";

}  // namespace delfront
