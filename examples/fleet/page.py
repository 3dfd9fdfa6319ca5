"""The page of a fleet: one HTML file that needs nothing else."""

from __future__ import annotations

import datetime
from html import escape
from typing import Any

from campaigns import KINDS
from machines import FIRST_DAY
from scoring import alarm_of
from shards import Settings

POLICY = "default-src 'none'; style-src 'unsafe-inline'"
STYLE = """
:root { --paper: #ffffff; --raised: #f6f7f8; --line: #dfe3e7; --ink: #1a2127; --soft: #56616b; --accent: #0b6e75;
  --bad: #b3261e; color-scheme: light;
  font-family: "Inter", "Segoe UI", system-ui, -apple-system, "Helvetica Neue", "Liberation Sans", Arial, sans-serif; }
@media screen and (prefers-color-scheme: dark) { :root { --paper: #12171b; --raised: #1a2126; --line: #2b343b;
  --ink: #e6eaed; --soft: #a3adb6; --accent: #5cc3c9; --bad: #ff8a80; color-scheme: dark; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); line-height: 1.55; font-variant-numeric: tabular-nums; }
main { max-width: 76rem; margin: 0 auto; padding: 1.5rem 1.25rem 4rem; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 0.4rem; } h2 { font-size: 1.15rem; margin: 2.4rem 0 0.6rem; }
p { max-width: 46rem; overflow-wrap: anywhere; } .soft { color: var(--soft); font-size: 0.875rem; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: 0.75rem; margin: 1.2rem 0; }
.figures div { background: var(--raised); border: 1px solid var(--line); border-radius: 6px; padding: 0.7rem 0.9rem; }
.figures b { display: block; font-size: 1.5rem; line-height: 1.2; } .figures span { color: var(--soft); font-size: 0.8125rem; }
.wide { overflow-x: auto; } table { border-collapse: collapse; width: 100%; font-size: 0.875rem; }
th, td { text-align: left; padding: 0.35rem 0.9rem 0.35rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { color: var(--soft); font-weight: 500; } .n { text-align: right; white-space: nowrap; } td svg { display: block; }
svg .line { fill: none; stroke: var(--accent); stroke-width: 1.5; } svg .limit { stroke: var(--bad); stroke-dasharray: 3 3; }
svg .box { fill: var(--accent); } svg text { fill: var(--soft); font-size: 11px; } svg .axis { stroke: var(--line); }
.delays { width: 100%; max-width: 40rem; }
:focus-visible { outline: 2px solid var(--accent); }
@media (max-width: 40rem) {
  .cards thead { position: absolute; clip-path: inset(50%); width: 1px; height: 1px; overflow: hidden; }
  .cards tr { display: block; padding: 0.6rem 0; border-bottom: 1px solid var(--line); }
  .cards td { display: flex; justify-content: space-between; gap: 1rem; border: 0; padding: 0.1rem 0; text-align: right; }
  .cards td::before { content: attr(data-name); color: var(--soft); text-align: left; white-space: nowrap; }
}
@media print { .wide { overflow: visible; } tr { break-inside: avoid; } body { font-size: 10pt; } main { padding: 0; } }
"""


def date_of(day: int) -> str:
    return (FIRST_DAY + datetime.timedelta(day)).isoformat()


def table(head: list[str], rows: list[list[str]], numbers: set[int], cards: bool = False) -> str:
    def cell(k: int, text: str) -> str:
        kind = ' class="n"' if k in numbers else ""
        return f'<td{kind} data-name="{escape(head[k])}">{text}</td>'
    top = "".join(f'<th scope="col"{" class=" + chr(34) + "n" + chr(34) if k in numbers else ""}>{escape(name)}</th>'
                  for k, name in enumerate(head))
    body = "\n".join("<tr>" + "".join(cell(k, text) for k, text in enumerate(row)) + "</tr>" for row in rows)
    return (f'<div class="wide" tabindex="0"><table{" class=" + chr(34) + "cards" + chr(34) if cards else ""}>'
            f"<thead><tr>{top}</tr></thead><tbody>\n{body}\n</tbody></table></div>")


