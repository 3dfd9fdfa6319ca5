// Deviations in words.

import {grouped} from './format';
import {Surface} from './surface_data';

/// "+12.35 µm", with the decimals that the data have; "beyond" where the data end.
export function signed(value: number, surface: Surface): string {
  if (Number.isNaN(value)) return 'fewer than 3 points near';
  const decimals = Math.min(6, Math.max(0, -Math.floor(Math.log10(surface.step * 1.5))));
  const text = Math.abs(value).toFixed(decimals);
  const sign = Number(text) === 0 ? '' : value < 0 ? '\u2212' : '+';
  const beyond = Math.abs(value) >= 32766.5 * surface.step ? 'beyond ' : '';
  return `${beyond}${sign}${grouped(text)}\u202fµm`;
}
