// The tool along its path: play, slider, axis positions, time and feed.

import {Camera} from './camera';
import {cssColour} from './colour';
import {Report, splitUnit} from './data';
import {field, html, section} from './dom';
import {count, fixed, number, plain, quantity} from './format';
import {animationTimes, momentAt, PathBlock, valueAt} from './path_data';
import {coverageColour, PathView} from './path_view';
import {Surface, SurfaceBlock, unpackSurface} from './surface_data';
import {thinningWords} from './surface';
import {onThemeChange} from './theme';

const kSteps = 2000;
const kSeconds = 20;

function cameraOf(path: PathBlock, part: Surface | undefined): Camera {
  // The part and what is done on it: ways around may lead far away.
  const kept = part && path.working.some(Boolean) ? path.working.map(Boolean) : path.working.map(() => true);
  const column = (k: 0 | 1 | 2) => {
    const values = path.point_mm[(['x', 'y', 'z'] as const)[k]].filter((_, i) => kept[i]);
    if (part) for (let i = k; i < part.vertices.length; i += 3) values.push(part.vertices[i]);
    return values;
  };
  const camera = new Camera({x: column(0), y: column(1), z: column(2)}, 1e-6);
  if (part && !path.stops) camera.lookFrom(...sideOf(path));
  return camera;
}

/// The side of the part on which the tool is; where it goes all around, the side on which it leaves the part.
function sideOf(path: PathBlock): [number, number, number] {
  const mean = (kept: (i: number) => boolean): [number, number, number] => {
    const sum = [0, 0, 0];
    let n = 0;
    for (let i = 0; i < path.time_s.length; ++i) {
      if (!kept(i)) continue;
      (['x', 'y', 'z'] as const).forEach((key, k) => (sum[k] += path.direction[key][i]));
      ++n;
    }
    return sum.map((v) => v / Math.max(n, 1)) as [number, number, number];
  };
  const all = mean(() => true);
  return Math.hypot(...all) > 0.2 || path.working.every(Boolean) ? all : mean((i) => !path.working[i]);
}

/// A row for each axis: name, position, where it is in its travel.
function axisTable(path: PathBlock): {table: HTMLElement; show: (value: (column: number[]) => number) => void} {
  const rows = (path.axes ?? Object.keys(path.commands)).map((key) => {
    const column = path.commands[key];
    const {name, unit} = splitUnit(key);
    const travel = path.travel?.[key];
    let [low, high] = travel ?? [Infinity, -Infinity];
    if (!travel) for (const v of column) [low, high] = [Math.min(low, v), Math.max(high, v)];
    // As positions are written: rounding is no range.
    const end = (at: number) => plain(Math.round(at * 1e3) / 1e3);
    const cell = html('td', {class: 'number', 'data-axis': key});
    const meter = html('meter', {min: low, max: high > low ? high : low + 1, 'aria-label': `${name} within its ${travel ? 'travel' : 'range'}`});
    const row = html('tr', {}, html('th', {scope: 'row'}, name), cell, html('td', {}, unit), html('td', {class: 'number'}, end(low)), html('td', {}, meter), html('td', {class: 'number'}, end(high)));
    return {row, column, cell, meter};
  });
  const table = html('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Axis positions'}, html('table', {class: 'axis-positions'},
    html('caption', {}, 'Axis positions'),
    html('thead', {}, html('tr', {}, ...['Axis', 'Position', 'Unit', 'from', 'within', 'to'].map((name, i) => html('th', {scope: 'col', class: [1, 3, 5].includes(i) ? 'number' : ''}, name)))),
    html('tbody', {}, ...rows.map(({row}) => row))));
  return {table, show: (value) => {
    for (const {column, cell, meter} of rows) {
      const at = value(column);
      cell.textContent = fixed(at, 3);
      meter.value = at;
    }
  }};
}

function coverageLegend(block: SurfaceBlock, surface: Surface): HTMLElement | undefined {
  const coverage = surface.coverage;
  if (!coverage) return undefined;
  const counts = new Array<number>(coverage.reasons.length).fill(0);
  coverage.ofTriangle.forEach((reason) => counts[reason] += 1);
  // Shares of the area are the producer's; triangles are only what is drawn.
  const shares = block.coverage?.percent;
  const words = (i: number) => {
    if (!shares) return `: ${number((100 * counts[i]) / block.triangle_count)}\u202f% of the triangles`;
    return shares[i] === undefined ? '' : `: ${number(shares[i])}\u202f% of the area`;
  };
  return html('p', {class: 'legend coverage'}, ...coverage.reasons.flatMap((reason, i) => counts[i] || (shares?.[i] ?? 0) > 0
    ? [html('span', {class: 'key', 'data-reason': i}, html('span', {class: 'dot', style: `background: ${cssColour(coverageColour(i, coverage.colours))}`}),
      `${reason}${words(i)}`)] : []));
}

