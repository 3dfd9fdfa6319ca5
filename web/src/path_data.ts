// A tool path as the data hold it, and where everything is at a moment of it; docs/report-data.md, "path".

import {Vectors} from './data';

export interface PathBlock {
  title?: string;
  /// Of all; the columns hold those that are drawn.
  moves?: number;
  time_s: number[];
  working: number[];
  /// Keys of the commands in the order of the chain.
  axes?: string[];
  commands: Record<string, number[]>;
  travel?: Record<string, [number, number]>;
  point_mm: Vectors;
  /// Unit, from the functional point to the spindle, source or probe.
  direction: Vectors;
  feed_mm_per_min?: number[];
  length_mm?: number[];
  tool?: {kind?: 'beam' | 'probe' | 'tool'; radius_mm?: number; length_mm?: number; working_distance_mm?: number};
  /// The machine stands still at each pose and a reading is taken there; the ways between are drawn pale.
  stops?: boolean;
  note?: string;
}

/// A place between two moves.
export interface Moment {
  /// The move that goes on.
  move: number;
  share: number;
  time: number;
}

/// Time of the animation: that of the machine, but moves whose time is not known take a little too.
export function animationTimes(block: PathBlock): number[] {
  const n = block.time_s.length;
  const total = n ? block.time_s[n - 1] : 0;
  const least = total > 0 ? total / (4 * n) : 1;
  const times = [0];
  for (let i = 1; i < n; ++i) times.push(times[i - 1] + Math.max(block.time_s[i] - block.time_s[i - 1], least));
  return times;
}

export function momentAt(block: PathBlock, times: number[], at: number): Moment {
  let low = 0;
  let high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= at) low = middle;
    else high = middle;
  }
  const share = high > low ? Math.min(1, Math.max(0, (at - times[low]) / (times[high] - times[low]))) : 0;
  return {move: high, share, time: block.time_s[low] + share * (block.time_s[high] - block.time_s[low])};
}

/// A column at that moment, linear within a move.
export function valueAt(column: number[], moment: Moment): number {
  const before = column[Math.max(0, moment.move - 1)];
  return before + moment.share * (column[moment.move] - before);
}
