/* Counts heap allocations of a process, when preloaded; glibc only. */
#include <errno.h>
#include <stddef.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static _Atomic long count;

long allocation_count(void) { return count; }

void* malloc(size_t size) { return ++count, __libc_malloc(size); }
void* calloc(size_t n, size_t size) { return ++count, __libc_calloc(n, size); }
void* realloc(void* old, size_t size) { return ++count, __libc_realloc(old, size); }
void* memalign(size_t align, size_t size) { return ++count, __libc_memalign(align, size); }
void* aligned_alloc(size_t align, size_t size) { return ++count, __libc_memalign(align, size); }
int posix_memalign(void** out, size_t align, size_t size) {
    *out = (++count, __libc_memalign(align, size));
    return *out ? 0 : ENOMEM;
}
