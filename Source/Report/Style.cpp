// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/Style.h"

namespace excursion {

std::string_view pageStyle()
{
    return R"(:root {
  --paper: #fdfdfb; --ink: #24292f; --soft: #5d6670; --grid: #e3e5e3; --rule: #d5d8d4; --card: #ffffff;
  --measured: #1d1d1f; --model: #0072b2; --error: #d55e00; --noise: #8a8f94;
  --before: #d55e00; --after: #009e73; --reference: #8a8f94;
  --good: #00785a; --warn: #a65300; --bad: #b3261e;
}
@media (prefers-color-scheme: dark) { :root {
  --paper: #15181b; --ink: #e3e5e7; --soft: #a0a8b0; --grid: #2c3236; --rule: #363d42; --card: #1a1e22;
  --measured: #f2f2f2; --model: #56b4e9; --error: #f0883e; --noise: #8c949b;
  --before: #f0883e; --after: #2fc79a; --reference: #8c949b;
  --good: #2fc79a; --warn: #f0a35e; --bad: #ff7b72;
} }
@media print { :root {
  --paper: #fff; --ink: #111; --soft: #444; --grid: #ddd; --rule: #bbb; --card: #fff;
  --measured: #000; --model: #0072b2; --error: #d55e00; --noise: #777;
  --before: #d55e00; --after: #009e73; --reference: #777; --good: #00785a; --warn: #a65300; --bad: #b3261e;
} nav, .tools, .switches, .where { display: none !important } figure > .grid > div, tr { break-inside: avoid }
  h2, h3, h4 { break-after: avoid }
  figcaption, .note { break-before: avoid } }
* { box-sizing: border-box }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 "Source Sans 3", "Source Sans Pro", "Segoe UI", "Noto Sans", "Helvetica Neue", Arial, sans-serif }
main { max-width: 62rem; margin: 0 auto; padding: 3.5rem 1.5rem 6rem }
h1 { font-size: 1rem; font-weight: 600; color: var(--soft); letter-spacing: .02em; margin: 0 0 .4rem }
h2 { font-size: 1.55rem; line-height: 1.2; margin: 4.5rem 0 .8rem; padding-top: 1.2rem;
  border-top: 1px solid var(--rule) }
h3 { font-size: 1.1rem; margin: 2.4rem 0 .5rem }
h4 { font-size: .88rem; font-weight: 600; margin: 0 0 .15rem; color: var(--soft) }
p { max-width: 44rem; margin: .5rem 0 }
.verdict { font-size: 2.1rem; line-height: 1.22; font-weight: 650; max-width: 50rem; margin: 1.4rem 0 1.6rem;
  text-wrap: balance }
.good { color: var(--good) } .warn { color: var(--warn) } .bad { color: var(--bad) }
.note, figcaption { color: var(--soft); font-size: .9rem; max-width: 44rem }
nav { display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; font-size: .9rem }
nav a { color: var(--model); text-decoration: none } nav a:hover { text-decoration: underline }
dl { display: flex; flex-wrap: wrap; gap: .6rem 2.4rem; margin: 1.2rem 0 }
dt { color: var(--soft); font-size: .82rem } dd { margin: 0; font-variant-numeric: tabular-nums }
.wide { overflow-x: auto; margin: 1rem 0 }
table { border-collapse: collapse; font-size: .93rem; font-variant-numeric: tabular-nums; min-width: 50% }
th { text-align: left; font-weight: 600; font-size: .82rem; color: var(--soft);
  border-bottom: 1.5px solid var(--ink); vertical-align: bottom }
th, td { padding: .42rem 1.4rem .42rem 0 } th:last-child, td:last-child { padding-right: 0 }
td { border-bottom: 1px solid var(--rule); vertical-align: top }
.figure { text-align: right; white-space: nowrap }
.share { white-space: nowrap }
.bar { display: inline-block; width: 7rem; height: .62rem; margin-right: .6rem; background: var(--grid);
  border-radius: 2px; overflow: hidden }
.bar i { display: block; height: 100%; background: var(--model); print-color-adjust: exact;
  -webkit-print-color-adjust: exact }
figure { margin: 1.4rem 0 2rem }
.grid { display: grid; gap: 1.4rem 1.6rem; grid-template-columns: 1fr } .columns1 { max-width: 40rem }
@media (min-width: 46rem) { .columns2 { grid-template-columns: 1fr 1fr }
  .columns3 { grid-template-columns: 1fr 1fr 1fr } }
