// Work that the processes do in step (docs/scale.md).
#include <utility>

#include "messages_of_work.h"
#include "mpi_group.h"

namespace abbe {
namespace {

void put_bytes(std::span<const std::byte> added, std::vector<std::byte>& bytes) {
  put_number(added.size(), bytes);
  bytes.insert(bytes.end(), added.begin(), added.end());
}

}  // namespace

WorkInStep MpiGroup::in_step() {
  return {static_cast<std::size_t>(size_), static_cast<std::size_t>(rank_),
          [this](std::uint64_t fingerprint, std::span<const std::byte> own) { return gather(fingerprint, own); }};
}

std::vector<std::vector<std::byte>> MpiGroup::gather(std::uint64_t fingerprint, std::span<const std::byte> own) {
  std::vector<std::vector<std::byte>> parts(static_cast<std::size_t>(size_));
  parts[static_cast<std::size_t>(rank_)].assign(own.begin(), own.end());
  if (!is_first()) {
    std::vector<std::byte> bytes;
    put_number(fingerprint, bytes);
    bytes.insert(bytes.end(), own.begin(), own.end());
    send(0, kInStep, bytes);
    const Message message = receive(0);
    if (message.tag == kEnd) end();
    if (message.tag != kInStep) throw WorkError("the first process does other work");
    std::span<const std::byte> left = message.bytes;
    for (std::vector<std::byte>& part : parts) {
      const std::uint64_t size = take_number(left);
      if (size > left.size()) throw WorkError("a message of a process is cut off");
      part.assign(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(size));
      left = left.subspan(size);
    }
    return parts;
  }
  for (int i = 1; i < size_; ++i) {
    Message message = receive(i);
    // What it asked before it was told that numbered work is done.
    while (message.tag == kAsk && works_ > 0) message = receive(i);
    if (message.tag == kLeft) fail_left(message);
    if (message.tag != kInStep) fail_other_work(i);
    std::span<const std::byte> left = message.bytes;
    if (take_number(left) != fingerprint) fail_other_work(i);
    parts[static_cast<std::size_t>(i)].assign(left.begin(), left.end());
  }
  std::vector<std::byte> all;
  for (const std::vector<std::byte>& part : parts) put_bytes(part, all);
  for (int i = 1; i < size_; ++i) send(i, kInStep, all);
  return parts;
}

}  // namespace abbe
