#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/geometry/box.h"

#include <sofa/core/CollisionModel.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>

namespace filasofia::sofaengine {

/// Pairs of bodies that welds hold together, the one with the lower id first, each with a box around the points [m].
using WeldedPairs = std::map<std::array<BodyId, 2>, geometry::Box>;

/// What our rules of collision ask about a collision model of SOFA.
struct ModelTag {
    BodyId body = {};
    int element = 0;                         ///< in a rigid body
    int parent = -1;                         ///< the element that a joint connects it to
    bool soft = false;                       ///< the body is soft
    bool moves = true;                       ///< by forces; false for a kinematic body
    std::shared_ptr<const bool> driven = {}; ///< if it has joints: whether forces move some of it. It changes that
    int group = 0;                           ///< only models of the same group meet
    bool self = false;                       ///< whether it meets its own body
    double friction = 0.0;                   ///< [-] the body's
    double stiffness = 0.0;                  ///< [N/m] a contact's, if contacts are penalties
    bool cuttable = false;                   ///< blades of its group pass through
    /// Whether a blade passes through what it could cut; null for all others. Its body changes it.
    std::shared_ptr<const bool> passes = {};
    std::shared_ptr<const WeldedPairs> welded = {}; ///< the scene's now
};
/// Has a tag, whatever kind of model it is.
class Tagged {
public:
    Tagged() = default;
    virtual ~Tagged() = default;
    Tagged(const Tagged&) = delete;
    Tagged& operator=(const Tagged&) = delete;
    ModelTag tag = {};
};

/// Where welds hold the bodies of two models together; null if none do.
inline const geometry::Box* weldOf(const ModelTag& a, const ModelTag& b)
{
    if (!a.welded) return nullptr;
    const auto found = a.welded->find({std::min(a.body, b.body), std::max(a.body, b.body)});
    return found == a.welded->end() ? nullptr : &found->second;
}

inline bool mayMeet(const ModelTag& a, const ModelTag& b)
{
    if ((a.passes && *a.passes && b.cuttable) || (b.passes && *b.passes && a.cuttable)) return false;
    const auto moves = [](const ModelTag& each) { return each.moves || (each.driven && *each.driven); };
    if (a.group != b.group || !(moves(a) || moves(b))) return false;
    if (a.body != b.body) return true;
    const bool jointed = a.parent == b.element || b.parent == a.element; // they overlap there
    return a.self && b.self && (a.soft || (a.element != b.element && !jointed));
}

/// A collision model of SOFA with our rules. SOFA's own are the opposite: models of the same group do not collide.
template <class Base> class TaggedModel final : public Base, public Tagged {
public:
    SOFA_CLASS(SOFA_TEMPLATE(TaggedModel, Base), Base);

    bool canCollideWith(::sofa::core::CollisionModel* other) override
    {
        const auto* tagged = dynamic_cast<const Tagged*>(other);
        return tagged ? mayMeet(tag, tagged->tag) : Base::canCollideWith(other); // a user's, added by tune()
    }
};

} // namespace filasofia::sofaengine
