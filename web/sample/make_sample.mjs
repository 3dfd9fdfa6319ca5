// A made-up but plausible report, for work on the page and its test: a table-and-column machine w C' X' b Z t with smooth random
// errors, drawn to first order. The same bytes every time.
//   node sample/make_sample.mjs DATA.json [REPORT.html TEMPLATE.html]
import {readFileSync, writeFileSync} from 'node:fs';

let state = 20210517;
const uniform = () => {
  state = (state + 0x6d2b79f5) | 0;
  let t = Math.imul(state ^ (state >>> 15), 1 | state);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
};
const normal = () => Math.sqrt(-2 * Math.log(1 - uniform())) * Math.cos(2 * Math.PI * uniform());
const digits = (v, n = 4) => Number(v.toPrecision(n));
const legendre = (s) => [1, s, (3 * s * s - 1) / 2, (5 * s ** 3 - 3 * s) / 2, (35 * s ** 4 - 30 * s * s + 3) / 8];
const fourier = (t) => [1, Math.cos(t), Math.sin(t), Math.cos(2 * t), Math.sin(2 * t), Math.cos(3 * t), Math.sin(3 * t)];

const axes = [
  {name: 'C', kind: 'rotary', side: 'workpiece', primed: true, direction: [0, 0, 1], point_mm: [0, 0, 0], travel_min_deg: 0, travel_max_deg: 360, endless: true},
  {name: 'X', kind: 'linear', side: 'workpiece', primed: true, direction: [1, 0, 0], point_mm: [0, 0, -120], travel_min_mm: 0, travel_max_mm: 1400},
  {name: 'Z', kind: 'linear', side: 'tool', primed: false, direction: [0, 0, 1], point_mm: [700, 520, 0], travel_min_mm: 0, travel_max_mm: 600},
];
const basis = {C: (q) => fourier((q * Math.PI) / 180), X: (q) => legendre(q / 700 - 1), Z: (q) => legendre(q / 300 - 1)};
const functionNames = {C: ['1', 'cos1', 'sin1', 'cos2', 'sin2', 'cos3', 'sin3'], X: ['P0', 'P1', 'P2', 'P3', 'P4'], Z: ['P0', 'P1', 'P2', 'P3', 'P4']};
const fixed = {C: [0], X: [0], Z: [0]};
const truth = {}, found = {}, spread = {};
for (const axis of axes)
  for (const [k, letter] of [...'XYZABC'].entries()) {
    const name = `E${letter}${axis.name}`;
    const unit = k < 3 ? (axis.name === 'C' ? 45 : 140) : axis.name === 'C' ? 60 : 150;
    truth[name] = functionNames[axis.name].map((_, i) => (i === 0 ? 0 : (normal() * unit) / (0.6 + i)));
    spread[name] = functionNames[axis.name].map((_, i) => (i === 0 ? 0 : (k < 3 ? 1.6 : 2.1) * (0.8 + 0.4 * uniform())));
    found[name] = truth[name].map((v, i) => v + normal() * spread[name][i]);
  }
const value = (set, name, q) => {
  const f = basis[name[2]](q);
  return set[name].reduce((sum, c, i) => sum + c * f[i], 0);
};

// First order: position error of the tip in the workpiece frame, um; angles in urad times mm give nm.
const errorAt = (set, [c, x, z]) => {
  const e = [0, 0, 0], w = [0, 0, 0];
  const place = [x, 250, z + 120];
  for (const [axis, q, sign] of [['X', x, -1], ['Z', z, 1], ['C', c, -1]]) {
    const d = [...'XYZ'].map((l) => value(set, `E${l}${axis}`, q));
    const r = [...'ABC'].map((l) => value(set, `E${l}${axis}`, q));
    const arm = axis === 'Z' ? [180, 250, 120] : place;
    const turn = [r[1] * arm[2] - r[2] * arm[1], r[2] * arm[0] - r[0] * arm[2], r[0] * arm[1] - r[1] * arm[0]];
    for (let i = 0; i < 3; ++i) {
      e[i] += sign * (d[i] + turn[i] * 1e-3);
      w[i] += sign * r[i];
    }
  }
  return {e, w};
};
const difference = (pose) => {
  const a = errorAt(truth, pose), b = errorAt(found, pose);
  return {e: a.e.map((v, i) => v - b.e[i]), w: a.w.map((v, i) => v - b.w[i])};
};
const length = (v) => Math.hypot(...v);
const statistics = (values) => {
  const s = [...values].sort((a, b) => a - b);
  const at = (p) => s[Math.min(s.length - 1, Math.floor(p * s.length))];
  const mean = s.reduce((a, b) => a + b, 0) / s.length;
  return {mean, rms: Math.sqrt(s.reduce((a, b) => a + b * b, 0) / s.length), median: at(0.5), p90: at(0.9), p95: at(0.95), p99: at(0.99), max: s[s.length - 1]};
};

