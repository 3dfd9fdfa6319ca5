// Facts and figures of an evaluation, with their tolerances.

import {Evaluation, EvaluationFigure, findQuantity} from './data';
import {html, section} from './dom';
import {drawing} from './drawings';
import {fixed, prose} from './format';
import {tableWithNote} from './table';

/// As evaluation_report.cpp names them; "not proven": the tolerance lies within the guard band.
const kVerdicts: Record<string, string> = {
  within: 'agrees', 'within, not proven': 'undecided', 'exceeded, not proven': 'exceeded', exceeded: 'exceeded', 'cannot be judged': 'exceeded',
};

export function evaluationFacts(evaluation: Evaluation): HTMLElement {
  return html('dl', {class: 'facts'}, ...(evaluation.facts ?? []).map((fact) => html('div', {}, html('dt', {}, fact.name), html('dd', {}, fact.text))));
}

export function evaluationSection(evaluation: Evaluation): HTMLElement {
  const part = section('figures', 'Figures');
  const figures = evaluation.figures ?? [];
  const find = (figure: EvaluationFigure, name: string) => {
    const found = findQuantity<number>(figure as unknown as Record<string, unknown>, name);
    return found ?? (typeof figure[name] === 'number' ? {value: figure[name] as number, unit: ''} : undefined);
  };
  const any = (name: string) => figures.some((figure) => find(figure, name));
  const uncertainty = any('expanded_uncertainty');
  const tolerance = any('tolerance');
  const heads = ['', 'Figure', 'Value', uncertainty && 'U (k = 2)', 'Unit', tolerance && 'Tolerance', tolerance && 'Verdict'].filter((name): name is string => name !== false);
  const numeric = new Set(['Value', 'U (k = 2)', 'Tolerance']);
  const text = (figure: EvaluationFigure, value: number | undefined) => (value === undefined ? '' : fixed(value, figure.decimals ?? 3));
  const number = (figure: EvaluationFigure, name: string, style: string) => html('td', {role: 'cell', class: `number ${style}`}, text(figure, find(figure, name)?.value));
  // Long symbols may break behind their underscores.
  const symbol = (words: string) => words.split(/(?<=_)/).flatMap((word, i) => (i ? [html('wbr'), word] : [word]));
  const rows = figures.map((figure) => {
    const value = find(figure, 'value');
    const verdict = figure.verdict ?? '';
    return html('tr', {role: 'row'},
      html('th', {scope: 'row', role: 'rowheader'}, ...symbol(figure.symbol)), html('td', {role: 'cell', class: 'words'}, figure.name ?? ''),
      value ? html('td', {role: 'cell', class: 'number'}, html('span', {'data-figure': figure.symbol}, text(figure, value.value)))
        : html('td', {role: 'cell', class: 'words'}, `not evaluated: ${figure.not_evaluated ?? ''}`),
      // An uncertainty to which nothing stated contributes is none: it is not written as a zero.
      uncertainty && number(find(figure, 'expanded_uncertainty')?.value ? figure : {symbol: ''}, 'expanded_uncertainty', 'uncertainty'), html('td', {role: 'cell'}, value?.unit ?? ''),
      tolerance && number(figure, 'tolerance', 'tolerance'), tolerance && html('td', {role: 'cell', class: `verdict-of ${kVerdicts[verdict] ?? ''}`}, verdict));
  });
  part.append(...(evaluation.tables ?? []).flatMap(tableWithNote));
  // A page may have drawings and no figures.
  if (figures.length) {
    part.append(html('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Figures'}, html('table', {class: 'figures', role: 'table'},
      html('caption', {class: 'unseen'}, 'Figures'),
      html('thead', {}, html('tr', {}, ...heads.map((name) => html('th', {scope: 'col', class: numeric.has(name) ? 'number' : ''}, name || html('span', {class: 'unseen'}, 'Symbol'))))),
      html('tbody', {}, ...rows))));
  }
  const drawings = (evaluation.drawings ?? []).map((made) => drawing(made.svg, made.svg_narrow, made.caption && prose(made.caption), made.beside));
  part.append(html('div', {class: 'drawings'}, ...drawings));
  return part;
}
