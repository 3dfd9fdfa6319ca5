// What the measurement cannot see, and which additional measurement would show it.

import {Advice} from './data';
import {html, section} from './dom';

export function adviceSection(advice: Advice[]): HTMLElement {
  const part = section('advice', 'What the measurement cannot see',
    'Parameters that these readings do not determine, or hardly, and the additional measurement that would show them.');
  part.append(html('ol', {class: 'advice-list'}, ...advice.map((entry) => html('li', {},
    html('p', {}, entry.text),
    entry.remedy && html('p', {class: 'remedy'}, html('b', {}, 'To see it: '), entry.remedy),
    !!entry.parameters?.length && html('code', {}, entry.parameters.join('  '))))));
  return part;
}
