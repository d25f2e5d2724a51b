#include "filasofia/runtime/scene_player.h"

#include "filasofia/core/hash.h"
#include "filasofia/visual/image.h"

namespace filasofia::runtime {

ScenePlayer::ScenePlayer(Simulation::Impl& impl, const ReplayDef& def)
    : impl_(impl), def_(def), drawing_(!def.picture.empty() || !def.video.empty())
{
}

void ScenePlayer::take(const std::vector<record::SceneRecord>& scene)
{
    if (!drawing_) return;
    for (const record::SceneRecord& record : scene) {
        SceneEvent event = eventOf(record);
        // In order: an event that follows a waiting one may concern the same thing.
        if (waiting_.empty() && knows(event))
            apply(event);
        else
            waiting_.push_back(std::move(event));
    }
}

void ScenePlayer::beforeStep()
{
    if (!drawing_) return;
    for (const SceneEvent& event : std::exchange(waiting_, {}))
        if (knows(event)) apply(event); // else its body came and went between two steps
    if (!visual_) open();
}

bool ScenePlayer::knows(const SceneEvent& event) const
{
    if (const auto* shown = std::get_if<SceneShown>(&event)) return impl_.physics.has(shown->body);
    if (const auto* bled = std::get_if<SceneBled>(&event)) return impl_.physics.has(bled->body);
    if (const auto* burnt = std::get_if<SceneBurnt>(&event)) return impl_.physics.has(burnt->body);
    if (const auto* treated = std::get_if<SceneTreated>(&event)) return impl_.physics.has(treated->body);
    if (const auto* electrode = std::get_if<SceneElectrode>(&event)) return impl_.physics.has(electrode->body);
    if (const auto* activated = std::get_if<SceneActivated>(&event)) return impl_.physics.has(activated->body);
    if (const auto* extracted = std::get_if<SceneExtracted>(&event))
        return !extracted->command.body || impl_.physics.has(extracted->command.body);
    if (const auto* painted = std::get_if<ScenePainted>(&event)) return impl_.physics.has(painted->body);
    return true;
}

ShownId ScenePlayer::shownBy(std::uint32_t recorded) const
{
    const auto found = shown_.find(recorded);
    return found == shown_.end() ? ShownId{} : found->second;
}

void ScenePlayer::apply(const SceneEvent& event)
{
    std::visit([this](const auto& each) { apply(each); }, event);
}

void ScenePlayer::apply(const SceneBegan& began)
{
    began_ = began;
    impl_.def.look = began.look;
}

void ScenePlayer::apply(const SceneFile& file)
{
    const auto described = [](const SceneFile& it) {
        return text(it.bytes, " bytes, digest ", hexadecimal(it.digest));
    };
    const auto now = digested(file.file);
    if (!now) fail("'", file.file, "', which the scene needs, is missing: recorded with ", described(file));
    if (now->digest != file.digest || now->bytes != file.bytes)
        fail("'", file.file, "', which the scene needs, has changed: recorded with ", described(file), ", now ",
             described(*now));
}

void ScenePlayer::apply(const SceneShown& shown)
{
    shown_[shown.shown] = impl_.bindings.show(shown.body, shown.def, impl_.physics);
}

void ScenePlayer::apply(const SceneVisible& visible)
{
    if (const ShownId id = shownBy(visible.shown)) impl_.bindings.setVisible(id, visible.visible);
}

void ScenePlayer::apply(const SceneMaterial& material)
{
    if (const ShownId id = shownBy(material.shown)) impl_.bindings.setMaterial(id, material.material);
}

void ScenePlayer::apply(const SceneUnshown& unshown)
{
    if (const ShownId id = shownBy(unshown.shown)) impl_.bindings.remove(id);
}

void ScenePlayer::apply(const ScenePainted& painted) { impl_.bindings.paint(painted.body, painted.def, impl_.physics); }
void ScenePlayer::apply(const SceneCleaned&) { impl_.cleanSurfaces(); }
void ScenePlayer::apply(const SceneBled& bled)
{
    impl_.bleedings.add(bled.body, bled.def, bled.gravity, impl_.physics);
}
void ScenePlayer::apply(const SceneTreated& treated) { impl_.treat(treated.body, treated.command); }
void ScenePlayer::apply(const SceneBurnt& burnt) { impl_.burnings.add(burnt.body, burnt.def, {}, impl_.physics); }

// The recording of physics has what they do to blades.
void ScenePlayer::apply(const SceneElectrode& electrode)
{
    impl_.electrodes.add(electrode.body, electrode.def, impl_.physics);
}
void ScenePlayer::apply(const SceneActivated& activated)
{
    impl_.electrodes.activate(activated.body, activated.on, activated.electrode);
}

void ScenePlayer::apply(const SceneSmoke& smoke) { impl_.smoke.add(smoke.def, smoke.gravity); }
void ScenePlayer::apply(const SceneExtracted& extracted) { impl_.smoke.extract(extracted.command, impl_.physics); }

void ScenePlayer::apply(const SceneDistension& distension) { impl_.distension.add(distension.def, distension.gravity); }
void ScenePlayer::apply(const SceneDistended& distended) { impl_.distension.apply(distended.command); }

void ScenePlayer::afterStep()
{
    if (!drawing_) return;
    const auto unheard = [](BodyId, const auto&...) { return true; };
    impl_.stepSurfaces(impl_.now.step(), impl_.now.seconds(), unheard, unheard, unheard);
}

void ScenePlayer::apply(const SceneStage& stage)
{
    for (const StageView& view : stage.views)
        if (view.camera >= static_cast<int>(stage.cameras.size()))
            fail("scene: views: camera must be in [0, ", stage.cameras.size(), "), got ", view.camera);
    stage_ = stage;
    lookIsLacking_ = false;
    if (visual_) setStage();
}

void ScenePlayer::setStage()
{
    for (visual::View* view : std::exchange(views_, {})) visual_->remove(*view);
    for (visual::Camera* camera : std::exchange(cameras_, {})) visual_->remove(*camera);
    for (visual::Light* light : std::exchange(lights_, {})) visual_->remove(*light);
    visual_->setEnvironment(stage_->environment);
    for (const visual::CameraDef& def : stage_->cameras) cameras_.push_back(&visual_->add(def));
    for (const visual::LightDef& def : stage_->lights) lights_.push_back(&visual_->add(def));
    for (const StageView& view : stage_->views) {
        views_.push_back(&visual_->add(view.def, *cameras_[static_cast<std::size_t>(view.camera)]));
        views_.back()->setVisible(view.visible);
    }
    for (const auto& [name, material] : stage_->materials)
        visual_->materials().contains(name) ? visual_->changeMaterial(name, material)
                                            : visual_->addMaterial(name, material);
}

void ScenePlayer::apply(const ScenePlaces& places)
{
    places_ = places;
    setPlaces();
}

void ScenePlayer::setPlaces()
{
    const auto set = [](const auto& entities, const std::vector<StagePlace>& list) {
        for (std::size_t i = 0; i < entities.size() && i < list.size(); ++i) {
            entities[i]->setPose(list[i].pose);
            entities[i]->setVisible(list[i].visible);
        }
    };
    set(cameras_, places_.cameras);
    set(lights_, places_.lights);
}

void ScenePlayer::open()
{
    if (began_.width == 0) fail(def_.file, ": it holds no scene, so there is nothing to draw");
    visual_ = std::make_unique<visual::VisualServer>(
        visual::VisualServerDef{.backend = visual::Backend::Headless, .width = began_.width, .height = began_.height});
    if (!def_.video.empty()) video_.emplace(def_.video, began_.width, began_.height, def_.fps);
    if (stage_) {
        setStage(); // before the bodies, whose materials may come from its pool
        setPlaces();
    }
    impl_.bindings.addPending(*visual_);
    if (stage_) return;
    lookIsLacking_ = began_.dressed;
    impl_.dressScene(*visual_);
    // A stage that comes later replaces these.
    cameras_ = visual_->cameras();
    lights_ = visual_->lights();
    views_ = visual_->views();
}

void ScenePlayer::draw()
{
    if (!video_ || !video_->due(impl_.now.seconds())) return;
    impl_.mapFinishedFrame(*visual_);
    video_->show(visual_->capture(), impl_.now.seconds());
}

void ScenePlayer::last(ReplayReport& report)
{
    if (!visual_) return;
    if (!def_.picture.empty()) {
        impl_.mapFinishedFrame(*visual_);
        visual::savePng(visual_->capture(), def_.picture);
        report.pictures.push_back(def_.picture);
    }
    if (video_) {
        video_->close();
        report.pictures.push_back(def_.video);
    }
    if (lookIsLacking_)
        report.notes.emplace_back("the session made its own lights and cameras and drew no picture, so the recording "
                                  "lacks them; drawn with the standard look");
}

} // namespace filasofia::runtime
