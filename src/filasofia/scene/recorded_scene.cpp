#include "filasofia/scene/scene_file.h"

#include "filasofia/core/error.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replayable.h"
#include "filasofia/runtime/scene_events.h"
#include "filasofia/scene/scene_numbers.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace filasofia::scene {
namespace {

/// Makes a scene of the steps of a recording. Whatever a scene cannot hold becomes a note.
class SceneCollector {
public:
    explicit SceneCollector(const std::filesystem::path& recording) : reader_(recording)
    {
        const record::RecordingHeader& header = reader_.header();
        const double rate = std::round(1.0 / header.period);
        scene_.physics.rate = 1.0 / rate == header.period ? rate : 1.0 / header.period;
        scene_.physics.contact = header.contact;
    }

    RecordedScene collect()
    {
        try {
            while (const auto step = reader_.next()) {
                takeScene();
                if (const auto why = record::whyNotReplayable(*step); !why.empty())
                    fail("step ", step->report.step, " cannot be in a scene: ", why);
                take(*step);
            }
        } catch (const Error& damage) {
            if (out_.hashes.empty()) throw;
            note("the recording ends early: ", damage.what());
        }
        if (out_.hashes.empty()) fail("the recording holds no step");
        takeScene();
        dress();
        addMotions();
        out_.scene = std::move(scene_);
        return std::move(out_);
    }

private:
    /// The keys of an element or joint.
    template <class Key> struct Track {
        std::vector<Key> keys = {};
        Pose start = {};        ///< an element's
        std::uint64_t step = 0; ///< in which it was told its last pose; 0: none

        void add(const Key& key)
        {
            if (!keys.empty() && keys.back().time == key.time) keys.pop_back(); // the last one in a step counts
            keys.push_back(key);
        }
    };

    template <class... Parts> void note(const Parts&... parts)
    {
        const std::string words = text(parts...);
        if (noted_.insert(words).second) out_.notes.push_back(words);
    }
    [[nodiscard]] bool started() const { return !out_.hashes.empty(); }

    void take(const physics::StepRecord& step)
    {
        const double dt = step.report.dt;
        if (dt > 0.0 && std::abs(dt - reader_.header().period) > 1e-12)
            note("its steps have different lengths, as those of a live run: those of the scene are all alike");
        before_ = time_;
        time_ += dt;
        step_ = step.report.step;
        for (const physics::Command& command : step.commands)
            std::visit([this](const auto& each) { take(each); }, command);
        for (const runtime::SceneEvent& event : std::exchange(waiting_, {}))
            std::visit([this](const auto& each) { show(each); }, event);
        if (dt > 0.0 || !started()) out_.hashes.push_back(step.hash); // a paused step is none
    }

    // Commands.

    void take(const physics::AddBody& add)
    {
        const std::string name = physics::describeBody(*add.def);
        constexpr std::uint32_t kMaxId = 1'000'000; // a recording is not trusted
        if (!add.id || add.id.value > kMaxId) fail("AddBody: id must be in [1, ", kMaxId, "], got ", add.id.value);
        if (started()) return note(name, ", added at ", time_, " s, is left out");
        SceneBody body{.def = *add.def};
        const std::size_t attachments = std::visit([](const auto& def) { return def.attachments.size(); }, body.def);
        if (!renumber(body.def)) return note(name, " is left out: it names a body that is");
        std::visit([this](auto& def) { makeUnique(def.name); }, body.def);
        for (std::size_t i = 0; i < attachments; ++i) number(AttachmentId{add.attachments.value + std::uint32_t(i)});
        if (bodies_.size() < add.id.value) bodies_.resize(add.id.value);
        scene_.bodies.push_back(std::move(body));
        bodies_[add.id.value - 1] = BodyId{static_cast<std::uint32_t>(scene_.bodies.size())};
    }
    void take(const physics::SetGravity& set)
    {
        if (!started())
            scene_.physics.gravity = set.gravity;
        else
            command(set);
    }
    void take(const physics::SetPose& set)
    {
        const auto* def = rigid(set.id);
        if (!def || def->dynamic) return command(set);
        const std::vector<Pose> start = physics::elementPoses(*def);
        const auto element = static_cast<std::size_t>(set.element);
        if (set.element < 0 || element >= start.size())
            fail("SetPose: element must be in [0, ", start.size(), "), got ", set.element);
        Track<KeyPose>& track = poses_[{numberOf(set.id).value, set.element}];
        if (track.keys.empty()) track.start = start[element];
        put(track, set.pose);
    }
    void put(Track<KeyPose>& track, const Pose& pose) const
    {
        const Pose last = track.keys.empty() ? track.start : track.keys.back().pose;
        if (track.step + 1 < step_) track.add({before_, last}); // it has stayed there until now
        track.add({time_, pose});
        track.step = step_;
    }
    void take(const physics::Reset& reset)
    {
        for (auto& each : poses_) put(each.second, each.second.start);
        command(reset);
    }
    void take(const physics::SetJoint& set)
    {
        if (rigid(set.id)) joints_[{numberOf(set.id).value, set.joint}].add({time_, set.command});
    }
    void take(const physics::SetMaterial& set) { command(SetMaterial{set.id, set.material}); }
    void take(const physics::Pause& pause)
    {
        if (pause.paused) note("pauses are left out");
    }
    void take(const physics::Tune&) {} // refused before
    template <class Command> void take(const Command& given) { command(given); }

