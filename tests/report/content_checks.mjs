// What the data hold is on the page: nothing less, and nothing that they do not hold.
import {until} from './until.mjs';

/// Every set-up with every component of its instrument: as many dots as values, every outlier marked, in both kinds of residual.
async function residualsOf(page, data, expect) {
  const blocks = await page.$$('#residuals .setup');
  const setups = data.residuals?.setups ?? [];
  expect(blocks.length === setups.length, `${blocks.length} blocks of residuals for ${setups.length} set-ups`);
  for (const [i, setup] of setups.entries()) {
    const components = setup.components ?? [];
    const drawn = () => blocks[i].$$eval('.plot', (all) => all.map((e) => ({
      label: [...e.querySelectorAll('.axis-label')].pop().textContent,
      dots: [...e.querySelectorAll('.dots')].reduce((n, d) => n + (d.getAttribute('d') ?? '').split('M').length - 1, 0),
      outliers: (e.querySelector('.dots.outlier').getAttribute('d') ?? '').split('M').length - 1,
    })));
    const wanted = (key, kept) => kept.map((c) => ({name: c.name, dots: c[key].filter((v) => v !== null).length,
      outliers: c[key].filter((v, k) => v !== null && setup.outlier?.[k]).length}));
    const compare = async (list, what) => {
      await until(async () => (await drawn()).length >= list.length);
      const plots = await drawn();
      for (const [k, row] of list.entries())
        expect(plots[k]?.label.startsWith(row.name) && plots[k].dots === row.dots && plots[k].outliers === row.outliers,
            `${what} of ${setup.name}: ${JSON.stringify(plots[k])} for ${JSON.stringify(row)}`);
      return plots;
    };
    const plots = await compare(wanted('normalised', components), 'residuals');
    expect(plots.length === components.length + (components.length > 1 ? 1 : 0), `${plots.length} plots of residuals for ${components.length} components of ${setup.name}`);
    const raw = components.filter((c) => c.residual);
    if (!raw.length) continue;
    await page.selectOption(`#residual-y-${i}`, 'raw');
    await compare(wanted('residual', raw), 'residuals in a unit');
    expect((await drawn()).length === raw.length, `${setup.name}: residuals in a unit are not those stated`);
    await page.selectOption(`#residual-y-${i}`, 'normalised');
  }
}

const isNumber = (v) => typeof v === 'number';

/// Ratios and interval ends of the simulation: one dot for every uncertain parameter, columns in the table.
async function monteCarloOf(page, data, expect) {
  const figures = data.summary?.monte_carlo;
  const there = await page.locator('#monte-carlo').count();
  expect(Boolean(there) === Boolean(figures?.samples), `section of the Monte Carlo is ${there ? 'there without data' : 'missing'}`);
  const heads = await page.$$eval('.parameters thead th button', (all) => all.map((e) => e.textContent));
  expect(!data.parameters || heads.includes('Ratio') === Boolean(data.parameters.monte_carlo_ratio), `columns of the parameters: ${heads}`);
  if (!there || !data.parameters?.monte_carlo_ratio) return;
  const wanted = data.parameters.monte_carlo_ratio.filter(isNumber).length;
  const dots = () => page.$$eval('#monte-carlo .plot', (all) => all.map((e) =>
    [...e.querySelectorAll('.dots')].reduce((n, d) => n + (d.getAttribute('d') ?? '').split('M').length - 1, 0)));
  await until(async () => (await dots()).length === 2);
  const drawn = await dots();
  expect(drawn[0] === wanted && drawn[1] === 2 * wanted, `Monte Carlo: ${drawn} dots for ${wanted} parameters`);
  const beyond = await page.$eval('#monte-carlo .dots.undetermined', (e) => (e.getAttribute('d') ?? '').split('M').length - 1);
  const expected = data.parameters.monte_carlo_ratio.filter((r) => isNumber(r) && (r < figures.chance_ratio_low || r > figures.chance_ratio_high)).length;
  expect(beyond === expected, `Monte Carlo: ${beyond} dots beyond chance, ${expected} in the data`);
  const words = await page.textContent('#monte-carlo .lead');
  expect(words.includes(figures.agrees ? 'confirms' : 'differs'), `Monte Carlo: the agreement is not said: ${words}`);
  const column = heads.indexOf('Ratio');
  const cells = await page.$$eval('.parameters tbody tr', (rows, at) => rows.map((row) => row.children[at].textContent), column);
  data.parameters.monte_carlo_ratio.forEach((ratio, i) =>
    expect(isNumber(ratio) ? Math.abs(Number(cells[i]) - ratio) <= 0.00501 : cells[i] === '\u2013', `${data.parameters.name[i]}: ratio ${cells[i]} for ${ratio}`));
}

