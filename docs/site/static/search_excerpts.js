// Shows below each result of the search where its words stand in the page. The texts come from search_texts.js, a
// script: no browser lets a page that was opened from a file read another one.
(() => {
  const kBefore = 60;
  const kLength = 220;
  const kMostPlaces = 500;

  /// Where words that begin with one of the stems stand in a text: [from, to, stem], in order.
  const placesOf = (text, stems) => {
    const alternatives = stems.map((stem) => stem.replace(/[.*+\-?^${}()|[\]\\]/g, '\\$&')).join('|');
    const places = [];
    for (const match of text.matchAll(new RegExp(`(?<![\\p{L}\\p{N}])(${alternatives})[\\p{L}\\p{N}_]*`, 'giu'))) {
      places.push([match.index, match.index + match[0].length, match[1].toLowerCase()]);
      if (places.length === kMostPlaces) break;
    }
    return places;
  };

  /// The part of a text with most of the stems near each other: [text, whether it is one of the words].
  const excerptOf = (text, stems) => {
    const places = placesOf(text, stems);
    if (!places.length) return [];
    const stemsFrom = (at) =>
      new Set(places.filter(([from]) => from >= at && from < at + kLength - kBefore).map((place) => place[2])).size;
    const counts = places.map(([from]) => stemsFrom(from));
    const best = places[counts.indexOf(Math.max(...counts))][0];
    const start = best <= kBefore ? 0 : Math.min(best, text.indexOf(' ', best - kBefore) + 1);
    const end = start + kLength >= text.length ? text.length : text.lastIndexOf(' ', start + kLength);
    const parts = [[start ? '… ' : '', false]];
    let last = start;
    for (const [from, to] of places) {
      if (from < last || to > end) continue;
      parts.push([text.slice(last, from), false], [text.slice(from, to), true]);
      last = to;
    }
    parts.push([text.slice(last, end) + (end < text.length ? ' …' : ''), false]);
    return parts;
  };

  const show = (item, stems) => {
    const link = item.querySelector('a');
    if (!link || item.querySelector('.excerpt, span')) return;
    const page = link
      .getAttribute('href')
      .replace(/[#?].*$/, '')
      .replace(/\.html$/, '');
    const parts = excerptOf(window.abbeSearchTexts?.[page] ?? '', stems);
    if (!parts.length) return;
    const line = document.createElement('p');
    line.className = 'excerpt';
    for (const [text, marked] of parts) {
      const part = document.createElement(marked ? 'mark' : 'span');
      part.textContent = text;
      line.append(part);
    }
    item.append(line);
  };

  document.addEventListener('DOMContentLoaded', () => {
    const results = document.getElementById('search-results');
    const query = new URLSearchParams(location.search).get('q') ?? '';
    const stemmer = new Stemmer();
    const stems = query
      .toLowerCase()
      .split(/[^\p{L}\p{N}_]+/u)
      .filter((word) => word.length > 1)
      .map((word) => stemmer.stemWord(word));
    if (!results || !stems.length) return;
    new MutationObserver(() => results.querySelectorAll('li').forEach((item) => show(item, stems))).observe(results, {
      childList: true,
      subtree: true,
    });
    results.querySelectorAll('li').forEach((item) => show(item, stems));
  });
})();
