#pragma once

#include <cstddef>
#include <functional>

namespace abbe {

/// Number of threads used where the caller gives 0: the machine's, at most 64.
int default_thread_count();

/// Sets that number for the whole process. @param threads  0: the machine's again
void set_default_thread_count(int threads);

/// Runs work(block) for block = 0 .. blocks - 1 on several threads; returns when all are done.
///
/// Which thread runs a block is not fixed: write results per block and reduce them in block order, so that they do not
/// depend on the number of threads. An exception in one block is rethrown here after the others have stopped.
/// @param threads  0: default_thread_count()
void for_each_block(std::size_t blocks, int threads, const std::function<void(std::size_t)>& work);

}  // namespace abbe
