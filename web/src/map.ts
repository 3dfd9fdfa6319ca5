// The map of error vectors: before and after side by side, one camera, one colour scale.

import {cssColour, rampColour} from './colour';
import {ErrorMap, PoseErrors, splitUnit} from './data';
import {axisLabel, axisLabelLines, kLine, field, html, responsive, section, svg} from './dom';
import {count, number, prose, quantity as withUnit} from './format';
import {Colour, colours, exaggeration, quantities, range, statisticsTable} from './map_choices';
import {Camera} from './camera';
import {View} from './map_view';
import {linearScale, logScale, roundFactor} from './scale';
import {onThemeChange} from './theme';

interface Scaling {
  low: number;
  high: number;
  log: boolean;
  colour: Colour;
}

export function fraction(value: number, scaling: {low: number; high: number; log: boolean}): number {
  if (scaling.log) return Math.log(Math.max(value, scaling.low) / scaling.low) / Math.log(scaling.high / scaling.low);
  return value / scaling.high;
}

function colourBar(scaling: () => Scaling): {box: HTMLElement; redraw: () => void} {
  const box = html('div', {class: 'colour-bar'});
  const redraw = responsive(box, (width) => {
    const {low, high, log, colour} = scaling();
    const inner: [number, number] = [10, width - 10];
    const scale = log ? logScale([low, high], inner, 6) : linearScale([0, high], inner, 6);
    const words = axisLabelLines(colour.legend, width - 20);
    const height = 44 + kLine * (words.length - 1);
    const root = svg('svg', {viewBox: `0 0 ${width} ${height}`, width, height, role: 'img',
      'aria-label': `Colour scale, ${colour.legend}, from ${number(log ? low : 0)} to ${number(high)}`});
    // Both are there, the style sheet shows one: paper always gets the light one, as the stills do.
    for (const name of ['light', 'dark']) {
      const stops = svg('linearGradient', {id: `ramp-${name}`});
      for (let i = 0; i <= 24; ++i) stops.append(svg('stop', {offset: `${(100 * i) / 24}%`, 'stop-color': cssColour(rampColour(i / 24, name === 'dark'))}));
      root.append(svg('defs', {}, stops),
        svg('rect', {x: inner[0], y: 4, width: Math.max(1, inner[1] - inner[0]), height: 10, rx: 2, fill: `url(#ramp-${name})`, class: `ramp-${name}`}));
    }
    for (const tick of scale.ticks) {
      const x = scale(tick);
      root.append(svg('line', {x1: x, x2: x, y1: 14, y2: 18, class: 'mark'}), svg('text', {x, y: 29, class: 'tick middle'}, scale.label(tick)));
    }
    root.append(axisLabel(words, inner[1], height - 2));
    return root;
  });
  return {box, redraw};
}

interface Slice {
  label: string;
  unit: string;
  values: number[];
  stops: number[];
  half: number;
}

function slices(map: ErrorMap): Slice[] {
  return Object.entries(map.positions ?? {}).flatMap(([key, values]) => {
    const {name, unit} = splitUnit(key);
    const unique = [...new Set(values.map((v) => Number(v.toPrecision(9))))].sort((a, b) => a - b);
    if (unique.length < 2) return [];
    const span = unique[unique.length - 1] - unique[0];
    if (unique.length <= 40) return [{label: name, unit, values, stops: unique, half: span * 1e-6}];
    // Scattered poses: slabs of a tenth of the travel.
    const stops = Array.from({length: 19}, (_, i) => unique[0] + (span * (i + 1)) / 20);
    return [{label: name, unit, values, stops, half: span / 20}];
  });
}

