#pragma once

#include "filasofia/scene/mjcf_source.h"

#include <map>

/// The bodies of a model of MuJoCo.
namespace filasofia::scene {

/// Where an element of the file stands: in a link of a body that moves as one, at a pose relative to it.
struct MjcfPlace {
    std::size_t tree = 0; ///< 0: the world
    int link = 0;
    Pose pose = {};
    std::string childClass = {};
};

/// What is read when all rigid bodies are known.
struct MjcfPending {
    Element element;
    MjcfPlace place;
};

/// Walks through <worldbody>.
class MjcfBodies {
public:
    explicit MjcfBodies(MjcfSource& source);

    void read(const Element& worldbody);

    std::vector<RigidTree> trees; ///< the world first
    std::vector<MjcfPending> flexes, cameras, lights;
    /// The tree and the joint of a name.
    std::map<std::string, std::pair<std::size_t, std::size_t>, std::less<>> joints;

    /// The pose in our world, as it is at the start; when all bodies have been read.
    [[nodiscard]] Pose worldPose(const MjcfPlace& place);
    /// [m], around all geoms but planes, in our world.
    [[nodiscard]] geometry::Box bounds();

private:
    /// `weighed`: what they are in has its inertia from elsewhere.
    void readChildren(const Element& of, const MjcfPlace& place, bool weighed);
    void readBody(const Element& body, const MjcfPlace& outer);
    /// The place behind the body's joints; a new tree if it hangs on nothing that moves.
    [[nodiscard]] MjcfPlace enter(const Element& body, MjcfPlace place);
    [[nodiscard]] MjcfPlace addJoint(const Attributes& says, const MjcfPlace& place, bool last,
                                     const std::string& name);
    void readLimits(const Attributes& says, bool turns, physics::JointDef& def) const;
    void readInertial(const Element& element, const MjcfPlace& place);
    void readGeom(const Element& element, const MjcfPlace& place, bool weighs);
    [[nodiscard]] std::optional<Solid> solidOf(const Attributes& says, Pose& pose);
    [[nodiscard]] Solid planeOf(const Attributes& says, Pose& pose) const;
    void weigh(const Attributes& says, const Solid& solid, const MjcfPlace& place);
    void collide(const Attributes& says, const std::shared_ptr<const geometry::TriangleMesh>& mesh,
                 const MjcfPlace& place);

    MjcfSource& source_;
    XmlReader& reader_;
    std::size_t shapes_ = 0;
    int depth_ = 0;
    std::set<std::size_t> rubbed_; ///< the trees whose friction a geom has said
    std::vector<std::pair<MjcfPlace, std::shared_ptr<const geometry::TriangleMesh>>> bounded_;
    std::map<std::size_t, std::vector<Pose>> poses_; ///< each tree's links
};

/// The collision group of contype and conaffinity; none if it touches nothing.
std::optional<int> groupOf(XmlReader& reader, const Attributes& says);
/// The first number of `friction`, 1 if none is given.
double frictionOf(XmlReader& reader, const Attributes& says);

} // namespace filasofia::scene
