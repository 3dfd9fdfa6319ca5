#include "abbe/runtime/allocations_for_test.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> counted{0};

void* counted_memory(std::size_t size) {
  ++counted;
  return std::malloc(size == 0 ? 1 : size);
}

}  // namespace

// All forms together: memory of one must not come back to another's owner, such as the address sanitizer.
void* operator new(std::size_t size) {
  if (void* const memory = counted_memory(size)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept { return counted_memory(size); }
void* operator new[](std::size_t size, const std::nothrow_t& /*tag*/) noexcept { return counted_memory(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t& /*tag*/) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t& /*tag*/) noexcept { std::free(memory); }

long abbe::test::allocations() { return counted; }
