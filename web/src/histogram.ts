// Distributions before and after, on one logarithmic axis so that both can be read.

import {ErrorMap, Histogram, Statistics, Summary, Vectors} from './data';
import {figure, html, isPrinting, responsive, section, svg} from './dom';
import {count, prose, quantity} from './format';
import {plot, Plot, rule} from './plot';
import {statisticsTable} from './statistics';

interface Distribution {
  edges: number[];
  share: number[];
  median: number;
  p95: number;
  total: number;
}

export function lengths(v: Vectors): number[] {
  return v.x.map((x, i) => Math.hypot(x, v.y[i], v.z[i]));
}

export function fromValues(values: number[], edges: number[]): Distribution {
  const counts = new Array<number>(edges.length - 1).fill(0);
  const low = Math.log(edges[0]);
  const step = Math.log(edges[1]) - low;
  for (const value of values) {
    const bin = Math.floor((Math.log(Math.max(value, edges[0])) - low) / step);
    counts[Math.min(counts.length - 1, Math.max(0, bin))] += 1;
  }
  const sorted = [...values].sort((a, b) => a - b);
  // As the tables of the summary: linear between order statistics.
  const at = (q: number) => {
    const place = q * (sorted.length - 1);
    const below = Math.floor(place);
    return sorted[below] + (place - below) * (sorted[Math.min(below + 1, sorted.length - 1)] - sorted[below]);
  };
  return {edges, share: counts.map((c) => (100 * c) / values.length), median: at(0.5), p95: at(0.95), total: values.length};
}

/// Counted data come with their own linear bins; quantiles are linear within them, and at their ends where they lie outside.
export function fromCounts(edges: number[], counts: number[], below = 0, above = 0): Distribution {
  const total = counts.reduce((a, b) => a + b, below + above);
  const quantile = (q: number) => {
    let sum = below;
    if (sum >= q * total && below) return edges[0];
    for (let i = 0; i < counts.length; ++i) {
      if (sum + counts[i] >= q * total) return edges[i] + ((q * total - sum) / Math.max(1, counts[i])) * (edges[i + 1] - edges[i]);
      sum += counts[i];
    }
    return edges[edges.length - 1];
  };
  return {edges, share: counts.map((c) => (100 * c) / total), median: quantile(0.5), p95: quantile(0.95), total};
}

function bars(target: Plot, distribution: Distribution, style: string): void {
  const zero = target.y(0);
  let path = '';
  distribution.share.forEach((share, i) => {
    const left = target.x(distribution.edges[i]);
    const right = target.x(distribution.edges[i + 1]);
    if (!(share > 0) || !Number.isFinite(left)) return;
    const gap = right - left > 4 ? 0.75 : 0;
    path += `M${left + gap} ${zero}V${target.y(share)}H${right - gap}V${zero}Z`;
  });
  target.layer.append(svg('path', {d: path, class: `bars ${style}`}));
}

function drawing(unit: string, sets: {style: string; name: string; data: Distribution}[], log: boolean, quantityName: string, of: string): HTMLElement {
  const box = html('div', {class: 'drawing'});
  const from = Math.min(...sets.map((set) => set.data.edges[0]));
  const to = Math.max(...sets.map((set) => set.data.edges[set.data.edges.length - 1]));
  const highest = Math.max(...sets.flatMap((set) => set.data.share));
  responsive(box, (width) => {
    const target = plot({
      width,
      height: isPrinting() ? 200 : 250,
      x: {label: `${quantityName} / ${unit}`, range: [from, to], log},
      y: {label: `share of the ${of} / %`, range: [0, highest * 1.22], nice: false},
      description: sets.map((set) => `${set.name && `${set.name}: `}median ${quantity(set.data.median, unit)}, 95 percent below ${quantity(set.data.p95, unit)}`).join('; '),
    });
    sets.forEach((set, i) => {
      bars(target, set.data, set.style);
      rule(target, set.data.median, 'x', set.style, `${set.name && `${set.name}, `}median ${quantity(set.data.median, unit)}`, i);
    });
    return target.root;
  });
  return box;
}

function logEdges(values: number[]): number[] {
  const positive = values.filter((value) => value > 0).sort((a, b) => a - b);
  if (!positive.length) return [0.1, 1];
  const from = Math.pow(10, Math.floor(Math.log10(positive[Math.floor(positive.length * 0.005)]) * 4) / 4);
  const to = Math.pow(10, Math.ceil(Math.log10(positive[positive.length - 1]) * 4) / 4);
  const bins = Math.max(12, Math.round(Math.log10(to / from) * 18));
  return Array.from({length: bins + 1}, (_, i) => from * Math.pow(to / from, i / bins));
}

