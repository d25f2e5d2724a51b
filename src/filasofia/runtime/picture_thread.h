#pragma once

#include "filasofia/runtime/simulation_impl.h"
#include "filasofia/runtime/stepped_run.h"

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace filasofia::runtime {

/// The renderer of a stepped run. All of a visual server belongs to the thread that made it, but the owner of a run may
/// call from any thread: so the server has a thread of its own, and the caller waits for it.
class PictureThread {
public:
    explicit PictureThread(Simulation::Impl& impl);
    /// Ends the visual server and its thread.
    ~PictureThread();
    PictureThread(const PictureThread&) = delete;
    PictureThread& operator=(const PictureThread&) = delete;

    /// Draws the present state; physics must not be stepping. Throws what the drawing throws.
    visual::Image draw(const PictureDef& def);
    visual::DepthImage drawDepth(const PictureDef& def);

private:
    struct Stage;
    /// Has the thread do this, and waits for it. Throws what it throws.
    void perform(const std::function<void(Stage&)>& task);
    void work();

    Simulation::Impl& impl_;
    std::mutex mutex_;
    std::condition_variable wake_, done_;
    /// Under the lock, like the members up to ending_; null: nothing is asked for.
    const std::function<void(Stage&)>* asked_ = nullptr;
    std::exception_ptr problem_;
    bool ending_ = false;
    std::thread thread_; ///< last, because it uses all other members
};

} // namespace filasofia::runtime
