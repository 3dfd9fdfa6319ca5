#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace abbe {

/// Results of numbered work from another process or a file do not fit. The message says how.
class WorkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Work that is a list of numbered items which do not depend on each other, in blocks of consecutive ones.
///
/// Every block leaves its results in a place of its own. They are reduced afterwards in the order of their numbers, so
/// no bit depends on who has computed which block, or when. As bytes, the results of a block can come from another
/// process or from a file (pack, unpack).
struct NumberedWork {
  std::string name;        ///< for messages: "Monte Carlo"
  std::size_t blocks = 0;  ///< number of all
  int threads = 0;         ///< as for_each_block()
  /// Several blocks may be computed at a time, each on one thread; else one after the other, each with all threads.
  bool in_parallel = true;
  bool is_followed = false;  ///< more such work follows, so the total time is not known
  bool for_all = false;      ///< every process goes on with the results; else the first one alone has them all
  bool is_kept = true;       ///< results are worth a file; else they are computed again after a kill
  /// Each process begins in its own range of blocks, the same in all work with this number of blocks: it keeps data of
  /// its blocks that make them faster the next time.
  bool in_ranges = false;

  /// Fingerprint of everything that the results depend on: equal ones may be mixed.
  std::function<std::uint64_t()> fingerprint{};
  std::function<void(std::size_t block)> compute{};
  /// Appends the results of a block that has been computed.
  std::function<void(std::size_t block, std::vector<std::byte>& bytes)> pack{};
  /// Puts results into their place. @throws WorkError if these are none of this block
  std::function<void(std::size_t block, std::span<const std::byte> bytes)> unpack{};

  std::vector<std::uint8_t> is_there{};  ///< [blocks] whose results are in their place already; empty: none
  /// Called once for every other block when its results are in their place, one call at a time but from any thread.
  std::function<void(std::size_t block)> finished{};
  /// For results that are too large to keep for every block and that may be summed in any order: adds those of a block
  /// to the sum and drops them. Called once for every block that is in its place, one call at a time but from any
  /// thread, when they have been sent or written and nobody asks for them any more. Not with `for_all`.
  std::function<void(std::size_t block)> reduce{};

  bool has(std::size_t block) const { return !is_there.empty() && is_there[block] != 0; }
};

/// Does numbered work: when it returns, the results of all blocks are in their places. What it or the work throws ends
/// the work.
using WorkDriver = std::function<void(const NumberedWork& work)>;

/// In the threads of this process.
void work_in_threads(const NumberedWork& work);

/// With the driver, or in the threads of this process if there is none.
inline void do_work(const WorkDriver& driver, const NumberedWork& work) {
  driver ? driver(work) : work_in_threads(work);
}

/// Numbers as the bytes of results, in native byte order: processes and files stay on one kind of computer.
void pack_numbers(std::span<const double> numbers, std::vector<std::byte>& bytes);

/// Takes numbers off the front of the bytes. @throws WorkError if there are fewer
void unpack_numbers(std::span<const std::byte>& bytes, std::span<double> numbers);

/// @throws WorkError if bytes are left
void require_unpacked(std::span<const std::byte> bytes);

}  // namespace abbe
