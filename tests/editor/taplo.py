"""Checks that taplo completes, explains and validates inputs with the schema of `emmy schema`, as docs/editors.md says.

    cargo install taplo-cli --locked --features lsp
    cargo build --release -p emmy-cli
    python3 tests/editor/taplo.py target/release/emmy taplo

The taplo of `pip install taplo` has no language server; with `--lint` only what it has is checked.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
INPUT = (ROOT / "examples/l-block.toml").read_text()
DIRECTIVE, CONFIG = re.findall(r"```toml\n(.*?)```", (ROOT / "docs/editors.md").read_text(), re.S)
LIMIT = 30.0  # seconds for a run of taplo lint, and for all that is asked of one server


def change(old, new):
    assert INPUT.count(old) == 1, f"{old!r} is {INPUT.count(old)} times in the example"
    return INPUT.replace(old, new)


# Wrong inputs, the key, and what is said of it.
WRONG = {
    "a mistyped key": (change("\ntolerance = ", "\ntolerence = "), "tolerence", "('tolerence' was unexpected)"),
    "a text for a number": (change("density = 0.5", 'density = "0.5"'), "density", '"0.5" is not of type "number"'),
    "an unknown word": (INPUT + '\n[solver]\nkind = "dircet"\n', "kind", '"dircet" is not one of'),
}
# Inputs with the cursor at ^, and some of what is offered there.
OFFERED = {
    "after sch": (change('scheme = "AS(5)"', "sch^"), {"scheme"}),
    "after deg": (change("degree = 1 ", "deg^ "), {"degree"}),
    "in [[region]]": (change("[[region]]\n", "[[region]]\n^\n"), {"thickness", "material.neo-hooke"}),
    "as kind of solver": (INPUT + '\n[solver]\nkind = "^"\n', {'"auto"', '"direct"', '"iterative"'}),
    "as scheme": (change('scheme = "AS(5)"', 'scheme = "^"'), {'"DGM"', '"AS(5)"', '"Bathe"'}),
}


class Server:
    """taplo's language server for a folder, as an editor talks to it."""

    def __init__(self, taplo, folder, log):
        self.folder, self.log, self.count = folder, log, 0
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": log.open("wb")}
        self.process = subprocess.Popen([taplo, "lsp", "stdio"], **pipes)
        self.timer = threading.Timer(LIMIT, self.process.kill)
        self.timer.start()

    def start(self):
        where = {"rootUri": self.folder.as_uri(), "workspaceFolders": [{"uri": self.folder.as_uri(), "name": "inputs"}]}
        able = {"workspace": {"configuration": True, "workspaceFolders": True}}
        self.request("initialize", {"processId": os.getpid(), "capabilities": able, **where})
        self.send(method="initialized", params={})

    def end(self):
        self.timer.cancel()
        self.process.kill()
        self.process.wait()

    def send(self, **message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        try:
            self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # `receive` says why.

    def receive(self):
        """The next message; what the server asks is answered: no schemas from the net, no other settings."""
        size = 0
        while line := self.process.stdout.readline().strip():
            size = int(line.split(b":")[1]) if line.lower().startswith(b"content-length:") else size
        if size == 0:
            said = re.findall("^ERROR operation.*", self.log.read_text(), re.M)
            sys.exit("FAILED: " + (said[-1] if said else f"taplo ended, or did not say the next within {LIMIT:.0f} s"))
        message = json.loads(self.process.stdout.read(size))
        if "method" in message and "id" in message:
            items = (message.get("params") or {}).get("items")
            self.send(id=message["id"], result=items and [{"schema": {"catalogs": []}}] * len(items))
        return message

    def request(self, method, params):
        self.count += 1
        self.send(id=self.count, method=method, params=params)
        while "method" in (message := self.receive()) or message["id"] != self.count:
            pass
        return message["result"]

    def open(self, text):
        uri = (self.folder / f"input-{self.count}.toml").as_uri()
        document = {"uri": uri, "languageId": "toml", "version": 1, "text": text}
        self.send(method="textDocument/didOpen", params={"textDocument": document})
        return uri

    def ask(self, what, text):
        """The answer at the cursor; as the server may still read its settings, it is asked until there is one."""
        before, after = text.split("^")
        at = {"line": before.count("\n"), "character": len(before) - before.rfind("\n") - 1}
        document = {"uri": self.open(before + after)}
        while not (answer := self.request(f"textDocument/{what}", {"textDocument": document, "position": at})):
            time.sleep(0.1)
        return answer

    def wait_for(self, text, complaint):
        uri = self.open(text)
        while complaint not in self.complaints.get(uri, ""):
            self.receive()


def check_lint(taplo, folder, flags, right, first):
    def lint(*files):
        run = [taplo, "lint", "--colors", "never", *flags, *files]
        done = subprocess.run(run, cwd=folder, capture_output=True, text=True, timeout=LIMIT)
        return done.returncode, done.stdout + done.stderr

    code, said = lint(*right)
    assert code == 0, said
    print(f"  taplo lint accepts {len(right)} inputs")
    for name, (text, key, complaint) in WRONG.items():
        (folder / "wrong.toml").write_text(first + text)
        code, said = lint("wrong.toml")
        assert code != 0 and key in said and complaint in said, (name, code, said)
        print(f"  taplo lint refuses {name}: {complaint}")


def check_server(server, first, explained):
    right = server.open(first + INPUT)
    for name, (text, words) in OFFERED.items():
        offered = {item["label"] for item in server.ask("completion", first + text)}
        assert words <= offered, (name, offered)
        print(f"  offered {name}: {', '.join(sorted(words))}")
    said = server.ask("hover", first + change("scheme = ", "sch^eme = "))["contents"]["value"]
    assert explained in said, said
    print(f"  explained at scheme: {explained}")
    for name, (text, _, complaint) in WRONG.items():
        server.wait_for(first + text, complaint)
        print(f"  underlined: {name}")
    assert server.complaints[right] == "", server.complaints[right]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("emmy", type=os.path.abspath, help="the program")
    parser.add_argument("taplo", help="the TOML language server")
    parser.add_argument("--lint", action="store_true", help="check `taplo lint` only")
    arguments = parser.parse_args()
    schema = subprocess.run([arguments.emmy, "schema"], check=True, capture_output=True).stdout
