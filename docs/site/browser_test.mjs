// Opens the site from file:// in headless Chromium: the search, and every page as a reader sees it.
//   node browser_test.mjs --web WEB_DIR --site FOLDER [--shots FOLDER]
// WEB_DIR has playwright-core among its packages. --shots leaves pictures of some pages, to be looked at.
// Exit code 77: Chromium is not installed, or the site was not built; nothing was tested.
import {existsSync, mkdirSync, readdirSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join, relative, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const options = {web: '', site: '', shots: ''};
for (let i = 2; i < process.argv.length; i += 2) options[process.argv[i].slice(2)] = resolve(process.argv[i + 1]);
const chromiumPath = process.env.ABBE_CHROMIUM ?? '/usr/bin/chromium';
for (const [path, what] of [
  [chromiumPath, 'Chromium (set ABBE_CHROMIUM)'],
  [join(options.site, 'index.html'), 'site'],
]) {
  if (existsSync(path)) continue;
  console.log(`SKIPPED: there is no ${what} at ${path}`);
  process.exit(77);
}
const {chromium} = createRequire(join(options.web, 'package.json'))('playwright-core');

const failures = [];
const check = (good, text) => {
  if (!good) failures.push(text);
};
const urlOf = (page) => pathToFileURL(join(options.site, page)).href;
const root = `${pathToFileURL(options.site).href}/`;
const pages = readdirSync(options.site, {recursive: true})
  .map(String)
  .filter((name) => name.endsWith('.html'))
  .sort();

const browser = await chromium.launch({
  executablePath: chromiumPath,
  args: [
    '--headless',
    '--no-sandbox',
    '--disable-gpu',
    '--disable-background-networking',
    '--no-first-run',
    '--disable-component-update',
    '--disable-sync',
  ],
});
const context = await browser.newContext({
  viewport: {width: 1280, height: 900},
  offline: true,
  reducedMotion: 'reduce',
});
const page = await context.newPage();
const where = () => relative(options.site, decodeURI(new URL(page.url()).pathname));
page.on('console', (message) => {
  if (['error', 'warning'].includes(message.type())) check(false, `${where()}: console: ${message.text()}`);
});
page.on('pageerror', (error) => check(false, `${where()}: exception: ${error.message}`));
page.on('request', (request) => {
  if (!request.url().startsWith(root) && !request.url().startsWith('data:'))
    check(false, `${where()}: request of ${request.url()}`);
});
page.on('requestfailed', (request) => {
  if (request.failure()?.errorText !== 'net::ERR_ABORTED')
    check(false, `${where()}: ${request.url()}: ${request.failure()?.errorText}`);
});

/// Types a query where a reader does, and returns the results.
async function search(from, query) {
  await page.goto(urlOf(from));
  await page.locator('.sidebar-search').fill(query);
  await page.keyboard.press('Enter');
  await page.waitForURL(/search\.html\?q=/);
  await page.waitForFunction(() =>
    /Search finished|did not match/.test(document.querySelector('.search-summary')?.textContent ?? ''),
  );
  return page.$$eval('#search-results li', (all) =>
    all.map((e) => ({
      title: e.querySelector('a').textContent,
      href: e.querySelector('a').href,
      excerpt: e.querySelector('.excerpt')?.textContent ?? '',
      marked: [...e.querySelectorAll('.excerpt mark')].map((mark) => mark.textContent.toLowerCase()),
    })),
  );
}

/// [from, query, what the first result leads to]
const kQueries = [
  ['index.html', 'ball bar', 'docs/ball-bar.html'],
  ['docs/tutorial.html', 'squareness', 'squareness'],
  ['docs/runtime.html', 'CompensatedInverse', 'reference/python/inverse.html'],
  ['reference/python/index.html', 'Machine.from_chain', 'reference/python/machine.html#abbe.Machine.from_chain'],
  ['docs/fits.html', 'minimum zone', 'docs/fits.html'],
];
async function searches() {
  for (const [from, query, wanted] of kQueries) {
    const results = await search(from, query);
    check(results.length > 0, `search for '${query}': no results`);
    const first = results.slice(0, 3).map((result) => `${result.href.slice(root.length)} ${result.title}`);
    check(
      first.some((text) => text.toLowerCase().includes(wanted.toLowerCase())),
      `search for '${query}': expected ${wanted} among ${first.join('; ')}`,
    );
    const texts = results.filter((result) => result.excerpt);
    check(
      !results.some((result) => /docs\/.*\.html$/.test(result.href)) || texts.length > 0,
      `search for '${query}': no excerpts`,
    );
    check(
      texts.every((result) => result.marked.length > 0),
      `search for '${query}': an excerpt without the words`,
    );
  }
  // A result opens the page that it names.
  const [result] = await search('index.html', 'Machine.from_chain');
  await page.click('#search-results li a');
  await page.waitForURL((url) => !url.pathname.endsWith('search.html'));
  check(
    page.url().split('?')[0] === result.href.split('?')[0] || page.url().startsWith(result.href.split('#')[0]),
    `a result leads to ${page.url()}, not to ${result.href}`,
  );
  check(
    await page.locator('[id="abbe.Machine.from_chain"]').isVisible(),
    'the first result does not show what was looked for',
  );
  const nothing = await search('index.html', 'zzyzxqq');
  check(nothing.length === 0, 'the search finds what is nowhere');
  // Without a mouse: the first stop skips the navigation, "/" goes to the search.
  await page.goto(urlOf('docs/tutorial.html'));
  await page.keyboard.press('Tab');
  const stop = await page.evaluate(() => [
    document.activeElement.textContent.trim(),
    document.activeElement.getAttribute('href'),
  ]);
  check(stop[1] === '#furo-main-content', `the first stop of the Tab key is '${stop[0]}'`);
  await page.keyboard.press('/');
  check(
    await page.evaluate(() => document.activeElement.classList.contains('sidebar-search')),
    'the key / does not lead to the search',
  );
}

/// What is wrong with the layout: a page that is moved sideways, text that a reader cannot reach, images without words.
const faultsOfLayout = () => {
  const faults = [];
  const width = document.documentElement.clientWidth;
  const scrolls = (e) => {
    for (; e && e !== document.body; e = e.parentElement)
      if (/auto|scroll/.test(getComputedStyle(e).overflowX)) return true;
    return false;
  };
  if (document.documentElement.scrollWidth > width) faults.push(`${document.documentElement.scrollWidth} px wide`);
  for (const e of document.querySelectorAll('article *')) {
    const box = e.getBoundingClientRect();
    if (box.width && box.right > width + 1 && !scrolls(e)) {
      faults.push(
        `<${e.tagName.toLowerCase()} class="${e.getAttribute('class') ?? ''}"> ends at ${Math.round(box.right)} px: ` +
          e.textContent.trim().slice(0, 40),
      );
      break;
    }
  }
  for (const e of document.images) {
    if (!e.alt.trim()) faults.push(`an image without words: ${e.getAttribute('src')}`);
    if (!e.complete || !e.naturalWidth) faults.push(`an image that is not shown: ${e.getAttribute('src')}`);
  }
  if (document.querySelectorAll('h1').length !== 1 && !document.getElementById('search-results'))
    faults.push('not one heading of the first level');
  return faults;
};

/// Contrast of running text with what is behind it below 4.5 (WCAG 2.1).
const lowContrast = () => {
  const light = (colour) => {
    const [r, g, b] = colour
      .match(/[\d.]+/g)
      .map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const found = new Set();
  for (const e of document.querySelectorAll('article *, .sidebar-tree a, .toc-tree a, footer *')) {
    if (![...e.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim()) || !e.getClientRects().length)
      continue;
    let behind = e;
    while (behind && /rgba\(0, 0, 0, 0\)|transparent/.test(getComputedStyle(behind).backgroundColor))
      behind = behind.parentElement;
    const a = light(getComputedStyle(e).color),
      b = light(behind ? getComputedStyle(behind).backgroundColor : 'rgb(255,255,255)');
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5 && !e.closest('.headerlink'))
      found.add(`${e.tagName.toLowerCase()}.${e.className}: ${ratio.toFixed(1)}`);
  }
  return [...found].slice(0, 6);
};

/// Formulas are set as such: no command of TeX is left, and 1/2 is a half.
async function formulas() {
  await page.goto(urlOf('docs/evaluate.html'));
  const texts = await page.$$eval('article math', (all) => all.map((e) => e.textContent));
  const left = texts.filter((text) => /[\\{}$]/.test(text));
  check(
    texts.length > 40 && !left.length,
    `${texts.length} formulas, of which with commands of TeX: ${left.slice(0, 2).join('; ')}`,
  );
  const fractions = await page.$$eval('article mfrac', (all) =>
    all.map((e) => [...e.children].map((part) => part.textContent)),
  );
  check(
    fractions.some(([above, below]) => above === '1' && below === '2') && !fractions.flat().includes('('),
    `fractions: ${fractions.map((parts) => parts.join('/')).join(' ')}`,
  );
}

async function everyPageInANarrowWindow() {
  await page.setViewportSize({width: 360, height: 800});
  for (const name of pages) {
    await page.goto(urlOf(name));
    for (const fault of await page.evaluate(faultsOfLayout)) check(false, `${name}, 360 px: ${fault}`);
  }
}

const kSamples = [
  'index.html',
  'docs/evaluate.html',
  'docs/formats.html',
  'reference/python/machine.html',
  'reference/cpp/geometry.html',
  'python/notebooks/quick_start.html',
];
async function themesAndPaper() {
  await page.setViewportSize({width: 1280, height: 900});
  for (const name of kSamples) {
    const backgrounds = [];
    for (const scheme of ['light', 'dark']) {
      await page.emulateMedia({colorScheme: scheme});
      await page.goto(urlOf(name));
      backgrounds.push(
        await page.evaluate(
          () =>
            getComputedStyle(document.querySelector('.page')).backgroundColor +
            getComputedStyle(document.body).backgroundColor,
        ),
      );
      for (const fault of await page.evaluate(lowContrast)) check(false, `${name}, ${scheme}: low contrast: ${fault}`);
      for (const fault of await page.evaluate(faultsOfLayout)) check(false, `${name}, 1280 px: ${fault}`);
    }
    check(backgrounds[0] !== backgrounds[1], `${name}: does not follow the system to dark`);
    // What a reader chooses stays, on the next page too.
    await page.emulateMedia({colorScheme: 'light', media: 'print'});
    await page.setViewportSize({width: 680, height: 900}); // A4 less its margins
    const shown = await page.evaluate(() =>
      ['.sidebar-drawer', '.mobile-header', '.toc-drawer', '.theme-toggle'].filter((each) =>
        [...document.querySelectorAll(each)].some((e) => e.getClientRects().length),
      ),
    );
    check(!shown.length, `${name}: on paper there is ${shown.join(', ')}`);
    for (const fault of await page.evaluate(faultsOfLayout)) check(false, `${name}, on paper: ${fault}`);
    const cut = await page.evaluate(() =>
      [...document.querySelectorAll('article pre, .table-wrapper')]
        .filter((e) => e.scrollWidth > e.clientWidth + 1)
        .map((e) => e.textContent.trim().slice(0, 40)),
    );
    check(!cut.length, `${name}: on paper the end of lines is cut off: ${cut.slice(0, 2).join('; ')}`);
    await page.emulateMedia({media: 'screen'});
    await page.setViewportSize({width: 1280, height: 900});
  }
  await page.emulateMedia({colorScheme: 'light'});
  await page.goto(urlOf('index.html'));
  const theme = () => page.evaluate(() => document.body.dataset.theme);
  const before = await theme();
  await page.locator('.theme-toggle:visible').first().click();
  const chosen = await theme();
  check(
    before === 'auto' && ['light', 'dark'].includes(chosen),
    `the button of the theme makes ${chosen} of ${before}`,
  );
  await page.goto(urlOf('docs/tutorial.html'));
  check((await theme()) === chosen, 'the theme that was chosen is forgotten on the next page');
  await page.evaluate(() => localStorage.removeItem('theme'));
}

async function pictures() {
  mkdirSync(options.shots, {recursive: true});
  for (const name of [...kSamples, 'search.html?q=squareness']) {
    for (const [width, scheme] of [
      [1280, 'light'],
      [1280, 'dark'],
      [360, 'light'],
      [360, 'dark'],
    ]) {
      await page.setViewportSize({width, height: 1400});
      await page.emulateMedia({colorScheme: scheme});
      await page.goto(name.includes('?') ? `${root}${name}` : urlOf(name));
      await page.waitForTimeout(name.includes('?') ? 1500 : 0);
      await page.screenshot({path: join(options.shots, `${name.replace(/\W/g, '-')}-${width}-${scheme}.png`)});
    }
    await page.emulateMedia({colorScheme: 'light'});
    await page.pdf({path: join(options.shots, `${name.replace(/\W/g, '-')}.pdf`), format: 'A4'});
  }
}

try {
  await searches();
  await formulas();
  await everyPageInANarrowWindow();
  await themesAndPaper();
  if (options.shots) await pictures();
} finally {
  await browser.close();
}
console.log(`${pages.length} pages, ${kQueries.length + 2} searches`);
for (const failure of failures) console.error(`FAILED ${failure}`);
process.exit(failures.length ? 1 : 0);
