// Every operator new and delete of this program, counted. In a file of its own, so that no compiler
// sees through them.

#include "support/allocations.hpp"

#include <cstdlib>
#include <new>

#if SKYBARK_TEST_COUNTS_ALLOCATIONS

void* operator new(std::size_t size) {
    ++skybark::support::allocations;
    if (void* memory = std::malloc(size == 0 ? 1 : size)) {
        return memory;
    }
    throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return ::operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

#endif
