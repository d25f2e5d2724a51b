#include "trajectories.h"

#include "filasofia/metric/motion.h"

#include <limits>

namespace gaps_test {

using namespace filasofia;
using namespace filasofia::metric;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Every value must be a finite number, or absent with a reason.
void checkHonest(const Session& session)
{
    const std::vector<Value> values = measure(session);
    REQUIRE(values.size() == catalog().size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        INFO(catalog()[i].id);
        if (values[i].value) CHECK(std::isfinite(*values[i].value));
        CHECK(values[i].reason.empty() == values[i].value.has_value());
        if (values[i].moment) CHECK(std::isfinite(*values[i].moment));
    }
}

} // namespace

TEST_CASE("without a track, without samples, with few of them: no number, and a reason")
{
    checkHonest({});
    CHECK(reason("path_length", {}) == "no tool was observed");
    for (int count = 0; count < 9; ++count) {
        Session session = sampled(100, 1.0, minimumJerk(0.1, 1.0), [](double t) { return Vec3{t, 0, 0}; });
        session.tracks[0].samples.resize(static_cast<std::size_t>(count));
        checkHonest(session);
        CHECK(measured("path_length", session).value.has_value() == (count >= kMinSamples));
        CHECK(measured("duration", session).value.has_value() == (count >= 2));
    }
}

TEST_CASE("samples that are not finite are ignored")
{
    Session session = sampled(1000, 1.0, minimumJerk(0.2, 1.0), [](double) { return Vec3{1, 0, 0}; });
    for (std::size_t i = 100; i < 900; i += 50) {
        session.tracks[0].samples[i].pose.position.x = kNan;
        session.tracks[0].samples[i + 7].force.y = kNan;
        session.tracks[0].samples[i + 11].time = kNan;
    }
    checkHonest(session);
    CHECK(number("path_length", session) == exactly(0.2));
    CHECK(number("force_max", session) == 1.0);
    CHECK(number("duration", session) == exactly(1.0));
}

TEST_CASE("gaps add nothing, and metrics that need the whole session are absent")
{
    Session session = sampled(
        1000, 4.0,
        [](double t) {
            return Vec3{0.05 * t, 0, 0};
        },
        [](double) {
            return Vec3{2, 0, 0};
        });
    auto& samples = session.tracks[0].samples;
    samples.erase(samples.begin() + 1001, samples.begin() + 3000); // from 1 s to 3 s
    CHECK(motionsOf(session.tracks[0], kUnfiltered).size() == 2);
    checkHonest(session);
    CHECK(number("duration", session) == exactly(4.0));
    CHECK(number("path_length", session) == exactly(0.1));
    CHECK(number("speed_mean", session) == exactly(0.05));
    CHECK(number("force_impulse", session) == exactly(4.0));
    for (const char* id : {"sparc", "log_dimensionless_jerk", "motion_frequency"})
        CHECK(reason(id, session) == "too many gaps: the longest stretch without a gap is 1 s of 4 s");
}

TEST_CASE("samples whose time does not increase are left out")
{
    Session session = sampled(1000, 1.0, minimumJerk(0.2, 1.0));
    auto& samples = session.tracks[0].samples;
    samples.insert(samples.begin() + 500, samples.begin() + 200, samples.begin() + 300);
    checkHonest(session);
    CHECK(number("path_length", session) == exactly(0.2));
}

TEST_CASE("a tool at rest is at rest, and has no smoothness")
{
    const Session session = sampled(200, 2.0, [](double) { return Vec3{0.1, 0.2, 0.3}; });
    checkHonest(session);
    CHECK(number("idle_share", session) == 1.0);
    CHECK(number("idle_longest", session) == exactly(2.0));
    CHECK(number("path_length", session) == 0.0);
    for (const char* id : {"sparc", "log_dimensionless_jerk", "motion_frequency", "speed_peaks"})
        CHECK(reason(id, session) == "the tool did not move");
}

TEST_CASE("places too large to square give no infinity")
{
    checkHonest(sampled(
        100, 1.0,
        [](double t) {
            return Vec3{1e300 * std::sin(20 * t), 0, 0};
        },
        [](double) {
            return Vec3{1e300, 1e300, 0};
        }));
}

TEST_CASE("sampled too slowly there is no motion")
{
    const Session session = sampled(5, 10.0, minimumJerk(0.1, 10.0));
    checkHonest(session);
    CHECK(reason("path_length", session) == "needs 7 consecutive samples with a position, at most 0.1 s apart");
    CHECK(reason("sparc", sampled(15, 10.0, minimumJerk(0.1, 10.0))) == "needs at least 20 samples per second");
}

TEST_CASE("the parameters of the measures are checked")
{
    CHECK_THROWS_WITH(measure({}, {.lowPass = -1}), "measure: lowPass must be in [0, 1000] Hz, got -1");
    CHECK_THROWS_WITH(measure({}, {.maximumGap = 0}), "measure: maximumGap must be > 0 s, got 0");
}

TEST_CASE("a jump of the tool is not motion")
{
    const auto path = [](double t) { return Vec3{0.05 * t + (t > 2.0 ? 0.3 : 0.0), 0, 0}; };
    Session session = sampled(1000, 4.0, path);
    for (Sample& sample : session.tracks[0].samples) sample.pose.orientation = axisAngle({0, 1, 0}, kPi / 2);
    checkHonest(session);
    CHECK(motionsOf(session.tracks[0], kUnfiltered).size() == 2);
    CHECK(number("path_length", session) == exactly(0.05 * 3.999)); // the displacement of the jump is unknown
    CHECK(number("depth_path", session) == exactly(0.05 * 3.999));
    CHECK(number("speed_peak", session) == exactly(0.05));
}

} // namespace gaps_test
