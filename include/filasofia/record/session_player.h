#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/record/recording.h"

#include <functional>

namespace filasofia::physics {
class PhysicsEngine;
}

namespace filasofia::record {

/// Makes an engine for a session's header: engine::makeNativeEngine({.period = header.period, .contact =
/// header.contact}). (This room knows no engine.)
using MakeEngine = std::function<std::unique_ptr<physics::PhysicsEngine>(const RecordingHeader&)>;

/// A recorded session, made again step by step for whoever samples it: a metric, a report, an exporter. All that a step
/// was is computed anew, so nothing of it needs to be in the file.
///
///     record::SessionPlayer session(file, makeEngine);
///     while (session.next()) sampleOf(*session.frame().rigidBody(tool), session.report().time);
///     if (!session.damage().empty()) ... // it ends there: all before it was whole
class SessionPlayer {
public:
    /// Throws an Error where not even the file's header can be read.
    SessionPlayer(const std::filesystem::path& file, const MakeEngine& makeEngine);
    ~SessionPlayer();
    [[nodiscard]] const RecordingHeader& header() const;

    /// Makes the next step; false at the end of the session, or of what is whole of it. Throws an Error naming a step
    /// that cannot be made again (Replayer::step()).
    bool next();

    // Of the step that next() made last.
    [[nodiscard]] const physics::StepRecord& recorded() const; ///< its commands too
    [[nodiscard]] const physics::StepReport& report() const;   ///< as it was made now: contacts, cuts and tears
    /// The whole state after it; captured when it is asked for. Good until next().
    [[nodiscard]] const frame::Frame& frame();
    /// The hash is the recorded one, or none was recorded. Computed when it is asked for.
    [[nodiscard]] bool same() const;

    /// What ended the file before the session's end, as the Error says it; empty: nothing has, so far.
    [[nodiscard]] const std::string& damage() const;
    /// What is made from what: the Defs of all bodies so far, also of those that have gone, ascending by id.
    [[nodiscard]] const std::vector<physics::AddBody>& bodies() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::record
