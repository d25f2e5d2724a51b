#include "trajectories.h"

#include "filasofia/metric/hull.h"
#include "filasofia/metric/motion.h"
#include "filasofia/metric/signal.h"

namespace motion_test {

using namespace filasofia;
using namespace filasofia::metric;

TEST_CASE("a minimum-jerk reach has its length, peak speed, mean speed and jerk")
{
    const Session session = sampled(1000, 1.6, minimumJerk(0.2, 1.6));
    CHECK(number("duration", session) == exactly(1.6));
    CHECK(number("path_length", session) == exactly(0.2));
    CHECK(number("speed_mean", session) == exactly(0.2 / 1.6));
    CHECK(number("speed_peak", session) == exactly(1.875 * 0.2 / 1.6));
    CHECK(*measured("speed_peak", session).moment == Approx(0.8));
    CHECK(number("log_dimensionless_jerk", session) == exactly(-std::log(204.8))); // 720 / 1.875^2
    CHECK(number("speed_peaks", session) == 1);
}

TEST_CASE("smoothness does not depend on how long and how far the reach is")
{
    for (const auto& [reach, time] : {std::pair{0.01, 0.5}, {0.3, 4.0}})
        CHECK(number("log_dimensionless_jerk", sampled(1000, time, minimumJerk(reach, time))) ==
              exactly(-std::log(204.8)));
    CHECK(
        number("sparc", sampled(1024, 1.0, minimumJerk(0.1, 1.0))) ==
        Approx(number("sparc", sampled(512, 2.0, minimumJerk(0.4, 2.0)))).epsilon(2e-3)); // the cut-off lies on a grid
    CHECK(number("sparc", sampled(1000, 1.0, minimumJerk(0.1, 1.0))) ==
          Approx(-1.41).margin(0.02)); // Balasubramanian 2015
}

TEST_CASE("a circle has its length, speed, frequency and no idle time")
{
    const double r = 0.03, f = 1.0;
    const auto circle = [=](double t) { return Vec3{r * std::cos(2 * kPi * f * t), r * std::sin(2 * kPi * f * t), 0}; };
    const Session session = sampled(2000, 4.0, circle);
    CHECK(number("path_length", session) == exactly(4.0 * 2 * kPi * r));
    CHECK(number("speed_mean", session) == exactly(2 * kPi * r * f));
    CHECK(number("speed_peak", session) == exactly(2 * kPi * r * f));
    CHECK(number("idle_share", session) == 0.0);
    CHECK(number("idle_longest", session) == 0.0);
    CHECK(number("working_volume", session) == exactly(0.0));
    // The jerk is constantly r w^3: T^3 / (r w)^2 * (r w^3)^2 T.
    CHECK(number("log_dimensionless_jerk", session) == exactly(-4.0 * std::log(2 * kPi * f * 4.0)));
}

TEST_CASE("a sinusoid has a peak in each half period, and rests where it is slow")
{
    const double a = 0.02, w = 2 * kPi * 0.5;
    const Session session = sampled(2000, 10.0, [=](double t) { return Vec3{0, a * (1.0 - std::cos(w * t)), 0}; });
    CHECK(number("speed_peaks", session) == 10);
    CHECK(number("path_length", session) == exactly(10 * 2 * a));
    // |a w sin(w t)| < v
    const double limit = MeasureDef{}.idleSpeed;
    CHECK(number("idle_share", session) == exactly(2.0 / kPi * std::asin(limit / (a * w))));
    CHECK(number("idle_longest", session) == exactly(2.0 / w * std::asin(limit / (a * w))));
    const double middle = *measured("idle_longest", session).moment + std::asin(limit / (a * w)) / w;
    CHECK(std::remainder(middle, 1.0) == Approx(0.0).margin(1e-6));
}

TEST_CASE("95 % of the power lies below the frequency of a sinusoid, or of the faster of two")
{
    const auto wave = [](double amplitude, double hertz, double t) {
        return amplitude / hertz * std::sin(2 * kPi * hertz * t); // its velocity is 2 pi amplitude
    };
    const auto at = [&](double second) {
        Session session = sampled(256, 16.0, [&](double t) {
            return Vec3{wave(0.01, 2.0, t), wave(second, 5.0, t), 0};
        });
        session.tracks[0].samples.pop_back(); // 4096 samples, whole periods
        return number("motion_frequency", session);
    };
    CHECK(at(0.0) == exactly(2.0));
    CHECK(at(0.01 * std::sqrt(0.04 / 0.96)) == exactly(2.0)); // 4 % of the power
    CHECK(at(0.01 * std::sqrt(0.06 / 0.94)) == exactly(5.0)); // 6 %
}

TEST_CASE("the spectral arc length of a bell is that of its spectrum, which is a bell")
{
    const double sigma = 0.1, rate = 512;
    std::vector<double> speeds;
    for (int i = 0; i < 1024; ++i) speeds.push_back(std::exp(-0.5 * std::pow((i / rate - 1.0) / sigma, 2)));
    const double step = rate / (16 * 1024);
    std::vector<double> bell;
    for (int k = 0;; ++k) {
        bell.push_back(std::exp(-2.0 * std::pow(kPi * sigma * step * k, 2)));
        if (bell.back() < 0.05) break;
    }
    bell.pop_back();
    double length = 0.0;
    for (std::size_t k = 1; k < bell.size(); ++k)
        length += std::hypot(1.0 / static_cast<double>(bell.size() - 1), bell[k] - bell[k - 1]);
    CHECK(spectralArcLength(speeds, 1.0 / rate) == exactly(-length));
    // That polygon approximates the curve: the integral of sqrt(1 / fc^2 + (dM/df)^2).
    const double fc = std::sqrt(std::log(20.0) / 2.0) / (kPi * sigma);
    std::vector<double> arc;
    for (int i = 0; i <= 2000; ++i) {
        const double f = fc * i / 2000,
                     slope = 4.0 * std::pow(kPi * sigma, 2) * f * std::exp(-2.0 * std::pow(kPi * sigma * f, 2));
        arc.push_back(std::hypot(1.0 / fc, slope));
    }
    CHECK(length == Approx(integral(arc, fc / 2000)).epsilon(2e-3));
}

TEST_CASE("a second movement makes a session less smooth, in both measures")
{
    const Session one = sampled(500, 2.0, minimumJerk(0.1, 2.0));
    const Session two = sampled(500, 2.0, [](double t) {
        return t < 1.0 ? minimumJerk(0.1, 1.0)(t) : Vec3{0.1, 0, 0} + minimumJerk(0.1, 1.0)(t - 1.0);
    });
    for (const char* id : {"sparc", "log_dimensionless_jerk"}) CHECK(number(id, two) < number(id, one));
    CHECK(number("speed_peaks", two) == 2);
}

TEST_CASE("economy is the ideal path over the path")
{
    Session session = sampled(2000, 1.0, [](double t) {
        return Vec3{0.1 * std::cos(kPi * t), 0.1 * std::sin(kPi * t), 0};
    });
    CHECK(reason("economy", session) == "the case specifies no ideal path");
    session.idealPath = 0.2; // the diameter
    CHECK(number("economy", session) == exactly(2.0 / kPi));
}

TEST_CASE("the depth path is the displacement along the instrument, however it points")
{
    const double depth = 0.01, side = 0.04;
    Session session = sampled(2000, 3.0, [=](double t) { return Vec3{depth * std::sin(2 * kPi * t), side * t, 0}; });
    for (Sample& sample : session.tracks[0].samples)
        sample.pose.orientation = axisAngle({0, 1, 0}, kPi / 2); // -z to -x
    CHECK(number("depth_path", session) == exactly(3 * 4 * depth));
    for (Sample& sample : session.tracks[0].samples) sample.pose.orientation = axisAngle({1, 0, 0}, kPi / 2); // -z to y
    CHECK(number("depth_path", session) == exactly(3 * side));
}

TEST_CASE("the working volume is that of the hull")
{
    // The edges of a box: its corners and thousands of points between them.
    const Vec3 size = {0.1, 0.2, 0.05};
    const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                       {0, 1, 1}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}};
    const auto edges = [&](double t) {
        const auto i = std::min<std::size_t>(6, static_cast<std::size_t>(t));
        const Vec3 p = corners[i] + (t - static_cast<double>(i)) * (corners[i + 1] - corners[i]);
        return Vec3{size.x * p.x, size.y * p.y, size.z * p.z};
    };
    CHECK(number("working_volume", sampled(1000, 7.0, edges)) == exactly(size.x * size.y * size.z));
    CHECK(hullVolume({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) == exactly(1.0 / 6.0));
    CHECK(hullVolume({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) == 0.0);
    CHECK(hullVolume(std::vector<Vec3>(600, Vec3{1, 1, 1})) == 0.0);
    // The hull of a round shape is a little too small, and never too large.
    std::vector<Vec3> ball;
    for (int i = 0; i < 20000; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / 20000, turn = 2.4 * i, r = std::sqrt(1.0 - z * z);
        ball.push_back({r * std::cos(turn), r * std::sin(turn), z});
    }
    CHECK(hullVolume(ball) < 4.0 / 3.0 * kPi);
    CHECK(hullVolume(ball) > 0.97 * 4.0 / 3.0 * kPi);
}

TEST_CASE("two hands whose speeds are waves are correlated by the cosine of their phase")
{
    const auto hands = [](double phase) {
        // Speeds 0.1 + 0.05 sin(w t + phase), integrated.
        const auto path = [](double p) {
            return [p](double t) { return Vec3{0.1 * t - 0.05 / (2 * kPi) * std::cos(2 * kPi * t + p), 0, 0}; };
        };
        Session session = sampled(1000, 6.0, path(0.0));
        session.tracks.push_back(sampled(1000, 6.0, path(phase)).tracks[0]);
        for (Track& track : session.tracks) track.samples.pop_back(); // whole periods
        return number("bimanual_correlation", session);
    };
    for (const double phase : {0.0, 0.7, kPi / 2, kPi}) CHECK(hands(phase) == Approx(std::cos(phase)).margin(1e-6));
    CHECK(reason("bimanual_correlation", sampled(100, 1.0, minimumJerk(0.1, 1.0))) == "only one tool was observed");
}

TEST_CASE("derivatives are exact for polynomials of degree six, to their ends")
{
    const double h = 0.01;
    std::vector<Vec3> values;
    for (int i = 0; i < 20; ++i) values.push_back({std::pow(i * h, 6), std::pow(i * h, 3), 1.0});
    const auto first = derivative(values, h, 1), third = derivative(values, h, 3);
    for (int i = 0; i < 20; ++i) {
        const double t = i * h;
        const auto at = static_cast<std::size_t>(i);
        CHECK(first[at].x == Approx(6 * std::pow(t, 5)).margin(1e-12));
        CHECK(third[at].x == Approx(120 * std::pow(t, 3)).margin(1e-6));
        CHECK(third[at].y == Approx(6.0).margin(1e-6));
        CHECK(first[at].z == 0.0);
    }
    CHECK(integral({0, 1, 8, 27}, 1.0) == exactly(81.0 / 4)); // a cubic: both rules
    CHECK(integral({0, 1, 8, 27, 64}, 1.0) == exactly(64.0));
    CHECK(integral({0, 1, 8, 27, 64, 125}, 1.0) == exactly(625.0 / 4));
}

TEST_CASE("the low pass has the gain of its formula and no delay")
{
    const double h = 1e-3, cutoff = 20.0;
    for (const double f : {1.0, 20.0, 60.0}) {
        std::vector<Vec3> values;
        for (int i = 0; i <= 4000; ++i) values.push_back({std::sin(2 * kPi * f * i * h), 0, 0});
        const std::vector<Vec3> before = values;
        lowPass(values, h, cutoff);
        const double ratio = std::tan(kPi * f * h) / std::tan(kPi * cutoff * h),
                     gain = 1.0 / (1.0 + std::pow(ratio, 4));
        for (std::size_t i = 1500; i <= 2500; ++i) CHECK(values[i].x == Approx(gain * before[i].x).margin(1e-6));
    }
}

TEST_CASE("noise of a device inflates path and speed, and the low pass takes most of it away")
{
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0.0, 2e-5);
    const auto reach = minimumJerk(0.1, 2.0);
    const Session session = sampled(1000, 2.0, [&](double t) {
        return reach(t) + Vec3{noise(random), noise(random), noise(random)};
    });
    CHECK(number("path_length", session, kUnfiltered) > 0.14);
    CHECK(number("path_length", session, {}) == Approx(0.1).epsilon(0.02));
    CHECK(number("speed_peak", session, {}) == Approx(1.875 * 0.05).epsilon(0.03));
}

