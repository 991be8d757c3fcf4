// SPDX-License-Identifier: GPL-3.0-or-later
// No allocation, no lock and no system call where audio runs. The sanitizers bring allocators and locks of their own.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include "Linearization/Drivers.h"

#include "Engine/Linearization/Crossfade.h"
#include "Engine/Linearization/Predistorter.h"
#include "Engine/Linearization/Speaker.h"

#include <catch2/catch.hpp>

#include <dlfcn.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <mutex>

using namespace excursion;

namespace {

thread_local bool watching = false;
thread_local int allocations = 0, locks = 0;

void count(int& counter)
{
    if (watching)
        ++counter;
}

} // namespace

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

/// Everything that an audio thread does: blocks of all sizes, controls, a fault, a model handed over and its predecessor back.
struct AudioThread {
    explicit AudioThread(int oversampling) : bend(1000), play(everything(), {48000.0, oversampling})
    {
        bend.start(std::make_unique<Predistorter>(everything(), RealTimeOptions {48000.0, oversampling}));
        bend.offer(std::make_unique<Predistorter>(midbass(), RealTimeOptions {48000.0, oversampling}));
        u = noise(8192, 6.0);
    }
    void run()
    {
        for (const std::size_t n : {std::size_t {0}, std::size_t {1}, std::size_t {64}, std::size_t {1000}, std::size_t {8192}}) {
            bend.each([](Predistorter& engine) { engine.set({0.5, 3e-3, 10.0}); });
            bend.process(u.data(), u.data(), n);
            play.process(u.data(), u.data(), n);
            u[17] = std::numeric_limits<double>::quiet_NaN();
        }
        bend.current()->reset();
        play.reset();
    }
    Crossfade<Predistorter> bend;
    Speaker play;
    std::vector<double> u;
};

} // namespace

TEST_CASE("The detectors detect", "[realtime]")
{
    std::unique_ptr<int> kept;
    CHECK(countIn([&] { kept = std::make_unique<int>(3); }).allocations == 1);
    CHECK(countIn([&] { kept.reset(); }).allocations == 1);
    void* volatile place = nullptr;
    CHECK(countIn([&] { place = std::malloc(100); }).allocations == 1);
    CHECK(countIn([&] { place = std::realloc(place, 200); }).allocations == 1);
    std::free(place);
    std::mutex mutex;
    CHECK(countIn([&] { const std::lock_guard guard(mutex); }).locks == 1);
    CHECK(countIn([] {}).allocations == 0);
    if (canWatchSystemCalls())
        CHECK_FALSE(callsSystem([] {}));
}

TEST_CASE("Nothing in process allocates, locks or calls the system", "[realtime]")
{
    for (const int oversampling : {1, 2, 4}) {
        INFO(oversampling);
        AudioThread thread(oversampling);
        const auto counts = countIn([&] { thread.run(); });
        CHECK(counts.allocations == 0);
        CHECK(counts.locks == 0);
        CHECK(thread.bend.collect() == 1);
        if (canWatchSystemCalls()) {
            AudioThread other(oversampling);
            CHECK_FALSE(callsSystem([&] { other.run(); }));
        }
    }
}

#endif
