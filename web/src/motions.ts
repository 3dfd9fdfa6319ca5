// Every error motion as a small plot with its 95 % band, grouped by axis; location errors as intervals.

import {ErrorMotion, findQuantity, LocationError, Machine} from './data';
import {figure, html, responsive, section, svg} from './dom';
import {number, quantity} from './format';
import {band, dots, line, plot, readout} from './plot';
import {extent} from './scale';

interface Curve {
  motion: ErrorMotion;
  position: number[];
  positionUnit: string;
  value: number[];
  unit: string;
  half?: number[];
  truth?: number[];
}

function curveOf(motion: ErrorMotion): Curve | undefined {
  const position = findQuantity<number[]>(motion, 'position');
  const value = findQuantity<number[]>(motion, 'value');
  if (!position || !value) return undefined;
  return {
    motion,
    position: position.value,
    positionUnit: position.unit,
    value: value.value,
    unit: value.unit,
    half: findQuantity<number[]>(motion, 'expanded_uncertainty')?.value,
    truth: findQuantity<number[]>(motion, 'truth')?.value,
  };
}

function rangeOf(curve: Curve): [number, number] {
  const half = curve.half;
  const [low, high] = extent([
    0,
    ...curve.value.map((v, i) => v - (half?.[i] ?? 0)),
    ...curve.value.map((v, i) => v + (half?.[i] ?? 0)),
    ...(curve.truth ?? []),
  ]);
  if (low === high) return [-1, 1];
  const margin = (high - low) * 0.06;
  return [low < 0 ? low - margin : low, high > 0 ? high + margin : high];
}

/// What the six letters mean on this axis (ISO 230-1).
function meaning(motion: ErrorMotion, rotary: boolean, along: string | undefined): string {
  const component = motion.component ?? motion.name[1];
  const rotation = 'ABC'.indexOf(component);
  const own = along ? 'XYZ'.indexOf(along) : -1;
  if (rotary) {
    if (rotation >= 0) return rotation === own ? 'angular positioning' : 'tilt';
    return 'XYZ'.indexOf(component) === own ? 'axial' : 'radial';
  }
  if (rotation >= 0) return own < 0 ? 'angular' : rotation === own ? 'roll' : 'tilt';
  return 'XYZ'.indexOf(component) === own ? 'positioning' : 'straightness';
}

function small(curve: Curve, range: () => [number, number], title: string): {box: HTMLElement; redraw: () => void} {
  const drawing = html('div', {class: 'drawing'});
  const {motion, position, value, unit, half, truth} = curve;
  const redraw = responsive(drawing, (width) => {
    const target = plot({
      width,
      // Narrow on paper, where thirty of them are to fit on two sheets.
      height: width < 240 ? 104 : 168,
      compact: true,
      zeroLine: true,
      x: {label: `${motion.axis} / ${curve.positionUnit}`, range: extent(position), angle: curve.positionUnit === '°'},
      y: {label: `${unit}`, range: range()},
      description: `${motion.name}, ${title}: from ${quantity(extent(value)[0], unit)} to ${quantity(extent(value)[1], unit)}`,
    });
    if (half) band(target, position, value.map((v, i) => v - half[i]), value.map((v, i) => v + half[i]), 'value');
    line(target, position, value, 'value');
    if (position.length === 1) dots(target, position, value, 'determined');
    if (truth) line(target, position, truth, 'truth');
    readout(target, position, (i) =>
      `${number(position[i], 4)}${curve.positionUnit === '°' ? '°' : '\u202f' + curve.positionUnit}: ${number(value[i])}${half ? ` ± ${number(half[i], 2)}` : ''}\u202f${unit}`);
    return target.root;
  });
  const box = html('figure', {class: 'motion'},
    html('figcaption', {}, html('b', {}, motion.name), html('span', {}, title)),
    drawing,
    motion.note && html('p', {class: 'note'}, motion.note));
  return {box, redraw};
}

function legend(curves: Curve[]): HTMLElement {
  const item = (style: string, text: string) => html('span', {class: 'key'}, (() => {
    const mark = svg('svg', {width: 26, height: 10, 'aria-hidden': 'true'});
    if (style === 'band') mark.append(svg('rect', {x: 0, y: 0, width: 26, height: 10, class: 'band value'}));
    else mark.append(svg('path', {d: 'M0 5H26', class: `line ${style}`}));
    return mark;
  })(), text);
  return html('div', {class: 'legend'}, item('value', 'error motion'),
    curves.some((c) => c.half) && item('band', '95\u202f% band (k = 2)'),
    curves.some((c) => c.truth) && item('truth', 'truth'));
}

