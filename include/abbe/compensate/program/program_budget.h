#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <stop_token>
#include <utility>

#include "abbe/geometry/stopped.h"

namespace abbe {

/// Limits of the size of a corrected program and of the time to compute it. A program of a few lines can have loops,
/// turns and arcs that produce gigabytes or never end. Thread-safe; the time counts from construction.
class ProgramBudget {
 public:
  enum class Spent {
    nothing,
    bytes,  ///< of the corrected program
    time,
    pieces,  ///< of moves that are corrected together, which need memory
  };
  static constexpr std::size_t kMostPieces = 2'000'000;

  /// @param stop  checked whenever the budget is
  ProgramBudget(std::size_t most_bytes, double most_seconds, std::stop_token stop = {})
      : most_bytes_(most_bytes),
        most_seconds_(most_seconds),
        start_(std::chrono::steady_clock::now()),
        stop_(std::move(stop)) {}

  void wrote(std::size_t bytes) { bytes_ += bytes; }
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  /// @param pieces  of moves that are corrected together, not yet written
  /// @throws Stopped if `stop` was requested
  Spent spent(std::size_t pieces = 0) const {
    stop_if_asked(stop_);
    if (bytes_ > most_bytes_) return Spent::bytes;
    if (pieces > kMostPieces) return Spent::pieces;
    return seconds() > most_seconds_ ? Spent::time : Spent::nothing;
  }

 private:
  std::size_t most_bytes_;
  double most_seconds_;
  std::chrono::steady_clock::time_point start_;
  std::stop_token stop_;
  std::atomic<std::size_t> bytes_ = 0;
};

}  // namespace abbe
