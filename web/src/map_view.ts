// Three-dimensional views of the map: arrows, a box with its scales, one camera for all views.

import {
  BoxGeometry, BufferGeometry, CanvasTexture, Color, ConeGeometry, CylinderGeometry, DynamicDrawUsage, EdgesGeometry, Float32BufferAttribute,
  InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, MeshBasicMaterial, PerspectiveCamera, Points, PointsMaterial, Quaternion, Scene,
  Sprite, SpriteMaterial, SRGBColorSpace, Vector3, WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {mergeGeometries} from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import {isDark} from './colour';
import {Vectors} from './data';
import {html} from './dom';
import {extent, niceTicks} from './scale';

type Rgb = [number, number, number];

/// Columns of what is drawn at each point: direction, length and the value that its colour shows.
export interface Arrows extends Vectors {
  length: number[];
  colour: number[];
}

/// One camera, turned from any of the views.
export class Camera {
  readonly camera = new PerspectiveCamera(32, 1, 1, 10);
  readonly target = new Vector3();
  readonly low: Vector3;
  readonly high: Vector3;
  readonly size: number;
  private listeners: (() => void)[] = [];

  constructor(points: Vectors) {
    const [x0, x1] = extent(points.x);
    const [y0, y1] = extent(points.y);
    const [z0, z1] = extent(points.z);
    this.low = new Vector3(x0, y0, z0);
    this.high = new Vector3(x1, y1, z1);
    this.size = Math.max(this.low.distanceTo(this.high), 1);
    // A flat cloud still gets a box.
    const thin = this.size * 0.01;
    for (const k of ['x', 'y', 'z'] as const)
      if (this.high[k] - this.low[k] < thin) {
        this.low[k] -= thin / 2;
        this.high[k] += thin / 2;
      }
    this.camera.up.set(0, 0, 1);
    this.camera.near = this.size * 0.01;
    this.camera.far = this.size * 20;
    this.reset();
  }

  reset(): void {
    this.target.copy(this.low).add(this.high).multiplyScalar(0.5);
    this.camera.position.copy(this.target).add(new Vector3(-0.95, -1.35, 0.85).normalize().multiplyScalar(this.size * 1.8));
    this.camera.lookAt(this.target);
    this.changed();
  }

  turn(azimuth: number, elevation: number, zoom: number): void {
    const arm = this.camera.position.clone().sub(this.target);
    const length = arm.length() * zoom;
    const polar = Math.min(Math.PI - 0.02, Math.max(0.02, Math.acos(arm.z / arm.length()) - elevation));
    const around = Math.atan2(arm.y, arm.x) + azimuth;
    arm.set(Math.sin(polar) * Math.cos(around), Math.sin(polar) * Math.sin(around), Math.cos(polar)).multiplyScalar(length);
    this.camera.position.copy(this.target).add(arm);
    this.camera.lookAt(this.target);
    this.changed();
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  changed(): void {
    for (const listener of this.listeners) listener();
  }
}

function arrowGeometry(): BufferGeometry {
  const shaft = new CylinderGeometry(0.16, 0.16, 0.7, 8, 1).translate(0, 0.35, 0);
  const head = new ConeGeometry(0.5, 0.3, 12).translate(0, 0.85, 0);
  return mergeGeometries([shaft, head]);
}

/// Words in the scene, always facing the reader; letters of `pixels` on the screen, see View.draw.
function label(text: string, colour: string, pixels: number): Sprite {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d')!;
  const font = '500 40px system-ui, sans-serif';
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 12;
  canvas.height = 52;
  context.font = font;
  context.fillStyle = colour;
  context.textBaseline = 'middle';
  context.fillText(text, 6, 27);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({map: texture, transparent: true, depthTest: false, sizeAttenuation: false}));
  sprite.userData = {height: (pixels * canvas.height) / 40, shape: canvas.width / canvas.height};
  return sprite;
}

export class View {
  readonly box: HTMLElement;
  readonly caption = html('span', {class: 'note'});
  private arrowsShown: Arrows = {x: [], y: [], z: [], length: [], colour: []};
  private readonly still = html('img', {class: 'still', alt: ''});
  private readonly canvas: HTMLCanvasElement;
  private readonly renderer?: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly arrows: InstancedMesh;
  private readonly feet: Points;
  private frame: {dark: boolean; parts: (LineSegments | Sprite)[]} | undefined;
  private screenColour: (value: number) => Rgb = () => [0, 0, 0];
  private printColour: (value: number) => Rgb = () => [0, 0, 0];
  private timer = 0;
  private pending = false;

  constructor(
    private readonly title: string,
    private readonly points: Vectors,
    private readonly shared: Camera,
  ) {
    this.canvas = html('canvas', {tabindex: 0, role: 'img', 'aria-label': title});
    this.box = html('figure', {class: 'view'}, html('figcaption', {}, html('b', {}, title), this.caption), html('div', {class: 'stage'}, this.canvas, this.still));
    const count = points.x.length;
    this.arrows = new InstancedMesh(arrowGeometry(), new MeshBasicMaterial(), count);
    this.arrows.instanceMatrix.setUsage(DynamicDrawUsage);
    this.arrows.frustumCulled = false;
    this.scene.add(this.arrows);
    const feet = new BufferGeometry();
    feet.setAttribute('position', new Float32BufferAttribute(new Float32Array(3 * count), 3));
    feet.setAttribute('color', new Float32BufferAttribute(new Float32Array(3 * count), 3));
    this.feet = new Points(feet, new PointsMaterial({size: 3, sizeAttenuation: false, vertexColors: true}));
    this.feet.frustumCulled = false;
    this.scene.add(this.feet);
    try {
      this.renderer = new WebGLRenderer({canvas: this.canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
    } catch {
      this.box.append(html('p', {class: 'note'}, 'The three-dimensional view needs WebGL, which this browser does not offer.'));
      return;
    }
    this.renderer.setPixelRatio(Math.min(2, Math.max(1, window.devicePixelRatio)));
    this.renderer.setClearColor(0, 0);
    const controls = new OrbitControls(shared.camera, this.canvas);
    controls.target = shared.target;
    controls.enableDamping = false;
    // The controls aimed the camera at their own first target.
    shared.reset();
    controls.addEventListener('change', () => shared.changed());
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement!);
    window.addEventListener('beforeprint', () => this.photograph());
    window.addEventListener('afterprint', () => this.render());
  }

  private key(event: KeyboardEvent): void {
    const turns: Record<string, [number, number, number]> = {
      ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, 0.1, 1], ArrowDown: [0, -0.1, 1],
      '+': [0, 0, 0.9], '=': [0, 0, 0.9], '-': [0, 0, 1.1],
    };
    const turn = turns[event.key];
    if (!turn) return;
    event.preventDefault();
    this.shared.turn(...turn);
  }

  /// What the arrows are, in words, for those who do not see them.
  describe(words: string): void {
    this.canvas.setAttribute('aria-label', `${this.title}: ${words}. Arrow keys turn the view, plus and minus zoom.`);
    this.still.alt = `${this.title}: ${words}`;
  }

  /// @param scale    millimetres drawn for one unit of `arrows.length`
  /// @param visible  undefined: all
  update(arrows: Arrows, scale: number, visible: boolean[] | undefined, screen: (value: number) => Rgb, print: (value: number) => Rgb): void {
    this.screenColour = screen;
    this.printColour = print;
    this.arrowsShown = arrows;
    const width = this.shared.size * 0.013;
    const matrix = new Matrix4();
    const up = new Vector3(0, 1, 0);
    const direction = new Vector3();
    const place = new Vector3();
    const turn = new Quaternion();
    const feet = this.feet.geometry.getAttribute('position');
    for (let i = 0; i < arrows.length.length; ++i) {
      const length = arrows.length[i] * scale;
      place.set(this.points.x[i], this.points.y[i], this.points.z[i]);
      const drawn = !visible || visible[i];
      if (drawn && length > 0) {
        direction.set(arrows.x[i], arrows.y[i], arrows.z[i]).normalize();
        turn.setFromUnitVectors(up, direction);
        const thick = Math.min(width, length * 0.35);
        matrix.compose(place, turn, new Vector3(thick, length, thick));
      } else matrix.makeScale(0, 0, 0);
      this.arrows.setMatrixAt(i, matrix);
      feet.setXYZ(i, place.x, place.y, drawn ? place.z : NaN);
    }
    this.arrows.instanceMatrix.needsUpdate = true;
    feet.needsUpdate = true;
    this.paint(screen);
    this.render();
  }

  private paint(colour: (value: number) => Rgb): void {
    const shade = new Color();
    const feet = this.feet.geometry.getAttribute('color');
    const values = this.arrowsShown.colour;
    for (let i = 0; i < values.length; ++i) {
      shade.setRGB(...colour(values[i]), SRGBColorSpace);
      this.arrows.setColorAt(i, shade);
      feet.setXYZ(i, shade.r, shade.g, shade.b);
    }
    this.arrows.instanceColor!.needsUpdate = true;
    feet.needsUpdate = true;
  }

  /// The box around the points with scales along three of its edges.
  private drawFrame(dark: boolean): void {
    if (this.frame?.dark === dark) return;
    for (const part of this.frame?.parts ?? []) {
      this.scene.remove(part);
      if (part instanceof Sprite) part.material.map?.dispose(), part.material.dispose();
      else (part.material as LineBasicMaterial).dispose();
    }
    const {low, high, size} = this.shared;
    const line = new LineBasicMaterial({color: dark ? 0x4a555f : 0xc3cad1});
    const extentOf = high.clone().sub(low);
    const edges = new LineSegments(new EdgesGeometry(new BoxGeometry(extentOf.x, extentOf.y, extentOf.z)), line);
    edges.position.copy(low).add(high).multiplyScalar(0.5);
    const parts: (LineSegments | Sprite)[] = [edges];
    const ink = dark ? '#aab4bd' : '#5b6670';
    const ticks: number[] = [];
    const out = size * 0.025;
    for (const k of ['x', 'y', 'z'] as const) {
      const wanted = Math.max(1, Math.round((5 * extentOf[k]) / Math.max(extentOf.x, extentOf.y, extentOf.z)));
      const values = niceTicks(low[k], high[k], wanted);
      const edge = k === 'x' ? new Vector3(0, low.y, low.z) : k === 'y' ? new Vector3(low.x, 0, low.z) : new Vector3(low.x, high.y, 0);
      const outward = k === 'x' ? new Vector3(0, -1, 0) : k === 'y' ? new Vector3(-1, 0, 0) : new Vector3(-0.7, 0.7, 0);
      for (const value of values) {
        const at = edge.clone();
        at[k] = value;
        ticks.push(...at.toArray(), ...at.clone().addScaledVector(outward, out * 0.5).toArray());
        const words = label(String(Number(value.toPrecision(6))).replace('-', '\u2212'), ink, 11);
        words.position.copy(at).addScaledVector(outward, out * 2.2);
        parts.push(words);
      }
      const name = label(`${k.toUpperCase()} / mm`, ink, 12);
      const middle = edge.clone();
      middle[k] = (low[k] + high[k]) / 2;
      name.position.copy(middle).addScaledVector(outward, out * (k === 'z' ? 4.4 : 5));
      parts.push(name);
    }
    const marks = new BufferGeometry();
    marks.setAttribute('position', new Float32BufferAttribute(ticks, 3));
    parts.push(new LineSegments(marks, line));
    this.scene.add(...parts);
    this.frame = {dark, parts};
  }

  private resize(): void {
    const stage = this.canvas.parentElement!;
    const width = stage.clientWidth;
    const height = stage.clientHeight;
    if (!this.renderer || width < 10 || height < 10) return;
    this.renderer.setSize(width, height, false);
    this.render();
  }

  /// Draws at the next frame; many changes in one frame cost one drawing.
  render(): void {
    if (!this.renderer || this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw(isDark());
      window.clearTimeout(this.timer);
      this.timer = window.setTimeout(() => this.photograph(), 300);
    });
  }

  private draw(dark: boolean): void {
    const stage = this.canvas.parentElement!;
    if (!this.renderer || stage.clientWidth < 10) return;
    this.drawFrame(dark);
    const camera = this.shared.camera;
    camera.aspect = stage.clientWidth / stage.clientHeight;
    // Letters keep their size on a small stage, so that the box must leave them more room.
    camera.fov = stage.clientWidth < 420 ? 37 : 32;
    camera.updateProjectionMatrix();
    const unit = (2 * Math.tan((camera.fov * Math.PI) / 360)) / stage.clientHeight;
    for (const part of this.frame?.parts ?? [])
      if (part instanceof Sprite) part.scale.set(unit * part.userData.height * part.userData.shape, unit * part.userData.height, 1);
    this.renderer.render(this.scene, camera);
  }

  /// A still for paper, in the colours of the light theme.
  private photograph(): void {
    if (!this.renderer || this.canvas.width < 10) return;
    const dark = isDark();
    if (dark) this.paint(this.printColour);
    this.draw(false);
    this.still.src = this.canvas.toDataURL('image/png');
    if (dark) {
      this.paint(this.screenColour);
      this.draw(true);
    }
  }
}
