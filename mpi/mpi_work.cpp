// How the processes share numbered work (docs/scale.md).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "block_workers.h"
#include "messages_of_work.h"
#include "mpi_group.h"

namespace abbe {
namespace {

using namespace std::chrono_literals;

/// How long a process waits for a block of its own before it looks for messages: short at the beginning, when the
/// others have nothing yet. Looking takes processor time from the block.
class LookingOut {
 public:
  std::chrono::microseconds wait() const {
    const auto elapsed = std::chrono::steady_clock::now() - begin_;
    return std::clamp(std::chrono::duration_cast<std::chrono::microseconds>(elapsed / 8), 100us, 3000us);
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Every process is given blocks for so long, so that it never waits for an answer, s.
constexpr double kAhead = 0.02;
/// In one message: it must not be so long that sending it waits for its receiver.
constexpr std::size_t kMostHandedOut = 200;
constexpr std::size_t kMessageBytes = std::size_t{1} << 26;
/// Along a tree of several levels: a process receives a message while its parent sends the next one.
constexpr std::size_t kRelayedBytes = std::size_t{1} << 18;
/// Messages that may wait for the processes below.
constexpr std::size_t kMostUnderWay = 16;

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

/// Blocks that a process computes without having asked: half of its range, so that it does not wait for an answer at
/// the beginning of each of many short works.
struct OwnBlocks {
  std::size_t begin = 0, end = 0;

  OwnBlocks(const NumberedWork& work, int rank, int size) {
    // Which kept blocks are there is not known to all processes.
    if (!work.in_ranges || work.is_kept) return;
    const auto at = [&](int process) {
      return static_cast<std::size_t>(process) * work.blocks / static_cast<std::size_t>(size);
    };
    begin = at(rank);
    end = begin + (at(rank + 1) - begin) / 2;
  }
};

BlockQuestion question_in(std::span<const std::byte> bytes) {
  BlockQuestion question{};
  if (bytes.size() != sizeof(question)) throw WorkError("a question of a process is cut off");
  std::memcpy(&question, bytes.data(), sizeof(question));
  return question;
}

}  // namespace

/// One list of blocks in the first process: hands them out and takes the results.
class MpiGroup::FirstOfWork {
 public:
  FirstOfWork(MpiGroup& group, const NumberedWork& work)
      : group_(group),
        work_(work),
        processes_(static_cast<std::size_t>(group.size_)),
        owner_(work.blocks, kNobody),
        is_done_(work.blocks, 0) {
    for (std::size_t block = 0; block < work.blocks; ++block) {
      if (work.has(block)) {
        is_done_[block] = 1;
      } else {
        ++open_;
      }
    }
    to_hand_out_ = open_;
    for (int rank = 1; rank < group.size_; ++rank) {
      const OwnBlocks own(work, rank, group.size_);
      for (std::size_t block = own.begin; block < own.end; ++block) own_by(rank, block);
    }
  }

  void run() {
    group_.last_work_.reset();
    if (open_ > 0) {
      group_.last_work_ = {work_.fingerprint(), work_.blocks};
      compute_and_collect();
    }
    if (work_.for_all) send_results();
    for (const int child : group_.children_) group_.send_soon(child, kWorkDone, std::vector<std::byte>());
    group_.wait_for_sent();
  }

 private:
  static constexpr int kNobody = -1;

  /// What is known of a process.
  struct Process {
    std::size_t open = 0;    ///< blocks that it has to compute or is computing
    std::size_t wanted = 0;  ///< blocks that it has asked for and not been given
    std::size_t threads = 1;
  };

  void compute_and_collect() {
    BlockWorkers workers(work_);
    processes_[0].threads = workers.threads();
    const LookingOut looking;
    while (open_ > 0) {
      const auto has_few = [&] {
        return workers.waiting() < workers.threads() && processes_[0].open < most_open(processes_[0]);
      };
      while (to_hand_out_ > 0 && has_few()) workers.add(next_for(0));
      if (workers.is_idle()) {
        answer(group_.receive({}, kPatiently));
      } else {
        for (const std::size_t block : workers.finished(is_waited_for() ? 200us : looking.wait())) note(block);
      }
      while (std::optional<Message> message = group_.look()) answer(*message);
    }
  }

