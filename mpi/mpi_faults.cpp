// How processes that have failed, or do other work than the first one, end the job (docs/scale.md).
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "abbe/formats/text/input_error.h"
#include "messages_of_work.h"
#include "mpi_group.h"

namespace abbe {
namespace {

/// The end of the first process ends the command of another one.
class FirstHasEnded : public std::runtime_error {
 public:
  FirstHasEnded() : std::runtime_error("the first process has ended") {}
};

}  // namespace

void MpiGroup::end_if_told(const Message& message) {
  if (message.tag == kEnd) end();
  if (message.tag == kLeft) fail_left(message);
  if (message.tag != kOther) return;
  std::span<const std::byte> bytes = message.bytes;
  fail_other_work(static_cast<int>(take_number(bytes)));
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

// What comes from above is of the work of the first process. So it is this one that does other work. What comes from
// below is of somebody who does other work than this one; if that is not the work of the first process either, this one
// has been found out by its own questions or by what comes from above.
void MpiGroup::fail_out_of_step(const Message& message) {
  const bool is_from_below = std::find(children_.begin(), children_.end(), message.from) != children_.end();
  const int other = is_first() || is_from_below ? message.from : rank_;
  if (is_first()) fail_other_work(other);
  std::vector<std::byte> bytes;
  put_number(static_cast<std::uint64_t>(other), bytes);
  send(0, kOther, bytes);
  while (receive_any().tag != kEnd) continue;
  end();
}

bool MpiGroup::is_late(const Message& message) const {
  if (message.tag == kAsk && is_first()) refuse_other_work(message);
  return message.tag == (is_first() ? kAsk : kHandedOut);
}

std::string MpiGroup::name_of(int rank) const { return fmt::format("process {} of {}", rank + 1, size_); }

}  // namespace abbe
