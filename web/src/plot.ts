// Plots in two dimensions: one frame, few ticks, units on both axes.

import {axisLabel, axisLabelLines, kLine, svg} from './dom';
import {linearScale, logScale, Scale} from './scale';

export interface AxisOptions {
  label: string;
  range: [number, number];
  log?: boolean;
  angle?: boolean;
  nice?: boolean;
  ticks?: {at: number; label: string}[];
}

export interface PlotOptions {
  width: number;
  height: number;
  x: AxisOptions;
  y: AxisOptions;
  /// Said to those who do not see the drawing.
  description: string;
  zeroLine?: boolean;
  compact?: boolean;
}

export interface Plot {
  root: SVGSVGElement;
  x: Scale;
  y: Scale;
  layer: SVGGElement;
  area: {left: number; right: number; top: number; bottom: number};
}

let clipCount = 0;

function axisScale(options: AxisOptions, pixels: [number, number], wanted: number): Scale {
  return options.log
    ? logScale(options.range, pixels, wanted)
    : linearScale(options.range, pixels, wanted, {angle: options.angle, nice: options.nice});
}

export function plot(options: PlotOptions): Plot {
  const {width, height} = options;
  const words = axisLabelLines(options.x.label, width - 24);
  const bottom = height - (options.compact ? 34 : 40) - kLine * (words.length - 1);
  const top = 18;
  const y = axisScale(options.y, [bottom, top], Math.max(2, (bottom - top) / 22));
  const yTicks = options.y.ticks ?? y.ticks.map((at) => ({at, label: y.label(at)}));
  const widest = Math.max(1, ...yTicks.map((tick) => tick.label.length));
  const left = 14 + widest * 6.4;
  const right = width - 18;
  const x = axisScale(options.x, [left, right], Math.max(2, (right - left) / 74));
  const xTicks = options.x.ticks ?? x.ticks.map((at) => ({at, label: x.label(at)}));

  const root = svg('svg', {
    viewBox: `0 0 ${width} ${height}`,
    width,
    height,
    class: 'plot',
    role: 'img',
    'aria-label': options.description,
  });
  const grid = svg('g', {class: 'grid', 'aria-hidden': 'true'});
  for (const tick of yTicks) {
    const at = y(tick.at);
    grid.append(svg('line', {x1: left, x2: right, y1: at, y2: at}));
    grid.append(svg('text', {x: left - 7, y: at + 3.5, class: 'tick end'}, tick.label));
  }
  for (const tick of xTicks) {
    const at = x(tick.at);
    grid.append(svg('line', {x1: at, x2: at, y1: bottom, y2: bottom + 4, class: 'mark'}));
    // Long names at an end stay inside of the drawing.
    const half = 3.2 * tick.label.length;
    const [place, style] = at + half > width ? [width, 'tick end'] : at - half < 0 ? [0, 'tick'] : [at, 'tick middle'];
    grid.append(svg('text', {x: place, y: bottom + 16, class: style}, tick.label));
  }
  grid.append(svg('line', {x1: left, x2: right, y1: bottom, y2: bottom, class: 'mark'}));
  if (options.zeroLine && y.from < 0 && y.to > 0)
    grid.append(svg('line', {x1: left, x2: right, y1: y(0), y2: y(0), class: 'zero'}));
  root.append(grid);
  const clip = `clip${++clipCount}`;
  root.append(
    svg('clipPath', {id: clip}, svg('rect', {x: left - 4, y: top - 4, width: Math.max(1, right - left + 8), height: bottom - top + 6})),
  );
  const layer = svg('g', {'clip-path': `url(#${clip})`});
  root.append(layer);
  root.append(axisLabel(words, right, height - 4));
  root.append(svg('text', {x: 2, y: 9, class: 'axis-label'}, options.y.label));
  return {root, x, y, layer, area: {left, right, top, bottom}};
}

type Values = readonly (number | null | undefined)[];

const round = (value: number) => Math.round(value * 10) / 10;

