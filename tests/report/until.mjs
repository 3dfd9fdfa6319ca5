/// Waits for a condition, because drawing is slow on a busy machine; the last value of the condition.
export async function until(condition) {
  for (let waited = 0; waited < 15000; waited += 250) {
    if (await condition()) return true;
    await new Promise((done) => setTimeout(done, 250));
  }
  return condition();
}

/// Runs in the page before its own script: counts the drawings of the three-dimensional views, each of which clears its canvas once, and
/// waits for frames.
export function watchDrawing() {
  const {clear} = WebGL2RenderingContext.prototype;
  window.drawings = 0;
  WebGL2RenderingContext.prototype.clear = function (...what) {
    ++window.drawings;
    return clear.apply(this, what);
  };
  // A change is drawn in the next frame, or one later if a size changes first. Other callbacks of the last frame may still be running: they
  // get a turn before this returns.
  window.settled = async (frames = 2) => {
    for (let i = 0; i < frames; ++i) await new Promise((done) => requestAnimationFrame(done));
    await new Promise((done) => setTimeout(done));
  };
}

/// Waits for so many frames: two are enough for any drawing; the image for paper takes 300 ms more.
export const settled = (page, frames) => page.evaluate((n) => window.settled(n), frames);
