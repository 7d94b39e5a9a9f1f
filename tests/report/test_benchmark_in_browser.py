"""The page of a benchmark in a real browser: whole without network, readable on a phone, contrast enough."""

from pathlib import Path

import numpy as np
import pytest

from tests.browser import BROWSER, Browser, Seen
from tests.evaluate.made_outcomes import outcomes
from vision_robot.evaluate.sweep import Cell, Outcome
from vision_robot.report.benchmark import benchmark_page
from vision_robot.report.film_strip import film_strip
from vision_robot.report.page import write_page

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine")

METHODS = {
    "optical-flow": 0.7,
    "optical-flow-plain": 0.4,
    "rgb": 0.9,
    "rgb-plain": 0.6,
    "background": 0.8,
    "background-plain": 0.7,
    "cv2-mog2": 0.5,
    "cv2-csrt": 0.7,
    "rgb:min_area_px=x0.5": 0.5,
    "rgb:min_area_px=x2": 0.85,
}
SCENES = {"many-objects": 0.0, **{f"noise={s:g}": 0.5 * s for s in (0, 0.25, 0.5, 1)}}

CONTRAST = """(() => {
  const linear = c => { c /= 255; return c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
  const light = c => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
  const parts = text => { const n = text.match(/[0-9.]+/g).map(Number); return [...n, 1].slice(0, 4); };
  const behind = e => { for (; e; e = e.parentElement) { const c = parts(getComputedStyle(e).backgroundColor);
    if (c[3] > 0) return c; } return [255, 255, 255, 1]; };
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode, e = node.parentElement, style = getComputedStyle(e);
    if (!node.textContent.trim() || !e.getClientRects().length) continue;
    const front = parts(e.ownerSVGElement ? style.fill : style.color);
    const [a, b] = [light(front), light(behind(e.ownerSVGElement ? e.ownerSVGElement.parentElement : e))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const m = e.ownerSVGElement ? e.getScreenCTM() : {a: 1, b: 0};
    const px = parseFloat(style.fontSize) * Math.hypot(m.a, m.b);
    found.push({text: node.textContent.trim().slice(0, 40), ratio, px});
  }
  return found;
})()"""

OUTSIDE = """(() => [...document.querySelectorAll("svg text")].filter(t => {
  const [a, b] = [t.getBoundingClientRect(), t.ownerSVGElement.getBoundingClientRect()];
  return a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 1 || a.bottom > b.bottom + 1;
}).map(t => t.textContent))()"""

OVERLAPPING = """(() => { const bad = [];
for (const svg of document.querySelectorAll("svg")) {
  const boxes = [...svg.querySelectorAll("text")].map(t => [t.textContent, t.getBoundingClientRect()]);
  for (let i = 0; i < boxes.length; i++) for (let j = 0; j < i; j++) {
    const [a, b] = [boxes[i][1], boxes[j][1]];
    const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
    const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
    if (wide > 1.5 && high > 3) bad.push(boxes[i][0] + " on " + boxes[j][0]);
  }
} return bad; })()"""


def made() -> list[Outcome]:
    """A large page: strips, a dial, variants, a failure, times, names of eighteen letters."""
    rng, found = np.random.default_rng(0), list[Outcome]()
    for scene, loss in SCENES.items():
        figures = {
            name: list(level - loss * level + rng.normal(0, 0.03, 12)) for name, level in METHODS.items()
        }
        found += outcomes(figures, "success_auc", scene)
    frame = rng.integers(0, 255, (60, 80, 3), dtype=np.uint8)
    box = np.array([[20.0, 20.0, 30.0, 15.0]])
    strip = film_strip([frame] * 5, [box] * 5, [box + 4.0] * 5, names=[f"frame {k}" for k in range(5)])
    for k in range(3):
        one = found[k]
        found[k] = Outcome(one.cell, one.figures, None, 0.1, 1, strip, "a machine, 2 cores", 0.1)
    hung = "PeerFailed: it did not answer within 60 s and was ended " + "x" * 150
    found.append(Outcome(Cell("trackers", "noise=1", "cv2-kcf", 0, "m:f"), {}, hung, 60, 1))
    for name in list(METHODS)[:8]:
        cell = Cell("trackers", "many-objects", name, 0, "m:f", {"timed": 1}, alone=True)
        found.append(
            Outcome(cell, {"latency_p50_ms": 3.3, "fps": 301.0}, None, 1.0, 1, None, "a machine", 0.98)
        )
    return found


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("page") / "benchmark.html"
    command = "vr benchmark trackers --seeds 12 --report benchmark.html"
    write_page(benchmark_page("trackers", made(), metric="success_auc", command=command, seed=0), path)
    return path


