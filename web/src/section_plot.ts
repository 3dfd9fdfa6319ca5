// A plane through the part, moved by the reader: outline of the part and the deviations, magnified.

import {field, html, responsive, section} from './dom';
import {count, plain, quantity} from './format';
import {ladder} from './ladder';
import {cutBy, Plane, planeOf, pointsNear, Triple} from './section_geometry';
import {sectionDrawing, SectionDrawing} from './section_drawing';
import {Surface} from './surface_data';
import {signed} from './surface_words';

const kAxes: Record<string, {normal: Triple; names: [string, string]}> = {
  x: {normal: [1, 0, 0], names: ['y', 'z']},
  y: {normal: [0, 1, 0], names: ['x', 'z']},
  z: {normal: [0, 0, 1], names: ['x', 'y']},
};

/// Extent of all vertices along a direction.
function along(surface: Surface, direction: Triple): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  const {vertices} = surface;
  for (let i = 0; i < vertices.length; i += 3) {
    const at = vertices[i] * direction[0] + vertices[i + 1] * direction[1] + vertices[i + 2] * direction[2];
    if (at < low) low = at;
    if (at > high) high = at;
  }
  return [low, high];
}

/// @param showCut  draws the line of the cut on the part elsewhere
export function sectionPlot(surface: Surface, radius: number, showCut: (ends: Float32Array) => void): HTMLElement {
  const part = section('section', 'Section',
    `The part cut by a plane, seen along it: outline (thin line), mean deviation of the points near it (coloured line) and the points of the scan within the slab, moved out by their deviation, magnified.`);
  const size = Math.hypot(...(['x', 'y', 'z'] as const).map((k) => {
    const [low, high] = along(surface, kAxes[k].normal);
    return high - low;
  }));
  const steps = ladder((0.08 * size) / (surface.limit * 1e-3));
  const direction = html('select', {id: 'section-direction'}, ...['x', 'y', 'z'].map((k) => html('option', {value: k}, `across ${k}`)), html('option', {value: 'free'}, 'by its normal'));
  const normals = [0, 0, 1].map((value, k) => html('input', {type: 'number', step: 'any', value, class: 'short', 'aria-label': `Normal of the plane, ${'xyz'[k]}`}));
  const free = html('span', {class: 'field', hidden: true}, ...normals);
  const position = html('input', {type: 'range', min: 0, max: 400, step: 1, value: 200, id: 'section-position'});
  const positionValue = html('output', {for: 'section-position'});
  const half = html('input', {type: 'number', min: 0, step: 'any', value: Number(Math.max(radius, size / 200).toPrecision(1)), class: 'short', id: 'section-half'});
  const magnify = html('input', {type: 'range', min: 0, max: steps.factors.length - 1, step: 1, value: steps.start, id: 'section-factor'});
  const magnifyValue = html('output', {for: 'section-factor'});
  const words = html('p', {class: 'note', 'aria-live': 'polite'});
  const reading = html('output', {class: 'reading', id: 'section-reading'}, '\u2013');
  const box = html('div', {class: 'drawing section-box'});
  let drawing: SectionDrawing | undefined;
  let plane: Plane | undefined;

  const choose = (): {plane: Plane; names: [string, string]} | undefined => {
    free.hidden = direction.value !== 'free';
    const axis = kAxes[direction.value];
    const normal = axis ? axis.normal : (normals.map((input) => Number(input.value)) as Triple);
    const flat = planeOf(normal, 0);
    if (!flat) return undefined;
    const [low, high] = along(surface, flat.normal);
    flat.offset = low + ((high - low) * (Number(position.value) + 0.37)) / (Number(position.max) + 0.74);
    return {plane: flat, names: axis ? axis.names : [directionName(flat.right), directionName(flat.up)]};
  };
  const draw = (width: number): Element => {
    const chosen = choose();
    if (!chosen) {
      words.textContent = 'The normal has no direction.';
      drawing = undefined;
      return html('div');
    }
    plane = chosen.plane;
    const factor = steps.factors[Number(magnify.value)];
    const cut = cutBy(surface, plane);
    const near = pointsNear(surface, plane, Math.max(0, Number(half.value) || 0));
    const [x0, x1] = along(surface, plane.right);
    const [y0, y1] = along(surface, plane.up);
    positionValue.textContent = quantity(plane.offset, 'mm', 4);
    position.setAttribute('aria-valuetext', positionValue.textContent);
    magnifyValue.textContent = factor ? `× ${plain(factor)}` : 'none';
    magnify.setAttribute('aria-valuetext', magnifyValue.textContent);
    let [least, most] = [Infinity, -Infinity];
    for (const point of near) [least, most] = [Math.min(least, point.value), Math.max(most, point.value)];
    words.textContent = `${direction.value === 'free' ? `Normal ${directionName(plane.normal)}` : `Across ${direction.value}`} at ${positionValue.textContent}, ` +
      `deviations ${factor ? `magnified × ${plain(factor)}` : 'not drawn'}. ` + (near.length
      ? `${count(near.length)} points within ±${quantity(Number(half.value), 'mm')}, from ${signed(least, surface)} to ${signed(most, surface)}.`
      : 'No point of the scan lies in this slab.');
    drawing = sectionDrawing(cut, near, {width, low: [x0, y0], high: [x1, y1], factor, names: chosen.names,
      description: `Section. ${words.textContent}`});
    showCut(cut.ends);
    return drawing.root;
  };
  const redraw = responsive(box, draw);
  for (const input of [position, magnify, half, ...normals]) input.addEventListener('input', redraw);
  direction.addEventListener('change', redraw);
  const read = (event: PointerEvent | MouseEvent) => {
    if (!drawing || !surface.points) return;
    const frame = drawing.root.getBoundingClientRect();
    const scale = drawing.root.viewBox.baseVal.width / frame.width;
    const found = drawing.nearest((event.clientX - frame.left) * scale, (event.clientY - frame.top) * scale);
    const feet = surface.points.feet;
    reading.textContent = found
      ? `${signed(found.value, surface)} at (${[0, 1, 2].map((k) => plain(feet[3 * found.index + k])).join(', ')})\u202fmm` : '\u2013';
  };
  box.addEventListener('pointermove', read);
  box.addEventListener('click', read);

  part.append(
    html('div', {class: 'controls'}, field('Plane', direction), free, field('Position', position, positionValue), field('Magnification', magnify, magnifyValue),
      field('Points within ± / mm', half)),
    html('figure', {}, box, html('figcaption', {}, words)),
    html('p', {class: 'note screen-only'}, 'Under the pointer: ', reading),
  );
  return part;
}

/// "x", or the components.
function directionName(direction: Triple): string {
  for (let k = 0; k < 3; ++k) if (Math.abs(Math.abs(direction[k]) - 1) < 1e-9) return (direction[k] > 0 ? '' : '\u2212') + 'xyz'[k];
  return `(${direction.map((v) => plain(Number(v.toFixed(3)))).join(', ')})`;
}
