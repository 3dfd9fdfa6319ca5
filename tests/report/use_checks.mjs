// The page on paper, with a keyboard and for a screen reader.
import {layoutFaults} from './layout_checks.mjs';
import {settled} from './until.mjs';

const kSheetWidth = 680;

/// As on paper: sheet width, print media, after the event that browsers send before printing.
export async function paperOf(page, data, expect) {
  await page.setViewportSize({width: kSheetWidth, height: 1000});
  await page.emulateMedia({media: 'print'});
  await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
  await settled(page);
  // An image that cannot be read is seen below.
  await page.evaluate(() => Promise.allSettled([...document.querySelectorAll('.still')].map((e) => e.decode())));
  const sheet = await page.evaluate(() => {
    const shown = (e) => getComputedStyle(e).display !== 'none';
    return {
      inner: document.documentElement.scrollWidth, outer: document.documentElement.clientWidth,
      cut: [...document.querySelectorAll('.scroll')].filter((e) => e.scrollHeight > e.clientHeight + 2 || e.scrollWidth > e.clientWidth + 2)
        .map((e) => `${e.getAttribute('aria-label')} ${e.scrollWidth}/${e.clientWidth}`),
      canvases: [...document.querySelectorAll('.stage canvas')].filter(shown).length,
      stills: [...document.querySelectorAll('.still')].map((e) => shown(e) && e.complete && e.naturalWidth > 200),
      controls: [...document.querySelectorAll('button,input,select,nav')].filter((e) => shown(e) && e.getClientRects().length).length,
      heads: [...document.querySelectorAll('.parameters thead th')].map((e) => [...e.children].filter(shown).map((c) => c.textContent).join('')),
      // A drawing made for another width would be shrunk, its letters with it.
      shrunk: [...document.querySelectorAll('.drawing > svg')].filter((e) => e.getClientRects().length && Math.abs(e.viewBox.baseVal.width - e.clientWidth) > 3).length,
      background: getComputedStyle(document.body).backgroundColor,
      closed: document.querySelectorAll('details:not([open])').length,
    };
  });
  expect(sheet.inner <= sheet.outer, `${sheet.inner} px wide on a sheet of ${sheet.outer} px`);
  expect(sheet.cut.length === 0, `cut on paper: ${sheet.cut}`);
  expect(sheet.canvases === 0, `${sheet.canvases} canvases instead of images on paper`);
  const stills = (data.map ? (data.map.after_um ? 2 : 1) : 0) + (data.surface?.values ? 1 : 0) + (data.path?.time_s?.length ? 1 : 0);
  expect(sheet.stills.length === stills && sheet.stills.every(Boolean), `images of the map on paper: ${sheet.stills}`);
  expect(sheet.controls === 0, `${sheet.controls} controls on paper`);
  expect(!data.parameters || (sheet.heads.length > 3 && sheet.heads.every((text) => text.length > 0)), `heads of the parameters on paper: ${sheet.heads}`);
  expect(sheet.shrunk === 0, `${sheet.shrunk} drawings not made for the sheet`);
  expect(sheet.background === 'rgb(255, 255, 255)', `paper is ${sheet.background}`);
  expect(sheet.closed === 0, `${sheet.closed} closed parts on paper`);
  for (const fault of await page.evaluate(layoutFaults)) expect(false, `on paper: ${fault}`);
  await page.evaluate(() => window.dispatchEvent(new Event('afterprint')));
  await page.emulateMedia({media: null});
  await page.setViewportSize({width: 1280, height: 900});
  await settled(page);
  expect((await page.locator(':root.printing').count()) === 0, 'the layout of the sheet stays after printing');
}

/// Everything that can be used can be reached by the Tab key and shows that it has the focus.
export async function keyboardOf(page, expect) {
  // From the top, wherever the last click was.
  await page.evaluate(() => {
    document.body.tabIndex = -1;
    document.body.focus();
    document.body.removeAttribute('tabindex');
  });
  const wanted = await page.evaluate(() => {
    const all = [...document.querySelectorAll('a[href],button,input,select,[tabindex="0"]')].filter((e) => e.getClientRects().length && !e.disabled);
    all.forEach((e, i) => (e.dataset.stop = String(i)));
    window.stops = [];
    document.addEventListener('focusin', ({target: e}) => {
      const style = getComputedStyle(e);
      window.stops.push({stop: e.dataset.stop, name: e.outerHTML.slice(0, 60), visible: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 1.5});
    });
    return all.length;
  });
  for (let i = 0; i < wanted + 8; ++i) await page.keyboard.press('Tab');
  const stops = (await page.evaluate(() => window.stops)).filter((at) => at.stop !== undefined);
  const reached = new Set(stops.map((at) => at.stop));
  const dark = stops.filter((at) => !at.visible).map((at) => at.name);
  expect(stops[0]?.name.includes('skip'), `the first stop of the Tab key is ${stops[0]?.name}`);
  expect(reached.size === wanted, `the Tab key reaches ${reached.size} of ${wanted} elements`);
  expect(dark.length === 0, `focus not visible: ${dark[0]}`);

  const spoken = await page.evaluate(() => ({
    sections: [...document.querySelectorAll('section')].filter((e) => !document.getElementById(e.getAttribute('aria-labelledby'))?.textContent).map((e) => e.id),
    tables: [...document.querySelectorAll('table')].filter((e) => !e.caption?.textContent).length,
    heads: [...document.querySelectorAll('thead th')].filter((e) => !e.scope).length,
    drawings: [...document.querySelectorAll('svg[role=img],canvas,img')].filter((e) => !(e.getAttribute('aria-label') ?? e.getAttribute('alt'))).length,
    regions: [...document.querySelectorAll('[role=region]')].filter((e) => !e.getAttribute('aria-label')).length,
    levels: [...document.querySelectorAll('h1,h2,h3')].map((e) => Number(e.tagName[1])),
    language: document.documentElement.lang,
  }));
  expect(spoken.sections.length === 0, `sections without a name: ${spoken.sections}`);
  expect(spoken.tables === 0, `${spoken.tables} tables without a caption`);
  expect(spoken.heads === 0, `${spoken.heads} column heads without a scope`);
  expect(spoken.drawings === 0, `${spoken.drawings} drawings without words`);
  expect(spoken.regions === 0, `${spoken.regions} regions without a name`);
  expect(spoken.levels.filter((level) => level === 1).length === 1, 'not exactly one heading of the first level');
  expect(spoken.language === 'en', 'the language is not stated');

  const motion = async (reducedMotion) => {
    await page.emulateMedia({reducedMotion});
    return page.evaluate(() => getComputedStyle(document.documentElement).scrollBehavior);
  };
  expect((await motion('no-preference')) === 'smooth', 'no smooth scrolling');
  expect((await motion('reduce')) === 'auto', 'moves although the reader wants no motion');
  await page.emulateMedia({reducedMotion: null});
}