const held = Array.from({length: 2000}, () => [360 * uniform(), 1400 * uniform(), 600 * uniform()]);
const before = held.map((p) => errorAt(truth, p)), after = held.map(difference);

const map = {frame: 'machine', poses: 8 * 11 * 7, description: '8 × 11 × 7 grid of C, X, Z', positions: {C_deg: [], X_mm: [], Z_mm: []},
  point_mm: {x: [], y: [], z: []}, before_um: {x: [], y: [], z: []}, after_um: {x: [], y: [], z: []},
  before_urad: {a: [], b: [], c: []}, after_urad: {a: [], b: [], c: []}, expanded_uncertainty_um: []};
const mapped = {before: [], after: []};
for (let c = 0; c < 8; ++c)
  for (let x = 0; x <= 1400; x += 140)
    for (let z = 0; z <= 600; z += 100) {
      const pose = [c * 45, x, z], turn = (c * Math.PI) / 4;
      map.positions.C_deg.push(pose[0]); map.positions.X_mm.push(x); map.positions.Z_mm.push(z);
      [x, 350 * Math.sin(turn) + 250, z + 120].forEach((v, i) => map.point_mm['xyz'[i]].push(digits(v, 6)));
      const b = errorAt(truth, pose), a = difference(pose);
      mapped.before.push(b);
      mapped.after.push(a);
      for (let i = 0; i < 3; ++i) {
        map.before_um['xyz'[i]].push(digits(b.e[i]));
        map.after_um['xyz'[i]].push(digits(a.e[i], 3));
        map.before_urad['abc'[i]].push(digits(b.w[i]));
        map.after_urad['abc'[i]].push(digits(a.w[i], 3));
      }
      map.expanded_uncertainty_um.push(digits(4.2 + 6 * ((x - 700) / 700) ** 2 + 3 * ((z - 300) / 300) ** 2, 3));
    }

const motions = [];
for (const axis of axes)
  for (const [k, letter] of [...'XYZABC'].entries()) {
    const name = `E${letter}${axis.name}`, rotary = axis.kind === 'rotary', to = rotary ? 360 : axis.travel_max_mm;
    const at = Array.from({length: 101}, (_, i) => (to * i) / 100), u = k < 3 ? 'um' : 'urad';
    motions.push({name, axis: axis.name, component: letter, basis: rotary ? 'Fourier, 3 harmonics' : 'Legendre, order 4',
      [rotary ? 'position_deg' : 'position_mm']: at.map((q) => digits(q)),
      [`value_${u}`]: at.map((q) => digits(value(found, name, q))),
      [`expanded_uncertainty_${u}`]: at.map((q) => digits(2 * Math.sqrt(basis[axis.name](q).reduce((s, f, i) => s + (f * spread[name][i]) ** 2, 0)), 3)),
      [`truth_${u}`]: at.map((q) => digits(value(truth, name, q)))});
  }

const parameters = {name: [], group: [], unit: [], value: [], standard_uncertainty: [], largest_correlation: [], correlated_with: [], gauge: [], truth: []};
const add = (name, group, unit, v, u, correlation, partner, gauge, t) => {
  for (const [key, entry] of Object.entries({name, group, unit, value: v, standard_uncertainty: u, largest_correlation: correlation, correlated_with: partner, gauge, truth: t}))
    parameters[key].push(entry);
};
for (const motion of motions)
  functionNames[motion.axis].forEach((f, i) => {
    const isFixed = fixed[motion.axis].includes(i);
    add(`${motion.name}[${f}]`, motion.axis, 'XYZ'.includes(motion.component) ? 'um' : 'urad', isFixed ? 0 : digits(found[motion.name][i], 7),
        isFixed ? null : digits(spread[motion.name][i]), isFixed ? null : digits(2 * uniform() - 1, 3),
        isFixed ? '' : `${motion.name}[${functionNames[motion.axis][1 + ((i + 1) % (functionNames[motion.axis].length - 1))]}]`,
        isFixed ? 'fixed at 0: the constant is not separable from the tracker pose' : '', digits(truth[motion.name][i], 7));
  });
