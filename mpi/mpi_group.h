#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "process_group.h"

namespace abbe {

/// The processes of MPI_COMM_WORLD. One object for a process, from MPI_Init() to MPI_Finalize().
///
/// The first process sends a request and a range of pieces to each of the others, sums the first range itself, and
/// takes the sums; what it adds up does not depend on their number (abbe/identify/sums/sum_of_readings.h). The readings
/// are not sent: every process reads or simulates them.
class MpiGroup : public ProcessGroup {
 public:
  MpiGroup(int* argc, char*** argv);
  MpiGroup(const MpiGroup&) = delete;
  MpiGroup& operator=(const MpiGroup&) = delete;
  ~MpiGroup() override;

  bool is_first() const override { return rank_ == 0; }
  int serve(const Study& study) override;
  Summation summation(const Study& study) override;

  /// Of all but the first: answers every request with this text, until the first process ends.
  void refuse(const std::string& why);

 private:
  /// What has come from a process.
  struct Message {
    int tag = 0;
    std::vector<std::byte> bytes;
  };

  SumOfReadings sum(PieceSummer& summer, const SumRequest& request, int threads, const std::stop_token& stop);
  void send(int to, int tag, const std::vector<std::byte>& bytes);
  Message receive(int from, const std::stop_token& stop = {});
  std::string name_of(int rank) const;

  int rank_ = 0, size_ = 1;
  bool ended_ = false;              // the first process has said so
  std::vector<bool> is_awaited_{};  // [size_]: has a request that it has not answered
};

}  // namespace abbe
