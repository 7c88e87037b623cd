"""Opens reports in a browser and checks what their users see.

    apt-get install chromium
    cargo build --release -p emmy-cli
    python3 tests/browser/report.py target/release/emmy

With `--picture FILE` it also writes the picture of the README.
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time

from chromium import Chromium, colours, pixels

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
RUNS = {
    "l-block": ["examples/l-block.toml", "--set", "time.scheme=DGM"],
    "newmark": ["examples/l-block.toml", "--set", "time.scheme=Newmark(0.25,0.5)"],
    "spring-network": ["examples/spring-network.toml", "--set", "output.format=vtkhdf"],
    "comet": ["examples/comet.toml"],
    "two-materials": ["examples/two-materials.toml"],
    "four-bar": ["examples/four-bar.toml"],
    "charts-only": ["examples/plane-beam.toml", "--set", "output.every=0"],
}


def shown(text):
    """A number as a page shows it, and half a unit of its last digit."""
    text = re.sub(r"[\s\u202f]", "", text).removesuffix("s")
    mantissa = text.lower().split("e")[0].lstrip("-").replace(".", "")
    value = float(text)
    digits = len(mantissa.lstrip("0")) or 1
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1) if value else 0.0
    return value, 0.5 * unit


def check_numbers(page, summaries):
    """Every number that the page says is of a summary is that number, as far as it is shown."""
    items = page.value("[...document.querySelectorAll('[data-key]')].map(e => [e.dataset.run, e.dataset.key, e.textContent])")
    assert len(items) >= 10, items
    for run, key, text in items:
        expected = summaries[run][key]
        if isinstance(expected, str):
            assert text == expected, (key, text, expected)
            continue
        value, half = shown(text)
        assert abs(value - expected) <= half * (1 + 1e-9), (run, key, text, expected)
    parts = page.value("[...document.querySelectorAll('[data-part]')].map(e => [e.dataset.run ?? '', e.dataset.part, e.textContent])")
    for run, key, text in parts:
        summary = summaries[run or next(iter(summaries))]
        largest = summary["largest_energy" if key == "energy" else f"largest_{key}"]
        scale = summary.get(f"{key}_scale", 0.0)
        size = scale if largest < 1e-9 * scale else largest
        value, half = shown(text)
        assert abs(value - summary[f"worst_{key}_residual"] / size) <= half * (1 + 1e-9), (run, key, text)
    return len(items) + len(parts)


def words(page):
    return page.value("[...document.querySelectorAll('.balance:not(.accuracy) .word')].map(e => e.textContent)")


def time_shown(page):
    return float(page.value("document.querySelector('#transport output b').textContent"))


def check_motion(page):
    """The body is there, moves with the cursor, and turns with the mouse."""
    page.press("Home", "Home")
    start = page.picture("#viewport")
    assert colours(start) > 300, f"the scene has {colours(start)} colours"
    assert page.value("document.getElementById('scene').dataset.frame") == "0"
    for _ in range(5):
        page.press("ArrowRight")
    assert page.value("document.getElementById('scene').dataset.frame") == "5"
    moved = page.picture("#viewport")
    assert moved != start, "the scene does not change when the time does"
    x, y, width, height = page.box("#viewport")
    page.drag([(x + width / 2, y + height / 2), (x + width / 2 + 80, y + height / 2 + 30)])
    page.settle()
    assert page.picture("#viewport") != moved, "the scene does not turn"
    # A click into a chart moves the time to where it was.
    left, top, wide, high = page.box(".chart .u-over")
    page.drag([(left + wide / 2, top + high / 2)])
    now = page.value("(s => Number(s.value))(document.querySelector('#transport input'))")
    assert abs(now - 5000) < 50, now


def check_keyboard(page, end):
    page.press("End")
    assert abs(time_shown(page) - end) <= 1e-4 * end
    page.press("ArrowLeft")
    assert time_shown(page) < end
    page.press("Home")
    assert time_shown(page) == 0.0
    label = "document.querySelector('#transport .play').getAttribute('aria-label')"
    assert page.value(label).startswith("Play")
    page.press(" ", "Space", " ")
    page.wait(f"{label}.startsWith('Pause') && Number(document.querySelector('#transport output b').textContent) > 0", 10)
    page.press(" ", "Space", " ")
    page.wait(f"{label}.startsWith('Play')", 10)
    stopped = time_shown(page)
    time.sleep(0.3)
    assert time_shown(page) == stopped, "it plays on after a pause"
    page.press("Tab")
    assert page.value("document.activeElement.matches(':focus-visible')"), "the focus is not to be seen"


def check_names(page):
    """Everything that can be worked has a name for those who do not see it."""
    nameless = page.value(
        "[...document.querySelectorAll('button, select, input, canvas[role], a')].filter(e => "
        "!(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length)).map(e => e.outerHTML.slice(0, 120))"
    )
    assert nameless == [], nameless


def check_layout(page):
    """Nothing stands out of the page to the right, and no chart is empty."""
    wide = page.value("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert wide <= 0, f"{wide} pixels too wide"
    heights = page.value("[...document.querySelectorAll('.plot .u-over')].map(e => e.clientHeight)")
    assert heights and min(heights) > 40, heights


# Boxes of the lines of text in the head of the page, with the text.
HEAD_LINES = """[...document.querySelectorAll('.page-head, #verdict')].flatMap(place => {
  const walker = document.createTreeWalker(place, NodeFilter.SHOW_TEXT), found = [];
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const r of range.getClientRects()) if (node.data.trim()) found.push([node.data, r.left, r.top, r.right, r.bottom]);
  }
  return found;
})"""


def check_head(page):
    """No line of text in the head lies on another one, or out of its frame."""
    lines = page.value(HEAD_LINES)
    left, _, width, _ = page.box("#verdict > *")
    assert len(lines) > 15, lines
    for i, (text, x0, y0, x1, y1) in enumerate(lines):
        assert x0 >= left - 1 and x1 <= left + width + 1, f"{text!r} stands out of the head"
        for other, u0, v0, u1, v1 in lines[:i]:
            # Line boxes of one paragraph touch; real overlaps are deeper.
            wide, high = min(x1, u1) - max(x0, u0), min(y1, v1) - max(y0, v0)
            assert wide <= 1 or high <= 4, f"{text!r} lies on {other!r}"


def check_long_numbers(browser, emmy, source, directory):
    """The head has room for the numbers of a large run, at every width."""
    os.makedirs(directory)
    for name in ["input.toml", "history.csv"]:
        open(f"{directory}/{name}", "w").write(open(f"{source}/{name}").read())
    summary = json.load(open(f"{source}/summary.json"))
    summary |= {"cells": 1291, "nodes": 2749, "dofs": 1_234_567, "wall_seconds": 32.6, "steps": 100_000,
                "newton_iterations": 1_234_567, "scheme": "generalized-alpha(0.85)"}
    json.dump(summary, open(f"{directory}/summary.json", "w"))
    subprocess.run([emmy, "report", directory], check=True, stdout=subprocess.DEVNULL)
    for width in [360, 400, 720, 721, 1000, 1001, 1119, 1120, 1300, 1920, 2560]:
        page = browser.page(f"{directory}/report.html", width=width, height=900)
        check_head(page)
        check_layout(page)
        page.close()


def check_windows(browser, directory):
    """The motion is in sight at once, and in a high window no column ends half-way down."""
    for width, height in [(1300, 900), (1300, 1600), (1080, 1920), (1366, 768), (1440, 1300), (1920, 1080), (2560, 1440)]:
        page = browser.page(f"{directory}/report.html", width=width, height=height)
        check_head(page)
        check_layout(page)
        _, top, _, high = page.box("#viewer")
        bar = page.box("#transport")[1]
        assert top + high <= bar, f"{width} x {height}: the motion ends at {top + high}, behind the bar at {bar}"
        for part in [0.25, 0.75]:
            # One of two points may lie in the gap between two charts.
            x, y = part * width, bar - 50
            at = f"[{y}, {y + 25}].some(y => document.elementFromPoint({x}, y)?.closest('.chart, .viewer'))"
            assert page.value(at), f"{width} x {height}: nothing at {x}, {y}"
        # Charts end where the motion beside them ends, or below it.
        lowest = page.value("Math.max(...[...document.querySelectorAll('.chart')].map(e => e.getBoundingClientRect().bottom))")
        assert lowest >= top + high - 2, f"{width} x {height}: the charts end at {lowest}, the motion at {top + high}"
        plots = page.value("[...document.querySelectorAll('.plot')].map(e => e.clientHeight - e.querySelector('.uplot').clientHeight)")
        assert max(map(abs, plots)) <= 1, f"{width} x {height}: plots do not fill their places: {plots}"
        page.close()
    page = browser.page(f"{directory}/report.html", width=360, height=740)
    check_head(page)
    check_layout(page)
    assert page.box("#viewport")[3] >= 320
    page.close()


def check_whole_body(browser, directory):
    """The body fits into pictures of any shape. The background is light."""
    for width, height in [(1440, 1300), (1300, 900), (1366, 768), (800, 1200), (390, 844)]:
        page = browser.page(f"{directory}/report.html", width=width, height=height)
        page.value("scrollTo(0, document.querySelector('#viewport').getBoundingClientRect().top - 10)")
        page.value("['triad', 'legend', 'scene-note', 'transport'].forEach(id => { document.getElementById(id).style.visibility = 'hidden'; })")
        # The arrow of the angular momentum may reach out of the picture.
        page.value("[...document.querySelectorAll('.viewer-tools label')].find(e => e.textContent === 'Angular momentum').click()")
        for step in ["Home", "End"]:
            page.press(step)
            rows, size = pixels(page.picture("#viewport"))
            edge = [row[size * x:size * x + 3] for row in rows for x in [2, 3, -4, -3]]
            edge += [row[size * x:size * x + 3] for row in [rows[2], rows[3], rows[-4], rows[-3]] for x in range(len(row) // size)]
            assert all(sum(pixel) > 300 for pixel in edge if pixel), f"{width} x {height}: the body is cut off"
        page.close()


def check_range(browser, directory):
    """The colours span the values of the run, and those of the frame after a click at the scale. The second frame is hardly stressed."""
    page = browser.page(f"{directory}/report.html")
    page.press("Home")
    ends = f"({ENDS})[0]"
    page.press("ArrowRight")
    of_run, picture = page.value(ends), page.picture("#viewport")
    chosen = "document.querySelector('#legend button[aria-pressed=true]').textContent"
    click(page, "#legend button:last-child")
    assert page.value(chosen) == "frame"
    of_frame = page.value(ends)
    assert float(of_frame[-1]) < 0.5 * float(of_run[-1]), (of_frame, of_run)
    assert page.picture("#viewport") != picture, "the colours do not change with their range"
    # The choice stays while the motion plays.
    for _ in range(5):
        page.press("ArrowRight")
    later = page.value(ends)
    assert page.value(chosen) == "frame" and later not in (of_frame, of_run), (later, of_frame, of_run)
    click(page, "#legend button:first-child")
    assert page.value(chosen) == "run" and page.value(ends) == of_run
    check_silence(page)
    page.close()


# Ends and middles of the scales of the colours: typed limits, or automatic ones.
ENDS = "[...document.querySelectorAll('#legend .ends')].map(row => [...row.children].map(e => e.value || e.placeholder || e.textContent))"


def check_limits(browser, directory):
    """Typed limits of the colours are those of the scale; a wrong text is shown as wrong, and the limit is automatic."""
    page = browser.page(f"{directory}/report.html")
    page.press("Home")
    page.press("ArrowRight")
    automatic, picture = page.value(ENDS), page.picture("#viewport")
    wrong = "[...document.querySelectorAll('#legend .ends input')].map(e => e.getAttribute('aria-invalid') === 'true')"
    limits = "document.querySelectorAll('#legend .ends input')"
    scale = "document.querySelector('#legend .scale').getBoundingClientRect().bottom"
    below = page.value(scale)

    def type_limit(place, text):
        page.value(f"(e => {{ e.value = {text!r}; e.dispatchEvent(new Event('input', {{ bubbles: true }})); }})({limits}[{place}])")
        page.settle()

    body = lambda: page.picture("#viewport")
    upper = float(automatic[0][2])
    type_limit(1, str(upper / 100))
    [[low, middle, high]] = page.value(ENDS)
    assert (low, float(high)) == (automatic[0][0], upper / 100), (low, high)
    value, half = shown(middle)
    assert abs(value - (float(low) + float(high)) / 2) <= half + shown(low)[1], (low, middle, high)
    # The body is stressed by more than a hundredth of the largest stress of the run: the colours go to the upper end.
    typed = body()
    assert differ(typed, picture) and page.value(wrong) == [False, False]
    for place, text in [(1, "much"), (1, "1,5"), (0, str(2 * upper))]:
        type_limit(1, "")
        type_limit(place, text)
        expected = [place == 0, place == 1]
        assert page.value(wrong) == expected, (text, page.value(wrong))
        assert not differ(body(), picture), f"{text}: the limits are not the automatic ones"
    type_limit(0, "")
    assert page.value(ENDS) == automatic and page.value(wrong) == [False, False]
    # Keys in the field are letters of its text, not commands of the page; the limit stays with its field.
    now = time_shown(page)
    click(page, "#legend .ends input:last-child")
    for letter in "2.5":
        page.press(letter, text=letter)
    assert time_shown(page) == now and page.value(ENDS)[0][2] == "2.5", page.value(ENDS)
    colour_by(page, "speed")
    assert page.value(ENDS)[0][2] != "2.5"
    colour_by(page, "von_mises_stress")
    assert page.value(ENDS)[0][2] == "2.5" and page.value(scale) == below
    check_silence(page)
    page.close()


def colour_by(page, field):
    page.value(f"(s => {{ s.value = '{field}'; s.dispatchEvent(new Event('change')); }})(document.querySelector('[aria-label=\"Colour by\"]'))")


def coloured(page):
    """Points of the picture with a colour of the scale: background, lines and outlines are grey."""
    rows, size = pixels(page.picture("#viewport"))
    at = lambda row, x: row[size * x:size * x + 3]
    return {(x, y) for y, row in enumerate(rows) for x in range(len(row) // size) if max(at(row, x)) - min(at(row, x)) > 45}


def bare(browser, directory):
    """A page whose picture has nothing but the body, seen along z, coloured by displacement."""
    page = browser.page(f"{directory}/report.html")
    page.value("['triad', 'legend'].forEach(id => { document.getElementById(id).style.visibility = 'hidden'; })")
    page.value("[...document.querySelectorAll('.viewer-tools label')].filter(e => e.textContent === 'Angular momentum').forEach(e => e.click())")
    colour_by(page, "displacement")
    click(page, ".views button:nth-child(3)")
    return page


def check_regions(browser, directory, stiff, soft):
    """Regions are hidden and shown one by one; each has a range of its own."""
    page = bare(browser, directory)
    label = lambda name: f".regions [data-region=\"{name}\"]"

    def seen(*regions):
        for name in [stiff, soft]:
            if page.value(f"document.querySelector('{label(name)} input').checked") != (name in regions):
                click(page, label(name))
        page.settle()
        return coloured(page)

    page.press("End")
    both, of_stiff, of_soft, none = seen(stiff, soft), seen(stiff), seen(soft), seen()
    assert none == set(), f"{len(none)} points of hidden regions"
    assert min(len(of_stiff), len(of_soft)) > 0.3 * len(both), (len(of_stiff), len(of_soft), len(both))
    # Each point of the body is of one region, but for the line where they meet.
    lost, twice = both - of_stiff - of_soft, of_stiff & of_soft
    assert len(lost) < 0.01 * len(both) and len(twice) < 0.05 * len(both), (len(lost), len(twice), len(both))
    assert len(seen(stiff, soft) ^ both) < 0.01 * len(both)
    summary = json.load(open(f"{directory}/summary.json"))
    [[low, _, high]] = page.value(ENDS)
    largest = summary["largest_displacement"]
    assert low == "0" and abs(float(high) - largest) <= shown(high)[1] * (1 + 1e-3), (high, largest)
    click(page, ".regions > label:last-child")
    titles = page.value("[...document.querySelectorAll('#legend .scale')].map(e => e.dataset.title)")
    assert titles == [stiff, soft], titles
    of_regions = page.value(ENDS)
    assert of_regions[0][0] == "0" and of_regions[1][2] == high, of_regions
    assert 0 < float(of_regions[0][2]) < float(high), of_regions
    # A limit of a region leaves the other one as it is.
    page.value("(e => { e.value = '7'; e.dispatchEvent(new Event('input')); })(document.querySelectorAll('#legend .ends input')[1])")
    limited = page.value(ENDS)
    assert limited[0][2] == "7" and limited[1] == of_regions[1], limited
    # With one region in sight the common range is that of this region.
    click(page, ".regions > label:last-child")
    seen(stiff)
    assert page.value(ENDS) == [of_regions[0]], (page.value(ENDS), of_regions)
    check_names(page)
    check_layout(page)
    check_silence(page)
    page.close()


def check_section(browser, directory, axis, middle):
    """A section cuts the body away beyond its plane, and shows the body from inside."""
    page = bare(browser, directory)
    page.press("Home")
    text = lambda: page.value("[...document.querySelectorAll('.viewer-tools span')].map(e => e.textContent).find(text => text.includes('≤'))")

    def cut(axis, at=None):
        page.value(f"(s => {{ s.value = '{axis}'; s.dispatchEvent(new Event('change')); }})(document.querySelector('[aria-label=\"Section across\"]'))")
        if at is not None:
            page.value(f"(s => {{ s.value = {at}; s.dispatchEvent(new Event('input')); }})(document.querySelector('[aria-label^=\"Position of the section\"]'))")
        page.settle()
        return coloured(page)

    assert page.value("document.querySelector('[aria-label^=\"Position of the section\"]').hidden")
    half = cut(axis)
    assert text().startswith(f"{axis} ≤ {middle}"), text()
    whole = cut(axis, 1000)
    assert text().startswith(f"{axis} ≤ {2 * middle}"), text()
    # Seen along z half of the length is left: that with the smaller coordinates. The ends of the other half are grey outlines.
    assert 0.45 < len(half) / len(whole) < 0.55, len(half) / len(whole)
    assert len(half - whole) < 0.01 * len(half), len(half - whole)
    assert max(x for x, _ in half) < sum(x for x, _ in whole) / len(whole) + 2
    assert len(cut(axis, 250)) < 0.6 * len(half)
    # From the side that is cut away one looks into the body, and sees its sides and its far end from inside: no hole.
    click(page, ".views button:nth-child(1)")
    inside = cut(axis, 500)
    wide, high = [max(own) - min(own) + 1 for own in zip(*inside)]
    assert len(inside) > 0.9 * wide * high > 5000, (len(inside), wide, high)
    check_names(page)
    check_silence(page)
    page.close()


def check_film(browser, directory, place):
    """The film that the button saves is a WebM that moves; a browser without a recorder says so."""
    os.makedirs(place)
    browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=place)
    page = browser.page(f"{directory}/report.html")
    button = "document.querySelector('.film')"
    assert not page.value(f"{button}.disabled"), page.value(f"{button}.title")
    # At the start all of the body has one colour.
    colour_by(page, "displacement")
    page.value("(s => { s.value = '4'; s.dispatchEvent(new Event('change')); })(document.querySelector('[aria-label=Speed]'))")
    click(page, ".film")
    assert page.value(f"{button}.textContent") == "Stop film"
    page.wait(f"{button}.textContent === 'Save film'", 180)
    assert page.value("Number(document.querySelector('#transport input').value)") == 10000, "the film ends before the motion"
    film = f"{place}/{os.path.basename(directory)}.webm"
    end = time.time() + 20
    while not os.path.exists(film):
        assert time.time() < end, os.listdir(place)
        time.sleep(0.1)
    check_silence(page)
    page.close()
    assert open(film, "rb").read(4) == b"\x1aE\xdf\xa3"
    open(f"{place}/film.html", "w").write(f"<html data-ready=true><video muted src={os.path.basename(film)}></video>")
    page = browser.page(f"{place}/film.html")
    video = "document.querySelector('video')"
    page.wait(f"{video}.readyState >= 2", 20)
    first = page.picture("video")
    assert colours(first) > 300, colours(first)
    page.value(f"{video}.playbackRate = 4, {video}.play()")
    page.wait(f"{video}.ended", 30)
    assert differ(page.picture("video"), first), "the film does not move"
    assert page.value(f"{video}.currentTime") > 1, page.value(f"{video}.currentTime")
    page.close()
    page = browser.page(f"{directory}/report.html", before="delete window.MediaRecorder")
    assert page.value(f"{button}.disabled") and "MediaRecorder" in page.value(f"{button}.title")
    check_silence(page)
    page.close()


def check_phone(browser, directory):
    """The first screen of a phone shows the picture, the verdict follows, then the charts."""
    for width, height in [(360, 740), (390, 844), (414, 896)]:
        page = browser.page(f"{directory}/report.html", width=width, height=height)
        order = ["#viewport", "#viewer-tools", "#verdict", "#charts", "#details", "#foot"]
        tops = [page.box(part)[1] for part in order]
        assert tops == sorted(tops), list(zip(order, tops))
        _, top, _, high = page.box("#viewport")
        bar = page.box("#transport")[1]
        assert 0 < top and top + high <= bar, f"{width} x {height}: the picture is at {top} to {top + high}, the bar at {bar}"
        check_head(page)
        check_layout(page)
        check_names(page)
        page.close()


def click(page, selector):
    x, y, width, height = page.box(selector)
    page.drag([(x + width / 2, y + height / 2)])


def check_probe(browser, directory, name):
    """A probe's chart begins at zero and ends at the displacement of the history; a click shows the position."""
    rows = open(f"{directory}/history.csv").read().splitlines()
    head, cells = rows[0].split(","), [row.split(",") for row in rows[1:]]
    column = lambda axis: [float(row[head.index(f"{name}_{axis}")]) for row in cells]
    page = browser.page(f"{directory}/report.html")
    values = f"[...document.querySelectorAll('[aria-label=\"Probe {name}\"] .key .value')].map(e => e.textContent)"
    page.press("Home")
    assert page.value(values) == ["0", "0", "0"], page.value(values)
    page.press("End")
    for axis, text in zip("xyz", page.value(values)):
        value, half = shown(text)
        expected = column(axis)[-1] - column(axis)[0]
        assert abs(value - expected) <= half * (1 + 1e-9), (axis, text, expected)
    chart = f"[aria-label=\"Probe {name}\"]"
    page.value(f"document.querySelector('{chart}').scrollIntoView()")
    click(page, f"{chart} .switch button:last-child")
    for axis, text in zip("xyz", page.value(values)):
        value, half = shown(text)
        assert abs(value - column(axis)[-1]) <= half * (1 + 1e-9), (axis, text, column(axis)[-1])
    check_silence(page)
    page.close()


