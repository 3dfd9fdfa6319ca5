// Every statistic of the summary in one table: means alone hide the tail.

import {Statistics, Summary} from './data';
import {html} from './dom';
import {number} from './format';

const kColumns: [keyof Statistics, string][] = [
  ['mean', 'mean'], ['rms', 'rms'], ['median', 'median'], ['p90', '90\u2009%'], ['p95', '95\u2009%'], ['p99', '99\u2009%'], ['max', 'max'],
];

function rowsOf(summary: Summary): {name: string; key: string; unit: string; statistics: Statistics}[] {
  const rows: {name: string; key: string; unit: string; statistics: Statistics}[] = [];
  const add = (name: string, key: string, unit: string, statistics: Statistics | undefined) => {
    if (statistics && Object.keys(statistics).length) rows.push({name, key, unit, statistics});
  };
  for (const [group, words] of [['held_out', 'unseen poses'], ['map', 'map']] as const) {
    const errors = summary[group];
    if (!errors) continue;
    const corrected = errors.position_after_um !== undefined;
    add(`Position error, ${words}, ${corrected ? 'before' : 'as it is'}`, `${group}.position_before_um`, 'µm', errors.position_before_um);
    add(`Position error, ${words}, after`, `${group}.position_after_um`, 'µm', errors.position_after_um);
    add(`Expanded uncertainty (k = 2)${errors.uncertainty_covers ? ` of the ${errors.uncertainty_covers}` : ''}, ${words}`, `${group}.predicted_expanded_uncertainty_um`, 'µm', errors.predicted_expanded_uncertainty_um);
    add(`Orientation error, ${words}, ${corrected ? 'before' : 'as it is'}`, `${group}.orientation_before_urad`, 'µrad', errors.orientation_before_urad);
    add(`Orientation error, ${words}, after`, `${group}.orientation_after_urad`, 'µrad', errors.orientation_after_urad);
  }
  add('Residual of the fit', 'fit_residual_um', 'µm', summary.fit_residual_um);
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
