// Pages of scans: figures of the evaluation, deviations on the part, sections. What the page shows is compared with the data, unpacked
// and cut here once more.
import {settled, until} from './until.mjs';

const bytes = (text) => Buffer.from(text, 'base64');
export const unpackedBytes = (text) => [...bytes(text)];
const words = (text, read, size) => {
  const raw = bytes(text);
  return Array.from({length: raw.length / size}, (_, i) => raw[read](size * i));
};

export function unpacked(block) {
  const places = (text) => words(text, 'readUInt16LE', 2).map((n, i) => block.lower_mm[i % 3] + n * block.step_mm);
  const values = (text) => words(text, 'readInt16LE', 2).map((n) => (n === -32768 ? NaN : n * block.value_step_um));
  const [read, size] = block.vertex_count > 65536 ? ['readUInt32LE', 4] : ['readUInt16LE', 2];
  return {vertices: places(block.vertices), triangles: words(block.triangles, read, size), values: block.values && values(block.values),
    feet: block.points && places(block.points.foot), readings: block.points && values(block.points.values)};
}

/// For each canvas, after its next frame: how many pixels are drawn and coloured, and a sum that changes with what is drawn.
/// @param least  difference between the channels of what counts as coloured
export const inksOf = (page, selector, least = 30) => page.evaluate(async ([selector, least]) => {
  await window.settled();
  return [...document.querySelectorAll(selector)].map((canvas) => {
    const flat = document.createElement('canvas');
    [flat.width, flat.height] = [canvas.width, canvas.height];
    // Read at once, so that it is kept where it is read.
    const context = flat.getContext('2d', {willReadFrequently: true});
    context.drawImage(canvas, 0, 0);
    const pixels = context.getImageData(0, 0, flat.width, flat.height).data;
    let [coloured, drawn, sum] = [0, 0, 0];
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] > 40) ++drawn;
      if (pixels[i + 3] > 40 && Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) - Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > least) ++coloured;
      sum = (sum + (i + 1) * (pixels[i] + 2 * pixels[i + 1] + 3 * pixels[i + 2])) % 1000000007;
    }
    return {coloured, drawn, sum};
  });
}, [selector, least]);
export const inkOf = async (page, selector) => (await inksOf(page, selector))[0];

async function figuresOf(page, evaluation, expect, parse) {
  const shown = new Map(await page.$$eval('#figures [data-figure]', (all) => all.map((e) => [e.dataset.figure, e.textContent])));
  for (const figure of evaluation.figures ?? []) {
    const key = Object.keys(figure).find((name) => name === 'value' || name.startsWith('value_'));
    if (!key) {
      expect(!shown.has(figure.symbol), `${figure.symbol} has no value, the page says ${shown.get(figure.symbol)}`);
      continue;
    }
    const off = Math.abs(parse(shown.get(figure.symbol) ?? 'none') - figure[key]);
    expect(off <= 0.5001 * 10 ** -figure.decimals, `${figure.symbol}: page says ${shown.get(figure.symbol)}, data ${figure[key]}`);
  }
  const uncertainties = await page.$$eval('#figures td.uncertainty', (all) => all.map((e) => e.textContent));
  for (const [i, figure] of (evaluation.figures ?? []).entries()) {
    const key = Object.keys(figure).find((name) => name.startsWith('expanded_uncertainty'));
    expect(!key || figure[key] !== 0 || uncertainties[i] === '', `${figure.symbol}: no uncertainty is written as ${uncertainties[i]}`);
  }
  const facts = await page.$$eval('.overview .facts dd', (all) => all.map((e) => e.textContent));
  for (const fact of evaluation.facts ?? []) expect(facts.includes(fact.text), `the fact ${fact.name} is not on the page`);
}

