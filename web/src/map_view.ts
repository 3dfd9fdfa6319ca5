// Arrows of the map in three dimensions.

import {
  BufferGeometry, Color, ConeGeometry, CylinderGeometry, DynamicDrawUsage, Float32BufferAttribute, InstancedMesh, Matrix4, MeshBasicMaterial,
  Points, PointsMaterial, Quaternion, SRGBColorSpace, Vector3,
} from 'three';
import {mergeGeometries} from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import {Camera} from './camera';
import {isDark} from './colour';
import {Vectors} from './data';
import {Stage} from './stage';

type Rgb = [number, number, number];

/// Columns of what is drawn at each point: direction, length and the value that its colour shows.
export interface Arrows extends Vectors {
  length: number[];
  colour: number[];
}

function arrowGeometry(): BufferGeometry {
  const shaft = new CylinderGeometry(0.16, 0.16, 0.7, 8, 1).translate(0, 0.35, 0);
  const head = new ConeGeometry(0.5, 0.3, 12).translate(0, 0.85, 0);
  return mergeGeometries([shaft, head]);
}

export class View extends Stage {
  private arrowsShown: Arrows = {x: [], y: [], z: [], length: [], colour: []};
  private readonly arrows: InstancedMesh;
  private readonly feet: Points;
  private colour: (value: number, dark: boolean) => Rgb = () => [0, 0, 0];

  constructor(
    title: string,
    private readonly points: Vectors,
    shared: Camera,
  ) {
    super(title, shared);
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
  }

  /// @param scale    millimetres drawn for one unit of `arrows.length`
  /// @param visible  undefined: all
  update(arrows: Arrows, scale: number, visible: boolean[] | undefined, colour: (value: number, dark: boolean) => Rgb): void {
    this.colour = colour;
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
    this.paint(isDark());
    this.render();
  }

  protected paint(dark: boolean): void {
    const shade = new Color();
    const feet = this.feet.geometry.getAttribute('color');
    const values = this.arrowsShown.colour;
    for (let i = 0; i < values.length; ++i) {
      shade.setRGB(...this.colour(values[i], dark), SRGBColorSpace);
      this.arrows.setColorAt(i, shade);
      feet.setXYZ(i, shade.r, shade.g, shade.b);
    }
    if (this.arrows.instanceColor) this.arrows.instanceColor.needsUpdate = true;
    feet.needsUpdate = true;
  }
}
