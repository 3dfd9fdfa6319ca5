/// Waits for a condition, because drawing is slow on a busy machine; the last value of the condition.
export async function until(condition) {
  for (let waited = 0; waited < 15000; waited += 250) {
    if (await condition()) return true;
    await new Promise((done) => setTimeout(done, 250));
  }
  return condition();
}
