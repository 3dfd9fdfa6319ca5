"""Curves over the hours of a day as SVG, wide for a screen and narrow for a telephone, in the colours of the page."""
from html import escape

WIDE, NARROW = 860, 340
HEIGHT = {WIDE: 300, NARROW: 230}


def ticks(low, high, most):
    """Round numbers from low to high, at most so many."""
    for step in (s * 10.0**e for e in range(-3, 4) for s in (1, 2, 5)):
        first, last = -(-low // step), high // step
        if last - first + 1 <= most:
            return [k * step for k in range(int(first), int(last) + 1)]
    return [low, high]


def text_of(value):
    return f"{value:g}".replace("-", "\u2212")


class Drawing:
    """One drawing: hours from `first` to `first` + 24 across, a value from `low` to `high` upwards."""

    def __init__(self, width, first, low, high, label):
        self.width, self.height, self.first, self.low, self.high = width, HEIGHT[width], first, low, high
        self.left, self.right, self.top, self.bottom = 40, width - 8, 32, self.height - 36
        self.parts = ['<g class="grid">']
        for value in ticks(low, high, 7):
            kind = ' class="zero"' if value == 0 else ""
            y = self.y(value)
            self.parts.append(f'<line{kind} x1="{self.left}" x2="{self.right}" y1="{y:.1f}" y2="{y:.1f}"/>')
        self.parts.append("</g>")
        self.text("axis-label", 0, 11, label)
        for value in ticks(low, high, 7):
            self.text("tick end", self.left - 6, self.y(value) + 4, text_of(value))
        for hour in range(0, 25, 2 if width == WIDE else 4):
            place = {0: "", 24: " end"}.get(hour, " middle")
            self.text("tick" + place, self.x(first + hour), self.bottom + 16, hour)
        self.text("axis-label end", self.right, self.height - 4, "hour of the unseen day")

    def text(self, style, x, y, words):
        self.parts.append(f'<text class="{style}" x="{x:.1f}" y="{y:.1f}">{escape(str(words))}</text>')

    def x(self, hour):
        return self.left + (self.right - self.left) * (hour - self.first) / 24

    def y(self, value):
        return self.bottom - (self.bottom - self.top) * (value - self.low) / (self.high - self.low)

    def points(self, hours, values):
        return " ".join(f"{self.x(h):.1f},{self.y(v):.1f}" for h, v in zip(hours, values))

    def line(self, hours, values, style):
        self.parts.append(f'<polyline class="line {style}" points="{self.points(hours, values)}"/>')

    def dots(self, hours, values, style):
        path = "".join(f"M{self.x(h):.1f} {self.y(v):.1f}h0" for h, v in zip(hours, values))
        self.parts.append(f'<path class="dots {style}" d="{path}"/>')

    def band(self, hours, low, high):
        outline = self.points(hours, low) + " " + self.points(hours[::-1], high[::-1])
        self.parts.append(f'<polygon class="band" points="{outline}"/>')

    def span(self, start, end, style):
        """Something that lasted, over the whole height."""
        x, width = self.x(max(start, self.first)), self.x(min(end, self.first + 24)) - self.x(max(start, self.first))
        self.parts.append(f'<rect class="{style}" x="{x:.1f}" y="{self.top}" width="{max(width, 1.5):.1f}" '
                          f'height="{self.bottom - self.top}"/>')

    def strip(self, start, end, strength):
        """A program, above the curves; the stronger the faster the spindle."""
        x, width = self.x(start), self.x(end) - self.x(start)
        self.parts.append(f'<rect class="program" style="fill-opacity:{0.15 + 0.75 * strength:.2f}" x="{x:.1f}" '
                          f'y="{self.top - 8}" width="{max(width - 0.8, 1):.1f}" height="7"/>')

    def svg(self, style, description):
        return (f'<svg class="{style}" viewBox="0 0 {self.width} {self.height}" role="img" '
                f'aria-label="{escape(description)}">{"".join(self.parts)}</svg>')


def both(draw, first, low, high, label, description):
    """The same drawing wide and narrow. @param draw  puts the curves into a Drawing"""
    drawings = []
    for width, style in ((WIDE, "wide"), (NARROW, "narrow")):
        drawing = Drawing(width, first, low, high, label)
        draw(drawing)
        drawings.append(drawing.svg(style, description))
    return "".join(drawings)