const locations = [['EA0C', 'urad', 42.1, 1.3], ['EB0C', 'urad', -61.7, 1.1], ['EX0C', 'um', 18.4, 0.9], ['EY0C', 'um', -25.3, 1.0], ['EB0Z', 'urad', 88.2, 1.6], ['EC0X', 'urad', -7.4, 1.2]]
  .map(([name, unit, v, u]) => ({name, axis: name[3], component: name[1], [`value_${unit}`]: v, [`standard_uncertainty_${unit}`]: u, [`truth_${unit}`]: digits(v + normal() * u)}));
for (const l of locations) {
  const unit = 'value_um' in l ? 'um' : 'urad';
  add(l.name, 'location', unit, l[`value_${unit}`], l[`standard_uncertainty_${unit}`], digits(2 * uniform() - 1, 3), 'tracker1.x', '', l[`truth_${unit}`]);
}
['x', 'y', 'z'].forEach((k, i) => add(`tracker1.${k}`, 'tracker1', 'mm', digits([1210.3141, -402.7718, 355.0932][i], 9), 0.0021 + 0.0004 * i, digits(-0.4 - 0.1 * i, 3), 'EX0C', '', null));
['a', 'b', 'c'].forEach((k, i) => add(`tracker1.${k}`, 'tracker1', 'deg', digits([0.4182, -1.20311, 14.88193][i], 8), 0.00012, digits(0.3 + 0.1 * i, 3), 'EC0X', '', null));

// A simulation of 1,000 campaigns: ratios scatter by 1 / sqrt(2 * 999); one parameter is made to differ.
const samples = 1000;
for (const key of ['uncertainty', 'ratio', 'low', 'high']) parameters[`monte_carlo_${key}`] = [];
parameters.standard_uncertainty.forEach((u, i) => {
  const ratio = u === null ? null : parameters.name[i] === 'EBZ[P4]' ? 1.19 : 1 + normal() / Math.sqrt(2 * (samples - 1));
  const at = (z) => (u === null ? null : digits(parameters.value[i] + (z + 0.06 * normal()) * ratio * u, 9));
  parameters.monte_carlo_uncertainty.push(u === null ? null : digits(u * ratio));
  parameters.monte_carlo_ratio.push(ratio === null ? null : digits(ratio, 5));
  parameters.monte_carlo_low.push(at(-1.96));
  parameters.monte_carlo_high.push(at(1.96));
});
const ratios = parameters.monte_carlo_ratio.filter((r) => r !== null);

const readings = 2000, outliers = new Set([41, 377, 905, 906, 1333, 1704]);
const setup = {name: 'tracker1', readings, reading: [], positions: {C_deg: [], X_mm: [], Z_mm: []}, outlier_limit: 4.59,
  components: [...'xyz'].map((name) => ({name, unit: 'um', normalised: [], residual: []})), outlier: [], held_out: []};
let squares = 0;
for (let i = 0; i < readings; ++i) {
  setup.reading.push(i);
  const pose = [digits(360 * uniform()), digits(1400 * uniform()), digits(600 * uniform())];
  ['C_deg', 'X_mm', 'Z_mm'].forEach((k, j) => setup.positions[k].push(pose[j]));
  for (const component of setup.components) {
    const n = outliers.has(i) ? normal() * 2 + (component.name === 'y' ? -9 : 7) : normal() * 0.985;
    if (!outliers.has(i)) squares += n * n;
    component.normalised.push(digits(n, 3));
    component.residual.push(digits(n * 16.4, 3));
  }
  setup.outlier.push(outliers.has(i) ? 1 : 0);
  setup.held_out.push(i % 10 === 9 && !outliers.has(i) ? 1 : 0);
}

