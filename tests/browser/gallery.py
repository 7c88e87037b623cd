"""Writes the pictures of the gallery in the book: jobs of `examples`, as their reports show them.

    cargo build --release -p emmy-cli
    python3 tests/browser/gallery.py target/release/emmy book/src/gallery
"""

import os
import subprocess
import sys
import tempfile

from chromium import Chromium

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

# Job, quantity of the colours, time as a part of the run, flags of the run.
JOBS = [
    ("balloon", "largest_stretch", 0.9, []),
    ("bracket", "von_mises_stress", 0.17, []),
    ("driven-beam", "von_mises_stress", 0.3, []),
    ("newtons-cradle", "von_mises_stress", 0.35, []),
    ("rotor-blade", "displacement", 1.0, []),
    ("rubber-bumper", "largest_stretch", 1.0, []),
    ("satellite", "displacement", 0.5, []),
    ("shock-mount", "largest_stretch", 0.17, ["--set", "output.every=1", "--until", "0.05"]),
    ("tuning-fork", "von_mises_stress", 0.5, []),
    ("two-materials", "von_mises_stress", 0.5, []),
]


def main(emmy, folder):
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as place, Chromium() as browser:
        for name, quantity, part, flags in JOBS:
            own = os.path.join(place, name)
            run = [emmy, "run", os.path.join(ROOT, "examples", f"{name}.toml"), "--output", own, "--quiet", *flags]
            subprocess.run(run, check=True, cwd=place)
            with open(os.path.join(folder, f"{name}.png"), "wb") as file:
                file.write(picture(browser, os.path.join(own, "report.html"), quantity, part))


def picture(browser, report, quantity, part):
    """The scene at a part of the run, coloured by a quantity."""
    page = browser.page(report, width=860, height=1100)
    page.value(
        f"(s => {{ s.value = s.max * {part}; s.dispatchEvent(new Event('input', {{ bubbles: true }})); }})"
        "(document.querySelector('#transport input'))"
    )
    page.value(
        f"(s => {{ s.value = {quantity!r}; s.dispatchEvent(new Event('change', {{ bubbles: true }})); }})"
        "([...document.querySelectorAll('select')].find(s => [...s.options].some(o => o.value === 'displacement')))"
    )
    page.value("[...document.querySelectorAll('button')].find(own => own.textContent === 'frame').click()")
    page.settle()
    found = page.picture("#viewport")
    page.close()
    return found


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]))
