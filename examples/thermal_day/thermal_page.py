"""The page of the thermal day: one file without a script, in the design of the reports (web/src/style.css)."""
import os
import pathlib
import re
from html import escape

import numpy as np
from svg_curves import both

STYLE = pathlib.Path(__file__).resolve().parents[2] / "web" / "src" / "style.css"
DARK = ':root[data-theme="dark"]'
CASES = {"before": "before", "geometric": "geometric compensation", "thermal": "geometric and thermal compensation"}
OWN_STYLE = """
.door { fill: var(--below); fill-opacity: 0.22; }
.program { fill: var(--soft); }
.dots.day { stroke-width: 3.4; }
.of-case-before { stroke: var(--truth); }
.of-case-geometric { stroke: var(--before); }
.of-case-thermal { stroke: var(--after); }
.legend .dot.of-case-before { background: var(--truth); }
.legend .dot.of-case-geometric { background: var(--before); }
.legend .stroke.of-case-geometric { border-color: var(--before); }
.legend .block { width: 0.9rem; height: 0.7rem; background: var(--band); }
.legend .block.door { background: var(--below); opacity: 0.4; }
.legend .block.program { background: var(--soft); }
.line.thin { stroke-width: 1.3; }
.curve-1 { stroke: var(--s1); } .curve-2 { stroke: var(--s2); } .curve-3 { stroke: var(--s3); }
.curve-4 { stroke: var(--s4); } .curve-5 { stroke: var(--s5); } .dashed { stroke-dasharray: 5 3; }
.legend .stroke.curve-1 { border-color: var(--s1); } .legend .stroke.curve-2 { border-color: var(--s2); }
.legend .stroke.curve-3 { border-color: var(--s3); } .legend .stroke.curve-4 { border-color: var(--s4); }
.legend .stroke.curve-5 { border-color: var(--s5); } .legend .stroke.dashed { border-top-style: dashed; }
"""


def style():
    """That of the reports. There a script chooses the dark colours; here the reader's setting does."""
    text = STYLE.read_text(encoding="utf-8")
    dark = re.findall(r"^:root\[data-theme=\"dark\"\][^{,]*\{[^}]*\}\n?", text, re.MULTILINE)
    if len(dark) < 2:
        raise ValueError(f"{STYLE}: no dark colours")
    for rule in dark:
        night = "@media screen and (prefers-color-scheme: dark) { " + rule.replace(DARK, ":root", 1).strip() + " }\n"
        text = text.replace(rule, night, 1)
    colours = (":root .with-curves { --s1: var(--after); --s2: var(--before); --s3: #4a5fa5; --s4: #8a3d7c; "
               "--s5: #66741a; }\n")
    night = ("@media screen and (prefers-color-scheme: dark) { :root .with-curves { --s3: #93a7f0; --s4: #d68fca; "
             "--s5: #b8c85c; } }\n")
    return text + colours + night + OWN_STYLE


def um(value):
    return f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def tile(heading, value, unit, note, state=""):
    return (f'<div class="tile"><h3>{heading}</h3><div class="side {state}"><span class="figure">{value} '
            f'<small>{unit}</small></span><span class="note">{note}</span></div></div>')


def legend(entries):
    if not entries:
        return ""
    keys = "".join(f'<span><i class="{kind}" aria-hidden="true"></i>{escape(text)}</span>' for kind, text in entries)
    return f'<p class="legend">{keys}</p>'


def figure(drawing, caption, entries):
    return (f'<figure class="made in-two large with-curves">{legend(entries)}<div class="drawing">{drawing}</div>'
            f"<figcaption>{caption}</figcaption></figure>")


def events(drawing, result):
    first, last = result["unseen"]
    for door in result["days"].doors:
        if first <= door.start < last:
            drawing.span(door.start, door.end, "door")
    for job in result["days"].jobs:
        if first <= job.start < last:
            drawing.strip(job.start, job.end, job.speed)


EVENTS = [("block door", "door open"), ("block program", "program running, stronger: faster spindle")]


