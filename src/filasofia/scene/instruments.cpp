#include "filasofia/scene/instruments.h"

#include "filasofia/core/error.h"
#include "filasofia/scene/motion.h"
#include "filasofia/scene/pedals.h"
#include "filasofia/scene/places.h"
#include "filasofia/scene/remember_past.h"
#include "filasofia/scene/scene_numbers.h"

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

/// The pose in a trocar at a time [s]; `start` is that at 0 s.
prefab::TrocarPose trocarPoseAt(const std::vector<KeyTrocar>& keys, const prefab::TrocarPose& start, double time)
{
    const auto later = std::ranges::upper_bound(keys, time, {}, &KeyTrocar::time);
    if (later == keys.end()) return keys.back().pose;
    const KeyTrocar before = later == keys.begin() ? KeyTrocar{0.0, start} : *(later - 1);
    return between(before.pose, later->pose, (time - before.time) / (later->time - before.time));
}

/// Moves what is in a trocar by its keys. Throws an Error if a pose is outside the limits.
template <class Moved> void followTrocarKeys(runtime::Simulation& simulation, const std::shared_ptr<Moved>& moved,
                                             const std::vector<KeyTrocar>& keys, const std::string& path)
{
    checkTimes(keys, path + ".trocarKeys");
    for (std::size_t i = 0; i < keys.size(); ++i)
        checkLimits(moved->def().trocar, keys[i].pose, text(path, ".trocarKeys[", i, "].pose"));
    if (moved->def().hand.haptic) fail(path, ".trocarKeys must be empty: a haptic device moves it");
    simulation.everyStep([moved, keys](double time) { moved->move(trocarPoseAt(keys, moved->def().start, time)); });
}

void followGrip(runtime::Simulation& simulation, const Instrument& added, const SceneInstrument& def)
{
    if (def.grip.empty()) return;
    const std::string& name = std::visit([](const auto& each) -> const std::string& { return each.name; }, def.def);
    const auto grip = std::make_shared<GripFollower>(added.jaws, def.grip);
    simulation.everyStep([grip](double time) { grip->follow(time); });
    rememberPast(simulation, text("the grip of instrument '", name, "'"), grip);
}

void checkKeys(const SceneInstrument& def, const std::string& path)
{
    const bool scope = std::holds_alternative<prefab::EndoscopeDef>(def.def) ||
                       std::holds_alternative<prefab::LaparoscopeDef>(def.def);
    const bool trocar = std::holds_alternative<prefab::LaparoscopicInstrumentDef>(def.def) ||
                        std::holds_alternative<prefab::LaparoscopeDef>(def.def);
    if (trocar && !def.keys.empty()) fail(path, ".keys must be empty: what is in a trocar has trocarKeys");
    if (!trocar && !def.trocarKeys.empty()) fail(path, ".trocarKeys must be empty: it is in no trocar");
    if (scope && !def.grip.empty()) fail(path, ".grip must be empty: an endoscope has no jaws");
    if (std::holds_alternative<prefab::WireLoopDef>(def.def) && !def.grip.empty())
        fail(path, ".grip must be empty: a loop has no jaws");
    if (!def.keys.empty()) checkTimes(def.keys, path + ".keys");
    for (std::size_t i = 0; i < def.keys.size(); ++i)
        static_cast<void>(physics::unitPose(def.keys[i].pose, text(path, ".keys[", i, "].pose")));
    if (!def.grip.empty()) checkTimes(def.grip, path + ".grip");
}

/// Adds an instrument of each kind. `def` is the whole of it, with its keys.
struct InstrumentAdder {
    runtime::Simulation& simulation;
    const SceneInstrument& def;
    const std::string& path;
    const Places& places;
    Instrument added = {};

