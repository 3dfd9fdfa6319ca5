// One camera for several three-dimensional views, and the box about what is drawn.

import {PerspectiveCamera, Vector3} from 'three';

import {Vectors} from './data';
import {extent} from './scale';

/// One camera, turned from any of the views.
export class Camera {
  readonly camera = new PerspectiveCamera(32, 1, 1, 10);
  readonly target = new Vector3();
  readonly low: Vector3;
  readonly high: Vector3;
  readonly size: number;
  private listeners: (() => void)[] = [];
  private from = new Vector3(-0.95, -1.35, 0.85);

  /// @param smallest  size of the whole at least, mm: a single point still gets a box
  constructor(points: Vectors, smallest = 1) {
    const [x0, x1] = extent(points.x);
    const [y0, y1] = extent(points.y);
    const [z0, z1] = extent(points.z);
    this.low = new Vector3(x0, y0, z0);
    this.high = new Vector3(x1, y1, z1);
    this.size = Math.max(this.low.distanceTo(this.high), smallest);
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

  /// The side from which it looks at first.
  get side(): {x: number; y: number} {
    return {x: Math.sign(this.from.x), y: Math.sign(this.from.y)};
  }

  /// Looks from the side that a direction points to; a little from above unless it clearly points down.
  lookFrom(x: number, y: number, z: number): void {
    this.from.set(x > 0.05 ? 0.95 : -0.95, y > 0.05 ? 1.35 : -1.35, z < -0.3 ? -0.85 : 0.85);
    this.reset();
  }

  reset(): void {
    this.target.copy(this.low).add(this.high).multiplyScalar(0.5);
    this.camera.position.copy(this.target).add(this.from.clone().normalize().multiplyScalar(this.size * 1.8));
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
