#include "filasofia/scene/quantity.h"

#include "filasofia/core/units.h"

#include <catch2/catch.hpp>

namespace filasofia::scene {
namespace {

double valueOf(const std::string& text, const std::string& unit)
{
    const auto quantity = parseQuantity(text);
    REQUIRE(quantity);
    REQUIRE(quantity->values.size() == 1);
    const auto scale = convert(quantity->unit, unit);
    REQUIRE(scale);
    return quantity->values[0] * scale->factor / scale->divisor;
}

} // namespace

TEST_CASE("quantities: a text has the bits of the literal of C++")
{
    CHECK(valueOf("10 kPa", "Pa") == 10_kPa);
    CHECK(valueOf("0.7mm", "m") == 0.7_mm);
    CHECK(valueOf(" 3 cm ", "m") == 3_cm);
    CHECK(valueOf("250 um", "m") == 250_um);
    CHECK(valueOf("30 deg", "rad") == 30_deg);
    CHECK(valueOf("-20 deg", "rad") == -20_deg);
    CHECK(valueOf("30 deg/s", "rad/s or m/s") == 30_deg);
    CHECK(valueOf("2 ms", "s") == 2_ms);
    CHECK(valueOf("1.5 kHz", "Hz") == 1.5_kHz);
    CHECK(valueOf("3 mN", "N") == 3_mN);
    CHECK(valueOf("20 g", "kg") == 20_g);
    CHECK(valueOf("7 MPa", "Pa") == 7_MPa);
    CHECK(valueOf("1060 kg/m^3", "kg/m^3") == 1060.0);
    CHECK(valueOf("20 1/s", "1/s") == 20.0);
}

TEST_CASE("quantities: units that are made of others are converted")
{
    CHECK(valueOf("1.06 g/ml", "kg/m^3") == Approx(1060.0));
    CHECK(valueOf("12 mmHg", "Pa") == Approx(1599.9).epsilon(1e-4));
    CHECK(valueOf("10 cmH2O", "Pa") == Approx(980.665));
    CHECK(valueOf("0.5 N/mm", "N/m") == Approx(500.0));
    CHECK(valueOf("3 N mm", "N m or N") == Approx(0.003));
    CHECK(valueOf("3 mN", "N m or N") == Approx(0.003));
    CHECK(valueOf("5 kg m^2 s^-2", "J") == Approx(5.0));
    CHECK(valueOf("40 %", "-") == Approx(0.4));
    CHECK(valueOf("2 min", "s") == Approx(120.0));
}

TEST_CASE("quantities: what measures something else, or is no unit, is not converted")
{
    for (const auto& [from, to] : {std::pair("kPa", "m"),
                                   {"mm", "-"},
                                   {"N", "N m"},
                                   {"N m", "N m/rad"},
                                   {"", "m"},
                                   {"m/", "m"},
                                   {"m//s", "m/s"},
                                   {"m/s/s", "m/s^2"},
                                   {"m^", "m"},
                                   {"m^0", "m"},
                                   {"m^99", "m"},
                                   {"kkm", "m"},
                                   {"kdeg", "rad"},
                                   {"furlong", "m"},
                                   {"mm", ""},
                                   {"m", "EV at ISO 100"}})
        CHECK_FALSE(convert(from, to));
    for (const char* text : {"", "  ", "mm", "ten mm", "inf", "nan mm", "1e999 m", "-"})
        CHECK_FALSE(parseQuantity(text));
}

TEST_CASE("quantities: several numbers may share a unit")
{
    const auto size = parseQuantity("60  -30.5 6e1 mm");
    REQUIRE(size);
    CHECK(size->values == std::vector{60.0, -30.5, 60.0});
    CHECK(size->unit == "mm");
    CHECK(parseQuantity("1 2 3")->unit.empty());
}

} // namespace filasofia::scene