/// "+12.5 µm at (1, 2, 3) mm, ..."
const readingOf = (text, parse) => {
  const match = text.match(/^(?:beyond )?([+\u2212]?[\d.\u202f]+)\u202fµm at \(([^)]*)\)\u202fmm/);
  return match && {value: parse(match[1].replace('+', '')), at: match[2].split(', ').map(parse)};
};

/// How far a place is from the nearest triangle that it lies over, mm.
function awayFromPart(data, at) {
  let least = Infinity;
  for (let t = 0; t < data.triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => data.vertices.slice(3 * data.triangles[t + k], 3 * data.triangles[t + k] + 3));
    const minus = (p, q) => p.map((v, k) => v - q[k]);
    const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    const normal = cross(minus(b, a), minus(c, a));
    const length = Math.hypot(...normal);
    const inside = [[a, b], [b, c], [c, a]].every(([from, to]) => dot(normal, cross(minus(to, from), minus(at, from))) >= -1e-3 * length * length);
    if (length > 0 && inside) least = Math.min(least, Math.abs(dot(normal, minus(at, a))) / length);
  }
  return least;
}

/// Moves the pointer over the drawing until something is read.
async function sweep(page, selector, output, parse) {
  const box = await page.locator(selector).first().boundingBox();
  for (const [u, v] of [[0.5, 0.5], [0.45, 0.55], [0.55, 0.5], [0.4, 0.5], [0.5, 0.4], [0.6, 0.6], [0.35, 0.6], [0.5, 0.62], [0.3, 0.5], [0.65, 0.45]]) {
    await page.mouse.move(box.x + u * box.width, box.y + v * box.height);
    await settled(page);
    const reading = readingOf(await page.textContent(output), parse);
    if (reading) return reading;
  }
  return undefined;
}

async function surfaceOf(page, block, expect, shot, parse) {
  const data = unpacked(block);
  expect(data.vertices.length === 3 * block.vertex_count && data.triangles.length === 3 * block.triangle_count && data.values.length === block.vertex_count,
    'the surface has other counts than stated');
  expect(data.readings.length === block.points.drawn && data.feet.length === 3 * block.points.drawn, 'the points have other counts than stated');
  const note = await page.textContent('#surface');
  expect((block.points.drawn < block.points.counted) === note.includes('evenly chosen'), 'what was left out of the points is not said');
  expect(Boolean(block.thinned_cell_mm) === note.includes('became one'), 'what was thinned out of the part is not said');

  const canvas = '#surface .stage canvas';
  await page.locator('#surface').scrollIntoViewIfNeeded();
  await until(async () => (await inkOf(page, canvas)).drawn > 5000);
  const first = await inkOf(page, canvas);
  expect(first.drawn > 5000, `the part is drawn with ${first.drawn} pixels`);
  const near = (reading, places) => places.reduce((list, _, i) => {
    if (i % 3 === 0) list.push([Math.hypot(places[i] - reading.at[0], places[i + 1] - reading.at[1], places[i + 2] - reading.at[2]), i / 3]);
    return list;
  }, []).sort((a, b) => a[0] - b[0]);
  const decimals = 1.01 * block.value_step_um;

  const reading = await sweep(page, canvas, '#surface-reading', parse);
  expect(reading !== undefined || data.values.every(Number.isNaN), 'nothing is read on the surface');
  if (reading) {
    // Between the values of the vertices about that place.
    const about = near(reading, data.vertices).slice(0, 30).map(([, i]) => data.values[i]).filter((v) => !Number.isNaN(v));
    expect(reading.value >= Math.min(...about) - decimals && reading.value <= Math.max(...about) + decimals,
      `reading ${reading.value} at ${reading.at}, values there ${Math.min(...about)} to ${Math.max(...about)}`);
  }
  await shot(page.locator('#surface'), 'surface');

  await page.selectOption('#surface-shown', 'points');
  expect(await until(async () => (await inkOf(page, canvas)).sum !== first.sum), 'points look like the surface');
  const point = await sweep(page, canvas, '#surface-reading', parse);
  if (point) {
    const [away, index] = near(point, data.feet).find(([, i]) => Math.abs(data.readings[i] - point.value) <= decimals) ?? [Infinity, -1];
    expect(away < 5e-4 * block.step_mm * 65535, `the reading ${point.value} at ${point.at} is no point of the data (${index}, ${away} mm)`);
  }
  await shot(page.locator('#surface'), 'points');
  await page.selectOption('#surface-shown', 'surface');

  // Another limit colours other places, exaggeration moves them, and both can be undone.
  await until(async () => (await inkOf(page, canvas)).sum === first.sum);
  const change = async (selector, value, what, look) => {
    const old = await page.inputValue(selector);
    await page.fill(selector, String(value));
    expect(await until(async () => (await inkOf(page, canvas)).sum !== first.sum), `${what} changes nothing`);
    await shot(page.locator('#surface'), what);
    await look?.();
    await page.fill(selector, old);
    expect(await until(async () => (await inkOf(page, canvas)).sum === first.sum), `${what} cannot be undone`);
  };
  if (data.values.every(Number.isNaN)) return;
  await change('#surface-limit', Number((block.limit_um / 5).toPrecision(3)), 'limits');
  const ticks = await page.$$eval('#surface .colour-bar .tick', (all) => all.map((e) => e.textContent));
  expect(ticks.includes('below') && ticks.includes('above'), 'the colour scale does not show what lies beyond it');
  const last = await page.getAttribute('#surface-exaggeration', 'max');
  await change('#surface-exaggeration', Math.max(1, Number(last) - 6), 'exaggeration', async () => {
    const far = await sweep(page, canvas, '#surface-reading', parse);
    expect(far !== undefined, 'nothing is read on the exaggerated surface');
    if (far) expect(awayFromPart(data, far.at) < 2e-4 * block.step_mm * 65535, `under exaggeration the reading is at ${far.at}, which is not on the part`);
  });
}

