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
} nav { display: none } figure > .grid > div, tr { break-inside: avoid } h2, h3, h4 { break-after: avoid } }
* { box-sizing: border-box }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 "Source Sans 3", "Source Sans Pro", "Segoe UI", "Noto Sans", "Helvetica Neue", Arial, sans-serif }
main { max-width: 62rem; margin: 0 auto; padding: 3.5rem 1.5rem 6rem }
h1 { font-size: 1rem; font-weight: 600; color: var(--soft); letter-spacing: .02em; margin: 0 0 .4rem }
h2 { font-size: 1.55rem; line-height: 1.2; margin: 4.5rem 0 .8rem; padding-top: 1.2rem; border-top: 1px solid var(--rule) }
h3 { font-size: 1.1rem; margin: 2.4rem 0 .5rem }
h4 { font-size: .88rem; font-weight: 600; margin: 0 0 .15rem; color: var(--soft) }
p { max-width: 44rem; margin: .5rem 0 }
.verdict { font-size: 2.1rem; line-height: 1.22; font-weight: 650; max-width: 50rem; margin: 1.4rem 0 1.6rem; text-wrap: balance }
.good { color: var(--good) } .warn { color: var(--warn) } .bad { color: var(--bad) }
.note, figcaption { color: var(--soft); font-size: .9rem; max-width: 44rem }
nav { display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; font-size: .9rem }
nav a { color: var(--model); text-decoration: none } nav a:hover { text-decoration: underline }
dl { display: flex; flex-wrap: wrap; gap: .6rem 2.4rem; margin: 1.2rem 0 }
dt { color: var(--soft); font-size: .82rem } dd { margin: 0; font-variant-numeric: tabular-nums }
.wide { overflow-x: auto; margin: 1rem 0 }
table { border-collapse: collapse; font-size: .93rem; font-variant-numeric: tabular-nums; min-width: 50% }
th { text-align: left; font-weight: 600; font-size: .82rem; color: var(--soft); border-bottom: 1.5px solid var(--ink); vertical-align: bottom }
th, td { padding: .42rem 1.4rem .42rem 0 } th:last-child, td:last-child { padding-right: 0 }
td { border-bottom: 1px solid var(--rule); vertical-align: top }
.figure { text-align: right; white-space: nowrap }
.share { white-space: nowrap }
.bar { display: inline-block; width: 7rem; height: .62rem; margin-right: .6rem; background: var(--grid); border-radius: 2px; overflow: hidden }
.bar i { display: block; height: 100%; background: var(--model); print-color-adjust: exact; -webkit-print-color-adjust: exact }
figure { margin: 1.4rem 0 2rem }
.grid { display: grid; gap: 1.4rem 1.6rem; grid-template-columns: 1fr } .columns1 { max-width: 40rem }
@media (min-width: 46rem), print { .columns2 { grid-template-columns: 1fr 1fr } .columns3 { grid-template-columns: 1fr 1fr 1fr } }
figcaption { margin-top: .7rem }
.plot { display: block; width: 100%; height: auto } .plot text, .plot g { font-family: inherit }
)";
}

}  // namespace excursion
