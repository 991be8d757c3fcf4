// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/PreparedTake.h"

#include "Check/SoundTake.h"
#include "Engine/Error.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("the record of a take is cut once, whoever asks", "[record]")
{
    const PreparedTake take(soundTake());
    const PreparedTake copy = take;
    CHECK(&take.record() == &copy.record());
    CHECK(take.record().sections.size()
          == soundTake().excitation->levels.size() * static_cast<std::size_t>(soundTake().excitation->realizations));
}

TEST_CASE("a prepared take has the lines that its maker did not name", "[record]")
{
    auto unnamed = soundTake();
    unnamed.excitation->lines.clear();
    CHECK(PreparedTake(unnamed).record().sections.front().excited == soundTake().excitation->lines);
}

TEST_CASE("a frequency response has no record, and refuses each time it is asked for one", "[record]")
{
    const PreparedTake take {Spectra {}};
    CHECK_THROWS_AS(take.record(), Error);
    CHECK_THROWS_AS(take.record(), Error);
}