    void operator()(prefab::ArticulatedInstrumentDef jaws)
    {
        jaws.pose = firstPose(jaws.pose, def.keys, path, places);
        added.jaws = std::make_shared<prefab::ArticulatedInstrument>(simulation, jaws);
        added.body = added.jaws->body();
        if (added.keyed) followKeys(simulation, added.jaws, withFirstKey({.keys = def.keys}, jaws.pose));
    }
    void operator()(prefab::EndoscopeDef scope)
    {
        scope.pose = firstPose(scope.pose, def.keys, path, places);
        added.scope = std::make_shared<prefab::Endoscope>(simulation, scope);
        added.body = added.scope->body();
        if (added.keyed) followKeys(simulation, added.scope, withFirstKey({.keys = def.keys}, scope.pose));
    }
    void operator()(prefab::WireLoopDef loop)
    {
        loop.pose = firstPose(loop.pose, def.keys, path, places);
        added.loop = std::make_shared<prefab::WireLoop>(simulation, loop);
        added.body = added.loop->body();
        if (added.keyed) followKeys(simulation, added.loop, withFirstKey({.keys = def.keys}, loop.pose));
        simulation.everyStep([loop = added.loop](double) {}); // it lives as long as the simulation's callbacks
    }
    void operator()(const prefab::LaparoscopicInstrumentDef& tool)
    {
        added.inTrocar = std::make_shared<prefab::LaparoscopicInstrument>(simulation, tool);
        added.jaws = {added.inTrocar, &added.inTrocar->tool()};
        added.body = added.inTrocar->body();
        if (added.keyed) followTrocarKeys(simulation, added.inTrocar, def.trocarKeys, path);
    }
    void operator()(const prefab::LaparoscopeDef& scope)
    {
        added.laparoscope = std::make_shared<prefab::Laparoscope>(simulation, scope);
        added.body = added.laparoscope->body();
        if (added.keyed) followTrocarKeys(simulation, added.laparoscope, def.trocarKeys, path);
    }
};

Instrument addInstrument(runtime::Simulation& simulation, const SceneInstrument& def, const std::string& path,
                         const Places& places)
{
    checkKeys(def, path);
    InstrumentAdder adder{simulation, def, path, places, {.keyed = !def.keys.empty() || !def.trocarKeys.empty()}};
    std::visit(adder, def.def);
    followGrip(simulation, adder.added, def);
    return adder.added;
}

/// Whether an instrument is of this kind of those with jaws.
bool isOf(prefab::InstrumentKind kind, const SceneInstrument& def)
{
    const auto* jaws = std::get_if<prefab::ArticulatedInstrumentDef>(&def.def);
    if (const auto* tool = std::get_if<prefab::LaparoscopicInstrumentDef>(&def.def)) jaws = &tool->tool;
    return jaws && jaws->kind == kind;
}

/// Gives an instrument with arms its bag.
void addBag(runtime::Simulation& simulation, const SceneInstrument& def, const Instrument& added)
{
    if (!def.bag) return;
    if (!isOf(prefab::InstrumentKind::SpecimenBag, def)) fail("bag needs an instrument of kind specimenBag");
    const prefab::SpecimenBag bag(simulation, *added.jaws, *def.bag); // its film is the simulation's, and stays
}

/// Gives an instrument with jaws its clips.
void addClips(runtime::Simulation& simulation, const SceneInstrument& def, const Instrument& added,
              const std::vector<BodyId>& ids)
{
    if (!def.clips) return;
    if (!isOf(prefab::InstrumentKind::ClipApplier, def)) fail("clips need an instrument of kind clipApplier");
    prefab::ClipApplierDef clips = *def.clips;
    SceneNumbers(ids).replaceIn(clips);
    const auto applier = std::make_shared<prefab::ClipApplier>(simulation, *added.jaws, clips);
    simulation.everyStep([applier, jaws = added.jaws](double) {}); // they live as long as the simulation's callbacks
}

/// Gives an instrument what works while it is closed, or while its pedal is pressed.
void addFunctions(runtime::Simulation& simulation, const SceneInstrument& def, Instrument& added)
{
    if ((def.suction || def.shears) && !added.jaws)
        fail(def.suction ? "suction" : "shears", " needs an instrument with a shaft");
    if (def.shears && !isOf(prefab::InstrumentKind::UltrasonicShears, def))
        fail("shears need an instrument of kind ultrasonicShears");
    if (def.suction) added.suction = std::make_shared<prefab::SuctionIrrigator>(simulation, *added.jaws, *def.suction);
    std::shared_ptr<prefab::UltrasonicShears> shears;
    if (def.shears) shears = std::make_shared<prefab::UltrasonicShears>(simulation, *added.jaws, *def.shears);
    if (def.suction || def.shears) // they live as long as the simulation's callbacks
        simulation.everyStep([shears, suction = added.suction, jaws = added.jaws](double) {});
}

