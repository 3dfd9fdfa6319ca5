// Part of every fuzz program: all work is done by one thread, so that a finding can be repeated.
#include "abbe/geometry/parallel_blocks.h"

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  abbe::set_default_thread_count(1);
  return 0;
}
