#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/record/recording.h"

#include <functional>

namespace filasofia::physics {
class PhysicsEngine;
}

namespace filasofia::record {

/// Makes an engine for a session's header: engine::makeNativeEngine({.period = header.period, .contact =
/// header.contact}). (This room does not know any engine.)
using MakeEngine = std::function<std::unique_ptr<physics::PhysicsEngine>(const RecordingHeader&)>;

/// Replays a recorded session step by step, for a metric, a report or an exporter. All results of a step are computed
/// again, so they need not be in the file.
///
///     record::SessionPlayer session(file, makeEngine);
///     while (session.next()) sampleOf(*session.frame().rigidBody(tool), session.report().time);
///     if (!session.damage().empty()) ... // the file ends there: everything before was complete
class SessionPlayer {
public:
    /// Throws an Error if not even the file's header can be read.
    SessionPlayer(const std::filesystem::path& file, const MakeEngine& makeEngine);
    ~SessionPlayer();
    [[nodiscard]] const RecordingHeader& header() const;

    /// Replays the next step; false at the end of the session, or of its undamaged part. Throws an Error naming a step
    /// that cannot be replayed (Replayer::step()).
    bool next();

    // The step that next() made last.
    [[nodiscard]] const physics::StepRecord& recorded() const; ///< with its commands
    [[nodiscard]] const physics::StepReport& report() const;   ///< as computed in the replay: contacts, cuts and tears
    /// The whole state after the step, captured on demand. Valid until next().
    [[nodiscard]] const frame::Frame& frame();
    /// True if the hash equals the recorded one, or none was recorded. Computed on demand.
    [[nodiscard]] bool same() const;

    /// The Error that ended the file before the session's end; empty if there was none so far.
    [[nodiscard]] const std::string& damage() const;
    /// The Defs of all bodies so far, including removed ones, in ascending order of ids.
    [[nodiscard]] const std::vector<physics::AddBody>& bodies() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::record
