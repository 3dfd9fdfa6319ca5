// One sequential colour scale, even in perceived lightness, computed in OKLCH (B. Ottosson, 2020).
//
// Small errors recede towards the background, large ones stand out, so lightness runs the other way in the dark theme.

/// Red, green, blue, each 0..1.
export type Rgb = [number, number, number];

function srgbFromOklch(lightness: number, chroma: number, hueDegrees: number): Rgb {
  const hue = (hueDegrees * Math.PI) / 180;
  const a = chroma * Math.cos(hue);
  const b = chroma * Math.sin(hue);
  const l = Math.pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const m = Math.pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const s = Math.pow(lightness - 0.0894841775 * a - 1.291485548 * b, 3);
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((v) => {
    const c = Math.min(1, Math.max(0, v));
    return c <= 0.0031308 ? 12.92 * c : 1.055 * Math.pow(c, 1 / 2.4) - 0.055;
  }) as Rgb;
}

/// Colour of a fraction 0..1 as sRGB, each 0..1.
export function rampColour(fraction: number, dark: boolean): Rgb {
  const t = Math.min(1, Math.max(0, fraction));
  const chroma = 0.1 + 0.08 * Math.sin(Math.PI * t);
  return dark
    ? srgbFromOklch(0.44 + 0.46 * t, chroma * 0.95, 285 - 185 * t)
    : srgbFromOklch(0.83 - 0.5 * t, chroma, 130 + 165 * t);
}

export function cssColour(rgb: Rgb): string {
  return `rgb(${rgb.map((v) => Math.round(v * 255)).join(' ')})`;
}

export function isDark(): boolean {
  return document.documentElement.dataset.theme === 'dark';
}
