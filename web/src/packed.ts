// Numbers of the data that are written as bytes in base64, the lowest byte first.

export function bytes(text: string): Uint8Array {
  const raw = atob(text);
  const result = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) result[i] = raw.charCodeAt(i);
  return result;
}

export function int8(text: string): Int8Array {
  return new Int8Array(bytes(text).buffer);
}

function words(text: string): DataView {
  return new DataView(bytes(text).buffer);
}

export function int16(text: string): Int16Array {
  const view = words(text);
  return Int16Array.from({length: view.byteLength / 2}, (_, i) => view.getInt16(2 * i, true));
}

export function uint16(text: string): Uint16Array {
  const view = words(text);
  return Uint16Array.from({length: view.byteLength / 2}, (_, i) => view.getUint16(2 * i, true));
}

export function uint32(text: string): Uint32Array {
  const view = words(text);
  return Uint32Array.from({length: view.byteLength / 4}, (_, i) => view.getUint32(4 * i, true));
}
