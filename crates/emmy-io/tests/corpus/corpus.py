"""Mesh files of meshio, Gmsh, pyNastran and VTK as Emmy reads them, against what the library holds that wrote them.

    pip install -r crates/emmy-io/tests/corpus/requirements.txt python/
    python crates/emmy-io/tests/corpus/corpus.py [--quick] [--only TEXT] [--keep FOLDER]

Every file is compared in its nodes, its cells with the order of their nodes, its volume and its groups. Files with a
difference are kept. What a library cannot write is listed; a library that is not installed is an error.
"""

import argparse
import collections
import importlib
import pathlib
import sys
import tempfile
import traceback
import warnings

import emmy
from bodies import all_bodies
from wanted import differences

# In the quick form each way of writing takes one body of so many.
QUICK = 9


class Corpus:
    """Writes files into a folder and collects what is different in them."""

    def __init__(self, folder, quick, only):
        self.folder, self.quick, self.only = folder, quick, only
        self.all_bodies = all_bodies()
        self.n_ways = 0
        self.counts = collections.Counter()
        self.unwritten = collections.defaultdict(list)
        self.faults = []

    def bodies(self, way):
        """The bodies for a way of writing: all of them, or other ones for each way."""
        if self.only and self.only not in way:
            return []
        self.n_ways += 1
        return [body for i, body in enumerate(self.all_bodies) if not self.quick or (i + self.n_ways) % QUICK == 0]

    def path(self, way, name):
        """Place for a file in a folder of its way."""
        folder = self.folder / way
        folder.mkdir(parents=True, exist_ok=True)
        return folder / name

    def cannot(self, way, what, reason):
        """Lists what a library cannot write."""
        self.unwritten[f"{way}: {reason}"].append(what)

    def check(self, way, name, wanted, read):
        """Compares the mesh of a function with what it must be."""
        self.counts[way] += 1
        try:
            found = differences(read(), wanted)
        except Exception as error:
            found = [str(error)]
        except BaseException:  # a panic of Rust is no Exception
            found = [traceback.format_exc()]
        if found:
            self.faults.append(f"{way}/{name}")
            print(f"DIFFERENT {way}/{name}: " + "; ".join(found[:4]), flush=True)
        return not found

    def file(self, way, path, wanted, **options):
        """Compares a file with what it must be, and removes it if it is right."""
        if self.check(way, path.name, wanted, lambda: emmy.Mesh.read(path, **options)):
            path.unlink()

    def refused(self, way, path, text):
        """Checks that a file that is not read gets a message with a text."""
        self.counts[way] += 1
        try:
            found = f"{emmy.Mesh.read(path)!r} is read"
        except emmy.MeshError as error:
            found = "" if text in str(error) else str(error)
        if found:
            self.faults.append(f"{way}/{path.name}")
            print(f"DIFFERENT {way}/{path.name}: {found}", flush=True)
        else:
            path.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="every way of writing with some of the bodies")
    parser.add_argument("--only", default="", help="ways of writing with this text in their names")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for files that are different; default: a temporary one")
    given = parser.parse_args()
    folder = given.keep or pathlib.Path(tempfile.mkdtemp(prefix="emmy-corpus-"))
    corpus = Corpus(folder, given.quick, given.only)
    warnings.simplefilter("ignore")
    missing = []
    for library, module in {"meshio": "by_meshio", "gmsh": "by_gmsh", "pyNastran": "by_nastran", "vtk": "by_vtk"}.items():
        try:
            importlib.import_module(library)
        except ImportError as error:
            missing.append(f"{library} ({error})")
            continue
        importlib.import_module(module).write_all(corpus)
    for way, count in corpus.counts.items():
        print(f"{count:6d}  {way}")
    for reason, names in corpus.unwritten.items():
        print(f"not written: {reason} ({', '.join(dict.fromkeys(names))})")
    total = sum(corpus.counts.values())
    print(f"{total} meshes, {len(corpus.faults)} different" + (f", kept in {folder}" if corpus.faults else ""))
    if missing:
        print(f"not installed: {', '.join(missing)}")
    sys.exit(bool(corpus.faults or missing or not total))


if __name__ == "__main__":
    main()
