#include "filasofia/runtime/picture_thread.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/runtime/run_keys.h"
#include "filasofia/runtime/window_scene.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace filasofia::runtime {

/// The visual server and what the look made of it; on the picture thread only.
struct PictureThread::Stage {
    Simulation::Impl& impl;
    std::optional<WindowScene> scene;   ///< in memory, or in the viewer's window
    visual::Camera* camera = nullptr;   ///< the first view's
    visual::Transform* mover = nullptr; ///< the camera, or the rig that carries it and the light
    Pose inMover = {};                  ///< the camera's pose, seen from the mover
    Pose startPose = {};                ///< the mover's, as the look placed it

    std::atomic<bool>& viewing; ///< the scene is in a viewer's window; read by other threads
    std::chrono::nanoseconds period = {};
    std::chrono::steady_clock::time_point nextFrame = {};
    visual::View* aside = nullptr; ///< an off-screen view for pictures while the viewer shows its own

    Stage(Simulation::Impl& itsImpl, std::atomic<bool>& itsViewing) : impl(itsImpl), viewing(itsViewing) {}
    ~Stage() { close(); }
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

    using Framed = Simulation::Impl::Framed;
    void open(std::unique_ptr<window::Window> window, const window::WindowDef& size, visual::Backend backend,
              Framed framed);
    void close();
    void aim(const PictureDef& def);
    /// What `capture` returns for the server; or, if a viewer shows the server's window, for a view aside from it.
    template <class Capture> auto take(const PictureDef& def, Capture&& capture);
    struct Watching;
    visual::View& viewAside(const PictureDef& def);
    void openViewer(const ViewerDef& def);
    /// One frame of the viewer, and what the person did since the last one.
    void frame();
};

void PictureThread::Stage::open(std::unique_ptr<window::Window> window, const window::WindowDef& size,
                                visual::Backend backend, Framed framed)
{
    scene.emplace(impl, std::move(window), size, backend, framed);
    visual::VisualServer& visual = scene->visual();
    if (visual.views().empty()) {
        scene.reset(); // the next one looks again
        fail("picture: nothing is shown, so there is nothing to look at: show a body first");
    }
    camera = &visual.views().front()->camera();
    mover = camera->parent() ? camera->parent() : camera;
    inMover = mover == camera ? Pose{} : camera->pose();
    startPose = mover->pose();
}

void PictureThread::Stage::close()
{
    impl.steering.end();
    aside = nullptr;
    scene.reset();
    viewing = false;
}

void PictureThread::Stage::aim(const PictureDef& def)
{
    mover->setPose(def.pose ? physics::unitPose(*def.pose, "picture: pose") * inverse(inMover) : startPose);
    if (def.camera) camera->set(*def.camera);
}

visual::View& PictureThread::Stage::viewAside(const PictureDef& def)
{
    visual::ViewDef view = scene->visual().views().front()->def();
    view.name = "picture beside the viewer";
    view.viewport = {};
    view.target = visual::OffScreen{def.width, def.height};
    if (!aside) {
        aside = &scene->visual().add(view, *camera);
        aside->setVisible(false); // for frames of the viewer; a capture draws it all the same
    } else if (aside->def().target != view.target) {
        aside->set(view);
    }
    return *aside;
}

/// Gives the camera its lens back, and lets the person at the window look on from where they were.
struct PictureThread::Stage::Watching {
    Stage& stage;
    Pose from;
    visual::CameraDef lens;
    std::optional<visual::CameraDef> asked; ///< the picture's own lens

    ~Watching()
    {
        if (asked) {
            const double now = stage.camera->def().verticalFieldOfView; // a scope may have been zoomed meanwhile
            if (now != asked->verticalFieldOfView) lens.verticalFieldOfView = now;
            stage.camera->set(lens);
        }
        if (stage.viewing) stage.mover->setPose(from);
    }
};

