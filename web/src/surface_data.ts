// A part with its deviations, unpacked from the data; docs/report-data.md, "surface".

import {bytes, int16, int8, uint16, uint32} from './packed';

export interface SurfaceBlock {
  frame?: string;
  quantity?: string;
  triangles_of_part?: number;
  thinned_cell_mm?: number;
  lower_mm: number[];
  step_mm: number;
  vertex_count: number;
  triangle_count: number;
  vertices: string;
  triangles: string;
  limit_um?: number;
  value_step_um?: number;
  averaging_radius_mm?: number;
  values?: string;
  points?: {measured: number; counted: number; drawn: number; foot: string; normal: string; values: string};
  coverage?: {reasons: string[]; of_triangle: string; percent?: number[]; colours?: string[]};
}

export interface Surface {
  frame: string;
  /// [3 vertices] mm
  vertices: Float32Array;
  /// [3 vertices] unit, area-weighted over the triangles of a vertex
  normals: Float32Array;
  /// [3 triangles]
  triangles: Uint16Array | Uint32Array;
  /// [vertices] um, NaN where no point lies near; undefined: the part alone
  values?: Float32Array;
  points?: SurfacePoints;
  coverage?: {reasons: string[]; ofTriangle: Uint8Array; colours?: string[]};
  limit: number;
  /// um, of the numbers in the data: what is beyond their range is written as its end
  step: number;
}

export interface SurfacePoints {
  /// [3 points] mm, on the surface
  feet: Float32Array;
  /// [3 points] unit
  normals: Float32Array;
  /// [points] um
  values: Float32Array;
}

const kNone = -32768;

function places(text: string, block: SurfaceBlock): Float32Array {
  const steps = uint16(text);
  return Float32Array.from(steps, (n, i) => block.lower_mm[i % 3] + n * block.step_mm);
}

function vertexNormals(vertices: Float32Array, triangles: Uint16Array | Uint32Array): Float32Array {
  const normals = new Float32Array(vertices.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [ux, uy, uz] = [vertices[b] - vertices[a], vertices[b + 1] - vertices[a + 1], vertices[b + 2] - vertices[a + 2]];
    const [vx, vy, vz] = [vertices[c] - vertices[a], vertices[c + 1] - vertices[a + 1], vertices[c + 2] - vertices[a + 2]];
    const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const corner of [a, b, c]) for (let k = 0; k < 3; ++k) normals[corner + k] += n[k];
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    for (let k = 0; k < 3; ++k) normals[i + k] /= length;
  }
  return normals;
}

export function unpackSurface(block: SurfaceBlock): Surface {
  const vertices = places(block.vertices, block);
  const triangles = block.vertex_count > 65536 ? uint32(block.triangles) : uint16(block.triangles);
  const step = block.value_step_um ?? 1;
  const values = (text: string) => Float32Array.from(int16(text), (n) => (n === kNone ? NaN : n * step));
  const points = block.points && {
    feet: places(block.points.foot, block),
    normals: Float32Array.from(int8(block.points.normal), (n) => n / 127),
    values: values(block.points.values),
  };
  return {
    frame: block.frame ?? 'part', vertices, triangles, normals: vertexNormals(vertices, triangles), limit: block.limit_um ?? 1, step,
    values: block.values === undefined ? undefined : values(block.values), points,
    coverage: block.coverage && {reasons: block.coverage.reasons, ofTriangle: bytes(block.coverage.of_triangle), colours: block.coverage.colours},
  };
}
