#pragma once

#include "filasofia/metric/session.h"
#include "filasofia/runtime/rewind.h"
#include "filasofia/runtime/simulation.h"

#include <functional>
#include <memory>
#include <string>

namespace filasofia::prefab {

/// The time [s] of `other` that belongs to a time of `own`: at the end of each step that both have done it is the end
/// of the same step, and in between it runs evenly. Before the first of these ends both begin at 0; after the last one
/// both run equally fast.
double sameMoment(const metric::Session& own, const metric::Session& other, double time);

/// Shows what a trainee has just done once more: a bar with the time to be dragged, with the ends of the steps, play,
/// pause and speed; the paths of the trainee's tools, and beside them an expert's at the same moment of the task. Space
/// plays and pauses, left and right go by a second, Escape closes.
class ReplayScreen {
public:
    /// Construct it before a run. It keeps what is drawn from then on. Throws an Error as Rewind does.
    explicit ReplayScreen(runtime::Simulation& simulation, const runtime::RewindDef& kept = {});
    /// Draws the paths on this server; call it from inside the function given to Simulation::dress(). Without it there
    /// are none.
    void dress(visual::VisualServer& server);

    // Main thread, as in callbacks of Guis.

    /// Plays from the beginning. Pause physics before. `closed` is called when the person closes it.
    void open(std::function<void()> closed = {});
    void setOwn(const metric::Session& session);    ///< the trainee's paths, and the ends of the steps on the bar
    void setExpert(const metric::Session& session); ///< the expert's paths, and a switch for them on the bar
    void say(std::string line);                     ///< a line on the bar, of which 80 characters are shown

    [[nodiscard]] bool isOpen() const;    ///< any thread
    [[nodiscard]] double shownAt() const; ///< [s], simulated time that is shown; any thread

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab
