// Elements of the page and of drawings.

type Attributes = Record<string, string | number | boolean | undefined>;
type Child = Node | string | undefined | null | false;

function fill(element: Element, attributes: Attributes, children: Child[]): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    element.setAttribute(name, value === true ? '' : String(value));
  }
  for (const child of children) if (child) element.append(child);
}

export function html<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  fill(element, attributes, children);
  return element;
}

/// Letters of the name of an axis, px, in a wide font.
const kLetter = 6.4;

/// The name of an axis in one line, or in two of about the same length where there is too little room.
export function axisLabelLines(text: string, room: number): string[] {
  if (kLetter * text.length <= room) return [text];
  const spaces = [...text.matchAll(/ /g)].map((match) => match.index!);
  if (!spaces.length) return [text];
  const middle = spaces.reduce((best, at) => (Math.abs(at - text.length / 2) < Math.abs(best - text.length / 2) ? at : best));
  return [text.slice(0, middle + 1), text.slice(middle + 1)];
}

/// Those lines, the last one at `y`, all ending at `x`.
export function axisLabel(lines: string[], x: number, y: number): SVGTextElement {
  return svg('text', {x, y: y - kLine * (lines.length - 1), class: 'axis-label end'}, ...lines.map((line, i) => svg('tspan', {x, dy: i ? kLine : 0}, line)));
}

/// From line to line of the name of an axis, px.
export const kLine = 13;

const redraws: (() => void)[] = [];

/// Drawings are made for a sheet of paper; see print.ts.
export function isPrinting(): boolean {
  return document.documentElement.classList.contains('printing');
}

/// Makes every drawing on the page again for its present width.
export function redrawAll(): void {
  for (const redraw of redraws) redraw();
}

/// Draws into a box now and again whenever its width changes, so that letters keep their size.
export function responsive(box: HTMLElement, draw: (width: number) => Element): () => void {
  let drawn = 0;
  const redraw = (force: boolean) => {
    const width = Math.round(box.clientWidth);
    if (width < 40 || (!force && Math.abs(width - drawn) < 2)) return;
    drawn = width;
    box.replaceChildren(draw(width));
  };
  new ResizeObserver(() => redraw(false)).observe(box);
  redraws.push(() => redraw(false));
  return () => redraw(true);
}

export function section(id: string, title: string, lead?: string): HTMLElement {
  return html(
    'section',
    {id, 'aria-labelledby': `${id}-title`},
    html('h2', {id: `${id}-title`}, title),
    lead && html('p', {class: 'lead'}, lead),
  );
}

/// A control with its label, kept together on one line.
export function field(text: string, control: HTMLElement, ...more: Child[]): HTMLElement {
  return html('span', {class: 'field'}, html('label', {for: control.id}, text), control, ...more);
}

export function figure(caption: string, ...children: Child[]): HTMLElement {
  return html('figure', {}, ...children, html('figcaption', {}, caption));
}
