// What the map can show: displacement or rotation as arrows, their length or the uncertainty as colour, with statistics.

import {ErrorMap, PoseErrors, Statistics, Vectors} from './data';
import {html} from './dom';
import {count, number, quantity} from './format';
import {lengths} from './histogram';

/// One kind of arrow, before and after.
export interface Quantity {
  id: 'displacement' | 'rotation';
  label: string;
  unit: string;
  key: 'um' | 'urad';
  /// Millimetres of one unit drawn without exaggeration; of a rotation on an arm of 1 m.
  millimetres: number;
  views: {vectors: Vectors; length: number[]}[];
  what: string;
}

export interface Colour {
  id: 'length' | 'uncertainty';
  label: string;
  /// Below the colour bar.
  legend: string;
  unit: string;
  /// Values of a view.
  values: (view: number) => number[];
}

function turned(v: {a: number[]; b: number[]; c: number[]}): Vectors {
  return {x: v.a, y: v.b, z: v.c};
}

export function quantities(map: ErrorMap): Quantity[] {
  const list: Quantity[] = [];
  const of = (vectors: (Vectors | undefined)[]) =>
    vectors.filter((v): v is Vectors => v !== undefined).map((v) => ({vectors: v, length: lengths(v)}));
  list.push({id: 'displacement', label: map.quantity ?? 'displacement of the tool', unit: 'µm', key: 'um', millimetres: 1e-3,
    what: map.quantity ? `vectors of the ${map.quantity}` : 'displacement vectors',
    views: of([map.before_um, map.after_um])});
  if (map.before_urad)
    list.push({id: 'rotation', label: 'rotation of the tool', unit: 'µrad', key: 'urad', millimetres: 1e-3, what: 'rotation vectors',
      views: of([turned(map.before_urad), map.after_urad && turned(map.after_urad)])});
  return list;
}

export function colours(map: ErrorMap, quantity: Quantity): Colour[] {
  const word = quantity.id === 'rotation' ? 'rotation' : 'error';
  const named = quantity.id === 'rotation' ? word : map.quantity ?? word;
  const list: Colour[] = [{id: 'length', label: `size of the ${word}`, legend: `length of the ${named} / ${quantity.unit}`, unit: quantity.unit,
    values: (view) => quantity.views[Math.min(view, quantity.views.length - 1)].length}];
  const uncertainty = map.expanded_uncertainty_um;
  if (uncertainty?.length)
    list.push({id: 'uncertainty', label: 'uncertainty', legend: `expanded uncertainty of the ${map.quantity ?? 'predicted displacement'} (k = 2) / µm`, unit: 'µm',
      values: () => uncertainty});
  return list;
}

/// One scale for all views: 0 or a small value to the largest.
export function range(values: number[]): {low: number; high: number} {
  const high = Math.max(...values) || 1;
  const small = [...values].sort((a, b) => a - b)[Math.floor(values.length * 0.02)];
  return {low: Math.max(small, high * 1e-4), high};
}

/// "× 200" for a displacement; a rotation has no length of its own: "100 µrad drawn as 40 mm".
export function exaggeration(kind: Quantity, factor: number): string {
  return kind.id === 'displacement' ? `× ${count(factor)}` : `100\u202fµrad = ${quantity(factor * 0.1, 'mm', 2)}`;
}

/// Mean, 95 % and maximum over all poses of the map, from the summary; absent where it does not have them.
export function statisticsTable(kind: Quantity, hasUncertainty: boolean, summary: PoseErrors | undefined): HTMLElement | undefined {
  if (!summary) return undefined;
  const stem = kind.id === 'displacement' ? 'position' : 'orientation';
  const rows: {name: string; key: string; unit: string}[] = [
    {name: kind.views.length > 1 ? 'before' : 'as it is', key: `${stem}_before_${kind.key}`, unit: kind.unit},
    {name: 'after', key: `${stem}_after_${kind.key}`, unit: kind.unit},
  ];
  if (hasUncertainty && kind.id === 'displacement') rows.push({name: `expanded uncertainty (k = 2)${summary?.uncertainty_covers ? ` of the ${summary.uncertainty_covers}` : ''}`, key: 'predicted_expanded_uncertainty_um', unit: 'µm'});
  const present = rows.flatMap((row) => {
    const statistics = (summary as unknown as Record<string, Statistics | undefined>)[row.key];
    return statistics ? [{...row, statistics}] : [];
  });
  if (!present.length) return undefined;
  const cell = (value: number | undefined, path: string) =>
    html('td', {class: 'number'}, value === undefined ? '\u2013' : html('span', {'data-key': path}, number(value)));
  return html('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Statistics of the map'}, html('table', {class: 'map-statistics'},
    html('caption', {}, `${kind.id === 'displacement' ? 'Length' : 'Angle'} of the ${kind.label}${summary.poses ? ` over all ${count(summary.poses)} poses` : ''}`),
    html('thead', {}, html('tr', {}, ...['', 'mean', '95\u202f% below', 'max', ''].map((name, i) =>
      html('th', {scope: 'col', class: i > 0 && i < 4 ? 'number' : ''}, name)))),
    html('tbody', {}, ...present.map(({name, key, unit, statistics}) => html('tr', {},
      html('th', {scope: 'row'}, name), cell(statistics.mean, `map.${key}.mean`), cell(statistics.p95, `map.${key}.p95`),
      cell(statistics.max, `map.${key}.max`), html('td', {}, unit))))));
}
