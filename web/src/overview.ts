// First screen: what was measured, the verdict in one sentence, the figures that matter.

import {PoseErrors, Report, Statistics, Summary} from './data';
import {html} from './dom';
import {evaluationFacts} from './evaluation';
import {count, micro, number, quantity} from './format';

/// The errors a reader asks for first: at unseen poses if there are any, else over the map.
function headline(summary: Summary): {errors: PoseErrors; key: 'held_out' | 'map'; where: string} | undefined {
  if (summary.held_out?.position_before_um) {
    const held = summary.held_out;
    return {errors: held, key: 'held_out', where: `at ${held.poses ? `${count(held.poses)} ` : ''}unseen poses`};
  }
  if (summary.map?.position_before_um) {
    const map = summary.map;
    return {errors: map, key: 'map', where: `over ${map.poses ? `${count(map.poses)} ` : 'the mapped '}poses`};
  }
  return undefined;
}

export function verdict(summary: Summary): string {
  if (summary.verdict) return micro(summary.verdict);
  if (summary.converged === false) return 'The identification did not converge; the figures below are no result.';
  const head = headline(summary);
  if (!head) return '';
  const {errors, where} = head;
  const before = errors.position_before_um?.mean;
  const after = errors.position_after_um?.mean;
  if (before === undefined) return '';
  if (after === undefined) return `Mean volumetric error ${quantity(before, 'µm')} ${where}.`;
  const predicted = errors.predicted_expanded_uncertainty_um?.mean;
  const interval = predicted === undefined ? '' : ` (predicted expanded uncertainty${errors.uncertainty_covers ? ` of the ${errors.uncertainty_covers}` : ''} ${quantity(predicted, 'µm')}, k\u00a0=\u00a02)`;
  return `Mean volumetric error ${quantity(before, 'µm')} before, ${quantity(after, 'µm')} after correction ${where}${interval}.`;
}

interface Tile {
  label: string;
  key: string;
  value: string;
  unit?: string;
  note?: string;
}

function errorTiles(errors: PoseErrors, key: string, where = ''): HTMLElement[] {
  const tiles: HTMLElement[] = [];
  const pair = (label: string, before: Statistics | undefined, after: Statistics | undefined, stem: string, unit: string) => {
    if (!before) return;
    const side = (name: string, statistics: Statistics, style: string, stateKey: string) =>
      html(
        'div',
        {class: `side ${style}`},
        html('span', {class: 'state'}, name),
        html(
          'span',
          {class: 'figure'},
          html('span', {'data-key': `${stateKey}.mean`}, number(statistics.mean)),
          html('small', {}, `\u2009${unit}`),
        ),
        html(
          'span',
          {class: 'note'},
          statistics.p95 !== undefined && html('span', {}, '95\u2009% below ', html('b', {'data-key': `${stateKey}.p95`}, number(statistics.p95))),
          statistics.p95 !== undefined && statistics.max !== undefined && ' · ',
          statistics.max !== undefined && html('span', {}, 'max ', html('b', {'data-key': `${stateKey}.max`}, number(statistics.max))),
        ),
      );
    tiles.push(
      html(
        'div',
        {class: 'tile pair'},
        html('h3', {}, label),
        html(
          'div',
          {class: 'sides'},
          side(after ? 'before' : 'as it is', before, 'before', `${key}.${stem}_before_${unit === 'µm' ? 'um' : 'urad'}`),
          after && side('after', after, 'after', `${key}.${stem}_after_${unit === 'µm' ? 'um' : 'urad'}`),
        ),
      ),
    );
  };
  pair('Volumetric error, mean', errors.position_before_um, errors.position_after_um, 'position', 'µm');
  pair(`Orientation error, mean${where}`, errors.orientation_before_urad, errors.orientation_after_urad, 'orientation', 'µrad');
  return tiles;
}

function smallTiles(summary: Summary, errors: PoseErrors | undefined, key: string): Tile[] {
  const tiles: Tile[] = [];
  const add = (label: string, path: string, value: number | undefined, digits: number, unit = '', note = '') => {
    if (value === undefined || value === null) return;
    tiles.push({label, key: path, value: digits ? number(value, digits) : count(value), unit, note});
  };
  if (errors) {
    add('Reduction', `${key}.reduction`, errors.reduction, 3, 'times', 'mean before over mean after');
    add('Against its prediction', `${key}.uncertainty_ratio`, errors.uncertainty_ratio, 3, '', 'error over predicted standard uncertainty, root mean squares; 1 if it is right');
    add('Remaining error', `${key}.remaining_percent`, errors.remaining_percent, 3, '%', 'of the mean before');
    add('Predicted uncertainty', `${key}.predicted_expanded_uncertainty_um.mean`, errors.predicted_expanded_uncertainty_um?.mean, 3, 'µm',
        [errors.uncertainty_covers && `of the ${errors.uncertainty_covers}`, 'k = 2, mean',
          errors.coverage_percent !== undefined && `covers ${number(errors.coverage_percent)}\u2009% of the coordinates`].filter(Boolean).join('; '));
  }
  const monte = summary.monte_carlo;
  if (monte?.samples) add('Monte Carlo', 'monte_carlo.samples', monte.samples, 0, '',
      monte.agrees === undefined ? 'samples' : monte.agrees ? 'samples; confirm the uncertainties' : 'samples; differ from the covariance');
  add('Readings', 'readings', summary.readings, 0, '',
      summary.outliers === undefined ? '' : `${count(summary.outliers)} marked as outlier${summary.outliers === 1 ? '' : 's'}`);
  add('Parameters', 'parameters', summary.parameters, 0, '',
      [summary.machine_parameters === undefined ? '' : `${count(summary.machine_parameters)} of the machine, ${count(summary.setup_parameters)} of set-ups`,
        summary.rank === undefined ? '' : `rank ${count(summary.rank)}, ${count(summary.null_space)} fixed by convention`].filter(Boolean).join('; '));
  add('Degrees of freedom', 'degrees_of_freedom', summary.degrees_of_freedom, 0, '',
      summary.chi_square === undefined || summary.chi_square === null ? '' : `χ² = ${number(summary.chi_square, 4)}` +
          (summary.chi_square_probability === undefined ? '' : `, p = ${number(summary.chi_square_probability, 2)}`));
  add('Residual, normalised', 'normalised_residual_rms', summary.normalised_residual_rms, 3, '', summary.residuals === undefined ? '1 if model and noise are right' : `of ${count(summary.residuals)} residuals; 1 if model and noise are right`);
  add('Observability index', 'observability_index', summary.observability_index, 3, '', summary.observability_index_kind ?? '');
  return tiles;
}

