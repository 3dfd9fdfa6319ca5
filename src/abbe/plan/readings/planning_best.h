#pragma once

// Internal to plan: finds the best of many candidates from short lists, one for each block or process.
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace abbe {

/// What a candidate would change.
struct ScoredCandidate {
  static constexpr double kImpossible = std::numeric_limits<double>::infinity();

  std::size_t candidate = static_cast<std::size_t>(-1);  ///< this one: none
  double change = kImpossible;                           ///< of the objective
  double score = kImpossible;                            ///< change, divided by the cost where that counts
  double tie = 0;  ///< a candidate whose score is higher than the lowest one by no more than this equals the best one
};

/// The candidates that may be the best of all, in their order.
///
/// Candidates whose score is at most a tie above the lowest one are equal, and the first of them is the best. So a
/// candidate is dropped if its score less its tie is above a known score, or is not below that of an earlier
/// candidate. Few are left. Lists can be joined in any order with the same result. It does not matter whether
/// candidates that are not equal to the best one were added at all.
class PossibleBests {
 public:
  /// @param one  a candidate after all those before; one without a finite score is left out
  void add(const ScoredCandidate& one);
  /// @param following  candidates after all those of this list
  void append(const PossibleBests& following);
  /// @param others  other candidates, which may lie between those of this list
  void merge(const PossibleBests& others);
  void clear();

  /// The best candidate, or none.
  ScoredCandidate best() const { return list_.empty() ? ScoredCandidate() : list_.front(); }
  /// The lowest score.
  double least() const { return least_; }
  std::span<const ScoredCandidate> list() const { return list_; }

  /// Appends the list to bytes.
  void pack(std::vector<std::byte>& bytes) const;
  /// Takes a list off the front of the bytes. @throws WorkError if there is no whole list
  static PossibleBests unpack(std::span<const std::byte>& bytes);

 private:
  void lower_least(double score);

  std::vector<ScoredCandidate> list_{};  // scores less ties fall, and are not above least_
  double least_ = ScoredCandidate::kImpossible;
};

std::vector<std::byte> bytes_of(std::span<const PossibleBests> lists);
/// @throws WorkError if the last list is cut off
std::vector<PossibleBests> lists_of(std::span<const std::byte> bytes);

/// Merges the first list with the first one that follows, and so on; as bytes (WorkInStep::Merge).
void merge_possible_bests(std::vector<std::byte>& all, std::span<const std::byte> following);

}  // namespace abbe
