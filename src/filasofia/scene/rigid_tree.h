#pragma once

#include "filasofia/scene/solid.h"
#include "filasofia/scene/xml_source.h"

#include <map>

/// What URDF and MJCF have in common: links that joints move, with shapes and inertias of their own.
namespace filasofia::scene {

/// From their world, which has z up, to ours.
inline const Pose kFromZUp{{}, {0.70710678118654757, -0.70710678118654757, 0.0, 0.0}};

constexpr std::size_t kMostLinks = 1000;  ///< a body's
constexpr std::size_t kMostShapes = 5000; ///< a file's
constexpr double kFarthestShape = 1000.0; ///< [m], largest size of a shape and largest step from one to the next

/// One rigid body that a file describes.
struct RigidTree {
    Element place = {};
    physics::RigidBodyDef def = {};
    std::vector<runtime::ShowDef> show = {};
    std::vector<physics::RigidInertia> inertias = {{}}; ///< per link, in its coordinates
    std::vector<Element> massPlaces = {{}};             ///< per link, what gives it a mass
    std::vector<std::string> jointNames = {};
    std::vector<std::string> linkNames = {""};

    /// A joint that goes with another one, which may go with a third.
    struct Mimic {
        std::size_t joint = 0;
        physics::JointMimic way = {};
        Element at = {}; ///< what says so
    };
    std::vector<Mimic> mimics = {};

    unsigned types = 0, affinities = 0; ///< MJCF: contype and conaffinity of all its shapes
    bool manyJoints = false; ///< a link of the file hangs on more than one joint, with links without a shape between

    [[nodiscard]] std::size_t links() const { return inertias.size(); }
    /// A new link, which the joint moves; returns its element.
    int add(physics::JointDef joint, const std::string& jointName, const std::string& linkName);
    void addInertia(int link, const physics::RigidInertia& inertia, const Element& from);
    [[nodiscard]] bool isMoved() const { return def.dynamic || links() > 1; }

    /// The body with its mimics and its links' inertias. Throws an Error that names the link whose inertia no body has,
    /// or the mimic that leaves no place.
    [[nodiscard]] SceneBody finish(XmlReader& reader);

private:
    void resolveMimics(const XmlReader& reader);
};

/// Products of quarter turns may be longer than 1 by a rounding, which no Def takes.
void keepUnit(Quat& q);

/// Names that differ: a second "arm" becomes "arm 2".
class Names {
public:
    std::string take(const std::string& name);

private:
    std::map<std::string, int> taken_;
};

} // namespace filasofia::scene
