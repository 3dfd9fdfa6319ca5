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

/// How long a process waits for a block of its own before it looks for messages.
constexpr auto kLook = 1000us;
/// Every process is given blocks for so long, so that it never waits for an answer, s.
constexpr double kAhead = 0.02;
/// In one message: it must not be so long that sending it waits for its receiver.
constexpr std::size_t kMostHandedOut = 200;
constexpr std::size_t kMessageBytes = std::size_t{1} << 26;
/// Along a tree of several levels: one receives while the one above it sends.
constexpr std::size_t kRelayedBytes = std::size_t{1} << 18;
/// So many messages may wait for the processes below.
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

  void compute_and_collect() {
    BlockWorkers workers(work_);
    while (open_ > 0) {
      while (workers.waiting() < workers.threads() && to_hand_out_ > 0) workers.add(next_for(0));
      if (workers.is_idle()) {
        answer(group_.receive(), workers.threads());
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
    if (message.tag != kAsk) group_.fail_out_of_step(message);
    group_.refuse_other_work(message);
    const BlockQuestion question = question_in(message.bytes);
    if (question.number < group_.works_) return;  // it has been told that this is done
    // At the end everybody gets few, so that nobody waits for one process.
    const std::size_t fair = to_hand_out_ / (2 * static_cast<std::size_t>(group_.size_) * threads) + 1;
    std::vector<std::byte> handed;
    put_number(question.number, handed);
    for (std::size_t i = 0; i < std::min<std::size_t>({question.wanted, fair, kMostHandedOut}) && to_hand_out_ > 0; ++i)
      put_number(next_for(message.from), handed);
    group_.send(message.from, kHandedOut, handed);
  }

  /// Down the tree. Whoever relays them gets all, and others those that they have not computed.
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
    while (!is_over_) {
      if (!has_asked_ && !is_empty_ && workers_.waiting() < pace.ahead()) {
        ask({group_.works_, fingerprint, work_.blocks, 2 * pace.ahead() - workers_.waiting()});
      }
      if (workers_.is_idle()) take(group_.receive());
      std::vector<std::byte> results;
      for (const std::size_t block : workers_.is_idle() ? std::vector<std::size_t>() : workers_.finished(kLook)) {
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
    while (!bytes.empty()) {
      const std::uint64_t block = take_number(bytes);
      is_own_.at(block) = 1;
      workers_.add(block);
    }
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