    template <class Command> void command(Command given)
    {
        if constexpr (requires { given.def; }) {
            const AttachmentId recorded = given.id; // it makes an attachment
            given.id = {};
            if (!renumber(given)) return noteLost(given);
            if (!attachments_.empty() && recorded < attachments_.rbegin()->first)
                note("an attachment that was made before a body with attachments comes after them: hashes differ");
            given.id = number(recorded);
        } else if (!renumber(given)) {
            return noteLost(given);
        }
        scene_.commands.push_back({.command = std::move(given), .time = time_});
    }
    template <class Command> void noteLost(const Command&)
    {
        note(record::typeName<Command>(), " at ", time_, " s is left out: it names what is not in the scene");
    }

    /// The number of a recorded body in the scene; none if it is not in it.
    [[nodiscard]] BodyId numberOf(BodyId id) const
    {
        return id && id.value <= bodies_.size() ? bodies_[id.value - 1] : BodyId{};
    }
    /// The rigid body of a recorded id; null if the scene has none.
    [[nodiscard]] const physics::RigidBodyDef* rigid(BodyId id) const
    {
        const BodyId number = numberOf(id);
        return number ? std::get_if<physics::RigidBodyDef>(&scene_.bodies[number.value - 1].def) : nullptr;
    }
    /// Replaces recorded ids by the numbers of the scene; false if one is not in it.
    template <class T> bool renumber(T& value) const
    {
        try {
            SceneNumbers(bodies_, &attachments_).replaceIn(value);
        } catch (const Error&) {
            return false;
        }
        if constexpr (std::is_same_v<T, physics::Release>) return static_cast<bool>(value.id);
        return true;
    }
    AttachmentId number(AttachmentId recorded)
    {
        const AttachmentId number{static_cast<std::uint32_t>(attachments_.size()) + 1};
        return attachments_[recorded] = number;
    }
    void makeUnique(std::string& name)
    {
        const std::string given = name;
        for (int i = 2; !names_.insert(name).second; ++i) name = text(given, " ", i);
        if (name != given) note("a second body '", given, "' is called '", name, "'");
    }

    // The picture.

