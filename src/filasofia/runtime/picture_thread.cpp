#include "filasofia/runtime/picture_thread.h"

#include "filasofia/core/error.h"

#include <utility>

namespace filasofia::runtime {

/// The visual server and what the look made of it; on the picture thread only.
struct PictureThread::Stage {
    Simulation::Impl& impl;
    const DrawnBindings drawn{impl.bindings};
    std::unique_ptr<visual::VisualServer> visual;
    visual::Camera* camera = nullptr;   ///< the first view's
    visual::Transform* mover = nullptr; ///< the camera, or the rig that carries it and the light
    Pose inMover = {};                  ///< the camera's pose, seen from the mover
    Pose startPose = {};                ///< the mover's, as the look placed it
    visual::CameraDef startLens = {};

    explicit Stage(Simulation::Impl& itsImpl) : impl(itsImpl) {}

    void open(const PictureDef& def);
    void aim(const PictureDef& def);
    /// Shows the present state as `def` asks, to be captured.
    visual::VisualServer& show(const PictureDef& def);
};

void PictureThread::Stage::open(const PictureDef& def)
{
    auto made = std::make_unique<visual::VisualServer>(
        visual::VisualServerDef{.backend = visual::Backend::Headless, .width = def.width, .height = def.height});
    try {
        impl.bindings.forgetRemoved(impl.physics);
        impl.bindings.addPending(*made);
        impl.dressScene(*made);
        if (made->views().empty()) fail("picture: nothing is shown, so there is nothing to look at: show a body first");
    } catch (...) {
        impl.bindings.release(); // the server ends, and the next picture makes another
        throw;
    }
    camera = &made->views().front()->camera();
    mover = camera->parent() ? camera->parent() : camera;
    inMover = mover == camera ? Pose{} : camera->pose();
    startPose = mover->pose();
    startLens = camera->def();
    visual = std::move(made);
}

void PictureThread::Stage::aim(const PictureDef& def)
{
    mover->setPose(def.pose ? physics::unitPose(*def.pose, "picture: pose") * inverse(inMover) : startPose);
    camera->set(def.camera.value_or(startLens));
}

visual::VisualServer& PictureThread::Stage::show(const PictureDef& def)
{
    if (!visual) open(def);
    if (visual->width() != def.width || visual->height() != def.height) visual->resize(def.width, def.height);
    aim(def);
    impl.mapFinishedFrame(*visual); // after aim(): a recording keeps where the camera is
    return *visual;
}

PictureThread::PictureThread(Simulation::Impl& impl) : impl_(impl), thread_([this] { work(); }) {}

PictureThread::~PictureThread()
{
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void PictureThread::work()
{
    Stage stage(impl_);
    for (;;) {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [this] { return ending_ || asked_; });
        if (ending_) return;
        problem_ = nullptr;
        try {
            (*asked_)(stage);
        } catch (...) {
            problem_ = std::current_exception();
        }
        asked_ = nullptr;
        lock.unlock();
        done_.notify_one();
    }
}

void PictureThread::perform(const std::function<void(Stage&)>& task)
{
    std::unique_lock lock(mutex_);
    asked_ = &task;
    wake_.notify_one();
    done_.wait(lock, [this] { return !asked_; });
    if (problem_) std::rethrow_exception(std::exchange(problem_, nullptr));
}

visual::Image PictureThread::draw(const PictureDef& def)
{
    visual::Image image;
    perform([&](Stage& stage) { image = stage.show(def).capture(); });
    return image;
}

visual::DepthImage PictureThread::drawDepth(const PictureDef& def)
{
    visual::DepthImage image;
    perform([&](Stage& stage) { image = stage.show(def).captureDepth(); });
    return image;
}

} // namespace filasofia::runtime
