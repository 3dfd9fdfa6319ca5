#include "mpi_group.h"

#include <fmt/format.h>
#include <mpi.h>
#include <sys/prctl.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <cstdlib>
#include <string_view>
#include <thread>
#include <utility>

#include "abbe/geometry/stopped.h"

namespace abbe {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLongestComplaint = 1000;
/// Along a tree of several levels: short enough that a process receives a part while its parent sends the next one.
constexpr std::size_t kPieceBytes = std::size_t{1} << 18;
/// Where nobody relays anything: half of the longest message of MPI.
constexpr std::size_t kLongestPiece = std::size_t{1} << 30;

/// On one machine messages go through its memory. The support of networks, which takes every process 10 ms to load, is
/// then left out, unless the environment says otherwise.
void leave_networks_out() {
  const char *const here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE"), *const all = std::getenv("OMPI_COMM_WORLD_SIZE");
  if (here != nullptr && all != nullptr && std::string_view(here) == all) ::setenv("OMPI_MCA_pml", "ob1", 0);
}

}  // namespace

MpiGroup::MpiGroup(int* argc, char*** argv) {
  leave_networks_out();
  int level = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &level);
  // By default the kernel ends a sleep up to 50 us late, which is longer than some messages take. Not before MPI has
  // started: meanwhile the processes sleep hundreds of times.
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0, 0, 0);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  place_ = place_in_tree(rank_, size_);
  for (const TreePlace::Child& child : place_.children) children_.push_back(child.rank);
  piece_bytes_ = place_.is_flat ? kLongestPiece : kPieceBytes;
}

MpiGroup::~MpiGroup() {
  if (is_first()) {
    for (int i = 1; i < size_; ++i) send(i, kEnd, {});
    while (left_ + 1 < size_) receive_any();
  }
  take_what_is_left();
  MPI_Finalize();
}

// A process that sends a long message waits for its receiver. So every process takes messages until none sends any
// more.
void MpiGroup::take_what_is_left() {
  MPI_Request nobody_sends = MPI_REQUEST_NULL;
  for (int is_over = 0; is_over == 0;) {
    int has_come = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &has_come, &status);
    if (has_come != 0) receive_found(status);
    drop_sent();
    if (sending_.empty() && nobody_sends == MPI_REQUEST_NULL) MPI_Ibarrier(MPI_COMM_WORLD, &nobody_sends);
    if (nobody_sends != MPI_REQUEST_NULL) MPI_Test(&nobody_sends, &is_over, MPI_STATUS_IGNORE);
    if (has_come == 0 && is_over == 0) std::this_thread::sleep_for(20us);
  }
}

int MpiGroup::length_of(std::span<const std::byte> bytes, int to) const {
  if (bytes.size() > INT_MAX) {
    throw SumError(fmt::format("a message of {} bytes for {} exceeds the 2 GiB of MPI; expected more processes",
                               bytes.size(), name_of(to)));
  }
  return static_cast<int>(bytes.size());
}

void MpiGroup::send(int to, int tag, const std::vector<std::byte>& bytes) {
  MPI_Send(bytes.data(), length_of(bytes, to), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

void MpiGroup::send_soon(int to, int tag, const Bytes& bytes, std::span<const std::byte> part) {
  const int length = length_of(part, to);
  Sending& sending = sending_.emplace_back(Sending{bytes, MPI_REQUEST_NULL});
  MPI_Isend(part.data(), length, MPI_BYTE, to, tag, MPI_COMM_WORLD, &sending.request);
}

void MpiGroup::send_soon(int to, int tag, std::vector<std::byte> bytes) {
  const auto shared = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  send_soon(to, tag, shared, *shared);
}

void MpiGroup::drop_sent() {
  sending_.remove_if([](Sending& sending) {
    int is_sent = 0;
    MPI_Test(&sending.request, &is_sent, MPI_STATUS_IGNORE);
    return is_sent != 0;
  });
}

void MpiGroup::wait_for_sent(std::size_t most) {
  // MPI_Wait() would keep a processor busy until the receiver comes.
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  for (drop_sent(); sending_.size() > most; drop_sent()) {
    std::this_thread::sleep_for(std::clamp<Clock::duration>((Clock::now() - begin) / 16, 20us, 1ms));
  }
}

std::optional<MpiGroup::Message> MpiGroup::look() {
  drop_sent();
  MPI_Status status;
  int has_come = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &has_come, &status);
  if (has_come == 0) return {};
  Message message = receive_found(status);
  end_if_told(message);
  return message;
}

MpiGroup::Message MpiGroup::receive(const std::stop_token& stop, Waiting waiting) {
  Message message = receive_any(stop, waiting);
  end_if_told(message);
  return message;
}

MpiGroup::Message MpiGroup::receive_any(const std::stop_token& stop, Waiting waiting) {
  // MPI_Recv() would keep a processor busy, which a computing process needs.
  using Clock = std::chrono::steady_clock;
  MPI_Status status;
  int has_come = 0;
  Clock::time_point begin;
  for (int look = 0;; ++look) {
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &has_come, &status);
    if (has_come != 0) return receive_found(status);
    stop_if_asked(stop);
    if (look == 0) begin = Clock::now();
    if (look < waiting.busy_looks) continue;
    drop_sent();
    // The longer it has waited, the longer it sleeps: looking takes processor time, and waking up late takes a part of
    // what it has waited anyway. While it looks, its own long messages go on.
    const Clock::duration longest = sending_.empty() ? 1ms : 50us, waited = Clock::now() - begin;
    std::this_thread::sleep_for(std::clamp<Clock::duration>(waited / waiting.part, waiting.least_sleep, longest));
  }
}

MpiGroup::Message MpiGroup::receive_found(const MPI_Status& status) {
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  Message message{status.MPI_SOURCE, status.MPI_TAG, std::vector<std::byte>(static_cast<std::size_t>(count))};
  MPI_Recv(message.bytes.data(), count, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  if (message.tag == kLeft) ++left_;
  return message;
}

void MpiGroup::leave(const std::string& why) {
  const auto* const first = reinterpret_cast<const std::byte*>(why.data());
  send(0, kLeft, {first, first + std::min(why.size(), kLongestComplaint)});
  while (!ended_) ended_ = receive_any().tag == kEnd;
}

}  // namespace abbe