    void takeScene()
    {
        for (const record::SceneRecord& each : reader_.takeScene()) {
            runtime::SceneEvent event = runtime::eventOf(each);
            if (started())
                std::visit([this](const auto& later) { noteLater(later); }, event);
            else
                waiting_.push_back(std::move(event)); // its bodies come with the first step
        }
    }
    void noteLater(const runtime::SceneShown&) { note("what was shown during the run is left out"); }
    void noteLater(const runtime::SceneVisible&) { note("what was shown or hidden during the run is left out"); }
    void noteLater(const runtime::SceneMaterial&) { note("looks that changed during the run are left out"); }
    void noteLater(const runtime::SceneUnshown&) { note("what was no longer shown stays"); }
    void noteLater(const runtime::ScenePainted&) { note("paint of the run is left out"); }
    void noteLater(const runtime::SceneCleaned&) {}
    void noteLater(const runtime::SceneBled&) { note("bodies that began to bleed during the run do not"); }
    void noteLater(const runtime::SceneBurnt&) { note("bodies that began to burn during the run do not"); }
    void noteLater(const runtime::SceneTreated&) { note("what was done to blood and heat is left out"); }
    void noteLater(const runtime::SceneElectrode&) { note("bodies that became electrodes during the run are none"); }
    void noteLater(const runtime::SceneActivated&) { note("pedals that were pressed are left out"); }
    void noteLater(const runtime::SceneDuct&) { note("ducts that were added during the run are none"); }
    void noteLater(const runtime::SceneSmoke&) { note("smoke of a room that was added during the run is left out"); }
    void noteLater(const runtime::SceneExtracted& extracted)
    {
        if (scene_.smoke) command(extracted.command);
    }
    void noteLater(const runtime::SceneDistension&) { note("a distension that was added during the run is left out"); }
    void noteLater(const runtime::SceneDistended& distended)
    {
        if (scene_.distension) command(distended.command);
    }
    void noteLater(const runtime::SceneFile&) {}
    void noteLater(const runtime::SceneBegan& event) { show(event); }
    void noteLater(const runtime::SceneStage& stage)
    {
        if (stage_) note("cameras, lights and views that changed during the run are left out");
        if (!stage_) stage_ = stage;
    }
    void noteLater(const runtime::ScenePlaces& places)
    {
        if (places_ && (moved(places_->cameras, places.cameras) || moved(places_->lights, places.lights)))
            note("cameras and lights stay where they were at the start");
        if (!places_) places_ = places;
    }
    static bool moved(const std::vector<runtime::StagePlace>& a, const std::vector<runtime::StagePlace>& b)
    {
        return !std::ranges::equal(a, b, {}, &runtime::StagePlace::pose, &runtime::StagePlace::pose);
    }

    void show(const runtime::SceneBegan& began)
    {
        scene_.look = began.look;
        scene_.window.width = began.width;
        scene_.window.height = began.height;
        dressed_ = began.dressed;
    }
    void show(const runtime::SceneShown& shown)
    {
        if (const BodyId number = numberOf(shown.body)) shown_[shown.shown] = {number.value - 1, shown.def};
    }
    void show(const runtime::SceneVisible& visible)
    {
        if (const auto found = shown_.find(visible.shown); found != shown_.end())
            found->second.def.visible = visible.visible;
    }
    void show(const runtime::SceneMaterial& material)
    {
        if (const auto found = shown_.find(material.shown); found != shown_.end())
            found->second.def.material = material.material;
    }
    void show(const runtime::SceneUnshown& unshown) { shown_.erase(unshown.shown); }
    void show(const runtime::ScenePainted& painted)
    {
        if (const BodyId number = numberOf(painted.body)) scene_.bodies[number.value - 1].paint.push_back(painted.def);
    }
    void show(const runtime::SceneBled& bled)
    {
        if (const BodyId number = numberOf(bled.body)) scene_.bodies[number.value - 1].bleeding = bled.def;
    }
    void show(const runtime::SceneBurnt& burnt)
    {
        if (const BodyId number = numberOf(burnt.body)) scene_.bodies[number.value - 1].burning = burnt.def;
    }
    void show(const runtime::SceneTreated&) { note("what was done to blood and heat is left out"); }
    void show(const runtime::SceneElectrode& electrode)
    {
        const BodyId number = numberOf(electrode.body);
        if (!number) return;
        surface::ElectrodeDef& def = scene_.bodies[number.value - 1].electrodes.emplace_back(electrode.def);
        if (def.other && def.other->body) def.other->body = numberOf(def.other->body);
    }
    void show(const runtime::SceneActivated&) { note("pedals that were pressed are left out"); }
    void show(const runtime::SceneCleaned&)
    {
        for (SceneBody& each : scene_.bodies) each.paint.clear();
    }
    void show(const runtime::SceneDuct& duct)
    {
        if (const BodyId number = numberOf(duct.body)) scene_.bodies[number.value - 1].ducts.push_back(duct.def);
    }
    void show(const runtime::SceneSmoke& smoke) { scene_.smoke = smoke.def; }
    void show(const runtime::SceneExtracted& extracted) { command(extracted.command); }
    void show(const runtime::SceneDistension& distension) { scene_.distension = distension.def; }
    void show(const runtime::SceneDistended& distended) { command(distended.command); }
    void show(const runtime::SceneFile&) {}
    void show(const runtime::SceneStage& stage) { stage_ = stage; }
    void show(const runtime::ScenePlaces& places) { places_ = places; }

