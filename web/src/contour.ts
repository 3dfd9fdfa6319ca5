// Contour error along a curve, with its uncertainty and its limits.

import {ContourBlock} from './data';
import {figure, html, responsive, section} from './dom';
import {count, number, quantity} from './format';
import {band, dots, line, plot, readout, rule} from './plot';
import {extent} from './scale';

/// Mean, largest amount and standard deviation (n - 1), as stated or of the points drawn.
function figures(block: ContourBlock): {mean: number; largest: number; deviation: number} {
  const values = block.error_um;
  const mean = values.reduce((a, b) => a + b, 0) / values.length;
  const square = values.reduce((a, b) => a + (b - mean) ** 2, 0);
  return {mean: block.mean_um ?? mean, largest: block.largest_um ?? Math.max(...values.map(Math.abs)),
    deviation: block.standard_deviation_um ?? Math.sqrt(square / Math.max(1, values.length - 1))};
}

function drawing(block: ContourBlock): HTMLElement {
  const box = html('div', {class: 'drawing'});
  const {s_mm: s, error_um: error, u_um: u} = block;
  const low = error.map((e, i) => e - 2 * (u?.[i] ?? 0));
  const high = error.map((e, i) => e + 2 * (u?.[i] ?? 0));
  const limits = block.limits_um ?? [];
  const [from, to] = extent([0, ...low, ...high, ...limits]);
  const stated = figures(block);
  responsive(box, (width) => {
    const target = plot({width, height: 300, x: {label: 'length along the curve / mm', range: extent(s)}, y: {label: 'contour error / µm', range: [from, to], nice: true},
      zeroLine: true, description: `Contour error along the curve: mean ${quantity(stated.mean, 'µm')}, largest ${quantity(stated.largest, 'µm')}`});
    if (u) band(target, s, low, high, '');
    line(target, s, error, 'value');
    if (error.length <= 200) dots(target, s, error, 'contour');
    for (const limit of limits) rule(target, limit, 'y', 'before', `limit ${quantity(limit, 'µm')}`);
    readout(target, s, (i) => `${quantity(s[i], 'mm', 4)}: ${quantity(error[i], 'µm', 4)}${u ? ` ± ${quantity(2 * u[i], 'µm', 2)}` : ''}`);
    return target.root;
  });
  return box;
}

export function contourSection(all: ContourBlock | ContourBlock[] | undefined): HTMLElement | undefined {
  const blocks = [all ?? []].flat().filter((block) => block.error_um?.length);
  if (!blocks.length) return undefined;
  const part = section('contour', 'Contour error along the curve');
  for (const block of blocks) {
    const stated = figures(block);
    const beyond = block.limits_um?.length === 2 ? block.error_um.filter((e) => e < block.limits_um![0] || e > block.limits_um![1]).length : undefined;
    const words = `${block.title ? `${block.title}. ` : ''}${count(block.points ?? block.error_um.length)} points` +
      `${block.points && block.points > block.error_um.length ? `, ${count(block.error_um.length)} drawn` : ''}: ` +
      `mean ${number(stated.mean, 4)}\u2009µm, largest amount ${number(stated.largest, 4)}\u2009µm, standard deviation ${number(stated.deviation, 4)}\u2009µm.` +
      `${block.u_um ? ' Band: expanded uncertainty, k = 2.' : ''}${beyond === undefined ? '' : ` ${beyond ? count(beyond) : 'None'} of the points drawn beyond the limits.`}`;
    part.append(figure(words, drawing(block)));
    if (block.note) part.append(html('p', {class: 'note'}, block.note));
  }
  return part;
}
