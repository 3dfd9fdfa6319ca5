// Tables: plain ones, and the parameter table that sorts and filters.

import {DataTable, Parameters, SparklineData, unitText} from './data';
import {field, html, section} from './dom';
import {alike, count, grouped, number, prose, withUncertainty} from './format';
import {sparkline} from './sparkline';

type Cell = string | number | boolean | null;

const kSheet = 670;
/// Letters of a text that stays on one line.
const kLongestWord = 24;
/// Letters of the name of a row.
const kLongestName = 14;
/// Rows of a table that is not divided between sheets.
const kShort = 20;

/// Leading columns that tell the rows apart: two at most beyond the first, which is always one of them.
function namingColumns(columns: string[], rows: string[][]): number {
  for (let n = 1; n <= Math.min(3, columns.length - 1); ++n)
    if (new Set(rows.map((row) => row.slice(0, n).join('\n'))).size === rows.length) return n;
  return 1;
}

/// Groups of columns, each as wide as a sheet of paper, with the columns that name the rows in all of them; one group where all fit.
/// Letters of tables on paper are 5.3 pixels wide; words and numbers do not break.
export function columnsOnPaper(columns: string[], rows: string[][]): number[][] {
  const longest = (text: string) => Math.max(0, ...text.split(/[ \u00ad-]+/).map((word) => word.length));
  const width = columns.map((name, i) => 8 + 5.3 * Math.max(longest(name), ...rows.map((row) => longest(row[i] ?? ''))));
  const groups: number[][] = [];
  const names = columns.map((_, i) => i).slice(0, namingColumns(columns, rows));
  let used = Infinity;
  for (let i = names.length; i < columns.length; ++i) {
    if (used + width[i] > kSheet) {
      groups.push([...names]);
      used = names.reduce((sum, k) => sum + width[k], 0);
    }
    groups[groups.length - 1].push(i);
    used += width[i];
  }
  return groups.length ? groups : [names];
}

