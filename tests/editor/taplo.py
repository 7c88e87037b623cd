"""Checks that taplo completes, explains and validates inputs with the schema of `emmy schema`, as book/src/editors.md says.

    cargo install taplo-cli --locked --features lsp
    cargo build --release -p emmy-cli
    python3 tests/editor/taplo.py target/release/emmy taplo

The taplo of `pip install taplo` has no language server; with `--lint` only what it has is checked.
"""

import argparse
import atexit
import json
import pathlib
import re
import shutil
import subprocess
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
INPUT = (ROOT / "examples/l-block.toml").read_text()
DIRECTIVE, CONFIG = re.findall(r"```toml\n(.*?)```", (ROOT / "book/src/editors.md").read_text(), re.S)
LIMIT = 30.0  # seconds for a run of `taplo lint`, and for all that is asked of one server


def change(old, new):
    assert INPUT.count(old) == 1, f"{old!r} is {INPUT.count(old)} times in the example"
    return INPUT.replace(old, new)


# Wrong inputs, the key, and the message about it.
WRONG = {
    "a mistyped key": (change("\ntolerance = ", "\ntolerence = "), "tolerence", "('tolerence' was unexpected)"),
    "a text for a number": (change("density = 0.5", 'density = "0.5"'), "density", '"0.5" does not match'),
    "an unknown word": (INPUT + '\n[solver]\nkind = "dircet"\n', "kind", '"dircet" is not one of'),
}
# Inputs with the cursor at ^, and some of the completions there.
OFFERED = {
    "after sch": (change('scheme = "AS(5)"', "sch^"), {"scheme"}),
    "after deg": (change("degree = 1 ", "deg^ "), {"degree"}),
    "in [[region]]": (change("[[region]]\n", "[[region]]\n^\n"), {"thickness", "material.hencky"}),
    "as kind of solver": (INPUT + '\n[solver]\nkind = "^"\n', {'"auto"', '"direct"', '"iterative"'}),
    "as scheme": (change('scheme = "AS(5)"', 'scheme = "^"'), {'"DGM"', '"AS(5)"', '"Bathe"'}),
}


class Server:
    """taplo's language server, as an editor talks to it; it ends with the script, or when its time is up."""

    def __init__(self, taplo, folder):
        self.folder, self.count, self.complaints = folder, 0, {}
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
        self.process = subprocess.Popen([taplo, "lsp", "stdio"], **pipes)
        atexit.register(self.process.kill)
        threading.Thread(target=lambda: time.sleep(LIMIT) or self.process.kill(), daemon=True).start()

    def send(self, **message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self.process.stdin.flush()

    def receive(self):
        """The next message; what the server asks is answered: no schemas from the net, no other settings."""
        head = b"".join(iter(lambda: self.process.stdout.readline().strip(), b""))
        size = re.search(rb"Content-Length: *(\d+)", head)
        assert size, f"the language server is not in this build, or did not say what is expected within {LIMIT:.0f} s"
        message = json.loads(self.process.stdout.read(int(size[1])))
        params = message.get("params") or {}
        if message.get("method") == "textDocument/publishDiagnostics":
            self.complaints[params["uri"]] = [each["message"] for each in params["diagnostics"]]
        elif "method" in message and "id" in message:
            self.send(id=message["id"], result=[{"schema": {"catalogs": []}} for _ in params.get("items", [])])
        return message

    def request(self, method, **params):
        self.count += 1
        self.send(id=self.count, method=method, params=params)
        while "method" in (message := self.receive()) or message["id"] != self.count:
            pass
        return message["result"]

    def open(self, name, text):
        uri = (self.folder / f"{name}.toml").as_uri()
        document = {"textDocument": {"uri": uri, "languageId": "toml", "version": 1, "text": text}}
        self.send(method="textDocument/didOpen", params=document)
        return uri

    def ask(self, what, name, text):
        """The answer at the cursor; as the server may still read its settings, it is asked until there is one."""
        before, after = text.split("^")
        document = {"uri": self.open(name, before + after)}
        at = {"line": before.count("\n"), "character": len(before) - before.rfind("\n") - 1}
        while not (answer := self.request(f"textDocument/{what}", textDocument=document, position=at)):
            time.sleep(0.1)
        return answer


def check_lint(way, taplo, folder, first, *more):
    for name, (text, key, complaint) in {"what is right": (INPUT, "", ""), **WRONG}.items():
        (folder / "input.toml").write_text(first + text)
        run = [taplo, "lint", "--colors", "never", *more]
        done = subprocess.run(run, cwd=folder, capture_output=True, text=True, timeout=LIMIT)
        assert (done.returncode == 0) == (text == INPUT), (name, done)
        assert key in done.stderr and complaint in done.stderr, (name, done)
        print(f"{way}: lint, {name}: {complaint or 'accepted'}")


def check_server(way, server, first, explained):
    folders = [{"uri": server.folder.as_uri(), "name": "inputs"}]
    server.request("initialize", capabilities={"workspace": {"configuration": True}}, workspaceFolders=folders)
    server.send(method="initialized", params={})
    for name, (text, words) in OFFERED.items():
        offered = {item["label"] for item in server.ask("completion", name, first + text)}
        assert words <= offered, (name, words, offered)
        print(f"{way}: offered {name}: {', '.join(sorted(words))}")
    said = server.ask("hover", "right", first + change("scheme = ", "sch^eme = "))["contents"]["value"].strip()
    assert said == explained, said
    print(f"{way}: explained at scheme: {said}")
    for name, (text, _, complaint) in WRONG.items():
        uri = server.open(name, first + text)
        while not any(complaint in each for each in server.complaints.get(uri, [])):
            server.receive()
        print(f"{way}: underlined, {name}: {complaint}")
    assert server.complaints[(server.folder / "right.toml").as_uri()] == []


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("emmy", help="the program")
    parser.add_argument("taplo", help="the program")
    parser.add_argument("--lint", action="store_true", help="check `taplo lint` only")
    arguments = parser.parse_args()
    taplo = pathlib.Path(shutil.which(arguments.taplo) or parser.error("no such taplo")).resolve()
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place).resolve()
        schema = folder / "emmy.schema.json"
        schema.write_bytes(subprocess.run([arguments.emmy, "schema"], check=True, stdout=subprocess.PIPE).stdout)
        explained = json.loads(schema.read_text())["properties"]["time"]["properties"]["scheme"]["description"]
        check_lint("--schema", taplo, folder, "", "--schema", schema.as_uri(), "input.toml", *ROOT.glob("examples/*.toml"))
        for way, first, config in ("#:schema", DIRECTIVE, ""), ("taplo.toml", "", CONFIG):
            (folder / "taplo.toml").write_text(config)
            check_lint(way, taplo, folder, first)
            if not arguments.lint:
                check_server(way, Server(taplo, folder), first, explained)


if __name__ == "__main__":
    main()
