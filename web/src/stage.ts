// A three-dimensional drawing on the page: canvas, frame, turning by pointer and keys, a still for paper.

import {Scene, Sprite, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import {Camera} from './camera';
import {isDark} from './colour';
import {html} from './dom';
import {disposeFrame, FramePart, frameParts, keepWordsApart} from './frame';

export abstract class Stage {
  readonly box: HTMLElement;
  readonly caption = html('span', {class: 'note'});
  protected readonly scene = new Scene();
  protected readonly canvas: HTMLCanvasElement;
  private readonly still = html('img', {class: 'still', alt: ''});
  private readonly renderer?: WebGLRenderer;
  private frame: {dark: boolean; parts: FramePart[]} | undefined;
  private timer = 0;
  private pending = false;
  private sized = false;

  constructor(
    protected readonly title: string,
    protected readonly shared: Camera,
  ) {
    this.canvas = html('canvas', {tabindex: 0, role: 'img', 'aria-label': title});
    this.box = html('figure', {class: 'view'}, html('figcaption', {}, html('b', {}, title), this.caption), html('div', {class: 'stage'}, this.canvas, this.still));
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
  }

  /// Gives everything drawn the colours of a theme.
  protected abstract paint(dark: boolean): void;
  /// Before each drawing.
  protected prepare(): void {}

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

  /// What is drawn, in words, for those who do not see it.
  describe(words: string): void {
    this.canvas.setAttribute('aria-label', `${this.title}: ${words}. Arrow keys turn the view, plus and minus zoom.`);
    this.still.alt = `${this.title}: ${words}`;
  }

  private drawFrame(dark: boolean): void {
    if (this.frame?.dark === dark) return;
    if (this.frame) {
      this.scene.remove(...this.frame.parts);
      disposeFrame(this.frame.parts);
    }
    const parts = frameParts(this.shared.low, this.shared.high, this.shared.size, this.shared.side, dark);
    this.scene.add(...parts);
    this.frame = {dark, parts};
  }

  private resize(): void {
    const stage = this.canvas.parentElement!;
    const width = stage.clientWidth;
    const height = stage.clientHeight;
    if (!this.renderer || width < 10 || height < 10) return;
    this.renderer.setSize(width, height, false);
    this.sized = true;
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
    // Before the first size is known the drawing would be thrown away.
    if (!this.renderer || !this.sized || stage.clientWidth < 10) return;
    this.drawFrame(dark);
    const camera = this.shared.camera;
    camera.aspect = stage.clientWidth / stage.clientHeight;
    // Letters keep their size on a small stage, so that the box must leave them more room.
    camera.fov = stage.clientWidth < 420 ? 37 : 32;
    camera.updateProjectionMatrix();
    const unit = (2 * Math.tan((camera.fov * Math.PI) / 360)) / stage.clientHeight;
    for (const part of this.frame?.parts ?? [])
      if (part instanceof Sprite) part.scale.set(unit * part.userData.height * part.userData.shape, unit * part.userData.height, 1);
    camera.updateMatrixWorld();
    keepWordsApart(this.frame?.parts ?? [], camera, stage.clientWidth, stage.clientHeight);
    this.prepare();
    this.renderer.render(this.scene, camera);
  }

  /// A still for paper, in the colours of the light theme.
  private photograph(): void {
    if (!this.renderer || !this.sized) return;
    const dark = isDark();
    if (dark) this.paint(false);
    // In the light theme the canvas shows it already, unless a change is not drawn yet.
    if (dark || this.pending) this.draw(false);
    this.still.src = this.canvas.toDataURL('image/png');
    if (dark) {
      this.paint(true);
      this.draw(true);
    }
  }
}
