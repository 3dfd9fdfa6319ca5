// Axes of drawings: from numbers to pixels, and the numbers worth writing.

import {fixed, grouped, superscript} from './format';

export interface Scale {
  (value: number): number;
  ticks: number[];
  label: (value: number) => string;
  from: number;
  to: number;
}

export function extent(values: Iterable<number | null | undefined>): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value === null || value === undefined || !Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : [0, 1];
}

function niceStep(span: number, wanted: number): number {
  const raw = span / Math.max(1, wanted);
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  for (const factor of [1, 2, 5, 10]) if (raw <= factor * power * 1.0001) return factor * power;
  return 10 * power;
}

/// 1, 2, 5, 10, ... nearest below.
export function roundFactor(value: number): number {
  const power = Math.pow(10, Math.floor(Math.log10(value)));
  return (value / power >= 5 ? 5 : value / power >= 2 ? 2 : 1) * power;
}

export function niceTicks(from: number, to: number, wanted: number): number[] {
  const step = niceStep(to - from, wanted);
  // Too close to tell apart in double precision, or not numbers at all.
  if (!(to > from) || !(step > 0) || from + step / 4 === from || to + step / 4 === to) return [from];
  const ticks: number[] = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + step * 1e-9; ++k) ticks.push(k * step);
  return ticks;
}

/// Full turns divide by 30, 45, 60, 90, not by 100.
function angleTicks(from: number, to: number, wanted: number): number[] {
  const span = to - from;
  for (const step of [1, 2, 5, 10, 15, 30, 45, 60, 90, 120, 180, 360]) {
    if (span / step > wanted + 0.5) continue;
    const ticks: number[] = [];
    for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; ++k) ticks.push(k * step);
    return ticks;
  }
  return [from, to];
}

function plain(step: number): (value: number) => string {
  const decimals = Math.min(8, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  return (value) => fixed(value, decimals);
}

export function linearScale(
  [from, to]: [number, number],
  [start, end]: [number, number],
  wanted: number,
  options: {nice?: boolean; angle?: boolean} = {},
): Scale {
  if (from === to) [from, to] = from === 0 ? [-1, 1] : [from - Math.abs(from) * 0.1, to + Math.abs(to) * 0.1];
  if (options.nice) {
    const step = niceStep(to - from, wanted);
    from = Math.floor(from / step + 1e-9) * step;
    to = Math.ceil(to / step - 1e-9) * step;
  }
  const scale = ((value: number) => start + ((value - from) / (to - from)) * (end - start)) as Scale;
  scale.ticks = options.angle && to - from >= 20 ? angleTicks(from, to, wanted) : niceTicks(from, to, wanted);
  scale.label = plain(scale.ticks.length > 1 ? scale.ticks[1] - scale.ticks[0] : to - from || 1);
  scale.from = from;
  scale.to = to;
  return scale;
}

export function logScale([from, to]: [number, number], [start, end]: [number, number], wanted: number): Scale {
  if (!(to > 0) || !Number.isFinite(to)) to = 1;
  if (!(from > 0)) from = to / 10;
  const low = Math.log10(from);
  const high = Math.log10(to > from ? to : from * 10);
  const scale = ((value: number) => start + ((Math.log10(value) - low) / (high - low)) * (end - start)) as Scale;
  const decades = high - low;
  const every = Math.max(1, Math.ceil(decades / Math.max(1, wanted)));
  const factors = decades < 1.2 ? [1, 2, 3, 5] : decades < wanted / 2.5 ? [1, 2, 5] : [1];
  scale.ticks = [];
  for (let k = Math.floor(low); k <= high + 1e-9; ++k) {
    if (factors.length === 1 && k % every !== 0) continue;
    for (const factor of factors) {
      const tick = factor * Math.pow(10, k);
      if (Math.log10(tick) >= low - 1e-9 && Math.log10(tick) <= high + 1e-9) scale.ticks.push(tick);
    }
  }
  const small = low >= -3.01 && high <= 5;
  scale.label = (value) => {
    if (small) return grouped(String(Number(value.toPrecision(3))));
    // A tick a hair below its power of ten belongs to it; 5e5 does not belong to 1e6.
    const exponent = Math.floor(Math.log10(value) + 1e-9);
    const mantissa = Math.round(value / Math.pow(10, exponent));
    return mantissa === 1 ? `10${superscript(exponent)}` : factors.length > 3 ? `${mantissa}\u202f·\u202f10${superscript(exponent)}` : '';
  };
  scale.from = from;
  scale.to = to;
  return scale;
}
