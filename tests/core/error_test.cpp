#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/units.h"

namespace error_test {

using namespace filasofia;

TEST_CASE("an error reads as one line, numbers in their shortest exact form")
{
    CHECK(text(1e5, " ", -100000.0, " ", 1e12, " ", 0.5f) == "100000 -100000 1e+12 0.5");
    CHECK(text("a ", 1, ' ', 0.1, " ", 6_kPa, " ", true) == "a 1 0.1 6000 true");
    CHECK_THROWS_WITH(fail("body 'x': density must be > 0 kg/m^3, got ", -1.5),
                      "body 'x': density must be > 0 kg/m^3, got -1.5");
}

TEST_CASE("an error and a log line stay one line, whatever a user named their objects")
{
    CHECK_THROWS_WITH(fail("body 'a\nb\033[31m': no"), "body 'a b [31m': no");
    std::string logged;
    setLogSink([&](LogLevel, std::string_view line) { logged = line; });
    logError("one\ntwo");
    setLogSink({});
    CHECK(logged == "one two");
}

TEST_CASE("a unit literal is its value in SI")
{
    CHECK(6_kPa == 6000.0);
    CHECK(0.5_mm == 0.0005);
    CHECK(180_deg == std::numbers::pi);
    CHECK(200_Hz == 200.0);
}

TEST_CASE("log lines go to the sink that was set")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel level, std::string_view line) {
        lines.push_back((level == LogLevel::Warning ? "warning " : "other ") + std::string(line));
    });
    logWarning("two and two are ", 4);
    setLogSink({});
    CHECK(lines == std::vector<std::string>{"warning two and two are 4"});
}

} // namespace error_test
