// Data of a verified compensation, as docs/report-data.md describes them.

/// Shares of the poses and the error below which they lie.
export interface CompensationDistribution {
  percent: number[];
  before_um: number[];
  after_um: number[];
  /// As errors with the predicted uncertainties would lie.
  predicted_um?: number[];
}

/// The foot or the head of a ruled surface, drawn in a plane; best fit of the workpiece taken out.
export interface PieceEdge {
  name: string;
  s_mm: number[];
  x_mm: number[];
  y_mm: number[];
  /// Unit, out of the material, in the plane of the drawing.
  out_x: number[];
  out_y: number[];
  before_um: number[];
  after_um: number[];
  /// Of all samples, where more were taken than are drawn.
  range_before_um?: number;
  range_after_um?: number;
}

export interface VerifiedPiece {
  name: string;
  description?: string;
  closed?: boolean;
  edges: PieceEdge[];
  figures?: {name: string; before_um: number; after_um: number}[];
}

export interface VerificationBlock {
  poses?: number;
  distribution?: CompensationDistribution;
  pieces?: VerifiedPiece[];
  wanted?: {text: string; met: boolean}[];
}
