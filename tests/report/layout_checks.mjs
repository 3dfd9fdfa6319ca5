// What a reader sees of the layout at one width: nothing wider than the window, no text over another, no number broken across lines, no
// letters of drawings that are too small.

/// Runs in the page. Faults in words; empty if there are none.
export function layoutFaults() {
  const kLeastLetters = 9.9;
  const faults = [];
  const name = (text) => `"${text.trim().replace(/\s+/g, ' ').slice(0, 40)}"`;
  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth) faults.push(`${root.scrollWidth} px wide in a window of ${root.clientWidth} px`);

  const scrolls = new Map();
  /// The box that an element is cut at: one that scrolls or hides what is outside; null: the window.
  const cutAt = (element) => {
    if (!element) return null;
    if (scrolls.has(element)) return scrolls.get(element);
    const style = getComputedStyle(element);
    const found = style.overflowX !== 'visible' && element !== document.body && element !== root ? element : cutAt(element.parentElement);
    scrolls.set(element, found);
    return found;
  };
  const closed = (element) => element.closest('[hidden],.unseen,.skip,.pad,noscript,script,style,title,option') || !element.getClientRects().length;

  // Lines of text on the page, each with the box that its letters fill.
  const lines = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (!node.data.trim() || closed(parent)) continue;
    const style = getComputedStyle(parent);
    if (style.visibility === 'hidden' || style.opacity === '0') continue;
    const drawing = parent.closest('svg');
    range.selectNodeContents(node);
    for (const box of range.getClientRects()) {
      if (box.width < 2 || box.height < 2) continue;
      const holder = cutAt(parent);
      if (!holder && !drawing && (box.right > root.clientWidth + 1 || box.left < -1)) faults.push(`${name(node.data)} ends at ${Math.round(box.right)} px outside of the window`);
      // Rows of tables in a box that scrolls may be outside of it; they are there all the same.
      lines.push({box, text: node.data, drawing, holder, parent, cut: false});
    }
    if (drawing) {
      // Drawings are made for their width or scaled; paper has more dots than a screen.
      const scale = parent.getScreenCTM();
      const letters = parseFloat(style.fontSize) * Math.hypot(scale.a, scale.b);
      if (letters < kLeastLetters && !matchMedia('print').matches) faults.push(`${name(node.data)} has letters of ${letters.toFixed(1)} px`);
      const outer = drawing.getBoundingClientRect();
      range.selectNodeContents(node);
      const box = range.getBoundingClientRect();
      if (box.left < outer.left - 1.5 || box.right > outer.right + 1.5 || box.top < outer.top - 2 || box.bottom > outer.bottom + 3)
        faults.push(`${name(node.data)} is cut at the edge of its drawing`);
    }
    // A number and its sign stay on one line; those in names of files and dates are none.
    if (!drawing) {
      for (const match of node.data.matchAll(/(?<![\w/.-])[\u2212+-]?\d[\d.,\u202f\u2009]*(?:e[\u2212+-]?\d+)?(?:[\u202f\u2009]·[\u202f\u2009]10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?(?![\w/])/g)) {
        if (match[0].length < 2 || match[0].length > 24) continue;
        range.setStart(node, match.index);
        range.setEnd(node, match.index + match[0].replace(/[.,]$/, '').length);
        const tops = new Set([...range.getClientRects()].filter((box) => box.width > 0.5).map((box) => Math.round(box.top / 4)));
        if (tops.size > 1) faults.push(`the number ${name(match[0])} is broken across lines in ${name(node.data)}`);
      }
    }
  }
  // Words over each other. Letters do not fill the height of their line.
  const core = ({box}) => ({left: box.left + 1, right: box.right - 1, top: box.top + 0.22 * box.height, bottom: box.bottom - 0.22 * box.height});
  const cores = lines.map(core);
  const order = lines.map((_, i) => i).sort((a, b) => cores[a].top - cores[b].top);
  const bar = document.querySelector('.bar');
  let found = 0;
  for (let m = 0; m < order.length && found < 12; ++m) {
    const a = cores[order[m]];
    for (let n = m + 1; n < order.length && cores[order[n]].top < a.bottom; ++n) {
      const b = cores[order[n]];
      const [first, second] = [lines[order[m]], lines[order[n]]];
      if (a.right <= b.left || b.right <= a.left || first.holder !== second.holder) continue;
      if (bar?.contains(first.parent) !== bar?.contains(second.parent)) continue;
      // The head of a table stays in view while its rows go by.
      if (Boolean(first.parent.closest('thead')) !== Boolean(second.parent.closest('thead')) && first.holder) continue;
      faults.push(`${name(first.text)} and ${name(second.text)} cover each other`);
      if (++found === 12) break;
    }
  }
  for (const box of document.querySelectorAll('figure .scroll'))
    if (box.querySelector('svg') && box.scrollWidth > box.clientWidth + 1) faults.push(`the drawing ${name(box.getAttribute('aria-label') ?? '')} is moved sideways`);
  // A few words on many lines make a row that is mostly empty.
  for (const cell of document.querySelectorAll('td,th')) {
    if (closed(cell)) continue;
    range.selectNodeContents(cell);
    const lines = new Set([...range.getClientRects()].filter((box) => box.width > 1).map((box) => Math.round(box.bottom / 4))).size;
    const letters = cell.textContent.trim().length;
    if (lines > 4 && letters < 9 * lines) faults.push(`the cell ${name(cell.textContent)} has ${letters} letters on ${lines} lines`);
  }
  // In a wide window only a table of many columns scrolls.
  for (const box of document.querySelectorAll('.scroll')) {
    const columns = box.querySelectorAll('table:first-of-type thead th').length;
    if (root.clientWidth > 1200 && columns > 0 && columns < 10 && box.scrollWidth > box.clientWidth + 1) faults.push(`the ${columns} columns of ${name(box.getAttribute('aria-label') ?? '')} do not fit`);
  }
  // Where a head stays in view while its table scrolls sideways, the names of the rows do as well.
  for (const table of document.querySelectorAll('.scroll table')) {
    const sticks = (cell) => cell && getComputedStyle(cell).position === 'sticky' && getComputedStyle(cell).left !== 'auto';
    const row = table.querySelector('tbody tr');
    const head = table.querySelector('thead th');
    if (row && head?.getClientRects().length && sticks(head) !== sticks(row.firstElementChild))
      faults.push(`the head and the first cells of ${name(table.caption?.textContent ?? 'a table')} do not stay in view together`);
  }
  // What is divided finer than its numbers are written repeats them.
  for (const drawing of document.querySelectorAll('svg')) {
    if (!drawing.getClientRects().length) continue;
    const columns = new Map();
    for (const tick of drawing.querySelectorAll('.tick')) {
      const box = tick.getBoundingClientRect();
      if (!box.width) continue;
      const key = tick.classList.contains('middle') ? `y ${Math.round(box.top)}` : `x ${Math.round(box.right)}`;
      const texts = columns.get(key) ?? [];
      if (tick.textContent && texts.includes(tick.textContent)) faults.push(`the tick ${name(tick.textContent)} stands twice on one axis`);
      texts.push(tick.textContent);
      columns.set(key, texts);
    }
  }
  return [...new Set(faults)];
}
