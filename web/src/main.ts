// Puts the page together: a section per part of the data that is there.

import {adviceSection} from './advice';
import {machineSection} from './chain';
import {contourSection} from './contour';
import {Report} from './data';
import {html, section} from './dom';
import {evaluationSection} from './evaluation';
import {prose} from './format';
import {histogramSection} from './histogram';
import {gaugeSection, identificationSection} from './identification';
import {mapSection} from './map';
import {monteCarloSection} from './monte_carlo';
import {locationSection, motionSection} from './motions';
import {overview} from './overview';
import {pathSection} from './path';
import {planCurveSection, planOpenSection, planPosesSection, planReadingsSection} from './plan';
import {preparePrint} from './print';
import {residualSection} from './residuals';
import {surfaceSections} from './surface';
import {parameterSection, tablesSection} from './table';
import {themeButton} from './theme';
import {verificationSections} from './verification';

const kShort: Record<string, string> = {
  unseen: 'Unseen poses', curve: 'How many', poses: 'Positions', open: 'Not determined', readings: 'Readings',
  figures: 'Figures', surface: 'Deviation', section: 'Section', path: 'Path', contour: 'Contour error', map: 'Map', distribution: 'Distribution', machine: 'Machine', motions: 'Error motions', locations: 'Location errors', tables: 'Comparison',
  identification: 'Observability', gauge: 'Gauge', advice: 'Unseen', 'monte-carlo': 'Monte Carlo', residuals: 'Residuals', parameters: 'Parameters', assumptions: 'Assumptions', references: 'References',
};

const kShortEvaluation: Record<string, string> = {tables: 'Details', assumptions: 'Notes'};

function listSection(id: string, title: string, lines: string[]): HTMLElement {
  const part = section(id, title);
  part.append(html('ul', {class: 'plain'}, ...lines.map((text) => html('li', {}, prose(text)))));
  return part;
}

function build(report: Report): void {
  document.title = report.title;
  const page = document.getElementById('page')!;
  const toggle = html('button', {type: 'button', class: 'theme'});
  themeButton(toggle);
  const print = html('button', {type: 'button'}, 'Print');
  print.addEventListener('click', () => window.print());

  const present = (parts: (HTMLElement | undefined | null | false | '' | 0)[]) => parts.filter((part): part is HTMLElement => Boolean(part));
  const body = present([
    report.evaluation?.figures?.length || report.evaluation?.drawings?.length ? evaluationSection(report.evaluation) : undefined,
    planCurveSection(report.plan),
    ...verificationSections(report.verification),
    ...surfaceSections(report),
    pathSection(report),
    planPosesSection(report),
    contourSection(report.contour),
    report.map && mapSection(report.map, report.summary?.map),
    histogramSection(report.histograms, report.map, report.summary),
    report.machine && machineSection(report.machine),
    report.error_motions?.length ? motionSection(report.error_motions, report.machine) : undefined,
    report.location_errors?.length ? locationSection(report.location_errors) : undefined,
    report.tables?.length ? tablesSection(report.tables, report.evaluation ? 'Details' : 'Comparison') : undefined,
    report.identification && identificationSection(report.identification, report.summary ?? {}),
    planOpenSection(report.plan),
    report.assumptions?.length ? listSection('assumptions', report.evaluation ? 'Notes' : 'What was assumed', report.assumptions) : undefined,
    report.references?.length ? listSection('references', 'References', report.references) : undefined,
  ]);
  // What is as long as the identification is large: on paper it begins on a sheet of its own.
  const appendix = present([
    report.advice?.length || report.not_identified ? adviceSection(report.advice ?? [], report.not_identified) : undefined,
    gaugeSection(report.identification?.gauge),
    monteCarloSection(report.parameters, report.summary?.monte_carlo),
    report.residuals && residualSection(report.residuals),
    planReadingsSection(report.plan),
    report.parameters?.name?.length ? parameterSection(report.parameters) : undefined,
  ]);
  for (const part of appendix) part.classList.add('appendix');
  const sections = [...body, ...appendix];

  const links = html('nav', {'aria-label': 'Sections'}, ...sections.map((part) =>
    html('a', {href: `#${part.id}`}, (report.evaluation && kShortEvaluation[part.id]) ?? kShort[part.id] ?? part.dataset.short ?? part.id)));
  page.append(
    html('a', {class: 'skip', href: '#content'}, 'Skip to the report'),
    html('div', {class: 'bar'}, html('span', {class: 'brand'}, 'Abbe'), links, html('div', {class: 'actions'}, print, toggle)),
    html('main', {id: 'content', tabindex: -1}, overview(report), ...body, appendix.length > 0 && body.length > 0 && html('p', {class: 'part appendix'}, 'Appendix'), ...appendix),
    html('footer', {}, report.generator ?? 'Abbe', report.study?.file && ` · ${report.study.file}`,
      report.study?.seed !== undefined && ` · seed ${report.study.seed}`),
  );
  preparePrint();
}

function fail(message: string): void {
  document.getElementById('page')!.append(html('main', {}, html('h1', {}, 'This report cannot be shown'), html('p', {}, message)));
}

const text = document.getElementById('abbe-data')?.textContent ?? '';
let report: Report | undefined;
try {
  report = JSON.parse(text) as Report;
} catch {
  fail('The page holds no readable data.');
}
if (report) {
  if (report.format !== 'abbe-report/1') fail(`The data have the format ${report.format ?? '(none)'}; this page reads abbe-report/1.`);
  else build(report);
}
