// The machine drawn as its chain: bodies from the workpiece to the tool, joined by its axes.

import {axesDrawing} from './axes_drawing';
import {Axis, Machine} from './data';
import {figure, html, responsive, section, svg} from './dom';
import {number, plain} from './format';
import {dataTable} from './table';

const kBodyHeight = 46;

function joint(axis: Axis, x: number, y: number, direction: string): SVGGElement {
  const group = svg('g', {class: `joint ${axis.kind}`, transform: `translate(${x} ${y})`});
  group.append(svg('circle', {r: 19}));
  if (axis.kind === 'linear') {
    group.append(svg('path', {d: 'M-11 0H11M6 -5L11 0L6 5M-6 -5L-11 0L-6 5', class: 'glyph'}));
  } else {
    group.append(svg('path', {d: 'M-8.5 6A10.5 10.5 0 1 1 8.5 6M9.8 -0.5L8.5 6.3L2.4 3.2', class: 'glyph'}));
    group.append(svg('circle', {r: 1.6, class: 'centre'}));
  }
  group.append(svg('title', {}, `${axis.kind} axis ${axis.name}${axis.primed ? ' (carries the workpiece)' : ''}, along ${direction}`));
  return group;
}

/// "+X", or the components if the direction is none of the machine's.
export function directionText(direction?: number[]): string {
  if (!direction || direction.length !== 3) return '';
  for (let i = 0; i < 3; ++i)
    if (Math.abs(Math.abs(direction[i]) - 1) < 1e-9) return (direction[i] > 0 ? '+' : '\u2212') + 'XYZ'[i];
  return `(${direction.map((v) => number(v, 4)).join(', ')})`;
}

export function travelText(axis: Axis): string {
  if (axis.endless) return 'endless';
  const angle = axis.kind === 'rotary';
  const from = angle ? axis.travel_min_deg : axis.travel_min_mm;
  const to = angle ? axis.travel_max_deg : axis.travel_max_mm;
  if (from === undefined || to === undefined) return '';
  return `${plain(from)} … ${plain(to)}${angle ? '°' : '\u202fmm'}`;
}

function bodies(machine: Machine): string[] {
  const axes = machine.axes ?? [];
  const workpieceAxes = axes.filter((axis) => axis.side === 'workpiece').length;
  const names: string[] = [];
  for (let i = 0; i <= axes.length; ++i) {
    if (i === workpieceAxes) names.push(axes.length === workpieceAxes ? 'bed, tool' : i === 0 ? 'workpiece, bed' : 'bed');
    else if (i === 0) names.push('workpiece');
    else if (i === axes.length) names.push('tool');
    else {
      const carriedBy = i < workpieceAxes ? axes[i] : axes[i - 1];
      names.push(`${carriedBy.kind === 'linear' ? 'slide' : 'body'} ${carriedBy.name}`);
    }
  }
  return names;
}

function ground(x: number, y: number, width: number): SVGGElement {
  const group = svg('g', {class: 'ground'});
  group.append(svg('line', {x1: x, x2: x + width, y1: y, y2: y}));
  for (let at = x + 6; at <= x + width; at += 9) group.append(svg('line', {x1: at, y1: y, x2: at - 6, y2: y + 6}));
  return group;
}

