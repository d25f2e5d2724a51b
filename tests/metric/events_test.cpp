#include "trajectories.h"

namespace events_test {

using namespace filasofia;
using namespace filasofia::metric;

namespace {

Session withEvents(std::vector<Event> events)
{
    Session session = sampled(100, 10.0, minimumJerk(0.1, 10.0));
    session.watched = {EventKind::Tear, EventKind::Cut, EventKind::Perforation, EventKind::Removed, EventKind::Mistake};
    session.targets = {"polyp"};
    session.events = std::move(events);
    return session;
}

/// A scope at the origin that looks along -z and rolls about it, and a tool in front of it.
Session scoped(const std::function<double(double)>& roll, const std::function<Vec3(double)>& tool)
{
    Session session = sampled(1000, 2.0, tool);
    Session scope = sampled(
        1000, 2.0, [](double) { return Vec3{}; }, [](double) { return Vec3{}; });
    scope.tracks[0].role = Role::Scope;
    for (Sample& sample : scope.tracks[0].samples) sample.pose.orientation = axisAngle({0, 0, 1}, roll(sample.time));
    session.tracks.push_back(scope.tracks[0]);
    session.fieldOfView = kPi / 2;
    return session;
}

} // namespace

TEST_CASE("opening the target is intended, opening anything else is not")
{
    const Session session = withEvents({{1.0, EventKind::Tear, "polyp", 2e-5},
                                        {2.0, EventKind::Tear, "uterus", 3e-5},
                                        {3.0, EventKind::Cut, "uterus", 4e-5},
                                        {4.0, EventKind::Cut, "polyp", 5e-5},
                                        {5.0, EventKind::Tear, "uterus", {}}});
    CHECK(number("tears_unintended", session) == 2);
    CHECK(*measured("tears_unintended", session).moment == 2.0);
    CHECK(number("cuts_unintended", session) == 1);
    CHECK(number("area_unintended", session) == exactly(7e-5));
    CHECK(number("perforations", session) == 0);
}

TEST_CASE("cuts or tears of one body in quick succession are one")
{
    std::vector<Event> events;
    for (int i = 0; i < 20; ++i) {
        const double time = 1.0 + 0.4 * i; // to 8.6 s
        events.push_back({time, EventKind::Cut, i % 2 == 0 ? "uterus" : "bowel", 1e-6});
        events.push_back({time, EventKind::Tear, "uterus", 1e-6});
    }
    events.push_back({9.2, EventKind::Tear, "uterus", 1e-6});
    const Session session = withEvents(events);
    CHECK(number("tears_unintended", session) == 2);
    CHECK(number("cuts_unintended", session) == 20); // 0.8 s apart on each body
    CHECK(number("cuts_unintended", session, {.rupturePause = 1.0}) == 2);
    CHECK(number("area_unintended", session) == exactly(41e-6));
}

TEST_CASE("kinds of events that were not recorded have no count")
{
    Session session = withEvents({});
    session.watched.clear();
    CHECK(reason("perforations", session) == "the session did not record events of kind 'perforation'");
    for (const char* id : {"tears_unintended", "cuts_unintended", "area_unintended", "volume_removed", "mistakes"})
        CHECK(reason(id, session).starts_with("the session did not record events of kind '"));
}

TEST_CASE("the simulator's reports are used: volume, share seen, what is left, mistakes, steps")
{
    Session session = withEvents({{1.0, EventKind::Seen, "", 0.3},
                                  {2.0, EventKind::Removed, "polyp", 1.5e-7},
                                  {3.0, EventKind::Removed, "polyp", 0.5e-7},
                                  {4.0, EventKind::Residual, "", 0.4},
                                  {5.0, EventKind::Step, "enter"},
                                  {5.5, EventKind::Step, "enter"},
                                  {6.0, EventKind::Seen, "", 0.9},
                                  {7.0, EventKind::Mistake, "wall"},
                                  {8.0, EventKind::Residual, "", 0.05}});
    CHECK(number("volume_removed", session) == exactly(2e-7));
    CHECK(number("share_seen", session) == 0.9);
    CHECK(*measured("share_seen", session).moment == 6.0);
    CHECK(number("residual", session) == 0.05);
    CHECK(number("mistakes", session) == 1);
    CHECK(reason("steps_done", session) == "the case specifies no steps");
    session.steps = {"enter", "see both ostia", "take it out", "leave"};
    CHECK(number("steps_done", session) == 0.25);
    CHECK(reason("share_seen", withEvents({})) == "there was no event of kind 'seen'");
}

TEST_CASE("blood lost is the sum over bodies and over what they lost between resets")
{
    const Session session = withEvents({{1.0, EventKind::Blood, "liver", 0.0},
                                        {2.0, EventKind::Blood, "liver", 3e-6},
                                        {2.5, EventKind::Blood, "bowel", 1e-6},
                                        {3.0, EventKind::Blood, "liver", 4e-6},
                                        {4.0, EventKind::Blood, "liver", 0.0}, // it was reset
                                        {5.0, EventKind::Blood, "liver", 0.5e-6}});
    CHECK(number("blood_lost", session) == exactly(5.5e-6));
    CHECK(*measured("blood_lost", session).moment == 2.0);
    CHECK(number("blood_lost", withEvents({{1.0, EventKind::Blood, "liver", 0.0}})) == 0.0);
    CHECK(reason("blood_lost", withEvents({})) == "the case has no body that can bleed");
    const Session wet = withEvents({{1.0, EventKind::Deficit, "fluid", 3e-6},
                                    {2.0, EventKind::Deficit, "fluid", 9e-6},
                                    {3.0, EventKind::Deficit, "fluid", 7e-6}});
    CHECK(number("fluid_deficit", wet) == 9e-6); // the cavity gives back what had stretched it
    CHECK(reason("fluid_deficit", withEvents({})) == "no fluid distends a cavity");
}

TEST_CASE("what electrodes did is the sum over them, in air and in all, between resets")
{
    const Session session = withEvents({{1.0, EventKind::Activation, "hook", 0.0},
                                        {2.0, EventKind::Activation, "hook", 0.7},
                                        {2.0, EventKind::InAir, "hook", 0.2},
                                        {2.0, EventKind::Energy, "hook", 15.0},
                                        {3.0, EventKind::Activation, "hook, electrode 1", 0.5},
                                        {3.0, EventKind::InAir, "hook, electrode 1", 0.0},
                                        {3.0, EventKind::Energy, "hook, electrode 1", 4.0},
                                        {4.0, EventKind::Activation, "hook", 0.0}, // it was reset
                                        {5.0, EventKind::Activation, "hook", 0.1}});
    CHECK(number("activation_time", session) == exactly(1.3));
    CHECK(*measured("activation_time", session).moment == 2.0);
    CHECK(number("activation_in_air", session) == exactly(0.2));
    CHECK(number("energy_delivered", session) == exactly(19.0));
    for (const char* id : {"activation_time", "activation_in_air", "energy_delivered"})
        CHECK(reason(id, withEvents({})) == "the case has no electrode");
}

TEST_CASE("an unintended burn is the largest burnt area of each body that is no target")
{
    const Session session = withEvents({{1.0, EventKind::Burn, "bowel", 0.0},
                                        {2.0, EventKind::Burn, "bowel", 8e-6},
                                        {2.5, EventKind::Burn, "duct", 1e-6},
                                        {3.0, EventKind::Burn, "bowel", 5e-6}}); // a piece of it was cut off
    CHECK(number("burnt_unintended", session) == exactly(9e-6));
    CHECK(*measured("burnt_unintended", session).moment == 2.0);
    CHECK(number("burnt_unintended", withEvents({{1.0, EventKind::Burn, "bowel", 0.0}})) == 0.0);
    CHECK(reason("burnt_unintended", withEvents({})) == "the case has no body that burns and is no target");
}

TEST_CASE("the horizon error is the mean roll of the picture")
{
    const auto before = [](double) { return Vec3{0, 0, -0.1}; };
    CHECK(number("horizon_error", scoped([](double) { return 0.3; }, before)) == exactly(0.3));
    CHECK(number("horizon_error", scoped([](double) { return -0.3; }, before)) == exactly(0.3));
    CHECK(number("horizon_error", scoped([](double t) { return 0.5 * std::sin(kPi * t); }, before)) ==
          exactly(0.5 * 2.0 / kPi));
    CHECK(reason("horizon_error", sampled(100, 1.0, before)) == "no scope was observed");
}

TEST_CASE("a tool beyond the cone of view is out of view for that time")
{
    const auto upright = [](double) { return 0.0; };
    // Out of view if x > 0.1, for a cone of 45 degrees to each side: half of the time, minus its first moment.
    const Session session = scoped(upright, [](double t) { return Vec3{0.2 * std::sin(kPi * t), 0, -0.1}; });
    const double share = 4.0 * (0.5 - std::asin(0.5) / kPi);
    CHECK(number("out_of_view", session) == Approx(share).margin(4e-3)); // four ends, each within a sample
    CHECK(*measured("out_of_view", session).moment == Approx(1.0 / 6.0).margin(1e-3));
    CHECK(number("out_of_view", scoped(upright, [](double) {
                     return Vec3{0, 0, 0.1};
                 })) == exactly(2.0)); // behind the scope
}

TEST_CASE("only a contact near the lens is one of the lens")
{
    Session session = scoped([](double) { return 0.0; }, [](double) { return Vec3{0, 0, -0.1}; });
    for (Sample& sample : session.tracks[1].samples) {
        const bool lens = sample.time > 0.5 && sample.time <= 1.25;
        sample.contacts = 1;
        sample.point = {0, lens ? 0.004 : 0.03, 0};
    }
    CHECK(number("lens_contact", session) == exactly(0.75));
    CHECK(*measured("lens_contact", session).moment == exactly(0.5));
}

} // namespace events_test