@pytest.fixture(scope="module")
def browser():
    with Browser() as opened:
        yield opened


@pytest.fixture(scope="module", params=[360, 1200])
def shown(request, browser, page) -> tuple[Browser, Seen, int]:
    return browser, browser.load(page, width=request.param), request.param


def test_it_asks_for_nothing_and_complains_of_nothing(shown, page):
    _, seen, _ = shown
    assert seen.complaints == []
    assert [one for one in seen.requests if not one.startswith("data:")] == [page.as_uri()]


def test_nothing_is_wider_than_the_window(shown):
    browser, _, width = shown
    assert browser.run("document.documentElement.scrollWidth") == width
    # What is wider moves inside a box of its own, which a keyboard reaches.
    boxes = browser.run(
        "[...document.querySelectorAll('.scroll')].map(e => [e.clientWidth, e.tabIndex, !!e.ariaLabel || "
        "!!e.getAttribute('aria-labelledby')])"
    )
    assert boxes
    assert all(wide <= width and index == 0 and named for wide, index, named in boxes)


def test_text_has_the_contrast_of_wcag_aa_and_a_size_to_read(shown):
    browser, _, _ = shown
    found = browser.run(CONTRAST)
    assert len(found) > 200
    assert [one for one in found if one["ratio"] < 4.5] == []
    assert [one for one in found if one["px"] < 8.5] == []


def test_drawings_are_whole_and_no_word_stands_on_another(shown):
    browser, _, _ = shown
    assert browser.run("document.querySelectorAll('svg').length") >= 8
    assert browser.run(OUTSIDE) == []
    assert browser.run(OVERLAPPING) == []


def test_pictures_are_shown_and_everything_has_words_for_the_blind(shown):
    browser, _, _ = shown
    widths = browser.run("[...document.images].map(i => i.naturalWidth)")
    assert len(widths) == 3
    assert min(widths) > 900
    assert browser.run("[...document.images].every(i => i.alt.length > 10)")
    assert browser.run("[...document.querySelectorAll('svg')].every(s => s.ariaLabel.length > 10)")


def test_the_answer_comes_first_and_failures_next(shown):
    browser, _, _ = shown
    titles = browser.run("[...document.querySelectorAll('h2')].map(h => h.textContent)")
    assert titles[:2] == ["Answer", "Failures"]
    for title in (
        "Where methods break",
        "Ranks",
        "Film strips",
        "Sensitivity",
        "Power",
        "How it was measured",
    ):
        assert title in titles
    assert "success_auc than every other method" in browser.run(
        "document.querySelector('.remarks').textContent"
    )


def test_the_first_column_stays_while_a_table_moves(browser, page):
    browser.load(page, width=360)
    moved = browser.run(
        "(() => { const box = [...document.querySelectorAll('.scroll')].find(e => e.scrollWidth > "
        "e.clientWidth + 50 && e.querySelector('.pinned')); box.scrollLeft = 50; const cell = "
        "box.querySelector('td'); return [box.scrollLeft, cell.getBoundingClientRect().left - "
        "box.getBoundingClientRect().left]; })()"
    )
    assert moved == [50, 0]
