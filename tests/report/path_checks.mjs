// The tool on its path, coverage and contour error: what the page shows is compared with the data.
import {settled, until} from './until.mjs';
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
    const stated = parse(shown.get(i).match(/: (.*?)\u202f%/)[1]);
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
    expect(Math.abs(parse(words.split('\u202fs')[0]) - path.time_s[n - 1]) < 1e-3 * path.time_s[n - 1], `time at the end: ${words}`);
    const said = (await page.$$eval('#path .note', (all) => all.map((e) => e.textContent).join(' '))).match(/(?:All ([\d\u202f]+) (?:moves|readings)|([\d\u202f]+) of ([\d\u202f]+) (?:moves|readings)) are drawn/);
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
    await shot(page.locator('#path'), 'path');
    // Plays on from there, stops, and stays. Stopped within the page, since a slow machine could come to the end before another click.
    const before = String(await positions());
    await page.click('#path-play');
    const [played, label, paused] = await page.evaluate(async (before) => {
      const shown = () => String([...document.querySelectorAll('#path [data-axis]')].map((e) => e.textContent));
      const play = document.querySelector('#path-play');
      for (const start = performance.now(); shown() === before && performance.now() < start + 15000;) await new Promise((done) => requestAnimationFrame(done));
      const seen = [shown() !== before, play.textContent];
      play.click();
      return [...seen, play.textContent];
    }, before);
    expect(played, 'nothing is played');
    expect(label === 'Pause', 'the button does not say pause');
    expect(paused === 'Play', `after a pause the button says ${paused}`);
    const still = String(await positions());
    await settled(page, 10);
    expect(String(await positions()) === still, 'the path goes on after a pause');
  }
}

/// Sections: each can be chosen, is drawn with all its points in one scale, and its caption says what the data say.
async function sectionsOf(page, block, at, expect, shot, parse) {
  const box = page.locator('.contour-sections').nth(at);
  const {sections} = block;
  expect((await box.locator('option').allTextContents()).join() === sections.map((one) => one.name).join(), 'sections to choose from');
  const largest = sections.reduce((best, one, i) => (Math.abs(one.error_um ?? 0) > Math.abs(sections[best].error_um ?? 0) ? i : best), 0);
  const chosen = async () => Number(await box.locator('select').inputValue());
  if (sections.some((one) => one.error_um !== undefined)) expect((await chosen()) === largest, 'the section of the largest contour error is not the first one shown');
  const check = async (i) => {
    const one = sections[i];
    expect((await chosen()) === i, `section ${i} is not chosen`);
    const caption = await box.locator('figcaption').textContent();
    expect(caption.startsWith(`Section ${one.name}`), `caption of section ${one.name}: ${caption}`);
    if (one.error_um === undefined) expect(caption.includes(`not evaluated: ${one.not_evaluated}`), `section ${one.name} is not evaluated: ${caption}`);
    else expect(Math.abs(parse(caption.match(/contour error (.*?)\u202fµm/)[1]) - one.error_um) <= 6e-4 * Math.abs(one.error_um), `caption of section ${one.name}: ${caption}`);
    const drawn = await box.locator('svg.plot').evaluate((root) => {
      const places = (d) => [...d.matchAll(/[ML](-?[\d.]+) (-?[\d.]+)/g)].map((m) => [Number(m[1]), Number(m[2])]);
      const path = (selector) => places(root.querySelector(selector)?.getAttribute('d') ?? '');
      const clip = root.querySelector('clipPath rect');
      return {scanned: path('.dots.scanned'), edges: root.querySelectorAll('.line.edge').length, corners: root.querySelectorAll('.mark-of.corner').length,
        onsets: root.querySelectorAll('.mark-of.onset').length, command: root.querySelectorAll('.mark-of.command').length,
        left: Number(clip.getAttribute('x')), right: Number(clip.getAttribute('x')) + Number(clip.getAttribute('width'))};
    });
    expect(drawn.scanned.length === one.across_um.length, `section ${one.name}: ${drawn.scanned.length} of ${one.across_um.length} points`);
    const edges = one.edges?.length ?? 0;
    expect([drawn.edges, drawn.corners, drawn.onsets].every((n) => n === edges) && drawn.command === 1, `section ${one.name}: ${drawn.edges} edges for ${edges}`);
    expect(drawn.scanned.every(([x]) => x >= drawn.left && x <= drawn.right), `section ${one.name} is drawn outside of its frame`);
    const span = (values) => Math.max(...values) - Math.min(...values);
    const scale = [span(drawn.scanned.map((p) => p[0])) / span(one.across_um), span(drawn.scanned.map((p) => p[1])) / span(one.height_um)];
    expect(span(one.height_um) < 5 || Math.abs(scale[0] / scale[1] - 1) < 0.02, `section ${one.name}: ${scale[0]} px/µm across, ${scale[1]} out of the surface`);
  };
  await check(largest);
  await shot(box, 'section-of-a-contour');
  const [back, on] = [box.getByRole('button', {name: 'Previous'}), box.getByRole('button', {name: 'Next'})];
  for (const i of new Set([0, sections.length - 1, Math.max(0, sections.findIndex((one) => one.error_um === undefined))])) {
    await box.locator('select').selectOption({index: i});
    await check(i);
    if (sections.length < 2) continue;
    expect((await back.isDisabled()) === (i === 0) && (await on.isDisabled()) === (i === sections.length - 1), `steps from section ${i}`);
    await (i > 0 ? back : on).click();
    await check(i > 0 ? i - 1 : i + 1);
  }
}

