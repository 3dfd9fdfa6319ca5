// Words of a drawing kept apart: each is moved the shortest way to where it covers none of those before it.

export interface Label {
  x: number;
  y: number; // of the baseline
  text: string;
  style: string;
  size: number; // of the letters
  middle: boolean; // x is the middle of the word, not its beginning
}

interface Box {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

const kLetter = 0.6; // width of a letter in letter sizes

function boxOf(label: Label): Box {
  const width = kLetter * label.size * [...label.text].length;
  const left = label.middle ? label.x - width / 2 : label.x;
  return {left: left - 2, right: left + width + 2, top: label.y - label.size, bottom: label.y + 0.25 * label.size};
}

const covers = (a: Box, b: Box): boolean => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

/// `taken`: places of marks [x, y, radius] that no word may cover.
export function keptApart(labels: Label[], taken: [number, number, number][] = []): Label[] {
  const boxes: Box[] = taken.map(([x, y, r]) => ({left: x - r, right: x + r, top: y - r, bottom: y + r}));
  return labels.map((label) => {
    const ways: [number, number][] = [[0, 0]];
    for (const far of [1, 1.8, 2.6])
      for (const [dx, dy] of [[0, -1], [0, 1], [1, 0], [-1, 0], [0.8, -0.8], [0.8, 0.8], [-0.8, -0.8], [-0.8, 0.8]])
        ways.push([far * dx * 1.2 * label.size, far * dy * 1.1 * label.size]);
    const moved = ways.map(([dx, dy]) => ({...label, x: label.x + dx, y: label.y + dy}));
    const free = moved.find((way) => !boxes.some((box) => covers(box, boxOf(way)))) ?? label;
    boxes.push(boxOf(free));
    return free;
  });
}
