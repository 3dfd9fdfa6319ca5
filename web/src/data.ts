// Data of a report, as docs/report-data.md describes it. Everything but format and title is optional.

import {PathBlock} from './path_data';
import {PlanBlock} from './plan_data';
import {SurfaceBlock} from './surface_data';
import {VerificationBlock} from './verification_data';

export type Column = (number | null)[];

export interface Statistics {
  mean?: number;
  rms?: number;
  median?: number;
  p90?: number;
  p95?: number;
  p99?: number;
  max?: number;
}

export interface PoseErrors {
  poses?: number;
  description?: string;
  reference?: string;
  /// Name of what is stated: "true volumetric error", "residual of held-out readings", ...
  quantity?: string;
  /// Held-out readings: root mean square of residuals over stated uncertainties.
  times_stated_uncertainty?: number;
  position_before_um?: Statistics;
  position_after_um?: Statistics;
  orientation_before_urad?: Statistics;
  orientation_after_urad?: Statistics;
  predicted_expanded_uncertainty_um?: Statistics;
  uncertainty_covers?: string;
  outside_range?: number;
  coverage_percent?: number;
  remaining_percent?: number;
  /// Mean before over mean after.
  reduction?: number;
  /// Root mean square after over that of the predicted standard uncertainty.
  uncertainty_ratio?: number;
}

/// Volumetric error over the grid of all commands. Predicted: what is left is stated with k = 2.
export interface VolumetricError {
  poses?: number;
  description?: string;
  outside_range?: number;
  before_um?: Statistics;
  after_um?: Statistics;
  after_expanded_um?: Statistics;
  uncertainty_covers?: string;
}

/// What the fit leaves of the readings, against their stated uncertainties.
export interface ResidualFigures {
  residuals?: number;
  outliers?: number;
  times_stated_uncertainty?: number;
  times_stated_uncertainty_without_outliers?: number;
  length_um?: Statistics;
  length_without_outliers_um?: Statistics;
}

export interface Summary {
  study?: string;
  machine?: string;
  chain?: string;
  verdict?: string;
  status?: string;
  converged?: boolean;
  iterations?: number;
  readings?: number;
  outliers?: number;
  residuals?: number;
  parameters?: number;
  machine_parameters?: number;
  setup_parameters?: number;
  rank?: number;
  null_space?: number;
  degrees_of_freedom?: number;
  chi_square?: number;
  chi_square_probability?: number;
  observability_index?: number;
  observability_index_kind?: string;
  condition_number?: number;
  normalised_residual_rms?: number;
  fit_residual_um?: Statistics;
  residual?: ResidualFigures;
  predicted_volumetric_error?: VolumetricError;
  true_volumetric_error?: VolumetricError;
  held_out?: PoseErrors;
  map?: PoseErrors;
  monte_carlo?: MonteCarlo;
  seed?: number;
}

export interface MonteCarlo {
  samples?: number;
  compared?: number;
  smallest_uncertainty_ratio?: number;
  largest_uncertainty_ratio?: number;
  chance_ratio_low?: number;
  chance_ratio_high?: number;
  largest_shift?: number;
  chance_shift?: number;
  beyond_chance?: number;
  agrees?: boolean;
}

export interface Axis {
  name: string;
  kind: 'linear' | 'rotary';
  side: 'workpiece' | 'tool';
  primed?: boolean;
  direction?: number[];
  point_mm?: number[];
  travel_min_mm?: number;
  travel_max_mm?: number;
  travel_min_deg?: number;
  travel_max_deg?: number;
  endless?: boolean;
}

export interface Machine {
  name?: string;
  description?: string;
  chain?: string;
  axes?: Axis[];
  tool_offset_mm?: number[];
  tool_reference_mm?: number[];
  tool_direction?: number[];
  workpiece_origin_mm?: number[];
}

export interface Vectors {
  x: number[];
  y: number[];
  z: number[];
}

export interface Rotations {
  a: number[];
  b: number[];
  c: number[];
}

