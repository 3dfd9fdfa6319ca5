// Drawings that the producer made: SVG in the colours of the page.

import {html} from './dom';

/// @param text  an SVG document; scripts in it are left out
export function drawing(text: string, caption: string | undefined): HTMLElement | undefined {
  const root = new DOMParser().parseFromString(text, 'image/svg+xml').documentElement as unknown as SVGSVGElement;
  if (root.nodeName !== 'svg') return undefined;
  for (const element of [root, ...root.querySelectorAll('*')]) {
    if (element.nodeName === 'script' || element.nodeName === 'foreignObject') element.remove();
    for (const name of element.getAttributeNames()) if (/^on|href$/i.test(name)) element.removeAttribute(name);
  }
  if (!root.getAttribute('role')) root.setAttribute('role', 'img');
  if (!root.getAttribute('aria-label')) root.setAttribute('aria-label', root.querySelector('title')?.textContent || caption || 'Drawing');
  // On a narrow screen it keeps three quarters of its size and is moved sideways: letters smaller than 9 pixels cannot be read.
  const width = root.viewBox?.baseVal.width ?? 0;
  if (width > 0) root.style.minWidth = `${Math.round(0.74 * width)}px`;
  return html('figure', {class: 'made'}, html('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption || 'Drawing'}, document.importNode(root, true)), caption ? html('figcaption', {}, caption) : undefined);
}