function draw(machine: Machine, width: number): Element {
  const axes = machine.axes ?? [];
  const names = bodies(machine);
  // Side by side where names, joints and what stands under the joints have room; on paper that is so for five axes.
  const kJoint = 46;
  const needed = Math.max(...names.map((name) => 7.2 * name.length + 8), ...axes.map((axis) => 6.4 * travelText(axis).length + 8 - kJoint));
  const vertical = width < axes.length * kJoint + (axes.length + 1) * needed + 4;
  const root = svg('svg', {class: 'chain', role: 'img', 'aria-label': `Kinematic chain ${machine.chain ?? ''}`});
  const bodyWidth = vertical ? 132 : Math.min(118, Math.max(needed, (width - axes.length * 70) / (axes.length + 1)));
  const gap = vertical ? 58 : (width - 4 - bodyWidth * (axes.length + 1)) / Math.max(1, axes.length);
  const height = vertical ? (axes.length + 1) * kBodyHeight + axes.length * gap + 20 : 132;
  const top = vertical ? 4 : 34;
  root.setAttribute('viewBox', `0 0 ${width} ${height}`);
  root.setAttribute('width', String(width));
  root.setAttribute('height', String(height));
  names.forEach((name, i) => {
    const x = vertical ? 2 : 2 + i * (bodyWidth + gap);
    const y = vertical ? top + i * (kBodyHeight + gap) : top;
    if (i < axes.length) {
      const axis = axes[i];
      const middle = vertical ? {x: x + bodyWidth / 2, y: y + kBodyHeight + gap / 2} : {x: x + bodyWidth + gap / 2, y: y + kBodyHeight / 2};
      root.append(
        vertical
          ? svg('line', {class: 'link', x1: middle.x, x2: middle.x, y1: y + kBodyHeight, y2: y + kBodyHeight + gap})
          : svg('line', {class: 'link', y1: middle.y, y2: middle.y, x1: x + bodyWidth, x2: x + bodyWidth + gap}),
      );
      const along = directionText(axis.direction);
      root.append(joint(axis, middle.x, middle.y, along));
      const label = `${axis.name}${axis.primed ? '′' : ''}`;
      const detail = `${axis.kind === 'linear' ? 'along' : 'about'} ${along}`;
      if (vertical) {
        root.append(svg('text', {x: middle.x + 30, y: middle.y - 2, class: 'axis-name'}, label));
        root.append(svg('text', {x: middle.x + 58, y: middle.y - 5, class: 'small'}, detail));
        root.append(svg('text', {x: middle.x + 58, y: middle.y + 11, class: 'small'}, travelText(axis)));
      } else {
        root.append(svg('text', {x: middle.x, y: middle.y - 28, class: 'axis-name middle'}, label));
        root.append(svg('text', {x: middle.x, y: middle.y + 38, class: 'small middle'}, detail));
        root.append(svg('text', {x: middle.x, y: middle.y + 54, class: 'small middle'}, travelText(axis)));
      }
    }
    const style = name.includes('bed') ? 'bed' : name === 'tool' ? 'tool' : name === 'workpiece' ? 'workpiece' : '';
    root.append(svg('rect', {x, y, width: bodyWidth, height: kBodyHeight, rx: 6, class: `body ${style}`}));
    root.append(svg('text', {x: x + bodyWidth / 2, y: y + kBodyHeight / 2 + 4.5, class: 'body-name middle'}, name));
    if (name.includes('bed')) root.append(ground(x + 10, y + kBodyHeight + (vertical && i < axes.length ? 0 : 5), vertical ? 34 : bodyWidth - 20));
  });
  return root;
}

export function machineSection(machine: Machine): HTMLElement | undefined {
  const axes = machine.axes;
  if (!axes?.length) return undefined;
  const part = section('machine', 'Machine', machine.description);
  const box = html('div', {class: 'drawing'});
  responsive(box, (width) => draw(machine, width));
  part.append(
    figure('Chain from the workpiece to the tool.' + (axes.some((axis) => axis.primed) ? ' A prime marks an axis that carries the workpiece: its positive command moves the table the other way.' : ''), box),
  );
  const vector = (v?: number[]) => (v ? v.map((c) => plain(c)).join(', ') : '');
  const space = html('div', {class: 'drawing'});
  responsive(space, (width) => axesDrawing(machine, width));
  const details = html('div', {},
    dataTable(
      'Axes, all at zero, machine frame',
      ['Axis', 'Kind', 'Carries', 'Direction', 'Point / mm', 'Travel'],
      axes.map((axis) => [
        `${axis.name}${axis.primed ? '′' : ''}`, axis.kind, axis.side, directionText(axis.direction), vector(axis.point_mm), travelText(axis),
      ]),
    ),
  );
  const isPlaced = axes.every((axis) => axis.direction?.length === 3);
  part.append(html('div', {class: 'columns machine'}, isPlaced && figure('Travels (arrows) and axis lines (dash-dotted) where they are, all axes at zero, parallel projection.', space), details));
  const places: [string, string][] = [
    ['Tool offset', vector(machine.tool_offset_mm)],
    ['Spindle gauge point', vector(machine.tool_reference_mm)],
    ['Workpiece origin', vector(machine.workpiece_origin_mm)],
  ];
  const stated = places.filter(([, text]) => text);
  if (stated.length) details.append(html('p', {class: 'note'}, stated.map(([name, text]) => `${name} (${text})\u202fmm`).join(' · ')));
  return part;
}
