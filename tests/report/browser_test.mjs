// Opens reports in headless Chromium from file:// and checks what a reader sees.
//   node browser_test.mjs --web WEB_DIR --out FOLDER [--shots] REPORT.html ...
// --shots leaves pictures of the steps in FOLDER, to be looked at: they cost more than all checks together.
// Exit code 77: Chromium is not installed, nothing was tested.
import {spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, statSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {basename, join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {contentOf, mapChoicesOf} from './content_checks.mjs';
import {layoutFaults} from './layout_checks.mjs';
import {motionOf} from './path_checks.mjs';
import {inksOf, scanOf} from './scan_checks.mjs';
import {settled, until, watchDrawing} from './until.mjs';
import {keyboardOf, paperOf} from './use_checks.mjs';

const reports = [];
const options = {web: '', out: '', shots: false};
for (let i = 2; i < process.argv.length; ++i) {
  const name = process.argv[i];
  if (name === '--shots') options.shots = true;
  else if (name.startsWith('--')) options[name.slice(2)] = process.argv[++i];
  else reports.push(resolve(name));
}
const chromiumPath = process.env.ABBE_CHROMIUM ?? '/usr/bin/chromium';
if (!existsSync(chromiumPath)) {
  console.log(`SKIPPED: no Chromium at ${chromiumPath} (set ABBE_CHROMIUM)`);
  process.exit(77);
}
// Chromium occasionally starts and then never answers. It is started once more; a page that hangs would hang again.
const kLongestMs = 280_000;  // the longest page takes a tenth of it
if (!process.env.ABBE_BROWSER_TRY) {
  for (const attempt of ['1', '2']) {
    const done = spawnSync(process.execPath, process.argv.slice(1),
      {stdio: 'inherit', timeout: kLongestMs, killSignal: 'SIGKILL', env: {...process.env, ABBE_BROWSER_TRY: attempt}});
    if (done.signal === null) process.exit(done.status);
    console.log(`attempt ${attempt} was ended by ${done.signal}, after at most ${kLongestMs / 1000} s`);
  }
  process.exit(1);
}
const {chromium} = createRequire(join(resolve(options.web), 'package.json'))('playwright-core');
mkdirSync(options.out, {recursive: true});

const failures = [];
const check = (good, text) => {
  if (!good) failures.push(text);
};

/// Number as the page writes it.
const parse = (text) => {
  const plain = text.replace(/[\u2009\u202f ]/g, '').replace(/\u2212/g, '-');
  const power = plain.match(/^(.*)·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)$/);
  if (!power) return Number(plain);
  const exponent = power[2].replace('⁻', '-').replace(/[⁰¹²³⁴⁵⁶⁷⁸⁹]/g, (d) => '⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(d));
  return Number(power[1]) * 10 ** Number(exponent);
};

async function inspect(browser, file) {
  const name = basename(file, '.html');
  const problems = (text) => `${name}: ${text}`;
  const expect = (good, text) => check(good, problems(text));
  const picture = (part) => join(options.out, `${name}-${part}.png`);
  // Without a picture what is shown is scrolled to all the same: the pointer acts only on what is in the window.
  const shot = (locator, part) => (options.shots ? locator.screenshot({path: picture(part)}) : locator.scrollIntoViewIfNeeded());
  const shotOfAll = (part) => options.shots && page.screenshot({path: picture(part), fullPage: true});
  const size = statSync(file).size;
  check(size < 3e6, problems(`${size} bytes, 3 MB allowed`));
  const text = readFileSync(file, 'utf8');
  const data = JSON.parse(text.match(/id="abbe-data">([\s\S]*?)<\/script>/)[1]);
  check(/<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'sha256-[^']+'/.test(text), problems('no content security policy'));

  // Smooth scrolling is drawn frame by frame; `keyboardOf` checks it by itself.
  const context = await browser.newContext({viewport: kTinyWindow, colorScheme: 'dark', reducedMotion: 'reduce', offline: true});
  const page = await context.newPage();
  await page.addInitScript(watchDrawing);
  const url = pathToFileURL(file).href;
  page.on('console', (message) => {
    // The software renderer comments on its own speed; that is not the page's doing.
    if (['error', 'warning'].includes(message.type()) && !/GPU stall due to ReadPixels|software WebGL|swiftshader/i.test(message.text()))
      check(false, problems(`console: ${message.text()}`));
  });
  page.on('pageerror', (error) => check(false, problems(`exception: ${error.message}`)));
  page.on('request', (request) => {
    if (request.url() !== url && !/^(data|blob):/.test(request.url())) check(false, problems(`request of ${request.url()}`));
  });
  // The system's preference is followed when nothing was chosen. The window has no room for drawings, which this does not need.
  await page.goto(url, {timeout: 120_000});
  check((await page.evaluate(() => document.documentElement.dataset.theme)) === 'dark', problems('does not follow the system to dark'));
  await page.emulateMedia({colorScheme: 'light'});
  await page.setViewportSize({width: 1280, height: 900});
  await page.goto(url, {timeout: 120_000});
  await settled(page, 5);
  // Each view is drawn once, and again where the layout of the page still changes its size. What is drawn stays: for half a second, and for
  // an image on paper, which is in the light theme too.
  const views = await page.locator('.stage canvas').count();
  const drawings = () => page.evaluate(() => window.drawings);
  const drawn = await drawings();
  check(drawn >= views && drawn <= 2 * views, problems(`${views} views are drawn ${drawn} times when the page opens`));
  if (views) {
    await page.evaluate(() => ['beforeprint', 'afterprint'].forEach((name) => window.dispatchEvent(new Event(name))));
    await settled(page, 30);
    check((await drawings()) === drawn, problems(`the views are drawn ${await drawings()} times, ${drawn} before, although nothing changes`));
  }

  check((await page.textContent('h1')) === data.title, problems('the heading is not the title'));
  check((await page.evaluate(() => window.broken)) === undefined, problems('data were executed as a script'));

  // Figures on the page against summary: equal to the digits printed.
  const compareFigures = async (selector) => {
    const figures = await page.$$eval(selector, (all) => all.map((e) => [e.dataset.key, e.textContent]));
    let compared = 0;
    for (const [key, text] of figures) {
      if (key === 'verdict') continue;
      const expected = key.split('.').reduce((object, part) => object?.[part], data.summary);
      const shown = parse(text);
      expect(typeof expected === 'number' && Math.abs(shown - expected) <= (Number.isInteger(expected) ? 0 : 0.0051 * Math.abs(expected)), `${key}: page says ${text}, summary ${expected}`);
      ++compared;
    }
    return compared;
  };
  const compared = await compareFigures('[data-key]');
  if (data.summary?.held_out?.position_before_um || data.summary?.map?.position_before_um) {
    check(compared >= 3, problems(`only ${compared} figures of the summary are on the page`));
    check((await page.textContent('.verdict')).length > 20, problems('no verdict'));
  }

  const sections = await page.$$eval('main > section', (all) => all.map((e) => e.id));
  const wanted = {map: data.map, machine: data.machine?.axes?.length, motions: data.error_motions?.length, parameters: data.parameters,
    residuals: data.residuals?.setups?.length, assumptions: data.assumptions?.length, figures: data.evaluation?.figures?.length || data.evaluation?.drawings?.length,
    surface: data.surface?.values, section: data.surface?.values, path: data.path?.time_s?.length, contour: data.contour};
  for (const [id, present] of Object.entries(wanted))
    check(sections.includes(id) === Boolean(present), problems(`section ${id} is ${present ? 'missing' : 'there without data'}`));
  if (data.error_motions) {
    const plots = await page.$$eval('#motions .plot .line.value', (all) => all.map((e) => e.getAttribute('d')));
    check(plots.length === data.error_motions.length, problems(`${plots.length} curves for ${data.error_motions.length} error motions`));
    check(plots.every((d, i) => d.length > ((data.error_motions[i].position_mm ?? data.error_motions[i].position_deg).length > 2 ? 40 : 2)), problems('an error motion is drawn empty'));
  }
  if (data.parameters) {
    const rows = await page.$$eval('.parameters tbody tr', (all) => all.length);
    check(rows === data.parameters.name.length, problems(`${rows} rows for ${data.parameters.name.length} parameters`));
    await page.fill('#parameter-filter', data.parameters.name[0]);
    const kept = await page.$$eval('.parameters tbody tr', (all) => all.length);
    check(kept >= 1 && (kept < rows || rows === 1), problems('the filter of the parameters does nothing'));
    await page.fill('#parameter-filter', '');
  }
  await contentOf(page, data, expect);
  const drawing = await page.evaluate(() => [...document.querySelectorAll('svg path')].filter((p) => (p.getAttribute('d') ?? '').includes('NaN')).length);
  check(drawing === 0, problems(`${drawing} paths hold NaN`));

  // The three-dimensional views: coloured pixels, different between before and after unless the data are equal.
  if (data.map) {
    const ink = () => inksOf(page, '.stage canvas', 40).then((all) => all.map((one) => one.coloured));
    const moved = ['x', 'y', 'z'].some((k) => data.map.before_um[k].some((v) => v !== 0));
    if (moved) await until(async () => (await ink())[0] > 500);
    const first = await ink();
    check(first.length === (data.map.after_um ? 2 : 1), problems(`${first.length} views of the map`));
    check(first.every((n) => n > (moved ? 50 : 0)) && (!moved || first[0] > 500), problems(`the map is drawn empty: ${first} coloured pixels`));
    await page.focus('.stage canvas');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('ArrowUp');
    check(!moved || (await until(async () => String(await ink()) !== String(first))), problems('the arrow keys do not turn the map'));
    // Slice, colours and lengths act on the drawing and can be undone.
    if (moved && (await page.locator('#map-slice').count())) {
      const turned = String(await ink());
      await page.selectOption('#map-slice', '0');
      check(await until(async () => String(await ink()) !== turned), problems('the slice does not change the map'));
      await page.selectOption('#map-slice', '');
      check(await until(async () => String(await ink()) === turned), problems('the map is not whole again after a slice'));
    }
    if (moved && data.map.after_um) {
      const same = (await ink())[1];
      const own = page.getByLabel('arrows after at their own length');
      await own.check();
      check(await until(async () => (await ink())[1] > same), problems('arrows after do not grow at their own length'));
      await shot(page.locator('.views'), 'own-length');
      await own.uncheck();
    }
    await page.getByRole('button', {name: 'Reset view'}).click();
    // Until the image for paper shows this view: later ones are compared with it.
    await settled(page, 30);
    const stills = () => page.$$eval('.still', (all) => all.map((e) => e.src.length));
    check(await until(async () => (await stills()).every((n) => n > 2000)), problems('no still image of the map for printing'));
  }

  await scanOf(page, data, expect, shot, parse);
  await motionOf(page, data, expect, shot, parse);
  if (data.map) await mapChoicesOf(page, data, expect, shot, compareFigures);
  if (data.summary?.monte_carlo) await shot(page.locator('#monte-carlo'), 'monte-carlo');

  const layout = async (width) => {
    await page.setViewportSize({width, height: 900});
    await settled(page);
    for (const fault of await page.evaluate(layoutFaults)) check(false, problems(`${width} px: ${fault}`));
  };
  await layout(320);
  await layout(360);
  await shotOfAll('narrow');
  await layout(1280);
  await shotOfAll('light');

  // Contrast of running text against what lies behind it, WCAG 2.1: 4.5.
  const contrast = () => page.evaluate(() => {
    const numbers = (c) => c.match(/[\d.]+/g).map(Number);
    const light = (c) => {
      const [r, g, b] = numbers(c).map((v) => { const s = v / 255; return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4; });
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const bad = [];
    for (const e of document.querySelectorAll('h1,h2,h3,p,td,th,dt,dd,li,figcaption,button,label,.note,.state,.bar a,svg text')) {
      if (!e.textContent.trim()) continue;
      let behind = e;
      while (behind && /rgba\(0, 0, 0, 0\)|transparent/.test(getComputedStyle(behind).backgroundColor)) behind = behind.parentElement;
      const style = getComputedStyle(e);
      const front = e instanceof SVGElement ? style.fill : style.color;
      if (!front.startsWith('rgb(')) continue;
      const a = light(front), b = light(behind ? getComputedStyle(behind).backgroundColor : 'rgb(255,255,255)');
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (ratio < 4.5) bad.push(`${e.tagName}.${e.getAttribute('class') ?? ''} "${e.textContent.slice(0, 20)}" ${ratio.toFixed(1)}`);
    }
    return [...new Set(bad)].slice(0, 5);
  });
  for (const text of await contrast()) check(false, problems(`low contrast in the light theme: ${text}`));

  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const lightPaper = await paper();
  await page.click('button.theme');
  await settled(page);
  const darkPaper = await paper();
  check(lightPaper !== darkPaper && numbersOf(darkPaper).every((v) => v < 60), problems(`dark theme: background ${darkPaper}`));
  for (const text of await contrast()) check(false, problems(`low contrast in the dark theme: ${text}`));
  await shotOfAll('dark');
  await page.pdf({path: join(options.out, `${name}-print.pdf`), format: 'A4', printBackground: true});
  if (await page.locator('.part').count()) {
    // What stands before the appendix is short, however large the identification is.
    await page.evaluate(() => document.querySelectorAll('.appendix').forEach((e) => (e.hidden = true)));
    const sheets = (await page.pdf({format: 'A4', printBackground: true})).toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
    check(sheets >= 1 && sheets <= kMostSheets, problems(`${sheets} sheets of paper before the appendix, ${kMostSheets} allowed`));
    await page.evaluate(() => document.querySelectorAll('.appendix').forEach((e) => (e.hidden = false)));
  }

  await paperOf(page, data, expect);
  await keyboardOf(page, expect);

  const unlabelled = await page.evaluate(() =>
    [...document.querySelectorAll('input,select,button,canvas,svg[role=img]')].filter((e) =>
      !(e.labels?.length || e.getAttribute('aria-label') || e.textContent.trim())).map((e) => e.outerHTML.slice(0, 80)));
  check(unlabelled.length === 0, problems(`without a label: ${unlabelled[0]}`));

  await context.close();
  return {name, size, figures: compared, sections: sections.length};
}

const kMostSheets = 6;
const kTinyWindow = {width: 20, height: 20};
const numbersOf = (colour) => colour.match(/[\d.]+/g).slice(0, 3).map(Number);
// There is no graphics processor: the three-dimensional views are drawn in software, and Chromium would draw the whole page through the
// same slow emulation of one unless told that there is none. Smooth edges take half of the time of a view; they are for looking only.
const browser = await chromium.launch({
  executablePath: chromiumPath,
  args: ['--headless', '--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-background-networking',
    '--no-first-run', '--disable-component-update', '--disable-sync', ...(options.shots ? [] : ['--webgl-antialiasing-mode=none'])],
});
/// The check of the layout finds each of its faults on a page that has them, and none on one that has not.
async function layoutCheckWorks() {
  const page = await browser.newPage({viewport: {width: 360, height: 800}});
  const faultsOf = async (content) => {
    await page.setContent(`<!doctype html><body style="margin:0;font:16px sans-serif">${content}`);
    return (await page.evaluate(layoutFaults)).join('; ');
  };
  const tick = (x, text) => `<text x="${x}" y="20" class="tick middle">${text}</text>`;
  const faulty = {
    'wide in a window': '<div style="width:500px">wide</div>', 'is broken across lines': '<p style="width:24px;overflow-wrap:anywhere">10.8234</p>',
    'cover each other': '<p style="margin:0">words</p><p style="margin:-20px 0 0">others</p>', 'stands twice on one axis': `<svg width="300" height="40">${tick(20, '10')}${tick(90, '10')}</svg>`,
    'has letters of 6.0 px': '<svg width="150" height="20" viewBox="0 0 300 40"><text x="20" y="20" font-size="12" style="font-size:12px">small</text></svg>',
    'do not stay in view together': '<div class="scroll"><table><thead><tr><th style="position:sticky;left:0">a</th></tr></thead><tbody><tr><td>b</td></tr></tbody></table></div>',
    'letters on 6 lines': '<table><tr><td>a <br>few <br>words <br>on <br>many <br>lines</td><td>b</td></tr></table>',
    'is moved sideways': '<figure><div class="scroll" aria-label="plot" style="overflow-x:auto;width:200px"><svg width="300" height="20"></svg></div></figure>',
    'is cut at the edge of its drawing': '<svg width="60" height="40"><text x="20" y="20">a long word</text></svg>'};
  for (const [words, content] of Object.entries(faulty)) {
    const found = await faultsOf(content);
    check(found.includes(words), `the check of the layout does not find what ${words}: ${found}`);
  }
  const found = await faultsOf(`<p>10.8234 <b>words</b></p><div style="overflow-x:auto;width:200px"><div style="width:500px">scrolls</div></div><svg width="300" height="40">${tick(20, '10')}${tick(90, '20')}</svg>`);
  await page.setViewportSize({width: 1280, height: 800});
  const wide = await faultsOf('<div class="scroll" aria-label="t" style="overflow-x:auto;width:50px"><table><thead><tr><th>unbreakable</th></tr></thead></table></div>');
  check(wide.includes('do not fit'), `the check of the layout does not find a table that scrolls in a wide window: ${wide}`);
  check(!found, `the check of the layout finds faults where there are none: ${found}`);
  await page.close();
}

const results = [];
try {
  if (reports.some((file) => basename(file) === 'sample.html')) await layoutCheckWorks();
  for (const file of reports) results.push(await inspect(browser, file));
} finally {
  await browser.close();
}
for (const result of results) console.log(`${result.name}: ${result.size} bytes, ${result.sections} sections, ${result.figures} figures compared with the summary`);
for (const failure of failures) console.error(`FAILED ${failure}`);
if (!reports.length) failures.push('no report given');
writeFileSync(join(options.out, 'browser_test.json'), JSON.stringify({results, failures}, null, 1));
process.exit(failures.length ? 1 : 0);