  std::size_t next_for(int rank) {
    const auto size = static_cast<std::size_t>(group_.size_), at = static_cast<std::size_t>(work_.in_ranges ? rank : 0);
    std::size_t& next = next_.try_emplace(at, at * work_.blocks / size).first->second;
    while (is_done_[next] != 0 || owner_[next] != kNobody) next = (next + 1) % work_.blocks;
    own_by(rank, next);
    return next;
  }

  void own_by(int rank, std::size_t block) {
    owner_[block] = rank;
    --to_hand_out_;
    ++processes_[static_cast<std::size_t>(rank)].open;
  }

  void note(std::size_t block) {
    is_done_[block] = 1;
    --open_;
    --processes_[static_cast<std::size_t>(owner_[block])].open;
    if (work_.finished) work_.finished(block);
    if (work_.reduce) work_.reduce(block);
  }

  void answer(const Message& message) {
    if (message.tag == kResults) {
      take_blocks(message.bytes, [&](std::size_t block, std::span<const std::byte> results) {
        if (block >= work_.blocks || owner_[block] != message.from || is_done_[block] != 0) {
          throw WorkError(fmt::format("{} has sent a block that was not asked of it", group_.name_of(message.from)));
        }
        work_.unpack(block, results);
        note(block);
      });
      return hand_out(message.from);
    }
    if (message.tag != kAsk) group_.fail_out_of_step(message);
    group_.refuse_other_work(message);
    const BlockQuestion question = question_in(message.bytes);
    if (question.number < group_.works_) return;  // it has been told that this is done
    Process& other = processes_[static_cast<std::size_t>(message.from)];
    other.wanted = std::max<std::size_t>(question.wanted, 1);
    other.threads = question.threads;
    hand_out(message.from);
  }

  /// Blocks that a process may have at a time: half of its share of what is left, and one for each thread. So no
  /// process has much to do at the end, when the others have nothing.
  std::size_t most_open(const Process& process) const {
    return open_ / (2 * static_cast<std::size_t>(group_.size_)) + process.threads;
  }

  /// True if a process may need one of the last blocks soon.
  bool is_waited_for() const {
    return to_hand_out_ > 0 && to_hand_out_ <= 2 * processes_.size() &&
           std::any_of(processes_.begin(), processes_.end(), [](const Process& other) { return other.wanted > 0; });
  }

  /// Gives a process what it has asked for, as far as it may have it now.
  void hand_out(int rank) {
    Process& other = processes_[static_cast<std::size_t>(rank)];
    if (other.wanted == 0) return;
    // A process that has enough is given more when it has done some of it.
    const std::size_t most = most_open(other);
    if (to_hand_out_ > 0 && other.open >= most) return;
    std::size_t count = std::min({other.wanted, to_hand_out_, kMostHandedOut});
    if (count > 0) count = std::min(count, most - other.open);
    other.wanted = count > 0 ? other.wanted - count : 0;
    std::vector<std::byte> handed;
    put_number(group_.works_, handed);
    for (; count > 0; --count) put_number(next_for(rank), handed);
    group_.send(rank, kHandedOut, handed);
  }

  /// Down the tree. Processes that relay results get all of them; the others get those that they have not computed.
  void send_results() {
    std::vector<int> relays;
    for (const TreePlace::Child& child : group_.place_.children)
      if (child.relays) relays.push_back(child.rank);
    if (!relays.empty()) send_results(relays, kNobody);
    for (const TreePlace::Child& child : group_.place_.children)
      if (!child.relays) send_results({&child.rank, 1}, child.rank);
  }

  void send_results(std::span<const int> to, int owner) {
    const std::size_t most = group_.place_.is_flat ? kMessageBytes : kRelayedBytes;
    std::vector<std::byte> bytes;
    const auto send = [&] {
      const auto message = std::make_shared<const std::vector<std::byte>>(std::exchange(bytes, {}));
      for (const int rank : to) group_.send_soon(rank, kResults, message, *message);
      group_.wait_for_sent(kMostUnderWay);
    };
    for (std::size_t block = 0; block < work_.blocks; ++block) {
      if (owner == kNobody || owner_[block] != owner) put_block(work_, block, bytes);
      if (bytes.size() >= most) send();
    }
    if (!bytes.empty()) send();
  }