// Two instruments with other components: a ball bar over time, and levels with two angles of which one has no unit stated.
const clock = Array.from({length: 720}, (_, i) => i);
const ballBar = {name: 'ballbar1', readings: 7200, reading: clock.map((i) => 10 * i), time_s: clock.map((i) => digits(0.25 * i)), outlier_limit: 3.89,
  positions: {X_mm: clock.map((i) => digits(700 + 150 * Math.cos((i * Math.PI) / 360))), Z_mm: clock.map((i) => digits(300 + 150 * Math.sin((i * Math.PI) / 360)))},
  components: [{name: 'radius', unit: 'um', normalised: clock.map((i) => digits(normal() + 0.4 * Math.sin(i / 110), 3))}], outlier: clock.map((i) => (i === 400 ? 1 : 0))};
ballBar.components[0].normalised[400] = 6.2;
ballBar.components[0].residual = ballBar.components[0].normalised.map((n) => digits(0.6 * n, 3));
const level = {name: 'level1', reading: clock.slice(0, 40), positions: {X_mm: clock.slice(0, 40).map((i) => 36 * i)},
  components: [{name: 'rotation about Y', unit: 'urad', normalised: [], residual: []}, {name: 'rotation about X', normalised: []}]};
for (let i = 0; i < 40; ++i) {
  const n = normal();
  level.components[0].normalised.push(digits(n, 3));
  level.components[0].residual.push(digits(n * 2.5, 3));
  level.components[1].normalised.push(digits(normal(), 3));
}

