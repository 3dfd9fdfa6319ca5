// A part in three dimensions, coloured by the deviation of a scan, or the scan's points on it.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, Points, PointsMaterial, Raycaster,
  SRGBColorSpace, Vector2, Vector3,
} from 'three';

import {Camera} from './camera';
import {isDark, Rgb} from './colour';
import {divergingColour} from './diverging';
import {Stage} from './stage';
import {Surface} from './surface_data';

export type Shown = 'surface' | 'points';

/// What lies under the pointer.
export interface Reading {
  value: number;
  at: [number, number, number];
  /// True: a point of the scan; else the mean of the points near a place of the surface.
  isPoint: boolean;
}

// Apart from the colour of no deviation, which points on it have.
const kPlainLight: Rgb = [0.56, 0.6, 0.64];
const kPlainDark: Rgb = [0.27, 0.3, 0.33];
const kReach = 7;

export class SurfaceView extends Stage {
  private shown: Shown = 'surface';
  private limit = 1;
  private factor = 0;
  private readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  private readonly dots?: Points<BufferGeometry, PointsMaterial>;
  private readonly light = new DirectionalLight(0xffffff, 1.3);
  private readonly ray = new Raycaster();
  private readonly cut = new LineSegments(new BufferGeometry(), new LineBasicMaterial());