  MpiGroup& group_;
  const NumberedWork& work_;
  std::vector<Process> processes_;  // [processes]
  std::vector<int> owner_;
  std::vector<std::uint8_t> is_done_;
  std::size_t open_ = 0, to_hand_out_ = 0;
  std::map<std::size_t, std::size_t> next_;  // of each range, where the next block is looked for
};

/// The same in another process.
class MpiGroup::OtherOfWork {
 public:
  OtherOfWork(MpiGroup& group, const NumberedWork& work)
      : group_(group), work_(work), workers_(work), is_own_(work.blocks, 0) {}

  void run() {
    const std::uint64_t fingerprint = work_.fingerprint();
    Pace pace(workers_.threads());
    const LookingOut looking;
    const auto ask_for = [&](std::size_t wanted) {
      ask({group_.works_, fingerprint, work_.blocks, wanted, workers_.threads()});
    };
    // The question comes before all results, since it says which work they belong to.
    const OwnBlocks own(work_, group_.rank_, group_.size_);
    ask_for(own.begin < own.end ? 1 : 2 * workers_.threads());
    for (std::size_t block = own.begin; block < own.end; ++block) compute_here(block);
    while (!is_over_) {
      const std::size_t ahead = pace.ahead(), waiting = workers_.waiting();
      if (!has_asked_ && !is_empty_ && waiting < ahead) ask_for(2 * ahead - waiting);
      if (workers_.is_idle()) take(group_.receive({}, kPatiently));
      std::vector<std::byte> results;
      for (const std::size_t block :
           workers_.is_idle() ? std::vector<std::size_t>() : workers_.finished(looking.wait())) {
        pace.add(1);
        put_block(work_, block, results);
        if (work_.reduce) work_.reduce(block);
        if (results.size() >= kMessageBytes) group_.send_soon(0, kResults, std::exchange(results, {}));
      }
      if (!results.empty()) group_.send_soon(0, kResults, std::move(results));
      while (!is_over_) {
        std::optional<Message> message = group_.look();
        if (!message) break;
        take(std::move(*message));
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

  void take(Message message) {
    if (message.tag == kHandedOut) {
      take_handed_out(message.bytes);
    } else if (message.tag == kResults || message.tag == kWorkDone) {
      is_over_ = message.tag == kWorkDone;
      const auto bytes = std::make_shared<const std::vector<std::byte>>(std::move(message.bytes));
      for (const int child : group_.children_) group_.send_soon(child, message.tag, bytes, *bytes);
      take_blocks(*bytes, [this](std::size_t block, std::span<const std::byte> results) {
        if (is_own_.at(block) == 0) work_.unpack(block, results);
      });
      group_.wait_for_sent(kMostUnderWay);
    } else {
      group_.fail_out_of_step(message);
    }
  }

  void take_handed_out(std::span<const std::byte> bytes) {
    if (take_number(bytes) != group_.works_) return;  // came too late
    has_asked_ = false;
    is_empty_ = bytes.empty();
    while (!bytes.empty()) compute_here(take_number(bytes));
  }

  void compute_here(std::size_t block) {
    is_own_.at(block) = 1;
    workers_.add(block);
  }

  MpiGroup& group_;
  const NumberedWork& work_;
  BlockWorkers workers_;
  std::vector<std::uint8_t> is_own_;  // [blocks] computed here
  bool has_asked_ = false, is_empty_ = false, is_over_ = false;
};

void MpiGroup::refuse_other_work(const Message& message) const {
  const BlockQuestion asked = question_in(message.bytes);
  if (asked.number < works_) return;
  const bool differs =
      last_work_ && (asked.fingerprint != last_work_->fingerprint || asked.blocks != last_work_->blocks);
  if (asked.number > works_ || differs) fail_other_work(message.from);
}

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
