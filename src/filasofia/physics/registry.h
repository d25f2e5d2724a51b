#pragma once

#include "filasofia/physics/commands.h"

#include <algorithm>
#include <map>
#include <memory>

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
    /// What is kept of a body. It may compute mass properties: to be asked for before a lock is taken.
    [[nodiscard]] static std::shared_ptr<Body> bodyOf(const AddBody& add);
    /// Bodies come and go: to be told of every command that was checked, in order, before its built body moves out.
    /// `added`: what bodyOf() made of an AddBody; none: it is made here.
    void note(const Command& command, std::shared_ptr<const Body> added = {});
    /// Attachments up to this one were made, whether or not this registry was told.
    void knowAttachments(AttachmentId last) { known_ = std::max(known_, last); }

    /// Error where there is none.
    [[nodiscard]] const Body& find(BodyId id) const;
    [[nodiscard]] bool has(BodyId id) const { return bodies_.contains(id); }
    [[nodiscard]] std::vector<BodyId> bodies() const; ///< ascending
    [[nodiscard]] BodyId lastAdded() const { return last_; }
    [[nodiscard]] std::size_t softBodyCount() const;
    [[nodiscard]] std::size_t dynamicElementCount() const; ///< of rigid bodies; links are counted with them
    [[nodiscard]] AttachmentId lastAttachment() const { return lastAttachment_; }

private:
    struct Check;
    [[nodiscard]] bool areFree(AttachmentId first, std::uint32_t count) const;
    void noteAttachments(AttachmentId first, std::uint32_t count);

    std::map<BodyId, std::shared_ptr<const Body>> bodies_;
    BodyId last_ = {};
    AttachmentId lastAttachment_ = {}, known_ = {};
    /// Ids below the last one that were not given yet, from first to last: two threads that attach at the same time may
    /// be heard in the other order.
    std::map<std::uint32_t, std::uint32_t> free_;
};

} // namespace filasofia::physics
