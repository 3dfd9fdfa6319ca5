// The box about what is drawn in three dimensions, with scales along three of its edges.

import {
  BoxGeometry, BufferGeometry, CanvasTexture, EdgesGeometry, Float32BufferAttribute, LineBasicMaterial, LineSegments, PerspectiveCamera, Sprite,
  SpriteMaterial, SRGBColorSpace, Vector3,
} from 'three';

import {niceTicks} from './scale';

export type FramePart = LineSegments | Sprite;

/// Words in the scene, always facing the reader; letters of `pixels` on the screen, see Stage.
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

/// @param size  of the whole, mm: ticks and distances follow it
/// @param side  the view is from that side at first (signs of x and y): scales stand in front
export function frameParts(low: Vector3, high: Vector3, size: number, side: {x: number; y: number}, dark: boolean): FramePart[] {
  const line = new LineBasicMaterial({color: dark ? 0x4a555f : 0xc3cad1});
  const extentOf = high.clone().sub(low);
  const edges = new LineSegments(new EdgesGeometry(new BoxGeometry(extentOf.x, extentOf.y, extentOf.z)), line);
  edges.position.copy(low).add(high).multiplyScalar(0.5);
  const parts: FramePart[] = [edges];
  const ink = dark ? '#aab4bd' : '#5b6670';
  const ticks: number[] = [];
  const out = size * 0.025;
  for (const k of ['x', 'y', 'z'] as const) {
    const wanted = Math.max(1, Math.round((5 * extentOf[k]) / Math.max(extentOf.x, extentOf.y, extentOf.z)));
    const values = niceTicks(low[k], high[k], wanted);
    const [nearX, nearY, farY] = [side.x < 0 ? low.x : high.x, side.y < 0 ? low.y : high.y, side.y < 0 ? high.y : low.y];
    const edge = k === 'x' ? new Vector3(0, nearY, low.z) : k === 'y' ? new Vector3(nearX, 0, low.z) : new Vector3(nearX, farY, 0);
    const outward = k === 'x' ? new Vector3(0, side.y, 0) : k === 'y' ? new Vector3(side.x, 0, 0) : new Vector3(0.7 * side.x, -0.7 * side.y, 0);
    for (const value of values) {
      const at = edge.clone();
      at[k] = value;
      ticks.push(...at.toArray(), ...at.clone().addScaledVector(outward, out * 0.5).toArray());
      const words = label(String(Number(value.toPrecision(6))).replace('-', '\u2212'), ink, 11);
      words.position.copy(at).addScaledVector(outward, out * 2.2);
      parts.push(words);
    }
    const name = label(`${k.toUpperCase()} / mm`, ink, 12);
    name.userData.first = true;
    const middle = edge.clone();
    middle[k] = (low[k] + high[k]) / 2;
    name.position.copy(middle).addScaledVector(outward, out * (k === 'z' ? 4.4 : 5));
    parts.push(name);
  }
  const marks = new BufferGeometry();
  marks.setAttribute('position', new Float32BufferAttribute(ticks, 3));
  parts.push(new LineSegments(marks, line));
  return parts;
}

/// Shows the words that have room on a stage of so many pixels: names of the axes, then numbers that cover nothing shown.
export function keepWordsApart(parts: FramePart[], camera: PerspectiveCamera, width: number, height: number): void {
  const words = parts.filter((part): part is Sprite => part instanceof Sprite);
  const taken: {x: number; y: number; width: number; height: number}[] = [];
  for (const word of [...words.filter((one) => one.userData.first), ...words.filter((one) => !one.userData.first)]) {
    const at = word.position.clone().project(camera);
    const box = {x: (at.x * width) / 2, y: (at.y * height) / 2, width: word.userData.height * word.userData.shape, height: 0.8 * word.userData.height};
    word.visible = taken.every((other) =>
      Math.abs(box.x - other.x) > (box.width + other.width) / 2 || Math.abs(box.y - other.y) > (box.height + other.height) / 2);
    if (word.visible) taken.push(box);
  }
}

export function disposeFrame(parts: FramePart[]): void {
  for (const part of parts) {
    if (part instanceof Sprite) part.material.map?.dispose(), part.material.dispose();
    else (part.material as LineBasicMaterial).dispose();
  }
}