def check_quantities(browser, emmy, source, directory):
    """Other columns have charts: components of one quantity together, the start of reactions is a gap."""
    os.makedirs(directory)
    open(f"{directory}/summary.json", "w").write(open(f"{source}/summary.json").read())
    text = open(f"{source}/input.toml").read()
    # A value whose name begins like a probe's.
    values = '[output]\nvalues = [{ name = "tip_energy", quantity = "strain_energy_density", measure = "total" }]\n'
    assert "\n[output]\n" in text
    open(f"{directory}/input.toml", "w").write(text.replace("[output]\n", values, 1))
    lines = open(f"{source}/history.csv").read().splitlines()
    force = [f"z-min_force_{axis}" for axis in "xyz"]
    tensor = [f"tip_cauchy_stress_{part}" for part in ["xx", "yy", "zz", "xy", "yz", "xz"]]
    rows = [",".join([lines[0], *force, *tensor, "max_displacement", "energy_of_beam", "tip_energy"])]
    for step, line in enumerate(lines[1:]):
        rows.append(",".join([line, *([str(k * step) for k in [2, 3, 6]] if step else [""] * 3), *map(str, range(6)), str(0.1 * step), "7", "8"]))
    open(f"{directory}/history.csv", "w").write("\n".join(rows) + "\n")
    subprocess.run([emmy, "report", directory], check=True, stdout=subprocess.DEVNULL)
    page = browser.page(f"{directory}/report.html")
    keys = lambda title: page.value(f"[...document.querySelectorAll('[aria-label=\"{title}\"] .key')].map(e => e.textContent)")
    page.press("Home")
    assert keys("Reaction force of z-min") == ["Fx–", "Fy–", "Fz–", "|F|–"], keys("Reaction force of z-min")
    page.press(".")
    assert keys("Reaction force of z-min") == ["Fx2", "Fy3", "Fz6", "|F|7"], keys("Reaction force of z-min")
    assert keys("Largest displacement") == ["max_displacement0.10000"] and keys("energy_of_beam") == ["energy_of_beam7"]
    assert keys("tip_energy") == ["tip_energy8"], keys("tip_energy")
    probes = page.value("[...document.querySelectorAll('[aria-label=\"Probe tip\"]')].map(e => e.querySelectorAll('.key').length)")
    assert probes == [3, 6], probes
    check_names(page)
    check_layout(page)
    check_silence(page)
    page.close()


