// A compensation before and after: how the errors at unseen poses lie, and what is left on test pieces.

import {html, figure, responsive, section, svg} from './dom';
import {count, number, prose, quantity} from './format';
import {line, plot, rule} from './plot';
import {extent, roundFactor} from './scale';
import {CompensationDistribution, PieceEdge, VerificationBlock, VerifiedPiece} from './verification_data';

function at(distribution: CompensationDistribution, values: number[], percent: number): number {
  // Between two shares the error is on a straight line, so that it is that of the figures of all poses.
  const after = distribution.percent.findIndex((p) => p >= percent);
  if (after <= 0) return values[after === 0 ? 0 : values.length - 1];
  const [low, high] = [distribution.percent[after - 1], distribution.percent[after]];
  const part = high > low ? Math.min(1, Math.max(0, (percent - low) / (high - low))) : 0;
  return values[after - 1] + part * (values[after] - values[after - 1]);
}

function cumulative(data: CompensationDistribution): HTMLElement {
  const box = html('div', {class: 'drawing'});
  const sets = [
    {name: 'before', style: 'before', values: data.before_um},
    {name: 'after', style: 'after', values: data.after_um},
    ...(data.predicted_um ? [{name: 'after, as predicted', style: 'predicted', values: data.predicted_um}] : []),
  ];
  const positive = sets.flatMap((set) => set.values).filter((value) => value > 0);
  const [low, high] = extent(positive);
  responsive(box, (width) => {
    const target = plot({
      width, height: 320,
      x: {label: 'volumetric error / µm', range: [low * 0.85, high * 1.15], log: true},
      y: {label: 'poses with a smaller error / %', range: [0, 100]},
      description: sets.map((set) => `${set.name}: half of the poses below ${quantity(at(data, set.values, 50), 'µm')}, 95 percent below ${quantity(at(data, set.values, 95), 'µm')}`).join('; '),
    });
    for (const set of [...sets].reverse()) line(target, set.values.map((v) => (v > 0 ? v : null)), data.percent, `of-${set.style}`);
    sets.filter((set) => set.style !== 'predicted').forEach((set, i) => rule(target, at(data, set.values, 50), 'x', set.style, `${set.name}, median ${quantity(at(data, set.values, 50), 'µm')}`, i, true));
    return target.root;
  });
  return box;
}

function key(entries: [style: string, text: string][]): HTMLElement {
  return html('p', {class: 'legend'}, ...entries.map(([style, text]) => html('span', {}, html('i', {class: `stroke ${style}`, 'aria-hidden': 'true'}), text)));
}

const round = (v: number) => Math.round(v * 100) / 100;

function ranges(edge: PieceEdge): [number, number] {
  const drawn = (values: number[]) => extent(values)[1] - extent(values)[0];
  return [edge.range_before_um ?? drawn(edge.before_um), edge.range_after_um ?? drawn(edge.after_um)];
}

/// The edge with its deviations magnified, before and after over one another.
function outline(edge: PieceEdge, closed: boolean, name: string, largest: number): HTMLElement {
  const box = html('div', {class: 'drawing'});
  const [lowX, highX] = extent(edge.x_mm);
  const [lowY, highY] = extent(edge.y_mm);
  responsive(box, (width) => {
    const margin = Math.min(56, width / 7);
    const foot = 40;
    const span = [Math.max(highX - lowX, 1e-9), Math.max(highY - lowY, 1e-9)];
    const scale = Math.min((width - 2 * margin) / span[0], 330 / span[1]);
    const height = Math.round(span[1] * scale + 2 * margin + foot);
    const left = (width - span[0] * scale) / 2;
    const pixels = (0.72 * margin) / Math.max(largest, 1e-9);  // per µm
    const place = (i: number, um: number) =>
      `${round(left + (edge.x_mm[i] - lowX) * scale + edge.out_x[i] * um * pixels)} ${round(margin + (highY - edge.y_mm[i]) * scale - edge.out_y[i] * um * pixels)}`;
    const path = (values?: number[]) => `M${edge.x_mm.map((_, i) => place(i, values?.[i] ?? 0)).join('L')}${closed ? 'Z' : ''}`;
    const band = (values: number[]) => {
      const forth = edge.x_mm.map((_, i) => place(i, values[i]));
      const back = edge.x_mm.map((_, i) => place(i, 0)).reverse();
      return `M${forth.join('L')}L${back.join('L')}Z`;
    };
    const root = svg('svg', {viewBox: `0 0 ${width} ${height}`, width, height, class: 'piece-drawing', role: 'img',
      'aria-label': `${name}, ${edge.name}: deviation before within ${quantity(ranges(edge)[0], 'µm')}, after within ${quantity(ranges(edge)[1], 'µm')}`});
    root.append(
      svg('path', {d: band(edge.before_um), class: 'left of-before'}),
      svg('path', {d: path(), class: 'outline'}),
      svg('path', {d: path(edge.before_um), class: 'line of-before'}),
      svg('path', {d: path(edge.after_um), class: 'line of-after'}),
    );
    const bar = (x: number, length: number, text: string) => {
      const y = height - 24;
      root.append(svg('path', {d: `M${round(x)} ${y - 4}v8M${round(x)} ${y}h${round(length)}M${round(x + length)} ${y - 4}v8`, class: 'scale-bar'}),
        svg('text', {x: round(x), y: y + 17, class: 'tick'}, text));
    };
    const length = roundFactor(Math.min(110, width / 4) / scale);
    bar(8, length * scale, quantity(length, 'mm'));
    const amount = roundFactor(Math.max(largest, 1e-9));
    bar(width / 2, amount * pixels, `deviation ${quantity(amount, 'µm')}`);
    return root;
  });
  return box;
}

