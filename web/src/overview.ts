// First screen: what was measured, the verdict in one sentence, the figures that matter.

import {PoseErrors, Report, Statistics, Summary} from './data';
import {html} from './dom';
import {evaluationFacts} from './evaluation';
import {count, number, prose, quantity} from './format';

/// Errors at poses: at unseen ones if there are any, else over the map.
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
  if (summary.verdict) return prose(summary.verdict);
  if (summary.converged === false) return 'The identification did not converge; the figures below are no result.';
  const head = headline(summary);
  if (!head) return '';
  const {errors, where} = head;
  const before = errors.position_before_um?.mean;
  const name = errors.quantity ?? 'volumetric error';
  const after = errors.position_after_um?.mean;
  if (before === undefined) return '';
  if (after === undefined) return `Mean ${name} ${quantity(before, 'µm')} ${where}.`;
  const predicted = errors.predicted_expanded_uncertainty_um?.mean;
  const interval = predicted === undefined ? '' : ` (predicted expanded uncertainty${errors.uncertainty_covers ? ` of the ${errors.uncertainty_covers}` : ''} ${quantity(predicted, 'µm')}, k\u00a0=\u00a02)`;
  return `Mean ${name} ${quantity(before, 'µm')} before, ${quantity(after, 'µm')} after correction ${where}${interval}.`;
}

interface Tile {
  label: string;
  key: string;
  value: string;
  unit?: string;
  note?: string;
}

interface Side {
  name: string;
  statistics: Statistics | undefined;
  style: string;
  key: string;
}

/// One quantity on two sides: mean, 95 % and maximum of each.
function pairTile(label: string, unit: string, sides: Side[]): HTMLElement | undefined {
  if (!sides[0].statistics) return undefined;
  const side = ({name, statistics, style, key}: Side) =>
    statistics &&
    html(
      'div',
      {class: `side ${style}`},
      html('span', {class: 'state'}, name),
      html('span', {class: 'figure'}, html('span', {'data-key': `${key}.mean`}, number(statistics.mean)), html('small', {}, `\u202f${unit}`)),
      html(
        'span',
        {class: 'note'},
        statistics.p95 !== undefined && html('span', {class: 'together'}, '95\u202f% below ', html('b', {'data-key': `${key}.p95`}, number(statistics.p95))),
        statistics.p95 !== undefined && statistics.max !== undefined && ' · ',
        statistics.max !== undefined && html('span', {class: 'together'}, 'max ', html('b', {'data-key': `${key}.max`}, number(statistics.max))),
      ),
    );
  return html('div', {class: 'tile pair'}, html('h3', {}, label), html('div', {class: 'sides'}, ...sides.map(side)));
}

/// The named figures over the grid of all commands: what is true where that is known, and what is predicted.
function volumetricTiles(summary: Summary): HTMLElement[] {
  const tiles: (HTMLElement | undefined)[] = [];
  const truth = summary.true_volumetric_error;
  const predicted = summary.predicted_volumetric_error;
  if (truth)
    tiles.push(pairTile('True volumetric error, mean', 'µm', [
      {name: truth.after_um ? 'before' : 'as it is', statistics: truth.before_um, style: 'before', key: 'true_volumetric_error.before_um'},
      {name: 'after', statistics: truth.after_um, style: 'after', key: 'true_volumetric_error.after_um'}]));
  if (predicted)
    tiles.push(pairTile('Predicted volumetric error, mean', 'µm', [
      {name: predicted.after_expanded_um ? 'before' : 'as it is', statistics: predicted.before_um, style: 'before', key: 'predicted_volumetric_error.before_um'},
      {name: `after, k\u00a0=\u00a02${predicted.uncertainty_covers ? `, ${predicted.uncertainty_covers}` : ''}`, statistics: predicted.after_expanded_um, style: 'after', key: 'predicted_volumetric_error.after_expanded_um'}]));
  return tiles.filter((tile): tile is HTMLElement => tile !== undefined);
}

const capitalised = (text: string) => text[0].toUpperCase() + text.slice(1);

function errorTiles(errors: PoseErrors, key: string, where = ''): HTMLElement[] {
  const quantity = errors.quantity ?? 'volumetric error';
  // At held-out reflectors and readings the set-up is fitted again for the nominal machine.
  const fitted = key === 'held_out' && errors.quantity !== undefined && !errors.quantity.endsWith('volumetric error');
  const states = fitted ? ['nominal machine, set-up fitted again', 'identified machine'] : ['before', 'after'];
  const pair = (label: string, before: Statistics | undefined, after: Statistics | undefined, stem: string, unit: string) => {
    const suffix = unit === 'µm' ? 'um' : 'urad';
    return pairTile(label, unit, [
      {name: after ? states[0] : 'as it is', statistics: before, style: 'before', key: `${key}.${stem}_before_${suffix}`},
      {name: states[1], statistics: after, style: 'after', key: `${key}.${stem}_after_${suffix}`}]);
  };
  const at = key === 'held_out' ? ' at unseen poses' : '';
  return [
    pair(`${capitalised(quantity)}${quantity.startsWith('residual') ? '' : at}, mean`, errors.position_before_um, errors.position_after_um, 'position', 'µm'),
    pair(`Orientation error, mean${where}`, errors.orientation_before_urad, errors.orientation_after_urad, 'orientation', 'µrad'),
  ].filter((tile): tile is HTMLElement => tile !== undefined);
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
    if (errors.quantity?.startsWith('residual'))
      add('Held-out residual', `${key}.times_stated_uncertainty`, errors.times_stated_uncertainty, 3, 'times', 'the stated uncertainties of the readings, root mean squares; their noise is in it');
    else add('Remaining error', `${key}.remaining_percent`, errors.remaining_percent, 3, '%', 'of the mean before');
    add(errors.quantity?.startsWith('residual') ? 'Uncertainty of the model there' : 'Predicted uncertainty', `${key}.predicted_expanded_uncertainty_um.mean`, errors.predicted_expanded_uncertainty_um?.mean, 3, 'µm',
        [errors.uncertainty_covers && `of the ${errors.uncertainty_covers}`, 'k = 2, mean',
          errors.coverage_percent !== undefined && `covers ${number(errors.coverage_percent)}\u202f% of the coordinates`].filter(Boolean).join('; '));
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
  const residual = summary.residual;
  if (residual?.outliers && residual.times_stated_uncertainty !== undefined)
    add('Residual with outliers', 'residual.times_stated_uncertainty', residual.times_stated_uncertainty, 3, 'times', `the stated uncertainties; ${number(residual.times_stated_uncertainty_without_outliers)} times without the ${count(residual.outliers)} outlier${residual.outliers === 1 ? '' : 's'}`);
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
    list.append(html('li', {class: `level-${known}`}, html('strong', {}, known[0].toUpperCase() + known.slice(1)), html('span', {}, prose(text))));
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
  tiles.append(...volumetricTiles(summary));
  // The map repeats what the named figures say of its poses.
  if (head && (head.key === 'held_out' || !tiles.children.length)) tiles.append(...errorTiles(head.errors, head.key));
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
        html('div', {class: 'figure'}, html('span', {'data-key': tile.key}, tile.value), tile.unit && html('small', {}, `\u202f${tile.unit}`)),
        tile.note && html('div', {class: 'note'}, tile.note),
      ),
    );
  if (tiles.children.length) box.append(tiles);
  const stated = summary.true_volumetric_error?.description ?? summary.predicted_volumetric_error?.description;
  if (stated) box.append(html('p', {class: 'note under'}, `Volumetric error over ${stated}.`));
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