function facts(report: Report): HTMLElement {
  const summary = report.summary ?? {};
  const entries: [string, string | undefined][] = [
    ['Machine', report.machine?.name ?? summary.machine],
    ['Chain', report.machine?.chain ?? summary.chain],
    ['Study', report.study?.name ?? summary.study],
    ['Identification', summary.status && summary.iterations !== undefined
      ? `${summary.status}, ${summary.iterations} iterations` : summary.status],
    ['Data', report.simulated === undefined ? undefined : report.simulated ? 'simulated, truth known' : 'measured'],
    ['Made', report.created],
  ];
  const list = html('dl', {class: 'facts'});
  for (const [name, value] of entries)
    if (value) list.append(html('div', {}, html('dt', {}, name), html('dd', {class: name === 'Chain' ? 'chain-text' : ''}, value)));
  return list;
}

export function warnings(report: Report): HTMLElement | undefined {
  const entries = [...(report.warnings ?? [])];
  // A result that is none must not look like one, whether or not the producer warns.
  if (report.summary?.converged === false)
    entries.unshift({level: 'error', text: `The identification did not converge${report.summary.status ? ` (${report.summary.status})` : ''}: its figures are not a result.`});
  if (!entries.length) return undefined;
  const list = html('ul', {class: 'warnings', 'aria-label': 'Warnings'});
  for (const entry of entries) {
    const {level, text} = typeof entry === 'string' ? {level: 'warning', text: entry} : {level: entry.level ?? 'warning', text: entry.text};
    const known = ['error', 'warning', 'note'].includes(level) ? level : 'warning';
    list.append(html('li', {class: `level-${known}`}, html('strong', {}, known[0].toUpperCase() + known.slice(1)), html('span', {}, micro(text))));
  }
  return list;
}

export function overview(report: Report): HTMLElement {
  const summary = report.summary ?? {};
  const head = headline(summary);
  const sentence = verdict(summary);
  const box = html(
    'header',
    {class: 'overview'},
    html('h1', {}, report.title),
    report.subtitle && html('p', {class: 'subtitle'}, report.subtitle),
    report.evaluation?.facts?.length ? evaluationFacts(report.evaluation) : facts(report),
    sentence && html('p', {class: 'verdict', 'data-key': 'verdict'}, sentence),
    warnings(report),
  );
  const tiles = html('div', {class: 'tiles'});
  if (head) tiles.append(...errorTiles(head.errors, head.key));
  // Unseen poses may say nothing of the orientation; the map does.
  if (head?.key === 'held_out' && !head.errors.orientation_before_urad && summary.map?.orientation_before_urad)
    tiles.append(...errorTiles({orientation_before_urad: summary.map.orientation_before_urad, orientation_after_urad: summary.map.orientation_after_urad}, 'map', ' over the map'));
  const small = html('div', {class: 'tiles small'});
  for (const tile of smallTiles(summary, head?.errors, head?.key ?? ''))
    small.append(
      html(
        'div',
        {class: 'tile'},
        html('h3', {}, tile.label),
        html('div', {class: 'figure'}, html('span', {'data-key': tile.key}, tile.value), tile.unit && html('small', {}, `\u2009${tile.unit}`)),
        tile.note && html('div', {class: 'note'}, tile.note),
      ),
    );
  if (tiles.children.length) box.append(tiles);
  if (head?.errors.description) {
    const against: Record<string, string> = {truth: 'compared with the known truth', readings: 'compared with readings not used in the fit', model: 'predicted by the model'};
    const reference = head.errors.reference;
    box.append(html('p', {class: 'note under'}, `Evaluated at ${head.errors.poses && !head.errors.description.startsWith(String(head.errors.poses)) ? `${count(head.errors.poses)} poses: ` : ''}${head.errors.description}` +
      (reference ? `; ${against[reference] ?? `compared with ${reference}`}` : '') +
      (head.errors.outside_range ? `; ${count(head.errors.outside_range)} more poses are outside the measured range and have no result.` : '.')));
  }
  if (small.children.length) box.append(small);
  return box;
}
