// Cross-sections of an engraved curve: what was scanned and what was fitted, one section at a time.

import {ContourSection} from './data';
import {field, html, responsive, svg} from './dom';
import {count, quantity} from './format';
import {dots, line, plot, Plot} from './plot';
import {extent} from './scale';

const kHighest = 460;
const kLowest = 200;
const kAround = 18 + 40;  // px above and below the area of a plot

type Range = [number, number];

const widened = ([low, high]: Range, by: number): Range => [low - by, high + by];

/// A plot with one scale in both directions, the data in its middle.
function alikePlot(width: number, across: Range, height: Range, description: string): Plot {
  let [u, v] = [across, height];
  let pixels = Math.round(kHighest / 2);
  let made: Plot | undefined;
  // The labels of the axis decide how wide the area is, the width how high it is, and that about the labels.
  for (let pass = 0; pass < 3; ++pass) {
    made = plot({width, height: pixels, x: {label: 'across the curve / µm', range: u}, y: {label: 'out of the surface / µm', range: v}, zeroLine: true, description});
    const area = made.area.right - made.area.left;
    const least = area / (across[1] - across[0]);
    const high = Math.min(kHighest, Math.max(kLowest, kAround + least * (height[1] - height[0])));
    const scale = Math.min(least, (high - kAround) / (height[1] - height[0]));
    u = widened(across, (area / scale - (across[1] - across[0])) / 2);
    v = widened(height, ((Math.round(high) - kAround) / scale - (height[1] - height[0])) / 2);
    pixels = Math.round(high);
  }
  return plot({width, height: pixels, x: {label: 'across the curve / µm', range: u}, y: {label: 'out of the surface / µm', range: v}, zeroLine: true, description});
}

/// Signs that are told apart without their colours: where the rounding begins, the corner, the commanded curve.
const kSigns: Record<string, (x: number, y: number) => string> = {
  onset: (x, y) => `M${x} ${y - 5}l5 9h-10Z`,
  corner: (x, y) => `M${x - 5} ${y - 5}l10 10M${x - 5} ${y + 5}l10 -10`,
  command: (x, y) => `M${x - 5} ${y}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0`,
};

function sign(target: Plot, [u, v]: number[], kind: string): void {
  target.layer.append(svg('path', {d: kSigns[kind](target.x(u), target.y(v)), class: `mark-of ${kind}`}));
}

function drawn(one: ContourSection, width: number): Element {
  const edges = one.edges ?? [];
  const u = extent([0, ...one.across_um, ...edges.flatMap((edge) => [...edge.across_um, edge.P2_um[0]])]);
  const v = extent([0, ...one.height_um, ...edges.flatMap((edge) => [...edge.height_um, edge.P2_um[1]])]);
  const margin = 0.04 * Math.max(u[1] - u[0], v[1] - v[0], 1);
  const target = alikePlot(width, widened(u, margin), widened(v, margin), `Section ${one.name}`);
  dots(target, one.across_um, one.height_um, 'scanned');
  for (const edge of edges) {
    line(target, edge.across_um, edge.height_um, 'edge');
    sign(target, edge.P1_um, 'onset');
    sign(target, edge.P2_um, 'corner');
  }
  sign(target, [0, 0], 'command');
  return target.root;
}

function words(one: ContourSection): string {
  const where = one.s_mm === undefined ? '' : ` at ${quantity(one.s_mm, 'mm', 5)}`;
  const says = one.not_evaluated !== undefined || one.error_um === undefined ? `not evaluated: ${one.not_evaluated ?? ''}`
    : `contour error ${quantity(one.error_um, 'µm', 4)}${one.u_um === undefined ? '' : ` ± ${quantity(2 * one.u_um, 'µm', 2)} (k = 2)`}`;
  return `Section ${one.name}${where}: ${says}.`;
}

/// @param all  how many there are, of which these are drawn
export function sectionsOf(sections: ContourSection[], all: number, id: string): HTMLElement {
  // The one with the largest contour error at first.
  const amount = (one: ContourSection) => (one.error_um === undefined ? -1 : Math.abs(one.error_um));
  let shown = sections.reduce((best, one, i) => (amount(one) > amount(sections[best]) ? i : best), 0);
  const choice = html('select', {id}, ...sections.map((one, i) => html('option', {value: i}, one.name)));
  const [back, on] = [html('button', {type: 'button'}, 'Previous'), html('button', {type: 'button'}, 'Next')];
  const box = html('div', {class: 'drawing contour-section'});
  const caption = html('figcaption', {'aria-live': 'polite'});
  const redraw = responsive(box, (width) => drawn(sections[shown], width));
  const show = (i: number) => {
    shown = Math.min(sections.length - 1, Math.max(0, i));
    choice.value = String(shown);
    back.disabled = shown === 0;
    on.disabled = shown === sections.length - 1;
    caption.textContent = words(sections[shown]);
    redraw();
  };
  choice.addEventListener('change', () => show(Number(choice.value)));
  back.addEventListener('click', () => show(shown - 1));
  on.addEventListener('click', () => show(shown + 1));
  show(shown);
  const entry = (style: string, text: string) => html('span', {}, html('i', {class: style, 'aria-hidden': 'true'}), text);
  const signed = (kind: string, text: string) =>
    html('span', {}, svg('svg', {width: 14, height: 14, viewBox: '0 0 14 14', 'aria-hidden': 'true'}, svg('path', {d: kSigns[kind](7, 7), class: `mark-of ${kind}`})), text);
  return html('div', {class: 'contour-sections'},
    html('h3', {}, 'Sections'),
    html('div', {class: 'controls'}, field('Section', choice), sections.length > 1 && back, sections.length > 1 && on,
      all > sections.length && html('span', {class: 'note'}, `${count(sections.length)} of ${count(all)} are drawn`)),
    html('figure', {}, html('p', {class: 'legend'}, entry('dot scanned', 'scanned'), entry('stroke edge', 'surface, rounding, wall'), signed('onset', 'P1'),
      signed('corner', 'P2'), signed('command', 'commanded curve')), box, caption));
}
