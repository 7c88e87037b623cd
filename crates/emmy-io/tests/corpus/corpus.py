"""Mesh files of meshio, Gmsh, pyNastran and VTK as Emmy reads them, against what the library holds that wrote them.

    pip install -r crates/emmy-io/tests/corpus/requirements.txt python/
    python crates/emmy-io/tests/corpus/corpus.py [--quick] [--only TEXT] [--keep FOLDER]

Every file is compared in its nodes, its cells with the order of their nodes, its volume and its groups. Files with a
difference are kept. What a library cannot write is listed; a library that is not installed is an error.
"""

import argparse
import collections
import concurrent.futures
import importlib
import importlib.util
import multiprocessing
import pathlib
import re
import sys
import tempfile
import traceback
import warnings

import emmy
from bodies import all_bodies
from wanted import differences

# In the quick form each way of writing takes one body of so many.
FEW = 11


class Corpus:
    """Writes files into a folder and collects what is different in them."""

    def __init__(self, folder, quick, only):
        self.folder, self.quick, self.only = folder, quick, only
        self.all_bodies = all_bodies()
        self.n_ways = 0
        self.counts = collections.Counter()
        self.unwritten = {}
        self.faults = []

    def bodies(self, way, few=False):
        """The bodies for a way of writing: all of them; in the quick form or of `few` other ones for each way."""
        if self.only and self.only not in way:
            return []
        self.n_ways += 1
        return [body for i, body in enumerate(self.all_bodies) if not (self.quick or few) or (i + self.n_ways) % FEW == 0]

    def path(self, way, name):
        """Place for a file in a folder of its way."""
        folder = self.folder / way
        folder.mkdir(parents=True, exist_ok=True)
        return folder / name

    def cannot(self, way, what, reason):
        """Lists what a library cannot write."""
        self.unwritten.setdefault(f"{way}: {reason}", []).append(re.sub("-(blocks|turned|spare)$", "", what))

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


LIBRARIES = {"vtk": "by_vtk", "meshio": "by_meshio", "gmsh": "by_gmsh", "pyNastran": "by_nastran"}


def write_all(library, folder, quick, only):
    """All files of a library: their counts, what it cannot write, what is different."""
    warnings.simplefilter("ignore")
    corpus = Corpus(folder, quick, only)
    importlib.import_module(LIBRARIES[library]).write_all(corpus)
    return corpus.counts, corpus.unwritten, corpus.faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="every way of writing with some of the bodies")
    parser.add_argument("--only", default="", help="ways of writing with this text in their names")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for files that are different; default: a temporary one")
    given = parser.parse_args()
    folder = given.keep or pathlib.Path(tempfile.mkdtemp(prefix="emmy-corpus-"))
    missing = [library for library in LIBRARIES if importlib.util.find_spec(library) is None]
    total, faults = 0, []
    # A process for each library, two at once.
    with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        work = [pool.submit(write_all, library, folder, given.quick, given.only) for library in LIBRARIES if library not in missing]
        for counts, unwritten, own in (one.result() for one in work):
            for way, count in counts.items():
                print(f"{count:6d}  {way}")
            for reason, names in unwritten.items():
                print(f"not written: {reason} ({', '.join(dict.fromkeys(names))})")
            total += sum(counts.values())
            faults += own
    print(f"{total} meshes, {len(faults)} different" + (f", kept in {folder}" if faults else ""))
    if missing:
        print(f"not installed: {', '.join(missing)}")
    sys.exit(bool(faults or missing or not total))


if __name__ == "__main__":
    main()
