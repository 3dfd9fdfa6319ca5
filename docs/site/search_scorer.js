// Order of the results of the search: first what has the words in its title; the reference of C++ after what explains.
var Scorer = {
  score: ([page, title, anchor, description, score]) => {
    const query = (new URLSearchParams(location.search).get('q') ?? '').toLowerCase().split(/\s+/).filter(Boolean);
    const named = query.length && query.every((word) => title.toLowerCase().includes(word));
    return score + (named ? 20 : 0) - (page.startsWith('reference/cpp/') || page === 'CHANGELOG' ? 12 : 0);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: {0: 15, 1: 5, 2: -5},
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
