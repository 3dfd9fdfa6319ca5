// How the processes share numbered work (docs/scale.md).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "abbe/formats/text/input_error.h"
#include "block_workers.h"
#include "messages_of_work.h"
#include "mpi_group.h"

namespace abbe {
namespace {

using namespace std::chrono_literals;

/// How long a process waits for a block of its own before it looks for messages.
constexpr auto kLook = 1000us;
/// Every process is given blocks for so long, so that it never waits for an answer, s.
constexpr double kAhead = 0.02;
/// In one message: it must not be so long that sending it waits for its receiver.
constexpr std::size_t kMostHandedOut = 200;
constexpr std::size_t kMessageBytes = std::size_t{1} << 26;

/// How many blocks should wait for the threads of a process.
class Pace {
 public:
  explicit Pace(std::size_t threads) : threads_(threads) {}
  void add(std::size_t blocks) { done_ += blocks; }
  std::size_t ahead() const {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    const double blocks = seconds > 0 ? static_cast<double>(done_) / seconds * kAhead : 0;
    return std::clamp(static_cast<std::size_t>(blocks), threads_, kMostHandedOut);
  }

 private:
  std::size_t threads_, done_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

/// One list of blocks in the first process: hands them out and takes the results.
class MpiGroup::FirstOfWork {
 public:
  FirstOfWork(MpiGroup& group, const NumberedWork& work)
      : group_(group), work_(work), owner_(work.blocks, kNobody), is_done_(work.blocks, 0) {
    for (std::size_t block = 0; block < work.blocks; ++block) {
      if (work.has(block)) {
        is_done_[block] = 1;
      } else {
        ++open_;
      }
    }
    to_hand_out_ = open_;
  }

  void run() {
    if (open_ > 0) {
      fingerprint_ = work_.fingerprint();
      compute_and_collect();
    }
    for (int rank = 1; rank < group_.size_; ++rank) {
      if (work_.for_all) send_others(rank);
      group_.send(rank, kWorkDone, {});
    }
  }

 private:
  static constexpr int kNobody = -1;

  void compute_and_collect() {
    BlockWorkers workers(work_);
    while (open_ > 0) {
      while (workers.waiting() < workers.threads() && to_hand_out_ > 0) workers.add(next_for(0));
      if (workers.is_idle()) {
        answer(group_.receive_from_any(), workers.threads());
      } else {
        for (const std::size_t block : workers.finished(kLook)) note(block);
      }
      while (std::optional<Message> message = group_.look()) answer(*message, workers.threads());
    }
  }

  std::size_t next_for(int rank) {
    const auto size = static_cast<std::size_t>(group_.size_), at = static_cast<std::size_t>(work_.in_ranges ? rank : 0);
    std::size_t& next = next_.try_emplace(at, at * work_.blocks / size).first->second;
    while (is_done_[next] != 0 || owner_[next] != kNobody) next = (next + 1) % work_.blocks;
    owner_[next] = rank;
    --to_hand_out_;
    return next;
  }

  void note(std::size_t block) {
    is_done_[block] = 1;
    --open_;
    if (work_.finished) work_.finished(block);
    if (work_.reduce) work_.reduce(block);
  }

  void answer(const Message& message, std::size_t threads) {
    if (message.tag == kLeft) group_.fail_left(message);
    if (message.tag == kResults) {
      take_blocks(message.bytes, [&](std::size_t block, std::span<const std::byte> results) {
        if (block >= work_.blocks || owner_[block] != message.from || is_done_[block] != 0) {
          throw WorkError(fmt::format("{} has sent a block that was not asked of it", group_.name_of(message.from)));
        }
        work_.unpack(block, results);
        note(block);
      });
      return;
    }
    if (message.tag != kAsk) group_.fail_other_work(message.from);
    BlockQuestion question{};
    if (message.bytes.size() != sizeof(question)) throw WorkError("a question of a process is cut off");
    std::memcpy(&question, message.bytes.data(), sizeof(question));
    if (question.number < group_.works_) return;  // it has been told that this is done
    if (question.number != group_.works_ || question.fingerprint != fingerprint_ || question.blocks != work_.blocks) {
      group_.fail_other_work(message.from);
    }
    // At the end everybody gets few, so that nobody waits for one process.
    const std::size_t fair = to_hand_out_ / (2 * static_cast<std::size_t>(group_.size_) * threads) + 1;
    std::vector<std::byte> handed;
    for (std::size_t i = 0; i < std::min<std::size_t>({question.wanted, fair, kMostHandedOut}) && to_hand_out_ > 0; ++i)
      put_number(next_for(message.from), handed);
    group_.send(message.from, kHandedOut, handed);
  }

