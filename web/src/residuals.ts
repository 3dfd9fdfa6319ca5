// Residuals in the order of the readings, over time and over each axis, with the outliers marked.

import {SetupResiduals, splitUnit} from './data';
import {html, responsive, section} from './dom';
import {count} from './format';
import {dots, plot, rule} from './plot';
import {extent} from './scale';

interface Choice {
  label: string;
  values: number[];
  axis: string;
  angle: boolean;
}

function choices(setup: SetupResiduals): Choice[] {
  const list: Choice[] = [{label: 'reading number', values: setup.reading, axis: 'reading', angle: false}];
  if (setup.time_s) list.push({label: 'time', values: setup.time_s, axis: 'time / s', angle: false});
  for (const [key, values] of Object.entries(setup.positions ?? {})) {
    const {name, unit} = splitUnit(key);
    list.push({label: `position of ${name}`, values, axis: `${name} / ${unit}`, angle: unit === '°'});
  }
  return list;
}

function setupBlock(setup: SetupResiduals, limit: number | undefined, index: number): HTMLElement {
  const options = choices(setup);
  const against = html('select', {id: `residual-x-${index}`}, ...options.map((o, i) => html('option', {value: i}, o.label)));
  const isRaw = html('select', {id: `residual-y-${index}`}, html('option', {value: 'normalised'}, 'normalised'),
    setup.residual_um && html('option', {value: 'um'}, 'in µm'));
  const marked = setup.reading.map((_, i) => Boolean(setup.outlier?.[i]));
  const plots = html('div', {class: 'stack'});
  const rebuild = () => {
    const choice = options[Number(against.value)];
    const raw = isRaw.value === 'um' && setup.residual_um;
    const columns = raw ? setup.residual_um! : setup.normalised;
    plots.replaceChildren();
    for (const [name, values] of Object.entries(columns)) {
      const clean = values.filter((_, i) => !marked[i]);
      const [low, high] = extent(clean);
      const reach = Math.max(Math.abs(low), Math.abs(high), raw ? 0 : (limit ?? 3) * 1.1) * 1.15;
      const beyond = values.filter((v) => v !== null && Math.abs(v) > reach).length;
      // Outliers beyond the drawing sit on its edge: they are counted, not lost, and do not flatten the rest.
      const clamped = values.map((v) => (v === null ? null : Math.max(-0.96 * reach, Math.min(0.96 * reach, v))));
      const drawing = html('div', {class: 'drawing'});
      responsive(drawing, (width) => {
        const target = plot({
          width, height: 176, zeroLine: true,
          x: {label: choice.axis, range: extent(choice.values), angle: choice.angle},
          y: {label: raw ? `${name} / µm` : `${name} / standard uncertainty`, range: [-reach, reach]},
          description: `Residuals ${name} against ${choice.label}, ${marked.filter(Boolean).length} outliers marked`,
        });
        if (!raw && limit) {
          rule(target, limit, 'y', 'limit');
          rule(target, -limit, 'y', 'limit');
        }
        dots(target, choice.values, clamped.map((v, i) => (marked[i] ? null : v)), 'residual');
        dots(target, choice.values, clamped.map((v, i) => (marked[i] ? v : null)), 'outlier');
        return target.root;
      });
      plots.append(html('figure', {}, drawing, beyond > 0 && html('figcaption', {}, `${count(beyond)} beyond the drawing, shown at its edge.`)));
    }
  };
  against.addEventListener('change', rebuild);
  isRaw.addEventListener('change', rebuild);
  rebuild();
  const shown = setup.reading.length;
  const total = setup.readings ?? shown;
  const bad = marked.filter(Boolean).length;
  return html('div', {class: 'setup'},
    html('h3', {}, setup.name, html('small', {}, `${shown < total ? `${count(shown)} of ${count(total)} readings shown` : `${count(total)} readings`}${bad ? `, ${count(bad)} marked as outliers` : ''}`)),
    html('div', {class: 'controls'},
      html('label', {for: `residual-x-${index}`}, 'Against'), against,
      html('label', {for: `residual-y-${index}`}, 'Residual'), isRaw,
      bad > 0 && html('span', {class: 'key'}, html('i', {class: 'dot outlier'}), 'outlier')),
    plots);
}

export function residualSection(residuals: {outlier_limit?: number; setups?: SetupResiduals[]}): HTMLElement | undefined {
  const setups = residuals.setups ?? [];
  if (!setups.length) return undefined;
  const part = section('residuals', 'Residuals',
    'Measured minus modelled, divided by the standard uncertainty of the reading. They should look like noise of unit size, without pattern in time or over any axis.');
  setups.forEach((setup, i) => part.append(setupBlock(setup, residuals.outlier_limit, i)));
  return part;
}
