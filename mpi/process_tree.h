#pragma once

#include <vector>

namespace abbe {

/// The place of a process in the tree along which sums, work in step and results for all go.
///
/// The first process is the root. Each part of the tree is a range of processes: its first one stands above up to four
/// ranges of nearly the same length. So neighbours stay together, in the order of their numbers.
struct TreePlace {
  static constexpr int kMostChildren = 4;

  struct Child {
    int rank;
    bool relays;  ///< others stand below it
  };
  int parent = -1;
  std::vector<Child> children{};  ///< by rank
  bool is_flat = true;            ///< all processes but the first one stand directly below it
};

TreePlace place_in_tree(int rank, int processes);

}  // namespace abbe
