// The drawing of a cut: outline of the part, deviations magnified, scale bars.

import {svg} from './dom';
import {quantity} from './format';
import {roundFactor} from './scale';
import {Cut, NearPoint} from './section_geometry';

export interface SectionDrawing {
  root: SVGSVGElement;
  /// The point nearest to a place on the drawing (its own units), within reach.
  nearest: (x: number, y: number) => NearPoint | undefined;
}

export interface SectionOptions {
  width: number;
  /// Lower and upper ends of the whole part in the plane, mm: the drawing does not jump when the plane moves.
  low: [number, number];
  high: [number, number];
  factor: number;
  description: string;
  names: [string, string];
}

const round = (v: number) => Math.round(v * 100) / 100;

export function sectionDrawing(cut: Cut, points: NearPoint[], options: SectionOptions): SectionDrawing {
  const {width, low, high, factor} = options;
  const margin = 34;
  const foot = 44;
  const span = [Math.max(high[0] - low[0], 1e-9), Math.max(high[1] - low[1], 1e-9)];
  const scale = Math.min((width - 2 * margin) / span[0], 440 / span[1]);
  const height = Math.round(span[1] * scale + 2 * margin + foot);
  const left = (width - span[0] * scale) / 2;
  const place = ([x, y]: [number, number]): [number, number] => [round(left + (x - low[0]) * scale), round(margin + (high[1] - y) * scale)];
  const moved = (end: {at: [number, number]; out: [number, number]; value: number}): [number, number] =>
    place([end.at[0] + end.out[0] * end.value * 1e-3 * factor, end.at[1] + end.out[1] * end.value * 1e-3 * factor]);

  let outline = '';
  let deviation = '';
  for (const [a, b] of cut.lines) {
    outline += `M${place(a.at).join(' ')}L${place(b.at).join(' ')}`;
    const known = [a, b].every((end) => Number.isFinite(end.value) && (end.out[0] !== 0 || end.out[1] !== 0));
    if (known) deviation += `M${moved(a).join(' ')}L${moved(b).join(' ')}`;
  }
  const dots = {below: '', above: ''};
  for (const point of points) dots[point.value < 0 ? 'below' : 'above'] += `M${moved(point).join(' ')}h0`;

  const root = svg('svg', {viewBox: `0 0 ${width} ${height}`, width, height, class: 'section-drawing', role: 'img', 'aria-label': options.description,
    'data-scale': scale});
  root.append(
    svg('path', {d: outline, class: 'outline'}),
    svg('path', {d: deviation, class: 'deviation'}),
    svg('path', {d: dots.below, class: 'dots below'}),
    svg('path', {d: dots.above, class: 'dots above'}),
  );
  const bar = (x: number, length: number, text: string) => {
    const y = height - 22;
    root.append(svg('path', {d: `M${round(x)} ${y - 4}v8M${round(x)} ${y}h${round(length)}M${round(x + length)} ${y - 4}v8`, class: 'scale-bar'}),
      svg('text', {x: round(x), y: y + 17, class: 'tick'}, text));
  };
  const wanted = Math.min(130, width / 4);
  const partLength = roundFactor(wanted / scale);
  bar(12, partLength * scale, quantity(partLength, 'mm'));
  if (factor > 0) {
    const amount = roundFactor((wanted / scale / factor) * 1e3);
    bar(width / 2 - 40, amount * 1e-3 * factor * scale, `deviation ${quantity(amount, 'µm')}`);
  }
  root.append(
    svg('text', {x: width - 6, y: height - 26, class: 'axis-label end'}, `→ ${options.names[0]}`),
    svg('text', {x: width - 6, y: height - 10, class: 'axis-label end'}, `↑ ${options.names[1]}`),
  );

  const nearest = (x: number, y: number) => {
    let best: NearPoint | undefined;
    let reach = 10 * 10;
    for (const point of points) {
      const [px, py] = moved(point);
      const away = (px - x) ** 2 + (py - y) ** 2;
      if (away < reach) [best, reach] = [point, away];
    }
    return best;
  };
  return {root, nearest};
}