export function motionSection(motions: ErrorMotion[], machine?: Machine): HTMLElement | undefined {
  const curves = motions.map(curveOf).filter((c): c is Curve => c !== undefined);
  if (!curves.length) return undefined;
  const part = section('motions', 'Error motions',
    'Actual minus nominal, each a function of the position of its own axis. Names after ISO 230-1: E, direction (A, B, C: rotation about X, Y, Z), moving axis.');
  const own = html('input', {type: 'checkbox'});
  part.append(html('div', {class: 'controls'}, legend(curves), html('label', {class: 'check'}, own, 'each plot at its own scale')));
  const redraws: (() => void)[] = [];
  const axes = [...new Set(curves.map((c) => c.motion.axis))];
  for (const name of axes) {
    const axis = machine?.axes?.find((a) => a.name === name);
    const rotary = axis ? axis.kind === 'rotary' : curves.some((c) => c.motion.axis === name && c.positionUnit === '°');
    const along = axis?.direction ? ['X', 'Y', 'Z'].find((_, i) => Math.abs(axis.direction![i]) > 1 - 1e-9) : name[0];
    const direction = along ?? undefined;
    const isLetter = direction && 'XYZ'.includes(direction) ? direction : 'ABC'.includes(name[0]) ? 'XYZ'['ABC'.indexOf(name[0])] : undefined;
    const mine = curves.filter((c) => c.motion.axis === name);
    const common = new Map<string, [number, number]>();
    for (const unit of new Set(mine.map((c) => c.unit))) common.set(unit, extent(mine.filter((c) => c.unit === unit).flatMap(rangeOf)));
    const grid = html('div', {class: `multiples ${mine.length % 3 === 0 ? 'of-six' : ''}`});
    for (const curve of mine) {
      const range = () => (own.checked ? rangeOf(curve) : common.get(curve.unit) ?? rangeOf(curve));
      const {box, redraw} = small(curve, range, meaning(curve.motion, rotary, isLetter));
      grid.append(box);
      redraws.push(redraw);
    }
    const bases = [...new Set(mine.map((c) => c.motion.basis).filter(Boolean))];
    part.append(html('h3', {}, `${rotary ? 'Rotary' : 'Linear'} axis ${name}`, bases.length === 1 && html('small', {}, bases[0])), grid);
  }
  own.addEventListener('change', () => redraws.forEach((redraw) => redraw()));
  return part;
}

export function locationSection(errors: LocationError[]): HTMLElement | undefined {
  const part = section('locations', 'Location errors',
    'Squareness and parallelism of linear axes, position and tilt of axis average lines; reversal values where they are identified. Bars are 95 % intervals (k = 2).');
  const groups = html('div', {class: 'columns'});
  for (const unit of ['µrad', 'µm']) {
    const rows = errors.flatMap((error) => {
      const value = findQuantity<number>(error, 'value');
      if (!value || value.unit !== unit) return [];
      return [{error, value: value.value, spread: findQuantity<number>(error, 'standard_uncertainty')?.value,
        truth: findQuantity<number>(error, 'truth')?.value}];
    });
    if (!rows.length) continue;
    const drawing = html('div', {class: 'drawing'});
    responsive(drawing, (width) => {
      const height = 64 + rows.length * 28;
      const [low, high] = extent(rows.flatMap((r) => [0, r.value - 2 * (r.spread ?? 0), r.value + 2 * (r.spread ?? 0), r.truth]));
      const margin = (high - low) * 0.06;
      const target = plot({
        width, height,
        x: {label: unit, range: [low - margin, high + margin]},
        y: {label: '', range: [-0.5, rows.length - 0.5], ticks: rows.map((r, i) => ({at: rows.length - 1 - i, label: r.error.name}))},
        description: rows.map((r) => `${r.error.name} ${quantity(r.value, unit)}`).join(', '),
      });
      const zero = target.x(0);
      target.layer.append(svg('line', {x1: zero, x2: zero, y1: target.area.top, y2: target.area.bottom, class: 'zero'}));
      rows.forEach((row, i) => {
        const y = target.y(rows.length - 1 - i);
        const text = `${row.error.name}: ${quantity(row.value, unit, 4)}${row.spread ? ` ± ${quantity(2 * row.spread, unit, 2)} (k = 2)` : ''}${row.truth === undefined ? '' : `, truth ${quantity(row.truth, unit, 4)}`}`;
        const mark = svg('g', {class: 'interval'}, svg('title', {}, text));
        if (row.spread) mark.append(svg('line', {x1: target.x(row.value - 2 * row.spread), x2: target.x(row.value + 2 * row.spread), y1: y, y2: y}));
        mark.append(svg('circle', {cx: target.x(row.value), cy: y, r: 4}));
        if (row.truth !== undefined) {
          const x = target.x(row.truth);
          mark.append(svg('line', {x1: x, x2: x, y1: y - 8, y2: y + 8, class: 'truth'}));
        }
        target.layer.append(mark);
      });
      return target.root;
    });
    const notes = rows.filter((r) => r.error.note).map((r) => `${r.error.name}: ${r.error.note}`);
    groups.append(figure(`${unit === 'µm' ? 'Shifts' : 'Angles'}${rows.some((r) => r.truth !== undefined) ? '; the tick is the truth' : ''}.${notes.length ? ` ${notes.join('. ')}.` : ''}`, drawing));
  }
  if (!groups.children.length) return undefined;
  part.append(groups);
  return part;
}
