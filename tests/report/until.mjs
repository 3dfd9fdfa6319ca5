/// Waits for a condition, because drawing is slow on a busy machine; the last value of the condition.
export async function until(condition) {
  for (let waited = 0; waited < 15000; waited += 250) {
    if (await condition()) return true;
    await new Promise((done) => setTimeout(done, 250));
  }
  return condition();
}

/// Runs in the page before its own script: counts the drawings of the three-dimensional views, and waits for frames.
export function watchDrawing() {
  const {clear} = WebGL2RenderingContext.prototype;
  window.drawings = 0;
  WebGL2RenderingContext.prototype.clear = function (...what) {
    ++window.drawings;
    return clear.apply(this, what);
  };
  // Changes are drawn at the next frame after the sizes are known; the drawing may be later in the last frame than this is told of it.
  window.settled = async (frames = 2) => {
    for (let i = 0; i < frames; ++i) await new Promise((done) => requestAnimationFrame(done));
    await new Promise((done) => setTimeout(done));
  };
}

/// Returns when the page has drawn what was asked of it so far.
export const settled = (page, frames) => page.evaluate((n) => window.settled(n), frames);
