#include "process_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace abbe {
namespace {

TEST(ProcessTree, HasEveryProcessOnceAndInOrder) {
  for (int processes = 1; processes <= 1100; processes += processes < 100 ? 1 : 61) {
    std::vector<int> parent(static_cast<std::size_t>(processes), -1), depth(parent.size(), 0);
    for (int rank = 0; rank < processes; ++rank) {
      const TreePlace place = place_in_tree(rank, processes);
      EXPECT_EQ(place.parent, parent[static_cast<std::size_t>(rank)]) << rank << " of " << processes;
      EXPECT_LE(place.children.size(), 4U);
      EXPECT_EQ(place.is_flat, processes <= 5);
      int before = rank;
      for (const TreePlace::Child& child : place.children) {
        ASSERT_GT(child.rank, before);
        ASSERT_LT(child.rank, processes);
        parent[static_cast<std::size_t>(child.rank)] = rank;
        depth[static_cast<std::size_t>(child.rank)] = depth[static_cast<std::size_t>(rank)] + 1;
        EXPECT_EQ(child.relays, !place_in_tree(child.rank, processes).children.empty());
        before = child.rank;
      }
      // The range of a process begins with it, and its first child follows it.
      EXPECT_TRUE(place.children.empty() || place.children.front().rank == rank + 1);
    }
    EXPECT_EQ(std::count(parent.begin(), parent.end(), -1), 1) << processes;
    int most = 0;
    for (int levels = 1; levels < processes; levels = 4 * levels + 1) ++most;
    EXPECT_LE(*std::max_element(depth.begin(), depth.end()), most) << processes;
  }
}

TEST(ProcessTree, KeepsNeighboursTogether) {
  // 0 over 1, 2 (over 3), 4 (over 5), 6 (over 7).
  const TreePlace first = place_in_tree(0, 8);
  std::vector<int> children;
  for (const TreePlace::Child& child : first.children) children.push_back(child.rank);
  EXPECT_EQ(children, (std::vector<int>{1, 2, 4, 6}));
  EXPECT_FALSE(first.children[0].relays);
  EXPECT_TRUE(first.children[1].relays);
  EXPECT_EQ(place_in_tree(3, 8).parent, 2);
  EXPECT_EQ(place_in_tree(7, 8).parent, 6);
}

}  // namespace
}  // namespace abbe
