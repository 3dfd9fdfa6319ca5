// How well the readings determine the parameters: rank, gauge, convergence, order.

import {Identification, Summary} from './data';
import {figure, html, responsive, section} from './dom';
import {count, number} from './format';
import {dots, line, plot, rule} from './plot';
import {extent} from './scale';
import {dataTable} from './table';

function positive(values: (number | null | undefined)[]): number[] {
  return values.filter((v): v is number => typeof v === 'number' && v > 0);
}

function decades(values: number[], margin = 0.25): [number, number] {
  if (!values.length) return [0.1, 10];
  const [low, high] = extent(values);
  return [Math.pow(10, Math.floor((Math.log10(low) - margin) * 2) / 2), Math.pow(10, Math.ceil((Math.log10(high) + margin) * 2) / 2)];
}

function singularValues(values: number[], rank: number | undefined, threshold: number | undefined): HTMLElement {
  const drawing = html('div', {class: 'drawing'});
  const largest = Math.max(...values);
  if (!(largest > 0)) return html('p', {class: 'note'}, 'All singular values are zero: the readings determine no parameter.');
  // A null space is rounding noise: everything below 1e-18 of the largest is drawn there.
  const floor = largest * 1e-18;
  const drawn = values.map((v) => Math.max(v, floor));
  const index = values.map((_, i) => i + 1);
  const cut = rank ?? values.length;
  responsive(drawing, (width) => {
    const target = plot({
      width, height: 250,
      x: {label: 'index', range: [0, values.length + 1]},
      y: {label: 'singular value of the scaled Jacobian', range: decades(drawn), log: true},
      description: `Singular values from ${number(largest)} to ${number(values[values.length - 1])}; rank ${cut}`,
    });
    if (cut < values.length) rule(target, cut + 0.5, 'x', 'limit', `rank ${cut}`);
    else if (threshold) rule(target, threshold * largest, 'y', 'limit', 'threshold');
    dots(target, index.slice(0, cut), drawn.slice(0, cut), 'determined');
    dots(target, index.slice(cut), drawn.slice(cut), 'undetermined');
    return target.root;
  });
  const lost = values.length - cut;
  return figure(lost > 0
    ? `Singular values. ${count(lost)} combinations of parameters leave every reading unchanged and are fixed by the gauge.`
    : 'Singular values. Every combination of parameters is determined by the readings.', drawing);
}

function convergence(history: NonNullable<Identification['history']>): HTMLElement | undefined {
  const chi = history.chi_square;
  if (!chi?.length) return undefined;
  const iteration = history.iteration ?? chi.map((_, i) => i);
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const target = plot({
      width, height: 250,
      x: {label: 'iteration', range: [Math.min(...iteration), Math.max(...iteration, 1)], ticks: iteration.length <= 14 ? iteration.map((i) => ({at: i, label: String(i)})) : undefined},
      y: {label: 'χ²', range: decades(positive(chi), 0.1), log: true},
      description: `Chi-square from ${number(chi[0])} to ${number(chi[chi.length - 1])} in ${iteration.length - 1} iterations`,
    });
    line(target, iteration, chi, 'value');
    dots(target, iteration, chi, 'determined');
    return target.root;
  });
  return figure(`Convergence: χ² from ${number(chi[0])} to ${number(chi[chi.length - 1], 4)}.`, drawing);
}

function orders(selection: NonNullable<Identification['order_selection']>): HTMLElement | undefined {
  const held = selection.held_out_rms_um ?? [];
  const fit = selection.fit_rms_um ?? [];
  const labels = selection.label ?? held.map((_, i) => String(i + 1));
  const all = positive([...held, ...fit]);
  if (!all.length) return undefined;
  const index = labels.map((_, i) => i);
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const every = Math.max(1, Math.ceil((labels.length * Math.max(...labels.map((l) => l.length)) * 7) / Math.max(120, width - 90)));
    const target = plot({
      width, height: 250,
      x: {label: 'order', range: [-0.4, labels.length - 0.6], ticks: labels.map((label, at) => ({at, label})).filter((_, i) => i % every === 0)},
      y: {label: 'rms residual / µm', range: decades(all, 0.1), log: true},
      description: 'Residual at the measured and at held-out poses against the order of the model',
    });
    if (selection.chosen !== undefined) rule(target, selection.chosen, 'x', 'limit', 'chosen');
    line(target, index, fit, 'faint');
    line(target, index, held, 'value');
    dots(target, index, held, 'determined');
    return target.root;
  });
  return figure('Choice of the order: residual at held-out poses (strong) and at fitted poses (faint).', drawing);
}

export function identificationSection(data: Identification, summary: Summary): HTMLElement | undefined {
  const part = section('identification', 'Observability and convergence');
  const words: string[] = [];
  if (data.strategy) words.push(`Strategy: ${data.strategy}.`);
  if (data.loss) words.push(`Loss: ${data.loss}.`);
  if (summary.rank !== undefined && summary.parameters !== undefined)
    words.push(`${count(summary.parameters)} parameters, rank ${count(summary.rank)}, null space ${count(summary.null_space ?? summary.parameters - summary.rank)}.`);
  if (summary.condition_number !== undefined) words.push(`Condition number without the null space ${number(summary.condition_number)}.`);
  if (words.length) part.append(html('p', {class: 'lead'}, words.join(' ')));
  const figures = [
    data.singular_values?.length ? singularValues(data.singular_values, summary.rank, data.rank_threshold) : undefined,
    data.history && convergence(data.history),
    data.order_selection && orders(data.order_selection),
  ].filter((f): f is HTMLElement => Boolean(f));
  if (figures.length) part.append(html('div', {class: `columns ${figures.length > 2 ? 'three' : ''}`}, ...figures));
  if (data.gauge?.length) {
    part.append(html('h3', {}, 'Gauge'), html('p', {class: 'note'}, 'What the readings cannot separate, and the convention that settles it.'),
      html('ol', {class: 'gauge-list'}, ...data.gauge.map((entry) => html('li', {},
        html('span', {}, entry.text ?? entry.parameters?.join(', ') ?? ''),
        entry.convention && html('em', {}, entry.convention),
        entry.text && !!entry.parameters?.length && html('code', {}, entry.parameters.join('  '))))));
  }
  if (data.strategies?.length)
    part.append(dataTable('Strategies', ['Strategy', 'Mean before / µm', 'Mean after / µm', 'Max after / µm', 'Left / %', 'Published / %', 'Why'],
      data.strategies.map((s) => [s.name, s.mean_before_um ?? null, s.mean_after_um ?? null, s.max_after_um ?? null,
        s.mean_before_um && s.mean_after_um !== undefined ? (100 * s.mean_after_um) / s.mean_before_um : null,
        s.published_percent ?? null, s.note ?? ''])));
  if (part.children.length < 2) return undefined;
  return part;
}