/// Counts of one signed quantity, with how many lie outside of the classes.
function signedCounts(entry: Histogram, edges: number[], unit: string): HTMLElement | undefined {
  const counts = entry.counts as number[];
  const inside = counts.reduce((a, b) => a + b, 0);
  if (!inside) return undefined;
  const below = Number(entry.below) || 0;
  const above = Number(entry.above) || 0;
  const all = inside + below + above;
  const of = typeof entry.of === 'string' ? entry.of : 'values';
  const data = fromCounts(edges, counts, below, above);
  const caption = `${prose(entry.title ?? 'Distribution')} of ${count(all)} ${of}.${all > inside ? ` ${count(below)} lie below and ${count(above)} above the classes.` : ''}`;
  return figure(caption, drawing(unit, [{style: 'after', name: '', data}], false, typeof entry.quantity === 'string' ? entry.quantity : 'value', of));
}

function one(entry: Histogram): HTMLElement | undefined {
  for (const [suffix, unit] of [['um', 'µm'], ['urad', 'µrad']]) {
    const before = entry[`before_${suffix}`] as number[] | undefined;
    const after = entry[`after_${suffix}`] as number[] | undefined;
    const edges = entry[`edges_${suffix}`] as number[] | undefined;
    const sets: {style: string; name: string; data: Distribution}[] = [];
    let log = true;
    if (before) {
      const common = logEdges([...before, ...(after ?? [])]);
      sets.push({style: 'before', name: after ? 'before' : 'as it is', data: fromValues(before, common)});
      if (after) sets.push({style: 'after', name: 'after', data: fromValues(after, common)});
    } else if (edges) {
      log = edges[0] > 0;
      const beforeCounts = entry.before_counts as number[] | undefined;
      const afterCounts = entry.after_counts as number[] | undefined;
      if (beforeCounts) sets.push({style: 'before', name: afterCounts ? 'before' : 'as it is', data: fromCounts(edges, beforeCounts)});
      if (afterCounts) sets.push({style: 'after', name: 'after', data: fromCounts(edges, afterCounts)});
    }
    // Percentiles of all poses, where the drawing has some of them or counts.
    for (const set of sets) {
      const exact = entry[`${set.style}_percentiles_${suffix}`] as Statistics | undefined;
      if (exact?.median !== undefined) set.data.median = exact.median;
      if (exact?.p95 !== undefined) set.data.p95 = exact.p95;
    }
    if (edges && entry.counts) return signedCounts(entry, edges, unit);
    if (!sets.length || sets.some((set) => set.data.total === 0)) continue;
    const of = typeof entry.of === 'string' ? entry.of : 'poses';
    const caption = `${prose(entry.title ?? 'Distribution')}. ${sets
      .map((set) => `${set.name[0].toUpperCase()}${set.name.slice(1)}: 95\u202f% of ${count(set.data.total)} ${of} below ${quantity(set.data.p95, unit)}`)
      .join('. ')}.${log ? ' Logarithmic axis.' : ''}`;
    return figure(caption, drawing(unit, sets, log, typeof entry.quantity === 'string' ? entry.quantity : suffix === 'um' ? 'volumetric error' : 'orientation error', of));
  }
  return undefined;
}

export function histogramSection(entries: Histogram[] | undefined, map: ErrorMap | undefined, summary: Summary | undefined): HTMLElement | undefined {
  let list = entries ?? [];
  if (!list.length && map)
    list = [{quantity: map.quantity && `length of the ${map.quantity}`, title: `${map.quantity ? `Length of the ${map.quantity}` : 'Volumetric error'} at the points of the map`, before_um: lengths(map.before_um), after_um: map.after_um && lengths(map.after_um),
      before_percentiles_um: summary?.map?.position_before_um, after_percentiles_um: summary?.map?.position_after_um}];
  const figures = list.map(one).filter((f): f is HTMLElement => f !== undefined);
  const table = summary && statisticsTable(summary);
  if (!figures.length && !table) return undefined;
  const part = section('distribution', list.some((entry) => entry.counts) ? 'Distribution' : 'Distribution of the error');
  if (figures.length) part.append(html('div', {class: figures.length > 1 ? 'columns' : ''}, ...figures));
  if (table) part.append(table);
  return part;
}
