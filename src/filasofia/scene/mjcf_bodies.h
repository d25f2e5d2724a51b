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
    std::map<std::string, std::pair<std::size_t, std::size_t>, std::less<>> joints, actuators;
    std::map<std::pair<std::size_t, std::size_t>, double> references; ///< [rad] or [m], where joints are in the file

    std::map<std::string, MjcfPlace, std::less<>> bodyPlaces, geomPlaces, sitePlaces; ///< by their names

    /// The pose in our world, as it is at the start; when all bodies have been read.
    [[nodiscard]] Pose worldPose(const MjcfPlace& place);
    /// [m], around all geoms but planes, in our world.
    [[nodiscard]] geometry::Box bounds();

private:
    /// An element of a body, in its <frame> elements if it stands in some.
    struct Member {
        Element element;
        Pose frame; ///< in the body
        std::string childClass;
    };
    /// What a body holds, without its frames.
    [[nodiscard]] std::vector<Member> membersOf(const Element& body, const std::string& childClass);
    void addMembers(const Element& of, const Pose& frame, const std::string& childClass, std::vector<Member>& all);
    void readMembers(const std::vector<Member>& members, const MjcfPlace& place);
    void readBody(const Element& body, const MjcfPlace& outer);
    /// The place behind the body's joints; a new tree if it hangs on nothing that moves.
    [[nodiscard]] MjcfPlace enter(const Element& body, const std::vector<Member>& members, MjcfPlace place);
    [[nodiscard]] MjcfPlace addJoint(const Attributes& says, const Pose& frame, const MjcfPlace& place,
                                     const std::string& link);
    void readLimits(const Attributes& says, bool turns, physics::JointDef& def) const;
    void readInertial(const Element& element, const MjcfPlace& place);
    void readGeom(const Element& element, const MjcfPlace& place, bool weighs);
    void readSite(const Element& element, const MjcfPlace& place);
    /// Notes attributes of the same element that another one makes useless.
    void noteUnused(const Attribute& before, std::initializer_list<const char*> names) const;
    [[nodiscard]] std::optional<Solid> solidOf(const Attributes& says, Pose& pose);
    /// As it is drawn, or as it is touched: without an end.
    [[nodiscard]] Solid planeOf(const Attributes& says, Pose& pose, bool touched) const;
    void weigh(const Attributes& says, const Solid& solid, const MjcfPlace& place);
    void collide(const Attributes& says, const std::shared_ptr<const geometry::TriangleMesh>& mesh,
                 const MjcfPlace& place);

    MjcfSource& source_;
    XmlReader& reader_;
    std::size_t shapes_ = 0;
    int depth_ = 0;
    std::set<std::string> bodyNames_;
    std::set<std::size_t> rubbed_; ///< the trees whose friction a geom has said
    std::vector<std::pair<MjcfPlace, std::shared_ptr<const geometry::TriangleMesh>>> bounded_;
    std::map<std::size_t, std::vector<Pose>> poses_; ///< each tree's links
};

struct ContactBits {
    unsigned type = 1, affinity = 1;
};
ContactBits contactBitsOf(XmlReader& reader, const Attributes& says); ///< contype and conaffinity
/// The collision group of contype and conaffinity; none if it touches nothing.
std::optional<int> groupOf(XmlReader& reader, const Attributes& says);
/// The first number of `friction`, 1 if none is given.
double frictionOf(XmlReader& reader, const Attributes& says);

} // namespace filasofia::scene
