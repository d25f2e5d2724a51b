#include "trajectories.h"

namespace force_test {

using namespace filasofia;
using namespace filasofia::metric;

namespace {

Vec3 still(double) { return {}; }

/// Pushes of half a sine wave, `peak` [N] high and 1 s long, with a pause of 1 s after each.
Session pushes(std::vector<double> peaks, double rate = 2000)
{
    return sampled(rate, 2.0 * static_cast<double>(peaks.size()), still, [=](double t) {
        const auto i = static_cast<std::size_t>(t / 2.0);
        const double within = t - 2.0 * static_cast<double>(i);
        if (i >= peaks.size() || within <= 0.0 || within > 1.0) return Vec3{};
        return Vec3{0, 0.6 * peaks[i] * std::sin(kPi * within), 0.8 * peaks[i] * std::sin(kPi * within)};
    });
}

} // namespace

TEST_CASE("a half-sine push has its peak, mean, root mean square and impulse")
{
    const Session session = pushes({3.0});
    CHECK(number("force_max", session) == exactly(3.0));
    CHECK(*measured("force_max", session).moment == exactly(0.5));
    CHECK(number("force_mean", session) == exactly(3.0 * 2.0 / kPi));
    CHECK(number("force_rms", session) == exactly(3.0 / std::sqrt(2.0)));
    CHECK(number("force_impulse", session) == exactly(3.0 * 2.0 / kPi));
}

TEST_CASE("the time above a limit is that of the wave, and each rise counts once")
{
    Session session = pushes({2.0, 0.5, 4.0});
    CHECK(reason("force_over_time", session) == "the case specifies no force limit of the tissue");
    session.forceLimit = 1.0;
    // For a half-sine of peak p: 1 - 2 asin(1 / p) / pi.
    CHECK(number("force_over_time", session) == exactly(2.0 / 3.0 + 1.0 - 2.0 * std::asin(0.25) / kPi));
    CHECK(number("force_over_count", session) == 2);
    CHECK(*measured("force_over_time", session).moment == Approx(1.0 / 6.0).epsilon(1e-5));
    session.forceLimit = 4.5;
    CHECK(number("force_over_time", session) == 0.0);
    CHECK_FALSE(measured("force_over_count", session).moment);
}

TEST_CASE("the largest force and the time above the limit are of every instrument, the mean is the tool's")
{
    Session session = pushes({2.0, 0.5});
    Session scope = pushes({0.5, 6.0}), other = pushes({9.0, 9.0});
    scope.tracks[0].role = Role::Scope;
    other.tracks[0].role = Role::Other;
    session.tracks.push_back(scope.tracks[0]);
    session.tracks.push_back(other.tracks[0]);
    session.forceLimit = 1.0;
    CHECK(number("force_max", session) == exactly(6.0));
    CHECK(*measured("force_max", session).moment == exactly(2.5));
    CHECK(number("force_over_time", session) == exactly(2.0 / 3.0 + 1.0 - 2.0 * std::asin(1.0 / 6.0) / kPi));
    CHECK(number("force_over_count", session) == 2);
    CHECK(number("force_impulse", session) == exactly(2.5 * 2.0 / kPi));
    // If both are above it at the same time, that counts once.
    Session both = pushes({2.0});
    both.tracks.push_back(pushes({4.0}).tracks[0]);
    both.forceLimit = 1.0;
    CHECK(number("force_over_time", both) == exactly(1.0 - 2.0 * std::asin(0.25) / kPi));
    CHECK(number("force_over_count", both) == 1);
}

TEST_CASE("contacts are counted, timed and described by their peaks")
{
    const Session session = pushes({2.0, 1.0, 6.0});
    CHECK(number("contact_count", session) == 3);
    CHECK(number("contact_time", session) == exactly(3.0));
    CHECK(number("contact_longest", session) == exactly(1.0));
    CHECK(number("contact_peak_mean", session) == exactly(3.0));
    CHECK(*measured("contact_count", session).moment == exactly(0.0));
}

TEST_CASE("a momentary release does not end a contact")
{
    const auto touching = [](double pause) {
        return sampled(1000, 1.0, still, [=](double t) { return Vec3{0, t > 0.4 && t < 0.4 + pause ? 0.0 : 1.0, 0}; });
    };
    CHECK(number("contact_count", touching(0.03)) == 1);
    CHECK(number("contact_count", touching(0.10)) == 2);
    CHECK(number("contact_time", touching(0.10)) == Approx(0.9).margin(2e-3));
}

TEST_CASE("a session that touches nothing has zeros, and no mean of nothing")
{
    const Session session = sampled(200, 1.0, minimumJerk(0.1, 1.0), [](double) { return Vec3{}; });
    CHECK(number("force_max", session) == 0.0);
    CHECK_FALSE(measured("force_max", session).moment);
    CHECK(number("force_impulse", session) == 0.0);
    CHECK(number("contact_count", session) == 0.0);
    for (const char* id : {"force_mean", "force_rms", "contact_peak_mean"})
        CHECK(reason(id, session) == "the tool touched nothing");
}

TEST_CASE("without observed forces there are no force metrics")
{
    const Session session = sampled(200, 1.0, minimumJerk(0.1, 1.0));
    for (const char* id : {"force_max", "force_mean", "force_impulse", "contact_count", "contact_time"})
        CHECK(reason(id, session) == "forces were not observed");
}

TEST_CASE("a hit of one step counts as its mean over 5 ms, whatever the step was")
{
    for (const double rate : {1000.0, 2000.0}) {
        const auto hit = [=](double t) { return Vec3{0, std::abs(t - 0.5) < 0.4 / rate ? 0.01 * rate : 0.0, 0}; };
        Session session = sampled(rate, 1.0, still, hit); // 0.01 N s
        session.forceLimit = 3.0;
        CHECK(number("force_max", session, {}) == exactly(0.01 / 5e-3));
        CHECK(number("contact_peak_mean", session, {}) == exactly(0.01 / 5e-3));
        CHECK(measured("force_over_count", session, MeasureDef{}).value == 0.0);
        CHECK(number("force_over_count", session) == 1); // without the mean
    }
    // If sampled every 5 ms or slower, it changes nothing.
    const Session slow = pushes({3.0}, 200);
    CHECK(number("force_max", slow, {}) == exactly(3.0));
}

} // namespace force_test
