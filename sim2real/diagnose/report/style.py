"""How the report looks: dark on light, one column, readable on a phone and on paper."""

CSS = """
:root { --ink: #1a1a1a; --soft: #555; --line: #d5d5d5; --before: #D55E00; --after: #0072B2; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 62rem; background: #fff; color: var(--ink);
  font: 16px/1.5 system-ui, sans-serif; overflow-wrap: anywhere; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0.2rem 0 0.6rem; }
h2 { font-size: 1.25rem; margin: 2rem 0 0.5rem; border-top: 2px solid var(--ink); padding-top: 0.5rem; }
h3 { font-size: 1.05rem; margin: 1.2rem 0 0.3rem; }
.verdict { color: var(--soft); margin: 0; text-transform: uppercase; letter-spacing: 0.05em; font-size: 0.85rem; }
ul.next { border-left: 4px solid var(--after); padding: 0.1rem 0.8rem 0.1rem 1.8rem; background: #f2f7fb; }
dl.glossary { display: grid; grid-template-columns: max-content 1fr; gap: 0 0.8rem; margin: 0.4rem 0;
  font-size: 0.9rem; color: var(--soft); }
dl.glossary dt { font-weight: 600; } dl.glossary dd { margin: 0; }
.open { border-left: 4px solid var(--before); padding: 0.1rem 0.8rem; background: #fdf5ef; }
code.law { display: block; background: #f5f5f5; padding: 0.5rem 0.8rem; margin: 0.4rem 0; white-space: pre-wrap; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: 0.6rem 0 1rem; font-size: 0.93rem; overflow-wrap: normal; }
caption { text-align: left; font-weight: 600; padding-bottom: 0.2rem; }
th, td { text-align: left; padding: 0.2rem 0.9rem 0.2rem 0; border-bottom: 1px solid var(--line);
  vertical-align: top; font-weight: 400; }
thead th { border-bottom: 2px solid var(--soft); color: var(--soft); }
.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
figure { margin: 0.5rem 0; break-inside: avoid; }
svg { display: block; width: 100%; height: auto; }
figcaption { color: var(--soft); font-size: 0.88rem; max-width: 40rem; }
.panels { display: grid; grid-template-columns: repeat(auto-fill, minmax(18rem, 1fr)); gap: 0.4rem 1rem; }
.maps { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 30rem)); gap: 0.4rem 1rem; }
.curve svg { max-width: 46rem; }
svg.bars { max-width: 36rem; }
.before { color: var(--before); font-weight: 600; } .after { color: var(--after); font-weight: 600; }
details { margin: 0.4rem 0; } summary { cursor: pointer; }
.panels svg { max-width: 26rem; }
@media (max-width: 40rem) { table { font-size: 0.8rem; } td { overflow-wrap: anywhere; }
  th, td { padding-right: 0.5rem; } .n { white-space: normal; }
  figure { overflow-x: auto; } .curve svg { min-width: 30rem; } svg.bars { min-width: 26rem; } }
@media print { .panels { grid-template-columns: 1fr 1fr; }
  body { font-size: 11pt; max-width: none; padding: 0; }
  h2, h3, caption { break-after: avoid; }
  tr { break-inside: avoid; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
"""
