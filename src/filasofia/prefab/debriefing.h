#pragma once

#include "filasofia/event/input_events.h"
#include "filasofia/prefab/expert_session.h"
#include "filasofia/prefab/replay_screen.h"
#include "filasofia/prefab/screens.h"
#include "filasofia/prefab/session_report.h"
#include "filasofia/prefab/trainer.h"

#include <atomic>
#include <memory>
#include <string>

namespace filasofia::prefab {

class MetricTracker;

/// What follows a trainee's session at a window: its result is kept, and the end screen leads to the learning curve,
/// the report, and the replay with the expert.
class Debriefing {
public:
    /// Before a run. Adds buttons to `end`, which outlives this.
    Debriefing(runtime::Simulation& simulation, EndScreen& end, const Training& training);

    void records(MetricTracker& tracker) { tracker_ = &tracker; }
    void dress(visual::VisualServer& server) { replay_.dress(server); }

    void begin(const TrainingResult& result); ///< the session is over; any thread
    [[nodiscard]] bool begun() const { return begun_; }
    [[nodiscard]] bool replaying() const { return replay_.isOpen(); } ///< the replay has keys of its own
    void press(const event::KeyEvent& key);                           ///< the thread that delivers events
    void follow();                                                    ///< main thread, with every picture

private:
    struct Asked { // the buttons of the end screen may outlive this
        std::atomic<bool> report = false, replay = false;
    };

    void keepResult();
    void writeReport();
    void openReplay();
    std::string findExpert();

    EndScreen& end_;
    const Training training_;
    ReplayScreen replay_;
    MetricTracker* tracker_ = nullptr;
    TrainingResult result_; ///< set before `begun_`
    std::atomic<bool> begun_ = false;
    const std::shared_ptr<Asked> asked_ = std::make_shared<Asked>();
    bool kept_ = false; // used by the main thread, like those below
    SessionReport report_;
    ExpertSession expert_;
};

} // namespace filasofia::prefab
