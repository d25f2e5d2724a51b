#pragma once

#include "filasofia/physics/commands.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>

namespace filasofia::physics {

/// The number of attachments that a body's Def makes.
std::uint32_t attachmentCount(const BodyDef& def);

/// The number of families of fibres in a material.
std::size_t familiesOf(const SoftMaterial& material);

/// What the server knows of the bodies outside the engine, so that an invalid command fails at its caller and never
/// inside a step.
class Registry {
public:
    struct Body {
        std::shared_ptr<const BodyDef> def;
        int nodeCount = 0;
        AttachmentId firstAttachment = {}; ///< first of its Def's attachments; the others follow
        std::vector<bool> takesForce = {}; ///< for an articulated body, per joint
        std::size_t families = 0;          ///< of fibres, in the present material
        double length = 0.0;               ///< [m] a rod's, at rest
        double longestBend = 0.0;          ///< [m] the longest part of a rod that bends at one node
    };

    /// Throws an Error naming body, field, bound and value unless the command can be applied.
    void check(const Command& command) const;
    /// The part of the check of a SetMaterial that does not look into the mesh.
    void checkMaterial(BodyId id, const SoftMaterial& material) const;
    /// Returns the data kept for a body. It may compute mass properties, so call it before a lock is taken.
    [[nodiscard]] static std::shared_ptr<Body> bodyOf(const AddBody& add);
    /// Updates the registry: to be called with every checked command, in order, before its built body is moved out.
    /// `added`: the result of bodyOf() for an AddBody; if empty, it is made here.
    void note(const Command& command, std::shared_ptr<const Body> added = {});
    /// Records how many families of fibres a body has now, if note() was not called for its material here.
    void noteFamilies(BodyId id, std::size_t families);
    /// Records that attachments up to this id were made, even if note() was not called for them here.
    void knowAttachments(AttachmentId last) { known_ = std::max(known_, last); }

    /// Throws an Error if there is none.
    [[nodiscard]] const Body& find(BodyId id) const;
    [[nodiscard]] bool has(BodyId id) const { return bodies_.contains(id); }
    /// Throws the Error of a body that is not there; `object` and what follows it come before.
    [[noreturn]] void failMissing(BodyId id, std::string_view before = {}) const;
    /// Its name, also if it was removed; "body 7" if there never was one.
    [[nodiscard]] std::string bodyName(BodyId id) const;
    [[nodiscard]] std::vector<BodyId> bodies() const; ///< ascending
    /// What differs between the bodies of both: their ids, kinds, names or sizes. Empty: nothing.
    [[nodiscard]] std::string differenceFrom(const Registry& saved) const;
    [[nodiscard]] BodyId lastAdded() const { return last_; }
    [[nodiscard]] std::size_t softBodyCount() const;
    [[nodiscard]] std::size_t dynamicElementCount() const; ///< elements of dynamic rigid bodies, and links
    [[nodiscard]] AttachmentId lastAttachment() const { return lastAttachment_; }

private:
    struct Check;
    [[nodiscard]] bool areFree(AttachmentId first, std::uint32_t count) const;
    void noteAttachments(AttachmentId first, std::uint32_t count);

    struct Gone {
        std::string name, described; ///< "tool", "rigid body 'tool'"
    };

    std::map<BodyId, std::shared_ptr<const Body>> bodies_;
    std::map<BodyId, Gone> gone_; ///< what was removed, for messages
    BodyId last_ = {};
    AttachmentId lastAttachment_ = {}, known_ = {};
    /// Unused ids below the last one, as ranges from first to last: commands of two threads that attach at the same
    /// time may arrive in reverse order.
    std::map<std::uint32_t, std::uint32_t> free_;
};

} // namespace filasofia::physics
