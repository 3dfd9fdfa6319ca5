// The part in three dimensions with the deviations of a scan, its colour scale and what the pointer reads.

import {Camera} from './camera';
import {Report} from './data';
import {deviationBar} from './deviation_bar';
import {field, html, section} from './dom';
import {count, plain, quantity} from './format';
import {ladder} from './ladder';
import {sectionPlot} from './section_plot';
import {Surface, SurfaceBlock, unpackSurface} from './surface_data';
import {Shown, SurfaceView} from './surface_view';
import {signed} from './surface_words';
import {onThemeChange} from './theme';

function cameraOf(surface: Surface): Camera {
  const column = (k: number) => Array.from({length: surface.vertices.length / 3}, (_, i) => surface.vertices[3 * i + k]);
  return new Camera({x: column(0), y: column(1), z: column(2)}, 1e-6);
}

function quantityWords(block: SurfaceBlock): string {
  const words = block.quantity ?? 'signed deviation';
  return words[0].toUpperCase() + words.slice(1);
}

/// What was left out of the drawing, in a sentence.
export function thinningWords(block: SurfaceBlock): string {
  const words: string[] = [];
  const triangles = block.triangles_of_part ?? block.triangle_count;
  words.push(block.thinned_cell_mm
    ? `The part has ${count(triangles)} triangles, drawn are ${count(block.triangle_count)}: vertices within cubes of ${quantity(block.thinned_cell_mm, 'mm')} became one.`
    : `All ${count(triangles)} triangles of the part are drawn${block.triangle_count > triangles ? `, divided into ${count(block.triangle_count)} for the colours` : ''}.`);
  const points = block.points;
  if (points) {
    const all = points.counted === points.measured ? `${count(points.counted)} points` : `${count(points.measured)} points, of which ${count(points.counted)} count`;
    words.push(`The scan has ${all}; ${points.drawn < points.counted ? `drawn are ${count(points.drawn)}, evenly chosen and those farthest off` : 'all that count are drawn'}.`);
  }
  if (block.averaging_radius_mm)
    words.push(`The colour of a place is the mean of all points within ${quantity(block.averaging_radius_mm, 'mm')} on its side of the part.`);
  return words.join(' ');
}

export function surfaceSections(report: Report): HTMLElement[] {
  const block = report.surface;
  if (!block?.values) return [];
  const surface = unpackSurface(block);
  const part = section('surface', 'Deviation on the part', `${quantityWords(block)}; coordinates in the frame of the ${surface.frame}.`);
  const camera = cameraOf(surface);
  // From where most of the scan is seen.
  const facing = [0, 1, 2].map((k) => {
    let sum = 0;
    const normals = surface.points?.normals ?? [];
    for (let i = k; i < normals.length; i += 3) sum += normals[i];
    return sum / Math.max(1, normals.length / 3);
  });
  camera.lookFrom(facing[0], facing[1], facing[2]);
  const view = new SurfaceView('Deviation', surface, camera);
  camera.onChange(() => view.render());
  let limit = surface.limit;
  const bar = deviationBar(() => limit, surface.values!.some(Number.isNaN));
  const steps = ladder((0.08 * camera.size) / (surface.limit * 1e-3));
  const shown = html('select', {id: 'surface-shown'}, html('option', {value: 'surface'}, 'coloured surface'), html('option', {value: 'points'}, 'points of the scan'));
  const limits = html('input', {type: 'number', min: 0, step: 'any', value: plain(limit).replace(/\u202f/g, ''), id: 'surface-limit', class: 'short'});
  const slider = html('input', {type: 'range', min: 0, max: steps.factors.length - 1, step: 1, value: 0, id: 'surface-exaggeration'});
  const sliderValue = html('output', {for: 'surface-exaggeration'});
  const reading = html('output', {class: 'reading', id: 'surface-reading'}, '\u2013');
  const reset = html('button', {type: 'button'}, 'Reset view');
  reset.addEventListener('click', () => camera.reset());

  const update = () => {
    const entered = Number(limits.value);
    if (entered > 0) limit = entered;
    const factor = steps.factors[Number(slider.value)];
    sliderValue.textContent = factor ? `× ${plain(factor)}` : 'none';
    slider.setAttribute('aria-valuetext', sliderValue.textContent);
    view.caption.textContent = factor ? `deviations exaggerated × ${plain(factor)}` : 'deviations as colours only';
    view.describe(`deviations from ${quantity(-limit, 'µm')} to ${quantity(limit, 'µm')} as colours on the part, ${view.caption.textContent}`);
    view.update(shown.value as Shown, limit, factor);
    bar.redraw();
  };
  for (const input of [limits, slider]) input.addEventListener('input', update);
  shown.addEventListener('change', update);
  onThemeChange(update);
  view.onPointer((found) => {
    reading.textContent = found
      ? `${signed(found.value, surface)} at (${found.at.map((v) => plain(Number(v.toPrecision(5)))).join(', ')})\u202fmm, ${found.isPoint ? 'a point of the scan' : 'mean of the points near'}`
      : '\u2013';
  });
  part.append(
    html('div', {class: 'views one'}, view.box),
    bar.box,
    html('div', {class: 'controls'}, field('Show', shown), field('Limits ± / µm', limits), field('Exaggeration', slider, sliderValue), reset),
    html('p', {class: 'note screen-only'}, 'Under the pointer: ', reading),
    html('p', {class: 'note'}, thinningWords(block)),
    html('p', {class: 'note screen-only'}, 'Drag to rotate, wheel or + and − to zoom, arrow keys to turn.'),
  );
  update();
  return [part, sectionPlot(surface, block.averaging_radius_mm ?? 0, (ends) => view.showCut(ends))];
}