TEST_CASE("unevenly sampled motion is brought to an even rate")
{
    Session session = sampled(1000, 1.0, minimumJerk(0.2, 1.0));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> late(0.0, 4e-4);
    for (Sample& sample : session.tracks[0].samples) {
        if (sample.time > 0.0 && sample.time < 1.0) sample.time += late(random);
        sample.pose.position = minimumJerk(0.2, 1.0)(sample.time);
    }
    CHECK(number("path_length", session) == exactly(0.2));
    CHECK(number("speed_peak", session) == Approx(0.375).epsilon(1e-5)); // the peak lies between two samples
    CHECK(number("log_dimensionless_jerk", session) == Approx(-std::log(204.8)).epsilon(1e-2));
}

namespace {

/// The hull's volume from every triangle that has all points on one side.
double volumeByTriangles(const std::vector<Vec3>& p)
{
    double volume = 0.0;
    for (std::size_t a = 0; a < p.size(); ++a)
        for (std::size_t b = a + 1; b < p.size(); ++b)
            for (std::size_t c = b + 1; c < p.size(); ++c) {
                const Vec3 normal = cross(p[b] - p[a], p[c] - p[a]);
                int above = 0, below = 0;
                for (std::size_t d = 0; d < p.size(); ++d) {
                    if (d == a || d == b || d == c) continue;
                    (dot(normal, p[d] - p[a]) > 0.0 ? above : below) += 1;
                }
                if (above == 0 || below == 0)
                    volume += std::abs(dot(normal, p[a] - p[0])) / 6.0; // a tetrahedron with a corner of the hull
            }
    return volume;
}

} // namespace

TEST_CASE("the hull of scattered points, and of a nearly straight path, is that of its supporting triangles")
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> side(-1.0, 1.0);
    for (const double noise : {1.0, 1e-2, 1e-4, 1e-6})
        for (int round = 0; round < 5; ++round) {
            std::vector<Vec3> points;
            for (int i = 0; i < 60; ++i) {
                const double t = i / 20.0; // three straight segments
                const Vec3 way = t < 1.0 ? Vec3{t, 0, 0} : t < 2.0 ? Vec3{1, t - 1.0, 0} : Vec3{1, 1, 0.3 * (t - 2.0)};
                points.push_back(way + noise * Vec3{side(random), side(random), side(random)});
            }
            CHECK(hullVolume(points) == exactly(volumeByTriangles(points)));
        }
}

} // namespace motion_test