export function linePath(target: Plot, xs: Values, ys: Values): string {
  let path = '';
  let pen = false;
  for (let i = 0; i < xs.length; ++i) {
    const x = xs[i];
    const y = ys[i];
    if (x === null || x === undefined || y === null || y === undefined || !Number.isFinite(target.y(y))) {
      pen = false;
      continue;
    }
    path += `${pen ? 'L' : 'M'}${round(target.x(x))} ${round(target.y(y))}`;
    pen = true;
  }
  return path;
}

export function line(target: Plot, xs: Values, ys: Values, style: string): void {
  target.layer.append(svg('path', {d: linePath(target, xs, ys), class: `line ${style}`}));
}

export function band(target: Plot, xs: readonly number[], low: readonly number[], high: readonly number[], style: string): void {
  const up = xs.map((x, i) => `${round(target.x(x))} ${round(target.y(high[i]))}`);
  const down = xs.map((x, i) => `${round(target.x(x))} ${round(target.y(low[i]))}`).reverse();
  target.layer.append(svg('path', {d: `M${up.join('L')}L${down.join('L')}Z`, class: `band ${style}`}));
}

/// One path for all dots: thousands of them stay light.
export function dots(target: Plot, xs: Values, ys: Values, style: string): void {
  let path = '';
  for (let i = 0; i < xs.length; ++i) {
    const x = xs[i];
    const y = ys[i];
    if (x === null || x === undefined || y === null || y === undefined || !Number.isFinite(target.y(y))) continue;
    path += `M${round(target.x(x))} ${round(target.y(y))}h0`;
  }
  target.layer.append(svg('path', {d: path, class: `dots ${style}`}));
}

export function rule(target: Plot, at: number, direction: 'x' | 'y', style: string, label?: string, row = 0, before = false): void {
  const {left, right, top, bottom} = target.area;
  if (direction === 'x') {
    const x = target.x(at);
    target.root.append(svg('line', {x1: x, x2: x, y1: top + 14 * row, y2: bottom, class: `rule ${style}`}));
    if (label) {
      // Over a curve that rises the room is before the line, or else under it behind the line.
      const needed = 6.1 * label.length + 5;
      const atEnd = (before && x - left > 150) || x > (left + right) / 2 + (right - left) / 4 || (x + needed > right + 16 && x - needed > 0);
      const under = before && !atEnd;
      target.root.append(
        svg('text', {x: x + (atEnd ? -5 : 5), y: (under ? (top + bottom) / 2 + 20 : top + 9) + 14 * row, class: `rule-label ${style} ${atEnd ? 'end' : ''}`}, label),
      );
    }
  } else {
    const y = target.y(at);
    target.root.append(svg('line', {x1: left, x2: right, y1: y, y2: y, class: `rule ${style}`}));
    if (label) target.root.append(svg('text', {x: right - 2, y: y - 4, class: `rule-label ${style} end`}, label));
  }
}

/// A line of text that says what is under the pointer, nearest in x.
export function readout(target: Plot, xs: readonly number[], text: (index: number) => string): void {
  const {left, right, top, bottom} = target.area;
  const cursor = svg('line', {y1: top, y2: bottom, class: 'cursor', visibility: 'hidden'});
  const words = svg('text', {x: right, y: 9, class: 'readout end'});
  const pad = svg('rect', {x: left, y: top, width: Math.max(1, right - left), height: bottom - top, class: 'pad'});
  pad.addEventListener('pointermove', (event) => {
    const box = target.root.getBoundingClientRect();
    const pixel = ((event.clientX - box.left) / box.width) * target.root.viewBox.baseVal.width;
    let nearest = 0;
    for (let i = 1; i < xs.length; ++i)
      if (Math.abs(target.x(xs[i]) - pixel) < Math.abs(target.x(xs[nearest]) - pixel)) nearest = i;
    const at = target.x(xs[nearest]);
    cursor.setAttribute('x1', String(at));
    cursor.setAttribute('x2', String(at));
    cursor.setAttribute('visibility', 'visible');
    words.textContent = text(nearest);
  });
  pad.addEventListener('pointerleave', () => {
    cursor.setAttribute('visibility', 'hidden');
    words.textContent = '';
  });
  target.root.append(cursor, words, pad);
}