/// Head of a column of a producer without Greek letters: "value in um" becomes "value in µm".
const withGreekUnit = (name: string) => name.replace(/(^| in | \/ |\()u(m|rad)\b/g, '$1µ$2');

/// `row` with `cell` in the second column.
const withSecond = <T>(row: T[], cell: T): T[] => [row[0], cell, ...row.slice(1)];

/// A sparkline is as wide as a word of so many letters.
const kSparkline = 'x'.repeat(26);

/// @param sparklines  of each row, in a second column; or none
export function dataTable(caption: string, heads: string[], cells: Cell[][], sparklines?: SparklineData[]): HTMLElement {
  const hasSparklines = Boolean(sparklines?.length) && heads.length > 0;
  const columns = hasSparklines ? withSecond(heads, 'course') : heads;
  const rows = hasSparklines ? cells.map((row) => withSecond<Cell>(row, '')) : cells;
  const isNumeric = (cell: unknown) => typeof cell === 'number' || (typeof cell === 'string' && /^-?\d[\d.]*(e[-+]?\d+)?( \u00b1 \d[\d.]*)?$/.test(cell));
  const isMissing = (cell: unknown) => cell === null || cell === '';
  const isNumber = columns.map((_, i) => rows.some((row) => typeof row[i] === 'number') || (rows.some((row) => isNumeric(row[i])) && rows.every((row) => isNumeric(row[i]) || isMissing(row[i]))));
  const asPrinted = (text: string) => text.replace('-', '\u2212').replace(/^(\u2212?)([\d.]+)$/, (_, sign, digits) => sign + grouped(digits));
  const written = rows.map((row) => row.map((cell, i) =>
    typeof cell === 'number' ? (Number.isInteger(cell) ? count(cell) : number(cell, 5)) : cell === null ? '\u2013' : isNumber[i] ? asPrinted(String(cell)) : prose(String(cell))));
  // Sentences stand on several lines, as wide as they need.
  const wordy = columns.map((_, i) => !isNumber[i] && written.some((row) => row[i].length > kLongestWord));
  const style = (i: number) => (isNumber[i] ? 'number' : wordy[i] ? 'words' : '');
  // A short first column names the rows and stays in view beside those that scroll; a long one would hide them.
  const named = columns.length > 1 && written.every((row) => row[0].length <= kLongestName);
  const cell = (row: string[], i: number, k: number) => {
    if (i === 1 && hasSparklines) return html('td', {class: 'course'}, sparklines![k] && sparkline(sparklines![k], row[0]));
    return i === 0 && named ? html('th', {scope: 'row', class: style(i)}, row[i]) : html('td', {class: style(i)}, row[i]);
  };
  const table = (kept: number[], name: string, where: string) => html('table', {class: `data ${where} ${named ? '' : 'unnamed'}`},
    html('caption', {}, name),
    html('thead', {}, html('tr', {}, ...kept.map((i) => html('th', {scope: 'col', class: `${isNumber[i] ? 'number' : ''}${columns[i].length > kLongestName ? ' long-head' : ''}`}, withGreekUnit(columns[i]))))),
    html('tbody', {}, ...written.map((row, k) => html('tr', {}, ...kept.map((i) => cell(row, i, k))))));
  const all = columns.map((_, i) => i);
  const groups = columnsOnPaper(columns, hasSparklines ? written.map(([first, , ...others]) => [first, kSparkline, ...others]) : written);
  return html('div', {class: `scroll${rows.length > kShort ? ' long' : ''}`, tabindex: 0, role: 'region', 'aria-label': caption}, table(all, prose(caption), groups.length > 1 ? 'screen-only' : ''),
    ...(groups.length > 1 ? groups.map((kept, i) => table(kept, `${prose(caption)} (${i + 1} of ${groups.length})`, 'paper-only')) : []));
}

/// A table and what is said below it.
export function tableWithNote(table: DataTable): HTMLElement[] {
  const drawn = dataTable(table.title, table.columns, table.rows, table.sparklines);
  return table.note ? [drawn, html('p', {class: 'note'}, prose(table.note))] : [drawn];
}

export function tablesSection(tables: DataTable[], title: string): HTMLElement {
  const part = section('tables', title);
  for (const table of tables) {
    part.append(...tableWithNote(table));
  }
  return part;
}

interface Row {
  cells: HTMLElement[];
  sort: (string | number)[];
  text: string;
  /// A convention acts on it; it alone fixes the value.
  gauge: boolean;
  fixed: boolean;
}

function parameterRows(p: Parameters): Row[] {
  return p.name.map((name, i) => {
    const uncertainty = p.standard_uncertainty?.[i];
    const [value, spread] = withUncertainty(p.value[i], uncertainty);
    const unit = p.unit?.[i] ?? '';
    const correlation = p.largest_correlation?.[i];
    const partner = p.correlated_with?.[i] ?? '';
    const gauge = p.gauge?.[i] ?? '';
    const truth = p.truth?.[i];
    const cells = [
      html('th', {scope: 'row'}, name),
      html('td', {}, p.group?.[i] ?? ''),
      html('td', {class: 'number'}, value),
      html('td', {class: 'number'}, spread),
      html('td', {}, unitText(unit)),
      html('td', {class: 'number'}, correlation === null || correlation === undefined ? '\u2013' : alike(correlation, '0.00')),
      html('td', {}, partner),
      html('td', {class: 'gauge'}, gauge),
    ];
    if (p.truth) cells.splice(4, 0, html('td', {class: 'number'}, alike(truth, uncertainty ? value : '')));
    const simulated = p.monte_carlo_uncertainty?.[i];
    const ratio = p.monte_carlo_ratio?.[i];
    if (p.monte_carlo_uncertainty)
      cells.splice(4, 0, html('td', {class: 'number'}, alike(simulated, spread)), html('td', {class: 'number'}, alike(ratio, '0.00')));
    const low = -Infinity;
    const sort: (string | number)[] = [name, p.group?.[i] ?? '', p.value[i] ?? low, uncertainty ?? low, unit,
      correlation === null || correlation === undefined ? low : Math.abs(correlation), partner, gauge];
    if (p.truth) sort.splice(4, 0, truth ?? low);
    if (p.monte_carlo_uncertainty) sort.splice(4, 0, simulated ?? low, ratio ?? low);
    return {cells, sort, text: `${name} ${p.group?.[i] ?? ''} ${partner} ${gauge}`.toLowerCase(), gauge: gauge !== '', fixed: gauge !== '' && !uncertainty};
  });
}

export function parameterSection(p: Parameters): HTMLElement {
  const part = section('parameters', 'Parameters',
    'Every estimated parameter with its standard uncertainty and the parameter it is most correlated with. Where the readings cannot separate parameters, the gauge column says which convention fixes them.');
  const columns = ['Parameter', 'Group', 'Value', 'Standard uncertainty', 'Unit', 'Largest correlation', 'with', 'Gauge'];
  if (p.truth) columns.splice(4, 0, 'Truth');
  if (p.monte_carlo_uncertainty) columns.splice(4, 0, 'Monte Carlo', 'Ratio');
  const numeric = new Set(['Value', 'Standard uncertainty', 'Monte Carlo', 'Ratio', 'Truth', 'Largest correlation']);
  const rows = parameterRows(p);
  const order = rows.map((_, i) => i);
  const body = html('tbody');
  const caption = html('caption');
  const status = html('span', {class: 'note', 'aria-live': 'polite'});
  const filter = html('input', {type: 'search', placeholder: 'EXX, tracker, C …', id: 'parameter-filter'});
  const onlyFixed = html('input', {type: 'checkbox', id: 'parameter-fixed'});
  const elements = rows.map((row) => html('tr', row.fixed ? {class: 'fixed'} : {}, ...row.cells));
  const show = () => {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = order.filter((i) => (!onlyFixed.checked || rows[i].gauge) && words.every((word) => rows[i].text.includes(word)));
    body.replaceChildren(...kept.map((i) => elements[i]));
    status.textContent = `${kept.length} of ${rows.length}`;
    caption.textContent = `Parameters${kept.length < rows.length ? `, ${kept.length} of ${rows.length} shown` : ''}`;
    // The heading says it already unless something is left out, which paper must say too.
    caption.className = kept.length < rows.length ? '' : 'unseen';
  };
  filter.addEventListener('input', show);
  onlyFixed.addEventListener('change', show);

  const heads = columns.map((name, column) => {
    const button = html('button', {type: 'button', title: `Sort by ${name.toLowerCase()}`}, name);
    const head = html('th', {scope: 'col', class: numeric.has(name) ? 'number' : '', 'aria-sort': 'none'}, button,
      // Browsers leave buttons out of the heads that they repeat on every sheet.
      html('span', {class: 'print-only'}, name));
    button.addEventListener('click', () => {
      const down = head.getAttribute('aria-sort') === 'ascending';
      for (const other of heads) other.setAttribute('aria-sort', 'none');
      head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
      order.sort((a, b) => {
        const x = rows[a].sort[column];
        const y = rows[b].sort[column];
        const less = typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y), 'en', {numeric: true});
        return (down ? -less : less) || a - b;
      });
      show();
    });
    return head;
  });
  part.append(
    html(
      'div',
      {class: 'controls'},
      field('Filter', filter),
      rows.some((row) => row.gauge) && html('label', {class: 'check'}, onlyFixed, 'only those in the gauge'),
      status,
    ),
    html('div', {class: 'scroll tall', tabindex: 0, role: 'region', 'aria-label': 'Parameters'},
      html('table', {class: 'parameters'}, caption, html('thead', {}, html('tr', {}, ...heads)), body)),
  );
  show();
  return part;
}
