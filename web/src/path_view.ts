// Part, path and tool in three dimensions.

import {
  BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, Points, PointsMaterial, Quaternion, Vector3,
} from 'three';

import {Camera} from './camera';
import {Rgb} from './colour';
import {Moment, PathBlock, valueAt} from './path_data';
import {Surface} from './surface_data';
import {SurfaceView} from './surface_view';

/// Covered, then reasons why not: told apart by lightness too.
const kCoverage: Rgb[] = [[0.36, 0.66, 0.62], [0.85, 0.37, 0.1], [0.48, 0.2, 0.58], [0.99, 0.78, 0.28], [0.16, 0.16, 0.2], [0.9, 0.55, 0.75]];

/// Of a reason: as the data say, else one of those above.
export function coverageColour(reason: number, colours?: string[]): Rgb {
  const text = colours?.[reason];
  if (text && /^#[0-9a-f]{6}$/i.test(text)) return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255) as Rgb;
  return kCoverage[Math.min(reason, kCoverage.length - 1)];
}

const kEmpty: Surface = {frame: 'workpiece', vertices: new Float32Array(), normals: new Float32Array(), triangles: new Uint16Array(), limit: 1, step: 1};

export class PathView extends SurfaceView {
  private readonly tool = new Group();
  private readonly done = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  private readonly ahead = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  private readonly rapid = new LineSegments(new BufferGeometry(), new LineBasicMaterial({transparent: true, opacity: 0.45}));
  private readonly taken = new Points(new BufferGeometry(), new PointsMaterial({size: 5, sizeAttenuation: false}));
  private readonly toTake = new Points(new BufferGeometry(), new PointsMaterial({size: 3, sizeAttenuation: false}));
  private readonly beam: LineSegments<BufferGeometry, LineBasicMaterial>;
  private reasonOfVertex: Uint8Array | undefined;
  private readonly colours: string[] | undefined;
  private readonly hasPart: boolean;

  constructor(
    title: string,
    private readonly path: PathBlock,
    part: Surface | undefined,
    camera: Camera,
  ) {
    super(title, coloured(part) ?? kEmpty, camera);
    this.reasonOfVertex = part?.coverage && reasons(part);
    this.colours = part?.coverage?.colours;
    this.hasPart = part !== undefined;
    this.beam = this.makeTool();
    for (const line of [this.done, this.ahead, this.rapid]) line.frustumCulled = false;
    this.layLines();
    this.scene.add(this.tool, this.done, this.ahead, this.rapid);
    if (path.stops) {
      const places = new BufferAttribute(new Float32Array(path.time_s.flatMap((_, i) => this.point(i))), 3);
      for (const marks of [this.taken, this.toTake]) {
        marks.geometry.setAttribute('position', places);
        marks.frustumCulled = false;
        this.scene.add(marks);
      }
      (this.rapid.material as LineBasicMaterial).opacity = 0.22;
    }
    this.update('points', 1, 0);
  }

  /// Body behind the working distance, with the beam (or its stylus) up to the functional point, which is the origin.
  private makeTool(): LineSegments<BufferGeometry, LineBasicMaterial> {
    const size = this.shared.size;
    const stated = this.path.tool ?? {};
    const far = stated.working_distance_mm ?? (stated.kind === 'beam' ? size * 0.08 : 0);
    const radius = Math.min(stated.radius_mm ?? size * 0.02, size * 0.08);
    const length = Math.min(stated.length_mm ?? size * 0.2, size * 0.35);
    const material = new MeshLambertMaterial({color: 0x8a949d, transparent: true, opacity: 0.85});
    const head = Math.min(2 * radius, 0.4 * length);
    const tip = new Mesh(new ConeGeometry(radius, head, 24, 1, true).rotateX(Math.PI).translate(0, far + head / 2, 0), material);
    const body = new Mesh(new CylinderGeometry(radius, radius, length - head, 24).translate(0, far + head + (length - head) / 2, 0), material);
    this.tool.add(tip, body);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array([0, 0, 0, 0, far + head / 2, 0]), 3));
    const beam = new LineSegments(geometry, new LineBasicMaterial());
    this.tool.add(beam);
    return beam;
  }

  private point(i: number): number[] {
    const p = this.path.point_mm;
    return [p.x[i], p.y[i], p.z[i]];
  }

  /// Towards the tool: a line in the surface, drawn in triangles, would be hidden by half of them.
  private lifted(i: number): number[] {
    const d = this.path.direction;
    const lift = this.hasPart ? 0.004 * this.shared.size : 0;
    return this.point(i).map((v, k) => v + lift * d[(['x', 'y', 'z'] as const)[k]][i]);
  }

  private layLines(): void {
    const working: number[] = [];
    const rapid: number[] = [];
    for (let i = 1; i < this.path.time_s.length; ++i) {
      if (this.path.working[i]) working.push(...this.lifted(i - 1), ...this.lifted(i));
      else rapid.push(...this.point(i - 1), ...this.point(i));
    }
    this.ahead.geometry.setAttribute('position', new BufferAttribute(new Float32Array(working), 3));
    this.done.geometry.setAttribute('position', new BufferAttribute(new Float32Array(working), 3));
    this.rapid.geometry.setAttribute('position', new BufferAttribute(new Float32Array(rapid), 3));
  }

  moveTo(moment: Moment): void {
    const {point_mm: p, direction: d} = this.path;
    this.tool.position.set(valueAt(p.x, moment), valueAt(p.y, moment), valueAt(p.z, moment));
    const direction = new Vector3(valueAt(d.x, moment), valueAt(d.y, moment), valueAt(d.z, moment));
    if (direction.lengthSq() > 1e-12) this.tool.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), direction.normalize()));
    let count = 0;
    for (let i = 1; i < moment.move; ++i) if (this.path.working[i]) ++count;
    this.done.geometry.setDrawRange(0, 2 * count);
    this.ahead.geometry.setDrawRange(2 * count, Infinity);
    this.taken.geometry.setDrawRange(0, moment.move);
    this.toTake.geometry.setDrawRange(moment.move, Infinity);
    this.beam.visible = Boolean(this.path.working[moment.move]) || this.path.tool?.kind !== 'beam';
    this.render();
  }

  get hasRapid(): boolean {
    return this.rapid.geometry.getAttribute('position').count > 0;
  }

  showRapid(shown: boolean): void {
    this.rapid.visible = shown;
    this.render();
  }

  protected vertexColour(vertex: number, dark: boolean): Rgb {
    if (this.reasonOfVertex) return coverageColour(this.reasonOfVertex[vertex], this.colours);
    return super.vertexColour(vertex, dark);
  }

  protected paint(dark: boolean): void {
    super.paint(dark);
    // On the colours of a coverage, which are the same in both themes: light and dark.
    const onColours = Boolean(this.reasonOfVertex);
    (this.done.material as LineBasicMaterial).color.set(onColours ? 0xfff2a8 : dark ? 0x5cc3c9 : 0x0b6e75);
    (this.ahead.material as LineBasicMaterial).color.set(dark && !onColours ? 0xe6eaed : 0x1a2127);
    (this.rapid.material as LineBasicMaterial).color.set(dark ? 0xe9965b : 0xb4551d);
    (this.taken.material as PointsMaterial).color.set(dark ? 0x5cc3c9 : 0x0b6e75);
    (this.toTake.material as PointsMaterial).color.set(dark ? 0xe6eaed : 0x1a2127);
    this.beam.material.color.set(dark ? 0xff8a80 : 0xb3261e);
  }
}

/// A triangle has one reason: its corners are its own.
function coloured(part: Surface | undefined): Surface | undefined {
  if (!part?.coverage) return part;
  const vertices = new Float32Array(3 * part.triangles.length);
  const normals = new Float32Array(3 * part.triangles.length);
  part.triangles.forEach((vertex, i) => {
    for (let k = 0; k < 3; ++k) {
      vertices[3 * i + k] = part.vertices[3 * vertex + k];
      normals[3 * i + k] = part.normals[3 * vertex + k];
    }
  });
  return {...part, vertices, normals, triangles: Uint32Array.from(part.triangles, (_, i) => i)};
}

function reasons(part: Surface): Uint8Array {
  return Uint8Array.from(part.triangles, (_, i) => part.coverage!.ofTriangle[Math.floor(i / 3)]);
}
