#include "trajectories.h"

#include "filasofia/core/text.h"

#include <fstream>
#include <set>

namespace catalog_test {

using namespace filasofia;
using namespace filasofia::metric;

TEST_CASE("every metric has a definition, a unit, a source and its evidence, and a name of its own")
{
    std::set<std::string_view> ids, names;
    for (const MetricInfo& info : catalog()) {
        INFO(info.id);
        CHECK(ids.insert(info.id).second);
        CHECK(names.insert(info.name).second);
        CHECK(info.definition.ends_with('.'));
        CHECK_FALSE(info.unit.empty());
        CHECK_FALSE(info.source.empty());
        CHECK_FALSE(info.found.empty());
        CHECK(info.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string_view::npos);
    }
}

TEST_CASE("docs/guide/metrics.md has the list of the code (filasofia report --definitions writes it)")
{
    std::ifstream file(FILASOFIA_SOURCE_DIR "/docs/guide/metrics.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    CHECK(page.find(catalogMarkdown()) != std::string::npos);
}

TEST_CASE("definitions state the thresholds that are used")
{
    const MeasureDef def;
    const auto tells = [](std::string_view id, const std::string& words) {
        CHECK(catalog()[indexOf(id)].definition.find(words) != std::string_view::npos);
    };
    tells("idle_share", text(1e3 * def.idleSpeed, " mm/s"));
    tells("idle_longest", text(1e3 * def.idleSpeed, " mm/s"));
    tells("contact_count", text(def.contactPause, " s"));
    tells("lens_contact", text(1e3 * def.lensReach, " mm"));
    for (const char* id : {"force_max", "force_over_time", "contact_peak_mean"})
        tells(id, text(1e3 * def.forceWindow, " ms"));
    CHECK(def.peakShare == 0.1); // "a tenth of the peak speed"
}

TEST_CASE("a number is compared with those of others")
{
    const std::vector<double> others = {2, 4, 4, 4, 5, 5, 7, 9};
    const Comparison comparison = compare({.value = 9.0}, others);
    CHECK(comparison.others == 8);
    CHECK(comparison.mean == exactly(5.0));
    CHECK(comparison.deviation == exactly(std::sqrt(32.0 / 7.0)));
    CHECK(*comparison.z == exactly(4.0 / std::sqrt(32.0 / 7.0)));
}

TEST_CASE("few others, others all alike, or no number: no z, and a reason")
{
    CHECK(compare({.value = 1.0}, std::vector{1.0, 2.0}).reason == "needs 3 other sessions, got 2");
    CHECK(compare({.value = 1.0}, {}).reason == "needs 3 other sessions, got 0");
    CHECK(compare({.value = 1.0}, std::vector{2.0, 2.0, 2.0}).reason == "all other sessions have the same number");
    CHECK(compare({.reason = "no tool"}, std::vector{1.0, 2.0, 3.0}).reason == "no tool");
    CHECK_FALSE(compare({.reason = "no tool"}, std::vector{1.0, 2.0, 3.0}).z);
}

} // namespace catalog_test
