// Contour error along a curve, with its uncertainty and its limits.

import {sectionsOf} from './contour_sections';
import {ContourBlock} from './data';
import {figure, html, responsive, section} from './dom';
import {count, number, quantity} from './format';
import {band, dots, line, plot, readout, rule} from './plot';
import {extent} from './scale';

interface Figures { mean: number; bias: number; largest: number; deviation?: number }

/// Of the amounts: mean, largest and standard deviation (n - 1), and the mean with signs; as stated or of the points
/// drawn. Of one value there is no deviation.
function figures(block: ContourBlock): Figures {
  const values = block.error_um, amounts = values.map(Math.abs);
  const meanOf = (of: number[]) => of.reduce((a, b) => a + b, 0) / of.length;
  const mean = meanOf(amounts);
  const square = amounts.reduce((a, b) => a + (b - mean) ** 2, 0);
  return {mean: block.mean_um ?? mean, bias: block.bias_um ?? meanOf(values), largest: block.largest_um ?? amounts.reduce((a, b) => Math.max(a, b), 0),
    deviation: block.standard_deviation_um ?? (values.length > 1 ? Math.sqrt(square / (values.length - 1)) : undefined)};
}

const kFewDots = 200;

function drawing(block: ContourBlock): HTMLElement {
  const box = html('div', {class: 'drawing'});
  const {s_mm: s, error_um: error, u_um: u} = block;
  const low = error.map((e, i) => e - 2 * (u?.[i] ?? 0));
  const high = error.map((e, i) => e + 2 * (u?.[i] ?? 0));
  const limits = block.limits_um ?? [];
  const also = block.also ?? [];
  const [from, to] = extent([0, ...low, ...high, ...limits, ...also.flatMap((one) => one.value_um)]);
  const stated = figures(block);
  const place = (i: number) => (block.counted ? `${block.counted} ${number(s[i], 4)}` : quantity(s[i], 'mm', 4));
  responsive(box, (width) => {
    const target = plot({width, height: 300, x: {label: block.counted ?? 'length along the curve / mm', range: extent([...s, ...also.flatMap((one) => one.s_mm)])},
      y: {label: 'contour error / µm', range: [from, to], nice: true},
      zeroLine: true, description: `Contour error along the curve: mean amount ${quantity(stated.mean, 'µm')}, largest ${quantity(stated.largest, 'µm')}`});
    if (u) band(target, s, low, high, '');
    also.forEach((one, i) => dots(target, one.s_mm, one.value_um, `also${i % 2}`));
    if (block.joined !== false) line(target, s, error, 'value');
    if (block.joined === false || error.length <= kFewDots) dots(target, s, error, error.length <= kFewDots ? 'contour' : 'contour many');
    for (const limit of limits) rule(target, limit, 'y', 'before', `limit ${quantity(limit, 'µm')}`);
    readout(target, s, (i) => `${place(i)}: ${quantity(error[i], 'µm', 4)}${u ? ` ± ${quantity(2 * u[i], 'µm', 2)}` : ''}`);
    return target.root;
  });
  return box;
}

/// What the colours of the dots mean.
function legend(block: ContourBlock): HTMLElement | undefined {
  if (!block.also?.length) return undefined;
  const entry = (style: string, text: string) => html('span', {}, html('i', {class: `dot ${style}`, 'aria-hidden': 'true'}), text);
  return html('p', {class: 'legend'}, entry('contour', 'contour error'), ...block.also.map((one, i) => entry(`also${i % 2}`, one.name)));
}

export function contourSection(all: ContourBlock | ContourBlock[] | undefined): HTMLElement | undefined {
  const blocks = [all ?? []].flat().filter((block) => block.error_um?.length || block.sections?.length);
  if (!blocks.length) return undefined;
  const part = section('contour', 'Contour error along the curve');
  blocks.forEach((block, i) => {
    if (block.error_um?.length) {
      const stated = figures(block);
      const beyond = block.limits_um?.length === 2 ? block.error_um.filter((e) => e < block.limits_um![0] || e > block.limits_um![1]).length : undefined;
      const words = `${block.title ? `${block.title}. ` : ''}${count(block.points ?? block.error_um.length)} ${block.sections ? 'sections' : 'points'}` +
        `${block.points && block.points > block.error_um.length ? `, ${count(block.error_um.length)} drawn` : ''}: ` +
        `mean amount ${number(stated.mean, 4)}\u202fµm, largest amount ${number(stated.largest, 4)}\u202fµm` +
        `${stated.deviation === undefined ? '' : `, standard deviation of the amounts ${number(stated.deviation, 4)}\u202fµm`}; mean with signs ${number(stated.bias, 4)}\u202fµm.` +
        `${block.u_um ? ' Band: expanded uncertainty, k = 2.' : ''}${beyond === undefined ? '' : ` ${beyond ? count(beyond) : 'None'} of the points drawn beyond the limits.`}`;
      const box = figure(words, drawing(block));
      const colours = legend(block);
      if (colours) box.prepend(colours);
      part.append(box);
    }
    if (block.sections?.length) part.append(sectionsOf(block.sections, block.sections_in_all ?? block.sections.length, `contour-section-${i}`));
    if (block.note) part.append(html('p', {class: 'note'}, block.note));
  });
  return part;
}
