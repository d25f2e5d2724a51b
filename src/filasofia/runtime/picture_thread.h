#pragma once

#include "filasofia/runtime/simulation_impl.h"
#include "filasofia/runtime/stepped_run.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace filasofia::runtime {

/// The renderer of a stepped run. All of a visual server belongs to the thread that made it, but the owner of a run may
/// call from any thread: so the server has a thread of its own, and the caller waits for it. While a viewer is open,
/// the thread draws the newest state into its window at its rate.
class PictureThread {
public:
    /// `viewing` tells from now on whether a viewer is open: the person may close it.
    PictureThread(Simulation::Impl& impl, std::atomic<bool>& viewing);
    /// Ends the visual server and its thread.
    ~PictureThread();
    PictureThread(const PictureThread&) = delete;
    PictureThread& operator=(const PictureThread&) = delete;

    // These throw what the drawing throws.
    /// Draws the present state; physics must not be stepping.
    visual::Image draw(const PictureDef& def);
    visual::DepthImage drawDepth(const PictureDef& def);
    /// Error if a viewer is open.
    void openViewer(const ViewerDef& def);
    /// Draws the present state into the viewer's window; does nothing without one.
    void showInViewer();
    /// Does nothing without a viewer.
    void closeViewer();

private:
    struct Stage;
    /// Has the thread do this, and waits for it. Throws what it throws.
    void perform(const std::function<void(Stage&)>& task);
    void work();

    Simulation::Impl& impl_;
    std::atomic<bool>& viewing_;
    std::mutex mutex_;
    std::condition_variable wake_, done_;
    /// Under the lock, like the members up to ending_; null: nothing is asked for.
    const std::function<void(Stage&)>* asked_ = nullptr;
    std::exception_ptr problem_;
    bool ending_ = false;
    std::thread thread_; ///< last, because it uses all other members
};

} // namespace filasofia::runtime