const count = parameters.name.length, nullSpace = 18, rank = count - nullSpace;
const singular = Array.from({length: count}, (_, i) => i < rank ? digits(9.4 * Math.exp(-5.2 * (i / rank) ** 1.4) * (1 + 0.04 * uniform()), 4) : digits(2e-15 * (1 + uniform()), 3)).sort((a, b) => b - a);
// The summary has every key that the page shows and those of docs/report-data.md that a program would look for.
const stated = {poses: map.poses, description: '8 x 11 x 7 poses over C 0 to 315 deg, X 0 to 1400 mm, Z 0 to 600 mm, after the best fit of the workpiece datum'};
const mapRanges = [{axis: 'C', range_deg: [0, 315], positions: 8}, {axis: 'X', range_mm: [0, 1400], positions: 11}, {axis: 'Z', range_mm: [0, 600], positions: 7}];
const data = {
  format: 'abbe-report/1',
  title: 'Volumetric accuracy of a table-and-column machine',
  subtitle: 'Laser-tracker campaign with 2,000 readings, joint identification of error motions and axis average lines',
  generator: 'abbe 0.2.0', simulated: true,
  study: {name: 'sample', file: 'sample.study.toml', seed: 20210517},
  machine: {name: 'Table-and-column machine', chain: "w C' X' b Z t", description: 'Rotary table on a slide, vertical column. Reflectors on the spindle, tracker on the table.', axes, tool_reference_mm: [0, 0, 250], tool_offset_mm: [180, 250, -120], tool_direction: [0, 0, 1]},
  summary: {
    format: 'abbe-summary/1', study: 'sample', machine: 'Table-and-column machine', chain: "w C' X' b Z t", status: 'converged', converged: true, trusted: true, iterations: 6,
    readings, outliers: outliers.size, residuals: readings * 3, parameters: count, machine_parameters: count - 6, setup_parameters: 6, rank, null_space: nullSpace,
    degrees_of_freedom: (readings - outliers.size) * 3 - rank, chi_square: squares, chi_square_probability: 0.83, observability_index: 0.0213, observability_index_kind: 'O1',
    condition_number: singular[0] / singular[rank - 1], normalised_residual_rms: Math.sqrt(squares / ((readings - outliers.size) * 3 - rank)), seed: 20210517,
    predicted_volumetric_error: {...stated, before_um: statistics(mapped.before.map((p) => 0.99 * length(p.e))), after_expanded_um: statistics(map.expanded_uncertainty_um)},
    true_volumetric_error: {...stated, before_um: statistics(mapped.before.map((p) => length(p.e))), after_um: statistics(mapped.after.map((p) => length(p.e)))},
    residual: {residuals: readings * 3, outliers: outliers.size, times_stated_uncertainty: 1.21, times_stated_uncertainty_without_outliers: 1.004,
      length_um: {mean: 25.9, rms: 34.2, median: 25.1, p95: 46.0, max: 912}, length_without_outliers_um: {mean: 25.7, rms: 28.4, median: 25.1, p95: 45.6, max: 61.3}},
    ranges: [{axis: 'X', wanted_mm: [0, 1400], measured_mm: [0.4, 1399.2], stated_mm: [0, 1400], margin_percent: 2, expanded_uncertainty_at_end_um: 9.8, expanded_uncertainty_at_end_urad: 14.2}],
    held_out: {poses: held.length, description: 'random poses over the full travel, none of them used in the fit', reference: 'truth', quantity: 'true volumetric error',
      position_before_um: statistics(before.map((p) => length(p.e))), position_after_um: statistics(after.map((p) => length(p.e))),
      orientation_before_urad: statistics(before.map((p) => length(p.w))), orientation_after_urad: statistics(after.map((p) => length(p.w))),
      predicted_expanded_uncertainty_um: {mean: 12.4, max: 21.9}, coverage_percent: 95.2},
    map: {poses: map.poses, description: map.description, reference: 'truth', outside_range: 12, ranges: mapRanges,
      position_before_um: statistics(mapped.before.map((p) => length(p.e))), position_after_um: statistics(mapped.after.map((p) => length(p.e))),
      orientation_before_urad: statistics(mapped.before.map((p) => length(p.w))), orientation_after_urad: statistics(mapped.after.map((p) => length(p.w))),
      predicted_expanded_uncertainty_um: statistics(map.expanded_uncertainty_um)},
    fit_residual_um: {mean: 25.7, rms: 28.4, median: 25.1, p95: 45.6, max: 61.3},
    monte_carlo: {samples, compared: ratios.length, smallest_uncertainty_ratio: Math.min(...ratios), largest_uncertainty_ratio: Math.max(...ratios),
      chance_ratio_low: 0.91, chance_ratio_high: 1.093, largest_shift: 0.094, chance_shift: 0.129, beyond_chance: ratios.filter((r) => r < 0.91 || r > 1.093).length, agrees: false},
  },
  warnings: [{level: 'warning', text: '6 of 2,000 readings were marked as outliers and carry no weight.'},
    {level: 'note', text: '18 combinations of parameters are not separable from the tracker pose; they are fixed by convention, see Gauge.'}],
  assumptions: ['Error motions depend on the position of their own axis only; no temperature, load or direction of approach.',
    'Tracker noise: 10 µm + 5 µm/m of the distance, isotropic, independent between readings.',
    'Composition of ISO 230-1 as in the conventions: linear axis after its motion, rotary axis before it.',
    'Straightness is zero at the reference position; rotary error motions are referred to the axis average line.'],
  map,
  histograms: [{title: 'Volumetric error at unseen poses', before_um: before.map((p) => digits(length(p.e))), after_um: after.map((p) => digits(length(p.e)))},
    {title: 'Orientation error at unseen poses', before_urad: before.map((p) => digits(length(p.w))), after_urad: after.map((p) => digits(length(p.w)))}],
  error_motions: motions, location_errors: locations, parameters,
  residuals: {setups: [setup, ballBar, level]},
  identification: {strategy: 'joint', loss: 'Tukey, 4.7 sigma', rank_threshold: 1e-10, singular_values: singular,
    gauge: [{parameters: ['EXX[P0]', 'EYX[P0]', 'EZX[P0]', 'tracker1.x'], text: 'The constants of the X slide are not separable from the place of the tracker.', convention: 'The errors of X are zero at X = 0.'},
      {parameters: ['EXZ[P0]', 'EYZ[P0]', 'EZZ[P0]'], text: 'The constants of the Z slide are not separable from the tool offset.', convention: 'The errors of Z are zero at Z = 0.'},
      {parameters: ['EXC[1]', 'EYC[1]', 'EZC[1]', 'EAC[1]', 'EBC[1]', 'ECC[1]'], text: 'The constants of the rotary table are not separable from its axis average line.', convention: 'Rotary error motions have no constant: they are referred to the axis average line.'}],
    history: {iteration: [0, 1, 2, 3, 4, 5, 6], chi_square: [8.1e9, 3.4e7, 2.1e5, 6410, squares + 12, squares + 0.02, squares], relative_step: [null, 0.9, 0.2, 0.03, 1e-3, 1e-5, 1e-8], damping: [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9]},
    hardly_seen: 1,
    stages: [{status: 'converged', parameters: 66, residuals: 2400, degrees_of_freedom: 2346, chi_square: 2360.2}, {status: 'converged', parameters: 60, residuals: 3600, degrees_of_freedom: 3552, chi_square: 3499.8}],
    order_selection: {label: ['X 1, Z 1, C 1', 'X 2, Z 1, C 1', 'X 3, Z 1, C 1', 'X 4, Z 1, C 1', 'X 4, Z 2, C 1', 'X 4, Z 3, C 1', 'X 4, Z 4, C 2', 'X 4, Z 4, C 3', 'X 4, Z 4, C 4'],
      held_out_normalised_rms: [9.8, 6.1, 4.4, 3.2, 2.4, 1.6, 1.21, 1.013, 1.016], chosen: 7}},
  advice: [
    {parameters: ['EBZ[P4]', 'EBZ[P3]'], text: 'The tilt of the column about Y (EBZ) is seen through one reflector offset only; near the ends of Z its expanded uncertainty is three times that of EAZ.',
      remedy: 'Repeat 60 readings with a reflector on an arm of at least 150 mm across X, over the whole travel of Z.'},
    {parameters: ['EX0C', 'tracker1.x'], text: 'The place of the axis average line along X is hardly separable from the place of the tracker.', remedy: 'Measure a part of the poses from a second station of the tracker on the bed.'},
    {text: 'Hysteresis is not seen: all positions were approached from one side.'}],
  not_identified: {errors: ['EBX', 'EA0Z'], text: 'not identified: EBX, EA0Z. They are taken as zero; the uncertainty of the volumetric error does not cover them. Errors there of usual size (10 um, 50 urad each) make about 12 um.',
    shown_by: [{errors: ['EBX'], by_these_readings: true, remedy: 'the readings show it: identify it too'}, {errors: ['EA0Z'], by_these_readings: false, remedy: 'a ball bar on circles in XY, YZ and ZX'}]},
  references: ['ISO 230-1:2012, ISO 230-7:2015', 'JCGM 100:2008 (GUM)', "Breaking out: </script><script>window.broken = 1</script>"],
};
data.summary.held_out.remaining_percent = (100 * data.summary.held_out.position_after_um.mean) / data.summary.held_out.position_before_um.mean;

