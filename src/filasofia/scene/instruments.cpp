#include "filasofia/scene/instruments.h"

#include "filasofia/core/error.h"
#include "filasofia/scene/motion.h"
#include "filasofia/scene/pedals.h"
#include "filasofia/scene/places.h"
#include "filasofia/scene/remember_past.h"

#include <algorithm>

namespace filasofia::scene {
namespace {

/// Opens and closes the jaws when the times of their keys have come.
class GripFollower {
public:
    GripFollower(std::shared_ptr<prefab::ArticulatedInstrument> instrument, std::vector<KeyGrip> keys)
        : instrument_(std::move(instrument)), keys_(std::move(keys))
    {
    }

    void follow(double time)
    {
        const auto later = std::ranges::upper_bound(keys_, time, {}, &KeyGrip::time);
        const auto reached = static_cast<std::size_t>(later - keys_.begin());
        if (reached == given_) return;
        given_ = reached;
        const KeyGrip& key = keys_[reached - 1];
        key.opening ? instrument_->open(*key.opening) : instrument_->close(key.torque);
    }

    [[nodiscard]] std::size_t past() const { return given_; }
    void goBack(std::size_t given) { given_ = given; }

private:
    std::shared_ptr<prefab::ArticulatedInstrument> instrument_;
    std::vector<KeyGrip> keys_;
    std::size_t given_ = 0; ///< number of keys whose times have come
};

template <class Moved>
void followKeys(runtime::Simulation& simulation, const std::shared_ptr<Moved>& moved, ElementMotion motion)
{
    simulation.everyStep([moved, motion = std::move(motion)](double time) { moved->move(poseAt(motion, time)); });
}

/// The pose at which an instrument begins: that of its key at 0 s or, if it has none, its Def's.
Pose firstPose(const Pose& said, const std::vector<KeyPose>& keys, const std::string& path, const Places& places)
{
    if (keys.empty() || keys.front().time > 0.0) return said;
    const Pose& first = keys.front().pose;
    if ((said != Pose{} || places.contains(path + ".pose")) && said != first)
        fail(path, ".pose must not differ from that of keys[0], where it is at 0 s");
    return first;
}

Instrument addInstrument(runtime::Simulation& simulation, const SceneInstrument& def, const std::string& path,
                         const Places& places)
{
    Instrument added{.keyed = !def.keys.empty()};
    if (added.keyed) checkTimes(def.keys, path + ".keys");
    for (std::size_t i = 0; i < def.keys.size(); ++i)
        static_cast<void>(physics::unitPose(def.keys[i].pose, text(path, ".keys[", i, "].pose")));
    if (!def.grip.empty()) checkTimes(def.grip, path + ".grip");
    const auto motionFrom = [&](const Pose& start) { return withFirstKey({.keys = def.keys}, start); };
    if (const auto* given = std::get_if<prefab::ArticulatedInstrumentDef>(&def.def)) {
        prefab::ArticulatedInstrumentDef jaws = *given;
        jaws.pose = firstPose(jaws.pose, def.keys, path, places);
        added.jaws = std::make_shared<prefab::ArticulatedInstrument>(simulation, jaws);
        added.body = added.jaws->body();
        if (added.keyed) followKeys(simulation, added.jaws, motionFrom(jaws.pose));
        if (def.grip.empty()) return added;
        const auto grip = std::make_shared<GripFollower>(added.jaws, def.grip);
        simulation.everyStep([grip](double time) { grip->follow(time); });
        rememberPast(simulation, text("the grip of instrument '", jaws.name, "'"), grip);
        return added;
    }
    prefab::EndoscopeDef scope = std::get<prefab::EndoscopeDef>(def.def);
    scope.pose = firstPose(scope.pose, def.keys, path, places);
    if (!def.grip.empty()) fail(path, ".grip must be empty: an endoscope has no jaws");
    added.scope = std::make_shared<prefab::Endoscope>(simulation, scope);
    added.body = added.scope->body();
    if (added.keyed) followKeys(simulation, added.scope, motionFrom(scope.pose));
    return added;
}

} // namespace

Instruments addInstruments(runtime::Simulation& simulation, const SceneDef& scene, std::vector<BodyId>& ids)
{
    Instruments added;
    for (std::size_t i = 0; i < scene.instruments.size(); ++i) {
        const std::string path = text("instruments[", i, "]");
        try {
            added.push_back(addInstrument(simulation, scene.instruments[i], path, scene.places));
            addElectrodes(simulation, added.back().body, scene.instruments[i].electrodes, ids);
        } catch (const Error& error) {
            const std::string words = error.what();
            failAtPlace(scene.places, words.starts_with(path) ? words : text(path, ": ", words));
        }
        ids.push_back(added.back().body);
    }
    const auto scope = std::ranges::find_if(added, &Instrument::isScope);
    if (scope != added.end() && scene.cameras.empty())
        simulation.dress([view = scope->scope](visual::VisualServer& visual) { view->dress(visual); });
    return added;
}

void giveToHand(runtime::Simulation& simulation, const Instruments& instruments, BodyId held, runtime::HapticId hand)
{
    const auto found = std::ranges::find(instruments, held, &Instrument::body);
    if (!held || found == instruments.end()) return;
    if (found->scope) fail("body must not be an endoscope: its camera would stay behind");
    if (found->keyed) fail("body must be an instrument without keys of its own");
    simulation.on<runtime::DeviceEvent>([jaws = found->jaws, hand](const runtime::DeviceEvent& event) {
        if (event.interface != hand || event.notice.kind != device::DeviceNotice::Kind::Button) return;
        if (event.notice.button != 0) return;
        event.notice.pressed ? jaws->close() : jaws->open();
    });
}

} // namespace filasofia::scene