def temperatures(result):
    hours, record = result["record"]
    day = hours >= result["unseen"][0]
    groups = [("curve-1", ""), ("curve-2", ""), ("curve-3", ""), ("curve-4", ""), ("curve-5", "")]
    names = list(result["sensors"])
    styles = {name: groups[k % 5][0] + (" dashed" if k >= 5 else "") for k, name in enumerate(names)}
    low = min(values[day].min() for values in record.values())
    high = max(values[day].max() for values in record.values())

    def draw(drawing):
        events(drawing, result)
        for name in names:
            drawing.line(hours[day][::3], record[name][day][::3], "thin " + styles[name])

    drawing = both(draw, result["unseen"][0], np.floor(low - 2), np.ceil(high + 1), "temperature / \u00b0C",
                   "Temperatures over the unseen day")
    return figure(drawing, "What the ten thermometers record, with their noise, lag and last digit. The compensation "
                  "in LinuxCNC sees these values and nothing else.",
                  [(f"stroke {styles[name]}", name.replace("_", " ")) for name in names] + EVENTS)


def all_over_the_travel(result):
    hours, errors, predicted = result["course"]
    length = {case: np.linalg.norm(of, axis=1) for case, of in errors.items()}

    def draw(drawing):
        events(drawing, result)
        for case in CASES:
            drawing.dots(hours, length[case], f"day of-case-{case}")

    highest = 1.05 * max(of.max() for of in length.values())
    drawing = both(draw, result["unseen"][0], 0, highest, "displacement / \u00b5m",
                   "Displacement of the functional point at poses all over the travel")
    keys = [(f"dot of-case-{case}", words) for case, words in CASES.items()]
    first = figure(drawing, f"Displacement of the functional point at {len(hours)} random poses, after the best fit of "
                   "the workpiece datum: one for the whole day.", keys + EVENTS)

    def close(drawing):
        events(drawing, result)
        drawing.band(hours, np.zeros(len(hours)), 2 * predicted)
        drawing.dots(hours, length["thermal"], "day of-case-thermal")

    highest = 1.1 * max(length["thermal"].max(), 2 * predicted.max())
    drawing = both(close, result["unseen"][0], 0, highest, "displacement / \u00b5m",
                   "What geometric and thermal compensation leaves, and what was predicted")
    covered = 100 * result["figures"]["covered"]
    second = figure(drawing, f"The lowest points alone. Band: predicted expanded uncertainty of the length, k = 2; "
                    f"{covered:.0f}\u202f% of the poses lie in it.",
                    [("dot", CASES["thermal"]), ("block", "predicted, k = 2"), *EVENTS])
    return first, second


def same_place(result):
    hours, displacements = result["same"]
    drawings = []
    lowest = min((1e3 * (of - of.mean(axis=0))).min() for of in displacements.values())
    highest = max((1e3 * (of - of.mean(axis=0))).max() for of in displacements.values())
    for k, axis in enumerate("XYZ"):
        def draw(drawing, k=k):
            events(drawing, result)
            for case in ("geometric", "thermal"):
                values = 1e3 * (displacements[case][:, k] - displacements[case][:, k].mean())
                drawing.line(hours, values, f"of-case-{case}")

        drawing = both(draw, result["unseen"][0], 1.08 * lowest, 1.08 * highest, f"{axis} / \u00b5m",
                       f"Drift along {axis} of the tool over the middle of the table")
        keys = [("stroke of-case-geometric", CASES["geometric"]), ("stroke", CASES["thermal"]), *EVENTS]
        drawings.append(figure(drawing, f"{axis}, less its mean over the day.", keys if axis == "X" else []))
    return "".join(drawings)


def row(words, mean, largest=""):
    return f'<tr><th scope="row">{words}</th><td class="number">{mean}</td><td class="number">{largest}</td></tr>'


def table(result):
    figures = result["figures"]
    rows = "".join(row(words, um(figures[case]), um(figures["largest"][case])) for case, words in CASES.items())
    rows += (row("predicted standard uncertainty", um(figures["predicted"]))
             + row("of this: identified parameters", um(figures["parameters"]))
             + row("of this: what no parameter explains", um(figures["pose"])))
    return ('<div class="scroll"><table class="piece-figures"><thead><tr><th scope="col">displacement of the '
            'functional point, \u00b5m</th><th scope="col" class="number">root mean square</th>'
            '<th scope="col" class="number">'
            f"largest</th></tr></thead><tbody>{rows}</tbody></table></div>")