/// Closes jaws while a button is down. A click leaves them as they are until the next press: nobody draws a thread
/// through tissue with a finger on the button.
class JawButton {
public:
    JawButton(runtime::Simulation& simulation, std::shared_ptr<prefab::ArticulatedInstrument> jaws, bool latches)
        : simulation_(simulation), jaws_(std::move(jaws)), latches_(latches)
    {
    }
    void press()
    {
        // Also as they were at the start, or after a reset: what is held may keep closed jaws apart.
        constexpr double wide = 0.95;           // [-]
        if (std::exchange(down_, true)) return; // a new run tells again what is down
        closed_ = !(latches_ && closed_ && jaws_->opening() < wide);
        closed_ ? jaws_->close() : jaws_->open();
        pressed_ = now();
    }
    void release()
    {
        constexpr double click = 0.25; // [s]
        down_ = false;
        if (!closed_ || (latches_ && now() - pressed_ < click)) return;
        closed_ = false;
        jaws_->open();
    }

private:
    [[nodiscard]] double now() const { return simulation_.physics().latest()->time; } ///< [s], simulated

    runtime::Simulation& simulation_;
    std::shared_ptr<prefab::ArticulatedInstrument> jaws_;
    bool latches_ = true;
    bool closed_ = true, down_ = false; ///< told to, and the button; used by the thread that delivers events
    double pressed_ = 0.0;
};

/// Lets a person move two instruments and a scope in trocars that nothing else moves.
void addTrocarHands(runtime::Simulation& simulation, const Instruments& instruments)
{
    std::vector<std::shared_ptr<prefab::LaparoscopicInstrument>> tools;
    std::shared_ptr<prefab::Laparoscope> scope;
    for (const Instrument& each : instruments) {
        if (each.keyed || each.handle()) continue;
        if (each.inTrocar && tools.size() < 2) tools.push_back(each.inTrocar);
        if (each.laparoscope && !scope) scope = each.laparoscope;
    }
    if (tools.size() < 2 || !scope) return;
    const auto hands = std::make_shared<prefab::TrocarHands>(simulation, *tools[0], *tools[1], *scope);
    simulation.everyStep([hands, tools, scope](double) {}); // they live as long as the simulation's callbacks
}

} // namespace

Instruments addInstruments(runtime::Simulation& simulation, const SceneDef& scene, std::vector<BodyId>& ids)
{
    Instruments added;
    for (std::size_t i = 0; i < scene.instruments.size(); ++i) {
        const std::string path = text("instruments[", i, "]");
        try {
            added.push_back(addInstrument(simulation, scene.instruments[i], path, scene.places));
            addFunctions(simulation, scene.instruments[i], added.back());
            addElectrodes(simulation, added.back().body, scene.instruments[i].electrodes, ids);
            addClips(simulation, scene.instruments[i], added.back(), ids);
            addBag(simulation, scene.instruments[i], added.back());
        } catch (const Error& error) {
            const std::string words = error.what();
            failAtPlace(scene.places, words.starts_with(path) ? words : text(path, ": ", words));
        }
        ids.push_back(added.back().body);
    }
    addTrocarHands(simulation, added);
    const auto scope = std::ranges::find_if(added, &Instrument::isScope);
    if (scope != added.end() && scene.cameras.empty())
        simulation.dress([view = *scope](visual::VisualServer& visual) {
            view.scope ? view.scope->dress(visual) : view.laparoscope->dress(visual);
        });
    return added;
}

BodyId heldFor(const Instruments& instruments, BodyId body)
{
    const auto found = std::ranges::find(instruments, body, &Instrument::body);
    if (!body || found == instruments.end() || !(found->inTrocar || found->laparoscope)) return body;
    if (!found->handle()) fail("body must be an instrument whose hand is haptic, if it is in a trocar");
    return found->handle();
}

void giveToHand(runtime::Simulation& simulation, const Instruments& instruments, BodyId held, runtime::HapticId hand)
{
    const auto found = std::ranges::find(instruments, held, &Instrument::body);
    if (!held || found == instruments.end()) return;
    if (found->scope) fail("body must not be an endoscope: its camera would stay behind");
    if (!found->jaws) return; // a laparoscope, or a loop, whose pedals are its electrodes
    if (found->keyed) fail("body must be an instrument without keys of its own");
    const auto button = std::make_shared<JawButton>(simulation, found->jaws, !found->suction);
    simulation.on<runtime::DeviceEvent>([button, hand](const runtime::DeviceEvent& event) {
        if (event.interface != hand || event.notice.kind != device::DeviceNotice::Kind::Button) return;
        if (event.notice.button == 0) event.notice.pressed ? button->press() : button->release();
    });
}

} // namespace filasofia::scene
