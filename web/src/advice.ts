// What the measurement cannot see, and which additional measurement would show it.

import {Advice, NotIdentified} from './data';
import {html, section} from './dom';
import {prose} from './format';

/// What lacks a measurement first; conventions and matters of the set-up need none.
const kOrder = ['not measured', 'weak', 'convention', 'datum', 'set-up'];
const needsNone = (entry: Advice) => ['convention', 'datum', 'set-up'].includes(entry.kind ?? '');

export function adviceSection(advice: Advice[], missing?: NotIdentified): HTMLElement {
  const part = section('advice', 'What the measurement cannot see',
    'Parameters that these readings do not determine, or hardly, and the additional measurement that would show them, ' +
    'tried with simulated readings.');
  const sorted = [...advice].sort((a, b) => kOrder.indexOf(a.kind ?? '') - kOrder.indexOf(b.kind ?? ''));
  if (advice.length) part.append(html('ol', {class: 'advice-list'}, ...sorted.map((entry) => html('li', {},
    html('p', {}, prose(entry.text)),
    entry.words && html('p', {}, entry.words),
    entry.remedy && html('p', {class: 'remedy'}, html('b', {}, needsNone(entry) ? 'Measurement: ' : 'To see it: '),
      entry.remedy),
    !!entry.parameters?.length && html('code', {}, entry.parameters.join('  '))))));
  if (missing) part.append(html('h3', {}, 'Errors that were not identified'), html('p', {}, prose(missing.text)),
    html('ul', {class: 'plain not-identified'}, ...(missing.shown_by ?? []).map((entry) => html('li', {},
      html('p', {class: 'remedy'}, html('code', {}, entry.errors.join('  ')), html('b', {}, ' To see it: '), entry.remedy)))));
  return part;
}
