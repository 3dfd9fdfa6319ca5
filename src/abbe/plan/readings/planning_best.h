#pragma once

// Internal to plan: the best of many candidates, from lists of those that may be, which several processes have.
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
  double tie = 0;  ///< equal to the best one if the score is higher than its score by no more
};

/// Of candidates in their order, those that may be the best of all.
///
/// Candidates whose score is at most a tie above the lowest one are equal, and the first of these is the best. So a
/// candidate is left out if its score less its tie is above a score that is known, or not below that of an earlier
/// one. What is left of several lists together does not depend on the order in which they are joined, and a candidate
/// that is not equal to the best one may be left out or not. These lists are short.
class PossibleBests {
 public:
  /// @param one  a candidate after all those before; one without a finite score is left out
  void add(const ScoredCandidate& one);
  /// @param following  candidates after all those of this list
  void append(const PossibleBests& following);
  /// Of other candidates, between those of this list.
  void merge(const PossibleBests& others);
  void clear();

  /// Without a candidate if there is none.
  ScoredCandidate best() const { return list_.empty() ? ScoredCandidate() : list_.front(); }
  /// The lowest score.
  double least() const { return least_; }
  std::span<const ScoredCandidate> list() const { return list_; }

  /// Appends the list to bytes.
  void pack(std::vector<std::byte>& bytes) const;
  /// Takes a list off the front of bytes. @throws WorkError if there is none
  static PossibleBests unpack(std::span<const std::byte>& bytes);

 private:
  void lower_least(double score);

  std::vector<ScoredCandidate> list_{};  // scores less ties fall, and are not above least_
  double least_ = ScoredCandidate::kImpossible;
};

std::vector<std::byte> bytes_of(std::span<const PossibleBests> lists);
/// @throws WorkError if the bytes are no lists
std::vector<PossibleBests> lists_of(std::span<const std::byte> bytes);

/// Merges the first list with the first one that follows, and so on; as bytes (WorkInStep::Merge).
void merge_possible_bests(std::vector<std::byte>& all, std::span<const std::byte> following);

}  // namespace abbe
