// The axes where they are: travels, axis lines, workpiece and tool in parallel projection, all axes at zero.

import {Axis, Machine} from './data';
import {svg} from './dom';
import {keptApart, Label} from './label_places';

type Point = [number, number, number];

const add = (a: Point, b: Point, factor = 1): Point => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const cross = (a: Point, b: Point): Point => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a: Point): Point => {
  const length = Math.hypot(...a) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
};
const point = (values: number[] | undefined): Point => (values?.length === 3 ? (values as Point) : [0, 0, 0]);

const kForward = unit([0.62, 1.25, -0.72]);
const kRight = unit(cross(kForward, [0, 0, 1]));
const kUp = cross(kRight, kForward);
const flat = (p: Point): [number, number] => [
  p[0] * kRight[0] + p[1] * kRight[1] + p[2] * kRight[2],
  -(p[0] * kUp[0] + p[1] * kUp[1] + p[2] * kUp[2]),
];

/// Two unit vectors that turn the first into the second about the axis in its positive sense.
function planeOf(direction: Point): [Point, Point] {
  const other: Point = Math.abs(direction[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const first = unit(cross(other, direction));
  return [first, cross(direction, first)];
}

interface Stroke {
  points: Point[];
  style: string;
  arrow?: boolean;
}

interface Word {
  at: Point;
  text: string;
  style: string;
}

function strokesOf(axis: Axis, size: number): {strokes: Stroke[]; word: Word} {
  const direction = unit(point(axis.direction));
  const at = point(axis.point_mm);
  const name = `${axis.name}${axis.primed ? '′' : ''}`;
  if (axis.kind === 'linear') {
    const from = add(at, direction, axis.travel_min_mm ?? 0);
    const to = add(at, direction, axis.travel_max_mm ?? size / 3);
    return {strokes: [{points: [from, to], style: 'travel', arrow: true}], word: {at: add(to, direction, size * 0.05), text: name, style: 'axis-name'}};
  }
  const reach = size * 0.26;
  const [u, v] = planeOf(direction);
  const centre = add(at, direction, reach * 0.72);
  const arc: Point[] = [];
  for (let k = 0; k <= 40; ++k) {
    const angle = 0.4 + (k / 40) * 5.2;
    arc.push(add(add(centre, u, size * 0.075 * Math.cos(angle)), v, size * 0.075 * Math.sin(angle)));
  }
  return {
    strokes: [
      {points: [add(at, direction, -reach * 0.45), add(at, direction, reach)], style: 'axis-line'},
      {points: arc, style: 'travel turn', arrow: true},
    ],
    word: {at: add(at, direction, reach + size * 0.04), text: name, style: 'axis-name'},
  };
}

export function axesDrawing(machine: Machine, width: number): Element {
  const axes = machine.axes ?? [];
  const places: Point[] = [point(machine.workpiece_origin_mm), point(machine.tool_reference_mm)];
  for (const axis of axes) {
    const at = point(axis.point_mm);
    places.push(at);
    if (axis.kind === 'linear')
      for (const travel of [axis.travel_min_mm, axis.travel_max_mm]) if (travel !== undefined) places.push(add(at, unit(point(axis.direction)), travel));
  }
  const span = [0, 1, 2].map((k) => Math.max(...places.map((p) => p[k])) - Math.min(...places.map((p) => p[k])));
  const size = Math.max(Math.hypot(...span), 100);

  const strokes: Stroke[] = [];
  const words: Word[] = [];
  for (const axis of axes) {
    const drawn = strokesOf(axis, size);
    strokes.push(...drawn.strokes);
    words.push(drawn.word);
  }
  const gauge = point(machine.tool_reference_mm);
  const tip = add(gauge, point(machine.tool_offset_mm));
  const origin = point(machine.workpiece_origin_mm);
  const spindle = add(tip, unit(point(machine.tool_direction ?? [0, 0, 1])), size * 0.12);
  strokes.push({points: [tip, gauge], style: 'tool-line'}, {points: [tip, spindle], style: 'tool-body'});

  const all = [...strokes.flatMap((s) => s.points), ...words.map((w) => w.at), origin].map(flat);
  const margin = 46;
  const low = [Math.min(...all.map((p) => p[0])), Math.min(...all.map((p) => p[1]))];
  const high = [Math.max(...all.map((p) => p[0])), Math.max(...all.map((p) => p[1]))];
  const scale = Math.min((width - 2 * margin) / Math.max(high[0] - low[0], 1e-9), 330 / Math.max(high[1] - low[1], 1e-9));
  const height = Math.round((high[1] - low[1]) * scale + 2 * 30);
  const shift = (width - (high[0] - low[0]) * scale) / 2;
  const place = (p: Point): [number, number] => {
    const [x, y] = flat(p);
    return [Math.round(10 * (shift + (x - low[0]) * scale)) / 10, Math.round(10 * (30 + (y - low[1]) * scale)) / 10];
  };

  const root = svg('svg', {viewBox: `0 0 ${width} ${height}`, width, height, class: 'axes', role: 'img',
    'aria-label': `Axes ${axes.map((axis) => axis.name).join(', ')} in space, workpiece and tool, all axes at zero`});
  for (const stroke of strokes) {
    const points = stroke.points.map(place);
    root.append(svg('path', {d: `M${points.map((p) => p.join(' ')).join('L')}`, class: stroke.style}));
    if (!stroke.arrow) continue;
    const [x, y] = points[points.length - 1];
    const before = points[points.length - 2];
    const angle = (Math.atan2(y - before[1], x - before[0]) * 180) / Math.PI;
    root.append(svg('path', {d: 'M0 0L-9 4L-9 -4Z', class: 'head', transform: `translate(${x} ${y}) rotate(${Math.round(angle)})`}));
  }
  const [ox, oy] = place(origin);
  const [tx, ty] = place(tip);
  root.append(svg('rect', {x: ox - 5, y: oy - 5, width: 10, height: 10, class: 'workpiece-mark'}));
  root.append(svg('circle', {cx: tx, cy: ty, r: 4.5, class: 'tool-mark'}));
  const apart = Math.hypot(tx - ox, ty - oy) > 40;
  const labels: Label[] = words.map((word) => {
    const [x, y] = place(word.at);
    return {x, y: y + 5, text: word.text, style: `${word.style} middle`, size: 15, middle: true};
  });
  labels.push({x: ox + 10, y: oy + 18, text: apart ? 'workpiece' : 'workpiece, tool', style: 'small', size: 12, middle: false});
  if (apart) labels.push({x: tx + 10, y: ty + 4, text: 'tool', style: 'small', size: 12, middle: false});
  for (const label of keptApart(labels, [[ox, oy, 6], [tx, ty, 5]]))
    root.append(svg('text', {x: Math.round(10 * label.x) / 10, y: Math.round(10 * label.y) / 10, class: label.style}, label.text));
  return root;
}
