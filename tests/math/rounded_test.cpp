#include "filasofia/core/text.h"
#include "filasofia/math/rounded.h"

namespace rounded_test {

using namespace filasofia;

TEST_CASE("a bound that a message advises has four digits and is no larger than the bound, but for rounding")
{
    CHECK(text(advised(88260254.59688818)) == "88260000");
    CHECK(text(advised(999.9999999999922)) == "1000");
    CHECK(text(advised(999.99)) == "999.9");
    CHECK(text(advised(0.0123456)) == "0.01234");
    CHECK(text(advised(7.0 / 3.0)) == "2.333");
    CHECK(text(advised(1.0)) == "1");
    CHECK(text(advised(9999.5)) == "9999");
    CHECK(text(advised(1.23456e-7)) == "1.234e-07");
    for (double value = 1e-9; value < 1e12; value *= 1.7) {
        CHECK(advised(value) <= (1.0 + 2e-9) * value);
        CHECK(advised(value) >= 0.999 * value);
    }
}

} // namespace rounded_test
