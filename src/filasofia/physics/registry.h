#pragma once

#include "filasofia/physics/commands.h"

#include <map>

namespace filasofia::physics {

/// The number of attachments that a body's Def makes.
std::uint32_t attachmentCount(const BodyDef& def);

/// What the server knows of the bodies outside the engine, so that an invalid command fails at its caller and never
/// inside a step.
class Registry {
public:
    struct Body {
        std::shared_ptr<const BodyDef> def;
        int nodeCount = 0;
        AttachmentId firstAttachment = {}; ///< first of its Def's attachments; the others follow
        std::vector<bool> takesForce = {}; ///< for an articulated body, per joint
    };

    /// Throws an Error naming body, field, bound and value unless the command can be applied.
    void check(const Command& command) const;
    /// Updates the registry: to be called with every checked command, in order, before its built body is moved out.
    void note(const Command& command);

    /// Throws an Error if there is none.
    [[nodiscard]] const Body& find(BodyId id) const;
    [[nodiscard]] bool has(BodyId id) const { return bodies_.contains(id); }
    [[nodiscard]] std::vector<BodyId> bodies() const; ///< ascending
    [[nodiscard]] BodyId lastAdded() const { return last_; }
    [[nodiscard]] std::size_t softBodyCount() const;
    [[nodiscard]] std::size_t dynamicElementCount() const; ///< elements of dynamic rigid bodies, and links
    [[nodiscard]] AttachmentId nextAttachment() const { return {lastAttachment_.value + 1}; }

private:
    struct Check;
    std::map<BodyId, Body> bodies_;
    BodyId last_ = {};
    AttachmentId lastAttachment_ = {};
};

} // namespace filasofia::physics
