#include "mpi_group.h"

#include <fmt/format.h>
#include <mpi.h>

#include <chrono>
#include <climits>
#include <stdexcept>
#include <thread>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/stopped.h"
#include "abbe/study/study_steps.h"
#include "exit_code.h"

namespace abbe {
namespace {

enum Tag { kRequest = 1, kEnd = 2, kSum = 3, kFault = 4 };

/// A range behind the bytes of a request: two numbers of 8 bytes, little-endian.
constexpr std::size_t kRangeBytes = 16;

void append_range(PieceRange range, std::vector<std::byte>& bytes) {
  for (const std::size_t bound : {range.first, range.last}) {
    for (int k = 0; k < 8; ++k) bytes.push_back(static_cast<std::byte>(bound >> (8 * k)));
  }
}

PieceRange range_at_end(const std::vector<std::byte>& bytes) {
  if (bytes.size() < kRangeBytes) throw SumError("a request of a process is cut off");
  const std::byte* const at = bytes.data() + bytes.size() - kRangeBytes;
  PieceRange range;
  for (int k = 0; k < 8; ++k) {
    range.first |= static_cast<std::size_t>(at[k]) << (8 * k);
    range.last |= static_cast<std::size_t>(at[8 + k]) << (8 * k);
  }
  return range;
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

}  // namespace

MpiGroup::MpiGroup(int* argc, char*** argv) {
  int level = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  is_awaited_.assign(static_cast<std::size_t>(size_), false);
}

MpiGroup::~MpiGroup() {
  if (is_first()) {
    // A process that still sums is not told before it has answered.
    for (int i = 1; i < size_; ++i) {
      if (is_awaited_[static_cast<std::size_t>(i)]) receive(i);
      send(i, kEnd, {});
    }
  }
  MPI_Finalize();
}

void MpiGroup::send(int to, int tag, const std::vector<std::byte>& bytes) {
  if (bytes.size() > INT_MAX) {
    throw SumError(fmt::format("a message of {} bytes for {} exceeds the 2 GiB of MPI; expected more processes",
                               bytes.size(), name_of(to)));
  }
  MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

MpiGroup::Message MpiGroup::receive(int from, const std::stop_token& stop) {
  // MPI_Recv() would keep a processor busy, which the first process needs between two requests.
  using namespace std::chrono_literals;
  constexpr int kBusyLooks = 2000;
  MPI_Status status;
  int has_come = 0;
  for (int look = 0;;) {
    MPI_Iprobe(from, MPI_ANY_TAG, MPI_COMM_WORLD, &has_come, &status);
    if (has_come != 0) break;
    stop_if_asked(stop);
    if (look < kBusyLooks) {
      ++look;
    } else {
      std::this_thread::sleep_for(200us);
    }
  }
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  Message message{status.MPI_TAG, std::vector<std::byte>(static_cast<std::size_t>(count))};
  MPI_Recv(message.bytes.data(), count, MPI_BYTE, from, message.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return message;
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
  const auto processes = static_cast<std::size_t>(size_);
  const std::vector<std::byte> bytes = to_bytes(request);
  for (int i = 1; i < size_; ++i) {
    std::vector<std::byte> own = bytes;
    append_range(share_of_pieces(request.pieces, static_cast<std::size_t>(i), processes), own);
    send(i, kRequest, own);
    is_awaited_[static_cast<std::size_t>(i)] = true;
  }
  std::vector<SumOfReadings> parts;
  parts.push_back(
      summer.sum(request, share_of_pieces(request.pieces, 0, processes), {.threads = threads, .stop = stop}));
  for (int i = 1; i < size_; ++i) {
    const Message message = receive(i, stop);
    is_awaited_[static_cast<std::size_t>(i)] = false;
    if (message.tag == kFault) {
      throw InputError({.file = name_of(i)},
                       std::string(reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size()),
                       "the same program and the same files in every process");
    }
    parts.push_back(sum_from_bytes(message.bytes));
  }
  return merge_all(std::move(parts));
}

int MpiGroup::serve(const Study& study) {
  if (!study.identification) return kDone;  // nothing is summed
  PieceSummer summer(prepared_problem(study));
  while (!ended_) {
    const Message message = receive(0);
    if (message.tag == kEnd) {
      ended_ = true;
      break;
    }
    try {
      const PieceRange range = range_at_end(message.bytes);
      const std::span<const std::byte> request(message.bytes.data(), message.bytes.size() - kRangeBytes);
      send(0, kSum, to_bytes(summer.sum(request_from_bytes(request), range, {.threads = study.threads})));
    } catch (const std::exception& error) {
      send(0, kFault, bytes_of(error.what()));
    }
  }
  return kDone;
}

void MpiGroup::refuse(const std::string& why) {
  while (!ended_) {
    if (receive(0).tag == kEnd) {
      ended_ = true;
    } else {
      send(0, kFault, bytes_of(why));
    }
  }
}

}  // namespace abbe
