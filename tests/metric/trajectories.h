#pragma once

#include "filasofia/metric/catalog.h"

#include <functional>
#include <numbers>

namespace filasofia::metric {

inline constexpr double kPi = std::numbers::pi;

/// As sampled, because closed forms include no filter and no mean.
inline constexpr MeasureDef kUnfiltered = {.lowPass = 0.0, .forceWindow = 0.0};

/// Samples of a path at rate [Hz] from 0 to `end` [s].
inline Session sampled(double rate, double end, const std::function<Vec3(double)>& path,
                       const std::function<Vec3(double)>& force = {})
{
    Session session;
    session.tracks.push_back({.name = "tool", .force = static_cast<bool>(force)});
    const auto count = static_cast<int>(std::lround(end * rate));
    for (int i = 0; i <= count; ++i) {
        const double time = i / rate;
        const Vec3 push = force ? force(time) : Vec3{};
        session.tracks[0].samples.push_back(
            {.time = time, .pose = {path(time), {}}, .force = push, .contacts = length(push) > 0.0 ? 1 : 0});
    }
    return session;
}

inline std::size_t indexOf(std::string_view id)
{
    for (std::size_t i = 0; i < catalog().size(); ++i)
        if (catalog()[i].id == id) return i;
    FAIL("there is no metric " << id);
    return 0;
}

inline Value measured(std::string_view id, const Session& session, const MeasureDef& def = kUnfiltered)
{
    return measure(session, def)[indexOf(id)];
}

inline double number(std::string_view id, const Session& session, const MeasureDef& def = kUnfiltered)
{
    const Value value = measured(id, session, def);
    INFO(id << ": " << value.reason);
    REQUIRE(value.value);
    return *value.value;
}

inline std::string reason(std::string_view id, const Session& session)
{
    const Value value = measured(id, session);
    CHECK_FALSE(value.value);
    return value.reason;
}

/// Within 1e-6 of the value.
inline Approx exactly(double value) { return Approx(value).epsilon(1e-6).margin(1e-9); }

/// A straight reach of `reach` [m] in `time` [s] with minimum jerk (Flash and Hogan 1985).
inline std::function<Vec3(double)> minimumJerk(double reach, double time)
{
    return [=](double t) {
        const double s = t / time;
        return Vec3{reach * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 0, 0};
    };
}

} // namespace filasofia::metric