const dotsOf = (page) => page.$eval('.section-drawing', (e) => ({scale: Number(e.dataset.scale),
  dots: ['below', 'above'].flatMap((side) => [...(e.querySelector(`.dots.${side}`).getAttribute('d') ?? '').matchAll(/M([-\d.]+) ([-\d.]+)/g)].map((m) => [Number(m[1]), Number(m[2])]))}));

/// Points are moved out by their deviation times the magnification, and the one under the pointer is read.
async function sectionReading(page, data, axis, expect, parse, step) {
  const steps = Number(await page.getAttribute('#section-factor', 'max'));
  const old = await page.inputValue('#section-factor');
  const at = async (value) => {
    await page.fill('#section-factor', String(value));
    await settled(page);
    const words = await page.textContent('label:has(#section-factor) output, output[for=section-factor]');
    return {factor: words === 'none' ? 0 : parse(words.replace('×', '')), ...await dotsOf(page)};
  };
  const [none, some] = [await at(0), await at(steps - 2)];
  expect(none.factor === 0 && some.factor > 0, `magnifications ${none.factor}, ${some.factor}`);
  const largest = Math.max(...data.readings.map(Math.abs));
  const moved = some.dots.map(([x, y], i) => Math.hypot(x - none.dots[i][0], y - none.dots[i][1]) / some.scale / some.factor * 1e3);
  const most = Math.max(...moved);
  expect(most <= largest * 1.01 + 0.02 / some.scale / some.factor * 1e3, `section across ${axis}: moved by ${most} um, the largest deviation is ${largest}`);
  await page.fill('#section-factor', old);
  await settled(page);
  const now = await dotsOf(page);
  const box = await page.locator('.section-drawing').boundingBox();
  const shownWidth = await page.$eval('.section-drawing', (e) => e.viewBox.baseVal.width);
  const [x, y] = now.dots[Math.floor(now.dots.length / 2)];
  await page.mouse.move(box.x + (x * box.width) / shownWidth, box.y + (y * box.width) / shownWidth);
  await settled(page);
  const read = readingOf(await page.textContent('#section-reading'), parse);
  expect(read !== null, `section across ${axis}: nothing is read at a point`);
  if (!read) return;
  const match = data.readings.some((value, i) => Math.abs(value - read.value) <= 1.01 * step &&
    [0, 1, 2].every((k) => Math.abs(data.feet[3 * i + k] - read.at[k]) <= 1e-5 * Math.abs(read.at[k]) + 1e-6));
  expect(match, `section across ${axis}: ${read.value} at ${read.at} is no point of the scan`);
}

