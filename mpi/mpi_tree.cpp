// What goes up and down the tree of processes (docs/scale.md).
#include <algorithm>
#include <utility>

#include "messages_of_work.h"
#include "mpi_group.h"

namespace abbe {
namespace {

void append_piece(std::vector<std::byte>& bytes, std::vector<std::byte> piece) {
  if (bytes.empty()) {
    bytes = std::move(piece);
  } else {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  }
}

}  // namespace

void MpiGroup::send_in_pieces(std::span<const int> to, int tag, const Bytes& bytes) {
  // A piece that is shorter than others is the last one.
  for (std::span<const std::byte> left = *bytes;;) {
    const std::span<const std::byte> piece = left.first(std::min(left.size(), piece_bytes_));
    for (const int rank : to) send_soon(rank, tag, bytes, piece);
    if (is_last_piece(piece)) return;
    left = left.subspan(piece.size());
  }
}

std::vector<std::vector<std::byte>> MpiGroup::receive_from_children(std::uint64_t key, const std::stop_token& stop) {
  std::vector<std::vector<std::byte>> found(children_.size());
  for (std::size_t open = children_.size(); open > 0;) {
    Message message = receive(stop);
    if (is_late(message)) continue;
    const auto child = std::find(children_.begin(), children_.end(), message.from);
    if (message.tag != kUp || child == children_.end()) fail_out_of_step(message);
    std::vector<std::byte>& bytes = found[static_cast<std::size_t>(child - children_.begin())];
    const bool is_last = is_last_piece(message.bytes);
    append_piece(bytes, std::move(message.bytes));
    if (!is_last) continue;
    if (is_first()) refuse_other_keys(bytes, key);
    --open;
  }
  return found;
}

void MpiGroup::refuse_other_keys(std::span<const std::byte> given, std::uint64_t key) const {
  while (!given.empty()) {
    const std::uint64_t rank = take_number(given);
    if (take_number(given) != key) fail_other_work(static_cast<int>(rank));
    take_bytes(given);
  }
}

// Who does other work is not merged with its neighbours: the first process finds it out, and names it.
std::vector<MpiGroup::Given> MpiGroup::given_from_here(Given own, const WorkInStep::Merge& merge,
                                                       const std::stop_token& stop) {
  const std::vector<std::vector<std::byte>> found = receive_from_children(own.key, stop);
  std::vector<Given> all;
  all.push_back(std::move(own));
  for (std::span<const std::byte> left : found) {
    while (!left.empty()) {
      const std::uint64_t rank = take_number(left), key = take_number(left);
      const std::span<const std::byte> bytes = take_bytes(left);
      if (key == all.back().key) {
        merge(all.back().bytes, bytes);
      } else {
        all.push_back({rank, key, {bytes.begin(), bytes.end()}});
      }
    }
  }
  return all;
}

std::vector<std::byte> MpiGroup::given_by_all(std::uint64_t key, std::vector<std::byte> own,
                                              const WorkInStep::Merge& merge, const std::stop_token& stop) {
  return std::move(given_from_here({0, key, std::move(own)}, merge, stop).front().bytes);
}

void MpiGroup::send_down(const std::vector<std::byte>& total) {
  // The bytes stay where they are until they have been sent.
  send_in_pieces(children_, kDown, Bytes(Bytes(), &total));
  wait_for_sent();
}

std::vector<std::byte> MpiGroup::give(std::uint64_t key, std::vector<std::byte> own, const WorkInStep::Merge& merge,
                                      const std::stop_token& stop) {
  std::vector<std::byte> bytes;
  for (const Given& given : given_from_here({static_cast<std::uint64_t>(rank_), key, std::move(own)}, merge, stop)) {
    put_number(given.rank, bytes);
    put_number(given.key, bytes);
    put_bytes(given.bytes, bytes);
  }
  send_in_pieces({&place_.parent, 1}, kUp, std::make_shared<const std::vector<std::byte>>(std::move(bytes)));
  return receive_down(stop);
}

std::vector<std::byte> MpiGroup::receive_down(const std::stop_token& stop) {
  std::vector<std::byte> total;
  for (bool is_last = false; !is_last;) {
    Message message = receive(stop);
    if (is_late(message)) continue;
    if (message.tag != kDown) fail_out_of_step(message);
    is_last = is_last_piece(message.bytes);
    if (!children_.empty()) {
      const auto piece = std::make_shared<const std::vector<std::byte>>(message.bytes);
      for (const int child : children_) send_soon(child, kDown, piece, *piece);
    }
    append_piece(total, std::move(message.bytes));
  }
  wait_for_sent();
  return total;
}

}  // namespace abbe
