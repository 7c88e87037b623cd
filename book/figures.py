"""The drawings of the book, computed from the formulas that they show: python3 book/figures.py writes them into book/src/figures, with
--check it compares what is there.

    python3 -m doctest book/figures.py
"""

import sys
from cmath import phase
from math import cos, factorial, pi, sin, sqrt
from pathlib import Path

INK, BLUE, RED, GREY, LIGHT = "#222222", "#2166ac", "#b2182b", "#888888", "#e8eef5"


class Drawing:
    """An SVG with a white ground; lengths in pixels."""

    def __init__(self, width, height):
        self.width, self.height, self.parts = width, height, []

    def line(self, points, colour=INK, width=1.5, dash=None, close=False, fill="none"):
        path = " ".join(f"{'ML'[i > 0]}{x:.1f},{y:.1f}" for i, (x, y) in enumerate(points)) + (" Z" if close else "")
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<path d="{path}" fill="{fill}" stroke="{colour}" stroke-width="{width}"{dashes}/>')

    def arrow(self, a, b, colour=INK, width=1.5):
        (x, y), (u, v) = a, b
        length = sqrt((u - x) ** 2 + (v - y) ** 2)
        ex, ey = (u - x) / length, (v - y) / length
        self.line([a, (u - 6 * ex, v - 6 * ey)], colour, width)
        tip = [(u, v), (u - 9 * ex - 4 * ey, v - 9 * ey + 4 * ex), (u - 9 * ex + 4 * ey, v - 9 * ey - 4 * ex)]
        self.line(tip, colour, 0.5, close=True, fill=colour)

    def dot(self, x, y, colour=INK, radius=4, fill=None):
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{fill or colour}" stroke="{colour}" stroke-width="1.5"/>')

    def box(self, x, y, width, height, fill=LIGHT):
        self.parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" fill="{fill}" stroke="{INK}"/>')

    def text(self, x, y, text, colour=INK, anchor="middle", size=14, italic=False):
        """Text; `_x_` and `^x^` are a subscript and a superscript of one word."""
        style = ' font-style="italic"' if italic else ""
        parts, shift = [], 0
        for i, part in enumerate(text.replace("^", "_^").split("_")):
            if i % 2 == 0:
                part = part.lstrip("^")
                parts.append(f'<tspan dy="{-shift}">{part}</tspan>' if shift else part)
                shift = 0
                continue
            shift = 4 if not part.startswith("^") else -6
            parts.append(f'<tspan dy="{shift}" font-size="{size - 4}">{part.lstrip("^")}</tspan>')
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="{anchor}" font-size="{size}"{style}>{"".join(parts)}</text>')

    def svg(self):
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
                f'viewBox="0 0 {self.width} {self.height}" font-family="DejaVu Sans, Arial, sans-serif">')
        ground = f'<rect width="{self.width}" height="{self.height}" fill="white"/>'
        return "\n".join([head, ground, *self.parts, "</svg>", ""])


def curve(function, start, end, n=60):
    return [function(start + (end - start) * i / n) for i in range(n + 1)]


def steps_per_period(degree, error):
    """Steps in a period at which the phase of a linear oscillation is wrong by a part `error`, for Gauss' method of a degree.

    The method multiplies the amplitude by the diagonal Pade approximation R of the exponential function in each step (Hairer and Wanner 1996).

    >>> [round(steps_per_period(k, 1e-3)) for k in (1, 2, 3)]
    [57, 7, 3]
    >>> [round(steps_per_period(k, 1e-6)) for k in (1, 2, 3)]
    [1814, 38, 9]
    """
    k = degree
    weights = [factorial(2 * k - j) * factorial(k) / (factorial(2 * k) * factorial(j) * factorial(k - j)) for j in range(k + 1)]

    def phase_error(n):
        z = 2j * pi / n
        value = lambda x: sum(weight * x**j for j, weight in enumerate(weights))
        # The phase of the quotient is twice the phase of the numerator.
        return abs(2 * phase(value(z)) / abs(z) - 1)

    low, high = 2.2, 1e5
    while high / low > 1 + 1e-9:
        middle = sqrt(low * high)
        low, high = (middle, high) if phase_error(middle) > error else (low, middle)
    return low


