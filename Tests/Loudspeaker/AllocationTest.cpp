// SPDX-License-Identifier: GPL-3.0-or-later
// The sanitizers bring allocators of their own, which must not be replaced.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include "Loudspeaker/EffectBench.h"

#include "Engine/Loudspeaker/Dynamics.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <memory>
#include <new>

using namespace excursion;

namespace {

thread_local bool watching = false;
thread_local int allocations = 0;

void* counted(std::size_t size)
{
    if (watching)
        ++allocations;
    if (void* place = std::malloc(size ? size : 1))
        return place;
    throw std::bad_alloc();
}

template <class Work>
int allocationsIn(const Work& work)
{
    allocations = 0;
    watching = true;
    work();
    watching = false;
    return allocations;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* place) noexcept { std::free(place); }
void operator delete[](void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t) noexcept { std::free(place); }

TEST_CASE("The detector of allocations detects one", "[effects]")
{
    std::unique_ptr<int> kept;
    CHECK(allocationsIn([&kept] { kept = std::make_unique<int>(3); }) == 1);
}

TEST_CASE("No effect allocates when it is asked", "[effects]")
{
    auto model = makeModel("electrodynamic");
    for (const auto* effect : catalogue())
        model = withEffect(model, *effect, someOperatingRange(1.0));
    const auto theta = parameterVector(model);
    const Dynamics<double> dynamics(model, {theta.begin(), theta.end()});
    const std::vector<double> state(static_cast<std::size_t>(dynamics.order()), 1e-3);
    std::vector<double> rates(state.size());
    CHECK(allocationsIn([&] {
              for (int n = 0; n < 100; ++n)
                  dynamics.rates(state.data(), 1.0, rates.data());
          })
          == 0);
    CHECK(rates[0] != 0.0);
}

#endif
