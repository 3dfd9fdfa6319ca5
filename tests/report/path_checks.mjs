// The tool on its path, coverage and contour error: what the page shows is compared with the data.
import {until} from './until.mjs';
import {inkOf, unpackedBytes} from './scan_checks.mjs';

async function coverageOf(page, block, expect, parse) {
  const reasons = unpackedBytes(block.coverage.of_triangle);
  expect(reasons.length === block.triangle_count, 'coverage is not one number for each triangle');
  const shown = new Map(await page.$$eval('#path .coverage [data-reason]', (all) => all.map((e) => [Number(e.dataset.reason), e.textContent])));
  for (const [i, reason] of block.coverage.reasons.entries()) {
    const drawn = (100 * reasons.filter((r) => r === i).length) / reasons.length;
    // Shares of the area where the producer states them; the colour of the legend is that of the data.
    const shares = block.coverage.percent;
    const share = shares ? shares[i] : drawn;
    expect(shown.has(i) === (drawn > 0 || share > 0), `coverage: ${reason} is ${drawn > 0 ? 'missing' : 'there without a triangle'}`);
    if (!shown.has(i)) continue;
    if (block.coverage.colours) {
      const colour = await page.$eval(`#path .coverage [data-reason="${i}"] .dot`, (e) => getComputedStyle(e).backgroundColor);
      const wanted = [1, 3, 5].map((at) => parseInt(block.coverage.colours[i].slice(at, at + 2), 16));
      expect(colour === `rgb(${wanted.join(', ')})`, `coverage: ${reason} is ${colour}, data ${wanted}`);
    }
    if (share === undefined) {
      expect(shown.get(i) === reason, `coverage: ${shown.get(i)} without a share`);
      continue;
    }
    const stated = parse(shown.get(i).match(/: (.*?)\u2009%/)[1]);
    expect(shown.get(i).startsWith(reason) && Math.abs(stated - share) < 0.006 * share, `coverage: ${shown.get(i)} for ${share}`);
  }
}

async function pathOf(page, data, expect, shot, parse) {
  const path = data.path;
  const n = path.time_s.length;
  await page.locator('#path').scrollIntoViewIfNeeded();
  const canvas = '#path .stage canvas';
  if (n > 10) expect(await until(async () => (await inkOf(page, canvas)).drawn > 3000), 'path and part are drawn empty');
  const rows = await page.$$eval('#path [data-axis]', (all) => all.map((e) => e.dataset.axis));
  expect(String(rows) === String(path.axes ?? Object.keys(path.commands)), `axes of the path: ${rows}`);
  const positions = () => page.$$eval('#path [data-axis]', (all) => all.map((e) => e.textContent));
  // Ends and a place between: each axis where the data have it.
  const compare = async (share, at) => {
    await page.fill('#path-position', String(Math.round(2000 * share)));
    const shown = await positions();
    rows.forEach((key, i) => expect(Math.abs(parse(shown[i]) - path.commands[key][at]) < 6e-4, `${key} at ${share}: page says ${shown[i]}, data ${path.commands[key][at]}`));
  };
  await compare(0, 0);
  const first = n > 10 ? await inkOf(page, canvas) : undefined;
  await compare(1, n - 1);
  if (n > 10) {
    expect(await until(async () => (await inkOf(page, canvas)).sum !== first.sum), 'the tool does not move');
    const words = await page.textContent('#path-words');
    expect(Math.abs(parse(words.split('\u2009s')[0]) - path.time_s[n - 1]) < 1e-3 * path.time_s[n - 1], `time at the end: ${words}`);
    const said = (await page.$$eval('#path .note', (all) => all.map((e) => e.textContent).join(' '))).match(/(?:All ([\d\u202f]+) moves|([\d\u202f]+) of ([\d\u202f]+) moves) are drawn/);
    const [drawn, moves] = [parse(said?.[1] ?? said?.[2] ?? 'none'), parse(said?.[1] ?? said?.[3] ?? 'none')];
    expect(drawn === n && moves === (path.moves ?? n), `${drawn} of ${moves} moves said to be drawn, ${n} of ${path.moves ?? n} are`);
    // Rapid moves can be hidden: where there are many, they hide the part.
    if (await page.locator('#path-rapid').count()) {
      const all = (await inkOf(page, canvas)).sum;
      await page.uncheck('#path-rapid');
      expect(await until(async () => (await inkOf(page, canvas)).sum !== all), 'rapid moves are not hidden');
      await page.check('#path-rapid');
    }
    await page.fill('#path-position', '1200');
    await page.waitForTimeout(400);
    await shot(page.locator('#path'), 'path');
    // Plays on from there, stops, and stays.
    const before = String(await positions());
    await page.click('#path-play');
    expect(await until(async () => String(await positions()) !== before), 'nothing is played');
    expect((await page.textContent('#path-play')) === 'Pause', 'the button does not say pause');
    await page.click('#path-play');
    const still = String(await positions());
    await page.waitForTimeout(400);
    expect(String(await positions()) === still, 'the path goes on after a pause');
  }
}

async function contoursOf(page, blocks, expect, shot, parse) {
  const wanted = blocks.filter((block) => block.error_um?.length);
  const figures = await page.$$eval('#contour figure', (all) => all.map((e) => ({caption: e.querySelector('figcaption').textContent,
    dots: (e.querySelector('.dots.contour')?.getAttribute('d') ?? '').split('M').length - 1, band: e.querySelectorAll('.band').length, rules: e.querySelectorAll('line.rule').length})));
  expect(figures.length === wanted.length, `${figures.length} contours for ${wanted.length}`);
  for (const [i, block] of wanted.entries()) {
    const values = block.error_um;
    const mean = block.mean_um ?? values.reduce((a, b) => a + b, 0) / values.length;
    const largest = block.largest_um ?? Math.max(...values.map(Math.abs));
    const stated = figures[i].caption.match(/mean (.*?)\u2009µm, largest amount (.*?)\u2009µm/);
    expect(stated && Math.abs(parse(stated[1]) - mean) <= 6e-4 * Math.abs(mean) && Math.abs(parse(stated[2]) - largest) <= 6e-4 * largest,
      `contour: ${figures[i].caption} for ${mean}, ${largest}`);
    if (values.length <= 200) expect(figures[i].dots === values.length, `contour: ${figures[i].dots} dots for ${values.length} points`);
    expect(figures[i].band === (block.u_um ? 1 : 0), 'contour: band of the uncertainty');
    expect(figures[i].rules === (block.limits_um?.length ?? 0), 'contour: limits');
  }
  await shot(page.locator('#contour'), 'contour');
}

export async function motionOf(page, data, expect, shot, parse) {
  if (data.path) {
    await pathOf(page, data, expect, shot, parse);
    if (data.surface?.coverage) await coverageOf(page, data.surface, expect, parse);
  }
  if (data.contour) await contoursOf(page, [data.contour].flat(), expect, shot, parse);
}
