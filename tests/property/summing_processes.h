#pragma once

// Child processes that sum pieces of the readings of a study, for the tests of an identification over several
// processes.
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "abbe/identify/sums/sum_of_readings.h"

namespace abbe::test {

/// Bytes over a socket, with their number before them; nothing at the end of the other side.
class Channel {
 public:
  explicit Channel(int file) : file_(file) {}
  bool send(const std::vector<std::byte>& bytes) const {
    const std::uint64_t size = bytes.size();
    return send_all(&size, sizeof size) && send_all(bytes.data(), bytes.size());
  }
  std::optional<std::vector<std::byte>> receive() const {
    std::uint64_t size = 0;
    if (!receive_all(&size, sizeof size)) return std::nullopt;
    std::vector<std::byte> bytes(size);
    if (!receive_all(bytes.data(), bytes.size())) return std::nullopt;
    return bytes;
  }
  void close() const { ::close(file_); }

 private:
  bool send_all(const void* data, std::size_t size) const {
    for (const char* next = static_cast<const char*>(data); size > 0;) {
      const ssize_t sent = ::send(file_, next, size, MSG_NOSIGNAL);
      if (sent <= 0) return false;
      next += sent;
      size -= static_cast<std::size_t>(sent);
    }
    return true;
  }
  bool receive_all(void* data, std::size_t size) const {
    for (char* next = static_cast<char*>(data); size > 0;) {
      const ssize_t received = ::recv(file_, next, size, 0);
      if (received <= 0) return false;
      next += received;
      size -= static_cast<std::size_t>(received);
    }
    return true;
  }

  int file_;
};

/// Processes of their own, each with its own readings; ended and waited for with this object.
class SummingProcesses {
 public:
  /// @param problem_of  called in the child: the problem of that process
  /// @param spoil       called in the child with the number of the sum; may change it, or end the process
  SummingProcesses(std::size_t count, const std::function<Problem(std::size_t process)>& problem_of,
                   const std::function<void(std::size_t process, int number, SumOfReadings&)>& spoil = {}) {
    for (std::size_t process = 0; process < count; ++process) {
      int ends[2];
      if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw SumError("no sockets");
      const pid_t child = ::fork();
      if (child < 0) throw SumError("no processes");
      if (child == 0) {
        for (const Channel& other : channels_) other.close();
        ::close(ends[0]);
        int code = 1;
        try {
          serve(Channel(ends[1]), problem_of(process), [&](int number, SumOfReadings& sum) {
            if (spoil) spoil(process, number, sum);
          });
          code = 0;
        } catch (...) {
        }
        ::_exit(code);
      }
      ::close(ends[1]);
      channels_.emplace_back(ends[0]);
      children_.push_back(child);
    }
  }
  SummingProcesses(const SummingProcesses&) = delete;
  SummingProcesses& operator=(const SummingProcesses&) = delete;
  ~SummingProcesses() {
    for (const Channel& channel : channels_) channel.close();
    for (const pid_t child : children_) ::waitpid(child, nullptr, 0);
  }

  /// Every process sums the range that `ranges` gives it; the sums are taken in another order each time.
  std::vector<SumOfReadings> sums(const SumRequest& request, const std::vector<PieceRange>& ranges) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      std::vector<std::byte> bytes = to_bytes(request);
      for (const std::size_t bound : {ranges[i].first, ranges[i].last})
        for (std::size_t k = 0; k < 8; ++k) bytes.push_back(static_cast<std::byte>(bound >> (8 * k)));
      channels_[i].send(bytes);  // whether it has ended shows in receive()
    }
    std::vector<SumOfReadings> parts;
    ++number_;
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      const std::size_t i = (5 * k + number_) % channels_.size();  // 5: prime to the numbers of processes here
      const std::optional<std::vector<std::byte>> bytes = channels_[i].receive();
      if (!bytes) throw SumError("process " + std::to_string(i) + " has ended without its sum");
      parts.push_back(sum_from_bytes(*bytes));
    }
    return parts;
  }

 private:
  static void serve(const Channel& channel, Problem problem, const std::function<void(int, SumOfReadings&)>& spoil) {
    PieceSummer summer(std::move(problem));
    for (int number = 1;; ++number) {
      const std::optional<std::vector<std::byte>> bytes = channel.receive();
      if (!bytes) return;
      const std::size_t size = bytes->size() - 16;
      PieceRange range;
      for (std::size_t k = 0; k < 8; ++k) {
        range.first |= static_cast<std::size_t>((*bytes)[size + k]) << (8 * k);
        range.last |= static_cast<std::size_t>((*bytes)[size + 8 + k]) << (8 * k);
      }
      SumOfReadings sum = summer.sum(request_from_bytes(std::span(*bytes).first(size)), range, {.threads = 1});
      spoil(number, sum);
      if (!channel.send(to_bytes(sum))) return;
    }
  }

  std::vector<Channel> channels_;
  std::vector<pid_t> children_;
  std::size_t number_ = 0;
};

}  // namespace abbe::test