export interface ErrorMap {
  /// What the vectors are, if not the volumetric error of the tool.
  quantity?: string;
  frame?: string;
  poses?: number;
  description?: string;
  positions?: Record<string, number[]>;
  point_mm: Vectors;
  before_um: Vectors;
  after_um?: Vectors;
  before_urad?: Rotations;
  after_urad?: Rotations;
  expanded_uncertainty_um?: number[];
  note?: string;
}

export type Histogram = {title?: string} & Record<string, unknown>;

/// Keys carry units: position_mm or position_deg, value_um or value_urad, ...
export type ErrorMotion = {name: string; axis: string; component?: string; basis?: string; note?: string} & Record<
  string,
  unknown
>;
export type LocationError = {name: string; axis?: string; note?: string} & Record<string, unknown>;

export interface Parameters {
  name: string[];
  group?: string[];
  unit?: string[];
  value: Column;
  standard_uncertainty?: Column;
  largest_correlation?: Column;
  correlated_with?: string[];
  gauge?: string[];
  truth?: Column;
  monte_carlo_uncertainty?: Column;
  monte_carlo_ratio?: Column;
  monte_carlo_low?: Column;
  monte_carlo_high?: Column;
}

/// One component of the readings of a set-up; `unit` is that of `residual`, as in the keys: um, urad, mm, deg, ...
export interface ResidualComponent {
  name: string;
  unit?: string;
  normalised: Column;
  residual?: Column;
}

export interface SetupResiduals {
  name: string;
  readings?: number;
  reading: number[];
  time_s?: number[];
  positions?: Record<string, number[]>;
  components: ResidualComponent[];
  outlier_limit?: number;
  outlier?: (number | boolean)[];
  held_out?: (number | boolean)[];
}

export interface Identification {
  strategy?: string;
  loss?: string;
  rank_threshold?: number;
  singular_values?: number[];
  hardly_seen?: number;
  gauge?: {parameters?: string[]; text?: string; convention?: string; by_convention?: boolean}[];
  history?: {iteration?: number[]; chi_square?: Column; relative_step?: Column; damping?: Column};
  stages?: {status?: string; parameters?: number; residuals?: number; degrees_of_freedom?: number; chi_square?: number}[];
  order_selection?: {label?: string[]; held_out_normalised_rms?: Column; chosen?: number};
  strategies?: {
    name: string;
    mean_before_um?: number;
    mean_after_um?: number;
    max_after_um?: number;
    published_percent?: number;
    note?: string;
  }[];
}

export interface DataTable {
  title: string;
  columns: string[];
  rows: (string | number | boolean | null)[][];
  /// For each row, drawn in a second column.
  sparklines?: SparklineData[];
  note?: string;
}

/// The course of one value, in the unit of its row.
export interface SparklineData {
  days: number[];
  value: (number | null)[];
  expanded_uncertainty?: (number | null)[];
  control_low?: (number | null)[];
  control_high?: (number | null)[];
}

/// An evaluation by a standard or of a scan; values carry their units in the keys: value_um, tolerance_um.
export type EvaluationFigure = {symbol: string; name?: string; decimals?: number; verdict?: string; not_evaluated?: string} & Record<string, unknown>;

export interface Evaluation {
  kind?: string;
  facts?: {name: string; text: string}[];
  figures?: EvaluationFigure[];
  /// `svg_narrow`: the same for a narrow window; `beside`: small, two in a row
  drawings?: {caption?: string; svg: string; svg_narrow?: string; beside?: boolean}[];
  /// Shown before the figures.
  tables?: DataTable[];
}