// A map of published tables: no identification, no correction, counted histogram, curves without bands, one dead axis.
const counts = new Array(40).fill(0);
for (const p of before) counts[Math.min(39, Math.floor(length(p.e) / 12.5))] += 885.78;
const grinder = {name: 'Five-axis grinder', chain: 'w C b X Z A Y B t', tool_reference_mm: [0, 0, 0], tool_offset_mm: [200, 0, 0], tool_direction: [1, 0, 0], workpiece_origin_mm: [0, 0, 400],
  axes: [{name: 'C', kind: 'rotary', side: 'workpiece', direction: [0, 0, 1], point_mm: [0, 0, 0], endless: true},
    {name: 'X', kind: 'linear', side: 'tool', direction: [1, 0, 0], point_mm: [0, 0, 0], travel_min_mm: 0, travel_max_mm: 400},
    {name: 'Z', kind: 'linear', side: 'tool', direction: [0, 0, 1], point_mm: [0, 0, 0], travel_min_mm: 0, travel_max_mm: 500},
    {name: 'A', kind: 'rotary', side: 'tool', direction: [1, 0, 0], point_mm: [0, 0, 0], travel_min_deg: -30, travel_max_deg: 30},
    {name: 'Y', kind: 'linear', side: 'tool', direction: [0, 1, 0], point_mm: [0, 0, 0], travel_min_mm: 0, travel_max_mm: 200},
    {name: 'B', kind: 'rotary', side: 'tool', direction: [0, Math.SQRT1_2, Math.SQRT1_2], point_mm: [0, 0, 0], travel_min_deg: -45, travel_max_deg: 45}]};