def time_element():
    """Trial and test functions of degree 2 over three steps."""
    d = Drawing(640, 330)
    nodes = [60, 240, 400, 580]
    q = lambda x: 95 - 45 * sin((x - 60) / 105) - 0.05 * (x - 60)
    gauss = [0.5 - sqrt(3) / 6, 0.5 + sqrt(3) / 6]
    d.arrow((40, 170), (620, 170)); d.text(622, 188, "t", italic=True)
    d.text(40, 40, "q^h^(t)", BLUE, "start", italic=True)
    for a, b in zip(nodes, nodes[1:]):
        m = (a + b) / 2
        parabola = lambda x: sum(q(p) * w for p, w in ((a, (x - m) * (x - b) / ((a - m) * (a - b))), (m, (x - a) * (x - b) / ((m - a) * (m - b))),
                                                       (b, (x - a) * (x - m) / ((b - a) * (b - m)))))
        d.line(curve(lambda x: (x, parabola(x)), a, b), BLUE, 2.5)
        for c in gauss:
            x = a + c * (b - a)
            d.dot(x, parabola(x), BLUE, fill="white")
    for n, x in enumerate(nodes):
        d.line([(x, 165), (x, 175)])
        d.dot(x, q(x), BLUE)
        d.text(x, 192, f"t_{n}_", italic=True)
    d.arrow((40, 290), (620, 290))
    d.text(40, 222, "test function", RED, "start")
    for (a, b), (u, v) in zip(zip(nodes, nodes[1:]), [(245, 275), (285, 240), (250, 262)]):
        d.line([(a, u), (b, v)], RED, 2.5)
        d.line([(a, 285), (a, 295)]); d.line([(b, 285), (b, 295)])
    d.dot(400, 20, BLUE); d.text(412, 25, "ends of the steps", anchor="start", size=12)
    d.dot(400, 40, BLUE, fill="white"); d.text(412, 45, "Gauss points c_i_", anchor="start", size=12)
    return d


def rule():
    """Where a scheme acts."""
    d = Drawing(680, 190)
    for x, width, lines in [(10, 130, ["nodes", "u_1_, x_1_ .. x_k_"]), (190, 130, ["quadrature point", "G_1_, F′_1_ .. F′_k_"]),
                            (370, 120, ["averaging rule", "P_1_ .. P_k_"]), (540, 130, ["nodes", "f_1_ .. f_k_"])]:
        d.box(x, 40, width, 60, "#fde7d3" if "rule" in lines[0] else LIGHT)
        d.text(x + width / 2, 65, lines[0]); d.text(x + width / 2, 88, lines[1], italic=True)
    for a, b, text in [(140, 190, "grad"), (320, 370, ""), (490, 540, "∫ grad N")]:
        d.arrow((a, 70), (b, 70))
        d.text((a + b) / 2, 30, text, size=12)
    d.box(370, 135, 120, 40); d.text(430, 160, "material W(E)")
    d.arrow((415, 100), (415, 135)); d.text(405, 122, "E", italic=True, anchor="end", size=12)
    d.arrow((445, 135), (445, 100)); d.text(455, 122, "S", italic=True, anchor="start", size=12)
    return d


def chord():
    """A bar that turns by 90 degrees in a step: its middle on the straight path."""
    d = Drawing(420, 290)
    o, length = (60, 250), 200
    at = lambda angle, r=length: (o[0] + r * cos(angle), o[1] - r * sin(angle))
    d.line(curve(at, 0, pi / 2), GREY, 1, "4 4")
    d.line([at(0), at(pi / 2)], GREY, 1, "4 4")
    d.line([o, at(0)], BLUE, 6); d.line([o, at(pi / 2)], BLUE, 6)
    d.line([o, at(pi / 4, length * cos(pi / 4))], RED, 6)
    for angle, r in [(0, length), (pi / 2, length), (pi / 4, length * cos(pi / 4))]:
        d.dot(*at(angle, r), INK, fill="white")
    d.dot(*o)
    d.line([(265, 118), (168, 148)], RED, 1)
    d.text(160, 275, "start"); d.text(30, 150, "end")
    d.text(270, 110, "middle of the step:", RED, "start", 13); d.text(270, 128, "length cos(θ/2)", RED, "start", 13)
    return d


def assumed_strain():
    """Strain of a bar that is stretched by a tenth and turned by 60 degrees, along its straight path, and the assumed strain."""
    d = Drawing(480, 300)
    left, top, width, height = 70, 30, 370, 220
    strain = lambda alpha: ((1 - alpha + alpha * 1.1 * cos(pi / 3)) ** 2 + (alpha * 1.1 * sin(pi / 3)) ** 2 - 1) / 2
    low, high = -0.15, 0.15
    at = lambda alpha, E: (left + width * alpha, top + height * (high - E) / (high - low))
    d.line([at(0, low), at(0, high)]); d.line([at(0, 0), at(1, 0)], GREY, 1)
    d.line([at(1, low), at(1, high)], GREY, 1)
    d.line(curve(lambda a: at(a, strain(a)), 0, 1), RED, 2.5)
    d.line([at(0, 0), at(1, strain(1))], BLUE, 2.5)
    d.dot(*at(0, 0)); d.dot(*at(1, strain(1)))
    for E in (-0.1, 0, 0.1):
        d.text(left - 8, at(0, E)[1] + 5, f"{E:g}".replace("-", "−"), anchor="end", size=12)
    d.text(left, 278, "α = 0", size=12); d.text(left + width, 278, "α = 1", size=12)
    d.text(left + 120, 90, "assumed strain Ẽ(α)", BLUE, "middle", 13)
    d.text(left + 190, 240, "strain of F(α)", RED, "middle", 13)
    d.text(20, 25, "E", italic=True)
    return d


