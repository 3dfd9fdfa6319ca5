// A plan of readings as the data hold it; docs/report-data.md, "plan".

import {Column} from './data';

export interface PlanBlock {
  curve?: {
    readings: number[];
    /// Null: so many readings do not determine everything.
    uncertainty_um: Column;
    grid_readings?: Column;
    grid_uncertainty_um?: Column;
    /// Index into the columns.
    enough?: number;
  };
  enough_words?: string;
  /// What no reading of the plan determines, in sentences.
  open?: string[];
  readings?: {columns: string[]; rows: string[][]};
}
