// A part cut by a plane: the lines of the cut and the points of the scan near it, in the plane's own coordinates.

import {Surface} from './surface_data';

export type Triple = [number, number, number];

export interface Plane {
  /// Unit; `offset` is the distance of the plane from the origin along it, mm.
  normal: Triple;
  offset: number;
  /// Unit vectors in the plane: to the right and up on the drawing.
  right: Triple;
  up: Triple;
}

/// One end of a line of the cut: place on the drawing (mm), direction of a deviation there, its value (um, NaN: none).
export interface CutEnd {
  at: [number, number];
  out: [number, number];
  value: number;
}

export interface Cut {
  lines: [CutEnd, CutEnd][];
  /// [6 lines] mm, in the frame of the part
  ends: Float32Array;
}

export interface NearPoint extends CutEnd {
  index: number;
}

const dot = (a: Triple, b: Triple) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Triple, b: Triple): Triple => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a: Triple): Triple => {
  const length = Math.hypot(...a);
  return [a[0] / length, a[1] / length, a[2] / length];
};

/// @returns undefined for a normal without a direction
export function planeOf(normal: Triple, offset: number): Plane | undefined {
  if (!(Math.hypot(...normal) > 1e-12) || !normal.every(Number.isFinite)) return undefined;
  const n = unit(normal);
  if (Math.abs(n[0]) < 1e-9 && Math.abs(n[2]) < 1e-9) return {normal: n, offset, right: [1, 0, 0], up: [0, 0, 1]};
  const right: Triple = Math.abs(n[2]) > 1 - 1e-9 ? [1, 0, 0] : unit(cross([0, 0, 1], n));
  return {normal: n, offset, right, up: cross(n, right)};
}

const triple = (values: Float32Array, i: number): Triple => [values[3 * i], values[3 * i + 1], values[3 * i + 2]];

/// In the plane, unit; zero where the direction is almost along the plane's normal.
function flatDirection(direction: Triple, plane: Plane): [number, number] {
  const flat: [number, number] = [dot(direction, plane.right), dot(direction, plane.up)];
  const length = Math.hypot(...flat);
  return length > 0.3 * Math.hypot(...direction) ? [flat[0] / length, flat[1] / length] : [0, 0];
}

export function cutBy(surface: Surface, plane: Plane): Cut {
  const {vertices, normals, triangles, values} = surface;
  const distance = new Float64Array(vertices.length / 3);
  // A vertex on the plane counts as above it, so that every line has two ends.
  for (let i = 0; i < distance.length; ++i) distance[i] = dot(triple(vertices, i), plane.normal) - plane.offset || 1e-12;
  const lines: [CutEnd, CutEnd][] = [];
  const ends: number[] = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const found: CutEnd[] = [];
    const places: Triple[] = [];
    for (let k = 0; k < 3; ++k) {
      let [a, b] = [triangles[t + k], triangles[t + ((k + 1) % 3)]];
      if (distance[a] > 0 === distance[b] > 0) continue;
      // The same arithmetic from both triangles of an edge.
      if (a > b) [a, b] = [b, a];
      const share = distance[a] / (distance[a] - distance[b]);
      const mix = (from: Float32Array): Triple => [0, 1, 2].map((m) => from[3 * a + m] + share * (from[3 * b + m] - from[3 * a + m])) as Triple;
      const place = mix(vertices);
      places.push(place);
      found.push({at: [dot(place, plane.right), dot(place, plane.up)], out: flatDirection(mix(normals), plane),
        value: values ? values[a] + share * (values[b] - values[a]) : NaN});
    }
    if (found.length !== 2) continue;
    lines.push([found[0], found[1]]);
    ends.push(...places[0], ...places[1]);
  }
  return {lines, ends: new Float32Array(ends)};
}

/// Points whose feet lie within `half` mm of the plane, moved along the surface into it.
export function pointsNear(surface: Surface, plane: Plane, half: number): NearPoint[] {
  const points = surface.points;
  const near: NearPoint[] = [];
  if (!points) return near;
  for (let i = 0; i < points.values.length; ++i) {
    const foot = triple(points.feet, i);
    const off = dot(foot, plane.normal) - plane.offset;
    if (Math.abs(off) > half) continue;
    const normal = triple(points.normals, i);
    const slope = dot(normal, plane.normal);
    const out = flatDirection(normal, plane);
    // Where the surface is almost parallel to the plane, a point has no place in the cut.
    if (out[0] === 0 && out[1] === 0) continue;
    // Down the tangent plane, across the line of the cut.
    const along = -off / (1 - slope * slope);
    const at = foot.map((v, k) => v + along * (plane.normal[k] - slope * normal[k])) as Triple;
    near.push({index: i, at: [dot(at, plane.right), dot(at, plane.up)], out, value: points.values[i]});
  }
  return near;
}
