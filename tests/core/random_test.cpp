#include "filasofia/core/random.h"

#include <catch2/catch.hpp>

#include <algorithm>

namespace random_test {

using filasofia::Random;

TEST_CASE("random numbers are those of the 64-bit Mersenne twister, in their order")
{
    // The standard fixes the 10,000th number of a twister of seed 5489: 9981545732273789042, which is 42 modulo 1,000.
    Random ten(5489), thousand(5489);
    for (int i = 1; i < 10000; ++i) {
        ten.below(10);
        thousand.between(0.0, 1.0);
    }
    CHECK(ten.below(1000) == 42);
    CHECK(thousand.between(0.0, 1.0) == Approx(static_cast<double>(9981545732273789042ULL % 1001) / 1000.0));
}

TEST_CASE("a random number lies in its range, and both ends are reached")
{
    Random random(1);
    double low = 1e9, high = -1e9;
    int ones = 0;
    for (int i = 0; i < 20000; ++i) {
        const double each = random.between(-2.0, 3.0);
        low = std::min(low, each);
        high = std::max(high, each);
        ones += random.onceIn(4) ? 1 : 0;
    }
    CHECK(low == -2.0);
    CHECK(high == 3.0);
    CHECK(ones == Approx(5000).margin(300)); // five standard deviations
}

TEST_CASE("of one thing the first is chosen, and a seed decides")
{
    Random one(7), two(7), other(8);
    int same = 0;
    for (int i = 0; i < 100; ++i) {
        CHECK(one.below(1) == 0);
        CHECK(two.below(1) == 0);
        other.below(1);
        const int a = one.below(1000);
        CHECK(a == two.below(1000));
        same += a == other.below(1000) ? 1 : 0;
    }
    CHECK(same < 5);
}

} // namespace random_test
