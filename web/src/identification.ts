// How well the readings determine the parameters: rank, gauge, convergence, order.

import {Column, Identification, Summary} from './data';
import {figure, html, isPrinting, responsive, section} from './dom';
import {count, number} from './format';
import {dots, line, plot, rule} from './plot';
import {extent} from './scale';
import {dataTable} from './table';

const heightOf = () => (isPrinting() ? 176 : 250);

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
      width, height: heightOf(),
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
  const axis = {label: 'iteration', range: [Math.min(...iteration), Math.max(...iteration, 1)] as [number, number],
    ticks: iteration.length <= 14 ? iteration.map((i) => ({at: i, label: String(i)})) : undefined};
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const target = plot({
      width, height: heightOf(), x: axis,
      y: {label: 'χ²', range: decades(positive(chi), 0.1), log: true},
      description: `Chi-square from ${number(chi[0])} to ${number(chi[chi.length - 1])} in ${iteration.length - 1} iterations`,
    });
    line(target, iteration, chi, 'value');
    dots(target, iteration, chi, 'determined');
    return target.root;
  });
  return figure(`Convergence: χ² from ${number(chi[0])} to ${number(chi[chi.length - 1], 4)}.`, drawing);
}

/// Size of the steps and of the damping, both without unit, on one axis.
function steps(history: NonNullable<Identification['history']>): HTMLElement | undefined {
  const step = history.relative_step ?? [], damping = history.damping ?? [];
  const all = positive([...step, ...damping]);
  if (!all.length) return undefined;
  const iteration = history.iteration ?? (history.chi_square ?? step).map((_, i) => i);
  const shown = (values: Column) => values.map((v) => (v !== null && v > 0 ? v : null));
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const target = plot({
      width, height: heightOf(),
      x: {label: 'iteration', range: [Math.min(...iteration), Math.max(...iteration, 1)]},
      y: {label: 'relative step, damping', range: decades(all, 0.1), log: true},
      description: `Relative step from ${number(positive(step)[0])} to ${number(positive(step)[positive(step).length - 1])}`,
    });
    line(target, iteration, shown(damping), 'truth');
    line(target, iteration, shown(step), 'value');
    dots(target, iteration, shown(step), 'determined');
    return target.root;
  });
  return figure(`Size of each step relative to the parameters${positive(damping).length ? '; damping dashed' : ''}.`, drawing);
}

function orders(selection: NonNullable<Identification['order_selection']>): HTMLElement | undefined {
  const held = selection.held_out_normalised_rms ?? [];
  const labels = selection.label ?? held.map((_, i) => String(i + 1));
  const all = positive(held);
  if (!all.length) return undefined;
  const index = labels.map((_, i) => i);
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const every = Math.max(1, Math.ceil((labels.length * Math.max(...labels.map((l) => l.length)) * 7) / Math.max(120, width - 90)));
    const target = plot({
      width, height: heightOf(),
      x: {label: 'model, in the order tried', range: [-0.4, labels.length - 0.6], ticks: labels.map((label, at) => ({at, label})).filter((_, i) => i % every === 0)},
      y: {label: 'rms of held-out residuals / standard uncertainty', range: decades(all, 0.1), log: true},
      description: `Residual at held-out poses for ${labels.length} models tried${selection.chosen === undefined ? '' : `; chosen: ${labels[selection.chosen]}`}`,
    });
    if (selection.chosen !== undefined) rule(target, selection.chosen, 'x', 'limit', 'chosen');
    line(target, index, held, 'value');
    dots(target, index, held, 'determined');
    return target.root;
  });
  return figure(`Choice of the order by the residual at held-out poses${selection.chosen === undefined ? '' : `; chosen: ${labels[selection.chosen]}`}.`, drawing);
}

export function identificationSection(data: Identification, summary: Summary): HTMLElement | undefined {
  const part = section('identification', 'Observability and convergence');
  const words: string[] = [];
  if (data.strategy) words.push(`Strategy: ${data.strategy}.`);
  if (data.loss) words.push(`Loss: ${data.loss}.`);
  if (summary.rank !== undefined && summary.parameters !== undefined)
    words.push(`${count(summary.parameters)} parameters, rank ${count(summary.rank)}, null space ${count(summary.null_space ?? summary.parameters - summary.rank)}.`);
  if (data.hardly_seen) words.push(`${count(data.hardly_seen)} more combinations are seen so weakly that they are fixed too.`);
  if (summary.condition_number !== undefined) words.push(`Condition number without the null space ${number(summary.condition_number)}.`);
  if (summary.observability_index !== undefined && summary.observability_index_kind)
    words.push(`Observability index ${summary.observability_index_kind} ${number(summary.observability_index)}.`);
  if (words.length) part.append(html('p', {class: 'lead'}, words.join(' ')));
  const figures = [
    data.singular_values?.length ? singularValues(data.singular_values, summary.rank, data.rank_threshold) : undefined,
    data.history && convergence(data.history),
    data.history && steps(data.history),
    data.order_selection && orders(data.order_selection),
  ].filter((f): f is HTMLElement => Boolean(f));
  if (figures.length) part.append(html('div', {class: `columns ${figures.length === 3 ? 'three' : ''}`}, ...figures));
  if (data.stages?.length)
    part.append(dataTable('Stages of the identification', ['Stage', 'Status', 'Parameters', 'Residuals', 'Degrees of freedom', 'χ²'],
      data.stages.map((s, i) => [String(i + 1), s.status ?? '', s.parameters ?? null, s.residuals ?? null, s.degrees_of_freedom ?? null, s.chi_square ?? null])));
  if (part.children.length < 2) return undefined;
  return part;
}

export function gaugeSection(gauge: Identification['gauge']): HTMLElement | undefined {
  if (!gauge?.length) return undefined;
  const part = section('gauge', 'Gauge', 'What the readings cannot separate, and the convention that settles it.');
  part.append(html('ol', {class: 'gauge-list'}, ...gauge.map((entry) => html('li', {},
    html('span', {}, entry.text ?? entry.parameters?.join(', ') ?? ''),
    entry.convention && html('em', {}, entry.by_convention === false ? `No convention fits, fixed by: ${entry.convention}` : entry.convention),
    entry.text && !!entry.parameters?.length && html('code', {}, entry.parameters.join('  '))))));
  return part;
}