function along(edge: PieceEdge, range: [number, number], name: string): HTMLElement {
  const box = html('div', {class: 'drawing'});
  responsive(box, (width) => {
    const target = plot({width, height: 190, x: {label: 'along the cut / mm', range: extent(edge.s_mm)}, y: {label: 'deviation / µm', range, nice: true}, zeroLine: true, compact: true,
      description: `${name}, ${edge.name}: deviation along the cut before and after`});
    line(target, edge.s_mm, edge.before_um, 'of-before');
    line(target, edge.s_mm, edge.after_um, 'of-after');
    return target.root;
  });
  return box;
}

function figuresTable(piece: VerifiedPiece): HTMLElement | undefined {
  if (!piece.figures?.length) return undefined;
  return html('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': `Figures of the ${piece.name}`}, html('table', {class: 'piece-figures'},
    html('caption', {class: 'unseen'}, `Figures of the ${piece.name}`),
    html('thead', {}, html('tr', {}, html('th', {scope: 'col'}, 'Figure'), ...['Before / µm', 'After / µm', 'Times smaller'].map((name) => html('th', {scope: 'col', class: 'number'}, name)))),
    html('tbody', {}, ...piece.figures.map((one) => html('tr', {}, html('th', {scope: 'row'}, one.name),
      html('td', {class: 'number'}, number(one.before_um)), html('td', {class: 'number'}, number(one.after_um)),
      html('td', {class: 'number'}, one.after_um > 0 ? number(one.before_um / one.after_um, 2) : '\u2013'))))));
}

function pieceSection(piece: VerifiedPiece, index: number): HTMLElement {
  const part = section(`piece-${index}`, piece.name, piece.description && `${piece.description}. Deviations are magnified; the best fit of the workpiece is taken out.`);
  part.dataset.short = piece.name;
  const [low, high] = extent(piece.edges.flatMap((edge) => [...edge.before_um, ...edge.after_um]));
  const largest = Math.max(Math.abs(low), Math.abs(high));
  part.append(key([['of-before', 'before'], ['of-after', 'after'], ['nominal', 'wanted']]),
    html('div', {class: 'columns'}, ...piece.edges.map((edge) => {
      const [b, a] = ranges(edge);
      return figure(`At the ${edge.name}: within ${quantity(b, 'µm')} before, ${quantity(a, 'µm')} after.`,
        outline(edge, piece.closed ?? false, piece.name, largest), along(edge, [Math.min(low, 0), Math.max(high, 0)], piece.name));
    })));
  const table = figuresTable(piece);
  if (table) part.append(table);
  return part;
}

export function verificationSections(block: VerificationBlock | undefined): HTMLElement[] {
  if (!block) return [];
  const sections: HTMLElement[] = [];
  if (block.distribution?.percent?.length) {
    const part = section('unseen', 'Errors at unseen poses');
    const data = block.distribution;
    part.append(key([['of-before', 'before'], ['of-after', 'after'], ...(data.predicted_um ? [['of-predicted', 'after, as its uncertainty predicts'] as [string, string]] : [])]),
      figure(`${block.poses ? `${count(block.poses)} random poses: ` : ''}95\u202f% of them below ${quantity(at(data, data.before_um, 95), 'µm')} before and ${quantity(at(data, data.after_um, 95), 'µm')} after` +
        `${data.predicted_um ? `; predicted: ${quantity(at(data, data.predicted_um, 95), 'µm')}` : ''}. Logarithmic axis.`, cumulative(data)));
    if (block.wanted?.length) part.append(html('ul', {class: 'plain'}, ...block.wanted.map((one) => html('li', {class: one.met ? 'agrees' : 'exceeded'}, prose(one.text)))));
    sections.push(part);
  }
  (block.pieces ?? []).forEach((piece, i) => sections.push(pieceSection(piece, i)));
  return sections;
}
