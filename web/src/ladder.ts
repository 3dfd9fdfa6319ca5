// Factors of exaggeration: none, then 1, 2, 5, 10, ... about one that suits the drawing.

import {roundFactor} from './scale';

export interface Ladder {
  factors: number[];
  /// Index of the factor that suits.
  start: number;
}

/// @param typical  factor with which a typical deviation is well seen
export function ladder(typical: number): Ladder {
  const factors = [0];
  let start = 1;
  const suits = roundFactor(typical);
  for (let power = Math.floor(Math.log10(suits)) - 2; power <= Math.log10(suits) + 1; ++power)
    for (const step of [1, 2, 5]) {
      const factor = step * 10 ** power;
      if (factor > 20 * suits) continue;
      if (Math.abs(factor / suits - 1) < 1e-6) start = factors.length;
      factors.push(Number(factor.toPrecision(3)));
    }
  return {factors, start};
}
