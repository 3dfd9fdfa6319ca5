#pragma once

#include <mpi.h>

#include <chrono>
#include <cstddef>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/study/process_group.h"
#include "process_tree.h"

namespace abbe {

/// The processes of MPI_COMM_WORLD. One object for a process, from MPI_Init() to MPI_Finalize().
///
/// Every process does what the command says from the same files. What all of them need goes along a tree
/// (process_tree.h): sums over readings and work in step go up to the first process, which adds sums as one process
/// does (abbe/identify/sums/sum_of_readings.h), and the total goes down; so do results of numbered work that all go on
/// with. The first process itself hands out blocks of numbered work to all others, and takes their results.
///
/// Whoever receives what does not belong to its own work tells the first process, which ends the job.
class MpiGroup : public ProcessGroup {
 public:
  MpiGroup(int* argc, char*** argv);
  MpiGroup(const MpiGroup&) = delete;
  MpiGroup& operator=(const MpiGroup&) = delete;
  ~MpiGroup() override;

  bool is_first() const override { return rank_ == 0; }
  Summation summation() override;
  void work(const NumberedWork& work) override;
  WorkInStep in_step() override;

  /// Of all but the first, when its command has ended: waits for the end of the first process, which fails if it still
  /// counted on this one.
  /// @param why  what the command has complained about; may be empty
  void leave(const std::string& why);

 private:
  class FirstOfWork;
  class OtherOfWork;
  enum Tag { kUp = 1, kDown, kAsk, kHandedOut, kResults, kWorkDone, kOther, kLeft, kEnd };

  /// What has come from a process.
  struct Message {
    int from = 0, tag = 0;
    std::vector<std::byte> bytes{};
  };
  using Bytes = std::shared_ptr<const std::vector<std::byte>>;
  /// A message that is under way; its bytes stay until the receiver has them.
  struct Sending {
    Bytes bytes;
    MPI_Request request;
  };

  struct WorkSeen {
    std::uint64_t fingerprint, blocks;
  };

  // Along the tree (mpi_tree.cpp).
  /// What neighbouring processes have given together.
  struct Given {
    std::uint64_t rank, key;  ///< of the first of them; fingerprint of what they do
    std::vector<std::byte> bytes;
  };
  std::vector<Given> given_from_here(Given own, const WorkInStep::Merge& merge, const std::stop_token& stop);
  std::vector<std::vector<std::byte>> receive_from_children(std::uint64_t key, const std::stop_token& stop);
  void refuse_other_keys(std::span<const std::byte> given, std::uint64_t key) const;
  /// Of the first process: what merging the bytes of all has made. It then sends down what they are to have.
  std::vector<std::byte> given_by_all(std::uint64_t key, std::vector<std::byte> own, const WorkInStep::Merge& merge,
                                      const std::stop_token& stop = {});
  void send_down(const std::vector<std::byte>& total);
  /// Of all others: gives bytes, and returns what the first process has sent down.
  std::vector<std::byte> give(std::uint64_t key, std::vector<std::byte> own, const WorkInStep::Merge& merge,
                              const std::stop_token& stop = {});
  std::vector<std::byte> receive_down(const std::stop_token& stop);
  void send_in_pieces(std::span<const int> to, int tag, const Bytes& bytes);
  bool is_last_piece(std::span<const std::byte> piece) const { return piece.size() < piece_bytes_; }

  SumOfReadings sum(const SumRequest& request, const Summation::Here& here, const std::stop_token& stop);

  // Messages.
  int length_of(std::span<const std::byte> bytes, int to) const;
  void send(int to, int tag, const std::vector<std::byte>& bytes);
  /// Goes on at once, where send() would wait, and keep a processor busy, until the receiver looks for a long message.
  void send_soon(int to, int tag, const Bytes& bytes, std::span<const std::byte> part);
  void send_soon(int to, int tag, std::vector<std::byte> bytes);
  void drop_sent();
  void wait_for_sent(std::size_t most = 0);  ///< until so few messages are under way
  /// How a process waits for a message: it looks busily, and then sleeps between looks, for this part of the time that
  /// it has waited so far.
  struct Waiting {
    int busy_looks, part;
    std::chrono::microseconds least_sleep;
  };
  static constexpr Waiting kBusily = {400, 8, std::chrono::microseconds(5)};
  /// Where the message may take long, as blocks do: a busy look takes nearly 1 us of processor time.
  static constexpr Waiting kPatiently = {20, 16, std::chrono::microseconds(20)};
  Message receive_any(const std::stop_token& stop = {}, Waiting waiting = kBusily);
  Message receive_found(const MPI_Status& status);
  /// As receive_any(), but ends if that is what it says.
  Message receive(const std::stop_token& stop = {}, Waiting waiting = kBusily);
  std::optional<Message> look();  ///< a message from anybody, if there is one
  void take_what_is_left();

  // Faults.
  void end_if_told(const Message& message);
  [[noreturn]] void end();  ///< of all but the first: the first process has ended
  [[noreturn]] void fail_left(const Message& message) const;
  [[noreturn]] void fail_other_work(int rank) const;
  [[noreturn]] void fail_out_of_step(const Message& message);  ///< does not belong to what this process does
  /// Of what has come in step: true for a question or an answer about numbered work that is done.
  bool is_late(const Message& message) const;
  void refuse_other_work(const Message& message) const;  ///< a question
  std::string name_of(int rank) const;

  int rank_ = 0, size_ = 1;
  TreePlace place_{};
  std::vector<int> children_{};
  std::size_t piece_bytes_ = 0;          // of a message along the tree
  bool ended_ = false;                   // the first process has said so
  int left_ = 0;                         // processes that have ended their command
  std::uint64_t works_ = 0;              // lists of numbered work that were begun
  std::optional<WorkSeen> last_work_{};  // the last one, once the first process has its fingerprint
  std::list<Sending> sending_{};
};

}  // namespace abbe