def chart(one: dict[str, Any]) -> str:
    """The control chart as a small drawing: the average and its limit."""
    lengths, limit = one["lengths"], one["limit"]
    top = max(2 * limit, 1e-9)
    step = 150 / max(len(lengths) - 1, 1)
    points = " ".join(f"{k * step:.1f},{38 - 36 * min(x / top, 1):.1f}" for k, x in enumerate(lengths))
    at = 38 - 36 * limit / top
    return (f'<svg width="152" height="40" viewBox="0 0 152 40" role="img" aria-label="control chart, largest value '
            f'{max(lengths):.1f}, limit {limit:.1f}"><line class="limit" x1="0" x2="150" y1="{at:.1f}" y2="{at:.1f}"/>'
            f'<polyline class="line" points="{points}"/></svg>')


def histogram(delays: list[int], weeks: int = 26) -> str:
    """Detection delays in weeks; the last bar has the longer ones."""
    counts = [0] * (weeks + 1)
    for delay in delays:
        counts[min(delay // 7, weeks)] += 1
    top = max(counts) or 1
    heights = [80 * n / top for n in counts]
    bars = "".join(f'<rect class="box" x="{20 + 20 * k}" y="{90 - height:.1f}" width="16" height="{height:.1f}"/>'
                   for k, height in enumerate(heights))
    labels = "".join(f'<text x="{28 + 20 * k}" y="105" text-anchor="middle">{k}{"+" if k == weeks else ""}</text>'
                     for k in range(0, weeks + 1, 2))
    return (f'<svg viewBox="0 0 570 110" class="delays" role="img" aria-label="detection delays in weeks">{bars}'
            f'<line class="axis" x1="18" x2="562" y1="90" y2="90"/>{labels}<text x="18" y="10">{top}</text></svg>')


def service_row(row: dict[str, Any], alarm: dict[str, Any]) -> list[str]:
    unit = "&micro;rad" if alarm["unit"] == "urad" else "&micro;m"
    return [str(row["machine"]),
            f"<div>{escape(alarm['error'])}<br><span class=\"soft\">{escape(alarm['words'])}</span></div>",
            f"{alarm['change']:+.1f} &plusmn; {alarm['expanded_uncertainty']:.1f} {unit}",
            f"{alarm['at_tool_um']:.1f} &micro;m", date_of(alarm["since"]), date_of(alarm["day"]),
            escape(alarm["kind"]), chart(row[alarm["kind"]])]


def service_table(rows: list[dict[str, Any]]) -> str:
    found = [(row, alarm) for row, alarm in ((row, alarm_of(row)) for row in rows) if alarm]
    if not found:
        return "<p>None.</p>"
    found.sort(key=lambda each: (-each[1]["at_tool_um"], each[0]["machine"]))
    head = ["Machine", "Error", "Change, U (k = 2)", "At the tool", "After", "Alarm", "By", "Chart"]
    return table(head, [service_row(row, alarm) for row, alarm in found], {0, 2, 3}, True)


def times_section(times: list[dict[str, Any]]) -> str:
    shards = [one for one in times if "identify_s" in one]
    if not shards:
        return ""
    campaigns = sum(one["campaigns"] for one in shards) or 1
    spent = {name: sum(one[key] for one in shards) for name, key in (
        ("simulated readings", "measure_s"), ("identification", "identify_s"), ("histories", "history_s"),
        ("charts and comparisons", "judge_s"))}
    lines = [[name, f"{seconds:.0f} s", f"{1e3 * seconds / campaigns:.1f} ms"] for name, seconds in spent.items()]
    wall = sum(one.get("wall_s", 0) for one in times)
    done = sum(one["campaigns"] for one in times if "wall_s" in one)
    rate = f"<p>{done} campaigns in {wall:.0f} s: {done / wall:.1f} a second.</p>" if wall > 0 and done else ""
    return "<h2>Times</h2>" + rate + table(["Step", "Processor, all workers", "One campaign"], lines, {1, 2})


def events_table(score: dict[str, Any]) -> str:
    def quantile(delays: list[int], share: float) -> str:
        return f"{delays[min(int(share * len(delays)), len(delays) - 1)]} d" if delays else "none"
    lines = [[escape(name), str(one["machines"]), str(one["detected"]), str(one["undetected"]), str(one["before"]),
              quantile(one["delays_days"], 0.5), quantile(one["delays_days"], 0.9)]
             for name, one in score["events"].items()]
    head = ["Event", "Machines", "Detected", "Undetected", "Alarm before it", "Median delay", "90 % within"]
    return table(head, lines, {1, 2, 3, 4, 5, 6}, True)


def figures(settings: Settings, score: dict[str, Any]) -> str:
    alarms = score["false_alarms"]
    events = score["events"].values()
    delays = [delay for one in events for delay in one["delays_days"]]
    shown = [(str(score["alarms"]), f"of {settings.machines} machines need service"),
             (f"{100 * alarms['share']:.2f} %", f"false alarms in {settings.weeks} weeks; expected at most "
                                               f"{100 * alarms['expected']:.2f} %"),
             (f"{len(delays)} of {sum(one['machines'] for one in events)}", "events detected"),
             (f"{sorted(delays)[len(delays) // 2]} d" if delays else "none", "median detection delay")]
    boxes = "".join(f"<div><b>{big}</b><span>{small}</span></div>" for big, small in shown)
    return f'<div class="figures">{boxes}</div>'


def percent(share: float) -> str:
    return f"{100 * share:.2f}"


def squares_words(name: str, one: dict[str, Any]) -> str:
    least, *_, most = sorted(one["by_error"].items(), key=lambda each: each[1])
    return (f"{name} {one['all']:.3f}, by error {least[1]:.2f} ({escape(least[0])}) to {most[1]:.2f} "
            f"({escape(most[0])}) with a standard deviation of {one['standard_deviation']:.2f}")


def page_html(settings: Settings, rows: list[dict[str, Any]], score: dict[str, Any],
              times: list[dict[str, Any]]) -> str:
    alarms = score["false_alarms"]
    squares = score["mean_square_of_innovations"]
    delays = [delay for one in score["events"].values() for delay in one["delays_days"]]
    checked = "; ".join(squares_words(kind.name, squares[kind.name]) for kind in KINDS if squares[kind.name])
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<title>Fleet: machines that need service</title><style>{STYLE}</style></head><body><main>
<h1>Machines that need service</h1>
<p class="soft">{settings.machines} simulated machines, {date_of(0)} to {date_of(7 * settings.weeks - 1)}; ball bar
every week, tracker every four weeks. Seed {settings.seed}.</p>
{figures(settings, score)}
<h2>Need service now</h2>
<p class="soft">The error that changed most, against its expanded uncertainty, from the last campaign before the change
(After) to the alarm. The largest effect at the tool is first. Chart: average of the innovations, with its limit.</p>
{service_table(rows)}
<h2>Against the truth</h2>
<p>False alarms: {alarms['machines']} of {alarms['of']} machines without an event ({percent(alarms['share'])} %; 95 %
interval {percent(alarms['interval'][0])} to {percent(alarms['interval'][1])} %) in {alarms['years']:.1f} machine-years.
Expected from the rule: {percent(alarms['expected_at_least'])} to {percent(alarms['expected'])} %. Machines with an event
that had an alarm before it: {score['before_event']}.</p>
<p>Mean square of the standardised innovations of machines without an event, which is 1 if drift, scatter and
uncertainties are as stated: {checked or "not enough campaigns"}.</p>
{events_table(score)}
<h2>Detection delay, weeks</h2>
{histogram(delays)}
<p class="soft">From the event to the alarm. Wear begins slowly: its delay counts from the first day of the wear.</p>
{times_section(times)}
</main></body></html>
"""