  void send_others(int rank) {
    std::vector<std::byte> bytes;
    for (std::size_t block = 0; block < work_.blocks; ++block) {
      if (owner_[block] != rank) put_block(work_, block, bytes);
      if (bytes.size() < kMessageBytes && block + 1 < work_.blocks) continue;
      group_.send(rank, kResults, bytes);
      bytes.clear();
    }
  }

  MpiGroup& group_;
  const NumberedWork& work_;
  std::vector<int> owner_;
  std::vector<std::uint8_t> is_done_;
  std::size_t open_ = 0, to_hand_out_ = 0;
  std::map<std::size_t, std::size_t> next_;  // of each range, where the next block is looked for
  std::uint64_t fingerprint_ = 0;
};

/// The same in another process.
class MpiGroup::OtherOfWork {
 public:
  OtherOfWork(MpiGroup& group, const NumberedWork& work) : group_(group), work_(work), workers_(work) {}

  void run() {
    const std::uint64_t fingerprint = work_.fingerprint();
    Pace pace(workers_.threads());
    while (!is_over_) {
      if (!has_asked_ && !is_empty_ && workers_.waiting() < pace.ahead()) {
        ask({group_.works_, fingerprint, work_.blocks, 2 * pace.ahead() - workers_.waiting()});
      }
      if (workers_.is_idle()) take(group_.receive(0));
      std::vector<std::byte> results;
      for (const std::size_t block : workers_.is_idle() ? std::vector<std::size_t>() : workers_.finished(kLook)) {
        pace.add(1);
        put_block(work_, block, results);
        if (work_.reduce) work_.reduce(block);
        if (results.size() >= kMessageBytes) group_.send_soon(0, kResults, std::exchange(results, {}));
      }
      if (!results.empty()) group_.send_soon(0, kResults, std::move(results));
      while (!is_over_) {
        const std::optional<Message> message = group_.look();
        if (!message) break;
        take(*message);
      }
    }
    group_.wait_for_sent();
  }

 private:
  void ask(const BlockQuestion& question) {
    const auto* const first = reinterpret_cast<const std::byte*>(&question);
    group_.send(0, kAsk, {first, first + sizeof(question)});
    has_asked_ = true;
  }

  void take(const Message& message) {
    if (message.tag == kEnd) group_.end();
    if (message.tag == kHandedOut) {
      has_asked_ = false;
      is_empty_ = message.bytes.empty();
      for (std::span<const std::byte> bytes = message.bytes; !bytes.empty();) workers_.add(take_number(bytes));
    } else if (message.tag == kResults) {
      take_blocks(message.bytes, work_.unpack);
    } else if (message.tag == kWorkDone) {
      is_over_ = true;
    } else {
      throw WorkError("the first process does other work");
    }
  }

  MpiGroup& group_;
  const NumberedWork& work_;
  BlockWorkers workers_;
  bool has_asked_ = false, is_empty_ = false, is_over_ = false;
};

void MpiGroup::work(const NumberedWork& work) {
  ++works_;
  if (size_ == 1) return work_in_threads(work);
  if (is_first()) {
    FirstOfWork(*this, work).run();
  } else {
    OtherOfWork(*this, work).run();
  }
}

}  // namespace abbe
