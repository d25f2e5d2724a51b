#include "filasofia/scene/import.h"

#include "filasofia/core/error.h"
#include "filasofia/scene/urdf_shapes.h"

#include <algorithm>
#include <map>

namespace filasofia::scene {
namespace {

constexpr Range kUrdfPlace = closed(-kFarthestShape, kFarthestShape);

/// A link or a joint as the file says it.
struct UrdfLink {
    Element element;
    int mover = -1;              ///< the joint that moves it
    std::vector<int> moves = {}; ///< the joints that it carries
};
struct UrdfJoint {
    Element element;
    int child = 0;
    int place = -1; ///< among the joints of the body; -1: it is fixed
};

class UrdfLoader {
public:
    UrdfLoader(const std::filesystem::path& file, const ImportOptions& options)
        : reader_(file, options, "the robot"), shapes_(reader_)
    {
        const XmlFile& source = reader_.read(file, file.string());
        robot_ = {source.document.document_element(), &source};
        if (robot_.tag() != "robot")
            fail(robot_.place(), ": a URDF must begin with <robot>, got <", text(robot_.tag()).substr(0, 80), ">");
    }

    Imported load()
    {
        readParts();
        connect();
        build(rootLink());
        for (const UrdfJoint& each : joints_)
            if (each.place >= 0 && childOf(each.element, "mimic")) follow(each);
        Imported out;
        SceneBody body = tree_.finish(reader_);
        out.scene.bodies.push_back(std::move(body));
        out.joints = {tree_.jointNames};
        out.scene.files = reader_.files();
        out.notes = reader_.takeNotes();
        return out;
    }

private:
    void readParts()
    {
        reader_.tellUnread(robot_, {"name", "version"});
        for (const pugi::xml_node node : robot_.node.children()) {
            if (node.type() != pugi::node_element) continue;
            const Element element{node, robot_.file};
            if (element.tag().starts_with("xacro:"))
                reader_.refuse(element, "is a macro: expand the file first (xacro FILE > robot.urdf)");
            if (element.tag() == "link")
                addNamed(element, links_, linkNames_, UrdfLink{element});
            else if (element.tag() == "joint")
                addJoint(element);
            else if (element.tag() == "material")
                shapes_.defineMaterial(element);
            else
                reader_.tellUnread(element);
        }
        if (links_.empty()) reader_.refuse(robot_, "must have a <link>");
    }
    void addJoint(const Element& element)
    {
        reader_.refuseSecond(childrenOf(element),
                             {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller"});
        addNamed(element, joints_, jointNames_, UrdfJoint{element});
    }
    template <class Part>
    void addNamed(const Element& element, std::vector<Part>& parts, std::map<std::string, int>& names, Part part)
    {
        const std::string name = reader_.requiredWord(Attributes(element), "name");
        if (!names.emplace(name, static_cast<int>(parts.size())).second)
            reader_.refuse(element, "has a name that another one has");
        parts.push_back(std::move(part));
    }

    int linkOf(const Element& joint, const char* tag)
    {
        const Element end = childOf(joint, tag);
        if (!end) reader_.refuse(joint, text("must have a <", tag, ">"));
        reader_.tellUnread(end, {"link"});
        const auto name = Attributes(end).find("link");
        if (!name) reader_.refuse(end, "must say its link");
        return reader_.named(*name, linkNames_, "must be the name of a link");
    }

    void connect()
    {
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            UrdfJoint& joint = joints_[j];
            links_[linkOf(joint.element, "parent")].moves.push_back(static_cast<int>(j));
            joint.child = linkOf(joint.element, "child");
            UrdfLink& moved = links_[joint.child];
            if (moved.mover >= 0) reader_.refuse(joint.element, "has a child that another joint has, too");
            moved.mover = static_cast<int>(j);
        }
    }
    int rootLink()
    {
        int root = -1;
        for (std::size_t i = 0; i < links_.size(); ++i) {
            if (links_[i].mover >= 0) continue;
            if (root >= 0) reader_.refuse(links_[i].element, "is a second link that no joint moves; a robot has one");
            root = static_cast<int>(i);
        }
        if (root < 0) reader_.refuse(robot_, "must have a link that no joint moves: its joints form a loop");
        return root;
    }

    /// Where a link is: an element, and its pose in it.
    struct Place {
        int link, element;
        Pose pose;
    };
    void build(int root)
    {
        tree_.place = robot_;
        const std::string name = reader_.word(Attributes(robot_), "name");
        tree_.def.name = name.empty() ? "robot" : name;
        tree_.def.elements = {kFromZUp};
        tree_.linkNames[0] = links_[root].element.node.attribute("name").value();
        std::vector<std::pair<int, Place>> open; // joints, and where the links are that carry them
        std::size_t seen = 0;
        const auto visit = [&](const Place& at) {
            ++seen;
            readLink(at);
            const std::vector<int>& moves = links_[at.link].moves;
            for (auto joint = moves.rbegin(); joint != moves.rend(); ++joint) open.emplace_back(*joint, at);
        };
        visit({root, 0, {}});
        while (!open.empty()) { // depth first, in the order of the file
            const auto [joint, from] = open.back();
            open.pop_back();
            visit(enter(joints_[joint], from));
        }
        if (seen < links_.size())
            for (const UrdfLink& each : links_)
                if (!isReached(each)) reader_.refuse(each.element, "is not connected to the root: joints form a loop");
    }
    /// Whether the joints from a link upwards end.
    [[nodiscard]] bool isReached(const UrdfLink& link) const
    {
        const UrdfLink* at = &link;
        for (std::size_t steps = 0; at->mover >= 0; ++steps) {
            if (steps > joints_.size()) return false;
            const Element& joint = joints_[at->mover].element;
            at = &links_[linkNames_.at(childOf(joint, "parent").node.attribute("link").value())];
        }
        return true;
    }

    Place enter(UrdfJoint& joint, const Place& from)
    {
        static const std::vector<std::string> kinds = {"fixed",     "revolute", "continuous",
                                                       "prismatic", "floating", "planar"};
        const Element& element = joint.element;
        const Attributes says(element);
        reader_.tellUnread(element, {"name", "type"});
        if (!says.has("type")) reader_.refuse(element, "must say its type");
        const std::size_t kind = reader_.oneOf(says, "type", 0, kinds);
        if (kind >= 4)
            reader_.refuse(element,
                           text("is ", kinds[kind], ": joints of one degree of freedom are carried, and fixed ones"));
        const Pose frame = from.pose * originOf(element);
        if (kind == 0) {
            for (const Element& inner : childrenOf(element))
                if (inner.tag() != "origin" && inner.tag() != "parent" && inner.tag() != "child" &&
                    inner.tag() != "axis")
                    reader_.tellUnread(inner);
            return {joint.child, from.element, frame};
        }
        physics::JointDef def{.kind = kind == 3 ? physics::JointKind::Prismatic : physics::JointKind::Revolute,
                              .axis = {1, 0, 0},
                              .parent = from.element,
                              .parentOffset = frame};
        readJoint(element, kind == 2, def);
        const std::string child = links_[joint.child].element.node.attribute("name").value();
        joint.place = static_cast<int>(tree_.def.articulation.joints.size());
        return {joint.child, tree_.add(def, reader_.word(says, "name"), child), {}};
    }

    void follow(const UrdfJoint& joint)
    {
        const Element mimic = childOf(joint.element, "mimic");
        const Attributes says(mimic);
        const UrdfJoint& other = jointOf(mimic);
        if (other.place < 0) reader_.refuse(mimic, "must name a joint that moves, and not a fixed one");
        tree_.mimics.push_back({.joint = static_cast<std::size_t>(joint.place),
                                .way = {.joint = other.place,
                                        .multiplier = reader_.number(says, "multiplier", 1.0, closed(-1e6, 1e6)),
                                        .offset = reader_.number(says, "offset", 0.0, closed(-1e6, 1e6))},
                                .at = mimic});
    }
    /// The joint that a <mimic> names.
    [[nodiscard]] const UrdfJoint& jointOf(const Element& mimic) const
    {
        const auto name = Attributes(mimic).find("joint");
        if (!name) reader_.refuse(mimic, "must say its joint");
        return joints_[static_cast<std::size_t>(reader_.named(*name, jointNames_, "must be the name of a joint"))];
    }

    void readJoint(const Element& element, bool endless, physics::JointDef& def)
    {
        if (!endless && !childOf(element, "limit")) reader_.refuse(element, "must have a <limit>");
        bool driven = false;
        for (const Element& inner : childrenOf(element)) {
            const Attributes says(inner);
            if (inner.tag() == "axis") {
                reader_.tellUnread(inner, {"xyz"});
                def.axis = reader_.vector(says, "xyz", def.axis, kUrdfPlace);
                if (!(length(def.axis) > 1e-9)) reader_.refuse(inner, "must have an xyz of some length");
            } else if (inner.tag() == "limit") {
                driven = readLimit(says, endless, static_cast<bool>(childOf(element, "mimic")), def);
            } else if (inner.tag() == "dynamics") {
                reader_.tellUnread(inner, {"damping", "friction"});
                def.damping = reader_.number(says, "damping", 0.0, closed(0, 1e12));
                def.friction = reader_.number(says, "friction", 0.0, closed(0, 1e12));
            } else if (inner.tag() == "mimic") {
                reader_.tellUnread(inner, {"joint", "multiplier", "offset"});
            } else if (inner.tag() != "origin" && inner.tag() != "parent" && inner.tag() != "child") {
                reader_.tellUnread(inner);
            }
        }
        def.start = std::clamp(0.0, def.lower, def.upper);
        if (!driven) def.command = physics::JointForce{0.0};
    }
    /// Returns whether the joint has a drive.
    bool readLimit(const Attributes& says, bool endless, bool mimics, physics::JointDef& def)
    {
        const Element element = says.element();
        reader_.tellUnread(element, {"lower", "upper", "effort", "velocity"});
        if (!endless) {
            def.lower = reader_.number(says, "lower", 0.0);
            def.upper = reader_.number(says, "upper", 0.0);
            if (def.lower > def.upper)
                reader_.refuse(*says.find(says.has("upper") ? "upper" : "lower"), "must leave lower <= upper");
        }
        const double effort = reader_.number(says, "effort", 0.0, closed(0, 1e12));
        const double velocity = reader_.number(says, "velocity", 0.0, closed(0, 1e12));
        if (velocity > 0.0) def.speed = velocity;
        if (velocity > 0.0 && mimics)
            reader_.note(element, "limit.velocity",
                         "<limit> velocity does not count if the joint has a <mimic>: it goes with the other one");
        if (effort > 0.0 && !mimics)
            reader_.note(element, "limit.effort",
                         "<limit> effort bounds no force: the joint goes where it is told, "
                         "whatever is in its way");
        return effort > 0.0;
    }

    Pose originOf(const Element& of)
    {
        const Element element = childOf(of, "origin");
        if (!element) return {};
        reader_.tellUnread(element, {"xyz", "rpy"});
        const Attributes says(element);
        const Vec3 rpy = reader_.vector(says, "rpy", {}, closed(-1e4, 1e4));
        const auto turn = [](Vec3 axis, double angle) { return angle == 0.0 ? Quat{} : axisAngle(axis, angle); };
        // Fixed axes: roll about x first, then pitch about y, then yaw about z.
        return {reader_.vector(says, "xyz", {}, kUrdfPlace),
                turn({0, 0, 1}, rpy.z) * turn({0, 1, 0}, rpy.y) * turn({1, 0, 0}, rpy.x)};
    }

    void readLink(const Place& at)
    {
        const Element& link = links_[at.link].element;
        reader_.tellUnread(link, {"name"});
        reader_.refuseSecond(childrenOf(link), {"inertial"});
        for (const Element& inner : childrenOf(link)) {
            if (inner.tag() == "inertial")
                readInertial(inner, at);
            else if (inner.tag() == "visual" || inner.tag() == "collision")
                readShape(inner, at);
            else
                reader_.tellUnread(inner);
        }
    }

    void readInertial(const Element& element, const Place& at)
    {
        reader_.refuseSecond(childrenOf(element), {"origin", "mass", "inertia"});
        for (const Element& inner : childrenOf(element))
            if (inner.tag() != "origin" && inner.tag() != "mass" && inner.tag() != "inertia") reader_.tellUnread(inner);
        const Element mass = childOf(element, "mass"), inertia = childOf(element, "inertia");
        if (!mass) reader_.refuse(element, "must have a <mass>");
        reader_.tellUnread(mass, {"value"});
        const double weight = reader_.number(Attributes(mass), "value", 0.0, closed(0, 1e9));
        Mat3 m{};
        if (inertia) {
            reader_.tellUnread(inertia, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
            const Attributes says(inertia);
            const auto value = [&](const char* name) { return reader_.number(says, name, 0.0); };
            const double xy = value("ixy"), xz = value("ixz"), yz = value("iyz");
            m = {{{value("ixx"), xy, xz}, {xy, value("iyy"), yz}, {xz, yz, value("izz")}}};
        }
        if (at.element == 0) {
            reader_.note(element, "base", "the base stands still: its <inertial> is not used");
            return;
        }
        if (weight == 0.0) tellWeightless(at, element, inertia);
        tree_.addInertia(at.element, moved(at.pose * originOf(element), {weight, {}, m}), element);
    }

    /// A mass of 0 is meant if a link is fixed to another, or lies between two joints; its inertia never is.
    void tellWeightless(const Place& at, const Element& inertial, const Element& inertia)
    {
        const UrdfLink& link = links_[at.link];
        const Attributes says(inertia);
        const auto turns = [&](const char* name) { return reader_.number(says, name, 0.0) != 0.0; };
        if (turns("ixx") || turns("iyy") || turns("izz"))
            reader_.tell(inertia, "weightless", "<inertia> of a link with a <mass> of 0 is not read");
        if (link.moves.empty() && Attributes(joints_[link.mover].element).find("type")->words != "fixed")
            reader_.note(inertial, "weightless link",
                         "a moving link with a <mass> of 0 gets a millionth of the mass of its robot");
    }

    void readShape(const Element& element, const Place& at)
    {
        const bool seen = element.tag() == "visual";
        if (++shapeCount_ > kMostShapes) reader_.refuse(element, text("is one of more than ", kMostShapes, " shapes"));
        reader_.tellUnread(element, {"name"});
        reader_.refuseSecond(childrenOf(element), {"origin", "geometry", "material"});
        std::optional<visual::Material> material;
        for (const Element& inner : childrenOf(element)) {
            if (inner.tag() == "material" && seen)
                material = shapes_.readMaterial(inner);
            else if (inner.tag() != "origin" && inner.tag() != "geometry")
                reader_.tellUnread(inner);
        }
        const Element geometry = childOf(element, "geometry");
        if (!geometry) reader_.refuse(element, "must have a <geometry>");
        const auto solid = shapes_.readSolid(geometry);
        if (!solid) return;
        const auto surface = surfaceOf(*solid, at.pose * originOf(element));
        if (seen)
            tree_.show.push_back({.surface = surface,
                                  .element = at.element,
                                  .material = material.value_or(plainMaterial({0.7, 0.7, 0.72}))});
        else
            tree_.def.collision.push_back({.mesh = surface, .element = at.element});
    }

    XmlReader reader_;
    Element robot_;
    UrdfShapes shapes_;
    RigidTree tree_;
    std::vector<UrdfLink> links_;
    std::vector<UrdfJoint> joints_;
    std::map<std::string, int> linkNames_, jointNames_;
    std::size_t shapeCount_ = 0;
};

} // namespace

Imported loadUrdf(const std::filesystem::path& file, const ImportOptions& options)
{
    return UrdfLoader(file, options).load();
}

} // namespace filasofia::scene
