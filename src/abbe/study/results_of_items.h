#pragma once

// Internal to study: independent items of a job as numbered work.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

struct ItemResult {
  std::vector<double> numbers;
  std::string text{};
};

struct NumberedItems {
  std::string name;  ///< as NumberedWork::name
  std::size_t count = 0;
  int threads = 0;
  bool in_parallel = true;                       ///< as NumberedWork::in_parallel
  bool for_all = true;                           ///< as NumberedWork::for_all
  std::function<std::uint64_t()> fingerprint{};  ///< as NumberedWork::fingerprint
  std::function<ItemResult(std::size_t item)> compute{};
};

/// @returns [count], in every process or in the first one: the others then have some. They are not kept in a file
std::vector<ItemResult> results_of_items(const WorkDriver& driver, const NumberedItems& items);

}  // namespace abbe
