#include "filasofia/engine/articulation/link_tree.h"

#include "filasofia/core/error.h"

#include <cmath>

namespace filasofia::engine {

LinkTree linkTree(std::vector<LinkJoint> joints)
{
    LinkTree tree;
    tree.joints = std::move(joints);
    const int links = static_cast<int>(tree.joints.size()) + 1;
    tree.jointOf.assign(static_cast<std::size_t>(links), -1);
    std::vector<bool> reached(tree.jointOf.size());
    reached[0] = true;
    const auto within = [&](int link) { return link >= 0 && link < links; };
    for (std::size_t before = tree.joints.size() + 1; before != tree.order.size();) {
        before = tree.order.size();
        for (std::size_t j = 0; j < tree.joints.size(); ++j) {
            const auto [parent, child] = std::pair{tree.joints[j].parent, tree.joints[j].child};
            if (!within(parent) || !within(child)) continue;
            if (!reached[static_cast<std::size_t>(parent)] || reached[static_cast<std::size_t>(child)]) continue;
            reached[static_cast<std::size_t>(child)] = true;
            tree.jointOf[static_cast<std::size_t>(child)] = static_cast<int>(j);
            tree.order.push_back(static_cast<int>(j));
        }
    }
    tree.followers.resize(tree.joints.size());
    for (std::size_t j = 0; j < tree.joints.size(); ++j)
        if (const int other = tree.joints[j].mimics; other >= 0)
            tree.followers[static_cast<std::size_t>(other)].push_back(static_cast<int>(j));
    return tree;
}

void checkTree(const std::string& object, const LinkTree& tree)
{
    const LinkTree again = linkTree(tree.joints);
    if (again.order.size() != tree.joints.size() || again.order != tree.order || again.jointOf != tree.jointOf)
        fail(object, ": joints must form a tree from link 0 on, parents first");
    for (std::size_t j = 0; j < tree.joints.size(); ++j) {
        const LinkJoint& joint = tree.joints[j];
        const std::string field = text(object, ": joints[", j, "]");
        if (!(std::abs(length(joint.axis) - 1.0) < 1e-6)) fail(field, ".axis must have length 1");
        for (const Pose& offset : {joint.parentOffset, joint.childOffset})
            if (!isFinite(offset) || !(std::abs(dot(offset.orientation, offset.orientation) - 1.0) < 1e-6))
                fail(field, ": offsets must be finite, with unit quaternions");
        if (!(joint.lower <= joint.start && joint.start <= joint.upper && std::isfinite(joint.start)))
            fail(field, ".start must be within its limits, got ", joint.start);
        if (!(joint.speed > 0.0)) fail(field, ".speed must be > 0, got ", joint.speed);
        for (double each : {joint.damping, joint.friction, joint.inertia})
            if (!(each >= 0.0 && std::isfinite(each)))
                fail(field, ": damping, friction and inertia must be >= 0, got ", each);
    }
}

} // namespace filasofia::engine
