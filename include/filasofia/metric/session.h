#pragma once

#include "filasofia/math/pose.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// A trainee's session as samples and events, and what can be measured from them.
namespace filasofia::metric {

/// One observed body at one moment. What was not or could not be observed is NaN: nothing is computed from it.
struct Sample {
    double time = 0.0; ///< [s], simulated
    Pose pose = {};    ///< pose of the observed point: an instrument's tip, a scope's lens
    Vec3 force = {};   ///< [N] force of all contacts and attachments on the body: the mean since the previous sample
    int contacts = 0;  ///< [-] number of contacts with a force, plus one per attachment
    Vec3 point = {};   ///< [m] point of the strongest contact; NaN without contacts
};

enum class Role {
    Tool,  ///< an instrument in the trainee's hand; the first one is measured, the second is its partner
    Scope, ///< a camera: looks along `axis`, with `up` upwards in its picture
    Other
};
constexpr std::array<std::string_view, 3> names(const Role*) { return {"tool", "scope", "other"}; }
std::string_view name(Role role); ///< "tool"

/// One observed body from the start of the session to its end.
struct Track {
    std::string name = {};
    Role role = Role::Tool;
    bool force = true;            ///< whether force, contacts and point were observed
    Vec3 axis = {0.0, 0.0, -1.0}; ///< [-], the direction in which it points, in its own coordinates
    Vec3 up = {0.0, 1.0, 0.0};    ///< [-], for a scope: upwards in its picture, in its own coordinates
    std::vector<Sample> samples = {};
};

enum class EventKind {
    Grasp,       ///< an instrument grasped something
    Release,     ///< an instrument released it
    Tear,        ///< stress opened a body; amount: [m^2]
    Cut,         ///< a blade opened a body; amount: [m^2]
    Perforation, ///< an instrument went through a wall
    Blood,       ///< a body has lost so much blood since it was added or reset; amount: [m^3]
    Energy,      ///< an electrode has given so much heat since it was added or reset; amount: [J]
    Activation,  ///< an electrode has been active for so long since then; amount: [s]
    InAir,       ///< for so long in this it touched no tissue; amount: [s]
    Leak,        ///< so much has flowed out of a cut duct since it was added or reset; amount: [m^3]
    Deficit,     ///< so much more fluid has flowed into a cavity than out of it since it was added; amount: [m^3]
    Clip,        ///< a clip was closed on tissue
    ClipLost,    ///< a clip was closed on nothing, and fell
    ClipSlipped, ///< a clip was pulled off, or its tissue was removed
    Burn,        ///< so much of a body that is no target of heat is burnt; amount: [m^2]
    Removed,     ///< a piece was removed; amount: [m^3]
    Seen,        ///< the share of the surface to be inspected that has been seen; amount: [-], in [0, 1]
    Residual,    ///< the share of the target that is left; amount: [-], in [0, 1]
    Step,        ///< a step of the task is done; `what` is one of Session::steps
    Mistake,     ///< a mistake as defined by the task
    Unfinished,  ///< the task ended before it was done; `what` says why
    Note
};
std::string_view name(EventKind kind); ///< "tear"
std::optional<EventKind> eventKind(std::string_view name);

/// An event of a session.
struct Event {
    double time = 0.0; ///< [s], simulated
    EventKind kind = EventKind::Note;
    std::string what = {};             ///< the body, the step
    std::optional<double> amount = {}; ///< in the unit of its kind
};

/// One session of one trainee. All names are text that users typed.
struct Session {
    std::string trainee = {};
    std::string task = {};                  ///< the case: only sessions of the same case are compared
    std::string date = {};                  ///< as "2026-11-20 18:05": sorts by time
    std::string software = {};              ///< program and version that ran it
    std::uint64_t seed = 0;                 ///< [-], random seed of the case
    std::optional<double> idealPath = {};   ///< [m], > 0, length of the shortest path that does the task
    std::optional<double> forceLimit = {};  ///< [N], > 0, force that the tissue withstands
    std::optional<double> fieldOfView = {}; ///< [rad], in (0, pi), full angle of the scope's picture
    Vec3 up = {0.0, 1.0, 0.0};              ///< [-], against gravity, in the world
    std::vector<std::string> targets =
        {}; ///< bodies that are to be cut or torn; cutting or tearing any other is unintended
    std::vector<std::string> steps = {}; ///< steps of the task, each to be done once
    std::vector<EventKind> watched =
        {}; ///< kinds that were recorded completely: if there is no event of such a kind, there was none
    std::vector<Track> tracks = {};
    std::vector<Event> events = {}; ///< in increasing order of time
    std::uint64_t lost = 0;         ///< [-] number of samples that could not be kept
    bool complete = true;           ///< false: the record has no end, because it was interrupted
};

/// Takes back the samples and events that are later than `time` [s], because a saved state was restored.
void takeBack(Session& session, double time);

/// The last Unfinished event, unless a step was done after it; or nullptr.
const Event* findUnfinished(const Session& session);

/// The track of a role after skipping the first `skip` of them, or nullptr.
const Track* findTrack(const Session& session, Role role, int skip = 0);

} // namespace filasofia::metric
