#pragma once

#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/work_in_step.h"
#include "abbe/identify/sums/sum_of_readings.h"

namespace abbe {

/// Several processes of one command, started together (mpi/). Each does what the command says from the same files; they
/// share sums over readings and numbered work, and the first one alone writes.
class ProcessGroup {
 public:
  virtual ~ProcessGroup() = default;
  virtual bool is_first() const = 0;
  /// Distributes the pieces of readings. Every process identifies with it, from the same readings, and gets the same
  /// sums.
  virtual Summation summation() = 0;
  /// Distributes the blocks. Every process calls it with the same work. What is there already, and
  /// NumberedWork::finished, count in the first one.
  virtual void work(const NumberedWork& work) = 0;
  /// For computations that every process makes in step with the others.
  virtual WorkInStep in_step() = 0;
};

}  // namespace abbe
