// The colour scale of signed deviations, with what lies beyond it.

import {cssColour} from './colour';
import {divergingColour, kBeyondAbove, kBeyondBelow, kNothing} from './diverging';
import {html, responsive, svg} from './dom';
import {quantity} from './format';
import {linearScale} from './scale';

export function deviationBar(limit: () => number, hasGaps: boolean): {box: HTMLElement; redraw: () => void} {
  const box = html('div', {class: 'colour-bar'});
  const redraw = responsive(box, (width) => {
    const end = limit();
    // Its two notes stand side by side only where there is room.
    const narrow = width < 520;
    const height = hasGaps && narrow ? 64 : 48;
    const inner: [number, number] = [74, width - 74];
    const scale = linearScale([-end, end], inner, Math.min(6, (inner[1] - inner[0]) / 44));
    const root = svg('svg', {viewBox: `0 0 ${width} ${height}`, width, height, role: 'img',
      'aria-label': `Colour scale, deviation from ${quantity(-end, 'µm')} to ${quantity(end, 'µm')}; beyond it lighter colours`});
    const stops = svg('linearGradient', {id: 'diverging'});
    for (let i = 0; i <= 20; ++i)
      stops.append(svg('stop', {offset: `${5 * i}%`, 'stop-color': cssColour(divergingColour(end * (i / 10 - 1), end))}));
    root.append(svg('defs', {}, stops),
      svg('rect', {x: inner[0], y: 4, width: Math.max(1, inner[1] - inner[0]), height: 10, fill: 'url(#diverging)'}),
      svg('rect', {x: inner[0] - 26, y: 4, width: 22, height: 10, fill: cssColour(kBeyondBelow)}),
      svg('rect', {x: inner[1] + 4, y: 4, width: 22, height: 10, fill: cssColour(kBeyondAbove)}),
      svg('text', {x: inner[0] - 30, y: 13, class: 'tick end'}, 'below'),
      svg('text', {x: inner[1] + 30, y: 13, class: 'tick'}, 'above'));
    for (const tick of scale.ticks) {
      const x = scale(tick);
      root.append(svg('line', {x1: x, x2: x, y1: 14, y2: 18, class: 'mark'}), svg('text', {x, y: 29, class: 'tick middle'}, scale.label(tick)));
    }
    root.append(svg('text', {x: narrow ? width - 4 : inner[1], y: 44, class: 'axis-label end'}, 'deviation / µm, positive outside of the material'));
    if (hasGaps)
      root.append(svg('rect', {x: 2, y: height - 13, width: 14, height: 10, fill: cssColour(kNothing)}), svg('text', {x: 21, y: height - 4, class: 'tick'}, 'fewer than 3 points near'));
    return root;
  });
  return {box, redraw};
}
