// Residuals of any instrument: every component in the order of the readings, over time and over each axis, outliers marked.

import {Column, SetupResiduals, splitUnit, unitText} from './data';
import {field, html, responsive, section} from './dom';
import {count, number} from './format';
import {dots, plot, rule} from './plot';
import {extent} from './scale';

interface Choice {
  label: string;
  values: number[];
  axis: string;
  angle: boolean;
}

function choices(setup: SetupResiduals): Choice[] {
  const list: Choice[] = [];
  if (setup.time_s) list.push({label: 'time', values: setup.time_s, axis: 'time / s', angle: false});
  list.push({label: 'reading number', values: setup.reading, axis: 'reading', angle: false});
  for (const [key, values] of Object.entries(setup.positions ?? {})) {
    const {name, unit} = splitUnit(key);
    list.push({label: `position of ${name}`, values, axis: `${name} / ${unit}`, angle: unit === '°'});
  }
  return list;
}

/// Length of the normalised residual of each reading: what decides whether it is an outlier.
function norms(setup: SetupResiduals): Column {
  return setup.reading.map((_, i) => {
    const values = setup.components.map((component) => component.normalised[i]);
    return values.some((v) => v === null || v === undefined) ? null : Math.hypot(...(values as number[]));
  });
}

interface Row {
  name: string;
  label: string;
  values: Column;
  /// Nothing is drawn below zero, and the limit is drawn: the length of the residual.
  length?: boolean;
}

function rows(setup: SetupResiduals, raw: boolean): Row[] {
  if (raw)
    return setup.components.flatMap((c) => (c.residual ? [{name: c.name, label: `${c.name} / ${unitText(c.unit) || '1'}`, values: c.residual}] : []));
  const list: Row[] = setup.components.map((c) => ({name: c.name, label: `${c.name} / standard uncertainty`, values: c.normalised}));
  // With one component its own plot shows the limit.
  if (list.length > 1) list.push({name: 'length', label: 'length of all components / standard uncertainty', values: norms(setup), length: true});
  return list;
}

function drawRow(row: Row, setup: SetupResiduals, choice: Choice, raw: boolean): HTMLElement {
  const limit = setup.outlier_limit;
  const marked = (i: number) => Boolean(setup.outlier?.[i]);
  const unused = (i: number) => Boolean(setup.held_out?.[i]) && !marked(i);
  const single = setup.components.length === 1;
  const [low, high] = extent(row.values.filter((_, i) => !marked(i)));
  const least = raw ? 0 : row.length || single ? (limit ?? 3) * 1.1 : 3.3;
  const reach = Math.max(Math.abs(low), Math.abs(high), least) * 1.15;
  const beyond = row.values.filter((v) => v !== null && Math.abs(v) > reach).length;
  // Outliers beyond the drawing sit on its edge: they are counted, not lost, and do not flatten the rest.
  const clamped = row.values.map((v) => (v === null ? null : Math.max(-0.96 * reach, Math.min(0.96 * reach, v))));
  const bad = row.values.filter((_, i) => marked(i)).length;
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const target = plot({
      width, height: 176, zeroLine: true,
      x: {label: choice.axis, range: extent(choice.values), angle: choice.angle},
      y: {label: row.label, range: [row.length ? 0 : -reach, reach]},
      description: `Residuals, ${row.name}, against ${choice.label}: ${count(row.values.length)} readings from ${number(extent(row.values)[0])} to ${number(extent(row.values)[1])}, ${count(bad)} outliers marked`,
    });
    if (limit && !raw && (row.length || single)) {
      rule(target, limit, 'y', 'limit', 'limit of outliers');
      if (!row.length) rule(target, -limit, 'y', 'limit');
    }
    const few = row.values.length < 400 ? ' few' : '';
    dots(target, choice.values, clamped.map((v, i) => (marked(i) || unused(i) ? null : v)), `residual${few}`);
    dots(target, choice.values, clamped.map((v, i) => (unused(i) ? v : null)), `residual unused${few}`);
    dots(target, choice.values, clamped.map((v, i) => (marked(i) ? v : null)), 'outlier');
    return target.root;
  });
  return html('figure', {}, drawing, beyond > 0 && html('figcaption', {}, `${count(beyond)} beyond the drawing, shown at its edge.`));
}

function setupBlock(setup: SetupResiduals, index: number): HTMLElement {
  const options = choices(setup);
  const against = html('select', {id: `residual-x-${index}`}, ...options.map((o, i) => html('option', {value: i}, o.label)));
  const units = [...new Set(setup.components.filter((c) => c.residual).map((c) => unitText(c.unit) || 'no unit'))];
  const kind = html('select', {id: `residual-y-${index}`}, html('option', {value: 'normalised'}, 'normalised'),
    units.length > 0 && html('option', {value: 'raw'}, `in ${units.join(', ')}`));
  const plots = html('div', {class: 'stack'});
  const rebuild = () => {
    const raw = kind.value === 'raw';
    plots.replaceChildren(...rows(setup, raw).map((row) => drawRow(row, setup, options[Number(against.value)], raw)));
  };
  against.addEventListener('change', rebuild);
  kind.addEventListener('change', rebuild);
  rebuild();
  const shown = setup.reading.length;
  const total = setup.readings ?? shown;
  const bad = (setup.outlier ?? []).filter(Boolean).length;
  const unused = (setup.held_out ?? []).filter(Boolean).length;
  const words = [shown < total ? `${count(shown)} of ${count(total)} readings shown` : `${count(total)} readings`];
  if (bad) words.push(`${count(bad)} marked as outlier${bad === 1 ? '' : 's'}`);
  return html('div', {class: 'setup'},
    html('h3', {}, setup.name, html('small', {}, words.join(', '))),
    html('div', {class: 'controls'},
      field('Against', against),
      field('Residual', kind),
      bad > 0 && html('span', {class: 'key'}, html('i', {class: 'dot outlier'}), 'outlier'),
      unused > 0 && html('span', {class: 'key'}, html('i', {class: 'dot unused'}), 'held out of the fit')),
    plots,
    setup.outlier_limit !== undefined && html('p', {class: 'note'},
      `A reading is marked as outlier when the length of its normalised residual is above ${number(setup.outlier_limit)}.`));
}

export function residualSection(residuals: {setups?: SetupResiduals[]}): HTMLElement | undefined {
  const setups = residuals.setups ?? [];
  if (!setups.length) return undefined;
  const part = section('residuals', 'Residuals',
    'Measured minus modelled, divided by the standard uncertainty of the reading. They should look like noise of unit size, without pattern in time or over any axis.');
  setups.forEach((setup, i) => part.append(setupBlock({...setup, components: setup.components ?? []}, i)));
  return part;
}