def check_extremes(browser, directory):
    """The largest displacement has its time, which a click shows, and its place."""
    summary = json.load(open(f"{directory}/summary.json"))
    page = browser.page(f"{directory}/report.html")
    click(page, ".extremes button")
    assert abs(time_shown(page) - summary["largest_displacement_time"]) <= 1e-4 * summary["time"]
    place = page.value("document.querySelector('.extremes').textContent")
    for x in summary["largest_displacement_point"]:
        assert any(abs(x - value) <= half for value, half in map(shown, re.search(r"\((.*?)\)", place)[1].split(", "))), (x, place)
    page.close()


def check_mechanism(browser, directory, joints):
    """Joints have charts, and rings in the scene that move with the bodies; constraints are shown with their rounding."""
    page = browser.page(f"{directory}/report.html")
    charts = page.value("[...document.querySelectorAll('section.chart')].map(e => e.getAttribute('aria-label'))")
    assert all(any(joint in chart for chart in charts) for joint in joints), charts
    keys = page.value("[...document.querySelectorAll('[aria-label=\"Constraints\"] .key')].map(e => e.textContent)")
    assert len(keys) == 2 and keys[1].startswith("rounding"), keys
    page.press("Home")
    start = rings(page)
    # Two rings of the cranks' heads lie on each other.
    assert len(start) > 6 * 60, len(start)
    for _ in range(5):
        page.press("ArrowRight")
    assert rings(page) != start, "the rings do not move"
    check_numbers(page, {os.path.basename(directory): json.load(open(f"{directory}/summary.json"))})
    check_names(page)
    check_layout(page)
    check_silence(page)
    page.close()


