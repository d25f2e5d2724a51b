#pragma once

#include "filasofia/runtime/bleeding_event.h"
#include "filasofia/runtime/film_marks.h"
#include "filasofia/runtime/memory.h"
#include "filasofia/runtime/run.h"

#include "filasofia/core/background.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/surface/bleeding.h"

#include <atomic>
#include <functional>
#include <map>
#include <mutex>

namespace filasofia::runtime {

/// The bodies that bleed. Each film steps on a background thread, from the frame of one step until that of a later
/// step, which waits for it: so what is seen and told is the same however busy the machine is.
class Bleedings {
public:
    /// Any thread. Error if the body is no soft body or bleeds already, or if the Def is wrong.
    void add(BodyId id, const surface::BleedingDef& def, Vec3 gravity, const physics::PhysicsServer& physics);
    /// Takes effect at the film's next step. Any thread. Error if the body does not bleed, or a field is wrong.
    void treat(BodyId id, const surface::BloodCommand& command);
    /// After the last step of the film that has ended. Any thread. Error if the body does not bleed.
    [[nodiscard]] surface::BloodBalance balance(BodyId id) const;
    /// All bodies are as they were added. Any thread.
    void restart();

    using Post = std::function<bool(std::unique_ptr<BleedingEvent>)>;
    /// After a step of physics that ended at `time` [s]: the stepping thread. `post` returns false if an event is lost;
    /// so does this.
    bool afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, const Post& post);
    /// The newest film of each body that has a newer one than at the last call.
    [[nodiscard]] std::map<BodyId, NodeFilm> takeFilms();
    /// Makes takeFilms() return all films once more.
    void resendFilms();
    void fill(RunReport& report) const;
    /// For saved states; between two steps.
    [[nodiscard]] Memory memory();

private:
    /// One step of a film, and what it needs.
    struct Turn {
        surface::Bleeding blood;
        std::vector<surface::BloodCommand> commands = {};
        std::vector<Vec3> positions = {};
        std::shared_ptr<const frame::Boundary> boundary = {};
        Vec3 gravity = {};
        double dt = 0.0;
        NodeFilm film = {};
        void run();
    };
    struct Patient {
        std::string name = {};
        Vec3 gravity = {};
        std::shared_ptr<const surface::Bleeding> start = {}; ///< as it was added
        std::shared_ptr<Turn> turn = {};
        std::shared_ptr<BackgroundJob> job = {}; ///< null: the turn is done
        std::vector<surface::BloodCommand> waiting = {};
        bool restart = false;
        double last = -1.0; ///< [s], time of the newest positions; < 0: it had none yet
        double next = 0.0;  ///< [s]
        surface::BloodBalance balance = {};
        std::optional<double> told = {}; ///< [m^3], blood lost in the last event
        double tellFrom = 0.0;           ///< [s], no event before
        NodeFilm film = {};
        bool fresh = false; ///< takeFilms() does not have this film yet
    };
    using Patients = std::map<BodyId, Patient>;
    static void finish(Patient& patient);
    static bool tell(BodyId id, double time, Patient& patient, const Post& post);
    void begin(Patient& patient, const frame::SoftBodyFrame& body, double time);
    [[nodiscard]] const Patient& patient(BodyId id) const;
    [[nodiscard]] Patients copy() const;

    mutable std::mutex mutex_;
    Patients patients_;
    std::atomic<bool> any_ = false; ///< without patients a step costs nothing
    BackgroundThread thread_;       ///< last: it ends before what its jobs use
};

} // namespace filasofia::runtime
