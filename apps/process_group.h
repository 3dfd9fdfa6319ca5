#pragma once

#include "abbe/formats/study/study.h"
#include "abbe/identify/sums/sum_of_readings.h"

namespace abbe {

/// The processes that mpirun has started for one command (mpi/). Each has read the same study.
class ProcessGroup {
 public:
  virtual ~ProcessGroup() = default;
  /// The first process does what the command says; the others sum readings for it.
  virtual bool is_first() const = 0;
  /// Of the others: sums readings of the study until the first process ends. @returns an ExitCode
  virtual int serve(const Study& study) = 0;
  /// Of the first: shares the readings of the study out.
  virtual Summation summation(const Study& study) = 0;
};

}  // namespace abbe
