#include "filasofia/frame/frame.h"

#include <algorithm>

namespace filasofia::frame {
namespace {

template <class Body> const Body* find(const std::vector<Body>& bodies, BodyId id)
{
    const auto found = std::lower_bound(bodies.begin(), bodies.end(), id,
                                        [](const Body& body, BodyId wanted) { return body.id < wanted; });
    return found != bodies.end() && found->id == id ? &*found : nullptr;
}

} // namespace

const SoftBodyFrame* Frame::softBody(BodyId id) const { return find(softBodies, id); }
const RigidBodyFrame* Frame::rigidBody(BodyId id) const { return find(rigidBodies, id); }

} // namespace filasofia::frame
