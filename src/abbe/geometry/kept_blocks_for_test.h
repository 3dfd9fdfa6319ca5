#pragma once

// For tests of numbered work.
#include <map>
#include <utility>
#include <vector>

#include "abbe/geometry/numbered_work.h"

namespace abbe::test {

/// Keeps the results of all blocks of one run, and gives them in another instead of computing them.
class KeptBlocks {
 public:
  WorkDriver keeping() {
    return [this](const NumberedWork& work) {
      work_in_threads(work);
      fingerprints.push_back(work.fingerprint());
      for (std::size_t block = 0; block < work.blocks; ++block) work.pack(block, blocks_[{fingerprints.back(), block}]);
    };
  }
  WorkDriver giving() {
    return [this](const NumberedWork& work) {
      for (std::size_t block = work.blocks; block-- > 0;) work.unpack(block, blocks_.at({work.fingerprint(), block}));
    };
  }
  std::vector<std::uint64_t> fingerprints;

 private:
  std::map<std::pair<std::uint64_t, std::size_t>, std::vector<std::byte>> blocks_;
};

}  // namespace abbe::test
