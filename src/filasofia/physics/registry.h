#pragma once

#include "filasofia/physics/commands.h"

#include <map>

namespace filasofia::physics {

/// How many attachments a body's Def makes.
std::uint32_t attachmentCount(const BodyDef& def);

/// What the outside knows of the bodies, so that a wrong command fails where it is made and never inside a step.
class Registry {
public:
    struct Body {
        std::shared_ptr<const BodyDef> def;
        int nodeCount = 0;
        AttachmentId firstAttachment = {}; ///< of those of its Def; the others follow
        std::vector<bool> takesForce = {}; ///< of an articulated body, per joint
    };

    /// Throws an Error naming body, field, bound and value unless the command can be applied.
    void check(const Command& command) const;
    /// Bodies come and go: to be told of every command that was checked, in order, before its built body moves out.
    void note(const Command& command);

    /// Error where there is none.
    [[nodiscard]] const Body& find(BodyId id) const;
    [[nodiscard]] bool has(BodyId id) const { return bodies_.contains(id); }
    [[nodiscard]] std::vector<BodyId> bodies() const; ///< ascending
    [[nodiscard]] BodyId lastAdded() const { return last_; }
    [[nodiscard]] std::size_t softBodyCount() const;
    [[nodiscard]] std::size_t dynamicElementCount() const; ///< of rigid bodies; links are counted with them
    [[nodiscard]] AttachmentId nextAttachment() const { return {lastAttachment_.value + 1}; }

private:
    struct Check;
    std::map<BodyId, Body> bodies_;
    BodyId last_ = {};
    AttachmentId lastAttachment_ = {};
};

} // namespace filasofia::physics
