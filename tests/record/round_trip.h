#pragma once

#include "filasofia/record/recording.h"
#include "physics/fake_engine.h"
#include "record/runs.h"

#include <bit>

/// Values that a careless format loses, and their round trip through a file.
namespace filasofia::record_test {

using namespace filasofia::physics;

// Numbers that a careless format loses: no short decimal, the smallest, the largest, the sign of zero.
inline const double kThird = 1.0 / 3.0, kTiny = 4.9406564584124654e-324, kLarge = 1.7976931348623157e308,
                    kMinusZero = -0.0;

inline bool sameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
inline bool sameBits(Vec3 a, Vec3 b) { return sameBits(a.x, b.x) && sameBits(a.y, b.y) && sameBits(a.z, b.z); }
inline bool sameBits(Quat a, Quat b)
{
    return sameBits(a.w, b.w) && sameBits(Vec3{a.x, a.y, a.z}, Vec3{b.x, b.y, b.z});
}
inline bool sameBits(const Pose& a, const Pose& b)
{
    return sameBits(a.position, b.position) && sameBits(a.orientation, b.orientation);
}

inline const Vec3 kVec{kThird, kTiny, kMinusZero};
inline const Pose kPose{{kLarge, -kThird, kMinusZero}, {0.1, 0.2, -0.3, kThird}};

template <class Kind> AddBody adding(std::uint32_t id, Kind def)
{
    return {BodyId{id}, std::make_shared<const BodyDef>(std::move(def)), nullptr};
}

inline StepRecord stepWith(Command command)
{
    StepRecord step;
    step.report = {.step = 1, .dt = 1e-3};
    step.commands.push_back(std::move(command));
    return step;
}

/// The step read back from a recording of it.
inline StepRecord roundTrip(const StepRecord& step)
{
    const record::ScratchFile file("round.rec");
    {
        record::RecordingWriter writer(file.path(), {});
        writer.write(step);
    }
    auto steps = record::readRecording(file.path()).steps;
    REQUIRE(steps.size() == 1);
    return std::move(steps[0]);
}

template <class Kind> Kind roundTrip(Kind command)
{
    const StepRecord step = roundTrip(stepWith(std::move(command)));
    REQUIRE(step.commands.size() == 1);
    REQUIRE(std::holds_alternative<Kind>(step.commands[0]));
    return std::move(const_cast<Kind&>(std::get<Kind>(step.commands[0])));
}

inline SoftBodyDef roundTrip(const SoftBodyDef& def)
{
    const AddBody add = roundTrip(adding(4, def));
    CHECK(add.id == BodyId{4});
    return std::get<SoftBodyDef>(*add.def);
}

inline RigidBodyDef roundTrip(const RigidBodyDef& def)
{
    return std::get<RigidBodyDef>(*roundTrip(adding(4, def)).def);
}

} // namespace filasofia::record_test
