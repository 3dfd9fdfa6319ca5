// Numbers as a metrologist writes them.

const kThin = '\u202f';
const kMinus = '\u2212';

/// `digits` significant digits, thousands apart, a real minus sign; powers of ten outside 1e-3 .. 1e6.
export function number(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '\u2013';
  if (value === 0) return '0';
  const size = Math.abs(value);
  let text: string;
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${mantissa.replace('-', kMinus)}${kThin}·${kThin}10${superscript(Number(exponent))}`;
  }
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Number(size.toPrecision(digits)))));
  text = size.toFixed(decimals);
  return (value < 0 ? kMinus : '') + grouped(text);
}

export function count(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '\u2013';
  return (value < 0 ? kMinus : '') + grouped(String(Math.round(Math.abs(value))));
}

/// With a number of decimals; what rounds to zero has no sign.
export function fixed(value: number, decimals: number): string {
  const text = Math.abs(value).toFixed(decimals);
  return (value < 0 && Number(text) !== 0 ? kMinus : '') + grouped(text);
}

/// Thousands apart from five digits on.
export function grouped(text: string): string {
  const [whole, fraction] = text.split('.');
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, '\u202f') : whole;
  return fraction === undefined ? grouped : `${grouped}.${fraction}`;
}

export function superscript(exponent: number): string {
  const digits = '⁰¹²³⁴⁵⁶⁷⁸⁹';
  return (exponent < 0 ? '⁻' : '') + [...String(Math.abs(exponent))].map((d) => digits[Number(d)]).join('');
}

/// Value and standard uncertainty with matching decimals, two digits of the uncertainty (GUM 7.2.6).
export function withUncertainty(value: number | null, uncertainty: number | null | undefined): [string, string] {
  if (value === null || value === undefined) return ['\u2013', number(uncertainty, 2)];
  if (!uncertainty) return [number(value, 4), '\u2013'];
  const decimals = 1 - Math.floor(Math.log10(uncertainty));
  if (decimals > 6 || decimals < -4) return [number(value, 4), number(uncertainty, 2)];
  const places = Math.max(0, decimals);
  return [fixed(value, places), fixed(uncertainty, places)];
}

/// Value with unit; the degree sign stands close.
export function quantity(value: number | null | undefined, unit: string, digits = 3): string {
  return number(value, digits) + (unit === '°' || !unit ? unit : `${kThin}${unit}`);
}

/// A number as it was given: up to six digits, no trailing zeros.
export function plain(value: number): string {
  return (value < 0 ? kMinus : '') + grouped(String(Number(Math.abs(value).toPrecision(6))));
}

/// With the decimals of another number as it was printed.
export function alike(value: number | null | undefined, printed: string): string {
  if (value === null || value === undefined) return '\u2013';
  const decimals = printed.includes('·') || !/\d/.test(printed) ? -1 : (printed.split('.')[1] ?? '').length;
  if (decimals < 0) return number(value, 4);
  return fixed(value, decimals);
}

/// Text of a producer, who writes without Greek letters and signs, as people print it: 18.3 um becomes 18.3 µm, 9 x 9 becomes 9 × 9,
/// 11^6 becomes 11⁶, 5e-11 becomes 5 · 10⁻¹¹, -460 has a minus sign, and lengths and angles of five digits are grouped.
export function prose(text: string): string {
  return text
    .replace(/(\d) u(m|rad)\b/g, '$1\u202fµ$2')
    .replace(/\bin u(m|rad)\b/g, 'in µ$1')
    .replace(/(?<![\w.])(\d+(?:\.\d+)?)e([-+]?\d+)(?!\w)/g, (_, mantissa, power) => `${mantissa}${kThin}·${kThin}10${superscript(Number(power))}`)
    .replace(/(\d) x (?=\d)/g, '$1 × ')
    .replace(/(^|[\s(,])-(?=\d)/g, `$1${kMinus}`)
    .replace(/(\d)\^(\d+)/g, (_, base, power) => base + superscript(Number(power)))
    .replace(/(?<![\w.])\d{5,}(?=(?:\.\d+)?[\u202f ](?:µm|µrad|mm)\b)/g, grouped);
}