template <class Capture> auto PictureThread::Stage::take(const PictureDef& def, Capture&& capture)
{
    // Pictures from poses of the caller's own are lit alike, whenever the first one is made.
    if (!scene)
        open(nullptr, {.width = def.width, .height = def.height}, visual::Backend::Headless,
             def.pose ? Framed::AtStart : Framed::Now);
    visual::VisualServer& visual = scene->visual();
    const Watching watching{*this, mover->pose(), camera->def(), def.camera};
    if (!viewing) visual.resize(def.width, def.height);
    visual::View* const view = viewing ? &viewAside(def) : nullptr;
    aim(def);
    if (def.pose || def.camera) impl.unseen.wait();
    impl.mapFinishedFrame(visual); // after aim(): a recording keeps where a camera is that follows no body
    if (def.pose) aim(def);        // one that does is back at its body
    if (def.pose || def.camera) {
        impl.unseen.lookAgain();
        impl.unseen.look(visual);
    }
    return view ? capture(*view) : capture(visual);
}

void PictureThread::Stage::openViewer(const ViewerDef& def)
{
    if (viewing) fail("viewer: this simulation has one already");
    std::unique_ptr<window::Window> window = openWindow(impl, def.window, def.backend); // may fail; nothing has changed
    close();
    open(std::move(window), def.window, def.backend, Framed::Now);
    viewing = true;
    period = std::chrono::nanoseconds(toNanoseconds(1.0 / def.rate));
    nextFrame = std::chrono::steady_clock::now();
    try {
        frame();
    } catch (...) {
        close();
        throw;
    }
}

void PictureThread::Stage::frame()
{
    nextFrame = std::max(nextFrame + period, std::chrono::steady_clock::now());
    bool quit = false;
    scene->input([&](std::unique_ptr<event::Event> event) {
        if (scene->visual().handle(*event)) return;
        const auto* key = dynamic_cast<const event::KeyEvent*>(event.get());
        const std::optional<RunAction> action = key && impl.def.look.keys ? actionOf(*key) : std::nullopt;
        quit = quit || action == RunAction::Quit;
        if (action == RunAction::Screenshot) impl.screenshots.ask({});
        if (!action) impl.steering.handle(*event, impl.bindings);
        impl.now.stamp(*event);
        static_cast<void>(impl.events.tryPost(std::move(event)));
    });
    if (quit || scene->closed()) return close();
    impl.mapNewestFrame(scene->visual());
    scene->visual().render();
    impl.takeScreenshots(scene->visual());
}

PictureThread::PictureThread(Simulation::Impl& impl, std::atomic<bool>& viewing)
    : impl_(impl), viewing_(viewing), thread_([this] { work(); })
{
}

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
    Stage stage(impl_, viewing_);
    const auto called = [this] { return ending_ || asked_; };
    // Frames and what is asked for take turns if there is not enough time for both.
    for (bool framed = false;;) {
        std::unique_lock lock(mutex_);
        if (stage.viewing)
            wake_.wait_until(lock, stage.nextFrame, called);
        else
            wake_.wait(lock, called);
        if (ending_) return;
        const bool due = stage.viewing && std::chrono::steady_clock::now() >= stage.nextFrame;
        if (!asked_ || (due && !framed)) {
            lock.unlock();
            framed = true;
            try {
                stage.frame();
            } catch (const std::exception& problem) { // nobody waits for it
                logError("viewer: ", problem.what());
                stage.close();
            }
            continue;
        }
        framed = false;
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
    perform([&](Stage& stage) { image = stage.take(def, [](auto& source) { return source.capture(); }); });
    return image;
}

visual::DepthImage PictureThread::drawDepth(const PictureDef& def)
{
    visual::DepthImage image;
    perform([&](Stage& stage) { image = stage.take(def, [](auto& source) { return source.captureDepth(); }); });
    return image;
}

void PictureThread::openViewer(const ViewerDef& def)
{
    perform([&](Stage& stage) { stage.openViewer(def); });
}

void PictureThread::showInViewer()
{
    perform([](Stage& stage) {
        if (stage.viewing) stage.frame();
    });
}

void PictureThread::closeViewer()
{
    perform([](Stage& stage) {
        if (stage.viewing) stage.close();
    });
}

} // namespace filasofia::runtime
