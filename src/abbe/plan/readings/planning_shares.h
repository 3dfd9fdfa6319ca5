#pragma once

// Internal to plan: blocks of candidates, shared out among processes that choose in step.
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "abbe/geometry/work_in_step.h"

namespace abbe {

class PlanningSpace;
struct PlanningOptions;

/// Fingerprint of everything that a choice depends on. All rows of the candidates have a part in the seen directions.
std::uint64_t fingerprint_of_choosing(const PlanningSpace& space, const PlanningOptions& options);

/// What all processes have given, in their order.
struct GatheredBytes {
  std::vector<std::byte> bytes{};
  std::vector<std::span<const std::byte>> parts{};  ///< [processes] of the bytes
};

/// Processes that give nothing take no part of the messages.
GatheredBytes gather(const WorkInStep& in_step, std::uint64_t fingerprint, std::span<const std::byte> own);

/// Blocks are dealt out to the processes in turn, so that neighbouring blocks, which are alike, do not burden one of
/// them. If there are many blocks, several neighbours go to the same process, so that it reads longer stretches of
/// memory.
class PlanShares {
 public:
  PlanShares() = default;  ///< one process
  PlanShares(const WorkInStep& in_step, std::uint64_t fingerprint, std::size_t blocks);

  /// Shares of other blocks among the same processes.
  PlanShares of(std::size_t blocks) const { return {in_step_, fingerprint_, blocks}; }
  bool any() const { return in_step_.processes > 1; }
  std::size_t owner(std::size_t block) const { return block / together_ % in_step_.processes; }
  std::size_t rank() const { return in_step_.rank; }
  /// How many of the blocks are own ones, and the k-th of these.
  std::size_t own_count() const { return own_count_; }
  std::size_t own(std::size_t k) const {
    return (k / together_ * in_step_.processes + in_step_.rank) * together_ + k % together_;
  }

  /// What merging the bytes of all processes makes (WorkInStep).
  std::vector<std::byte> merged(std::vector<std::byte> own, const WorkInStep::Merge& merge) const;

  /// Numbers that one process has, its owner.
  struct Piece {
    std::size_t owner;
    std::span<double> numbers;
  };
  /// Gives every process the numbers of all pieces.
  void complete(std::span<const Piece> pieces) const;

 private:
  WorkInStep in_step_{};
  std::uint64_t fingerprint_ = 0;
  std::size_t own_count_ = 0;
  std::size_t together_ = 1;
};

}  // namespace abbe
