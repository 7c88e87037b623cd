"""Formulas of the book: a preprocessor of mdBook that writes LaTeX as MathML, which browsers show without a script or a network.

Formulas in the pages have GitHub's syntax: in blocks ```math and, within a line, between $` and `$.
A command that is not known here ends the build.

    python3 -m doctest book/formulas.py
    python3 book/formulas.py --check    reads the formulas of all pages, without mdBook
"""

import json
import re
import sys
from html import escape
from pathlib import Path

GREEK = dict(zip(
    "alpha beta gamma delta epsilon zeta lambda mu nu pi rho sigma tau phi psi omega xi eta theta kappa chi Delta Gamma Lambda Pi Omega Phi".split(),
    "αβγδεζλμνπρστφψωξηθκχΔΓΛΠΩΦ"))
SYMBOLS = {
    "cdot": "⋅", "times": "×", "otimes": "⊗", "nabla": "∇", "partial": "∂", "le": "≤", "ge": "≥", "ne": "≠", "to": "→", "approx": "≈",
    "sim": "∼", "ldots": "…", "cdots": "⋯", "infty": "∞", "in": "∈", "pm": "±", "colon": ":", "quad": "\u2003", "qquad": "\u2003\u2003",
    ",": "\u2009", ";": "\u2005", " ": "\u2005", "{": "{", "}": "}", "|": "‖", "Vert": "‖", "ll": "≪", "gg": "≫", "perp": "⊥", "equiv": "≡",
}
LARGE = {"sum": "∑", "int": "∫"}
FENCES = {"lvert": "|", "rvert": "|", "langle": "⟨", "rangle": "⟩"}
SUM = '<mo largeop="true">∑</mo>'
# Combining characters: browsers without a font for formulas set them better than accents of MathML.
ACCENTS = {"tilde": "\u0303", "bar": "\u0304", "hat": "\u0302", "dot": "\u0307", "ddot": "\u0308", "dddot": "\u20db"}
NAMES = ["sin", "cos", "tan", "arg", "exp", "ln", "log", "det", "max", "min", "lim"]
TEXT = {"text": "normal", "mathrm": "normal", "operatorname": "normal"}


def tokens(text):
    return re.findall(r"\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\S", text)


class Reader:
    """Reads a formula by recursive descent."""

    def __init__(self, text, display):
        self.text, self.display = text, display
        # Texts keep their blanks.
        self.texts = []
        def keep(match):
            self.texts.append(match[2])
            return f"\\{match[1]}{{{len(self.texts) - 1}}}"
        self.tokens = tokens(re.sub(r"\\(text|mathrm|operatorname)\{([^{}]*)\}", keep, text))
        self.at = 0

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def next(self):
        token = self.peek()
        if token is None:
            raise SyntaxError(f"ends early: {self.text}")
        self.at += 1
        return token

    def row(self, ends=()):
        """Everything up to one of the ends, which is not taken."""
        parts = []
        while self.peek() is not None and self.peek() not in ends:
            parts.append(self.scripted())
        return "".join(parts)

    def scripted(self):
        base = self.atom()
        under = over = primes = ""
        while self.peek() in ("_", "^", "'"):
            mark = self.next()
            if mark == "'":
                primes += "′"
            elif mark == "_":
                under = self.argument()
            else:
                over = self.argument()
        if primes:
            base = f'<mrow>{base}<mo lspace="0" rspace="0">{primes}</mo></mrow>'
        kind = ("munder", "mover", "munderover") if base == SUM and self.display else ("msub", "msup", "msubsup")
        if under and over:
            return f"<{kind[2]}>{base}{under}{over}</{kind[2]}>"
        if under or over:
            name = kind[0] if under else kind[1]
            return f"<{name}>{base}{under or over}</{name}>"
        return base

    def argument(self):
        return self.group() if self.peek() == "{" else self.atom()

    def group(self):
        self.next()
        row = self.row("}")
        self.next()
        return f"<mrow>{row}</mrow>"

    def atom(self):
        token = self.peek()
        if token == "{":
            return self.group()
        self.next()
        if token[0] == "\\":
            return self.command(token[1:])
        if token[0].isdigit():
            return f"<mn>{token}</mn>"
        if token.isalpha():
            return f"<mi>{token}</mi>"
        stretchy = ' stretchy="false"' if token in "()[]|" else ""
        return f"<mo{stretchy}>{escape('−' if token == '-' else token)}</mo>"

    def command(self, name):
        if name in GREEK:
            return f"<mi>{GREEK[name]}</mi>"
        if name in LARGE:
            return f'<mo largeop="true">{LARGE[name]}</mo>'
        if name in SYMBOLS:
            return f"<mo>{SYMBOLS[name]}</mo>" if name not in (",", ";", " ", "quad", "qquad") else f"<mtext>{SYMBOLS[name]}</mtext>"
        if name in FENCES:
            form = "prefix" if name[0] == "l" else "postfix"
            return f'<mo stretchy="false" form="{form}">{FENCES[name]}</mo>'
        if name in NAMES:
            return f"<mi>{name}</mi><mo>\u2061</mo>"
        if name in ("frac", "tfrac"):
            small = ' displaystyle="false"' if name == "tfrac" else ""
            return f"<mfrac{small}>{self.argument()}{self.argument()}</mfrac>"
        if name == "sqrt":
            return f"<msqrt>{self.argument()}</msqrt>"
        if name in TEXT:
            self.next()
            text = self.texts[int(self.next())]
            self.next()
            tag = "mtext" if name == "text" else "mi mathvariant=\"normal\""
            return f"<{tag}>{escape(text).replace(' ', chr(160))}</{tag.split()[0]}>"
        if name in ("mathbf", "boldsymbol"):
            return f'<mrow style="font-weight: bold">{self.argument()}</mrow>'
        if name in ACCENTS:
            return self.argument().replace("<mi>", '<mi style="font-style: italic">').replace("</mi>", ACCENTS[name] + "</mi>")
        if name == "left":
            opening = self.delimiter()
            row = self.row(("\\right",))
            self.next()
            return f"<mrow>{opening}{row}{self.delimiter()}</mrow>"
        if name == "begin":
            return self.table()
        raise SyntaxError(f"\\{name} is not known: {self.text}")

    def delimiter(self):
        token = self.next()
        token = SYMBOLS.get(token[1:], token)
        return "" if token == "." else f'<mo stretchy="true">{token}</mo>'

    def environment(self):
        self.next()
        name = ""
        while self.peek() != "}":
            name += self.next()
        self.next()
        return name

    def table(self):
        """aligned, pmatrix, cases."""
        name = self.environment()
        rows = [[""]]
        while self.peek() != "\\end":
            rows[-1][-1] += self.row(("&", "\\\\", "\\end"))
            if self.peek() == "&":
                self.next()
                rows[-1].append("")
            elif self.peek() == "\\\\":
                self.next()
                rows.append([""])
        self.next()
        self.environment()
        def cell(index, text):
            side = ("right" if index % 2 == 0 else "left") if name == "aligned" else "left" if name == "cases" else "center"
            return f'<mtd style="text-align: {side}; padding: 0.25em 0.1em">{text}</mtd>'
        body = "".join("<mtr>" + "".join(cell(i, text) for i, text in enumerate(row)) + "</mtr>" for row in rows)
        shown = ' displaystyle="true"' if name == "aligned" else ""
        table = f"<mtable{shown}>{body}</mtable>"
        brackets = {"aligned": ("", ""), "pmatrix": ("(", ")"), "cases": ("{", "")}[name]
        left, right = (f'<mo stretchy="true">{bracket}</mo>' if bracket else "" for bracket in brackets)
        return f"<mrow>{left}{table}{right}</mrow>"