    void dress()
    {
        for (auto& [number, shown] : shown_) {
            if (shown.def.material) name(*shown.def.material);
            if (shown.def.interior) name(*shown.def.interior);
            scene_.bodies[shown.body].show.push_back(shown.def);
        }
        for (SceneBody& each : scene_.bodies)
            if (each.show.empty()) each.paint.clear();
        if (!dressed_) return; // the look's own camera and light
        if (!stage_ || !places_)
            return note("the session made its own lights and cameras and drew no picture, so the recording lacks them");
        scene_.environment = stage_->environment;
        for (std::size_t i = 0; i < stage_->cameras.size(); ++i) {
            SceneCamera& camera = scene_.cameras.emplace_back(SceneCamera{.def = stage_->cameras[i]});
            if (i < places_->cameras.size()) camera.pose = places_->cameras[i].pose;
            while (std::ranges::count(scene_.cameras, camera.def.name, [](const auto& c) { return c.def.name; }) > 1)
                camera.def.name += "'";
        }
        for (std::size_t i = 0; i < stage_->lights.size() && i < places_->lights.size(); ++i)
            if (places_->lights[i].visible)
                scene_.lights.push_back({.def = stage_->lights[i], .pose = places_->lights[i].pose});
        for (const runtime::StageView& view : stage_->views)
            if (view.visible && view.camera < static_cast<int>(scene_.cameras.size()))
                scene_.views.push_back({view.def, scene_.cameras[static_cast<std::size_t>(view.camera)].def.name});
    }
    /// Puts the material of the session's pool in place of its name.
    void name(visual::Material& material)
    {
        const auto* named = std::get_if<visual::NamedMaterial>(&material);
        if (!named || !stage_) return;
        if (!named->overrides.empty()) note("a body's own values of the material '", named->name, "' are left out");
        const auto found = std::ranges::find(stage_->materials, named->name, &runtime::StageMaterial::name);
        if (found != stage_->materials.end()) material = visual::Material(found->material);
    }

    void addMotions()
    {
        for (auto& [which, track] : poses_)
            scene_.bodies[which.first - 1].motions.push_back({.element = which.second, .keys = std::move(track.keys)});
        for (auto& [which, track] : joints_)
            scene_.bodies[which.first - 1].jointMotions.push_back(
                {.joint = which.second, .keys = std::move(track.keys)});
    }

    struct Shown {
        std::size_t body = 0; ///< its index in the scene
        runtime::ShowDef def = {};
    };
    using Which = std::pair<std::uint32_t, int>; ///< number of a body, index of an element or joint

    record::RecordingReader reader_;
    RecordedScene out_;
    SceneDef scene_;
    std::set<std::string> noted_, names_;
    std::vector<BodyId> bodies_; ///< by recorded id: their numbers in the scene; none if they are not in it
    std::map<AttachmentId, AttachmentId> attachments_;
    std::map<Which, Track<KeyPose>> poses_;
    std::map<Which, Track<KeyCommand>> joints_;
    std::vector<runtime::SceneEvent> waiting_;
    std::map<std::uint32_t, Shown> shown_;
    std::optional<runtime::SceneStage> stage_;
    std::optional<runtime::ScenePlaces> places_;
    bool dressed_ = false;
    double before_ = 0.0, time_ = 0.0; ///< [s] begin and end of the step
    std::uint64_t step_ = 0;
};

} // namespace

RecordedScene sceneOf(const std::filesystem::path& recording)
{
    try {
        return SceneCollector(recording).collect();
    } catch (const Error& error) {
        const std::string what = error.what();
        if (what.starts_with(recording.string())) throw;
        fail(recording.string(), ": ", what);
    }
}

} // namespace filasofia::scene
