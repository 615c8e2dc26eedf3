"""Typography of the HTML report."""

CSS = """
:root { color-scheme: light; }
body { margin: 0; background: #fff; color: #1c1c1c;
  font: 15px/1.5 "Helvetica Neue", Helvetica, Arial, "DejaVu Sans", sans-serif; }
main { max-width: 1000px; margin: 0 auto; padding: 2.2rem 1.4rem 3rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.25rem; margin: 2.4rem 0 .7rem; padding-bottom: .25rem;
  border-bottom: 1px solid #c8c8c8; }
h3 { font-size: 1rem; margin: 1.4rem 0 .35rem; }
h3 small { color: #777; font-weight: normal; margin-left: .35em; }
p { margin: .5rem 0; }
.lead { font-size: 1.05rem; max-width: 46rem; }
.run { color: #666; font-size: .85rem; }
.warnings { margin: 1.2rem 0; padding: .1rem 1rem .5rem; border-left: 4px solid #d98200;
  background: #fff6e5; }
.warnings h2 { margin: .6rem 0 .3rem; border: 0; padding: 0; font-size: 1.05rem; }
.warnings span { color: #555; }
figure { margin: .9rem 0; }
img { display: block; max-width: 100%; height: auto; }
figcaption { color: #555; font-size: .85rem; margin-top: .35rem; }
table { border-collapse: collapse; width: 100%; margin: .6rem 0; font-size: .86rem;
  font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; color: #555; border-bottom: 1.5px solid #999; }
th, td { padding: .25rem .9rem .25rem 0; vertical-align: top; }
td { border-bottom: 1px solid #e6e6e6; overflow-wrap: break-word; }
td:last-child, th:last-child { padding-right: 0; }
.n { text-align: right; white-space: nowrap; }
td.good { color: #1a7a33; white-space: nowrap; }
td.bad { color: #b3261e; white-space: nowrap; }
table.readouts { table-layout: fixed; }
.readouts th:nth-child(1) { width: 12rem; }
.readouts th:nth-child(2) { width: 9rem; }
.readouts th:nth-child(3) { width: 6rem; }
.wide { overflow-x: auto; }
.economy th:nth-child(1) { width: 28%; }
.economy th:nth-child(2) { width: 29%; }
.published td { overflow-wrap: normal; }
.published td:nth-child(1) { min-width: 7rem; }
.published td:nth-child(2) { min-width: 5rem; }
.published td:nth-child(5) { white-space: nowrap; }
.published td:nth-child(7) { min-width: 13rem; }
@media (max-width: 700px) {
  main { padding: 1.2rem .8rem; }
  .published { font-size: .78rem; }
  .published thead, .published tbody { display: block; }
  .published tr { display: grid; border-bottom: 1px solid #e6e6e6;
    grid-template-columns: 2fr 1.7fr 2.6fr 1.7fr 1.4fr 1.9fr; }
  .published tr td { min-width: 0; border: 0; padding-right: .5rem; }
  .published tr th { min-width: 0; border: 0; padding-right: .5rem; }
  .published td:nth-child(7) { grid-column: 1 / -1; color: #555; }
  .published td:nth-child(7):empty, .published th:nth-child(7) { display: none; }
  .published td.n, .published td.good, .published td.bad { white-space: normal; }
  .readouts th:nth-child(1) { width: 10rem; }
  .readouts th:nth-child(2) { width: 6rem; }
  .readouts th:nth-child(3) { width: 5rem; }
}
ul { padding-left: 1.2rem; }
@media print {
  body { font-size: 10.5pt; }
  main { max-width: none; padding: 0; }
  figure, tr { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
}
"""
