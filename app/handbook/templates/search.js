"use strict";
// Finds pages by words of their titles and texts, or by their synonyms; WORDS and SYNONYMS come
// from words.js, so that it works without a server. The contents fold on a narrow screen only.
const root = document.body.dataset.root;
const contents = document.getElementById("contents");
const field = document.getElementById("search");
const hits = document.getElementById("hits");
const wide = window.matchMedia("(min-width: 801px)");
const unfold = () => { contents.open = wide.matches; };
wide.addEventListener("change", unfold);
unfold();
const here = contents.querySelector(".here");
if (wide.matches && here) here.scrollIntoView({ block: "nearest" });

const plain = text => text.toLocaleLowerCase("en").normalize("NFD").replace(/[\u0300-\u036f]/g, "");
const pages = WORDS.map(([address, title, lead, text]) => (
  { address, title, lead, text, low: plain(text), heads: plain(title) }));

function found(query) {
  const typed = plain(query).split(/\s+/).filter(Boolean);
  if (!typed.length) return [];
  const others = typed.map(word => SYNONYMS[word] || word);
  const ranked = [...having(others), ...having(typed)].sort((a, b) => b[0] - a[0]);
  const seen = new Set();
  return ranked.filter(([, page]) => !seen.has(page) && seen.add(page)).slice(0, 14);
}

function having(words) {
  const ranked = [];
  for (const page of pages) {
    let score = 0;
    for (const word of words) {
      const inTitle = page.heads.indexOf(word), inText = page.low.indexOf(word);
      if (inTitle < 0 && inText < 0) { score = 0; break; }
      if (inTitle === 0) score += 60; else if (inTitle > 0) score += 40;
      if (page.heads === word) score += 60;
      score += Math.min(page.low.split(word).length - 1, 12);
    }
    if (score) ranked.push([score, page, words]);
  }
  return ranked;
}

function excerpt(page, words) {
  const at = page.low.indexOf(words[0]);
  if (at < 0 || plain(page.lead).includes(words[0])) return page.lead;
  const from = Math.max(0, page.text.lastIndexOf(" ", Math.max(0, at - 50)) + 1);
  return (from ? "… " : "") + page.text.slice(from, at + 110) + " …";
}

function show() {
  const list = found(field.value);
  hits.replaceChildren();
  hits.hidden = !field.value.trim();
  for (const [, page, words] of list) {
    const item = document.createElement("li"), link = document.createElement("a");
    const title = document.createElement("b"), text = document.createElement("small");
    link.href = root + page.address;
    title.textContent = page.title;
    text.textContent = excerpt(page, words);
    link.append(title, text);
    item.append(link);
    hits.append(item);
  }
  if (!list.length && field.value.trim()) {
    const none = document.createElement("p");
    none.textContent = "No page has these words.";
    hits.append(none);
  }
  choose(0);
}

let chosen = 0;
function choose(place) {
  const items = [...hits.children];
  chosen = Math.max(0, Math.min(place, items.length - 1));
  items.forEach((item, at) => item.classList.toggle("on", at === chosen));
  if (items[chosen]) items[chosen].scrollIntoView({ block: "nearest" });
}
field.addEventListener("input", show);
field.addEventListener("keydown", event => {
  if (event.key === "ArrowDown") choose(chosen + 1);
  else if (event.key === "ArrowUp") choose(chosen - 1);
  else if (event.key === "Escape") { field.value = ""; show(); }
  else if (event.key === "Enter") {
    const link = hits.children[chosen] && hits.children[chosen].querySelector("a");
    if (link) location.href = link.href;
  } else return;
  event.preventDefault();
});
document.addEventListener("keydown", event => {
  if (event.key === "/" && document.activeElement !== field) { field.focus(); event.preventDefault(); }
});
document.addEventListener("click", event => { if (!event.target.closest("form")) hits.hidden = true; });
const asked = new URLSearchParams(location.search).get("q");
if (asked) { field.value = asked; show(); field.focus(); }

// The file that is awaited is there once the figures are drawn; a script is what a page of a local
// folder may look for.
const awaited = document.body.dataset.awaited;
function lookAgain() {
  const script = document.createElement("script");
  script.src = `${root}${awaited}?${Date.now()}`;
  script.onload = () => { if (field.value.trim()) setTimeout(lookAgain, 2000); else location.reload(); };
  script.onerror = () => { script.remove(); setTimeout(lookAgain, 2000); };
  document.head.append(script);
}
if (awaited) setTimeout(lookAgain, 2000);
