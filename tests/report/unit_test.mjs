// Parts of the page that need no browser: words kept apart, quantiles, numbers as text.
//   node unit_test.mjs --web WEB_DIR
import assert from 'node:assert/strict';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const web = resolve(process.argv[process.argv.indexOf('--web') + 1]);
const {buildSync} = createRequire(join(web, 'package.json'))('esbuild');
const folder = mkdtempSync(join(tmpdir(), 'abbe-page-'));

/// A module of the page, without types.
async function load(name) {
  const built = buildSync({entryPoints: [join(web, 'src', `${name}.ts`)], bundle: true, write: false, format: 'esm', logLevel: 'silent'});
  const file = join(folder, `${name}.mjs`);
  writeFileSync(file, built.outputFiles[0].text);
  return import(pathToFileURL(file).href);
}

const tests = {
  async 'words that cover each other are kept apart, others stay'() {
    const {keptApart} = await load('label_places');
    const label = (text, x, y) => ({text, x, y, style: '', size: 10, middle: false});
    const alone = [label('X', 0, 0), label('Y', 200, 0)];
    assert.deepEqual(keptApart(alone), alone);
    const placed = keptApart([label('first', 0, 0), label('second', 3, 2), label('third', 1, -1)], [[40, -4, 3]]);
    assert.deepEqual([placed[0].x, placed[0].y], [0, 0]);
    const box = ({x, y, size, text}) => [x, x + 0.6 * size * text.length, y - size, y + 0.25 * size];
    for (let i = 0; i < placed.length; ++i)
      for (let j = 0; j < i; ++j) {
        const [a, b] = [box(placed[i]), box(placed[j])];
        assert.ok(a[1] <= b[0] || b[1] <= a[0] || a[3] <= b[2] || b[3] <= a[2], `${placed[i].text} covers ${placed[j].text}`);
      }
    // A mark where the word would be drives it away.
    const [driven] = keptApart([label('mark', 0, 0)], [[5, -4, 3]]);
    assert.ok(driven.x !== 0 || driven.y !== 0);
  },
  async 'sentences of the data are written with signs and letters that people print'() {
    const {prose} = await load('format');
    assert.equal(prose('mean 10910 um over 9 x 9 x 9 poses, Z -460 to 0 mm, 11^6'), 'mean 10\u202f910\u202fµm over 9 × 9 × 9 poses, Z \u2212460 to 0 mm, 11\u2076');
    assert.equal(prose('shifts in um; 5e-11 um at most'), 'shifts in µm; 5\u202f·\u202f10⁻¹¹\u202fµm at most');
    for (const kept of ['ISO 10791-6, seed 87109', 'tables/figure-3.csv', 'EXX[P1], file1e5', '0.123456 mm']) assert.equal(prose(kept), kept);
  },
  async 'quantiles of values are linear between order statistics'() {
    const {fromValues} = await load('histogram');
    const values = [4, 1, 3, 2];
    const data = fromValues(values, [0.5, 1, 2, 4, 8]);
    assert.equal(data.median, 2.5);
    assert.ok(Math.abs(data.p95 - 3.85) < 1e-12);
    assert.equal(data.share.reduce((a, b) => a + b), 100);
  },
  async 'quantiles of counts take in what lies outside of the classes'() {
    const {fromCounts} = await load('histogram');
    assert.equal(fromCounts([0, 1, 2], [5, 5]).median, 1);
    // Ten of eleven lie in the upper class.
    assert.ok(fromCounts([0, 1, 2], [1, 10], 0, 0).median > 1);
    assert.equal(fromCounts([0, 1, 2], [1, 1], 10, 0).median, 0);
    assert.equal(fromCounts([0, 1, 2], [1, 1], 0, 10).median, 2);
    assert.equal(fromCounts([0, 1, 2], [2, 2], 6, 2).share[0], 100 / 6);
  },
  async 'a logarithmic axis names each power of ten once'() {
    const {logScale} = await load('scale');
    for (const range of [[3e3, 3e6], [1e4, 1e7], [2e5, 9e5], [1e-5, 1e-3], [1, 1e9]]) {
      const scale = logScale(range, [0, 200], 9);
      const labels = scale.ticks.map((tick) => scale.label(tick)).filter(Boolean);
      assert.ok(labels.length > 0, `no label on ${range}`);
      assert.equal(new Set(labels).size, labels.length, `${labels} on ${range}`);
      assert.ok(!labels.some((label) => label === '10\u2076') || scale.ticks.some((tick) => Math.abs(tick / 1e6 - 1) < 1e-9));
    }
  },
  async 'tables wider than a sheet are printed in parts, each with the first column'() {
    const {columnsOnPaper} = await load('table');
    const columns = Array.from({length: 20}, (_, i) => `column${i}`);
    const row = columns.map(() => '-1234.5678');
    const groups = columnsOnPaper(columns, [row]);
    assert.ok(groups.length > 1);
    assert.ok(groups.every((group) => group[0] === 0 && group.length > 2));
    assert.deepEqual(groups.flatMap((group) => group.slice(1)), columns.map((_, i) => i).slice(1));
    assert.deepEqual(columnsOnPaper(['a', 'b'], [['1', 'many words that may stand on several lines of a narrow column']]), [[0, 1]]);
    assert.deepEqual(columnsOnPaper(['a'], []), [[0]]);
    // Where the first column does not tell the rows apart, the next ones are repeated too.
    const rows = [1, 2, 3].map((n) => columns.map((_, i) => (i === 0 ? 'circle' : i === 1 ? String(n) : '-1234.5678')));
    const twice = columnsOnPaper(columns, rows);
    assert.ok(twice.length > 1 && twice.every((group) => group[0] === 0 && group[1] === 1 && group.length > 3), JSON.stringify(twice));
    assert.deepEqual(twice.flatMap((group) => group.slice(2)), columns.map((_, i) => i).slice(2));
  },
  async 'numbers have a real minus sign, none at zero, and thousands apart'() {
    const {fixed, number, withUncertainty} = await load('format');
    assert.equal(fixed(-0.0004, 3), '0.000');
    assert.equal(fixed(-12345.678, 1), '\u221212\u202f345.7');
    assert.equal(number(-0.00012), '\u22121.20\u202f\u00b7\u202f10\u207b\u2074');
    assert.deepEqual(withUncertainty(-1.23456, 0.0123), ['\u22121.235', '0.012']);
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  try {
    await test();
    console.log(`ok      ${name}`);
  } catch (error) {
    ++failed;
    console.log(`FAILED  ${name}\n${error.stack}`);
  }
}
rmSync(folder, {recursive: true});
process.exit(failed ? 1 : 0);