const raised = (power) => [...String(Number(power))].map((d) => (d === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[d])).join('');
/// A sentence of the data as the page writes it; the parts of the page are tested by themselves.
const typeset = (text) => text.replace(/(\d) u(m|rad)\b/g, '$1\u202fµ$2').replace(/\bin u(m|rad)\b/g, 'in µ$1')
  .replace(/(?<![\w.])(\d+(?:\.\d+)?)e([-+]?\d+)(?!\w)/g, (_, mantissa, power) => `${mantissa}\u202f·\u202f10${raised(power)}`).replace(/(\d) x (?=\d)/g, '$1 × ').replace(/(^|[\s(,])-(?=\d)/g, '$1\u2212')
  .replace(/(\d)\^(\d+)/g, (_, base, power) => base + raised(power))
  .replace(/(?<![\w.])\d{5,}(?=(?:\.\d+)?[\u202f ](?:µm|µrad|mm)\b)/g, (digits) => digits.replace(/\B(?=(\d{3})+$)/g, '\u202f'));

/// Lists and figures of the identification, advice, assumptions, warnings: one entry for each in the data.
async function listsOf(page, data, expect) {
  const count = async (selector, wanted, what) => {
    const found = await page.locator(selector).count();
    expect(found === wanted, `${found} entries of ${what} for ${wanted} in the data`);
  };
  await count('#advice .advice-list > li', data.advice?.length ?? 0, 'advice');
  // The page puts what lacks a measurement first; every entry is there once, whole.
  const said = await page.locator('#advice .advice-list > li').allTextContents();
  for (const [i, entry] of (data.advice ?? []).entries()) {
    const text = typeset(entry.text);
    const parts = [text, entry.remedy ?? '', ...(entry.parameters ?? [])];
    const at = said.findIndex((shown) => parts.every((part) => shown.includes(part)));
    expect(at >= 0, `advice ${i + 1} is not on the page: ${parts.join(' | ')}`);
    if (at >= 0) said.splice(at, 1);
  }
  await count('#advice .not-identified > li', data.not_identified?.shown_by?.length ?? 0, 'errors that were not identified');
  await count('#assumptions li', data.assumptions?.length ?? 0, 'assumptions');
  await count('#references li', data.references?.length ?? 0, 'references');
  await count('#gauge .gauge-list > li', data.identification?.gauge?.length ?? 0, 'the gauge');
  await count('.overview .warnings li', (data.warnings?.length ?? 0) + (data.summary?.converged === false ? 1 : 0), 'warnings');
  const identification = data.identification;
  if (!identification) return;
  const history = identification.history ?? {};
  const figures = [
    identification.singular_values?.length,
    history.chi_square?.length,
    [...(history.relative_step ?? []), ...(history.damping ?? [])].some((v) => v > 0),
    identification.order_selection?.held_out_normalised_rms?.some((v) => v > 0),
  ].filter(Boolean).length;
  await count('#identification figure, #identification > .columns > p', figures, 'figures of the identification');
  if (identification.stages?.length) await count('#identification table tbody tr', identification.stages.length, 'stages');
  const words = await page.textContent('#identification');
  for (const text of [identification.strategy, identification.loss]) expect(!text || words.includes(text), `the identification does not say ${text}`);
}

/// Sparklines: one in each row; the line passes through the values, to one scale; the last mark says whether it is within its limits.
async function sparklinesOf(page, data, expect) {
  const tables = [...(data.evaluation?.tables ?? []), ...(data.tables ?? [])].filter((table) => table.sparklines);
  const drawn = await page.$$eval('table:not(.paper-only) .sparkline', (all) => all.map((e) => ({
    row: e.closest('tr').firstElementChild.textContent, label: e.getAttribute('aria-label'),
    line: e.querySelector('.line.value')?.getAttribute('d') ?? '', band: Boolean(e.querySelector('.band')),
    limits: e.querySelectorAll('.control-limit').length, marks: e.querySelectorAll('.end-mark').length, beyond: e.querySelectorAll('.beyond').length})));
  const wanted = tables.flatMap((table) => table.rows.map((row, i) => ({name: String(row[0]), ...table.sparklines[i]})));
  expect(drawn.length === wanted.length, `${drawn.length} sparklines for ${wanted.length} rows`);
  for (const [k, one] of wanted.entries()) {
    const shown = drawn[k];
    if (!shown) break;
    const values = one.value.filter(isNumber);
    const last = one.value[one.value.length - 1], low = one.control_low?.at(-1), high = one.control_high?.at(-1);
    const beyond = isNumber(low) && isNumber(high) && (last < low || last > high);
    expect(shown.row === one.name && shown.label.startsWith(one.name), `the sparkline of ${one.name} is in the row ${shown.row}`);
    expect(shown.marks === (values.length ? 1 : 0) && shown.beyond === (beyond ? 1 : 0), `${one.name}: the last mark of the sparkline is wrong`);
    expect(shown.band === Boolean(values.length && one.expanded_uncertainty?.some((u) => u > 0)), `${one.name}: the band of the sparkline is wrong`);
    expect(shown.limits === [one.control_low, one.control_high].filter((v) => v?.some(isNumber)).length, `${one.name}: ${shown.limits} limits in the sparkline`);
    const points = [...shown.line.matchAll(/[ML](\S+) ([\d.-]+)/g)].map((m) => [Number(m[1]), Number(m[2])]);
    expect(points.length === (values.length > 1 ? values.length : 0), `${one.name}: ${points.length} points for ${values.length} values`);
    if (points.length < 2) continue;
    // The scale of the two values that are farthest apart holds for all.
    const [from, to] = [values.indexOf(Math.min(...values)), values.indexOf(Math.max(...values))];
    const scale = values[to] > values[from] ? (points[to][1] - points[from][1]) / (values[to] - values[from]) : 0;
    expect(scale <= 0 && points.every((p, i) => Math.abs(p[1] - points[from][1] - scale * (values[i] - values[from])) < 0.21), `${one.name}: the line does not pass through the values`);
  }
}

/// Rotations and uncertainty on the map: own legend, own statistics, one colour scale for both views.
export async function mapChoicesOf(page, data, expect, shot, compareFigures) {
  const heading = await page.textContent('#map-title'), wanted = `Map of the ${data.map.quantity ?? 'volumetric error'}`;
  expect(heading === wanted, `the map is called ${heading}, not ${wanted}`);
  const lead = await page.textContent('#map .lead');
  expect(lead.includes(data.map.quantity ?? 'where the tool really is'), `the map does not say what its arrows show: ${lead}`);
  if (data.map.quantity && data.summary?.map && !data.summary.held_out && !data.summary.verdict) {
    const verdict = await page.textContent('.verdict'), rows = await page.textContent('table.statistics');
    expect(verdict.startsWith(`Mean ${data.map.quantity} `), `the verdict is not on the ${data.map.quantity}: ${verdict}`);
    expect(!rows.includes('fitted again'), `the statistics of the map speak of a fit: ${rows}`);
  }
  const legend = () => page.textContent('.colour-bar .axis-label');
  const bars = await page.locator('.colour-bar svg').count();
  expect(bars === 1, `${bars} colour scales`);
  const statistics = async (stem, wantedCaption) => {
    const keys = await page.$$eval('.map-statistics [data-key]', (all) => all.map((e) => e.dataset.key));
    const table = data.summary?.map?.[stem];
    expect(!table || keys.filter((key) => key.startsWith(`map.${stem}.`)).length === 3, `mean, 95 % and maximum of ${stem} are not beside the map: ${keys}`);
    if (table) {
      const caption = await page.textContent('.map-statistics caption');
      expect(caption.startsWith(wantedCaption), `the table beside the map is called ${caption}, not ${wantedCaption}`);
    }
    await compareFigures('.map-statistics [data-key]');
  };
  await statistics('position_before_um', `Length of the ${data.map.quantity ?? 'displacement of the tool'}`);
  const length = `length of the ${data.map.quantity ?? 'error'} / µm`;
  expect((await legend()) === length, `legend of the map: ${await legend()}, not ${length}`);
  const still = () => page.$eval('.still', (e) => e.src);
  if (data.map.before_urad) {
    const first = await still();
    await page.selectOption('#map-vectors', 'rotation');
    expect(await until(async () => (await legend()).includes('µrad')), `legend of the rotations: ${await legend()}`);
    expect((await page.textContent('.view figcaption .note')).includes('µrad'), 'the rotations have no scale of their own');
    await statistics('orientation_before_urad', 'Angle of the rotation of the tool');
    expect(await until(async () => (await still()) !== first), 'rotations look like displacements');
    await shot(page.locator('#map'), 'rotation');
    await page.selectOption('#map-vectors', 'displacement');
  } else expect((await page.locator('#map-vectors').count()) === 0, 'a choice of arrows without rotations in the data');
  if (data.map.expanded_uncertainty_um) {
    await page.selectOption('#map-colour', 'uncertainty');
    const of = `expanded uncertainty of the ${data.map.quantity ?? 'predicted displacement'} `;
    expect(await until(async () => (await legend()).startsWith(of)), `legend of the uncertainty: ${await legend()}, not ${of}`);
    const last = await page.$$eval('.colour-bar .tick', (all) => Number(all.pop().textContent));
    const largest = Math.max(...data.map.expanded_uncertainty_um);
    expect(last <= largest * 1.001 && last > largest / 3, `colours of the uncertainty end near ${last}, data at ${largest}`);
    await shot(page.locator('#map'), 'uncertainty');
    await page.selectOption('#map-colour', 'length');
  } else expect((await page.locator('#map-colour').count()) === 0, 'a choice of colours without uncertainty in the data');
}

export async function contentOf(page, data, expect) {
  await residualsOf(page, data, expect);
  await monteCarloOf(page, data, expect);
  await sparklinesOf(page, data, expect);
  await listsOf(page, data, expect);
}