const mapOnly = {
  format: 'abbe-report/1', title: 'Integrated error of a published machine', simulated: false, machine: grinder,
  summary: {machine: grinder.name, chain: grinder.chain,
    map: {quantity: 'integrated error', poses: 1771561, description: 'full travel, 11 steps per axis', reference: 'model', position_before_um: data.summary.held_out.position_before_um}},
  warnings: ['The unit of the angles is inferred, not stated in the source.'],
  map: {...map, quantity: 'integrated error', after_um: undefined, poses: 1771561},
  histograms: [{title: 'Integrated error over all poses', edges_um: Array.from({length: 41}, (_, i) => 12.5 * i), before_counts: counts.map(Math.round)}],
  error_motions: motions.map((m, i) => Object.fromEntries(Object.entries(m).filter(([k]) => !/^(expanded|truth)/.test(k)).map(([k, v]) => [k, i === 4 && k.startsWith('value') ? v.map(() => 0) : v]))),
  tables: [{title: 'Published figures beside ours', columns: ['Pose', 'Published / mm', 'Here / mm', 'Why'], rows: [['i = 1', -5.39, -5.400842, 'sign of one column'], ['i = 7', null, 0.001, 'sum is wrong in print']], note: 'The published sum does not add up.'}],
};

// Everything that can be empty, single, zero or missing.
const edge = {
  format: 'abbe-report/1', title: 'An unfortunate day: nothing moved & <b>nothing</b> converged', subtitle: 'Averyveryveryverylongstudynamewithoutanyplacetobreakthelineinanarrowwindow',
  machine: {name: 'One axis', chain: 'w b X t', axes: [{name: 'X', kind: 'linear', side: 'tool'}]},
  summary: {status: 'rank deficient', converged: false, readings: 1, outliers: 1, parameters: 5, rank: 0, null_space: 5, degrees_of_freedom: 0, chi_square: null,
    held_out: {position_before_um: {mean: 0, max: 0}}},
  warnings: ['All readings are at one pose.'],
  map: {positions: {X_mm: [0]}, point_mm: {x: [0], y: [0], z: [0]}, before_um: {x: [0], y: [0], z: [0]}, after_um: {x: [0], y: [0], z: [0]}},
  histograms: [{before_um: [], after_um: []}, {edges_um: [0, 1], before_counts: [0]}],
  error_motions: [{name: 'EXX', axis: 'X', position_mm: [0], value_um: [0]}, {name: 'EYX', axis: 'X', position_mm: [0, 1], value_um: [1e-9, -1e9], expanded_uncertainty_um: [0, 1e10]}],
  location_errors: [{name: 'EC0X', value_urad: 0, standard_uncertainty_urad: null}],
  parameters: {name: ['EXX[P0]', 'EXX[P1]'], value: [0, null]},
  residuals: {setups: [{name: 'empty', reading: [], components: [{name: 'x', normalised: []}]}, {name: 'null', reading: [0], components: [{name: 'x', unit: 'um', normalised: [null], residual: [null]}, {name: 'y', normalised: [0]}]}, {name: 'none', reading: []}]},
  identification: {singular_values: [0, 0], history: {iteration: [0], chi_square: [0]}, order_selection: {label: ['1'], held_out_normalised_rms: [null]}, gauge: [{parameters: ['EXX[P0]']}]},
  tables: [{title: 'Nothing', columns: [], rows: []},
    {title: 'Courses', columns: ['error', 'unit'], rows: [['none', 'um'], ['one', 'um'], ['still', 'um'], ['gaps', 'urad'], ['beyond', 'um']], sparklines: [
      {days: [], value: []}, {days: [0], value: [0], expanded_uncertainty: [1]}, {days: [0, 90, 90], value: [1, 1, 1], expanded_uncertainty: [0, 0, 0], control_low: [null, 1, 1], control_high: [null, 1, 1]},
      {days: [0, 90, 180], value: [0, null, -1e6], control_low: [null, null, -2e6], control_high: [null, null, 0]},
      {days: [0, 90, 180], value: [0, -3, 40], expanded_uncertainty: [2, 2, 2], control_low: [null, -6, -17], control_high: [null, 6, 5]}], note: 'In um and urad.'}], advice: [{text: 'Everything.'}],
};

const [, , dataFile, pageFile, templateFile] = process.argv;
if (dataFile) writeFileSync(dataFile, JSON.stringify(data));
if (pageFile) {
  const template = readFileSync(templateFile, 'utf8');
  const write = (name, content) => writeFileSync(pageFile.replace(/\.html$/, `${name}.html`),
    template.replace('@@ABBE_DATA@@', () => JSON.stringify(content).replace(/</g, '\\u003c')));
  write('', data);
  write('-map', mapOnly);
  write('-edge', edge);
  write('-smallest', {format: 'abbe-report/1', title: 'Nothing but a title'});
}
