#include "mpi_group.h"

#include <fmt/format.h>
#include <mpi.h>
#include <sys/prctl.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <stdexcept>
#include <thread>
#include <utility>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/stopped.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

constexpr std::size_t kLongestComplaint = 1000;

/// The end of the first process ends the command of another one.
class FirstHasEnded : public std::runtime_error {
 public:
  FirstHasEnded() : std::runtime_error("the first process has ended") {}
};

}  // namespace

MpiGroup::MpiGroup(int* argc, char*** argv) {
  // By default the kernel ends a sleep up to 50 us late, which is longer than some messages take.
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0, 0, 0);
  int level = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  has_left_.assign(static_cast<std::size_t>(size_), false);
}

MpiGroup::~MpiGroup() {
  if (is_first()) {
    for (int i = 1; i < size_; ++i) send(i, kEnd, {});
    // What they are sending is taken, or they would wait for that.
    for (int i = 1; i < size_; ++i) {
      while (!has_left_[static_cast<std::size_t>(i)]) receive(i);
    }
  }
  wait_for_sent();
  MPI_Finalize();
}

int MpiGroup::length_of(const std::vector<std::byte>& bytes, int to) const {
  if (bytes.size() > INT_MAX) {
    throw SumError(fmt::format("a message of {} bytes for {} exceeds the 2 GiB of MPI; expected more processes",
                               bytes.size(), name_of(to)));
  }
  return static_cast<int>(bytes.size());
}

void MpiGroup::send(int to, int tag, const std::vector<std::byte>& bytes) {
  MPI_Send(bytes.data(), length_of(bytes, to), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

void MpiGroup::send_soon(int to, int tag, std::vector<std::byte> bytes) {
  const int length = length_of(bytes, to);
  Sending& sending = sending_.emplace_back(std::move(bytes), MPI_REQUEST_NULL);
  MPI_Isend(sending.bytes.data(), length, MPI_BYTE, to, tag, MPI_COMM_WORLD, &sending.request);
}

void MpiGroup::drop_sent() {
  std::erase_if(sending_, [](Sending& sending) {
    int is_sent = 0;
    MPI_Test(&sending.request, &is_sent, MPI_STATUS_IGNORE);
    return is_sent != 0;
  });
}

void MpiGroup::wait_for_sent() {
  for (Sending& sending : sending_) MPI_Wait(&sending.request, MPI_STATUS_IGNORE);
  sending_.clear();
}

std::optional<MpiGroup::Message> MpiGroup::look() {
  drop_sent();
  MPI_Status status;
  int has_come = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &has_come, &status);
  if (has_come == 0) return {};
  return receive(status.MPI_SOURCE);
}

MpiGroup::Message MpiGroup::receive_from_any() { return receive(MPI_ANY_SOURCE); }

MpiGroup::Message MpiGroup::receive(int from, const std::stop_token& stop) {
  // MPI_Recv() would keep a processor busy, which a computing process needs.
  using namespace std::chrono_literals;
  using Clock = std::chrono::steady_clock;
  constexpr int kBusyLooks = 400;
  MPI_Status status;
  int has_come = 0;
  Clock::time_point begin;
  for (int look = 0;; ++look) {
    MPI_Iprobe(from, MPI_ANY_TAG, MPI_COMM_WORLD, &has_come, &status);
    if (has_come != 0) break;
    stop_if_asked(stop);
    if (look == 0) begin = Clock::now();
    // The longer it has waited, the longer it sleeps: looking takes processor time, and waking up late takes an eighth
    // of what it has waited anyway.
    if (look >= kBusyLooks)
      std::this_thread::sleep_for(std::clamp<Clock::duration>((Clock::now() - begin) / 8, 5us, 1ms));
  }
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  Message message{status.MPI_SOURCE, status.MPI_TAG, std::vector<std::byte>(static_cast<std::size_t>(count))};
  MPI_Recv(message.bytes.data(), count, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  if (message.tag == kLeft) has_left_[static_cast<std::size_t>(message.from)] = true;
  return message;
}

void MpiGroup::end() {
  ended_ = true;
  throw FirstHasEnded();
}

void MpiGroup::fail_left(const Message& message) const {
  std::string why(reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size());
  if (why.empty()) why = "has ended before the others";
  throw InputError({.file = name_of(message.from)}, why, "the same program and the same files in every process");
}

void MpiGroup::fail_other_work(int rank) const {
  throw InputError({.file = name_of(rank)}, "does work of another problem",
                   "the same program and the same files in every process");
}

std::string MpiGroup::name_of(int rank) const { return fmt::format("process {} of {}", rank + 1, size_); }

Summation MpiGroup::summation(const Study& study) {
  if (size_ == 1) return {};
  // Made when the first sum is asked for, after the study has read the same readings.
  const auto summer = std::make_shared<std::optional<PieceSummer>>();
  return [this, study, summer](const SumRequest& request, const std::stop_token& stop) {
    if (!*summer) summer->emplace(prepared_problem(study));
    return sum(**summer, request, study.threads, stop);
  };
}

SumOfReadings MpiGroup::sum(PieceSummer& summer, const SumRequest& request, int threads, const std::stop_token& stop) {
  const auto share = [&](int rank) {
    return share_of_pieces(request.pieces, static_cast<std::size_t>(rank), static_cast<std::size_t>(size_));
  };
  SumOfReadings own = summer.sum(request, share(rank_), {.threads = threads, .stop = stop});
  if (!is_first()) {
    send(0, kSum, to_bytes(own));
    const Message message = receive(0, stop);
    if (message.tag == kEnd) end();
    return sum_from_bytes(message.bytes);
  }
  std::vector<SumOfReadings> parts;
  parts.push_back(std::move(own));
  for (int i = 1; i < size_; ++i) {
    Message message = receive(i, stop);
    // What it asked before it was told that numbered work is done.
    while (message.tag == kAsk && works_ > 0) message = receive(i, stop);
    if (message.tag == kLeft) fail_left(message);
    if (message.tag != kSum) fail_other_work(i);
    parts.push_back(sum_from_bytes(message.bytes));
    if (parts.back().point != parts.front().point || parts.back().selection != parts.front().selection) {
      fail_other_work(i);
    }
  }
  SumOfReadings all = merge_all(std::move(parts));
  const std::vector<std::byte> bytes = to_bytes(all);
  for (int i = 1; i < size_; ++i) send(i, kSum, bytes);
  return all;
}

void MpiGroup::leave(const std::string& why) {
  const auto* const first = reinterpret_cast<const std::byte*>(why.data());
  send(0, kLeft, {first, first + std::min(why.size(), kLongestComplaint)});
  while (!ended_) ended_ = receive(0).tag == kEnd;
}

}  // namespace abbe
