/// Style sheet of report.html: screens from 320 pixels on, and paper.
#pragma once

#include <string>

namespace cgcontact {

inline const std::string page_style = R"css(
:root { color-scheme: light dark; --text: #1c2430; --back: #fff; --quiet: #566273; --line: #d6dde6; --strong: #c4cdd8;
  --soft: #f3f5f8; --plate: #fffe; --stage: linear-gradient(#eef2f7, #fbfcfd); --good: #e8f5ec; --doubtful: #fff5dc;
  --bad: #fdeaea; --wrong: #a01c20; }
@media screen and (prefers-color-scheme: dark) {
  :root { --text: #e4e8ee; --back: #14181e; --quiet: #9aa7b6; --line: #333c48; --strong: #4a5664; --soft: #1e242c;
    --plate: #1a2028ee; --stage: linear-gradient(#2a313b, #1b2027); --good: #173323; --doubtful: #3a2f10; --bad: #401a1c;
    --wrong: #ff9c9c; }
  img { background: #fff; border-radius: 4px; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 70rem; padding: 1rem; color: var(--text); background: var(--back);
  font: 16px/1.5 system-ui, "Segoe UI", "Helvetica Neue", "DejaVu Sans", sans-serif; overflow-wrap: anywhere; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0.5rem 0 0; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 0.6rem; padding-bottom: 0.2rem; border-bottom: 2px solid var(--line); }
h3 { font-size: 1rem; margin: 1.2rem 0 0.4rem; }
p { margin: 0.4rem 0; }
.note, figcaption { color: var(--quiet); font-size: 0.88rem; }
.verdict { margin: 1rem 0 0.6rem; padding: 0.7rem 1rem; border-left: 0.5rem solid; border-radius: 4px; }
.good { background: var(--good); border-color: #2c8a4b; }
.doubtful { background: var(--doubtful); border-color: #d99a00; }
.bad { background: var(--bad); border-color: #c0282d; }
.bad strong { color: var(--wrong); }
.warnings { margin: 0.6rem 0; padding: 0.7rem 1rem; background: var(--doubtful); border-left: 0.5rem solid #d99a00;
  border-radius: 4px; }
.warnings ul { margin: 0.2rem 0 0; padding-left: 1.2rem; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.4rem, 1fr)); gap: 0.7rem; margin: 1rem 0; }
.tile { border: 1px solid var(--line); border-radius: 6px; padding: 0.6rem 0.8rem; }
.tile span { display: block; color: var(--quiet); font-size: 0.82rem; line-height: 1.35; }
.tile b { display: block; font-size: 1.15rem; font-weight: 600; white-space: nowrap; }
figure { margin: 0.8rem 0 1.2rem; text-align: center; }
img { max-width: 100%; max-height: 56rem; height: auto; }
figcaption { text-align: left; }
.film div { display: grid; justify-items: center; }
.film img { grid-area: 1 / 1; opacity: 0; z-index: 1; }
.film img:last-child { opacity: 1; z-index: 0; }
.film:hover img { animation-play-state: paused; }
.wide { overflow-x: auto; margin: 0.6rem 0; }
table { border-collapse: collapse; font-size: 0.9rem; font-variant-numeric: tabular-nums; overflow-wrap: normal; }
th, td { padding: 0.25rem 0.55rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
thead th { color: var(--quiet); font-weight: 600; border-bottom: 2px solid var(--strong); white-space: normal;
  vertical-align: bottom; overflow-wrap: normal; }
tbody th, thead th:first-child { text-align: left; font-weight: 600; }
tbody th { max-width: 14rem; white-space: normal; overflow-wrap: anywhere; min-width: 5rem; }
td small { color: var(--quiet); }
td.text { text-align: left; white-space: normal; min-width: 14rem; }
td.bar { width: 10rem; min-width: 6rem; padding-left: 0; }
td.bar span { display: block; height: 0.75rem; background: #2070b8; border-radius: 2px; }
pre { background: var(--soft); padding: 0.7rem 1rem; border-radius: 4px; white-space: pre-wrap; font-size: 0.88rem; }
@media print {
  :root { color-scheme: light; }
  @page { margin: 15mm; }
  body { max-width: none; padding: 0; font-size: 10pt; }
  h2 { break-after: avoid; }
  figure, .tiles, .verdict, .warnings, tr { break-inside: avoid; }
  img { max-height: 16cm; }
  .wide { overflow: visible; }
  table { font-size: 8pt; }
  th, td { padding: 0.15rem 0.35rem; }
  .verdict, .warnings, td.bar span, pre { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
)css";

}  // namespace cgcontact
