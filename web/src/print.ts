// On paper the page is as wide as the paper: drawings are made again for that width, so that letters keep their size.

import {redrawAll} from './dom';

export function preparePrint(): void {
  const root = document.documentElement;
  window.addEventListener('beforeprint', () => {
    root.classList.add('printing');
    redrawAll();
  });
  window.addEventListener('afterprint', () => {
    root.classList.remove('printing');
    redrawAll();
  });
}