/// Contour error over the length of a curve; u is the standard uncertainty.
export interface ContourBlock {
  title?: string;
  points?: number;
  s_mm: number[];
  error_um: number[];
  u_um?: number[];
  /// Lower and upper, or one.
  limits_um?: number[];
  /// Of the amounts; the mean with signs is the bias.
  mean_um?: number;
  largest_um?: number;
  standard_deviation_um?: number;
  bias_um?: number;
  /// False: neighbours are not one behind the other on the curve, no line joins them.
  joined?: boolean;
  /// What s_mm counts if it is no length: "section".
  counted?: string;
  /// Beside the contour error, at places of its own.
  also?: {name: string; s_mm: number[]; value_um: number[]}[];
  sections?: ContourSection[];
  sections_in_all?: number;
  note?: string;
}

/// A cross-section: across the curve and out of the surface, µm, its origin on the commanded curve.
export interface ContourSection {
  name: string;
  s_mm?: number;
  error_um?: number;
  u_um?: number;
  not_evaluated?: string;
  across_um: number[];
  height_um: number[];
  edges?: EdgeDrawing[];
}

/// What was fitted to an edge: surface, rounding and wall as one line, where the rounding begins, the corner.
export interface EdgeDrawing {
  across_um: number[];
  height_um: number[];
  P1_um: number[];
  P2_um: number[];
}

export interface Report {
  format: string;
  title: string;
  subtitle?: string;
  evaluation?: Evaluation;
  surface?: SurfaceBlock;
  path?: PathBlock;
  plan?: PlanBlock;
  contour?: ContourBlock | ContourBlock[];
  verification?: VerificationBlock;
  generator?: string;
  created?: string;
  study?: {name?: string; file?: string; seed?: number};
  simulated?: boolean;
  machine?: Machine;
  summary?: Summary;
  warnings?: (string | {level?: string; text: string})[];
  assumptions?: string[];
  map?: ErrorMap;
  histograms?: Histogram[];
  error_motions?: ErrorMotion[];
  location_errors?: LocationError[];
  parameters?: Parameters;
  residuals?: {setups?: SetupResiduals[]};
  identification?: Identification;
  tables?: DataTable[];
  advice?: Advice[];
  not_identified?: NotIdentified;
  references?: string[];
}

/// What the measurement cannot see, and which additional measurement would show it.
export interface Advice {
  /// "not measured", "weak", "convention", "datum" or "set-up".
  kind?: string;
  parameters?: string[];
  text: string;
  /// The parameters in words of ISO 230.
  words?: string;
  remedy?: string;
}

/// Errors of the machine that were taken as zero, and what would show them.
export interface NotIdentified {
  errors: string[];
  words?: string[];
  text: string;
  shown_by?: {errors: string[]; by_these_readings?: boolean; remedy: string}[];
}

const kUnits: [string, string][] = [
  ['_um', 'µm'],
  ['_urad', 'µrad'],
  ['_mrad', 'mrad'],
  ['_mm', 'mm'],
  ['_deg', '°'],
  ['_arcsec', '″'],
  ['_s', 's'],
  ['_min', 'min'],
  ['_percent', '%'],
  ['_um_per_m', 'µm/m'],
  ['_ms', 'ms'],
  ['_K', 'K'],
  ['_K_per_h', 'K/h'],
];

/// A unit as it is written in data, as it is written for people.
export function unitText(unit: string | undefined): string {
  return kUnits.find(([suffix]) => suffix === `_${unit}`)?.[1] ?? unit ?? '';
}

/// Unit written in a key: "X_mm" gives {name: "X", unit: "mm"}; without a unit the unit is empty.
export function splitUnit(key: string): {name: string; unit: string} {
  for (const [suffix, unit] of kUnits)
    if (key.endsWith(suffix)) return {name: key.slice(0, -suffix.length), unit};
  return {name: key, unit: ''};
}

/// The quantity `name` of an object whose key carries one of the units: find(motion, "value") finds value_um or value_urad.
export function findQuantity<T>(object: Record<string, unknown>, name: string): {value: T; unit: string} | undefined {
  for (const [suffix, unit] of kUnits) {
    const value = object[name + suffix];
    if (value !== undefined && value !== null) return {value: value as T, unit};
  }
  return undefined;
}
