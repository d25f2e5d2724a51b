#pragma once

#include "filasofia/physics/commands.h"

namespace filasofia::physics {

class PhysicsServer;

/// Checks commands as a server would if it were given one after the other from now on; the server gets none of them.
/// What a script of commands says is found wrong before it runs.
class CommandTrial {
public:
    /// Begins with the bodies and attachments that the server has now; it must outlive the trial.
    explicit CommandTrial(const PhysicsServer& server);
    ~CommandTrial();
    CommandTrial(const CommandTrial&) = delete;
    CommandTrial& operator=(const CommandTrial&) = delete;

    /// Tries any command but AddBody and Tune. Returns the attachment that it would make, or none. Throws an Error as
    /// the function of PhysicsServer that gives it, but builds no material for a SetMaterial.
    AttachmentId give(Command command);
    /// Throws an Error unless the body would be there now.
    void mustBeThere(BodyId id) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::physics
