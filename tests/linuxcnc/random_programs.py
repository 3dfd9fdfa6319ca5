"""Random NC programs that LinuxCNC 2.9 runs: moves, arcs, cycles, modes, offsets, expressions, subroutines, odd spellings."""
import math
import random

PLANES = {17: "XYZ", 18: "ZXY", 19: "YZX"}
CENTRES = {"X": "I", "Y": "J", "Z": "K"}


class RandomProgram:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.lines = ["G21", "G90 G94 G17 G54 S500 F300", "G0 X0 Y0 Z0 A0 C0"]
        self.absolute, self.plane, self.inverse_time, self.inches = True, 17, False, False
        self.label = 100
        # LinuxCNC takes a tool length for one in the new unit there.
        self.changes_unit = self.random.random() < 0.5

    def number(self, value):
        """The value with three or four decimals, spelled in any way."""
        rng = self.random
        text = f"{abs(value):.{4 if self.inches else 3}f}"
        if rng.random() < 0.5:
            text = text.rstrip("0").rstrip(".") or "0"
        if text.startswith("0.") and rng.random() < 0.5:
            text = text[1:]
        if rng.random() < 0.05:
            text = "0" + text
        if len(text) > 1 and rng.random() < 0.05:
            text = text[0] + " " + text[1:]
        return ("-" if value < 0 else rng.choice(["", "", "+"])) + text

    def value(self, value):
        """A number, or an expression of about that value."""
        rng = self.random
        if rng.random() < 0.85:
            return self.number(value)
        angle = rng.uniform(-80, 80)
        name, known = rng.choice([("sin", math.sin(math.radians(angle))), ("COS", math.cos(math.radians(angle))),
                                  ("Tan", math.tan(math.radians(angle))), ("abs", abs(angle))])
        rest = value - 3 * known
        return f"[3 * {name}[{angle:.9f}] {'-' if rest < 0 else '+'} {abs(rest):.9f}*2**[2-1]/2]"

    def length(self, low, high):
        return self.random.uniform(low, high) / (25.4 if self.inches else 1)

    def block(self, *words):
        """Words in any order, some with a number or comment."""
        rng = self.random
        words = list(words)
        if rng.random() < 0.3:
            rng.shuffle(words)
        text = rng.choice([" ", "", " "]).join(w.lower() if rng.random() < 0.2 else w for w in words)
        if rng.random() < 0.1:
            text = f"N{rng.randint(1, 999)} {text}"
        if rng.random() < 0.1:
            text += rng.choice([" (a comment)", " ; G1 X5 (", "(c)"])
        self.lines.append(text)

    def axes(self, letters="XYZAC"):
        chosen = [a for a in letters if self.random.random() < 0.5] or [letters[0]]
        reach = 40 if self.absolute else 6
        return [a + self.value(self.length(-reach, reach) if a in "XYZ" else self.random.uniform(-reach, reach))
                for a in chosen]

    def feed(self):
        if self.inverse_time:
            return ["F" + self.number(self.random.uniform(1, 30))]
        return ["F" + self.number(self.length(100, 900))] if self.random.random() < 0.3 else []

    def straight(self):
        self.block(self.random.choice(["G0", "G00"]), *self.axes())
        self.block(self.random.choice(["G1", "G01", "G 1"]), *self.axes(), *self.feed())
        self.block("G1", *self.axes("AC"), *self.feed())

    def arc(self):
        rng = self.random
        first, second, normal = PLANES[self.plane]
        start = [round(self.length(-20, 20), 3) for _ in range(2)]
        self.block("G90", "G0", f"{first}{start[0]}", f"{second}{start[1]}")
        self.absolute = True
        radius, angle = self.length(2, 30), rng.uniform(0, 2 * math.pi)
        centre = [start[0] + radius * math.cos(angle), start[1] + radius * math.sin(angle)]
        to = angle + math.pi + rng.uniform(0.2, 6)
        end = [centre[0] + radius * math.cos(to), centre[1] + radius * math.sin(to)]
        words = [rng.choice(["G2", "G3"]), f"{first}{end[0]:.6f}", f"{second}{end[1]:.6f}", *self.feed()]
        if rng.random() < 0.3:
            words.append(f"R{math.dist(start, end) * rng.choice([0.6, 1, -1]):.6f}")
        else:
            words += [f"{CENTRES[a]}{c - s:.6f}" for a, c, s in zip((first, second), centre, start)]
            if rng.random() < 0.3:
                words.append("P" + rng.choice(["1", "2", "[1+2]"]))
        if rng.random() < 0.4:
            words.append(normal + self.value(self.length(-9, 9)))
        self.block(*words)

    def cycle(self):
        if self.inverse_time:
            return
        rng = self.random
        first, second, normal = PLANES[self.plane]
        code = rng.choice(["G81", "G82 P.2", "G83 Q1.3", "G73 Q1.7", "G85", "G89 P.1"]).split()
        level, bottom = (self.length(0, 9), self.length(-9, -1)) if self.absolute else (self.length(-4, 3), self.length(-9, -1))
        if self.inches and code[-1][0] == "Q":
            code[-1] = "Q.06"
        self.block(*code, rng.choice(["G98", "G99"]), "R" + self.value(level), normal + self.value(bottom),
                   *self.axes(first + second), "L" + rng.choice(["1", "2"]))
        for _ in range(rng.randint(0, 3)):
            above = ["R" + self.number(level + self.length(0, 4))] if rng.random() < 0.4 else []
            self.block(*self.axes(first + second), rng.choice(["G98", "G99"]), *above, *self.feed())
        self.block("G80")

    def modes(self):
        rng = self.random
        choice = rng.randrange(4)
        if choice == 0:
            self.plane = rng.choice(sorted(PLANES))
            self.block(f"G{self.plane}")
        elif choice == 1:
            self.absolute = rng.random() < 0.6
            self.block("G90" if self.absolute else "G91")
        elif choice == 2:
            self.inverse_time = not self.inverse_time
            self.block("G93" if self.inverse_time else "G94")
            self.block("F" + self.number(self.length(100, 900)))
        elif self.changes_unit and not self.inverse_time:
            self.inches = not self.inches
            # F of this block is in the unit before.
            self.block("G20" if self.inches else "G21", "G1", *self.axes("XYZ"))

    def offsets(self):
        rng = self.random
        choice = rng.randrange(8)
        if choice == 0:
            self.block("G10", "L" + rng.choice(["2", "20"]), f"P{rng.randint(0, 9)}", *self.axes("XYZA"))
        elif choice == 1:
            self.block(rng.choice(["G54", "G55", "G59", "G59.1", "G59.3"]))
        elif choice == 2:
            self.block(rng.choice(["G92", "G52"]), *self.axes())
        elif choice == 3:
            self.block(rng.choice(["G92.1", "G92.2", "G92.3"]))
        elif choice == 4:
            self.block("G43", "H" + rng.choice(["1", "2"]))
        elif choice == 5:
            self.block(rng.choice(["G49", "G43.2 H1", "G43.1 Z3.5"]))
        elif not self.changes_unit:
            self.block(rng.choice(["G28.1", "G30.1", "G28", "G30"]))
            self.block("G90", "G53", "G0", *self.axes("XYZ"))
            self.absolute = True

    def flow(self):
        rng = self.random
        self.label += 1
        label = self.label
        kind = rng.randrange(4)
        if kind == 0:
            self.lines.append(f"o{label} repeat [{rng.randint(0, 3)}]")
            self.straight()
            self.lines.append(f"O{label} endrepeat")
        elif kind == 1:
            self.lines += [f"#1=0 #<_far>={self.value(9)}", f"o{label} while [#1 LT {rng.randint(1, 3)}]", "#1=[#1+1]",
                           "G0 X[#1*2] Y#<_far> (debug, #1)", f"o{label} endwhile"]
        elif kind == 2:
            self.lines += [f"o{label} sub", "G0 X#1 Z[#2/3]", "#3=[#1-#2]",
                           "G0 Y#3", f"o{label} endsub [#3]", f"o{label} call [{self.value(3)}] [{self.value(2)}]",
                           "G0 C#<_value>"]
        else:
            self.lines += [f"o{label} if [{self.value(1)} GT {self.value(2)}]", "G0 X1", f"o{label} else", "G0 Y-1 Z2",
                           f"o{label} endif", "#<near>=[.1+.2]", "G0 X#<near>", "G1 X.3 A40 F300" if not self.inverse_time
                           else "G1 X.3 A40 F3"]

    def text(self):
        parts = [self.straight, self.straight, self.arc, self.arc, self.cycle, self.modes, self.modes, self.offsets,
                 self.offsets, self.flow]
        for _ in range(self.random.randint(6, 16)):
            self.random.choice(parts)()
        return "\n".join([*self.lines, "M2", ""])
