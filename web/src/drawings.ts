// Drawings that the producer made: SVG in the colours of the page, in a second layout for narrow windows.

import {html} from './dom';
import {prose} from './format';

/// An SVG document as an element of the page, without the scripts that are in it.
function picture(text: string, caption: string | undefined): SVGSVGElement | undefined {
  const root = new DOMParser().parseFromString(text, 'image/svg+xml').documentElement as unknown as SVGSVGElement;
  if (root.nodeName !== 'svg') return undefined;
  for (const element of [root, ...root.querySelectorAll('*')]) {
    if (element.nodeName === 'script' || element.nodeName === 'foreignObject') element.remove();
    for (const name of element.getAttributeNames()) if (/^on|href$/i.test(name)) element.removeAttribute(name);
    if (element.nodeName === 'text' && element.textContent) element.textContent = prose(element.textContent).replace(/(^| in )u(m|rad)$/, '$1µ$2');
  }
  if (!root.getAttribute('role')) root.setAttribute('role', 'img');
  if (!root.getAttribute('aria-label')) root.setAttribute('aria-label', root.querySelector('title')?.textContent || caption || 'Drawing');
  return document.importNode(root, true);
}

/// @param wide    for a wide window and for paper
/// @param narrow  the same for a narrow window; without it the wide one is moved sideways, as letters would become too small
/// @param beside  it is narrow itself and stands beside others
export function drawing(wide: string, narrow: string | undefined, caption: string | undefined, beside = false): HTMLElement | undefined {
  const large = picture(wide, caption);
  if (!large) return undefined;
  const words = caption ? html('figcaption', {}, caption) : undefined;
  if (beside) return html('figure', {class: 'made beside'}, large, words);
  const small = narrow ? picture(narrow, caption) : undefined;
  const width = large.viewBox?.baseVal.width ?? 0;
  if (!small) {
    if (width > 0) large.style.minWidth = `${Math.round(kLeast * width)}px`;
    return html('figure', {class: 'made'}, html('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption || 'Drawing'}, large), words);
  }
  small.classList.add('narrow');
  large.classList.add('wide');
  return html('figure', {class: `made in-two ${width > 700 ? 'large' : ''}`}, large, small, words);
}

/// A drawing without a narrow layout keeps this share of its size.
const kLeast = 0.85;