async function contoursOf(page, blocks, expect, shot, parse) {
  const wanted = blocks.filter((block) => block.error_um?.length);
  const read = () => page.$$eval('#contour > figure', (all) => all.map((e) => ({caption: e.querySelector('figcaption').textContent,
    also: [...e.querySelectorAll('[class*="dots also"]')].map((d) => d.getAttribute('d').split('M').length - 1), lines: e.querySelectorAll('.line.value').length,
    dots: (e.querySelector('.dots.contour')?.getAttribute('d') ?? '').split('M').length - 1, band: e.querySelectorAll('.band').length, rules: e.querySelectorAll('line.rule').length})));
  await until(async () => (await read()).every((figure, i) => figure.dots || !(wanted[i]?.error_um.length <= 200)));
  const figures = await read();
  expect(figures.length === wanted.length, `${figures.length} contours for ${wanted.length}`);
  for (const [i, block] of wanted.entries()) {
    const values = block.error_um;
    const meanOf = (of) => of.reduce((a, b) => a + b, 0) / of.length;
    const mean = block.mean_um ?? meanOf(values.map(Math.abs)), bias = block.bias_um ?? meanOf(values);
    const largest = block.largest_um ?? Math.max(...values.map(Math.abs));
    const stated = figures[i].caption.match(/mean amount (.*?)\u202fµm, largest amount (.*?)\u202fµm.*mean with signs (.*?)\u202fµm/);
    expect(stated && Math.abs(parse(stated[1]) - mean) <= 6e-4 * Math.abs(mean) && Math.abs(parse(stated[2]) - largest) <= 6e-4 * largest &&
      Math.abs(parse(stated[3]) - bias) <= 6e-4 * Math.abs(bias) + 1e-9, `contour: ${figures[i].caption} for ${mean}, ${largest}, ${bias}`);
    if (values.length <= 200) expect(figures[i].dots === values.length, `contour: ${figures[i].dots} dots for ${values.length} points`);
    expect(figures[i].band === (block.u_um ? 1 : 0), 'contour: band of the uncertainty');
    expect(figures[i].rules === (block.limits_um?.length ?? 0), 'contour: limits');
    expect(String(figures[i].also) === String((block.also ?? []).map((one) => one.value_um.length)), `contour: ${figures[i].also} dots beside it`);
    expect(figures[i].lines === (block.joined === false ? 0 : 1), 'contour: line through the points');
  }
  for (const [i, block] of blocks.filter((block) => block.sections?.length).entries()) await sectionsOf(page, block, i, expect, shot, parse);
  await shot(page.locator('#contour'), 'contour');
}

export async function motionOf(page, data, expect, shot, parse) {
  if (data.path) {
    await pathOf(page, data, expect, shot, parse);
    if (data.surface?.coverage) await coverageOf(page, data.surface, expect, parse);
  }
  if (data.contour) await contoursOf(page, [data.contour].flat(), expect, shot, parse);
}
