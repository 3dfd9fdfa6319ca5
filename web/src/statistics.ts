// Every statistic of the summary in one table: means alone hide the tail.

import {Statistics, Summary} from './data';
import {html} from './dom';
import {number} from './format';

const kColumns: [keyof Statistics, string][] = [
  ['mean', 'mean'], ['rms', 'rms'], ['median', 'median'], ['p90', '90\u202f%'], ['p95', '95\u202f%'], ['p99', '99\u202f%'], ['max', 'max'],
];

function rowsOf(summary: Summary): {name: string; key: string; unit: string; statistics: Statistics}[] {
  const rows: {name: string; key: string; unit: string; statistics: Statistics}[] = [];
  const add = (name: string, key: string, unit: string, statistics: Statistics | undefined) => {
    if (statistics && Object.keys(statistics).length) rows.push({name, key, unit, statistics});
  };
  const truth = summary.true_volumetric_error;
  const predicted = summary.predicted_volumetric_error;
  add('True volumetric error, before', 'true_volumetric_error.before_um', 'µm', truth?.before_um);
  add('True volumetric error, after', 'true_volumetric_error.after_um', 'µm', truth?.after_um);
  add('Predicted volumetric error, before', 'predicted_volumetric_error.before_um', 'µm', predicted?.before_um);
  add(`Predicted volumetric error, after (k = 2)${predicted?.uncertainty_covers ? `, ${predicted.uncertainty_covers}` : ''}`, 'predicted_volumetric_error.after_expanded_um', 'µm', predicted?.after_expanded_um);
  for (const [group, words] of [['held_out', 'unseen poses'], ['map', 'map']] as const) {
    const errors = summary[group];
    if (!errors) continue;
    const corrected = errors.position_after_um !== undefined;
    const residual = errors.quantity?.startsWith('residual') ?? false;
    const fitted = group === 'held_out' && errors.quantity !== undefined && !errors.quantity.endsWith('volumetric error');
    const name = residual ? 'Residual of held-out readings' : `${errors.quantity ? errors.quantity[0].toUpperCase() + errors.quantity.slice(1) : 'Position error'}, ${words}`;
    add(`${name}, ${fitted ? 'nominal machine, set-up fitted again' : corrected ? 'before' : 'as it is'}`, `${group}.position_before_um`, 'µm', errors.position_before_um);
    add(`${name}, ${fitted ? 'identified machine' : 'after'}`, `${group}.position_after_um`, 'µm', errors.position_after_um);
    add(`Expanded uncertainty (k = 2)${errors.uncertainty_covers ? ` of the ${errors.uncertainty_covers}` : ''}, ${words}`, `${group}.predicted_expanded_uncertainty_um`, 'µm', errors.predicted_expanded_uncertainty_um);
    add(`Orientation error, ${words}, ${corrected ? 'before' : 'as it is'}`, `${group}.orientation_before_urad`, 'µrad', errors.orientation_before_urad);
    add(`Orientation error, ${words}, after`, `${group}.orientation_after_urad`, 'µrad', errors.orientation_after_urad);
  }
  const outliers = summary.residual?.outliers ?? 0;
  add(outliers ? 'Residual of the readings, with outliers' : 'Residual of the readings', 'fit_residual_um', 'µm', summary.fit_residual_um);
  if (outliers) add('Residual of the readings, without outliers', 'residual.length_without_outliers_um', 'µm', summary.residual?.length_without_outliers_um);
  return rows;
}

export function statisticsTable(summary: Summary): HTMLElement | undefined {
  const rows = rowsOf(summary);
  if (!rows.length) return undefined;
  const used = kColumns.filter(([key]) => rows.some((row) => row.statistics[key] !== undefined));
  const caption = 'All statistics; percentages: part of the poses below';
  return html('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'All statistics'},
    html('table', {class: 'statistics'},
      html('caption', {}, caption),
      html('thead', {}, html('tr', {}, html('th', {scope: 'col'}, 'Length of'), ...used.map(([, name]) => html('th', {scope: 'col', class: 'number'}, name)), html('th', {scope: 'col'}, 'Unit'))),
      html('tbody', {}, ...rows.map((row) => html('tr', {}, html('th', {scope: 'row'}, row.name),
        ...used.map(([key]) => {
          const value = row.statistics[key];
          return html('td', {class: 'number'}, value === undefined ? '\u2013' : html('span', {'data-key': `${row.key}.${key}`}, number(value)));
        }),
        html('td', {}, row.unit))))));
}