def body(result):
    figures, (least, ratio) = result["figures"], result["goals"]
    verdict = (f"At hours that the identification has not seen, the tool is {figures['reduction']:.1f} times nearer to "
               f"its place than with geometric compensation alone: {um(figures['thermal'])}\u202f\u00b5m instead of "
               f"{um(figures['geometric'])}\u202f\u00b5m. That is {figures['ratio']:.2f} times the predicted "
               "uncertainty.")
    if not figures["reached"]:
        verdict += f" The goals, {least} times and at most {ratio}, are missed."
    tiles = (tile("Before", um(figures["before"]), "\u00b5m", "nothing compensated")
             + tile("Geometric", um(figures["geometric"]), "\u00b5m", "same readings, no thermometers", "before")
             + tile("Geometric and thermal", um(figures["thermal"]), "\u00b5m", "ten thermometers, six lags", "after")
             + tile("Predicted", um(figures["predicted"]), "\u00b5m", "standard uncertainty, before the day")
             + tile("Better", f"{figures['reduction']:.1f}", "times", f"goal: {least}"))
    first, second = all_over_the_travel(result)
    return f"""<div class="bar"><span class="brand">Abbe</span><nav aria-label="Sections"><a href="#day">Unseen day</a>
<a href="#temperatures">Temperatures</a><a href="#place">One place</a><a href="#figures">Figures</a>
<a href="#how">How</a></nav></div>
<main><div class="overview"><h1>A thermal day of a mill, in LinuxCNC</h1>
<p class="subtitle">A simulated machine with hidden geometric and thermal errors, identified over three days and
compensated on another one with other programs, other weather and other open doors</p>
<p class="verdict">{verdict}</p><div class="tiles small">{tiles}</div>
<p class="note">Root mean square of the displacement of the functional point at {figures['poses']} random poses over 24
hours, after the best fit of the workpiece datum.</p></div>
<section id="day"><h2>The unseen day</h2><p class="lead">Joints are those that a real LinuxCNC commanded, with the
compensation in its kinematics. Where the tool then is, the hidden machine says.</p>{first}{second}</section>
<section id="temperatures"><h2>Temperatures</h2>{temperatures(result)}</section>
<section id="place"><h2>One place, all day</h2><p class="lead">The tool over the middle of the table, every
{result['every_min']:.0f} minutes.</p>{same_place(result)}</section>
<section id="figures"><h2>Figures</h2>{table(result)}
<p class="note">The predicted uncertainty is that of the identification: the covariance of its parameters, and the pose
noise that it estimated from the training days by restricted maximum likelihood, which is what the model lacks.</p>
</section>
<section id="how"><h2>How this came about</h2><ul class="plain">
<li>Hidden: heat in rods and plates by finite volumes, losses of spindle and screws, hall air with open doors. The
machine bends and grows by its temperature fields. The identified model has none of this: it is error terms times
measured temperatures and first-order lags.</li>
<li>Identified from a laser tracker on the table, {result['trained_poses']} poses over three days, and from ten
thermometers. The geometric errors alone come from the same readings.</li>
<li>Both compensations were frozen (abbe compensate freeze) and ran in a real LinuxCNC. The day took
{24 * 3600 / result['factor']:.0f}\u202fs there: time constants were divided by {result['factor']}, rates multiplied by
it, and every pose was judged at the hour at which it was reached.</li>
<li>Checked: lags in LinuxCNC are within {result['lag_off']:.2f}\u202fK of the solution of their equations, corrections
within {1e3 * result['correction_off']:.0f}\u202fnm of a second computation from the identified errors.</li></ul>
</section></main>
<footer>Equations, sources and limits: docs/thermal-day.md</footer>"""


def write_page(path, result):
    head = ('<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
            'style-src \'unsafe-inline\'; img-src data:">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            '<meta name="color-scheme" content="light dark">\n<title>A thermal day of a mill</title>\n'
            f'<link rel="icon" href="data:,">\n<style>{style()}</style>\n')
    page = f'<!doctype html>\n<html lang="en">\n<head>\n{head}</head>\n<body>\n{body(result)}\n</body>\n</html>\n'
    unfinished = path.with_name(f".{path.name}.unfinished")
    unfinished.write_text(page, encoding="utf-8")
    os.replace(unfinished, path)
