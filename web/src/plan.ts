// A plan of readings: how many are enough, where the axes stand, what stays open, and the readings in their order.

import {Report, splitUnit} from './data';
import {figure, html, responsive, section} from './dom';
import {count, number, prose, quantity} from './format';
import {PlanBlock} from './plan_data';
import {dots, line, plot, readout, rule} from './plot';
import {extent} from './scale';
import {dataTable} from './table';

export function planCurveSection(plan: PlanBlock | undefined): HTMLElement | undefined {
  const curve = plan?.curve;
  if (!curve?.readings.length) return undefined;
  const part = section('curve', 'How many readings are enough', plan!.enough_words && prose(plan!.enough_words));
  const {readings, uncertainty_um: chosen} = curve;
  const gridReadings = curve.grid_readings ?? [];
  const grids = curve.grid_uncertainty_um ?? [];
  const there = (values: (number | null)[]) => values.filter((v): v is number => v !== null);
  if (!there(chosen).length) return part;
  const box = html('div', {class: 'drawing'});
  responsive(box, (width) => {
    const target = plot({
      width, height: 300,
      x: {label: 'readings', range: [0, extent([...readings, ...there(gridReadings)])[1] * 1.04]},
      y: {label: 'predicted volumetric standard uncertainty / µm', range: [0, extent([...there(chosen), ...there(grids)])[1] * 1.08]},
      description: `Predicted volumetric standard uncertainty from ${quantity(there(chosen)[0], 'µm')} to ${quantity(there(chosen)[there(chosen).length - 1], 'µm')} for ${count(readings[0])} to ${count(readings[readings.length - 1])} readings`,
    });
    if (curve.enough !== undefined) rule(target, readings[curve.enough], 'x', 'limit', `enough: ${count(readings[curve.enough])}`);
    line(target, readings, chosen, 'value');
    dots(target, readings, chosen, 'determined');
    dots(target, gridReadings, grids, 'undetermined');
    readout(target, readings, (i) => `${count(readings[i])}: ${chosen[i] === null ? 'open' : quantity(chosen[i], 'µm')}` +
      (i in grids ? `, best grid ${grids[i] === null ? 'open' : quantity(grids[i], 'µm')}` : ''));
    return target.root;
  });
  const key = (style: string, text: string) => html('span', {}, html('i', {class: `dot ${style}`, 'aria-hidden': 'true'}), text);
  const made = figure('Each number with the readings chosen for it. Where a number has no dot, so many readings do not determine everything.', box);
  made.prepend(html('p', {class: 'legend'}, key('contour', 'chosen readings'), there(grids).length > 0 && key('also0', 'best grid that determines everything')));
  part.append(made);
  return part;
}

/// Where each axis stands at the readings, in their order.
export function planPosesSection(report: Report): HTMLElement | undefined {
  const path = report.path;
  if (!report.plan || !path?.time_s?.length) return undefined;
  const part = section('poses', 'Positions of the axes', 'One dot for each reading, in the order in which readings are taken. Ends and middles of a travel are where polynomials are determined best.');
  const reading = path.time_s.map((_, i) => i + 1);
  const grid = html('div', {class: 'multiples'});
  for (const key of path.axes ?? Object.keys(path.commands)) {
    const {name, unit} = splitUnit(key);
    const values = path.commands[key];
    const box = html('div', {class: 'drawing'});
    responsive(box, (width) => {
      const target = plot({
        width, height: width < 240 ? 120 : 168, compact: true,
        x: {label: 'reading', range: [0, reading.length + 1]},
        y: {label: unit, range: extent([...values, ...(path.travel?.[key] ?? [])]), angle: unit === '°'},
        description: `${name} between ${number(extent(values)[0], 4)} and ${number(extent(values)[1], 4)} ${unit}`,
      });
      dots(target, reading, values, 'pose');
      return target.root;
    });
    grid.append(html('figure', {class: 'motion'}, html('figcaption', {}, html('b', {}, name)), box));
  }
  part.append(grid);
  return part;
}

export function planOpenSection(plan: PlanBlock | undefined): HTMLElement | undefined {
  if (!plan?.open?.length) return undefined;
  const part = section('open', 'What the plan does not determine');
  part.append(html('ul', {class: 'plain'}, ...plan.open.map((text) => html('li', {}, prose(text)))));
  return part;
}

export function planReadingsSection(plan: PlanBlock | undefined): HTMLElement | undefined {
  if (!plan?.readings?.rows.length) return undefined;
  const part = section('readings', 'Readings', 'In the order in which they are to be taken.');
  const table = dataTable('Readings', plan.readings.columns, plan.readings.rows);
  table.classList.add('tall');
  table.querySelector('caption')!.className = 'unseen';
  part.append(table);
  return part;
}