def discrete_gradient():
    """Stored energy over the strain: the secant, and the stress at the middle."""
    d = Drawing(480, 300)
    at = lambda E, W: (60 + 380 * E, 260 - 220 * W)
    energy = lambda E: 0.15 * E + 0.85 * E**4
    a, b = 0.1, 0.95
    m = (a + b) / 2
    d.arrow((40, 260), (460, 260)); d.arrow((60, 280), (60, 15))
    d.text(455, 280, "E", italic=True); d.text(40, 25, "W", italic=True)
    d.line(curve(lambda E: at(E, energy(E)), 0, 1.0), INK, 2.5)
    d.line([at(a, energy(a)), at(b, energy(b))], BLUE, 2)
    slope = 0.15 + 4 * 0.85 * m**3
    d.line([at(m - 0.3, energy(m) - 0.3 * slope), at(m + 0.3, energy(m) + 0.3 * slope)], RED, 2)
    for E, name in [(a, "E_1_"), (m, ""), (b, "E_2_")]:
        d.dot(*at(E, energy(E)), RED if E == m else INK)
        d.text(at(E, 0)[0], 280, name, italic=True)
    d.text(120, 130, "W_2_ − W_1_ over E_2_ − E_1_", BLUE, "start", 13)
    d.text(330, 235, "S at the middle", RED, "start", 13)
    return d


def bracket():
    """The bent bracket in parallel projection, from the numbers of bracket.geo."""
    d = Drawing(500, 330)
    at = lambda x, y, z: (90 + 4.2 * x + 3.4 * y, 285 - 4.2 * z - 1.7 * y + 0.9 * x)
    t, r = 4, 4
    R = r + t
    outer = curve(lambda a: (R - R * sin(a), R - R * cos(a)), 0, pi / 2, 12)
    inner = curve(lambda a: (R - r * sin(a), R - r * cos(a)), 0, pi / 2, 12)
    profile = [(40, 0), *outer, (0, 50), (t, 50), *reversed(inner), (40, t)]
    for y0, y1, fill in [(0, 30, "#dbe4ee")]:
        top = [at(40, y, t) for y in (y0, y1)] + [at(x, y1, z) for x, z in inner] + [at(x, y0, z) for x, z in reversed(inner)]
        d.line(top, INK, 1, close=True, fill="#eef3f8")
        face = [at(t, y0, R), at(t, y1, R), at(t, y1, 50), at(t, y0, 50)]
        d.line(face, INK, 1, close=True, fill=fill)
        d.line([at(0, y0, 50), at(t, y0, 50), at(t, y1, 50), at(0, y1, 50)], INK, 1, close=True, fill="#f7f9fc")
        d.line([at(40, y0, 0), at(40, y1, 0), at(40, y1, t), at(40, y0, t)], INK, 1, close=True, fill="#c9d6e3")
    d.line([at(x, 0, z) for x, z in profile], INK, 1.2, close=True, fill="#c9d6e3")
    for y in (8, 22):
        d.line(curve(lambda a: at(28 + 3 * cos(a), y + 3 * sin(a), t), 0, 2 * pi, 30), RED, 2, close=True, fill="white")
    d.line(curve(lambda a: at(t, 15 + 5 * cos(a), 40 + 5 * sin(a)), 0, 2 * pi, 30), BLUE, 2, close=True, fill="white")
    x, y = at(t, 15, 40)
    d.arrow((x + 100, y + 21), (x + 8, y + 2), BLUE, 3)
    d.text(x + 108, y + 28, "blow on the wall of the eye", BLUE, "start", 13)
    x, y = at(28, 22, t)
    d.text(x + 40, y - 40, "bolts", RED, "start", 13); d.line([(x + 38, y - 42), (x + 4, y - 4)], RED, 1)
    return d


FIGURES = {"time-element": time_element, "averaging-rule": rule, "chord": chord, "assumed-strain": assumed_strain,
           "discrete-gradient": discrete_gradient, "bracket": bracket}

if __name__ == "__main__":
    folder = Path(__file__).parent / "src/figures"
    for name, figure in FIGURES.items():
        path, text = folder / f"{name}.svg", figure().svg()
        if "--check" in sys.argv:
            assert path.read_text() == text, f"{path} is not what figures.py draws"
        else:
            path.write_text(text)