def rings(page):
    """Points of the picture with the colour of the rings at joints."""
    ink = page.value("getComputedStyle(document.body).getPropertyValue('--c2').trim()")
    ink = bytes.fromhex(ink[1:])
    rows, size = pixels(page.picture("#viewport"))
    return {(x, y) for y, row in enumerate(rows) for x in range(len(row) // size) if row[size * x:size * x + 3] == ink}


def check_silence(page):
    # Reading pixels back for a picture may be slow with a renderer in software; that is not of the page.
    complaints = [text for text in page.complaints() if "GPU stall due to ReadPixels" not in text]
    assert complaints == [], complaints


def check_single(browser, directory, expects, has_motion=True):
    summary = json.load(open(f"{directory}/summary.json"))
    page = browser.page(f"{directory}/report.html")
    n = check_numbers(page, {os.path.basename(directory): summary})
    found = words(page)
    assert len(found) == 3 and all(word in expects for word in found), found
    accuracy = page.value("document.querySelector('.accuracy .word')?.textContent ?? null")
    assert accuracy == summary["accuracy_in_time"], accuracy
    assert page.value("document.querySelectorAll('.chart').length") >= 7
    if has_motion:
        check_motion(page)
    else:
        assert page.value("document.getElementById('viewer').hidden")
    check_keyboard(page, summary["time"])
    check_names(page)
    check_layout(page)
    check_silence(page)
    page.close()
    for width in [400, 800, 1920]:
        page = browser.page(f"{directory}/report.html", width=width, height=900)
        check_layout(page)
        check_silence(page)
        page.close()
    return n


def check_schemes(browser, directory):
    """Dark where the reader has it dark; it moves by itself unless the reader wants no motion."""
    paper = "getComputedStyle(document.body).backgroundColor"
    light = browser.page(f"{directory}/report.html")
    dark = browser.page(f"{directory}/report.html", scheme="dark", motion="no-preference")
    assert light.value(paper) != dark.value(paper)
    dark.wait("Number(document.querySelector('#transport output b').textContent) > 0", 20)
    time.sleep(0.3)
    assert time_shown(light) == 0.0, "it moves although less motion is wanted"
    for page in [light, dark]:
        check_silence(page)
        page.close()


def check_comparison(browser, directory, runs):
    page = browser.page(f"{directory}/report.html")
    summaries = {run: json.load(open(f"{directory}/../{run}/summary.json")) for run in runs}
    n = check_numbers(page, summaries)
    keys = page.value("[...document.querySelector('.chart').querySelectorAll('.key')].map(e => e.textContent)")
    assert len(keys) == len(runs) and all(key.startswith(run) for key, run in zip(keys, runs)), keys
    links = page.value("[...document.querySelectorAll('.runs a')].map(e => e.href)")
    assert len(links) == len(runs) and all(os.path.exists(link.removeprefix("file://")) for link in links), links
    check_differences(page, summaries)
    first = page.picture("#viewport")
    page.value("(s => { s.value = 1; s.dispatchEvent(new Event('change')); })(document.querySelector('[aria-label=Run]'))")
    page.press("End")
    assert colours(page.picture("#viewport")) > 300 and page.picture("#viewport") != first
    check_names(page)
    check_layout(page)
    check_silence(page)
    page.close()
    return n


def check_differences(page, summaries):
    """Tables of the keys in which the inputs differ, and of the peaks of the columns."""
    tables = page.value(
        "[...document.querySelectorAll('.differences')].map(e => [e.getAttribute('aria-label'), [...e.rows].map(row => [...row.cells].map(e => e.textContent))])")
    runs, tables = list(summaries), dict(tables)
    keys = {key: values for key, *values in tables["Inputs that differ"]}
    assert keys["key"] == runs and keys["time.scheme"] == ['"DGM"', '"Newmark(0.25,0.5)"'], keys
    head, *rows = tables["Peaks"]
    assert head == ["column", *runs, f"{runs[1]}, %"] and [row[0] for row in rows] == ["tip_x", "tip_y", "tip_z"], (head, rows)
    peak = lambda run, column: max((summaries[run][f"{column}{end}"] for end in ["_min", "_max"]), key=abs)
    size = max(abs(peak(runs[0], row[0])) for row in rows)
    for column, *cells, percent in rows:
        peaks = [peak(run, column) for run in runs]
        for text, expected in zip(cells, peaks):
            value, half = shown(text)
            assert abs(value - expected) <= half * (1 + 1e-9), (column, text, expected)
        exact = 100 * (abs(peaks[1]) - abs(peaks[0])) / size
        assert abs(float(percent.removesuffix(" %")) - exact) < 0.0051, (column, percent, exact)


def check_curves(browser, emmy, place):
    """Pages of a harmonic response and of a shock response spectrum read the numbers of their tables at the cursor."""
    mount = ["response", "examples/shock-mount.toml", "--base", "z", "--frequencies", "20:2000:100", "--output", f"{place}/response"]
    spectrum = ["spectrum", f"{place}/l-block", "--column", "total_energy", "--kind", "srs", "--output", f"{place}/srs"]
    for command, table, ending in [(mount, "response.csv", "_amplitude"), (spectrum, "spectrum.csv", "_acceleration_maximax")]:
        subprocess.run([emmy, *command, "--quiet"], check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
        directory = command[-1]
        head, *rows = [line.split(",") for line in open(f"{directory}/{table}").read().splitlines()]
        page = browser.page(f"{directory}/report.html", width=1300)
        keys = "[...document.querySelector('section.chart').querySelectorAll('.key')].map(e => [e.childNodes[1].textContent, e.querySelector('.value').textContent])"
        for key, row in [("Home", rows[0]), ("ArrowRight", rows[1]), ("End", rows[-1])]:
            page.press(key)
            readings = page.value(keys)
            assert readings, directory
            for label, text in readings:
                value, half = shown(text)
                expected = float(row[head.index(label + ending)])
                assert abs(value - expected) <= half * (1 + 1e-9), (directory, key, label, text, expected)
        frequency, half = shown(re.search(r": ([0-9.e+-]+)", page.value("document.getElementById('status').textContent"))[1])
        assert abs(frequency - float(rows[-1][0])) <= half * (1 + 1e-9), frequency
        page.settle()
        assert colours(page.picture("section.chart")) > 20, directory
        check_silence(page)
        page.close()


def check_adaptive(browser, adaptive, planned):
    """Adaptive steps have a chart of their errors, planned ones have none."""
    for directory, expected in [(adaptive, True), (planned, False)]:
        page = browser.page(f"{directory}/report.html")
        charts = page.value("[...document.querySelectorAll('section.chart')].map(e => e.getAttribute('aria-label'))")
        assert ("Error of each step" in charts) == expected, (directory, charts)
        page.close()


def differ(a, b):
    """Whether a hundredth of the pixels of two pictures clearly differ; the same picture may be taken with a small shift."""
    (one, size), (other, _) = pixels(a), pixels(b)
    pairs = [(row[i:i + 3], own[i:i + 3]) for row, own in zip(one[::4], other[::4]) for i in range(0, len(row), 4 * size)]
    return sum(max(abs(x - y) for x, y in zip(*pair)) > 30 for pair in pairs) > 0.01 * len(pairs)


def check_modes(browser, emmy, directory):
    """The table has the numbers of modes.csv; a mode that is clicked is drawn as a vibration about the body at rest."""
    run = [emmy, "modes", "examples/l-block.toml", "--count", "9", "--output", directory, "--quiet"]
    subprocess.run(run, check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
    head, *rows = [line.split(",") for line in open(f"{directory}/modes.csv").read().splitlines()]
    page = browser.page(f"{directory}/report.html", width=1300)
    table = page.value("[...document.querySelectorAll('.modes tbody tr')].map(e => [e.className, ...[...e.querySelectorAll('td')].map(e => [e.dataset.key, e.textContent])])")
    assert len(table) == len(rows) == 9
    largest = max(float(row[head.index(f"effective_mass_{axis}")]) for row in rows for axis in "xyz")
    for row, (kind, *cells) in zip(rows, table):
        assert kind == ("rigid" if float(row[head.index("frequency")]) == 0 else ""), (kind, row)
        for key, text in cells:
            expected = float(row[head.index(key)])
            assert (text == "–") == math.isinf(expected), (key, text, expected)
            if text != "–":
                value, half = shown(text)
                rounding = 1e-6 * largest if key.startswith("effective") else 0.0
                assert abs(value - expected) <= max(half * (1 + 1e-9), rounding), (key, text, expected)
    # A free body: the first elastic mode is chosen.
    chosen = "document.querySelector('.modes tr[aria-selected=true] button').textContent"
    assert [kind for kind, *_ in table].count("rigid") == 6 and page.value(chosen) == "7"
    scene = lambda: page.picture("#viewport")

    def drawn(is_as_wanted):
        """Waits for a picture; a busy machine draws it late."""
        end = time.time() + 10
        while not is_as_wanted(picture := scene()):
            assert time.time() < end, "the mode is not drawn"
            page.settle()
        return picture

    drawn(lambda picture: colours(picture) > 300)
    # The first picture may still be of the first mode.
    time.sleep(0.5)
    seventh = scene()
    click(page, ".modes tbody tr:nth-child(9) td")
    assert page.value(chosen) == "9"
    drawn(lambda picture: differ(picture, seventh))
    page.press("ArrowLeft")
    page.press("ArrowLeft")
    assert page.value(chosen) == "7"
    drawn(lambda picture: not differ(picture, seventh))
    phase = lambda value: page.value(f"(s => {{ s.value = {value}; s.dispatchEvent(new Event('input')); }})(document.querySelector('[aria-label=Phase]'))")
    phase(750)
    back = drawn(lambda picture: differ(picture, seventh))
    # The body is at rest at the start and after half a period.
    phase(0)
    rest = drawn(lambda picture: differ(picture, seventh) and differ(picture, back))
    phase(250)
    drawn(lambda picture: not differ(picture, seventh))
    phase(500)
    drawn(lambda picture: not differ(picture, rest))
    page.value("(s => { s.value = 2; s.dispatchEvent(new Event('input')); })(document.querySelector('[aria-label=Amplitude]'))")
    phase(250)
    drawn(lambda picture: differ(picture, seventh) and differ(picture, rest))
    check_names(page)
    check_silence(page)
    page.close()
    for width, height in [(360, 740), (1080, 1920), (1920, 1080)]:
        page = browser.page(f"{directory}/report.html", width=width, height=height)
        wide = page.value("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        assert wide <= 0, f"{wide} pixels too wide"
        check_silence(page)
        page.close()
    page = browser.page(f"{directory}/report.html", motion="no-preference")
    label = "document.querySelector('#transport .play').getAttribute('aria-label')"
    page.wait(f"{label}.startsWith('Pause')", 10)
    page.press(" ", "Space", " ")
    page.wait(f"{label}.startsWith('Play')", 10)
    page.close()


def check_static(browser, emmy, directory):
    """A static analysis has the load fraction in place of time, and no balances of a motion."""
    os.makedirs(directory)
    source = open(f"{ROOT}/examples/cantilever.toml").read()
    before, _, rest = source.partition("[time]")
    after = rest[rest.index("\n["):] if "\n[" in rest else ""
    open(f"{directory}/static.toml", "w").write(before + "[equilibrium]\nload_steps = 4\n" + after)
    run = [emmy, "run", f"{directory}/static.toml", "--set", "output.every=1", "--output", f"{directory}/static", "--quiet"]
    subprocess.run(run, check=True)
    page = browser.page(f"{directory}/static/report.html")
    check_numbers(page, {"static": json.load(open(f"{directory}/static/summary.json"))})
    charts = page.value("[...document.querySelectorAll('section.chart')].map(e => e.getAttribute('aria-label'))")
    assert words(page) == [] and charts[0] == "Stored energy" and not any("omentum" in chart for chart in charts), charts
    page.press("End")
    assert page.value("document.querySelector('#transport output').textContent") == "load fraction = 1, increment 4 of 4"
    check_layout(page)
    check_silence(page)
    page.close()


def check_begun(browser, emmy, source, directory):
    """A run that has just begun: no row of its history, then one."""
    os.makedirs(directory)
    lines = open(f"{source}/history.csv").read().splitlines(keepends=True)
    for name in ["input.toml", "summary.json"]:
        open(f"{directory}/{name}", "w").write(open(f"{source}/{name}").read())
    for rows in [0, 1]:
        open(f"{directory}/history.csv", "w").writelines(lines[:rows + 1])
        subprocess.run([emmy, "report", directory], check=True, stdout=subprocess.DEVNULL)
        page = browser.page(f"{directory}/report.html")
        page.press("ArrowRight")
        assert time_shown(page) == 0.0
        check_silence(page)
        page.close()


def check_long(browser, emmy, source, directory):
    """A history of 200,000 steps: the page is small, quick, and has the peak."""
    os.makedirs(directory)
    for name in ["input.toml", "summary.json"]:
        open(f"{directory}/{name}", "w").write(open(f"{source}/{name}").read())
    lines = open(f"{source}/history.csv").read().splitlines()
    head, cells = lines[0].split(","), [line.split(",") for line in lines[1:]]
    n, peak = 200_000, 123_457
    with open(f"{directory}/history.csv", "w") as out:
        out.write(lines[0] + "\n")
        for step in range(n + 1):
            row = list(cells[step % len(cells)])
            row[0], row[1] = str(step), f"{step * 1e-3:.16e}"
            if step == peak:
                row[head.index("kinetic_energy")] = "9.9e9"
            out.write(",".join(row) + "\n")
    subprocess.run([emmy, "report", directory], check=True, stdout=subprocess.DEVNULL)
    size = os.path.getsize(f"{directory}/report.html")
    assert size < 4e6, f"{size} bytes"
    began = time.time()
    page = browser.page(f"{directory}/report.html", fragment=f"#t={peak * 1e-3}")
    seconds = time.time() - began
    assert seconds < 10, f"{seconds} s to open"
    assert page.value("document.querySelector('.chart .key .value').textContent") == "9.90e9"
    assert "200\u202f001 rows" in page.value("document.getElementById('foot').textContent")
    page.press("ArrowRight")
    check_silence(page)
    page.close()
    return size, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("emmy", help="the program")
    parser.add_argument("--picture", help="write the picture of the README to this file")
    arguments = parser.parse_args()
    emmy = os.path.abspath(arguments.emmy)
    with tempfile.TemporaryDirectory() as place, Chromium() as browser:
        for name, flags in RUNS.items():
            run = [emmy, "run", *flags, "--output", f"{place}/{name}", "--quiet"]
            subprocess.run(run, check=True, cwd=ROOT)
        kept = ["closes to 11 digits"]
        n = check_single(browser, f"{place}/l-block", kept)
        n += check_single(browser, f"{place}/spring-network", kept)
        n += check_single(browser, f"{place}/charts-only", kept, has_motion=False)
        n += check_single(browser, f"{place}/comet", kept)
        n += check_single(browser, f"{place}/two-materials", kept)
        check_mechanism(browser, f"{place}/four-bar", ["foot-0", "foot-1", "foot-2", "head-0", "head-1", "head-2", "head-3"])
        check_long_numbers(browser, emmy, f"{place}/charts-only", f"{place}/long-numbers")
        check_windows(browser, f"{place}/l-block")
        check_whole_body(browser, f"{place}/two-materials")
        check_range(browser, f"{place}/l-block")
        check_limits(browser, f"{place}/l-block")
        check_regions(browser, f"{place}/two-materials", "stiff", "soft")
        check_section(browser, f"{place}/two-materials", "x", 6)
        check_film(browser, f"{place}/two-materials", f"{place}/films")
        check_phone(browser, f"{place}/l-block")
        check_phone(browser, f"{place}/two-materials")
        check_probe(browser, f"{place}/two-materials", "tip")
        check_extremes(browser, f"{place}/two-materials")
        check_quantities(browser, emmy, f"{place}/charts-only", f"{place}/quantities")
        check_adaptive(browser, f"{place}/comet", f"{place}/l-block")
        n += check_single(browser, f"{place}/newmark", [*kept, "does not close"])
        check_modes(browser, emmy, f"{place}/modes")
        check_curves(browser, emmy, place)
        check_static(browser, emmy, f"{place}/static")
        check_schemes(browser, f"{place}/l-block")
        compared = ["l-block", "newmark"]
        compare = [emmy, "compare", *(f"{place}/{run}" for run in compared), "--output", f"{place}/compare", "--quiet"]
        subprocess.run(compare, check=True, stdout=subprocess.DEVNULL)
        n += check_comparison(browser, f"{place}/compare", compared)
        check_begun(browser, emmy, f"{place}/charts-only", f"{place}/begun")
        size, seconds = check_long(browser, emmy, f"{place}/charts-only", f"{place}/long")
        sizes = {run: os.path.getsize(f"{place}/{run}/report.html") // 1000 for run in RUNS}
        print(f"reports: {n} numbers as in the summaries; kB: {sizes}")
        print(f"200,000 steps: {size / 1e6:.1f} MB, open after {seconds:.1f} s")
        if arguments.picture:
            page = browser.page(f"{place}/l-block/report.html", width=1360, height=880, fragment="#t=1.6")
            page.settle()
            open(arguments.picture, "wb").write(page.picture())


if __name__ == "__main__":
    sys.exit(main())
