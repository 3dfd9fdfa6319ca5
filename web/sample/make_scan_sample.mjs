// Made-up pages of scans for the page's test: a ball with coverage, a probe's path and a contour error; and everything that can be
// empty or single. The same bytes every time.
//   node sample/make_scan_sample.mjs PAGE.html TEMPLATE.html
import {readFileSync, writeFileSync} from 'node:fs';

const packed = (numbers, size, write) => {
  const raw = Buffer.alloc(numbers.length * size);
  numbers.forEach((n, i) => raw[write](n, size * i));
  return raw.toString('base64');
};
const uint16 = (numbers) => packed(numbers, 2, 'writeUInt16LE');
const int16 = (numbers) => packed(numbers, 2, 'writeInt16LE');
const int8 = (numbers) => packed(numbers, 1, 'writeInt8');
const uint8 = (numbers) => packed(numbers, 1, 'writeUInt8');

// A ball of radius 10 mm about (0, 0, 20).
const rings = 40;
const vertices = [];
for (let i = 0; i <= rings; ++i)
  for (let k = 0; k < 2 * rings; ++k) {
    const [t, p] = [(Math.PI * i) / rings, (Math.PI * k) / rings];
    vertices.push([10 * Math.sin(t) * Math.cos(p), 10 * Math.sin(t) * Math.sin(p), 20 + 10 * Math.cos(t)]);
  }
const triangles = [];
for (let i = 0; i < rings; ++i)
  for (let k = 0; k < 2 * rings; ++k) {
    const [a, b, c, d] = [[i, k], [i + 1, k], [i + 1, k + 1], [i, k + 1]].map(([r, m]) => r * 2 * rings + (m % (2 * rings)));
    if (i > 0) triangles.push([a, c, d]);
    if (i < rings - 1) triangles.push([a, b, c]);
  }
const lower = [-10, -10, 10];
const step = 20 / 65535;
const ball = {frame: 'workpiece', triangles_of_part: triangles.length, lower_mm: lower, step_mm: step, vertex_count: vertices.length, triangle_count: triangles.length,
  vertices: uint16(vertices.flat().map((v, i) => Math.round((v - lower[i % 3]) / step))), triangles: uint16(triangles.flat())};
const height = (t) => triangles[t].reduce((sum, v) => sum + vertices[v][2] / 3, 0) - 20;
const coverage = {reasons: ['covered', 'angle of the beam', 'collision with the probe'], of_triangle: uint8(triangles.map((_, t) => (height(t) > -3 ? 0 : height(t) > -7 ? 1 : 2)))};

const n = 400;
const path = {title: 'Scan path', moves: 12000, time_s: [], working: [], axes: ['C_deg', 'X_mm', 'Z_mm'], commands: {C_deg: [], X_mm: [], Z_mm: []}, travel: {X_mm: [-50, 50], Z_mm: [0, 60]},
  point_mm: {x: [], y: [], z: []}, direction: {x: [], y: [], z: []}, feed_mm_per_min: [], length_mm: [],
  tool: {kind: 'probe', radius_mm: 1.5, length_mm: 12, working_distance_mm: 4}, note: 'Made up.'};