def mathml(text, display=False):
    r"""A formula as MathML.

    >>> mathml("x_1^2")
    '<math><msubsup><mi>x</mi><mn>1</mn><mn>2</mn></msubsup></math>'
    >>> mathml(r"\frac{1}{b_i}")
    '<math><mfrac><mrow><mn>1</mn></mrow><mrow><msub><mi>b</mi><mi>i</mi></msub></mrow></mfrac></math>'
    >>> mathml(r"\lvert x\rvert")
    '<math><mo stretchy="false" form="prefix">&#124;</mo><mi>x</mi><mo stretchy="false" form="postfix">&#124;</mo></math>'
    >>> mathml("F'_j")
    '<math><msub><mrow><mi>F</mi><mo lspace="0" rspace="0">′</mo></mrow><mi>j</mi></msub></math>'
    >>> mathml(r"\oops")
    Traceback (most recent call last):
    SyntaxError: \oops is not known: \oops
    """
    reader = Reader(text, display)
    row = reader.row()
    if reader.peek() is not None:
        raise SyntaxError(f"{reader.peek()} is left over: {text}")
    shown = ' display="block"' if display else ""
    # Markdown reads the resulting text, so its own marks are written as references.
    row = re.sub(r"[~*^|\[\]_]", lambda mark: f"&#{ord(mark[0])};", row)
    return f"<math{shown}>{row}</math>"


def with_formulas(page):
    r"""A page with its formulas as MathML; code is left alone.

    >>> with_formulas("a $`x`$ b")
    'a <math><mi>x</mi></math> b'
    >>> with_formulas("```toml\na = '$`x`$'\n```")
    "```toml\na = '$`x`$'\n```"
    """
    blocks = re.split(r"(^```.*?^```$)", page, flags=re.M | re.S)
    for i, block in enumerate(blocks):
        if block.startswith("```math"):
            blocks[i] = mathml(block[len("```math"):-len("```")], display=True)
        elif not block.startswith("```"):
            blocks[i] = re.sub(r"\$`(.+?)`\$", lambda match: mathml(match[1]), block, flags=re.S)
    return "".join(blocks)


def visit(items):
    for item in items:
        if isinstance(item, dict) and "Chapter" in item:
            chapter = item["Chapter"]
            chapter["content"] = with_formulas(chapter["content"])
            visit(chapter["sub_items"])


def check(pages):
    """Reads the formulas of all pages, and exits with those that cannot be written."""
    faults = []
    for page in sorted(pages.rglob("*.md")):
        try:
            with_formulas(page.read_text(encoding="utf-8"))
        except SyntaxError as error:
            faults.append(f"{page.name}: {error}")
    sys.exit("\n".join(faults) or 0)


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        check(Path(__file__).parent / "src")
    if sys.argv[1:2] == ["supports"]:
        sys.exit(0 if sys.argv[2] == "html" else 1)
    _, book = json.load(sys.stdin)
    visit(book.get("items", book.get("sections", [])))
    json.dump(book, sys.stdout)