async function sectionOf(page, block, expect, shot, parse) {
  const data = unpacked(block);
  await page.locator('#section').scrollIntoViewIfNeeded();
  for (const [k, axis] of ['x', 'y', 'z'].entries()) {
    await page.selectOption('#section-direction', axis);
    await settled(page);
    const words = await page.textContent('#section figcaption');
    const offset = parse(words.match(/ at ([^ ]*?)\u202fmm/)[1]);
    const drawn = await page.$eval('.section-drawing', (e) => ({scale: Number(e.dataset.scale), path: e.querySelector('.outline').getAttribute('d'),
      dots: [...e.querySelectorAll('.dots')].reduce((n, d) => n + (d.getAttribute('d') ?? '').split('M').length - 1, 0)}));
    // Length of the outline: cut once more here. The position on the page is rounded, so the length is that of a range.
    const lengthAt = (at) => {
      let sum = 0;
      for (let t = 0; t < data.triangles.length; t += 3) {
        const ends = [];
        for (let e = 0; e < 3; ++e) {
          const [a, b] = [3 * data.triangles[t + e], 3 * data.triangles[t + (e + 1) % 3]];
          const [da, db] = [data.vertices[a + k] - at, data.vertices[b + k] - at];
          if (da > 0 !== db > 0) ends.push([0, 1, 2].map((m) => data.vertices[a + m] + (da / (da - db)) * (data.vertices[b + m] - data.vertices[a + m])));
        }
        if (ends.length === 2) sum += Math.hypot(...ends[0].map((v, m) => v - ends[1][m]));
      }
      return sum;
    };
    let shown = 0;
    for (const [, x1, y1, x2, y2] of drawn.path.matchAll(/M([-\d.]+) ([-\d.]+)L([-\d.]+) ([-\d.]+)/g)) shown += Math.hypot(x2 - x1, y2 - y1);
    shown /= drawn.scale;
    const wanted = lengthAt(offset);
    expect(Math.abs(shown - wanted) < 0.02 * wanted + 1e-9, `section across ${axis}: outline of ${shown} mm, cut here ${wanted} mm`);
    const stated = words.match(/([\d\u202f]+) points within/);
    expect(drawn.dots === (stated ? parse(stated[1]) : 0), `section across ${axis}: ${drawn.dots} dots, ${stated?.[1]} stated`);
    if (axis === 'z') await shot(page.locator('#section'), 'section');
    if (drawn.dots) await sectionReading(page, data, axis, expect, parse, block.value_step_um);
  }
  const before = await page.$eval('.section-drawing .outline', (e) => e.getAttribute('d'));
  await page.selectOption('#section-direction', 'free');
  const first = page.locator('#section input[aria-label="Normal of the plane, x"]');
  await first.fill('1');
  expect(await until(async () => (await page.$eval('.section-drawing .outline', (e) => e.getAttribute('d'))) !== before), 'a plane by its normal cuts nothing new');
  await shot(page.locator('#section'), 'section-free');
  await page.selectOption('#section-direction', 'x');
}

export async function scanOf(page, data, expect, shot, parse) {
  if (data.evaluation) await figuresOf(page, data.evaluation, expect, parse);
  if (!data.surface?.values) return;
  await surfaceOf(page, data.surface, expect, shot, parse);
  await sectionOf(page, data.surface, expect, shot, parse);
}