export function mapSection(map: ErrorMap, summary: PoseErrors | undefined): HTMLElement {
  const shown = map.point_mm.x.length;
  const total = map.poses ?? shown;
  const frame = map.frame ? `${map.frame} frame` : 'workpiece frame';
  const shows = map.quantity ? `the ${map.quantity}` : 'where the tool really is';
  const part = section('map', `Map of the ${map.quantity ?? 'volumetric error'}`,
    `Each arrow stands at its nominal point (${frame}) and shows ${shows}, exaggerated. ` +
    `${shown < total ? `${count(shown)} of ${count(total)} poses drawn` : `${count(total)} ${total === 1 ? 'pose' : 'poses'}`}${map.description ? `: ${map.description}` : ''}.`);
  if (map.note) part.append(html('p', {class: 'note under'}, prose(map.note)));
  const kinds = quantities(map);
  let kind = kinds[0];
  const after = kind.views.length > 1;

  const camera = new Camera(map.point_mm);
  const views: View[] = kind.views.map((_, i) => new View(i ? 'After' : after ? 'Before' : 'Errors', map.point_mm, camera));
  camera.onChange(() => views.forEach((view) => view.render()));

  const typical = (values: number[]) => [...values].sort((a, b) => a - b)[Math.floor(values.length * 0.95)] || 1;
  const automatic = (values: number[]) => roundFactor((camera.size * 0.11) / (typical(values) * kind.millimetres));
  const vectors = html('select', {id: 'map-vectors'}, ...kinds.map((entry) => html('option', {value: entry.id}, entry.label)));
  const colouring = html('select', {id: 'map-colour'});
  const slider = html('input', {type: 'range', min: -2, max: 2, step: 0.05, value: 0, id: 'map-exaggeration'});
  const sliderValue = html('output', {for: 'map-exaggeration'});
  const own = html('input', {type: 'checkbox'});
  const log = html('input', {type: 'checkbox'});
  const choices = slices(map);
  const axis = html('select', {id: 'map-slice'}, html('option', {value: ''}, 'all poses'),
    ...choices.map((slice, i) => html('option', {value: i}, `slice by ${slice.label}`)));
  const position = html('input', {type: 'range', min: 0, max: 1, step: 1, value: 0, 'aria-label': 'Position of the slice', hidden: true});
  const positionValue = html('output', {});
  const statistics = html('div', {class: 'map-statistics-box', 'aria-live': 'polite'});
  let scaling: Scaling;
  const bar = colourBar(() => scaling);

  /// After a change of what is drawn: colours to choose from, one scale for all views, statistics.
  const choose = () => {
    kind = kinds.find((entry) => entry.id === vectors.value) ?? kinds[0];
    const offered = colours(map, kind);
    const wanted = colouring.value;
    colouring.replaceChildren(...offered.map((entry) => html('option', {value: entry.id}, entry.label)));
    const colour = offered.find((entry) => entry.id === wanted) ?? offered[0];
    colouring.value = colour.id;
    scaling = {...range(kind.views.flatMap((_, i) => colour.values(i))), log: log.checked, colour};
    const table = statisticsTable(kind, Boolean(map.expanded_uncertainty_um), summary);
    statistics.replaceChildren(...(table ? [table] : []));
    update();
  };
  const update = () => {
    const factor = Math.pow(10, Number(slider.value));
    scaling.log = log.checked;
    const slice = axis.value === '' ? undefined : choices[Number(axis.value)];
    position.hidden = !slice;
    let visible: boolean[] | undefined;
    if (slice) {
      position.max = String(slice.stops.length - 1);
      const at = slice.stops[Number(position.value)];
      visible = slice.values.map((v) => Math.abs(v - at) <= slice.half * 1.0001);
      positionValue.textContent = `${slice.label} = ${withUnit(at, slice.unit, 4)}${slice.half > 1e-3 ? ` ± ${withUnit(slice.half, slice.unit, 2)}` : ''}, ${count(visible.filter(Boolean).length)} poses`;
      position.setAttribute('aria-valuetext', positionValue.textContent);
    } else positionValue.textContent = '';
    const common = automatic(kind.views[0].length);
    views.forEach((view, i) => {
      const entry = kind.views[Math.min(i, kind.views.length - 1)];
      const scale = factor * (own.checked && i > 0 ? automatic(entry.length) : common);
      view.caption.textContent = `${slice ? `${positionValue.textContent}; ` : ''}arrows ${exaggeration(kind, scale)}`;
      view.describe(`${kind.what} in three dimensions, ${exaggeration(kind, scale)}, coloured by ${scaling.colour.legend}`);
      view.update({...entry.vectors, length: entry.length, colour: scaling.colour.values(i)}, scale * kind.millimetres, visible,
        (value, dark) => rampColour(fraction(value, scaling), dark));
    });
    sliderValue.textContent = exaggeration(kind, common * factor);
    slider.setAttribute('aria-valuetext', sliderValue.textContent);
    bar.redraw();
  };
  for (const input of [slider, own, log, position]) input.addEventListener('input', update);
  for (const input of [vectors, colouring]) input.addEventListener('change', choose);
  axis.addEventListener('change', () => {
    const slice = axis.value === '' ? undefined : choices[Number(axis.value)];
    if (slice) {
      position.max = String(slice.stops.length - 1);
      position.value = String(Math.floor((slice.stops.length - 1) / 2));
    }
    update();
  });
  onThemeChange(update);
  const reset = html('button', {type: 'button'}, 'Reset view');
  reset.addEventListener('click', () => camera.reset());

  const several = kinds.length > 1, coloured = Boolean(map.expanded_uncertainty_um?.length);
  part.append(
    html('div', {class: `views ${views.length > 1 ? 'two' : 'one'}`}, ...views.map((view) => view.box)),
    bar.box,
    html('div', {class: 'controls'},
      several && field('Arrows', vectors),
      coloured && field('Colour', colouring),
      field('Exaggeration', slider, sliderValue),
      choices.length > 0 && field('Show', axis),
      choices.length > 0 && html('span', {class: 'field'}, position, positionValue),
      html('label', {class: 'check'}, log, 'logarithmic colours'),
      after && html('label', {class: 'check'}, own, 'arrows after at their own length'),
      reset),
    html('p', {class: 'note screen-only'}, 'Drag to rotate, wheel or + and − to zoom, arrow keys to turn.' + (after ? ' Both views move together.' : '') +
      (several ? ' A rotation is drawn along its axis, right-handed.' : '')),
    statistics,
  );
  choose();
  return part;
}
