// Standard uncertainties by simulation beside those from the covariance: ratios, interval ends, and whether they agree.

import {Column, MonteCarlo, Parameters} from './data';
import {figure, html, responsive, section, svg} from './dom';
import {count, number} from './format';
import {dots, plot, Plot, readout, rule} from './plot';
import {extent} from './scale';

/// The middle of each group of neighbouring parameters; of names that would overlap the larger group keeps its own.
function groupTicks(p: Parameters, index: number[], width: number): {at: number; label: string}[] {
  const ticks: {at: number; label: string; size: number}[] = [];
  let from = 0;
  for (let i = 1; i <= index.length; ++i) {
    const name = p.group?.[index[from]] ?? '';
    if (i < index.length && (p.group?.[index[i]] ?? '') === name) continue;
    ticks.push({at: (from + i + 1) / 2, label: name, size: i - from});
    from = i;
  }
  const pixels = Math.max(60, width - 60) / (index.length + 1);
  const kept: typeof ticks = [];
  for (const tick of [...ticks].sort((a, b) => b.size - a.size || a.at - b.at))
    if (kept.every((other) => Math.abs(other.at - tick.at) * pixels > 3.6 * (other.label.length + tick.label.length) + 6)) kept.push(tick);
  return kept;
}

function chanceBand(target: Plot, low: number | undefined, high: number | undefined): void {
  if (low === undefined || high === undefined) return;
  const {left, right} = target.area;
  target.layer.append(svg('rect', {x: left, width: Math.max(1, right - left), y: target.y(high), height: Math.max(0, target.y(low) - target.y(high)), class: 'band'}));
}

function ratios(p: Parameters, figures: MonteCarlo, index: number[]): HTMLElement {
  const values = index.map((i) => p.monte_carlo_ratio![i]);
  const place = index.map((_, k) => k + 1);
  const {chance_ratio_low: low, chance_ratio_high: high} = figures;
  const isBeyond = (v: number | null) => v !== null && low !== undefined && high !== undefined && (v < low || v > high);
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const [from, to] = extent([...values, 1, low, high]);
    const margin = Math.max((to - from) * 0.12, 0.01);
    const target = plot({
      width, height: 250,
      x: {label: 'parameters by group', range: [0, index.length + 1], ticks: groupTicks(p, index, width)},
      y: {label: 'standard uncertainty, Monte Carlo / covariance', range: [from - margin, to + margin]},
      description: `Ratios of ${count(index.length)} parameters from ${number(extent(values)[0])} to ${number(extent(values)[1])}`,
    });
    chanceBand(target, low, high);
    rule(target, 1, 'y', 'limit');
    dots(target, place, values.map((v) => (isBeyond(v) ? null : v)), 'determined ratio');
    dots(target, place, values.map((v) => (isBeyond(v) ? v : null)), 'undetermined ratio');
    readout(target, place, (k) => `${p.name[index[k]]}: ${number(values[k], 4)}`);
    return target.root;
  });
  return figure(`Ratio of every uncertain parameter.${low === undefined ? '' : ` In the shaded range differences are no more than chance with ${count(figures.samples)} samples.`}`, drawing);
}

/// Ends of the simulated 95 % interval, counted in standard uncertainties of the covariance: ±1.96 if both agree.
function intervals(p: Parameters, index: number[]): HTMLElement | undefined {
  if (!p.monte_carlo_low || !p.monte_carlo_high || !p.standard_uncertainty) return undefined;
  const end = (column: Column) => index.map((i) => {
    const value = p.value[i], u = p.standard_uncertainty![i], at = column[i];
    return value === null || at === null || !u ? null : (at - value) / u;
  });
  const low = end(p.monte_carlo_low), high = end(p.monte_carlo_high);
  const place = index.map((_, k) => k + 1);
  const drawing = html('div', {class: 'drawing'});
  responsive(drawing, (width) => {
    const reach = Math.max(2.4, ...extent([...low, ...high]).map(Math.abs)) * 1.08;
    const target = plot({
      width, height: 250, zeroLine: true,
      x: {label: 'parameters by group', range: [0, index.length + 1], ticks: groupTicks(p, index, width)},
      y: {label: '(value − estimate) / standard uncertainty', range: [-reach, reach]},
      description: `Simulated 95 percent intervals of ${count(index.length)} parameters, in standard uncertainties of the covariance`,
    });
    dots(target, place, low, 'determined ratio');
    dots(target, place, high, 'determined ratio');
    rule(target, 1.96, 'y', 'limit', '+1.96');
    rule(target, -1.96, 'y', 'limit', '−1.96');
    readout(target, place, (k) => `${p.name[index[k]]}: ${number(low[k])} … ${number(high[k])}`);
    return target.root;
  });
  return figure('Ends of the simulated 95\u202f% intervals (dots) against those of the covariance (dashed).', drawing);
}

export function monteCarloSection(p: Parameters | undefined, figures: MonteCarlo | undefined): HTMLElement | undefined {
  if (!figures?.samples) return undefined;
  const part = section('monte-carlo', 'Uncertainty by Monte Carlo');
  const figureOf = (key: keyof MonteCarlo, digits: number) =>
    html('b', {'data-key': `monte_carlo.${key}`}, digits ? number(figures[key] as number, digits) : count(figures[key] as number));
  const words = html('p', {class: 'lead monte-carlo-words'});
  words.append(figureOf('samples', 0), ' simulated campaigns, each identified again. ');
  if (figures.smallest_uncertainty_ratio !== undefined && figures.largest_uncertainty_ratio !== undefined)
    words.append('Their standard uncertainties are ', figureOf('smallest_uncertainty_ratio', 3), ' to ', figureOf('largest_uncertainty_ratio', 3), ' times those of the covariance');
  if (figures.chance_ratio_low !== undefined && figures.chance_ratio_high !== undefined)
    words.append('; by chance alone ', figureOf('chance_ratio_low', 3), ' to ', figureOf('chance_ratio_high', 3), ' would be expected');
  words.append('. ');
  if (figures.largest_shift !== undefined && figures.chance_shift !== undefined)
    words.append('The simulated means lie within ', figureOf('largest_shift', 3), ' standard uncertainties of the estimates (by chance up to ', figureOf('chance_shift', 3), '). ');
  if (figures.agrees !== undefined) {
    const verdict = html('strong', {class: figures.agrees ? 'agrees' : 'differs'});
    if (figures.agrees) verdict.append('The simulation confirms the uncertainties of the covariance.');
    else if (figures.beyond_chance !== undefined)
      verdict.append('The simulation differs from the covariance by more than chance for ', figureOf('beyond_chance', 0), figures.compared !== undefined ? ' of ' : '',
        figures.compared !== undefined ? figureOf('compared', 0) : '', ' parameters: the larger of the two is the safer one.');
    else verdict.append('The simulation differs from the covariance by more than chance.');
    words.append(verdict);
  }
  part.append(words);
  const index = (p?.name ?? []).map((_, i) => i).filter((i) => p!.monte_carlo_ratio?.[i] !== null && p!.monte_carlo_ratio?.[i] !== undefined);
  if (p && index.length) {
    const drawn = [ratios(p, figures, index), intervals(p, index)].filter((f): f is HTMLElement => Boolean(f));
    part.append(html('div', {class: 'columns'}, ...drawn), html('p', {class: 'note'}, 'Both uncertainties and their ratio stand in the table of parameters.'));
  }
  return part;
}
