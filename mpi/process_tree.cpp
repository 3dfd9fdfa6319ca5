#include "process_tree.h"

#include <algorithm>

namespace abbe {

TreePlace place_in_tree(int rank, int processes) {
  TreePlace place;
  place.is_flat = processes <= TreePlace::kMostChildren + 1;
  for (int first = 0, end = processes;;) {
    const int below = end - first - 1, ranges = std::min(below, TreePlace::kMostChildren);
    // below * k fits: MPI counts processes in int, and no cluster has 2^29 of them.
    const auto begin_of = [&](int k) { return first + 1 + below * k / ranges; };
    int range = 0;
    for (int k = 0; k < ranges; ++k) {
      if (begin_of(k) <= rank) range = k;
      if (first == rank) place.children.push_back({begin_of(k), begin_of(k + 1) - begin_of(k) > 1});
    }
    if (first == rank) return place;
    place.parent = first;
    end = begin_of(range + 1);
    first = begin_of(range);
  }
}

}  // namespace abbe