for (let i = 0; i < n; ++i) {
  const t = 0.1 + (1.7 * i) / n;
  const p = 0.5 * i;
  const d = [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
  const working = i % 50 === 0 ? 0 : 1;
  path.time_s.push(0.25 * i); path.working.push(working); path.feed_mm_per_min.push(working ? 120 : 0); path.length_mm.push(0.5 * i);
  path.commands.C_deg.push(((p * 180) / Math.PI)); path.commands.X_mm.push(10 * Math.sin(t)); path.commands.Z_mm.push(20 + 10 * Math.cos(t));
  ['x', 'y', 'z'].forEach((k, m) => { path.point_mm[k].push((m === 2 ? 20 : 0) + (working ? 10 : 14) * d[m]); path.direction[k].push(d[m]); });
}
const s = Array.from({length: 30}, (_, i) => 2.5 * i);
const contour = {title: 'Engraved curve', s_mm: s, error_um: s.map((v, i) => 15 + 6 * Math.sin(0.3 * v) + (i === 20 ? 12 : 0)), u_um: s.map(() => 2), limits_um: [-25, 25],
  also: [{name: 'rounding P1 P2', s_mm: s, value_um: s.map((v) => 15 + Math.cos(v))}], sections_in_all: 300,
  sections: [0, 1, 2].map((k) => {
    const u = Array.from({length: 200}, (_, i) => i - 150);
    const one = {name: `S${k}`, across_um: u, height_um: u.map((x) => (x < 12 ? Math.sin(9 * x) : -60))};
    if (k === 1) return {...one, not_evaluated: 'nothing is deeper than eight times the scatter of the surface'};
    return {...one, s_mm: 10 * k, error_um: 12 - 8 * k, u_um: 1.5, edges: [{across_um: [-150, -3, 12, 12], height_um: [0, 0, -15, -60], P1_um: [-3, 0], P2_um: [12, 0]}]};
  })};
const scan = {format: 'abbe-report/1', title: 'A probe on a ball', evaluation: {kind: 'scan', facts: [{name: 'part', text: 'a ball'}],
  figures: [{symbol: 'covered', name: 'part of the surface', value_percent: 71.25, decimals: 2, tolerance_percent: 95, verdict: 'exceeded'},
    {symbol: 'time', name: 'of the path', value_s: 100, decimals: 1}, {symbol: 'none', name: 'nothing known', not_evaluated: 'no point counts', decimals: 3}]},
surface: {...ball, coverage}, path, contour, assumptions: ['A probe of 1.5 mm.']};

const one = {...ball, vertex_count: 3, triangle_count: 1, triangles_of_part: 1, vertices: uint16([0, 0, 0, 65535, 0, 0, 0, 65535, 0]), triangles: uint16([0, 1, 2]), limit_um: 1e-3, value_step_um: 5e-7};
const edge = {format: 'abbe-report/1', title: 'One triangle, no point near it', evaluation: {facts: [], figures: [],
  drawings: [{caption: 'A drawing without figures', svg: '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20"><title>A square</title><rect width="20" height="20"/></svg>'}]},
  surface: {...one, values: int16([-32768, -32768, -32768]), points: {measured: 5, counted: 1, drawn: 1, foot: uint16([100, 100, 0]), normal: int8([0, 0, 127]), values: int16([32767])}},
  histograms: [{title: 'Distribution', edges_um: [-1, 0, 1], counts: [0, 0], below: 0, above: 1}],
  contour: [{s_mm: [0], error_um: [0]}, {s_mm: [], error_um: []},
    {s_mm: [], error_um: [], counted: 'section', joined: false, also: [], sections: [{name: 'one', across_um: [3], height_um: [2], not_evaluated: 'fewer than 20 points'}]}],
  path: {time_s: [0], working: [1], commands: {X_mm: [0]}, point_mm: {x: [0], y: [0], z: [0]}, direction: {x: [0], y: [0], z: [1]}}};

// A plan of readings: a drawing of the producer too, with letters near its edges.
const m = 90;
const stops = {title: 'The chosen poses on the machine', moves: m, stops: true, time_s: [], working: [], axes: path.axes, commands: {C_deg: [], X_mm: [], Z_mm: []}, travel: path.travel,
  point_mm: {x: [], y: [], z: []}, direction: {x: [], y: [], z: []}, tool: {kind: 'tool'}, note: 'Made up.'};
const taken = [];
for (let i = 0; i < m; ++i) {
  const at = [(40 * i) % 360, [-50, 0, 50][(i * i) % 3], [0, 30, 60][i % 3]];
  stops.time_s.push(4.3 * (i + 1)); stops.working.push(0);
  ['C_deg', 'X_mm', 'Z_mm'].forEach((key, k) => stops.commands[key].push(at[k]));
  stops.point_mm.x.push(at[1]); stops.point_mm.y.push(20 * Math.sin(i)); stops.point_mm.z.push(at[2]);
  stops.direction.x.push(0); stops.direction.y.push(0); stops.direction.z.push(1);
  taken.push([String(i + 1), (0.0717 * (i + 1)).toFixed(1), ...at.map((v) => v.toFixed(3)), 'table', `S${1 + (i % 3)}`]);
}
const numbers = [24, 30, 38, 48, 60, 75, 90, 120];
const plan = {format: 'abbe-report/1', title: 'Planned measurement: a sample', subtitle: 'table-and-column machine', summary: {verdict: '90 readings in 6 min: predicted volumetric standard uncertainty 1.268 um.'},
  evaluation: {kind: 'plan', facts: [{name: 'goal', text: 'smallest predicted volumetric uncertainty'}], figures: [{symbol: 'u', name: 'predicted volumetric standard uncertainty, root mean square', value_um: 1.268, decimals: 3},
    {symbol: 'time', name: 'of the whole measurement', value_min: 6.4, decimals: 1}, {symbol: 'a_very_long_symbol_of_a_figure', name: 'words', value: 2.5, decimals: 2, expanded_uncertainty: 0.2, tolerance: 2, verdict: 'exceeded, not proven'}]},
  plan: {curve: {readings: numbers, uncertainty_um: numbers.map((v, i) => (i ? 12 / Math.sqrt(v) : null)), grid_readings: numbers.map((v, i) => (i > 2 ? v + 5 : null)), grid_uncertainty_um: numbers.map((v, i) => (i > 2 ? 21 / Math.sqrt(v) : null)), enough: 3},
    enough_words: 'from 48 readings on, more readings average noise', open: ['12 of the 66 combinations of parameters change no reading of any candidate.'],
    readings: {columns: ['reading', 'time / min', 'C / °', 'X / mm', 'Z / mm', 'station', 'reflector'], rows: taken}},
  path: stops, tables: [{title: 'A table wider than a sheet', columns: Array.from({length: 20}, (_, i) => `quantity ${i}`), rows: [0, 1, 2].map((k) => Array.from({length: 20}, (_, i) => (k - 1.5) * 1234.5678 * (i + 1)))}],
  assumptions: ['Made up.']};

const [, , pageFile, templateFile] = process.argv;
const template = readFileSync(templateFile, 'utf8');
for (const [name, content] of [['', scan], ['-edge', edge], ['-plan', plan]])
  writeFileSync(pageFile.replace(/\.html$/, `${name}.html`), template.replace('@@ABBE_DATA@@', () => JSON.stringify(content).replace(/</g, '\\u003c')));
