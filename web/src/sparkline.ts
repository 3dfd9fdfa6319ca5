// Sparklines: the course of one value in a cell of a table, with its uncertainty and its control limits, without axes.

import {SparklineData} from './data';
import {svg} from './dom';

const kWidth = 132;
const kHeight = 34;
const kMargin = 4;

type Point = [number, number];

const isNumber = (value: number | null | undefined): value is number => typeof value === 'number' && Number.isFinite(value);

const path = (points: Point[]) => points.map(([x, y], i) => `${i ? 'L' : 'M'}${x.toFixed(1)} ${y.toFixed(1)}`).join('');

/// Whether the last value is beyond its limits; without limits it is not.
export function isBeyond(data: SparklineData): boolean {
  const last = data.value.length - 1;
  const value = data.value[last], low = data.control_low?.[last], high = data.control_high?.[last];
  return isNumber(value) && isNumber(low) && isNumber(high) && (value < low || value > high);
}

/// @param name  of what it shows, for those who do not see it
export function sparkline(data: SparklineData, name: string): SVGSVGElement {
  const at = data.days.map((_, i) => i).filter((i) => isNumber(data.days[i]) && isNumber(data.value[i]));
  const beyond = isBeyond(data);
  const root = svg('svg', {viewBox: `0 0 ${kWidth} ${kHeight}`, width: kWidth, height: kHeight, class: 'sparkline', role: 'img',
    'aria-label': `${name}: course over ${at.length} campaigns${beyond ? ', the last value is beyond its control limits' : ''}`});
  if (!at.length) return root;
  const values = (column: (number | null)[] | undefined) => at.map((i) => column?.[i]);
  const value = values(data.value) as number[];
  const expanded = values(data.expanded_uncertainty).map((u) => (isNumber(u) ? u : 0));
  const low = values(data.control_low), high = values(data.control_high);
  const all = [...value.flatMap((v, i) => [v - expanded[i], v + expanded[i]]), ...low.filter(isNumber), ...high.filter(isNumber)];
  const [bottom, top] = [Math.min(...all), Math.max(...all)];
  const [first, last] = [data.days[at[0]], data.days[at[at.length - 1]]];
  // A single value and values without a spread are in the middle.
  const x = (day: number) => (last > first ? kMargin + ((kWidth - 2 * kMargin) * (day - first)) / (last - first) : kWidth / 2);
  const y = (v: number) => (top > bottom ? kHeight - kMargin - ((kHeight - 2 * kMargin) * (v - bottom)) / (top - bottom) : kHeight / 2);
  const days = at.map((i) => x(data.days[i]));
  const course: Point[] = value.map((v, i) => [days[i], y(v)]);
  if (expanded.some((u) => u > 0)) {
    const above: Point[] = value.map((v, i) => [days[i], y(v + expanded[i])]);
    const below: Point[] = value.map((v, i) => [days[i], y(v - expanded[i])]);
    // Of a single value it is a bar.
    const sides: Point[] = days.length > 1 ? [...above, ...below.reverse()]
      : [[days[0] - 3, above[0][1]], [days[0] + 3, above[0][1]], [days[0] + 3, below[0][1]], [days[0] - 3, below[0][1]]];
    root.append(svg('path', {class: 'band', d: `${path(sides)}Z`}));
  }
  for (const limits of [low, high]) {
    const points = limits.flatMap((v, i): Point[] => (isNumber(v) ? [[days[i], y(v)]] : []));
    // Limits of one campaign alone are short dashes beside it.
    const [only] = points;
    const drawn: Point[] = points.length === 1 ? [[Math.max(0, only[0] - 10), only[1]], [Math.min(kWidth, only[0] + kMargin), only[1]]] : points;
    if (drawn.length) root.append(svg('path', {class: 'control-limit', d: path(drawn)}));
  }
  if (course.length > 1) root.append(svg('path', {class: 'line value', d: path(course)}));
  const [endX, endY] = course[course.length - 1];
  root.append(svg('circle', {class: beyond ? 'end-mark beyond' : 'end-mark', cx: endX.toFixed(1), cy: endY.toFixed(1), r: 2.4}));
  return root;
}
