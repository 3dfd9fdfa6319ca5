// Shows below each result of the search where its words stand in the page. The texts come from search_texts.js, a script:
// no browser lets a page opened from a file read another one.
(() => {
  const kBefore = 60;
  const kLength = 220;

  /// [text, whether it is a word that was looked for] of the place where most of the words are near each other.
  const excerptOf = (text, words) => {
    const found = [];
    const lower = text.toLowerCase();
    for (const word of words) {
      for (let at = lower.indexOf(word); at >= 0 && found.length < 500; at = lower.indexOf(word, at + 1)) found.push([at, word]);
    }
    if (!found.length) return [];
    found.sort((a, b) => a[0] - b[0]);
    let best = 0, most = 0;
    for (const [at] of found) {
      const near = new Set(found.filter(([other]) => other >= at && other < at + kLength - kBefore).map(([, word]) => word)).size;
      if (near > most) [best, most] = [at, near];
    }
    const from = best <= kBefore ? 0 : text.indexOf(' ', best - kBefore) + 1;
    const start = from > best ? best : from;
    const end = Math.min(text.length, start + kLength);
    const parts = [[start ? '… ' : '', false]];
    let last = start;
    for (const [at, word] of found) {
      if (at < last || at + word.length > end) continue;
      parts.push([text.slice(last, at), false], [text.slice(at, at + word.length), true]);
      last = at + word.length;
    }
    parts.push([text.slice(last, end) + (end < text.length ? ' …' : ''), false]);
    return parts;
  };

  const show = (item, words) => {
    const link = item.querySelector('a');
    if (!link || item.querySelector('.excerpt, span')) return;
    const page = link.getAttribute('href').replace(/[#?].*$/, '').replace(/\.html$/, '');
    const parts = excerptOf(window.abbeSearchTexts?.[page] ?? '', words);
    if (!parts.length) return;
    const line = document.createElement('p');
    line.className = 'excerpt';
    for (const [text, marked] of parts) {
      const part = marked ? document.createElement('mark') : document.createElement('span');
      part.textContent = text;
      line.append(part);
    }
    item.append(line);
  };

  document.addEventListener('DOMContentLoaded', () => {
    const results = document.getElementById('search-results');
    if (!results) return;
    const query = new URLSearchParams(location.search).get('q') ?? '';
    // Endings are left to the search, which stems words.
    const words = query.toLowerCase().split(/[^\p{L}\p{N}_]+/u).filter((word) => word.length > 1)
      .map((word) => (word.length > 5 ? word.replace(/(ations?|ing|ed|es|s|e)$/, '') : word));
    new MutationObserver((changes) => {
      for (const change of changes) {
        for (const node of change.addedNodes) if (node.nodeName === 'LI') show(node, words);
      }
    }).observe(results, {childList: true, subtree: true});
  });
})();