export function pathSection(report: Report): HTMLElement | undefined {
  const path = report.path;
  if (!path?.time_s?.length) return undefined;
  const n = path.time_s.length;
  const surface = report.surface && unpackSurface(report.surface);
  const part = section('path', path.title ?? 'Path', path.stops ? 'The tool at each reading, seen from the workpiece, in the order in which readings are taken: done in colour, ahead in black; ways between paler.' : `The tool on its path, seen from the workpiece. Path at work: done ${surface?.coverage ? 'pale' : 'in colour'}, ahead in black; rapid moves paler.`);
  const camera = cameraOf(path, surface);
  const view = new PathView('Path', path, surface, camera);
  camera.onChange(() => view.render());
  const times = animationTimes(path);
  const end = times[n - 1];
  const play = html('button', {type: 'button', id: 'path-play'}, 'Play');
  const slider = html('input', {type: 'range', min: 0, max: kSteps, step: 1, value: kSteps / 2, id: 'path-position'});
  const speed = html('select', {id: 'path-speed'}, ...[['fit', `whole path in ${kSeconds} s`], ['1', 'as the machine'], ['10', '10 times as fast'], ['100', '100 times as fast']]
    .map(([value, text]) => html('option', {value}, text)));
  const words = html('output', {id: 'path-words', for: 'path-position'});
  const axes = axisTable(path);
  const rapid = html('input', {type: 'checkbox', id: 'path-rapid', checked: ''});
  rapid.addEventListener('change', () => view.showRapid(rapid.checked));
  const reset = html('button', {type: 'button'}, 'Reset view');
  reset.addEventListener('click', () => camera.reset());
  let at = end / 2;
  let playing = false;
  let last = 0;

  const show = () => {
    const moment = momentAt(path, times, at);
    view.moveTo(moment);
    axes.show((column) => valueAt(column, moment));
    const feed = path.feed_mm_per_min?.[moment.move];
    words.textContent = [`${quantity(moment.time, 's', 4)} of ${quantity(path.time_s[n - 1], 's', 4)}`, path.stops ? `reading ${count(moment.move + (moment.share > 0.5 ? 1 : 0))} of ${count(path.moves ?? n)}` : path.working[moment.move] ? 'at work' : 'rapid',
      feed ? `feed ${quantity(feed, 'mm/min', 4)}` : '', path.length_mm ? `${quantity(valueAt(path.length_mm, moment), 'mm', 5)} done` : ''].filter(Boolean).join(', ');
    slider.setAttribute('aria-valuetext', words.textContent);
    view.caption.textContent = words.textContent;
  };
  const stop = () => {
    playing = false;
    play.textContent = 'Play';
  };
  const step = (now: number) => {
    if (!playing) return;
    at += ((now - last) / 1000) * (speed.value === 'fit' ? end / kSeconds : Number(speed.value));
    last = now;
    if (at >= end) {
      at = end;
      stop();
    }
    slider.value = String(Math.round((kSteps * at) / (end || 1)));
    show();
    if (playing) requestAnimationFrame(step);
  };
  play.addEventListener('click', () => {
    if (playing) return stop();
    playing = true;
    play.textContent = 'Pause';
    if (at >= end) at = 0;
    last = performance.now();
    requestAnimationFrame(step);
  });
  slider.addEventListener('input', () => {
    stop();
    at = (end * Number(slider.value)) / kSteps;
    show();
  });
  onThemeChange(() => {
    view.update('points', 1, 0);
    show();
  });
  view.describe(path.stops ? `the tool at ${count(path.moves ?? n)} readings` : `tool path of ${count(path.moves ?? n)} moves on the part`);
  const kind = path.stops ? 'readings' : 'moves';

  const drawn = `${(path.moves ?? n) > n ? `${count(n)} of ${count(path.moves)} ${kind} are drawn${path.stops ? '' : '; between them the tool goes straight'}.` : `All ${count(n)} ${kind} are drawn.`}` +
    (report.surface ? ` ${thinningWords(report.surface)}` : '');
  part.append(
    html('div', {class: 'views one'}, view.box),
    html('div', {class: 'controls'}, play, field('Position', slider), words, field('Speed', speed), ...(view.hasRapid ? [html('label', {}, rapid, path.stops ? ' ways between' : ' rapid moves')] : []), reset),
    ...[report.surface && surface && coverageLegend(report.surface, surface)].filter((e): e is HTMLElement => Boolean(e)),
    axes.table,
    html('p', {class: 'note'}, drawn, path.note && ` ${path.note}`),
    html('p', {class: 'note screen-only'}, 'Drag to rotate, wheel or + and − to zoom, arrow keys to turn.'),
  );
  show();
  return part;
}