  constructor(
    title: string,
    protected readonly surface: Surface,
    shared: Camera,
  ) {
    super(title, shared);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(surface.vertices.slice(), 3));
    geometry.setAttribute('normal', new BufferAttribute(surface.normals, 3));
    geometry.setAttribute('color', new BufferAttribute(new Float32Array(surface.vertices.length), 3));
    geometry.setIndex(new BufferAttribute(surface.triangles, 1));
    this.mesh = new Mesh(geometry, new MeshLambertMaterial({vertexColors: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, side: 2}));
    this.mesh.frustumCulled = false;
    this.cut.frustumCulled = false;
    this.scene.add(this.mesh, this.cut, new AmbientLight(0xffffff, 1.9), this.light);
    if (surface.points) {
      const dots = new BufferGeometry();
      dots.setAttribute('position', new BufferAttribute(surface.points.feet.slice(), 3));
      dots.setAttribute('color', new BufferAttribute(new Float32Array(surface.points.feet.length), 3));
      this.dots = new Points(dots, new PointsMaterial({size: 3, sizeAttenuation: false, vertexColors: true}));
      this.dots.frustumCulled = false;
      this.scene.add(this.dots);
    }
  }

  /// @param limit   um, of the full colour
  /// @param factor  exaggeration of the deviations; 0: on the part itself
  update(shown: Shown, limit: number, factor: number): void {
    this.shown = shown;
    this.limit = limit;
    this.factor = factor;
    const {surface} = this;
    const values = shown === 'surface' ? surface.values : undefined;
    this.move(this.mesh.geometry, surface.vertices, surface.normals, values);
    if (this.dots && surface.points) {
      this.dots.visible = shown === 'points';
      this.move(this.dots.geometry, surface.points.feet, surface.points.normals, surface.points.values);
    }
    this.repaint();
    this.render();
  }

  /// A line on the part where a plane cuts it. @param ends  [6 lines] mm
  showCut(ends: Float32Array): void {
    // A section is drawn anew for another width too, and the same cut is there already.
    const there = this.cut.geometry.getAttribute('position')?.array;
    if (there?.length === ends.length && ends.every((value, i) => value === there[i])) return;
    this.cut.geometry.dispose();
    this.cut.geometry = new BufferGeometry();
    this.cut.geometry.setAttribute('position', new BufferAttribute(ends, 3));
    this.render();
  }

  private move(geometry: BufferGeometry, from: Float32Array, normals: Float32Array, values: Float32Array | undefined): void {
    const place = geometry.getAttribute('position') as BufferAttribute;
    for (let i = 0; i < from.length / 3; ++i) {
      const value = values?.[i] ?? 0;
      const by = Number.isNaN(value) ? 0 : value * 1e-3 * this.factor;
      for (let k = 0; k < 3; ++k) place.array[3 * i + k] = from[3 * i + k] + by * normals[3 * i + k];
    }
    place.needsUpdate = true;
    geometry.computeBoundingSphere();
  }

  /// Colour of a vertex; another view has another meaning of it.
  protected vertexColour(vertex: number, dark: boolean): Rgb {
    if (this.shown === 'points' || !this.surface.values) return dark ? kPlainDark : kPlainLight;
    return divergingColour(this.surface.values[vertex], this.limit);
  }

  protected repaint(): void {
    this.paint(isDark());
  }

  protected paint(dark: boolean): void {
    const shade = new Color();
    const fill = (geometry: BufferGeometry, colour: (i: number) => Rgb) => {
      const colours = geometry.getAttribute('color') as BufferAttribute;
      for (let i = 0; i < colours.count; ++i) {
        shade.setRGB(...colour(i), SRGBColorSpace);
        colours.setXYZ(i, shade.r, shade.g, shade.b);
      }
      colours.needsUpdate = true;
    };
    this.cut.material.color.set(dark ? 0xffffff : 0x000000);
    fill(this.mesh.geometry, (i) => this.vertexColour(i, dark));
    const {points} = this.surface;
    if (this.dots && points) fill(this.dots.geometry, (i) => divergingColour(points.values[i], this.limit));
  }

  protected prepare(): void {
    // From behind the reader's shoulder, so that no side is black.
    const camera = this.shared.camera;
    this.light.position.copy(camera.position).add(new Vector3(0.3, 0.5, 0).applyQuaternion(camera.quaternion).multiplyScalar(this.shared.size));
    this.light.target.position.copy(this.shared.target);
    this.light.target.updateMatrixWorld();
  }

  /// @param x, y  pixels of the canvas
  read(x: number, y: number): Reading | undefined {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    this.ray.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.shared.camera);
    const hit = this.ray.intersectObject(this.mesh, false)[0];
    if (this.shown === 'surface') {
      if (!hit?.face || !this.surface.values) return undefined;
      // Linear in the triangle, as the colours are; the place is that on the part, not on its exaggerated picture.
      const {vertices, values} = this.surface;
      const corners = [hit.face.a, hit.face.b, hit.face.c];
      const weights = (hit.barycoord ?? new Vector3(1 / 3, 1 / 3, 1 / 3)).toArray();
      const mean = (of: (corner: number) => number) => corners.reduce((sum, corner, k) => sum + weights[k] * of(corner), 0);
      return {value: mean((i) => values[i]), at: [0, 1, 2].map((k) => mean((i) => vertices[3 * i + k])) as Reading['at'], isPoint: false};
    }
    return this.nearestPoint(x, y, width, height, hit ? hit.distance : Infinity);
  }

  private nearestPoint(x: number, y: number, width: number, height: number, surfaceDistance: number): Reading | undefined {
    const points = this.surface.points;
    if (!points || !this.dots) return undefined;
    const place = this.dots.geometry.getAttribute('position');
    const camera = this.shared.camera;
    const at = new Vector3();
    let best = -1;
    let nearest = kReach * kReach;
    for (let i = 0; i < place.count; ++i) {
      at.fromBufferAttribute(place, i);
      // What the part hides is not under the pointer.
      if (at.distanceTo(camera.position) > surfaceDistance + this.shared.size * 0.01) continue;
      at.project(camera);
      if (at.z > 1) continue;
      const dx = ((at.x + 1) / 2) * width - x;
      const dy = ((1 - at.y) / 2) * height - y;
      if (dx * dx + dy * dy >= nearest) continue;
      nearest = dx * dx + dy * dy;
      best = i;
    }
    if (best < 0) return undefined;
    return {value: points.values[best], at: [points.feet[3 * best], points.feet[3 * best + 1], points.feet[3 * best + 2]], isPoint: true};
  }

  /// Calls back with what is under the pointer, or nothing.
  onPointer(listener: (reading: Reading | undefined) => void): void {
    const tell = (event: PointerEvent) => {
      const box = this.canvas.getBoundingClientRect();
      listener(this.read(event.clientX - box.left, event.clientY - box.top));
    };
    // Not while turning.
    this.canvas.addEventListener('pointermove', (event) => event.buttons === 0 && tell(event));
    this.canvas.addEventListener('click', (event) => tell(event as PointerEvent));
    this.canvas.addEventListener('pointerleave', () => listener(undefined));
  }
}
