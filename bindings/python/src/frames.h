#pragma once

#include "session.h"
#include "where.h"

#include "filasofia/frame/frame.h"

namespace filasofia::python {

/// A state as Python holds it: the engine's own frame, which stays as it is while this lives, or a copy of one.
struct HeldFrame {
    std::shared_ptr<Session> session = {}; ///< before the reference into it; null: a copy
    frame::FrameRef ref = {};
    std::shared_ptr<const frame::Frame> copy = {};

    [[nodiscard]] const frame::Frame& get() const { return copy ? *copy : *ref; }
};

/// The frame of the last step. Throws an Error if none was made yet, or if the step was not captured because frames of
/// the pool were held.
HeldFrame newestFrame(const std::shared_ptr<Session>& session);

/// Frame and what it consists of.
void bindFrames(nb::module_& module);

} // namespace filasofia::python
