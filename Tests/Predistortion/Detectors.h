// SPDX-License-Identifier: GPL-3.0-or-later
// Detectors of what an audio thread must not do: allocate, lock, call the system. They replace functions of the C
// library, so one source of a program includes this, and none where a sanitizer has brought its own.
#pragma once

#include <catch2/catch.hpp>

#include <dlfcn.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>

namespace {

thread_local bool watching = false;
thread_local int allocations = 0, locks = 0;

void count(int& counter)
{
    if (watching)
        ++counter;
}

}  // namespace

// glibc lets a program bring its own malloc; these count and pass on.
extern "C" {
void* __libc_malloc(std::size_t);
void __libc_free(void*);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size)
{
    count(allocations);
    return __libc_malloc(size);
}
void free(void* place)
{
    count(allocations);
    __libc_free(place);
}
void* calloc(std::size_t number, std::size_t size)
{
    count(allocations);
    return __libc_calloc(number, size);
}
void* realloc(void* place, std::size_t size)
{
    count(allocations);
    return __libc_realloc(place, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size)
{
    count(allocations);
    return __libc_memalign(alignment, size);
}

int pthread_mutex_lock(pthread_mutex_t* mutex)
{
    count(locks);
    using Lock = int (*)(pthread_mutex_t*);
    static const auto next = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
    return next(mutex);
}
}

namespace {

struct Counts {
    int allocations, locks;
};

template <class Work>
Counts countIn(const Work& work)
{
    allocations = locks = 0;
    watching = true;
    work();
    watching = false;
    return {allocations, locks};
}

/// Whether the work makes a system call: a child process does it, to which the kernel allows none but write and exit.
/// @returns false as well where the kernel has no such mode
template <class Work>
bool callsSystem(const Work& work)
{
    const pid_t child = fork();
    if (child == 0) {
        if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0)
            _exit(2);
        work();
        syscall(SYS_exit, 0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 2) {
        WARN("The kernel does not watch system calls here; that none is made is not shown.");
        return false;
    }
    return !(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

bool canWatchSystemCalls()
{
    return callsSystem([] { static_cast<void>(syscall(SYS_getppid)); });
}

}  // namespace
