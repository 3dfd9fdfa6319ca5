// Colours of signed values: blue below zero, light grey at zero, red above, both ends equally dark; blue and red are told apart with
// any colour vision. Beyond the limits a light cyan and a light yellow, which nothing within them has.

import {Rgb} from './colour';

const kBelow: Rgb = [33 / 255, 102 / 255, 172 / 255];
const kZero: Rgb = [225 / 255, 225 / 255, 225 / 255];
const kAbove: Rgb = [178 / 255, 24 / 255, 43 / 255];
export const kBeyondBelow: Rgb = [0, 214 / 255, 1];
export const kBeyondAbove: Rgb = [1, 200 / 255, 0];
/// Where there is no value: darker than zero, without a hue.
export const kNothing: Rgb = [0.52, 0.54, 0.56];

export function divergingColour(value: number, limit: number): Rgb {
  if (Number.isNaN(value)) return kNothing;
  if (value > limit) return kBeyondAbove;
  if (value < -limit) return kBeyondBelow;
  const share = Math.abs(value) / limit;
  const end = value < 0 ? kBelow : kAbove;
  return [0, 1, 2].map((k) => kZero[k] + share * (end[k] - kZero[k])) as Rgb;
}
