"""THIRD_PARTY_NOTICES.md: the licence texts of every crate that `emmy` is linked with, and of the libraries in its pages.

    python3 tests/licences/notices.py            # checks the file
    python3 tests/licences/notices.py --write    # writes it again
"""

import collections
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOTICES = ROOT / "THIRD_PARTY_NOTICES.md"
# Libraries in the pages that Emmy writes: a folder each.
VENDOR = ROOT / "crates/emmy-io/src/report/assets/vendor"
LICENCE_FILE = re.compile(r"(un)?licen[cs]e|copying|notice|copyright", re.IGNORECASE)
# Not linked.
OTHER_FOLDERS = {"tests", "benches", "examples", "src"}
# Programs that stand inside crates, by words of their notices.
INSIDE_CRATES = {
    "METIS": "Copyright 1995-2013, Regents of the University of Minnesota",
    "GKlib": "Copyright 1995-2018, Regents of the University of Minnesota",
    "Eigen": "Mozilla Public License Version 2.0",
    "AMD": "AMD, Copyright (c), 1996-2022, Timothy A. Davis",
    "COLAMD": "COLAMD, Copyright 1998-2022, Timothy A. Davis",
    "LAPACK": "The University of Tennessee",
    "HDF5": "Copyright 2006 by The HDF Group",
    "Bitstream Vera": "Copyright (c) 2003 by Bitstream, Inc.",
    "Arev": "Tavmjong Bah",
    "Apache-2.0": "TERMS AND CONDITIONS FOR USE, REPRODUCTION, AND DISTRIBUTION",
}
HEAD = """# Third-party notices

The program `emmy` contains the crates listed here and the standard library of Rust (MIT OR Apache-2.0); crates for one platform
only are listed too. Their sources are at `https://crates.io/crates/NAME/VERSION`. Where a crate may be had under MIT as well as under
other licences, only its MIT text stands here. `just notices` writes this file, and CI compares it with the crates.
"""


def cargo(*arguments):
    return subprocess.run(["cargo", *arguments], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def linked():
    """Packages that `emmy` and the package of Python need to run on any platform, without those of the workspace, in the order of their names."""
    tree = cargo("tree", *"--locked --edges normal --target all --package emmy-cli --package emmy-python --prefix none --format {p}".split())
    names = {tuple(line.split()[:2]) for line in tree.splitlines() if line}
    packages = json.loads(cargo("metadata", "--locked", "--format-version", "1"))["packages"]
    wanted = [p for p in packages if (p["name"], "v" + p["version"]) in names and p["source"]]
    return sorted(wanted, key=lambda package: (package["name"], package["version"]))


def licence_files(package):
    folder = pathlib.Path(package["manifest_path"]).parent
    files = [path for path in sorted(folder.rglob("*")) if LICENCE_FILE.match(path.name) and path.is_file()]
    files = [path for path in files if not OTHER_FOLDERS & set(path.relative_to(folder).parts[:-1])]
    has_choice = re.search(r" OR |/", package["license"]) and " AND " not in package["license"]
    mit = [path for path in files if path.parent == folder and "mit" in path.name.lower()]
    if has_choice and mit:
        files = mit + [path for path in files if path.parent != folder]
    return files


def clean(text):
    return "\n".join(line.rstrip() for line in text.replace("\f", "").splitlines()).strip("\n")


def has_own_text(package, files):
    """Whether there is a licence of the crate itself, in its first folder, and not only of what it contains."""
    own = [path.read_text(errors="replace") for path in files if path.parent == pathlib.Path(package["manifest_path"]).parent]
    return any("Permission is hereby granted" in text for text in own) if package["license"] == "MIT" else bool(own)


def section(title, users, text):
    return f"\n### {title}\n\n" + "".join(f"- {user}\n" for user in users) + f"\n```text\n{text}\n```\n"


def notices():
    texts, without = collections.defaultdict(list), []
    page = HEAD + "\n## Crates\n\n"
    for package in linked():
        name = f"{package['name']} {package['version']}"
        page += f"- {name} ({package['license']})\n"
        files = licence_files(package)
        if not has_own_text(package, files):
            authors = ", ".join(package["authors"]) or "no authors named"
            without.append(f"{name} ({package['license']}; {authors})")
        for path in files:
            inside = path.relative_to(pathlib.Path(package["manifest_path"]).parent)
            texts[clean(path.read_text(errors="replace"))].append(f"{name}: {inside.as_posix()}")
    page += "\n## Texts\n"
    for number, (text, users) in enumerate(texts.items(), 1):
        page += section(f"Text {number}", users, text)
    permission = clean((ROOT / "LICENSE-MIT").read_text()).split("\n\n", 2)[2]
    page += section("Crates that name a licence and bring no text of it", without, permission)
    page += "\n## Libraries in the pages that Emmy writes\n"
    for path in sorted(VENDOR.glob("*/LICENSE")):
        page += section(path.parent.name, [], clean(path.read_text()))
    return page


def main():
    page = notices()
    squeezed = " ".join(page.split())
    missing = [name for name, words in INSIDE_CRATES.items() if words not in squeezed]
    if missing:
        sys.exit(f"the notices of {', '.join(missing)} are not where they were: look at their crates")
    if sys.argv[1:] == ["--write"]:
        NOTICES.write_text(page)
    elif not NOTICES.exists() or NOTICES.read_text() != page:
        sys.exit("THIRD_PARTY_NOTICES.md does not match these crates; `just notices` writes it again")


if __name__ == "__main__":
    main()
