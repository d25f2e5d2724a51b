#pragma once

#include "filasofia/math/pose.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What a trainee did, as samples, and what can be measured of it.
namespace filasofia::metric {

/// One observed body at one moment. What was not observed, or could not be, is NaN: nothing is computed from it.
struct Sample {
    double time = 0.0; ///< [s], simulated
    Pose pose = {};    ///< of the point that is followed: an instrument's tip, a scope's lens
    Vec3 force = {};   ///< [N] on the body, by all that touches it and that it holds: the mean since the sample before
    int contacts = 0;  ///< [-] that push; what is held is one more
    Vec3 point = {};   ///< [m] where the strongest of them pushes; NaN without contacts
};

enum class Role {
    Tool,  ///< what the trainee holds; the first is the one that is measured, the second its partner
    Scope, ///< a camera: looks along `axis`, its picture's upper side is `up`
    Other
};
std::string_view name(Role role); ///< "tool"

/// One observed body from the session's start to its end.
struct Track {
    std::string name = {};
    Role role = Role::Tool;
    bool force = true;            ///< were force, contacts and point observed
    Vec3 axis = {0.0, 0.0, -1.0}; ///< [-], where it points, in its own coordinates
    Vec3 up = {0.0, 1.0, 0.0};    ///< [-], a scope's: upwards in its picture, in its own coordinates
    std::vector<Sample> samples = {};
};

enum class EventKind {
    Grasp,       ///< something is held
    Release,     ///< it is let go
    Tear,        ///< stress opened a body; amount: [m^2]
    Cut,         ///< a blade opened a body; amount: [m^2]
    Perforation, ///< an instrument went through a wall
    Removed,     ///< a piece is out; amount: [m^3]
    Seen,        ///< how much of what is to be inspected has been seen; amount: [-], in [0, 1]
    Residual,    ///< how much of the target is left; amount: [-], in [0, 1]
    Step,        ///< a step of the task is done; what: one of Session::steps
    Mistake,     ///< what the task calls a mistake
    Note
};
std::string_view name(EventKind kind); ///< "tear"
std::optional<EventKind> eventKind(std::string_view name);

/// Something that happened.
struct Event {
    double time = 0.0; ///< [s], simulated
    EventKind kind = EventKind::Note;
    std::string what = {};             ///< the body, the step
    std::optional<double> amount = {}; ///< in the unit of its kind
};

/// One session of one trainee. Every name is text that somebody typed.
struct Session {
    std::string trainee = {};
    std::string task = {};                  ///< the case: only sessions of one case are compared
    std::string date = {};                  ///< as "2026-11-20 18:05": sorts by time
    std::string software = {};              ///< what ran it, with its version
    std::uint64_t seed = 0;                 ///< [-], of what was random in the case
    std::optional<double> idealPath = {};   ///< [m], > 0, the shortest way that does the task
    std::optional<double> forceLimit = {};  ///< [N], > 0, that the tissue stands
    std::optional<double> fieldOfView = {}; ///< [rad], in (0, pi), the full angle of the scope's picture
    Vec3 up = {0.0, 1.0, 0.0};              ///< [-], against gravity, in the world
    std::vector<std::string> targets = {};  ///< bodies that are to be cut or torn; of others it is unintended
    std::vector<std::string> steps = {};    ///< of the task, each to be done once
    std::vector<EventKind> watched = {};    ///< kinds that are known to be complete: none of them means zero
    std::vector<Track> tracks = {};
    std::vector<Event> events = {}; ///< by rising time
    std::uint64_t lost = 0;         ///< [-] samples that could not be kept
    bool complete = true;           ///< false: the record has no end, it broke off
};

/// The first track of a role after the first `skip` of them, or nullptr.
const Track* findTrack(const Session& session, Role role, int skip = 0);

} // namespace filasofia::metric