@media print { .columns2, .columns3 { grid-template-columns: 1fr 1fr } }
figcaption { margin-top: .7rem }
.plot, .live > svg { display: block; width: 100%; height: auto } .plot text, .plot g { font-family: inherit }
[hidden] { display: none !important }
.picture { min-width: 0 } .picture.large { grid-column: 1 / -1 } .columns1:has(.large) { max-width: none }
.picture h4 { display: flex; justify-content: space-between; align-items: center; gap: .6rem; min-height: 1.6rem }
.live { display: none }
@media screen { .alive > .plot { display: none } .alive > .live { display: block } }
@media print { .touched > .plot { display: none } .touched > .live { display: block } }
.live > svg { touch-action: pan-y; cursor: crosshair; user-select: none; -webkit-user-select: none;
  outline-offset: 2px }
.live text { font-size: 12px; fill: var(--ink) } .labels { font-variant-numeric: tabular-nums }
.gridlines { stroke: var(--grid); fill: none } .border { stroke: var(--ink); stroke-width: .8; fill: none }
.cursor { pointer-events: none } .cursor path { stroke: var(--soft); stroke-dasharray: 3 3 }
.frame { fill: var(--model); fill-opacity: .14; stroke: var(--model) }
button { font: inherit; color: inherit; background: none; border: 0; padding: 0; cursor: pointer; border-radius: 3px }
button:focus-visible, .live > svg:focus-visible { outline: 2px solid var(--model) }
.tools { display: flex; flex: none; gap: .1rem; opacity: .45 } .picture:hover .tools, .tools:focus-within { opacity: 1 }
.tools button { width: 1.6rem; height: 1.6rem; padding: .25rem } .tools button:hover { background: var(--grid) }
.tools svg { display: block; width: 100%; fill: none; stroke: currentColor; stroke-width: 1.5 }
.key { display: grid; grid-template-columns: repeat(auto-fill, minmax(10rem, 1fr)); gap: 0 .8rem; font-size: .82rem;
  line-height: 1.45; margin-bottom: .2rem }
.key button { display: flex; align-items: baseline; gap: .4rem; min-width: 0; text-align: left }
.key .name { flex: 1 1 auto; min-width: 0; overflow: hidden; text-overflow: ellipsis; white-space: nowrap }
.key output { font-variant-numeric: tabular-nums; white-space: nowrap } .key .value { font-weight: 600 } 
.live { position: relative } .where { position: absolute; right: 10px; margin-top: 2px; padding: 0 .3rem;
  font-size: .82rem; color: var(--soft); background: var(--paper); opacity: .9; pointer-events: none;
  font-variant-numeric: tabular-nums }
.key [aria-pressed=false] { opacity: .45; text-decoration: line-through }
  .swatch { flex: none; width: 20px; height: 8px; align-self: center }
.switches { font-size: .88rem; margin: .8rem 0 1.2rem }
  .switches div { display: flex; flex-wrap: wrap; align-items: baseline; gap: .35rem .5rem; margin: .35rem 0 }
.switches span { color: var(--soft); margin-right: .2rem; display: inline-block }
  .switches span::first-letter { text-transform: uppercase }
.switches button { border: 1px solid var(--rule); padding: .1rem .6rem; color: var(--soft) }
  .switches [aria-pressed=true] { border-color: var(--model); color: var(--ink); background: var(--card) }
.switches [aria-pressed=true]::before { content: "\2713\202f"; color: var(--model) }
@media (pointer: coarse) { .tools { opacity: 1 } .tools button { width: 2.2rem; height: 2.2rem; padding: .5rem }
  .key button { min-height: 1.9rem; align-items: center } .switches button { padding: .4rem .7rem } }
@media print { main { padding: 0; max-width: none } h2 { margin-top: 2rem } .verdict { font-size: 1.7rem }
  .wide { overflow: visible }
  table { font-size: .78rem } th { font-size: .72rem } th, td { padding: .3rem .8rem .3rem 0 }
  .many, h2:has(+ .many) { page: many } .many table { font-size: .5rem } .many th { font-size: .5rem }
  .many th, .many td { padding: .2rem .35rem .2rem 0 } }
@page many { size: landscape }
@media screen and (max-width: 40rem) { main { padding: 1.6rem 1rem 4rem } .verdict { font-size: 1.5rem }
  h2 { font-size: 1.3rem; margin-top: 3rem } th, td { padding-right: .9rem } td:first-child { min-width: 6.5rem }
  td:last-child:not(.figure, .share) { min-width: 12rem } }
)";
}

}  // namespace excursion
