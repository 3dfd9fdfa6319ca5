#pragma once

#include <mpi.h>

#include <cstddef>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/study/process_group.h"

namespace abbe {

/// The processes of MPI_COMM_WORLD. One object for a process, from MPI_Init() to MPI_Finalize().
///
/// Every process does what the command says from the same files. Sums over readings: each process sums a range of
/// pieces, the first one adds them all up and sends the sums to the others; what it adds up does not depend on their
/// number (abbe/identify/sums/sum_of_readings.h). Numbered work: the first process hands out blocks and takes results.
/// Work in step: the first one receives what the others give, and sends it to all.
class MpiGroup : public ProcessGroup {
 public:
  MpiGroup(int* argc, char*** argv);
  MpiGroup(const MpiGroup&) = delete;
  MpiGroup& operator=(const MpiGroup&) = delete;
  ~MpiGroup() override;

  bool is_first() const override { return rank_ == 0; }
  Summation summation(const Study& study) override;
  void work(const NumberedWork& work) override;
  WorkInStep in_step() override;

  /// Of all but the first, when its command has ended: waits for the end of the first process, which fails if it still
  /// counted on this one.
  /// @param why  what the command has complained about; may be empty
  void leave(const std::string& why);

 private:
  class FirstOfWork;
  class OtherOfWork;
  enum Tag { kSum = 1, kAsk, kHandedOut, kResults, kWorkDone, kLeft, kEnd, kInStep };

  /// What has come from a process.
  struct Message {
    int from = 0, tag = 0;
    std::vector<std::byte> bytes;
  };

  std::vector<std::vector<std::byte>> gather(std::uint64_t fingerprint, std::span<const std::byte> own);
  SumOfReadings sum(PieceSummer& summer, const SumRequest& request, int threads, const std::stop_token& stop);
  /// A message that is under way; its bytes stay until the receiver has them.
  struct Sending {
    Sending(std::vector<std::byte> given, MPI_Request none) : bytes(std::move(given)), request(none) {}
    std::vector<std::byte> bytes;
    MPI_Request request;
  };

  int length_of(const std::vector<std::byte>& bytes, int to) const;
  void send(int to, int tag, const std::vector<std::byte>& bytes);
  /// Goes on at once, where send() would wait, and keep a processor busy, until the receiver looks for a long message.
  void send_soon(int to, int tag, std::vector<std::byte> bytes);
  void drop_sent();
  void wait_for_sent();
  Message receive(int from, const std::stop_token& stop = {});
  Message receive_from_any();
  std::optional<Message> look();  ///< a message from anybody, if there is one
  [[noreturn]] void end();        ///< of all but the first: the first process has ended
  [[noreturn]] void fail_left(const Message& message) const;
  [[noreturn]] void fail_other_work(int rank) const;
  std::string name_of(int rank) const;

  int rank_ = 0, size_ = 1;
  bool ended_ = false;            // the first process has said so
  std::uint64_t works_ = 0;       // lists of numbered work that were begun
  std::vector<bool> has_left_{};  // [size_]: has ended its command
  std::list<Sending> sending_{};
};

}  // namespace abbe
