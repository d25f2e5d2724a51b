#pragma once

#include "filasofia/runtime/carried.h"
#include "filasofia/runtime/film_marks.h"
#include "filasofia/runtime/memory.h"
#include "filasofia/runtime/run.h"

#include "filasofia/core/background.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/surface/bleeding.h"
#include "filasofia/surface/burning.h"

#include <atomic>
#include <functional>
#include <map>
#include <mutex>

namespace filasofia::runtime {

/// A flag per node of a body.
using NodeFlags = std::shared_ptr<const std::vector<std::uint8_t>>;

/// The bodies whose surface has a layer of one kind: blood (Bleeding) or heat (Burning). Each layer steps on a
/// background thread, from the frame of one step until that of a later step, which waits for it: so what is seen and
/// told is the same however busy the machine is.
template <class Layer> class SurfaceLayers {
public:
    using Def = typename Layer::Def;
    using Command = typename Layer::Command;
    using Balance = typename Layer::Balance;

    /// Any thread. Error if the body is no soft body or has this layer already, or if the Def is wrong.
    void add(BodyId id, const Def& def, Vec3 gravity, const physics::PhysicsServer& physics);
    /// Takes effect at the layer's next step. Any thread. Error if the body has no layer, or a field is wrong.
    void treat(BodyId id, const Command& command, const physics::PhysicsServer& physics);
    /// The Error that treat() would throw. Any thread.
    void check(BodyId id, const Command& command, const physics::PhysicsServer& physics) const;
    /// After the last step of the layer that has ended. Any thread. Error if the body has none.
    [[nodiscard]] Balance balance(BodyId id) const;
    /// Summed over all bodies: what is told of them, for blood what has welled [m^3]. Any thread.
    [[nodiscard]] double told() const;
    /// Whether a body has this layer. Any thread.
    [[nodiscard]] bool has(BodyId id) const;
    /// After the last step of the layer that has ended; null before. Any thread. Error if the body has none.
    [[nodiscard]] NodeFilm damage(BodyId id) const;
    /// All bodies are as they were added. Any thread.
    void restart();

    /// Posts what is told once a second while it changes; returns false if the event is lost.
    using Post = std::function<bool(BodyId, const Def&, const Balance&)>;
    /// After a step of physics that ended at `time` [s]: the stepping thread. Returns false if an event is lost.
    bool afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, const Post& post);
    /// The stepping thread. Vessels that are closed at the layer's steps from now on, for bodies that bleed.
    void close(const std::map<BodyId, NodeFlags>& closed);
    /// The stepping thread. Nodes that were found burnt since the last call.
    [[nodiscard]] std::map<BodyId, NodeFlags> takeBurnt();

    /// The stepping thread. What was given off by steps whose results have come since the last call.
    [[nodiscard]] std::vector<surface::Fume> takeFumes();

    /// A surface that electrodes may touch.
    struct Surface {
        BodyId body = {};
        std::span<const geometry::Triangle> skin = {}; ///< before it is cut; as long as its layer
        double dt =
            0.0; ///< [s], length of the step that the layer begins in afterStep() of this time; 0: it begins none
        double spread = 0.0; ///< [m], how far heat spreads along the layer before it is lost
    };
    /// The stepping thread.
    [[nodiscard]] std::vector<Surface> surfaces(double time) const;
    /// What tips give in that step. The stepping thread.
    void touch(BodyId id, surface::TipHeat tip);
    /// [J], taken from an electrode by all bodies, in the steps whose results are known; `toTheEnd`: in all, after
    /// fill(). Any thread.
    [[nodiscard]] double taken(int electrode, bool toTheEnd = false) const;

    /// The stepping thread. What heat has done to the tissue in steps whose results have come since the last call.
    [[nodiscard]] std::vector<physics::SetTissue> takeTissue();
    /// Throws an Error if an engine cannot do to a body's tissue what its heat may ask for. Any thread.
    void check(const physics::PhysicsEngine& engine, const physics::PhysicsServer& physics) const;

    /// The newest film of each body that has a newer one than at the last call.
    [[nodiscard]] std::map<BodyId, NodeFilm> takeFilms();
    void fill(RunReport& report) const;
    /// For saved states; between two steps.
    [[nodiscard]] Memory memory();

private:
    /// One step of a layer, and what it needs.
    struct Turn {
        Layer layer;
        std::vector<Command> commands = {};
        std::vector<Vec3> positions = {};
        std::shared_ptr<const frame::Boundary> boundary = {};
        Vec3 gravity = {};
        double dt = 0.0;
        NodeFlags closed = {};
        std::vector<surface::TipHeat> tips = {};
        NodeFlags burnt = {}; ///< found by the step
        NodeFilm film = {};   ///< the same
        NodeFilm damage = {}; ///< the same
        void run();
    };
    struct Patient {
        std::string name = {};
        Vec3 gravity = {};
        std::shared_ptr<const Layer> start = {}; ///< as it was added
        std::shared_ptr<Turn> turn = {};
        std::shared_ptr<BackgroundJob> job = {}; ///< null: the turn is done
        std::vector<Command> waiting = {};
        CarriedTreatments carried = {}; ///< blood's
        bool restart = false;
        double last = -1.0; ///< [s], time of the newest positions; < 0: it had none yet
        double next = 0.0;  ///< [s]
        Balance balance = {};
        std::optional<double> told = {}; ///< what the last event said
        double tellFrom = 0.0;           ///< [s], no event before
        NodeFlags closed = {};
        std::vector<surface::TipHeat> tips = {};     ///< for the step that begins
        std::map<int, double> taken = {};            ///< [J], by electrodes
        NodeFlags burnt = {};                        ///< takeBurnt() does not have it yet
        NodeFilm damage = {};                        ///< heat's, null before the first step and after a reset
        std::vector<surface::Fume> fumes = {};       ///< takeFumes() does not have them yet
        std::vector<physics::SetTissue> tissue = {}; ///< takeTissue() does not have them yet
        NodeFilm film = {};
        bool fresh = false;  ///< takeFilms() does not have this film yet
        bool missed = false; ///< the log has said that a command reached nothing
    };
    using Patients = std::map<BodyId, Patient>;
    static void finish(Patient& patient);
    static void warnOfMisses(const frame::SoftBodyFrame& body, Patient& patient);
    static bool tell(BodyId id, double time, Patient& patient, const Post& post);
    static bool takeResults(BodyId id, double time, Patient& patient, const Post& post);
    void begin(Patient& patient, const frame::Frame& frame, const frame::SoftBodyFrame& body, double time);
    [[nodiscard]] const Patient& patient(BodyId id) const;
    [[nodiscard]] Patients copy() const;

    mutable std::mutex mutex_;
    Patients patients_;
    std::atomic<bool> any_ = false; ///< without patients a step costs nothing
    BackgroundThread thread_;       ///< last: it ends before what its jobs use
};

using Bleedings = SurfaceLayers<surface::Bleeding>;
using Burnings = SurfaceLayers<surface::Burning>;

} // namespace filasofia::runtime
