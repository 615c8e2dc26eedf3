"""A page of 400 pixels, in a browser: no text of a table's cell lies over that of another."""

import json
import re
import shutil
import subprocess
from html import unescape

import pytest

from shipped_reports import reports_of

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
# A browser's own window is 500 pixels wide at least: the page lies in a frame of that window.
OVERLAPS = """<script>addEventListener('load', () => {
  const bad = [], text = document.createRange();
  for (const cell of document.querySelectorAll('td, th')) {
    text.selectNodeContents(cell);
    const words = text.getBoundingClientRect(), box = cell.getBoundingClientRect();
    if (words.width && (words.right > box.right + 1 || words.left < box.left - 1))
      bad.push(cell.textContent);
  }
  const found = parent.document.createElement('pre');
  found.textContent = JSON.stringify([innerWidth, document.documentElement.scrollWidth, bad]);
  parent.document.body.appendChild(found);
});</script>"""


@pytest.mark.skipif(BROWSER is None, reason="there is no Chromium here")
@pytest.mark.parametrize("network", ["kodak_kir310", "measured_mtf"])
def test_no_cell_lies_over_another(tmp_path, network):
    page = reports_of(network, tmp_path).page
    (tmp_path / "page.html").write_text(page + OVERLAPS, encoding="utf-8")
    frame = '<body><iframe src="page.html" width="400" height="3000" frameborder="0"></iframe>'
    (tmp_path / "phone.html").write_text(frame)
    words = [
        BROWSER, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
        "--allow-file-access-from-files", "--virtual-time-budget=5000",
        f"--user-data-dir={tmp_path / 'browser'}", "--dump-dom", f"file://{tmp_path}/phone.html",
    ]  # fmt: skip
    seen = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    found = re.search("<pre>(.*?)</pre>", seen, re.DOTALL)
    assert found, seen
    assert json.loads(unescape(found[1])) == [400, 400, []]
